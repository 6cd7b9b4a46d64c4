//! Frames known only at run time give what the same frames give that are written into the table.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test")]

use dh_codegen::compile;
use dh_codegen::plan::eval::Program;
use dh_codegen::verify::Level;
use dh_core::{Float, Frame, IkError, Kinematics, Mounted, Rule, SolutionSet, Target, TargetKind};
use dh_tests::engine;

/// Five joints, of which the last turns the tool's z axis.
const FIVE: &str = "[robot]\nname = \"five\"\nconvention = \"standard\"\n\
    [[joint]]\nd = 0.3\nalpha = \"pi/2\"\na = 0.05\n[[joint]]\na = 0.4\n[[joint]]\na = 0.3\n\
    [[joint]]\nalpha = \"pi/2\"\noffset = \"pi/2\"\n[[joint]]\nd = 0.1\nalpha = \"pi/2\"\na = 0.08\n\
    [[ik]]\nname = \"p\"\ntarget = \"position_direction\"\n";
const FOUR: &str = "[robot]\nname = \"four\"\nconvention = \"standard\"\n\
    [[joint]]\nd = 0.3\nalpha = \"pi/2\"\na = 0.05\n[[joint]]\na = 0.4\n[[joint]]\na = 0.3\nalpha = \"pi/2\"\n\
    [[joint]]\nd = 0.1\nalpha = \"pi/2\"\n[[ik]]\nname = \"p\"\ntarget = \"ray\"\n";
const THREE: &str = "[robot]\nname = \"three\"\nconvention = \"standard\"\n\
    [[joint]]\nd = 0.3\nalpha = \"pi/2\"\n[[joint]]\na = 0.1\nalpha = \"-pi/2\"\n[[joint]]\nd = 0.2\n\
    [[ik]]\nname = \"p\"\ntarget = \"rotation\"\n";
const TWO: &str = "[robot]\nname = \"two\"\nconvention = \"standard\"\n\
    [[joint]]\nd = 0.3\nalpha = \"pi/2\"\na = 0.05\n[[joint]]\na = 0.1\nalpha = \"pi/2\"\n\
    [[ik]]\nname = \"look\"\ntarget = \"lookat\"\n[[ik]]\nname = \"p\"\ntarget = \"direction\"\n";
const FLAT: &str = "[robot]\nname = \"flat\"\nconvention = \"standard\"\n\
    [[joint]]\na = 0.3\n[[joint]]\na = 0.2\n[[joint]]\na = 0.1\n[[ik]]\nname = \"p\"\ntarget = \"xy_yaw\"\n";

/// The same numbers on every run.
struct Random(u64);

impl Random {
    /// In -1 ... 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((self.0 >> 40) as u32) / f64::from(1_u32 << 23) - 1.0
    }

    fn three(&mut self, size: f64) -> [f64; 3] {
        [size * self.next(), size * self.next(), size * self.next()]
    }
}

/// Greatest difference, whole turns aside; slides of these tables are shorter than half a turn.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).wrap_angle().abs()).fold(0.0, f64::max)
}

/// `[tool]` or `[base]` of a table.
fn section(name: &str, text: &str, place: [f64; 3], turn: [f64; 3]) -> String {
    let place = place.map(|x| format!("\"{x:?} m\"")).join(", ");
    let turn = turn.map(|x| format!("\"{x:?} rad\"")).join(", ");
    assert!(!text.contains(&format!("\n[{name}]")), "the table has its own");
    format!("\n[{name}]\nxyz = [{place}]\nrpy = [{turn}]\n")
}

/// Joint values that a table's problem gives for a random target.
fn drawn(arm: &dyn Kinematics, problem: &str, kind: TargetKind, random: &mut Random) -> Vec<f64> {
    let mut set = SolutionSet::new();
    for _ in 0..1000 {
        let q: Vec<f64> = (0..arm.dof()).map(|_| 3.1 * random.next()).collect();
        let target = Target::of_frame(kind, &arm.fk(&q).unwrap());
        if arm.ik_into(problem, &target, &mut set).is_ok() {
            return set.get(set.len() / 2).unwrap().q.to_vec();
        }
    }
    panic!("{}: {problem} has no solution", arm.name())
}

/// Solutions of the mounted arm are those of the table with the frames in it, where that can be compiled, and hold the joint
/// values that the target was made from.
fn same_as_written(text: &str, problem: &str, targets: usize, (tool, base): (f64, f64)) {
    let mut random = Random(7);
    let bare = engine::interpreter(text).unwrap();
    let kind = bare.problems().iter().find(|info| info.name == problem).unwrap().target;
    let tool = (random.three(0.1 * tool), random.three(1.5 * tool));
    let base = (random.three(0.5 * base), random.three(3.0 * base));
    let written =
        format!("{text}{}{}", section("tool", text, tool.0, tool.1), section("base", text, base.0, base.1));
    let written = engine::interpreter(&written).unwrap();
    let solves = written.problems().iter().any(|info| info.name == problem);
    let mounted = Mounted::new(&*bare)
        .with_tool(Frame::from_rpy(tool.0, tool.1))
        .with_base(Frame::from_rpy(base.0, base.1));
    for _ in 0..targets {
        let q = drawn(&*bare, problem, kind, &mut random);
        let target = Target::of_frame(kind, &mounted.fk(&q).unwrap());
        let (mut found, mut expected) = (SolutionSet::new(), SolutionSet::new());
        mounted.ik_into(problem, &target, &mut found).unwrap();
        let name = bare.name();
        for solution in found.iter() {
            let (position, rotation) = target.errors(&written.fk(solution.q).unwrap());
            assert!(position < 1e-9 && rotation < 1e-9, "{name}: {position:e} {rotation:e}");
        }
        let has = |set: &SolutionSet, q: &[f64]| set.iter().any(|other| apart(other.q, q) < 1e-6);
        assert!(has(&found, &q), "{name}, {problem}: {q:?} is not among {found:?}");
        if solves {
            written.ik_into(problem, &target, &mut expected).unwrap();
            let all = expected.iter().all(|solution| has(&found, solution.q));
            assert!(all && found.len() == expected.len(), "{name}, {problem}: {found:?} for {expected:?}");
        }
    }
}

#[test]
fn frames_mounted_and_written_give_the_same_solutions() {
    let shipped = |name| dh_robots::table(name).unwrap();
    for frames in [(1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        same_as_written(shipped("planar2r"), "xy", 5, frames);
        same_as_written(shipped("mycobot"), "tool_down", 5, frames);
        same_as_written(shipped("scara"), "place", 5, frames);
        same_as_written(shipped("elbow3r"), "position", 3, frames);
        same_as_written(FLAT, "p", 5, frames);
        same_as_written(THREE, "p", 5, frames);
        same_as_written(TWO, "p", 5, frames);
    }
    same_as_written(shipped("puma560"), "tool_down", 3, (1.0, 1.0));
}

#[test]
fn what_only_the_general_chain_solves_is_solved_mounted() {
    same_as_written(FIVE, "p", 3, (1.0, 1.0));
    same_as_written(FOUR, "p", 3, (1.0, 1.0));
    same_as_written(TWO, "look", 1, (1.0, 0.0));
}

/// `where` of the problem holds for what is found, and is what is said where it refuses all.
#[test]
fn conditions_hold_for_mounted_arms() {
    let arm = engine::shipped("planar2r").unwrap();
    let mounted = Mounted::new(&*arm).with_tool(Frame::from_rpy([0.02, 0.05, 0.0], [0.0, 0.0, 0.4]));
    let mut found = SolutionSet::new();
    for step in 0..6 {
        let q = [0.3 * f64::from(step), 0.9];
        let target = Target::of_frame(TargetKind::Xy, &mounted.fk(&q).unwrap());
        for (problem, sign) in [("xy_elbow_up", -1.0), ("xy_elbow_down", 1.0)] {
            mounted.ik_into(problem, &target, &mut found).unwrap();
            assert_eq!(found.len(), 1);
            assert!(sign * found.get(0).unwrap().q[1] >= 0.0, "{found:?}");
        }
    }
    let text = "[robot]\nname = \"w\"\nconvention = \"standard\"\n[[joint]]\na = 1\n[[joint]]\na = 1\n\
        [[ik]]\nname = \"p\"\ntarget = \"xy\"\nwhere = [\"theta2 <= 0\", \"theta2 >= 3\"]\n";
    let arm = engine::interpreter(text).unwrap();
    let mounted = Mounted::new(&*arm).with_tool(Frame::from_translation([0.1, 0.2, 0.0]));
    let refused = mounted.ik_into("p", &Target::Xy([1.0, 0.5]), &mut found);
    assert!(matches!(refused, Err(IkError::Forbidden { rule: Rule::Where { .. } })), "{refused:?}");
}

/// The tool point on the first axis: that joint is free, is marked, and is where the seed has it.
#[test]
fn a_joint_that_is_free_goes_to_the_seed() {
    let arm = engine::shipped("elbow3r").unwrap();
    let mounted = Mounted::new(&*arm).with_tool(Frame::from_translation([0.0, 0.03, 0.0]));
    let mut found = SolutionSet::new();
    let [_, _, top] = mounted.fk(&[0.0, 1.2, 0.3]).unwrap().translation;
    let target = Target::Position([0.0, 0.0, 0.9 * top]);
    for q1 in [-1.1, 0.4, 2.5] {
        let seed = [q1, 0.4, 0.8];
        mounted
            .ik_seeded_into("position", &target, &[], Some(dh_core::Seed::new(&seed)), &mut found)
            .unwrap();
        assert!(!found.is_empty() && found.len() <= 4, "{found:?}");
        for solution in found.iter() {
            assert!(solution.residual() < 1e-9, "{solution:?}");
            if solution.free.is_some() {
                assert!(solution.free == Some(0) && (solution.q[0] - q1).wrap_angle().abs() < 1e-9);
            }
        }
    }
}

#[test]
fn single_precision_finds_the_same() {
    let output = compile(FLAT, Level::Quick).output.unwrap();
    let program = Program::<f32>::new(&output.model, &output.plan).unwrap();
    let arm = program.interpreter().unwrap();
    let frames = [([0.05, 0.02, 0.1], [0.3, 0.2, 0.4]), ([0.1, 0.2, 0.3], [0.2, -0.4, 1.0])];
    let [tool, base] = frames.map(|(place, turn)| Frame::<f32>::from_rpy(place, turn));
    let mounted = Mounted::new(&arm).with_tool(tool).with_base(base);
    for q in [[0.3_f32, 0.9, -0.5], [-1.0, -1.3, 0.8], [2.0, 1.8, 0.4]] {
        let target = Target::of_frame(TargetKind::XyYaw, &mounted.fk(&q).unwrap());
        let mut found = SolutionSet::new();
        mounted.ik_into("p", &target, &mut found).unwrap();
        let near = |other: &[f32]| other.iter().zip(q).all(|(a, b)| (a - b).wrap_angle().abs() < 1e-3);
        assert!(found.iter().any(|solution| near(solution.q)), "{q:?} is not among {found:?}");
    }
}
