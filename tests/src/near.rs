//! Nearly special arms (`near/`): calibrated, rounded, off by the tolerances of a robot description.

/// (name, text of the table, name of the shipped arm that it nearly is)
pub const TABLES: &[(&str, &str, &str)] = &[
    ("iiwa14_offset", include_str!("../near/iiwa14_offset.toml"), "iiwa14"),
    ("puma560_rounded", include_str!("../near/puma560_rounded.toml"), "puma560"),
    ("ur5_calibrated", include_str!("../near/ur5_calibrated.toml"), "ur5"),
    ("ur5_tilted", include_str!("../near/ur5_tilted.toml"), "ur5"),
    ("ur5_kilometres", include_str!("../near/ur5_kilometres.toml"), "ur5"),
];
