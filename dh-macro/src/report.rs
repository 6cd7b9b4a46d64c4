//! What the compiler of the user's crate is told: mistakes, warnings, and which file to watch.

use crate::arguments::Arguments;
use dh_codegen::diagnostic::Style;
use dh_codegen::diagnostic::{Diagnostic, Severity};
use proc_macro::{Group, Span, TokenStream, TokenTree};
use std::path::Path;

/// Items that say it.
#[derive(Default)]
pub(crate) struct Report(TokenStream);

impl Report {
    /// A mistake in the attribute or in what it stands on.
    pub(crate) fn mistake(&mut self, message: &str, span: Span) {
        self.0.extend(spanned(&format!("::core::compile_error!{{ {message:?} }}"), span));
    }

    /// What the compiler of tables says, drawn over the table's text, at the table's name.
    pub(crate) fn diagnostic(
        &mut self,
        diagnostic: &Diagnostic,
        text: &str,
        path: &str,
        arguments: &Arguments,
    ) {
        match diagnostic.severity {
            Severity::Error => {
                self.mistake(&diagnostic.render(text, path, Style::WithinError), arguments.span);
            }
            Severity::Warning if !arguments.warnings => {}
            Severity::Warning => {
                // A macro cannot warn; the use of something deprecated can.
                let note = diagnostic.render(text, path, Style::WithinError);
                let warning = format!(
                    "const _: () = {{
                        #[deprecated(note = {note:?})]
                        const ROBOT_TABLE: () = ();
                        ROBOT_TABLE
                    }};"
                );
                self.0.extend(spanned(&warning, arguments.span));
            }
        }
    }

    /// Has the crate compiled again when the table changes, mistakes in it or not.
    pub(crate) fn track(&mut self, path: Option<&Path>) {
        if let Some(path) = path.and_then(Path::to_str) {
            self.0.extend(tokens(&format!("const _: &[u8] = ::core::include_bytes!({path:?});")));
        }
    }

    pub(crate) fn into_tokens(self) -> TokenStream {
        self.0
    }
}

/// Text as tokens. That of our own printer always is Rust; if it were not, the message would say so.
pub(crate) fn tokens(text: &str) -> TokenStream {
    text.parse().unwrap_or_else(|error| {
        let message = format!("dh_robot printed what is not Rust: {error}");
        format!("::core::compile_error!{{ {message:?} }}").parse().unwrap_or_default()
    })
}

/// Text as tokens that stand at a place of the user's.
fn spanned(text: &str, span: Span) -> TokenStream {
    fn moved(tokens: TokenStream, span: Span) -> TokenStream {
        let token = |token| {
            let mut token = match token {
                TokenTree::Group(group) => {
                    TokenTree::Group(Group::new(group.delimiter(), moved(group.stream(), span)))
                }
                token => token,
            };
            token.set_span(span);
            token
        };
        tokens.into_iter().map(token).collect()
    }
    moved(tokens(text), span)
}
