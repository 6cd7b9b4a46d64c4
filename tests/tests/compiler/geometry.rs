//! How joint axes lie to each other, against axes found from nothing but poses.
//!
//! A joint turned by half a turn turns the tool about the joint's axis: from the two poses alone, by the oracle, come
//! the direction of that axis and its point nearest to the origin. What holds of the axes at several drawn joint
//! values holds always.

#![expect(clippy::unwrap_used, reason = "a test")]

use dh_codegen::diagnostic::Diagnostics;
use dh_codegen::model::geometry::{EXACT, NEARLY_MEETING, NEARLY_PARALLEL, RelationKind};
use dh_codegen::model::product::frames;
use dh_codegen::model::{JointKind, Model};
use dh_codegen::{model, table};
use dh_tests::near;
use dh_tests::oracle::Oracle;
use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::fmt::Write;

/// Numbers in -1 ... 1, the same on every run.
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((self.0 >> 40) as u32) / f64::from(1_u32 << 23) - 1.0
    }

    fn of<T: Copy>(&mut self, list: &[T]) -> T {
        list[((f64::midpoint(self.next(), 1.0) * list.len() as f64) as usize).min(list.len() - 1)]
    }
}

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross([ax, ay, az]: Vector, [bx, by, bz]: Vector) -> Vector {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

fn minus([ax, ay, az]: Vector, [bx, by, bz]: Vector) -> Vector {
    [ax - bx, ay - by, az - bz]
}

fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// Direction and a point of each joint's axis at `q`.
fn axes(oracle: &Oracle, q: &[f64]) -> Vec<(Vector, Vector)> {
    let before = oracle.fk(q);
    let chain = oracle.chain();
    let moved = |joint: usize, by: f64| {
        let mut q = q.to_vec();
        q[joint] += by;
        oracle.fk(&q)
    };
    let column = |pose: &[[f64; 4]; 4], j: usize| [pose[0][j], pose[1][j], pose[2][j]];
    (0..q.len())
        .map(|joint| {
            if chain.rows[chain.joints[joint]].prismatic {
                let along = minus(column(&moved(joint, 1.0), 3), column(&before, 3));
                return (along, [0.0; 3]);
            }
            // R = after before^T = 2 z z^T - 1; its translation is twice the point nearest to the origin.
            let after = moved(joint, PI);
            let r = |i: usize, j: usize| (0..3).map(|k| after[i][k] * before[j][k]).sum::<f64>();
            let squares = [0, 1, 2].map(|i| f64::midpoint(r(i, i), 1.0));
            let largest = (0..3).max_by(|a, b| squares[*a].total_cmp(&squares[*b])).unwrap();
            let z = [0, 1, 2].map(|i| {
                let entry = if i == largest { f64::midpoint(r(i, i), 1.0) } else { r(i, largest) / 2.0 };
                entry / squares[largest].sqrt()
            });
            let point = [0, 1, 2].map(|i| {
                let turned: f64 = (0..3).map(|j| r(i, j) * before[j][3]).sum();
                (after[i][3] - turned) / 2.0
            });
            (z, point)
        })
        .collect()
}

/// By how much two lines are off parallel (rad), and how far apart they are (m).
fn apart((one, at): (Vector, Vector), (other, there): (Vector, Vector)) -> (f64, f64) {
    let normal = cross(one, other);
    let tilt = length(normal).atan2(dot(one, other).abs());
    let step = minus(there, at);
    if tilt < NEARLY_PARALLEL {
        return (tilt, length(cross(one, step)));
    }
    (tilt, dot(step, normal).abs() / length(normal))
}

/// The point of the second line nearest to the first.
fn foot((one, at): (Vector, Vector), (other, there): (Vector, Vector)) -> Vector {
    let normal = cross(one, other);
    let along = dot(cross(minus(at, there), one), cross(other, one)) / dot(normal, normal);
    [there[0] + along * other[0], there[1] + along * other[1], there[2] + along * other[2]]
}

type Found = BTreeSet<(String, Vec<usize>)>;

/// Relations that hold to within `angle` and `distance` at every one of a few drawn poses.
fn seen(oracle: &Oracle, angle: f64, distance: f64) -> Found {
    let mut draw = Draw(7);
    let count = oracle.dof();
    let chain = oracle.chain();
    let turns = |i: usize| !chain.rows[chain.joints[i]].prismatic;
    let mut all: Option<Found> = None;
    for _ in 0..4 {
        let q: Vec<f64> = (0..count).map(|_| 3.0 * draw.next()).collect();
        let lines = axes(oracle, &q);
        let mut found = Found::new();
        for i in 0..count.saturating_sub(1) {
            let (tilt, off) = apart(lines[i], lines[i + 1]);
            if tilt <= angle {
                found.insert(("Parallel".to_owned(), vec![i, i + 1]));
            }
            if turns(i) && turns(i + 1) && off <= distance {
                let kind = if tilt <= angle { "Coincident" } else { "Meet" };
                found.insert((kind.to_owned(), vec![i, i + 1]));
            }
            if i + 2 < count && (i..i + 3).all(turns) {
                let (other_tilt, other_off) = apart(lines[i + 1], lines[i + 2]);
                let feet = minus(foot(lines[i], lines[i + 1]), foot(lines[i + 2], lines[i + 1]));
                let skew = tilt > NEARLY_PARALLEL && other_tilt > NEARLY_PARALLEL;
                if skew && off.max(other_off).max(length(feet)) <= distance {
                    found.insert(("Spherical".to_owned(), vec![i, i + 1, i + 2]));
                }
            }
            // Across slides in other directions.
            let slides = (i + 1..count).take_while(|k| !turns(*k)).count();
            for k in i + 2..=(i + 1 + slides).min(count - 1) {
                let others = (i..k).all(|j| apart(lines[j], lines[j + 1]).0 > angle);
                if others && apart(lines[i], lines[k]).0 <= angle {
                    found.insert(("Parallel".to_owned(), vec![i, k]));
                    break;
                }
            }
        }
        all = Some(match all {
            Some(before) => before.intersection(&found).cloned().collect(),
            None => found,
        });
    }
    all.unwrap_or_default()
}

fn model(text: &str) -> Model {
    let mut diagnostics = Diagnostics::new();
    let table = table::parse(text, &mut diagnostics);
    model::check(&table, &mut diagnostics).unwrap()
}

fn named(kind: RelationKind) -> String {
    format!("{kind:?}")
}

/// What the compiler finds exact, and what it finds exact or near.
fn told(model: &Model) -> (Found, Found) {
    let geometry = model.geometry();
    let of = |exact: bool| {
        let relations = geometry.relations.iter().filter(|relation| relation.exact || !exact);
        relations.map(|relation| (named(relation.kind), relation.axes.clone())).collect()
    };
    (of(true), of(false))
}

#[test]
fn relations_of_shipped_arms_are_those_of_their_poses() {
    let mut relations = 0;
    for name in dh_robots::names() {
        let oracle = Oracle::shipped(name).unwrap();
        let model = model(dh_robots::table(name).unwrap());
        // Of coupled arms several axes turn at once.
        if model.rows.iter().any(|row| row.terms.len() > 1) {
            continue;
        }
        // What the poses tell is good to 1e-14 or so.
        let (exact, _) = told(&model);
        assert_eq!(exact, seen(&oracle, 1e-11, 1e-11), "{name}");
        relations += exact.len();
    }
    assert!(relations > 200, "{relations}");
}

/// A table of drawn rows, special ones mostly.
fn drawn(draw: &mut Draw) -> String {
    let convention = draw.of(&["standard", "modified"]);
    let mut text = format!(
        "[robot]\nname = \"d\"\nconvention = \"{convention}\"\nunits = {{ length = \"m\", angle = \"deg\" }}\n\
         [base]\nxyz = [0.1, 0.2, 0.3]\nrpy = [10, 20, 30]\n[tool]\nxyz = [0.1, 0, 0.05]\n"
    );
    for _ in 0..2 + (draw.next().abs() * 6.0) as usize {
        let alpha = draw.of(&[0.0, 90.0, -90.0, 180.0, 60.0, 37.3, 0.0, 90.0]);
        let a = draw.of(&[0.0, 0.0, 0.2, -0.31]);
        writeln!(text, "[[joint]]\nalpha = {alpha}\na = {a}").unwrap();
        let (length, angle) = (draw.of(&[0.0, 0.0, 0.17]), draw.of(&[0.0, 90.0, 41.0]));
        if draw.next() > 0.6 {
            writeln!(text, "type = \"prismatic\"\ntheta = {angle}\noffset = {length}").unwrap();
        } else {
            writeln!(text, "d = {length}\noffset = {angle}").unwrap();
        }
        if draw.next() > 0.8 {
            writeln!(text, "direction = -1").unwrap();
        }
    }
    text
}

#[test]
fn relations_of_drawn_arms_are_those_of_their_poses() {
    let mut draw = Draw(11);
    let mut kinds = BTreeSet::new();
    for _ in 0..150 {
        let text = drawn(&mut draw);
        let (exact, near) = told(&model(&text));
        assert_eq!(exact, seen(&Oracle::read(&text).unwrap(), 1e-11, 1e-11), "{text}");
        assert_eq!(exact, near, "{text}");
        kinds.extend(exact.into_iter().map(|(kind, axes)| (kind, axes.len(), axes[1] - axes[0])));
    }
    // Every kind, and parallels across a slide, came up.
    assert!(kinds.len() >= 5, "{kinds:?}");
}

/// The common normals and axes themselves, of arms that are in no special position.
#[test]
fn axes_and_normals_are_those_of_the_poses() {
    for name in ["jaco2", "baxter", "stanford", "fr3", "vx300s", "kr6_r900"] {
        let oracle = Oracle::shipped(name).unwrap();
        let geometry = model(dh_robots::table(name).unwrap()).geometry();
        let lines = axes(&oracle, &vec![0.0; oracle.dof()]);
        for (axis, (direction, point)) in geometry.axes.iter().zip(&lines) {
            assert!(length(cross(axis.direction, *direction)) < 1e-12, "{name}");
            if axis.kind == JointKind::Revolute {
                let off = cross(minus(axis.point, *point), axis.direction);
                assert!(length(off) < 1e-12, "{name}: {off:?}");
            }
        }
        for (i, normal) in geometry.normals.iter().enumerate() {
            let (tilt, off) = apart(lines[i], lines[i + 1]);
            assert!((normal.tilt() - tilt).abs() < 1e-12, "{name}, {i}");
            if geometry.axes[i].kind == geometry.axes[i + 1].kind {
                assert!((normal.distance - off).abs() < 1e-12, "{name}, {i}: {normal:?}, {off}");
            }
        }
    }
}

/// A nearly special arm is told for what it is, by as much as its poses show, and its neighbour is of the class that
/// was meant and close by.
#[test]
fn nearly_special_arms_have_the_neighbour_that_was_meant() {
    for (name, text, meant) in near::TABLES {
        let oracle = Oracle::read(text).unwrap();
        let arm = model(text);
        let reach = arm.reach();
        let (_, near) = told(&arm);
        assert_eq!(near, seen(&oracle, NEARLY_PARALLEL, NEARLY_MEETING * reach), "{name}");
        let lines = axes(&oracle, &vec![0.4; oracle.dof()]);
        for relation in arm.geometry().near().filter(|relation| relation.kind == RelationKind::Parallel) {
            let (tilt, _) = apart(lines[relation.axes[0]], lines[relation.axes[1]]);
            assert!((relation.off - tilt).abs() < 1e-12 && relation.off > EXACT, "{name}: {relation:?}");
            assert!(!relation.numbers.is_empty(), "{name}: {relation:?}");
        }

        let nominal = arm.nominal().unwrap_or_else(|| panic!("{name} has no neighbour"));
        let exact = model(dh_robots::table(meant).unwrap()).geometry();
        assert_eq!(nominal.geometry.class(), exact.class(), "{name}");
        assert_eq!(nominal.geometry.near().count(), 0, "{name}");
        // What was changed is small, and so is what it does to a pose.
        let off = arm.geometry().near().fold(0.0_f64, |off, relation| {
            let by =
                if relation.kind == RelationKind::Parallel { relation.off * reach } else { relation.off };
            off + by
        });
        let mut draw = Draw(3);
        for _ in 0..50 {
            let q: Vec<f64> = (0..oracle.dof()).map(|_| PI * draw.next()).collect();
            let (pose, neighbour) = (oracle.fk(&q), frames(&nominal.model, &q).tool);
            for (row, other) in pose.iter().zip(neighbour) {
                for (a, b) in row.iter().zip(other) {
                    assert!((a - b).abs() < 4.0 * off / reach.min(1.0), "{name}: {a} {b} at {q:?}, {off}");
                }
            }
        }
    }
    // What is exact needs no other.
    for name in ["ur5", "puma560", "iiwa14", "jaco2", "manocha_canny"] {
        assert!(model(dh_robots::table(name).unwrap()).nominal().is_none(), "{name}");
    }
}
