//! `"mycobot.toml", scalar = "f32", types = "plain", warnings = "off"`.

use crate::report::Report;
use dh_codegen::emit::rust::{ScalarType, Types};
use proc_macro::{Literal, Span, TokenStream, TokenTree};

/// What stands in the parentheses of the attribute.
pub(crate) struct Arguments {
    /// The table, as written.
    pub(crate) path: String,
    /// Where it is written.
    pub(crate) span: Span,
    pub(crate) scalar: ScalarType,
    pub(crate) types: Types,
    pub(crate) warnings: bool,
}

const USAGE: &str = "dh_robot takes a table and options: #[dh_robot(\"arm.toml\", scalar = \"f32\", types = \"plain\", warnings = \"off\")]";

impl Arguments {
    /// Reads what it can; what it cannot is a mistake and left out. `None` where there is no table.
    pub(crate) fn parse(tokens: TokenStream, report: &mut Report) -> Option<Self> {
        let mut tokens = tokens.into_iter();
        let table = tokens.next();
        let Some((path, span)) = table.as_ref().and_then(string) else {
            report.mistake(USAGE, table.map_or_else(Span::call_site, |token| token.span()));
            return None;
        };
        let types = if cfg!(feature = "nalgebra") { Types::Nalgebra } else { Types::Plain };
        let mut arguments = Self { path, span, scalar: ScalarType::F64, types, warnings: true };
        let rest: Vec<_> = tokens.collect();
        for option in rest.split(|token| matches!(token, TokenTree::Punct(mark) if mark.as_char() == ',')) {
            match option {
                [] => {}
                [TokenTree::Ident(name), TokenTree::Punct(equals), value] if equals.as_char() == '=' => {
                    let written = string(value).map(|(value, _)| value);
                    if let Err(message) = arguments.set(&name.to_string(), written.as_deref()) {
                        report.mistake(&message, value.span());
                    }
                }
                [token, ..] => report.mistake(USAGE, token.span()),
            }
        }
        Some(arguments)
    }

    fn set(&mut self, name: &str, value: Option<&str>) -> Result<(), String> {
        match (name, value) {
            ("scalar", Some("f64")) => self.scalar = ScalarType::F64,
            ("scalar", Some("f32")) => self.scalar = ScalarType::F32,
            ("types", Some("nalgebra")) if cfg!(feature = "nalgebra") => self.types = Types::Nalgebra,
            ("types", Some("nalgebra")) => {
                return Err("dh-runtime is built without its feature `nalgebra`".to_owned());
            }
            ("types", Some("plain")) => self.types = Types::Plain,
            ("warnings", Some("on")) => self.warnings = true,
            ("warnings", Some("off")) => self.warnings = false,
            ("scalar", _) => return Err("`scalar` is \"f64\" or \"f32\"".to_owned()),
            ("types", _) => return Err("`types` is \"nalgebra\" or \"plain\"".to_owned()),
            ("warnings", _) => return Err("`warnings` is \"on\" or \"off\"".to_owned()),
            _ => {
                return Err(format!("dh_robot has no option `{name}`, but `scalar`, `types` and `warnings`"));
            }
        }
        Ok(())
    }
}

/// The letters of a string literal, and where it stands.
fn string(token: &TokenTree) -> Option<(String, Span)> {
    match token {
        TokenTree::Literal(literal) => Some((letters(literal)?, literal.span())),
        // What a macro_rules parameter was, comes in an invisible group.
        TokenTree::Group(group) => string(&group.stream().into_iter().next()?),
        _ => None,
    }
}

fn letters(literal: &Literal) -> Option<String> {
    let text = literal.to_string();
    if let Some(raw) = text.strip_prefix('r') {
        return Some(raw.trim_matches('#').strip_prefix('"')?.strip_suffix('"')?.to_owned());
    }
    let mut characters = text.strip_prefix('"')?.strip_suffix('"')?.chars();
    let mut letters = String::new();
    while let Some(character) = characters.next() {
        // Paths and options need no other escapes.
        letters.push(if character == '\\' {
            characters.next().filter(|c| "\\\"".contains(*c))?
        } else {
            character
        });
    }
    Some(letters)
}
