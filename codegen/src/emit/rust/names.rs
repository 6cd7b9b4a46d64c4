//! Rust identifiers for the names of a plan, none of which may hide another.

use std::collections::BTreeSet;

/// What the printer itself calls things inside a generated function, and what it calls there.
const OURS: [&str; 25] = [
    "q",
    "target",
    "search",
    "roots",
    "pose",
    "tool",
    "columns",
    "frame",
    "frames",
    "position_error",
    "rotation_error",
    "forward_kinematics",
    "flange_pose",
    "geometric_jacobian",
    "pose_and_jacobian",
    "row_frames",
    "tool_point",
    "conditions",
    "rules",
    "seed",
    "free",
    "unknowns",
    "wanted",
    "asked",
    "candidates",
];

/// Words that are not identifiers in any edition up to 2024 (`raw#` forms are no easier to read than a suffix).
const KEYWORDS: [&str; 53] = [
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn",
    "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop",
    "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self", "static",
    "struct", "super", "trait", "true", "try", "type", "typeof", "union", "unsafe", "unsized", "use",
    "virtual", "where", "while", "yield", "_",
];

/// Identifiers of one scope, each given once.
#[derive(Debug, Clone)]
pub(super) struct Names {
    taken: BTreeSet<String>,
}

impl Names {
    /// A scope in which the printer's own names and `reserved` are taken.
    pub(super) fn new<'a>(reserved: impl IntoIterator<Item = &'a str>) -> Self {
        let taken = OURS.into_iter().chain(KEYWORDS).chain(reserved).map(str::to_owned).collect();
        Self { taken }
    }

    /// A local of its own for `wanted`: as it is where that is possible.
    pub(super) fn local(&mut self, wanted: &str) -> String {
        self.fresh(&identifier(wanted).to_lowercase())
    }

    /// A constant of its own for `wanted`.
    pub(super) fn constant(&mut self, wanted: &str) -> String {
        self.fresh(&identifier(wanted).to_uppercase())
    }

    fn fresh(&mut self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        let mut number = 2;
        while !self.taken.insert(name.clone()) {
            name = format!("{wanted}_{number}");
            number += 1;
        }
        name
    }
}

/// `text` with everything that cannot stand in an identifier as `_`.
fn identifier(text: &str) -> String {
    let mut name: String = text.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        name.insert(0, 'x');
    }
    name
}

/// The name of a robot as that of a struct: "myCobot 280 Pi" is `MyCobot280Pi`.
pub fn struct_name(robot: &str) -> String {
    let mut name = String::new();
    for word in robot.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty()) {
        let mut letters = word.chars();
        name.extend(letters.next().map(|c| c.to_ascii_uppercase()));
        // CRANE is Crane, as Rust writes acronyms; mixed case is the maker's own.
        let shouted = word.len() > 3 && !word.chars().any(|c| c.is_ascii_lowercase());
        name.extend(letters.map(|c| if shouted { c.to_ascii_lowercase() } else { c }));
    }
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        name.insert_str(0, "Robot");
    }
    // The one keyword that is written in upper camel case.
    if name == "Self" { "SelfRobot".to_owned() } else { name }
}

/// The name of an inverse problem as part of a function's name: as it is, since the model has checked it.
pub(super) fn function_suffix(problem: &str) -> String {
    problem.to_owned()
}

#[cfg(test)]
mod tests {
    use super::{Names, struct_name};

    #[test]
    fn names_are_given_once() {
        let mut names = Names::new(["D1"]);
        assert_eq!(names.local("s234"), "s234");
        assert_eq!(names.local("s234"), "s234_2");
        assert_eq!(names.local("q"), "q_2");
        assert_eq!(names.local("in"), "in_2");
        assert_eq!(names.local("theta2+theta3"), "theta2_theta3");
        assert_eq!(names.constant("d1"), "D1_2");
        assert_eq!(names.local("1/2"), "x1_2");
    }

    #[test]
    fn structs_are_named_after_the_robot() {
        assert_eq!(struct_name("myCobot 280 Pi"), "MyCobot280Pi");
        assert_eq!(struct_name("CRANE-X7"), "CraneX7");
        assert_eq!(struct_name("UR5e"), "UR5e");
        assert_eq!(struct_name("4-axis \u{e9}"), "Robot4Axis");
        assert_eq!(struct_name("self"), "SelfRobot");
    }
}
