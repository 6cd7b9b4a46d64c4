//! Prints a plan as Rust that depends on `dh_runtime` and `core` only.
//!
//! The same text serves as a file of its own and inside a block beside a struct of the user's: straight-line functions
//! over plain arrays, private, and on the struct thin methods in the user's types. It has no panics, no heap and no
//! `unsafe`, and is laid out as rustfmt would do it.

mod body;
mod chains;
mod documentation;
mod expression;
mod functions;
mod inverse;
mod inverse_methods;
mod kinematics;
mod layout;
mod liveness;
mod names;
mod number;
mod paths;
mod redundant;
mod stub;
mod tables;
mod targets;
mod text;

pub use names::struct_name;
pub use stub::{Outline, stub};

use crate::model::Model;
use crate::plan::{ConstantId, Function, FunctionKind, Plan};
use liveness::Live;
use names::Names;
use number::number;
use paths::{Paths, Style};
use text::{Text, clean};

/// How the text is printed.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Name of the struct; left out, it is made from that of the robot.
    pub name: Option<String>,
    /// Generic parameters of the struct.
    pub generics: Generics,
    /// Type of all numbers.
    pub scalar: ScalarType,
    /// Types of the methods' arguments and results.
    pub types: Types,
    /// The table as the user names it, for the header.
    pub table: String,
}

/// Generic parameters of a struct, as text.
#[derive(Debug, Clone, Default)]
pub struct Generics {
    /// Parameters with their bounds: `<'a, T: Clone>`, or nothing.
    pub parameters: String,
    /// The same as arguments: `<'a, T>`.
    pub arguments: String,
    /// `where T: Clone`, or nothing.
    pub clause: String,
}

/// Type of all numbers in the generated code.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ScalarType {
    /// Double precision.
    #[default]
    F64,
    /// Single precision.
    F32,
}

impl ScalarType {
    fn name(self) -> &'static str {
        match self {
            Self::F64 => "f64",
            Self::F32 => "f32",
        }
    }
}

/// Types of the generated methods' arguments and results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Types {
    /// nalgebra's.
    #[default]
    Nalgebra,
    /// Arrays and `dh_runtime::Frame`.
    Plain,
}

/// What the attribute adds to a struct of the user's.
#[derive(Debug, Clone)]
pub struct Attached {
    /// Documentation of the struct, as comment lines.
    pub documentation: String,
    /// Items, to be put into a block of their own.
    pub items: String,
}

/// A file: a unit struct with everything that the plan computes.
pub fn print(model: &Model, plan: &Plan, options: &Options) -> String {
    let printer = Printer::new(model, plan, options, Style::File);
    let mut text = Text::default();
    printer.header(&mut text);
    let items = printer.items();
    text.line("");
    printer.paths.uses().iter().for_each(|line| text.line(line));
    text.line("");
    text.documentation(documentation::of_robot(model, &printer.reach()));
    text.line("#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]");
    let reason = "public where it is used or not, and documented in the words of the table";
    text.allow(&["unreachable_pub", "clippy::doc_markdown"], reason);
    text.line(format!("pub struct {};", printer.struct_name));
    text.line("");
    text.laid_out(&items);
    format!("{}\n", text.into_string().trim_end())
}

/// The same for a struct that the user wrote.
pub fn attach(model: &Model, plan: &Plan, options: &Options) -> Attached {
    let printer = Printer::new(model, plan, options, Style::Attribute);
    let mut documentation = Text::default();
    documentation.documentation(documentation::of_robot(model, &printer.reach()));
    Attached { documentation: documentation.into_string(), items: printer.items() }
}

/// What all parts of the text are printed from.
struct Printer<'a> {
    model: &'a Model,
    plan: &'a Plan,
    options: &'a Options,
    struct_name: String,
    paths: Paths,
    /// Names of the plan's constants.
    constants: Vec<String>,
    /// Names of the printer's own constants: what they are asked for by, and what they are called.
    privates: [(&'static str, String); 2],
}

impl<'a> Printer<'a> {
    fn new(model: &'a Model, plan: &'a Plan, options: &'a Options, style: Style) -> Self {
        let struct_name = options.name.clone().unwrap_or_else(|| struct_name(&model.name));
        let mut names = Names::new(reserved(&struct_name, &options.generics));
        let constants = plan.constants.iter().map(|constant| names.constant(&constant.name)).collect();
        let privates = ["REACH", "WINDINGS"].map(|name| (name, names.constant(name)));
        let paths = Paths::new(style, &struct_name);
        Self { model, plan, options, struct_name, paths, constants, privates }
    }

    /// Where the text comes from, and whose it is.
    fn header(&self, text: &mut Text) {
        let table = clean(&self.options.table);
        text.line(format!("// Generated by dhc {} from {table}; edits are lost.", env!("CARGO_PKG_VERSION")));
        text.line(format!("// To regenerate: dhc generate {table} --lang rust"));
        text.line("// The compiler puts no licence terms of its own on this text.");
    }

    /// Everything but the struct: constants, methods, functions.
    fn items(&self) -> String {
        let mut text = Text::default();
        text.gap();
        self.numbers(&mut text);
        text.gap();
        let generics = &self.options.generics;
        let clause = if generics.clause.is_empty() { String::new() } else { format!(" {}", generics.clause) };
        text.allow(
            &["clippy::unused_self", "clippy::trivially_copy_pass_by_ref", "dead_code", "unreachable_pub"],
            "the same methods for every arm, whatever of them is used and where",
        );
        text.open(format!(
            "impl{} {}{}{clause} {{",
            generics.parameters, self.struct_name, generics.arguments
        ));
        self.tables(&mut text);
        self.forward_methods(&mut text);
        self.inverse_methods(&mut text);
        if self.is_complete() {
            self.mounting(&mut text);
        }
        text.close("}");
        text.gap();
        self.forward_functions(&mut text);
        self.tool_point(&mut text);
        self.inverse_functions_text(&mut text);
        if self.is_complete() {
            self.kinematics(&mut text);
        }
        text.into_string()
    }

    /// The numbers of the table that some function reads.
    fn numbers(&self, text: &mut Text) {
        let live: Vec<_> = self
            .plan
            .functions
            .iter()
            .map(|function| Live::of(function, self.plan.constants.len()))
            .collect();
        for (i, (constant, name)) in self.plan.constants.iter().zip(&self.constants).enumerate() {
            if !live.iter().any(|live| live.constant(ConstantId(i))) {
                continue;
            }
            let value = number(constant.value, self.options.scalar, &self.paths);
            if number::looks_approximate(constant.value) {
                text.line(format!("#[allow({}, reason = \"as the table has it\")]", number::APPROXIMATE));
            }
            text.line(format!("const {name}: {} = {value}; // {}", self.scalar(), clean(&constant.note)));
        }
        let reach = number(self.model.reach(), self.options.scalar, &self.paths);
        text.line(format!(
            "const {}: {} = {reach}; // bound on the distance of the tool point",
            self.private("REACH"),
            self.scalar()
        ));
        self.windings(text);
    }

    fn find(&self, kind: &FunctionKind) -> Option<&'a Function> {
        self.plan.functions.iter().find(|function| function.kind == *kind)
    }

    fn dof(&self) -> usize {
        self.model.joints.len()
    }

    fn scalar(&self) -> &'static str {
        self.options.scalar.name()
    }

    /// The scalar type as the last argument of a type whose default is f64.
    fn scalar_argument(&self, separator: &str) -> String {
        match self.options.scalar {
            ScalarType::F64 => String::new(),
            ScalarType::F32 => format!("{separator}f32"),
        }
    }

    /// A type of `dh_runtime` in the scalar type.
    fn runtime_type(&self, name: &str) -> String {
        match self.options.scalar {
            ScalarType::F64 => self.paths.runtime(name),
            ScalarType::F32 => format!("{}<f32>", self.paths.runtime(name)),
        }
    }

    /// A type of `dh_runtime` with a number of joints, in the scalar type.
    fn sized_type(&self, name: &str) -> String {
        format!("{}<{}{}>", self.paths.runtime(name), self.dof(), self.scalar_argument(", "))
    }

    /// Joint values.
    fn joints_type(&self) -> String {
        format!("[{}; {}]", self.scalar(), self.dof())
    }

    /// A pose, in the types of the methods.
    fn pose_type(&self) -> String {
        self.runtime_type(match self.options.types {
            Types::Nalgebra => "Pose",
            Types::Plain => "Frame",
        })
    }

    fn private(&self, name: &str) -> &str {
        self.privates.iter().find(|(known, _)| *known == name).map_or("", |(_, name)| name)
    }

    fn reach(&self) -> String {
        documentation::trimmed((self.model.reach() * 1e4).round() / 1e4)
    }

    /// Names that are taken inside every function.
    fn scope(&self) -> Names {
        Names::new(
            self.constants.iter().chain(self.privates.iter().map(|(_, name)| name)).map(String::as_str),
        )
    }
}

/// Identifiers that constants must leave alone: the struct's own, and what its parameters may be called.
fn reserved<'a>(struct_name: &'a str, generics: &'a Generics) -> impl Iterator<Item = &'a str> {
    let words = |text: &'a str| text.split(|c: char| !(c.is_alphanumeric() || c == '_'));
    let constants =
        ["PI", "TAU", "FRAC_PI_2", "FRAC_PI_3", "FRAC_PI_4", "FRAC_PI_6", "FRAC_PI_8", "FRAC_1_PI"];
    let more = ["SQRT_2", "FRAC_1_SQRT_2", "FULL_POSE"];
    core::iter::once(struct_name)
        .chain(words(&generics.parameters))
        .chain(words(&generics.clause))
        .chain(constants)
        .chain(more)
        .filter(|word| !word.is_empty())
}
