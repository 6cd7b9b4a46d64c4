//! How items of other crates are named: imported where the text is a file of its own, by absolute paths where it
//! lands beside the user's items, which may have any names.

use std::cell::RefCell;
use std::collections::BTreeSet;

use super::ScalarType;

/// Where the text goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Style {
    /// A file of its own.
    File,
    /// Inside a block next to the struct that carries the attribute.
    Attribute,
}

/// Names of foreign items, and which of them have been used.
#[derive(Debug)]
pub(super) struct Paths {
    style: Style,
    struct_name: String,
    imports: RefCell<BTreeSet<String>>,
}

impl Paths {
    pub(super) fn new(style: Style, struct_name: &str) -> Self {
        Self { style, struct_name: struct_name.to_owned(), imports: RefCell::default() }
    }

    /// An item of `dh_runtime`, by the name of its last segment.
    pub(super) fn runtime(&self, name: &str) -> String {
        self.imported("::dh_runtime", name)
    }

    /// A link of documentation to an item of `dh_runtime`.
    pub(super) fn link(&self, name: &str) -> String {
        let path = self.runtime(name);
        if path == name { format!("[`{name}`]") } else { format!("[`{name}`]({path})") }
    }

    /// A type of nalgebra, through `dh_runtime`.
    pub(super) fn nalgebra(&self, name: &str) -> String {
        self.imported("::dh_runtime::nalgebra", name)
    }

    /// A constant of `core::f64::consts` or `core::f32::consts`.
    pub(super) fn constant(&self, name: &str, scalar: ScalarType) -> String {
        self.imported(&format!("::core::{}::consts", scalar.name()), name)
    }

    /// An item of the prelude, which a user may have shadowed (`Result` often is).
    pub(super) fn prelude(&self, name: &'static str) -> String {
        if self.style == Style::File && name != self.struct_name {
            return name.to_owned();
        }
        let module = match name {
            "Ok" | "Err" => "::core::result::Result",
            "Some" | "None" => "::core::option::Option",
            "Result" => "::core::result",
            _ => "::core::option",
        };
        format!("{module}::{name}")
    }

    /// The `use` lines of all that was named, sorted as rustfmt sorts them.
    pub(super) fn uses(&self) -> Vec<String> {
        let imports = self.imports.borrow();
        let mut modules: Vec<(String, Vec<&str>)> = Vec::new();
        for path in imports.iter() {
            let Some((module, name)) = path.rsplit_once("::") else { continue };
            match modules.iter_mut().find(|(known, _)| known == module) {
                Some((_, names)) => names.push(name),
                None => modules.push((module.to_owned(), vec![name])),
            }
        }
        let mut uses: Vec<_> = modules.iter().map(|(module, names)| use_lines(module, names)).collect();
        // A list of names sorts behind deeper modules.
        uses.sort();
        uses.concat()
    }

    fn imported(&self, module: &str, name: &str) -> String {
        let path = format!("{module}::{name}");
        if self.style == Style::Attribute || name == self.struct_name {
            return path;
        }
        self.imports.borrow_mut().insert(path);
        name.to_owned()
    }
}

/// `use module::{names};`, in lines of at most 100 columns.
fn use_lines(module: &str, names: &[&str]) -> Vec<String> {
    let mut sorted = names.to_vec();
    sorted.sort_unstable();
    if let [name] = sorted[..] {
        return vec![format!("use {module}::{name};")];
    }
    let line = format!("use {module}::{{{}}};", sorted.join(", "));
    if line.len() <= 100 {
        return vec![line];
    }
    let mut lines = vec![format!("use {module}::{{")];
    let mut row = String::new();
    for name in sorted {
        if row.len() + name.len() + 6 > 100 {
            lines.push(format!("   {row}"));
            row.clear();
        }
        row.push(' ');
        row.push_str(name);
        row.push(',');
    }
    lines.push(format!("   {row}"));
    lines.push("};".to_owned());
    lines
}

#[cfg(test)]
mod tests {
    use super::{Paths, ScalarType, Style};

    #[test]
    fn a_file_imports_what_it_names() {
        let paths = Paths::new(Style::File, "Frame");
        assert_eq!(paths.runtime("Joint"), "Joint");
        assert_eq!(paths.runtime("Frame"), "::dh_runtime::Frame");
        assert_eq!(paths.constant("PI", ScalarType::F64), "PI");
        assert_eq!(paths.prelude("Result"), "Result");
        assert_eq!(paths.uses(), ["use ::core::f64::consts::PI;", "use ::dh_runtime::Joint;"]);
    }

    #[test]
    fn an_attribute_imports_nothing() {
        let paths = Paths::new(Style::Attribute, "Arm");
        assert_eq!(paths.runtime("Joint"), "::dh_runtime::Joint");
        assert_eq!(paths.prelude("Ok"), "::core::result::Result::Ok");
        assert!(paths.uses().is_empty());
    }
}
