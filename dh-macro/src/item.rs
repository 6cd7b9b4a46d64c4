//! The struct that the attribute stands on.

use crate::report::{Report, tokens};
use dh_codegen::emit::rust::Generics;
use proc_macro::{Delimiter, Spacing, Span, TokenStream, TokenTree};

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
            report.mistake(
                "dh_robot stands on a struct",
                all.first().map_or_else(Span::call_site, TokenTree::span),
            );
            return None;
        };
        let depths = depths(rest);
        let end = depths.iter().position(|depth| *depth == 0).filter(|end| *end > 0).map_or(0, |end| end + 1);
        let inside: Vec<_> = rest.iter().zip(&depths).take(end.saturating_sub(1)).skip(1).collect();
        let parameters: Vec<_> = inside
            .split(|(token, depth)| is_mark(token, ',') && **depth == 1)
            .filter(|one| !one.is_empty())
            .collect();
        // With bounds, without defaults.
        let declared = |parameter: &&[(&TokenTree, &usize)]| {
            text(
                parameter
                    .iter()
                    .take_while(|(token, depth)| !(is_mark(token, '=') && **depth == 1))
                    .map(|(token, _)| *token),
            )
        };
        let clause = rest.iter().skip(end).skip_while(|token| !is_word(token, "where"));
        let generics = Generics {
            parameters: bracketed(parameters.iter().map(declared)),
            arguments: bracketed(parameters.iter().map(|parameter| argument(parameter))),
            clause: text(clause.take_while(|token| !is_end(token))),
        };
        Some(Self { name: name.to_string(), generics, tokens: item })
    }

    /// Puts documentation (comment lines) behind the struct's own attributes.
    pub(crate) fn document(&mut self, documentation: &str) {
        let mut attributes: Vec<_> = std::mem::take(&mut self.tokens).into_iter().collect();
        let count = attributes
            .chunks(2)
            .take_while(|pair| pair.first().is_some_and(|mark| is_mark(mark, '#')))
            .count();
        let item = attributes.split_off(2 * count);
        self.tokens.extend(attributes);
        self.tokens.extend(tokens(documentation));
        self.tokens.extend(item);
    }
}

/// How many angle brackets are open after each token.
fn depths(tokens: &[TokenTree]) -> Vec<usize> {
    let mut depth = 0_usize;
    let mut arrow = false;
    let mut depths = Vec::new();
    for token in tokens {
        if is_mark(token, '<') {
            depth += 1;
        } else if is_mark(token, '>') && !arrow {
            depth = depth.saturating_sub(1);
        }
        arrow = matches!(token, TokenTree::Punct(mark) if mark.as_char() == '-' && mark.spacing() == Spacing::Joint);
        depths.push(depth);
    }
    depths
}

/// A generic parameter as an argument.
fn argument(parameter: &[(&TokenTree, &usize)]) -> String {
    match parameter {
        [(quote, _), (name, _), ..] if is_mark(quote, '\'') => format!("'{name}"),
        [(word, _), (name, _), ..] if is_word(word, "const") => name.to_string(),
        [(name, _), ..] => name.to_string(),
        [] => String::new(),
    }
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

fn is_mark(token: &TokenTree, character: char) -> bool {
    matches!(token, TokenTree::Punct(mark) if mark.as_char() == character)
}

/// Fields in braces, or the semicolon.
fn is_end(token: &TokenTree) -> bool {
    let braces =
        |token: &TokenTree| matches!(token, TokenTree::Group(group) if group.delimiter() == Delimiter::Brace);
    is_mark(token, ';') || braces(token)
}
