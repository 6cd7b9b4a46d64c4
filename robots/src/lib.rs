//! Denavit-Hartenberg tables of published arms, embedded by name.
//!
//! The tables are the TOML files beside this crate's `Cargo.toml`; `README.md` there is the reference of their format
//! and says which arm each one is.
//!
//! ```
//! let text = dh_robots::table("mycobot").expect("shipped");
//! assert!(text.contains("[[joint]]"));
//! assert!(dh_robots::names().any(|name| name == "mycobot"));
//! ```

#![no_std]

macro_rules! embed {
    ($($name:literal),* $(,)?) => {
        /// (name, text), in alphabetical order.
        const TABLES: &[(&str, &str)] = &[$(($name, include_str!(concat!("../", $name, ".toml")))),*];
    };
}

embed!(
    "crane_x7",
    "crane_x7_2r",
    "elbow3r",
    "mycobot",
    "panda",
    "planar2r",
    "puma560",
    "rtm2r",
    "scara",
    "uarm_swift_pro",
    "ur5",
    "ur5e",
    "vs068",
);

/// The text of the table shipped under `name` (its file name without `.toml`).
pub fn table(name: &str) -> Option<&'static str> {
    TABLES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// The names of all shipped tables, in alphabetical order.
pub fn names() -> impl Iterator<Item = &'static str> {
    TABLES.iter().map(|(name, _)| *name)
}
