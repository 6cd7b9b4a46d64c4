//! Tokens of expressions.

use super::Text;
use std::ops::Range;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TokenKind {
    Number,
    Name,
    Plus,
    Minus,
    Times,
    Over,
    /// `^` or `**`, which the language does not have.
    Power,
    Open,
    Close,
    Comma,
    Unknown,
    End,
}

/// A token with its byte range in the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Token {
    pub(super) kind: TokenKind,
    pub(super) at: Range<usize>,
}

/// Reads a part of a text, token by token.
#[derive(Clone)]
pub(super) struct Lexer<'a> {
    text: &'a str,
    at: usize,
    end: usize,
}

impl<'a> Lexer<'a> {
    pub(super) fn new(text: &'a Text, part: Range<usize>) -> Lexer<'a> {
        Lexer { text: &text.value, at: part.start, end: part.end.min(text.value.len()) }
    }

    /// The text of a token.
    pub(super) fn of(&self, token: &Token) -> &'a str {
        self.text.get(token.at.clone()).unwrap_or("")
    }

    pub(super) fn peek(&self) -> Token {
        self.clone().next()
    }

    pub(super) fn next(&mut self) -> Token {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
        let rest = self.rest();
        let Some(first) = rest.chars().next() else {
            return Token { kind: TokenKind::End, at: self.at..self.at };
        };
        let (kind, length) = match first {
            '*' if rest.starts_with("**") => (TokenKind::Power, 2),
            '+' => (TokenKind::Plus, 1),
            '-' => (TokenKind::Minus, 1),
            '*' => (TokenKind::Times, 1),
            '/' => (TokenKind::Over, 1),
            '^' => (TokenKind::Power, 1),
            '(' => (TokenKind::Open, 1),
            ')' => (TokenKind::Close, 1),
            ',' => (TokenKind::Comma, 1),
            '0'..='9' | '.' => (TokenKind::Number, number_length(rest)),
            c if is_name_start(c) => (TokenKind::Name, name_length(rest)),
            c => (TokenKind::Unknown, c.len_utf8()),
        };
        let at = self.at..self.at + length;
        self.at = at.end;
        Token { kind, at }
    }

    fn rest(&self) -> &'a str {
        self.text.get(self.at..self.end).unwrap_or("")
    }
}

fn is_name_start(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

fn name_length(rest: &str) -> usize {
    rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len())
}

/// Digits, a point and more digits, and an exponent if digits follow its `e`.
fn number_length(rest: &str) -> usize {
    let digits = |from: usize| {
        let tail = rest.get(from..).unwrap_or("");
        from + tail.find(|c: char| !c.is_ascii_digit()).unwrap_or(tail.len())
    };
    let mut end = digits(0);
    if rest.get(end..).is_some_and(|tail| tail.starts_with('.')) {
        end = digits(end + 1);
    }
    if let Some(tail) = rest.get(end..).filter(|tail| tail.starts_with(['e', 'E'])) {
        let sign = usize::from(tail.get(1..).is_some_and(|tail| tail.starts_with(['+', '-'])));
        let exponent = digits(end + 1 + sign);
        if exponent > end + 1 + sign {
            end = exponent;
        }
    }
    end
}
