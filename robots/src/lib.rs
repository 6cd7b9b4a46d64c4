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
    "baxter",
    "crane_x7",
    "crane_x7_2r",
    "crx10ia_l",
    "cylindrical",
    "elbow3r",
    "fr3",
    "gantry",
    "gen3",
    "gen3_lite",
    "gofa5",
    "gp7",
    "hc10",
    "iiwa14",
    "iiwa7",
    "irb120",
    "irb6640",
    "jaco2",
    "kr10_r1100",
    "kr6_r900",
    "lite6",
    "lrmate200id",
    "m0609",
    "m10ia",
    "manocha_canny",
    "mycobot",
    "panda",
    "planar2r",
    "puma560",
    "rh6frh5520",
    "rizon4",
    "rtm2r",
    "rv4fr",
    "sawyer",
    "scara",
    "sia20d",
    "stanford",
    "tm5_900",
    "tx2_60",
    "uarm_swift_pro",
    "ur10",
    "ur10e",
    "ur16e",
    "ur3e",
    "ur5",
    "ur5e",
    "vs068",
    "vx300s",
    "wx250",
    "xarm5",
    "xarm6",
    "xarm7",
);

/// The text of the table shipped under `name` (its file name without `.toml`).
pub fn table(name: &str) -> Option<&'static str> {
    TABLES.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// The names of all shipped tables, in alphabetical order.
pub fn names() -> impl Iterator<Item = &'static str> {
    TABLES.iter().map(|(name, _)| *name)
}
