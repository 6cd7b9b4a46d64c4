//! The worked examples of `cases/`: JSON files of numbers computed apart from this project, beside published ones.

use serde_json::Value;

macro_rules! cases {
    ($($(#[$doc:meta])* $name:ident = $file:literal),* $(,)?) => {
        $(
            $(#[$doc])*
            ///
            /// # Panics
            /// The file is not JSON.
            pub fn $name() -> Value {
                parse(include_str!(concat!("../cases/", $file)))
            }
        )*
    };
}

cases! {
    /// Six-axis myCobot 280 Pi: published positions, refused poses, positions solved with the tool down.
    mycobot = "mycobot280.json",
    /// Two-link planar arm: both elbows, unreachable and singular targets.
    planar2r = "planar2r.json",
    /// The same with joint 1 measured from the y axis.
    rtm2r = "rtm2r.json",
    /// CRANE-X7 with two moving joints: the corners of a square.
    crane_x7_2r = "crane_x7_2r.json",
    /// CRANE-X7 with seven joints.
    crane_x7 = "crane_x7.json",
    /// Six-axis arm of VS-068 dimensions.
    vs068 = "vs068.json",
}

#[expect(clippy::expect_used, reason = "a broken case is a broken test")]
fn parse(text: &str) -> Value {
    serde_json::from_str(text).expect("the case is JSON")
}

/// An array of numbers.
///
/// # Panics
/// It is something else.
#[expect(clippy::expect_used, reason = "a broken case is a broken test")]
pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("an array").iter().map(|x| x.as_f64().expect("a number")).collect()
}

/// The elements of an array.
///
/// # Panics
/// It is something else.
#[expect(clippy::expect_used, reason = "a broken case is a broken test")]
pub fn elements(value: &Value) -> &[Value] {
    value.as_array().expect("an array")
}

/// Degrees to radians.
pub fn radians(degrees: &[f64]) -> Vec<f64> {
    degrees.iter().map(|x| x.to_radians()).collect()
}
