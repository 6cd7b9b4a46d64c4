//! Branches: along a path that passes no singularity the label of its joint values stays, solutions of one target have
//! different ones.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test fails by panicking"
)]

use super::classes::{CLASSES, Random, modified_rows, table};
use dh_codegen::plan::eval::Program;
use dh_codegen::verify::Level;
use dh_core::{
    Branch, BranchWord, FULL_POSE, IkError, JointKind, Kinematics, ProblemInfo, SolutionSet, Target,
    TargetKind,
};
use dh_tests::engine;
use dh_tests::random::any_arm;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use std::cell::Cell;
use std::f64::consts::{PI, TAU};

/// The least singular value from which on joint values are away from singularities (m and rad in arms of 1 m).
const CLEAR: f64 = 0.03;

/// Length of a step of a path in joint space (rad or m): singular values change by less than [`CLEAR`] in it.
const STEP: f64 = 0.004;

/// A problem of an arm.
struct Case<'a> {
    arm: &'a dyn Kinematics,
    info: ProblemInfo<'a>,
    /// Rows of the constraints: coefficients, then the constant.
    constraints: Vec<Vec<f64>>,
    reach: f64,
    /// How many solutions a branch has at most.
    most: usize,
}

impl<'a> Case<'a> {
    fn new(arm: &'a dyn Kinematics, info: ProblemInfo<'a>) -> Self {
        let dof = arm.dof();
        let mut constraints: Vec<Vec<f64>> = Vec::new();
        for term in info.constraints {
            while constraints.len() <= term.equation {
                constraints.push(vec![0.0; dof + 1]);
            }
            constraints[term.equation][term.joint.unwrap_or(dof)] += term.coefficient;
        }
        let mut reach: f64 = 0.0;
        let mut random = Random(1);
        for _ in 0..20 {
            let q: Vec<f64> = (0..dof).map(|_| PI * random.symmetric()).collect();
            let [x, y, z] = arm.fk(&q).unwrap().translation;
            reach = reach.max((x * x + y * y + z * z).sqrt());
        }
        Self { arm, info, constraints, reach: if reach > 1e-3 { reach } else { 1.0 }, most: 1 }
    }

    /// Joint values that keep the constraints, and the nearest ones that do where these don't.
    fn projected(&self, q: &[f64]) -> Vec<f64> {
        let mut q = q.to_vec();
        let dof = q.len();
        // Kaczmarz: one equation after the other.
        for _ in 0..400 {
            for row in &self.constraints {
                let off: f64 = row[..dof].iter().zip(&q).map(|(a, x)| a * x).sum::<f64>() + row[dof];
                let square: f64 = row[..dof].iter().map(|a| a * a).sum();
                q.iter_mut().zip(row).for_each(|(x, a)| *x -= off / square * a);
            }
        }
        q
    }

    fn random(&self, random: &mut Random) -> Vec<f64> {
        let value = |joint: &dh_core::Joint<'_>, x: f64| match (joint.kind, joint.limits) {
            (JointKind::Prismatic, Some(limits)) => {
                limits.min + f64::midpoint(x, 1.0) * (limits.max - limits.min)
            }
            (JointKind::Prismatic, None) => x * self.reach,
            _ => PI * x,
        };
        let q: Vec<f64> = self.arm.joints().iter().map(|joint| value(joint, random.symmetric())).collect();
        self.projected(&q)
    }

    /// What the target of joint values prescribes, as numbers of which none stays the same where the tool moves in it.
    fn numbers(&self, q: &[f64], around: &Target) -> Vec<f64> {
        let tool = self.arm.fk(q).unwrap();
        let [px, py, pz] = tool.translation.map(|x| x / self.reach);
        let [zx, zy, zz] = tool.z_axis();
        match (self.info.target, around) {
            (TargetKind::Ray, _) => {
                let along = px * zx + py * zy + pz * zz;
                vec![px - along * zx, py - along * zy, pz - along * zz, zx, zy, zz]
            }
            (_, Target::Lookat([x, y, z])) => {
                let [x, y, z] = [x / self.reach - px, y / self.reach - py, z / self.reach - pz];
                vec![y * zz - z * zy, z * zx - x * zz, x * zy - y * zx]
            }
            (kind, _) => {
                let target = Target::of_frame(kind, &tool).numbers();
                let lengths = match kind {
                    TargetKind::Pose => vec![3, 7, 11],
                    TargetKind::Rotation | TargetKind::Direction => vec![],
                    TargetKind::Xy | TargetKind::XyYaw => vec![0, 1],
                    _ => vec![0, 1, 2],
                };
                target
                    .iter()
                    .enumerate()
                    .map(|(place, x)| if lengths.contains(&place) { x / self.reach } else { *x })
                    .collect()
            }
        }
    }

    /// The least singular value of the Jacobian of what is prescribed by the joints that the problem solves for.
    fn singular_value(&self, q: &[f64]) -> f64 {
        let target = self.target(q);
        // Directions: those that keep the constraints and what is given.
        let dof = q.len();
        let mut fixed: Vec<Vec<f64>> = self.constraints.iter().map(|row| row[..dof].to_vec()).collect();
        fixed.extend(
            self.info.free.iter().map(|&joint| (0..dof).map(|k| f64::from(u8::from(k == joint))).collect()),
        );
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let mut kept = 0;
        for (index, vector) in fixed
            .into_iter()
            .chain((0..dof).map(|joint| (0..dof).map(|k| f64::from(u8::from(k == joint))).collect()))
            .enumerate()
        {
            let mut vector: Vec<f64> = vector;
            for _ in 0..2 {
                for other in &basis {
                    let along: f64 = vector.iter().zip(other).map(|(a, b)| a * b).sum();
                    vector.iter_mut().zip(other).for_each(|(a, b)| *a -= along * b);
                }
            }
            let size = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
            if size > 1e-3 {
                basis.push(vector.iter().map(|x| x / size).collect());
                if index < self.constraints.len() + self.info.free.len() {
                    kept = basis.len();
                }
            }
        }
        let columns: Vec<Vec<f64>> = basis[kept..]
            .iter()
            .map(|direction| {
                const H: f64 = 1e-5;
                let moved = |h: f64| -> Vec<f64> {
                    let slides = self.arm.joints().iter().map(|joint| joint.kind == JointKind::Prismatic);
                    let scale = slides.map(|slides| if slides { self.reach } else { 1.0 });
                    q.iter().zip(direction).zip(scale).map(|((x, d), scale)| x + h * d * scale).collect()
                };
                let (a, b) = (self.numbers(&moved(H), &target), self.numbers(&moved(-H), &target));
                a.iter().zip(&b).map(|(a, b)| (a - b) / (2.0 * H)).collect()
            })
            .collect();
        least_singular_value(&columns)
    }

    fn target(&self, q: &[f64]) -> Target {
        Target::of_frame(self.info.target, &self.arm.fk(q).unwrap())
    }

    fn solve(&self, q: &[f64]) -> Result<SolutionSet, IkError> {
        let given: Vec<f64> = self.info.free.iter().map(|&joint| q[joint]).collect();
        let mut set = SolutionSet::new();
        self.arm.ik_at_into(self.info.name, &self.target(q), &given, &mut set)?;
        Ok(set)
    }

    /// Whether all solutions are away from singularities; then, by a closed form, no two are on one branch, or, of a step with
    /// four roots, no three.
    fn told_apart(&self, set: &SolutionSet) -> Result<bool, String> {
        // Where the target has more rows than there are joints, nothing tells solutions apart.
        let solved = self.arm.dof() - self.info.free.len() - self.constraints.len();
        let clear = || set.iter().all(|one| self.singular_value(one.q) > CLEAR / 3.0);
        if self.is_searched() || solved < self.info.target.rows() || !clear() {
            return Ok(false);
        }
        for one in set.iter() {
            if set.on_branch(one.branch).count() > self.most {
                return Err(format!(
                    "{} more often: {:?}",
                    self.info.named(one.branch),
                    set.iter().collect::<Vec<_>>()
                ));
            }
        }
        Ok(true)
    }

    /// The branch of the solution that is q.
    fn branch(&self, q: &[f64], set: &SolutionSet) -> Option<Branch> {
        let nearest =
            set.iter().map(|one| (self.apart(one.q, q), one.branch)).min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.filter(|(apart, _)| *apart < 1e-6).map(|(_, branch)| branch)
    }

    fn apart(&self, a: &[f64], b: &[f64]) -> f64 {
        let joints = a.iter().zip(b).zip(self.arm.joints());
        let apart = joints.map(|((a, b), joint)| match joint.kind {
            JointKind::Revolute => ((a - b + PI).rem_euclid(TAU) - PI).abs(),
            JointKind::Prismatic => (a - b).abs(),
        });
        apart.fold(0.0, f64::max)
    }

    fn is_searched(&self) -> bool {
        self.info.branch.iter().any(|bit| bit.word == BranchWord::Determinant)
    }
}

/// By Jacobi's method on the products of columns.
fn least_singular_value(columns: &[Vec<f64>]) -> f64 {
    let mut columns = columns.to_vec();
    for _ in 0..30 {
        for i in 0..columns.len() {
            for j in i + 1..columns.len() {
                let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                let (a, b, c) = (
                    dot(&columns[i], &columns[i]),
                    dot(&columns[j], &columns[j]),
                    dot(&columns[i], &columns[j]),
                );
                if c.abs() < 1e-15 {
                    continue;
                }
                let angle = 0.5 * (2.0 * c).atan2(a - b);
                let (sin, cos) = angle.sin_cos();
                for k in 0..columns[i].len() {
                    let (x, y) = (columns[i][k], columns[j][k]);
                    columns[i][k] = cos * x + sin * y;
                    columns[j][k] = cos * y - sin * x;
                }
            }
        }
    }
    columns
        .iter()
        .map(|column| column.iter().map(|x| x * x).sum::<f64>().sqrt())
        .fold(f64::INFINITY, f64::min)
}

/// What was seen of an arm.
#[derive(Default, Debug)]
pub(super) struct Seen {
    /// Steps of paths.
    pub(super) steps: usize,
    /// Targets whose solutions were told apart.
    targets: usize,
}

/// Walks along random paths of a problem and says what is wrong.
fn walk(case: &Case<'_>, random: &mut Random, paths: u32, steps: u32) -> Result<Seen, String> {
    let mut seen = Seen::default();
    let refused = |error: IkError| matches!(error, IkError::Forbidden { .. });
    for _ in 0..paths {
        let (from, to) = (case.random(random), case.random(random));
        let longest = from.iter().zip(&to).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let mut last: Option<Branch> = None;
        for step in 0..steps {
            let part = STEP * f64::from(step) / longest;
            let q: Vec<f64> = from.iter().zip(&to).map(|(a, b)| a + part * (b - a)).collect();
            if case.singular_value(&q) < CLEAR {
                last = None;
                continue;
            }
            let set = match case.solve(&q) {
                Ok(set) => set,
                Err(error) if refused(error) => {
                    last = None;
                    continue;
                }
                Err(error) => return Err(format!("{q:?}: {error}")),
            };
            let branch = case.branch(&q, &set);
            if let (Some(last), Some(branch)) = (last, branch)
                && last != branch
            {
                let [last, branch] = [last, branch].map(|branch| case.info.named(branch).to_string());
                return Err(format!("from {last} to {branch} at {q:?}"));
            }
            if branch.is_some_and(|branch| !branch.is_known()) {
                return Err(format!("no branch at {q:?}"));
            }
            seen.steps += usize::from(last.is_some() && branch.is_some());
            last = branch;
            if step % 40 == 0 {
                seen.targets += usize::from(case.told_apart(&set)?);
                let asked = case.arm.branch_of(case.info.name, &q).map_err(|error| error.to_string())?;
                if asked != branch.unwrap_or(Branch::UNKNOWN) {
                    return Err(format!("{asked:?}, not {branch:?} at {q:?}"));
                }
            }
        }
    }
    Ok(seen)
}

/// Every problem of an arm.
pub(super) fn check(
    arm: &dyn Kinematics,
    random: &mut Random,
    paths: u32,
    most: usize,
) -> Result<Seen, String> {
    let mut all = Seen::default();
    for info in arm.problems() {
        let case = Case { most, ..Case::new(arm, *info) };
        let (paths, steps) = if case.is_searched() { (paths.min(4), 16) } else { (paths, 120) };
        let seen = walk(&case, random, paths, steps).map_err(|error| format!("{}: {error}", info.name))?;
        all.steps += seen.steps;
        all.targets += seen.targets;
    }
    Ok(all)
}

#[test]
fn of_shipped_tables() {
    let mut random = Random(7);
    for name in dh_robots::names() {
        let arm = engine::shipped(name).unwrap();
        let seen = check(&*arm, &mut random, 5, 1).unwrap_or_else(|error| panic!("{name}, {error}"));
        assert!(seen.steps > 8, "{name}: {seen:?}");
    }
}

#[test]
fn of_tables_of_every_class() {
    let mut random = Random(11);
    for (class, rows, skew) in CLASSES {
        // Where the axes that place the wrist have nothing special, one of their steps has four roots.
        let most = if class.ends_with("nothing else special") { 2 } else { 1 };
        for modified in [false, true] {
            let text = table(rows, *skew, &mut random);
            let text = if modified { modified_rows(&text) } else { text };
            let arm = engine::interpreter(&text).unwrap();
            let mut seen = Seen::default();
            let enough = |seen: &Seen| seen.steps > 100 && (seen.targets > 3 || arm.dof() < 6);
            // Some arms are nearly singular almost everywhere.
            for _ in 0..8 {
                let more = check(&*arm, &mut random, 8, most);
                let more = more.unwrap_or_else(|error| panic!("{class}, {error}\n{text}"));
                seen.steps += more.steps;
                seen.targets += more.targets;
                if enough(&seen) {
                    break;
                }
            }
            assert!(enough(&seen), "{class}: {seen:?}\n{text}");
        }
    }
}

#[test]
fn of_any_table() {
    let mut runner = TestRunner::new(ProptestConfig::with_cases(20));
    let seen = Cell::new(0);
    runner
        .run(&any_arm(), |arm| {
            let engine = engine::interpreter(&arm.text).map_err(TestCaseError::fail)?;
            let own = check(&*engine, &mut Random(3), 6, 1)
                .map_err(|error| TestCaseError::fail(format!("{error}\n{}", arm.text)))?;
            seen.set(seen.get() + own.steps);
            Ok(())
        })
        .unwrap();
    assert!(seen.get() > 400, "{seen:?}");
}

/// In f32 a solution has the branch that it has in f64.
#[test]
fn of_single_precision() {
    let mut random = Random(5);
    for name in ["ur5", "puma560", "stanford", "scara", "cylindrical", "gantry", "mycobot", "irb120"] {
        let text = dh_robots::table(name).unwrap();
        let output = dh_codegen::compile(text, Level::Quick).output.unwrap();
        let double = Program::new(&output.model, &output.plan).unwrap();
        let single = Program::<f32>::new(&output.model, &output.plan).unwrap();
        let (double, single) = (double.interpreter().unwrap(), single.interpreter().unwrap());
        for info in double.problems() {
            let case = Case::new(&double, *info);
            let mut seen = 0;
            for _ in 0..60 {
                let q = case.random(&mut random);
                if case.singular_value(&q) < CLEAR {
                    continue;
                }
                let rounded: Vec<f32> = q.iter().map(|x| *x as f32).collect();
                // Where a condition refuses it, in both.
                let own = double.branch_of(info.name, &q).unwrap_or(Branch::UNKNOWN);
                let found = single.branch_of(info.name, &rounded).unwrap_or(Branch::UNKNOWN);
                assert_eq!(found, own, "{name}, {} at {q:?}", info.name);
                seen += usize::from(own.is_known());
            }
            assert!(seen > 10, "{name}, {}: {seen}", info.name);
        }
    }
}

/// The words for well-known arms.
#[test]
fn words() {
    let all = |name: &str, problem: &str| {
        let arm = engine::shipped(name).unwrap();
        let info = *arm.problems().iter().find(|info| info.name == problem).unwrap();
        let mut words: Vec<_> = info.branch.iter().map(|bit| format!("{bit}")).collect();
        words.sort();
        words.join(" ")
    };
    for name in ["puma560", "ur5", "mycobot", "irb6640", "stanford", "vs068"] {
        assert_eq!(all(name, FULL_POSE), "elbow shoulder wrist", "{name}");
    }
    for name in ["iiwa7", "crane_x7", "panda"] {
        assert_eq!(all(name, FULL_POSE), "elbow shoulder wrist", "{name}");
    }
    for (name, problem) in [("planar2r", "xy"), ("scara", "place"), ("rh6frh5520", "place")] {
        assert_eq!(all(name, problem), "elbow", "{name} {problem}");
    }
    for (name, problem) in [("elbow3r", "position"), ("uarm_swift_pro", "place"), ("puma560", "tool_down")] {
        assert_eq!(all(name, problem), "elbow shoulder", "{name} {problem}");
    }
    assert_eq!(all("gantry", FULL_POSE), "wrist");
    assert_eq!(all("cylindrical", FULL_POSE), "shoulder wrist");
    assert_eq!(all("crx10ia_l", FULL_POSE), "determinant");
    // Fewer joints than the target has rows.
    assert_eq!(all("planar2r", FULL_POSE), "");
    assert_eq!(all("scara", FULL_POSE), "");
}
