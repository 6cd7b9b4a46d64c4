//! `#[dh_robot("mycobot.toml")]` puts the kinematics of a robot table on a struct.
//!
//! This crate finds the table ([`dh_build`]), has it compiled ([`dh_codegen`]) and reports; nothing else. It reads its
//! input by hand: the crates that parse all of Rust would be most of its build time.

mod arguments;
mod item;
mod report;

use arguments::Arguments;
use dh_build::Source;
use dh_codegen::emit::rust::{Attached, Options, Outline, attach, stub};
use dh_codegen::verify::Level;
use item::Item;
use proc_macro::TokenStream;
use report::Report;
use std::path::PathBuf;

/// Gives a struct the kinematics of a robot table: `fk`, `jacobian`, `ik`, `JOINTS` and what else the table asks for.
///
/// ```text
/// #[dh_robot("mycobot.toml")]   // a file beside this source file, else in the crate's root, else in its robots/ folder
/// pub struct MyCobot;
///
/// #[dh_robot("mycobot", scalar = "f32")]   // without .toml, the table shipped under that name
/// pub struct MyCobot32;
/// ```
///
/// Options: `scalar = "f64"` or `"f32"`; `types = "nalgebra"` or `"plain"` (arrays and `Frame` in the methods);
/// `warnings = "off"`. The struct may have fields and generic parameters.
#[proc_macro_attribute]
pub fn dh_robot(arguments: TokenStream, item: TokenStream) -> TokenStream {
    let mut report = Report::default();
    let arguments = Arguments::parse(arguments, &mut report);
    let (Some(arguments), Some(mut parsed)) = (arguments, Item::parse(item.clone(), &mut report)) else {
        return [item, report.into_tokens()].into_iter().collect();
    };
    let options = Options {
        name: Some(parsed.name.clone()),
        generics: parsed.generics.clone(),
        scalar: arguments.scalar,
        types: arguments.types,
        table: arguments.path.clone(),
    };
    let attached = compile(&arguments, &options, &mut report);
    parsed.document(&attached.documentation);
    [parsed.tokens, report::tokens(&format!("const _: () = {{ {} }};", attached.items)), report.into_tokens()]
        .into_iter()
        .collect()
}

/// The items of the table, or, where it has mistakes, those that it would have without.
fn compile(arguments: &Arguments, options: &Options, report: &mut Report) -> Attached {
    let crate_root = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    let source_file = arguments.span.local_file();
    let source = match Source::for_macro(&arguments.path, source_file.as_deref(), crate_root.as_deref()) {
        Ok(source) => source,
        Err(error) => {
            report.diagnostic(&error.diagnostic(), "", error.name(), arguments);
            return stub(&Outline::default(), options);
        }
    };
    report.track(source.path.as_deref());
    let compilation = dh_codegen::compile(&source.text, Level::Quick);
    for diagnostic in compilation.diagnostics.sorted() {
        report.diagnostic(diagnostic, &source.text, &source.name_shown, arguments);
    }
    match &compilation.output {
        Some(output) => attach(&output.model, &output.plan, options),
        None => stub(&compilation.outline, options),
    }
}
