//! The published examples of the myCobot 280 Pi, computed by generated code, beside the published figures.

use dh_runtime::{Bound, IkError, Point3, Rule, Side, Violation, Violations, dh_robot};

#[dh_robot("mycobot")]
struct MyCobot;

/// Joint angles (deg), and the position of the tool point published for them (mm).
const POSITIONS: [([f64; 6], [f64; 3]); 6] = [
    ([-12.08, -51.17, -123.8, 84.96, 0.0, -12.08], [149.987_075_21, -99.993_093_32, 69.979_032_52]),
    ([-34.7, -63.36, -119.18, 92.54, 0.0, -34.7], [100.001_540_38, -149.996_622_36, 49.995_824_56]),
    ([26.27, -26.46, -146.28, 82.74, 0.0, 26.27], [149.995_606, -0.001_879_348_29, 100.004_76]),
    ([55.3, -51.17, -123.8, 84.96, 0.0, 55.3], [149.988_889_22, 99.990_372_3, 69.979_032_52]),
    ([77.92, -63.36, -119.18, 92.54, 0.0, 77.92], [99.995_936_16, 150.000_358_5, 49.995_824_56]),
    ([63.24, -41.72, -103.45, 55.17, 0.0, 63.24], [149.996_876_37, 150.009_158_32, 100.001_588_33]),
];

/// Positions (mm) of the tool pointing down, and the joint angles of the arm's elbow-up solution (deg), from the
/// corrected equations of the publication.
const TOOL_DOWN: [([f64; 3], [f64; 6]); 9] = [
    (
        [150.0, -100.0, 70.0],
        tool_down(
            -12.081_384_092_329_47,
            -51.165_343_861_772_01,
            -123.796_446_278_398_3,
            84.961_790_140_170_31,
        ),
    ),
    (
        [100.0, -150.0, 50.0],
        tool_down(
            -34.701_249_040_369_895,
            -63.357_465_078_608_8,
            -119.179_969_660_004_5,
            92.537_434_738_613_31,
        ),
    ),
    (
        [150.0, -100.0, 50.0],
        tool_down(
            -12.081_384_092_329_47,
            -63.357_465_078_608_8,
            -119.179_969_660_004_5,
            92.537_434_738_613_31,
        ),
    ),
    (
        [150.0, -100.0, 150.0],
        tool_down(
            -12.081_384_092_329_47,
            -8.424_337_863_634_85,
            -116.974_060_523_944_12,
            35.398_398_387_578_97,
        ),
    ),
    (
        [100.0, -150.0, 150.0],
        tool_down(
            -34.701_249_040_369_895,
            -8.424_337_863_634_85,
            -116.974_060_523_944_12,
            35.398_398_387_578_97,
        ),
    ),
    (
        [100.0, 150.0, 50.0],
        tool_down(
            77.918_615_907_670_53,
            -63.357_465_078_608_8,
            -119.179_969_660_004_5,
            92.537_434_738_613_31,
        ),
    ),
    (
        [150.0, 100.0, 70.0],
        tool_down(
            55.298_750_959_630_105,
            -51.165_343_861_772_01,
            -123.796_446_278_398_3,
            84.961_790_140_170_31,
        ),
    ),
    (
        [150.0, 0.0, 100.0],
        tool_down(
            26.269_889_403_430_13,
            -26.464_993_338_649_045,
            -146.277_240_596_257_54,
            82.742_233_934_906_6,
        ),
    ),
    (
        [150.0, 150.0, 100.0],
        tool_down(
            63.238_034_160_143_37,
            -41.719_326_409_615_73,
            -103.453_236_021_240_83,
            55.172_562_430_856_544,
        ),
    ),
];

/// Joint angles (deg) that the publication refuses: below the floor, and twice outside the limits.
const REFUSED: [[f64; 6]; 3] = [
    [63.24, -85.92, -83.17, 79.09, 0.0, 63.24],
    [145.3, -63.36, -119.18, 92.54, 0.0, 145.3],
    [41.6, -118.04, -155.24, 183.28, 0.0, 41.6],
];

/// Positions (mm) without a solution: on the first axis, and too far away.
const WITHOUT_SOLUTION: [[f64; 3]; 2] = [[0.0, 0.0, 100.0], [1000.0, 1000.0, 100.0]];

/// Joint angles with the forearm held as the constraints of `tool_down` say: joint 5 at 0, joint 6 as joint 1.
const fn tool_down(j1: f64, j2: f64, j3: f64, j4: f64) -> [f64; 6] {
    [j1, j2, j3, j4, 0.0, j1]
}

fn main() -> Result<(), IkError> {
    let arm = MyCobot;

    println!("1. Joint angles (deg) to the position of the tool point (mm)\n");
    println!("{} | {}", names(&["J1", "J2", "J3", "J4", "J5", "J6"], 8), names(&["x", "y", "z"], 15));
    for (joints, published) in POSITIONS {
        let tool = arm.fk(&joints.map(f64::to_radians)).translation;
        let computed = [tool.x, tool.y, tool.z].map(|x| x * 1000.0);
        let off = difference(&computed, &published);
        println!("{} | {}", numbers(&joints, 8, 2), numbers(&computed, 15, 8));
        println!("{:>48} | {}", format!("published, off by {off:.1e}"), numbers(&published, 15, 8));
    }

    println!("\n2. Position (mm) with the tool down to joint angles (deg)\n");
    println!("{} | {}", names(&["x", "y", "z"], 7), names(&["J1", "J2", "J3", "J4", "J5", "J6"], 16));
    for (position, known) in TOOL_DOWN {
        for solution in &arm.ik_tool_down_elbow_up(&point(position))? {
            let computed = solution.q.map(f64::to_degrees);
            let off = difference(&computed, &known);
            println!("{} | {}", numbers(&position, 7, 0), numbers(&computed, 16, 10));
            println!("{:>21} | {}", format!("known, off by {off:.1e}"), numbers(&known, 16, 10));
        }
    }

    println!("\n3. Joint angles (deg) that are refused, with everything that they break\n");
    for joints in REFUSED {
        let mut asked = numbers(&joints, 8, 2);
        for violation in arm.check(&joints.map(f64::to_radians)).err().iter().flat_map(Violations::iter) {
            println!("{asked:>48} | {}", in_table_units(&violation));
            asked.clear();
        }
    }

    println!("\n4. Positions (mm) without a solution, with the error that says why\n");
    for position in WITHOUT_SOLUTION {
        if let Err(error) = arm.ik_tool_down_elbow_up(&point(position)) {
            println!("{} | {error}", numbers(&position, 7, 0));
            println!("{:>21} | {error:?}", "");
        }
    }
    Ok(())
}

/// A position (mm) as the arm takes it (m).
fn point(position: [f64; 3]) -> Point3<f64> {
    Point3::from(position.map(|x| x / 1000.0))
}

/// The greatest of the differences of two lists.
fn difference(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(left, right)| (left - right).abs()).fold(0.0, f64::max)
}

/// A broken rule, in millimetres and degrees.
fn in_table_units(violation: &Violation<'_>) -> String {
    match *violation {
        Violation::OutsideLimits { name, value, min, max, .. } => {
            let [value, min, max] = [value, min, max].map(f64::to_degrees);
            format!("{name} is at {value:.2}, not in {min:.0} to {max:.0}")
        }
        Violation::Forbidden(Rule::Bound { bound: Bound { axis, side, value: bound }, value }) => {
            let relation = if side == Side::Min { "below" } else { "above" };
            format!("{axis} is {:.6}, {relation} {:.0}", value * 1000.0, bound * 1000.0)
        }
        other => other.to_string(),
    }
}

/// Numbers in columns.
fn numbers(values: &[f64], width: usize, digits: usize) -> String {
    // Adding 0 makes -0 a 0.
    row(values.iter().map(|value| format!("{:.digits$}", value + 0.0)), width)
}

/// Their headings.
fn names(names: &[&str], width: usize) -> String {
    row(names.iter().map(|name| (*name).to_owned()), width)
}

/// Words in columns.
fn row(words: impl Iterator<Item = String>, width: usize) -> String {
    words.fold(String::new(), |row, word| row + &format!("{word:>width$}"))
}
