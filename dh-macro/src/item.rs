//! The struct that the attribute stands on.

use crate::report::{Report, tokens};
use dh_codegen::emit::rust::Generics;
use proc_macro::{Delimiter, Spacing, TokenStream, TokenTree};

/// A struct, unread but for its name and generic parameters.
pub(crate) struct Item {
    pub(crate) name: String,
    pub(crate) generics: Generics,
    /// All of it.
    pub(crate) tokens: TokenStream,
}

impl Item {
    /// Finds name and generic parameters of a struct.
    pub(crate) fn parse(item: TokenStream, report: &mut Report) -> Option<Self> {
        let all: Vec<_> = item.clone().into_iter().collect();
        let at = all.iter().position(|token| is_word(token, "struct"));
        let Some([TokenTree::Ident(name), rest @ ..]) = at.and_then(|at| all.get(at + 1..)) else {
            let span = all.first().map_or_else(proc_macro::Span::call_site, TokenTree::span);
            report.mistake("dh_robot stands on a struct", span);
            return None;
        };
        let parameters = angle_bracketed(rest);
        let clause = rest.get(parameters.len()..).unwrap_or_default();
        let clause = clause.iter().skip_while(|token| !is_word(token, "where"));
        let generics = Generics {
            parameters: declared(&split(parameters)),
            arguments: passed(&split(parameters)),
            clause: text(clause.take_while(|token| !is_end(token))),
        };
        Some(Self { name: name.to_string(), generics, tokens: item })
    }

    /// Puts documentation (comment lines) behind the struct's own attributes.
    pub(crate) fn document(&mut self, documentation: &str) {
        let mut attributes: Vec<_> = std::mem::take(&mut self.tokens).into_iter().collect();
        let is_mark = |token: &TokenTree| matches!(token, TokenTree::Punct(mark) if mark.as_char() == '#');
        let count = attributes.chunks(2).take_while(|pair| pair.first().is_some_and(is_mark)).count();
        let item = attributes.split_off(2 * count);
        self.tokens.extend(attributes);
        self.tokens.extend(tokens(documentation));
        self.tokens.extend(item);
    }
}

/// `<...>` at the beginning of `rest`, brackets included.
fn angle_bracketed(rest: &[TokenTree]) -> &[TokenTree] {
    let mut depth = 0_usize;
    let mut arrow = false;
    for (i, token) in rest.iter().enumerate() {
        let mark = if let TokenTree::Punct(mark) = token { mark.as_char() } else { ' ' };
        match mark {
            '<' => depth += 1,
            '>' if !arrow => depth = depth.saturating_sub(1),
            _ => {}
        }
        arrow = matches!(token, TokenTree::Punct(mark) if mark.as_char() == '-' && mark.spacing() == Spacing::Joint);
        if depth == 0 {
            return if i == 0 { &[] } else { rest.get(..=i).unwrap_or_default() };
        }
    }
    &[]
}

/// Generic parameters, each as its tokens.
fn split(parameters: &[TokenTree]) -> Vec<&[TokenTree]> {
    let inner = parameters.get(1..parameters.len().saturating_sub(1)).unwrap_or_default();
    let mut depth = 0_usize;
    let mut split = Vec::new();
    let mut start = 0;
    for (i, token) in inner.iter().enumerate() {
        let TokenTree::Punct(mark) = token else { continue };
        match mark.as_char() {
            '<' => depth += 1,
            '>' => depth = depth.saturating_sub(1),
            ',' if depth == 0 => {
                split.push(inner.get(start..i).unwrap_or_default());
                start = i + 1;
            }
            _ => {}
        }
    }
    split.push(inner.get(start..).unwrap_or_default());
    split.retain(|parameter| !parameter.is_empty());
    split
}

/// Generic parameters as they are declared on an `impl`: with bounds, without defaults.
fn declared(parameters: &[&[TokenTree]]) -> String {
    bracketed(parameters.iter().map(|parameter| {
        let mut depth = 0_usize;
        text(parameter.iter().take_while(|token| {
            let mark = if let TokenTree::Punct(mark) = token { mark.as_char() } else { ' ' };
            match mark {
                '<' => depth += 1,
                '>' => depth = depth.saturating_sub(1),
                _ => {}
            }
            mark != '=' || depth > 0
        }))
    }))
}

/// Generic parameters as arguments.
fn passed(parameters: &[&[TokenTree]]) -> String {
    bracketed(parameters.iter().map(|parameter| match parameter {
        [TokenTree::Punct(quote), name, ..] if quote.as_char() == '\'' => format!("'{name}"),
        [constant, name, ..] if is_word(constant, "const") => name.to_string(),
        [name, ..] => name.to_string(),
        [] => String::new(),
    }))
}

fn bracketed(parameters: impl Iterator<Item = String>) -> String {
    let parameters: Vec<_> = parameters.collect();
    if parameters.is_empty() { String::new() } else { format!("<{}>", parameters.join(", ")) }
}

fn text<'a>(tokens: impl Iterator<Item = &'a TokenTree>) -> String {
    tokens.cloned().collect::<TokenStream>().to_string()
}

fn is_word(token: &TokenTree, word: &str) -> bool {
    matches!(token, TokenTree::Ident(ident) if ident.to_string() == word)
}

/// Fields in braces, or the semicolon.
fn is_end(token: &TokenTree) -> bool {
    match token {
        TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
        TokenTree::Punct(mark) => mark.as_char() == ';',
        _ => false,
    }
}
