//! The full pose of arms drawn at random, class by class, there and back against the oracle: every pose that joint values
//! give has solutions that meet it, on the lattice of eighths of a turn too, and those joint values are among them wherever
//! the arm is not singular.

use dh_core::{FULL_POSE, Frame, Kinematics, SolutionSet, Target};
use dh_tests::engine;
use dh_tests::oracle::Oracle;
use std::f64::consts::{FRAC_PI_4, PI};

/// The same numbers on every run.
struct Random(u64);

impl Random {
    /// In 0 ... 1.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((self.0 >> 40) as u32) / f64::from(1_u32 << 24)
    }

    fn sign(&mut self) -> f64 {
        if self.unit() < 0.5 { -1.0 } else { 1.0 }
    }

    /// m
    fn length(&mut self) -> f64 {
        (0.1 + 0.5 * self.unit()) * self.sign()
    }

    /// A quarter turn either way, or any twist (deg).
    fn twist(&mut self, skew: bool) -> f64 {
        self.sign() * if skew { 30.0 + 120.0 * self.unit() } else { 90.0 }
    }
}

/// One row: `L` is a length, `T` a twist, 0 nothing, in the order a, alpha, d; `P` before them a sliding row; `-` a
/// reversed one; `C` one that follows the row before it.
const CLASSES: &[(&str, &str, bool)] = &[
    ("spherical wrist, parallel shoulder", "LTL L0L LTL 0TL 0T0 00L", false),
    ("spherical wrist, skew twists", "LTL L0L LTL 0TL 0T0 00L", true),
    ("spherical wrist, first axes meet", "0TL LTL LTL 0TL 0T0 LTL", false),
    ("spherical shoulder", "0TL 0T0 LTL L0L LTL 00L", false),
    ("spherical shoulder, skew twists", "0TL 0T0 LTL L0L LTL 00L", true),
    ("three parallel axes, the wrist's meet", "0TL L0L L0L 0TL 0TL 00L", false),
    ("reversed and coupled rows", "LTL -L0L CLTL -0TL 0T0 C0TL", false),
    ("slides before a spherical wrist", "LTL LTL P0T 0TL 0T0 LTL", false),
    ("a slide below a spherical wrist", "PLT LTL LTL 0TL 0T0 LTL", false),
    ("four joints of a gripper on slides", "L0L L0L P0T 00L", false),
];

fn table(rows: &str, skew: bool, random: &mut Random) -> String {
    let mut text = String::from(
        "[robot]\nname = \"Drawn\"\nconvention = \"standard\"\nunits = { length = \"m\", angle = \"deg\" }\n",
    );
    for (index, row) in rows.split(' ').enumerate() {
        text += "\n[[joint]]\n";
        let mut keys = if row.contains('P') { ["a", "alpha", ""] } else { ["a", "alpha", "d"] }.into_iter();
        for letter in row.chars() {
            match letter {
                'P' => text += "type = \"prismatic\"\n",
                '-' => text += "direction = -1\n",
                'C' => text.extend(["couple = { J", &index.to_string(), " = -1 }\n"]),
                _ => {
                    let Some(key) = keys.next() else { continue };
                    let value = match letter {
                        'L' => random.length(),
                        'T' => random.twist(skew),
                        _ => 0.0,
                    };
                    text.extend([key, " = ", &value.to_string(), "\n"]);
                }
            }
        }
    }
    let [x, y, z] = [0; 3].map(|_| random.length());
    text + &format!("\n[tool]\nxyz = [{x}, {y}, {z}]\nrpy = [0, 90, {}]\n", random.twist(true))
}

fn frame_of(pose: &[[f64; 4]; 4]) -> Frame {
    let [x, y, z, _] = *pose;
    let rows = [x, y, z].map(|[a, b, c, p]| ([a, b, c], p));
    Frame { rotation: rows.map(|row| row.0), translation: rows.map(|row| row.1) }
}

/// Solves for the pose at `q`; says what is wrong, else how far the nearest solution is.
fn there_and_back(arm: &dyn Kinematics, oracle: &Oracle, q: &[f64]) -> Result<f64, String> {
    let pose = oracle.fk(q);
    let mut set = SolutionSet::new();
    arm.ik_into(FULL_POSE, &Target::Pose(frame_of(&pose)), &mut set).map_err(|error| error.to_string())?;
    let chain = oracle.chain();
    let mut nearest = f64::INFINITY;
    for solution in set.iter() {
        let found = oracle.fk(solution.q);
        let off = found.iter().flatten().zip(pose.iter().flatten()).map(|(a, b)| (a - b).abs());
        let off = off.fold(0.0, f64::max);
        if off > 2e-11 {
            return Err(format!("{:?} misses by {off:e}", solution.q));
        }
        let joints = solution.q.iter().zip(q).zip(&chain.joints);
        let apart = joints.map(|((a, b), row)| {
            let turns = !chain.rows[*row].prismatic;
            if turns { ((a - b + PI).rem_euclid(2.0 * PI) - PI).abs() } else { (a - b).abs() }
        });
        nearest = nearest.min(apart.fold(0.0, f64::max));
    }
    Ok(nearest)
}

#[test]
fn every_pose_has_its_solutions() {
    let mut random = Random(20_240_607);
    for (class, rows, skew) in CLASSES {
        for modified in [false, true] {
            // A modified row's length and twist are those before its joint: the first ones are the base's.
            let text = table(rows, *skew, &mut random);
            let text = if modified { modified_rows(&text) } else { text };
            let oracle = Oracle::read(&text).unwrap();
            let arm = engine::interpreter(&text).unwrap();
            assert!(arm.problems().iter().any(|problem| problem.name == FULL_POSE), "{class}\n{text}");
            let slides: Vec<bool> =
                oracle.chain().joints.iter().map(|&row| oracle.chain().rows[row].prismatic).collect();
            for number in 0..60 {
                let q: Vec<f64> = slides
                    .iter()
                    .map(|slides| match (slides, number % 3) {
                        (true, _) => random.unit() - 0.5,
                        (false, 0) => PI * (2.0 * random.unit() - 1.0),
                        (false, 1) => FRAC_PI_4 * (8.0 * random.unit()).floor(),
                        _ => 2.0 * FRAC_PI_4 * (4.0 * random.unit()).floor() + 1e-7 * (random.unit() - 0.5),
                    })
                    .collect();
                let nearest = there_and_back(&*arm, &oracle, &q);
                let nearest = nearest.unwrap_or_else(|error| panic!("{class} at {q:?}: {error}\n{text}"));
                assert!(number % 3 != 0 || nearest < 1e-7, "{class} at {q:?}: {nearest:e}\n{text}");
            }
        }
    }
}

/// The same arm in the other convention: what follows a joint moves to the row after it, and the last row's to the tool's
/// place, which is drawn anew anyway.
fn modified_rows(text: &str) -> String {
    let mut blocks: Vec<String> = text.split("\n[[joint]]\n").map(str::to_owned).collect();
    let (mut a, mut alpha) = ("a = 0".to_owned(), "alpha = 0".to_owned());
    for block in blocks.iter_mut().skip(1) {
        let mut lines: Vec<String> = block.lines().map(str::to_owned).collect();
        for line in &mut lines {
            if line.starts_with("a =") {
                std::mem::swap(line, &mut a);
            } else if line.starts_with("alpha =") {
                std::mem::swap(line, &mut alpha);
            }
        }
        *block = lines.join("\n") + "\n";
    }
    blocks.join("\n[[joint]]\n").replace("\"standard\"", "\"modified\"")
}
