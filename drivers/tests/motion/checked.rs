//! What the checker lets through and what it refuses, looked at by other means: dense sampling.

use super::{Cell, MyCobot, Planar, Sudden};
use dh_drivers::driver::{JointMap, Pace};
use dh_drivers::motion::{Checked, Dynamics, Move, Planner, Reason, Refusal, WAY_TOLERANCE};
use dh_runtime::{Kinematics, Rule, Target};
use proptest::prelude::*;
use std::time::Duration;

pub(crate) fn planner(arm: &dyn Kinematics, pace: Pace) -> Planner<'_> {
    Planner::new(arm, &JointMap::of_table(arm).unwrap(), pace).unwrap()
}

pub(crate) fn every(milliseconds: u64) -> Pace {
    Pace::Stream { period: Duration::from_millis(milliseconds) }
}

/// How far the tool point is inside what is forbidden (m); negative outside.
fn depth(arm: &dyn Kinematics, q: &[f64]) -> f64 {
    let [x, y, z] = arm.fk(q).unwrap().translation;
    let rules = arm.rules();
    let bounds = rules.bounds.iter().map(|bound| {
        let value = [x, y, z][bound.axis as usize];
        if matches!(bound.side, dh_runtime::Side::Min) { bound.value - value } else { value - bound.value }
    });
    let boxes = rules.keep_out.iter().map(|keep| {
        let inside = |(i, p): (usize, f64)| (p - keep.min[i]).min(keep.max[i] - p);
        [x, y, z].into_iter().enumerate().map(inside).fold(f64::INFINITY, f64::min)
    });
    bounds.chain(boxes).fold(f64::NEG_INFINITY, f64::max)
}

/// Looks at straight lines between commands at places that have nothing to do with the checker's.
pub(crate) fn assert_kept(arm: &dyn Kinematics, checked: &Checked, dynamics: &[Dynamics]) {
    let joints = arm.joints();
    for step in 0..checked.moves() {
        let mut before: Option<(f64, Vec<f64>)> = None;
        for (time, command) in checked.commands(step) {
            let here = command.positions();
            let (then, from) = before.unwrap_or_else(|| {
                (
                    0.0,
                    if step == 0 { checked.start().unwrap() } else { checked.goal(step - 1).unwrap() }
                        .to_vec(),
                )
            });
            for (joint, (from, to)) in from.iter().zip(here).enumerate() {
                let limit = dynamics[joint].velocity;
                let speed = (to - from).abs() / (time - then);
                assert!(time == then || speed <= limit * (1.0 + 1e-6), "{speed} {limit}");
                assert!(joints[joint].motion_limits().is_none_or(|limits| limits.contains(*to)));
            }
            let looks = 1 + (time - then).mul_add(700.0, 31.0) as u32;
            for look in 0..=looks {
                let part = f64::from(look) / f64::from(looks);
                let q: Vec<f64> = from.iter().zip(here).map(|(a, b)| a + part * (b - a)).collect();
                let deep = depth(arm, &q);
                assert!(deep <= 1.5 * WAY_TOLERANCE, "{deep} at {q:?}");
                for sum in arm.rules().sums {
                    let value = sum.value(&q);
                    assert!(value >= sum.range.min - 1e-9 && value <= sum.range.max + 1e-9, "{value}");
                }
            }
            before = Some((time, here.to_vec()));
        }
    }
}

/// Looks at the tool point where some joints have gone further to the next goal than others. What the checker looks at
/// are samples, too: what may lie between them is a centimetre.
fn assert_kept_out_of_step(arm: &dyn Kinematics, checked: &Checked) {
    let mut from = checked.start().unwrap().to_vec();
    let mut random = 1_u64;
    for (_, command) in checked.commands(0) {
        for _ in 0..200 {
            let q = from.iter().zip(command.positions()).map(|(a, b)| {
                random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                a + (random >> 40) as f64 / f64::from(1 << 24) * (b - a)
            });
            let q: Vec<f64> = q.collect();
            assert!(depth(arm, &q) < 0.01, "{} at {q:?}", depth(arm, &q));
        }
        from = command.positions().to_vec();
    }
}

/// Joint values from parts of the motion limits.
fn between_limits(arm: &dyn Kinematics, parts: &[f64]) -> Vec<f64> {
    let joints = arm.joints().iter().zip(parts);
    joints
        .map(|(joint, part)| {
            let limits = joint.motion_limits().unwrap();
            limits.min + part * (limits.max - limits.min)
        })
        .collect()
}

fn pace() -> impl Strategy<Value = Pace> {
    prop_oneof![Just(every(4)), Just(every(20)), Just(Pace::PointToPoint)]
}

fn is_allowed(arm: &dyn Kinematics, q: &[f64]) -> bool {
    let inside = arm.joints().iter().zip(q);
    arm.check(q).is_ok()
        && inside.into_iter().all(|(joint, q)| joint.motion_limits().is_none_or(|limits| limits.contains(*q)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(250))]

    #[test]
    fn joint_moves_keep_limits_rules_and_speeds_or_are_refused_for_cause(
        six in proptest::bool::weighted(0.3),
        pace in pace(),
        start in [0.0..1.0, 0.0..1.0, 0.0..1.0, 0.0..1.0, 0.0..1.0, 0.0..1.0],
        goal in [0.0..1.0, 0.0..1.0, 0.0..1.0, 0.0..1.0, 0.0..1.0, 0.0..1.0],
        near in 0.05..1.0,
    ) {
        let arm: &dyn Kinematics = if six { &MyCobot } else { &Cell };
        let planner = planner(arm, pace);
        let start = between_limits(arm, &start);
        let mut goal = between_limits(arm, &goal);
        goal.iter_mut().zip(&start).for_each(|(goal, start)| *goal = start + near * (*goal - start));
        prop_assume!(is_allowed(arm, &start));
        match planner.plan(&start, &[Move::joints(&goal)]) {
            Ok(checked) => {
                prop_assert!(is_allowed(arm, &goal));
                prop_assert_eq!(checked.goal(0), Some(goal.as_slice()));
                assert_kept(arm, &checked, planner.dynamics());
                if pace == Pace::PointToPoint {
                    assert_kept_out_of_step(arm, &checked);
                }
            }
            Err(Refusal { reason: Reason::Forbidden(rule), sample: Some(sample), .. }) if is_allowed(arm, &goal) => {
                // Somewhere near the straight line it is forbidden indeed. (A stream may leave that line.)
                prop_assert!(sample.part > 0.0 && sample.part <= 1.0);
                let deepest = (0..=20_000).map(|look| {
                    let part = f64::from(look) / 20_000.0;
                    let q: Vec<f64> = start.iter().zip(&goal).map(|(a, b)| a + part * (b - a)).collect();
                    depth(arm, &q)
                });
                if pace == Pace::PointToPoint {
                    let deepest = deepest.fold(f64::NEG_INFINITY, f64::max);
                    prop_assert!(deepest > 0.9 * WAY_TOLERANCE, "{} {:?}", deepest, rule);
                }
            }
            Err(refusal) => prop_assert!(!is_allowed(arm, &goal), "{}", refusal),
        }
    }

    #[test]
    fn lines_and_curves_are_where_they_should_be_at_speeds_that_are_allowed(
        parts in [0.0..1.0, 0.0..1.0, 0.0..1.0],
        through in proptest::collection::vec([-0.5..0.5, -0.5..0.5, 0.05..0.8], 1..4),
        fast in prop_oneof![Just(None), (0.02..0.5).prop_map(Some)],
        pace in pace(),
    ) {
        let planner = planner(&Cell, pace);
        let start = between_limits(&Cell, &parts);
        prop_assume!(is_allowed(&Cell, &start));
        let points: Vec<Target> = through.iter().copied().map(Target::Position).collect();
        let asked = Move::curve("position", points);
        let asked = if let Some(speed) = fast { asked.speed(speed) } else { asked };
        let Ok(checked) = planner.plan(&start, &[asked]) else { return Ok(()) };
        assert_kept(&Cell, &checked, planner.dynamics());
        let end = Kinematics::fk(&Cell, checked.goal(0).unwrap()).unwrap().translation;
        let goal = through[through.len() - 1];
        prop_assert!((0..3).all(|i| (end[i] - goal[i]).abs() < 1e-6), "{:?} {:?}", end, goal);
        let Pace::Stream { period } = pace else { return Ok(()) };
        let dt = period.as_secs_f64();
        let commands: Vec<Vec<f64>> = [start.clone(), start.clone(), start.clone()].into_iter()
            .chain(checked.commands(0).map(|(_, command)| command.positions().to_vec())).collect();
        let from = Kinematics::fk(&Cell, &start).unwrap().translation;
        let straight: Vec<f64> = (0..3).map(|i| goal[i] - from[i]).collect();
        let length = straight.iter().map(|x| x * x).sum::<f64>().sqrt();
        for four in commands.windows(4) {
            for (joint, limits) in planner.dynamics().iter().enumerate() {
                let [a, b, c, d] = [0, 1, 2, 3].map(|i: usize| four[i][joint]);
                let acceleration = (b - 2.0 * c + d) / dt.powi(2);
                prop_assert!(acceleration.abs() <= limits.acceleration * 1.02, "{} {:?}", acceleration, limits);
                let jerk = (d - 3.0 * c + 3.0 * b - a) / dt.powi(3);
                prop_assert!(jerk.abs() <= limits.jerk * 1.05, "{} {:?}", jerk, limits);
            }
            let at = |q: &[f64]| Kinematics::fk(&Cell, q).unwrap().translation;
            let (here, next) = (at(&four[2]), at(&four[3]));
            let speed = (0..3).map(|i| (next[i] - here[i]).powi(2)).sum::<f64>().sqrt() / dt;
            if through.len() == 1 {
                // Straight, and no faster than it was asked for.
                prop_assert!(speed <= fast.unwrap_or(0.1) * (1.0 + 1e-3) + 1e-5 / dt, "{}", speed);
                let along: f64 = (0..3).map(|i| (next[i] - from[i]) * straight[i]).sum::<f64>() / length;
                let off: f64 = (0..3).map(|i| (next[i] - from[i] - along * straight[i] / length).powi(2)).sum();
                prop_assert!(off.sqrt() < 2e-5, "{}", off.sqrt());
            }
        }
    }
}

fn refusal(arm: &dyn Kinematics, start: &[f64], asked: Move) -> Refusal {
    planner(arm, every(10)).plan(start, &[asked]).unwrap_err()
}

#[test]
fn a_wall_that_is_thinner_than_a_step_is_seen() {
    // From one side of the 2 mm wall to the other, with nothing but the wall in the way.
    let planner = planner(&Cell, every(20));
    let inverse = |point: [f64; 3]| {
        let mut solutions = dh_runtime::SolutionSet::new();
        Cell.ik_within("position", &Target::Position(point), Some(&[0.0, 1.0, -1.0]), &mut solutions)
            .unwrap();
        solutions.nearest(&[0.0, 1.0, -1.0]).unwrap().q.to_vec()
    };
    let (start, goal) = (inverse([0.15, -0.3, 0.3]), inverse([0.25, -0.3, 0.3]));
    let refused = planner.plan(&start, &[Move::joints(&goal)]).unwrap_err();
    assert!(matches!(refused.reason, Reason::Forbidden(Rule::KeepOut { index: 0, .. })), "{refused}");
    let line = Move::line("position", Target::Position([0.25, -0.3, 0.3]));
    let refused = planner.plan(&start, &[line]).unwrap_err();
    assert!(matches!(refused.reason, Reason::NoSolution(_) | Reason::Forbidden(_)), "{refused}");
}

#[test]
fn a_line_on_the_very_floor_is_allowed() {
    let planner = planner(&Cell, every(10));
    let at = |x, y| Target::Position([x, y, 0.05]);
    let above = planner.plan(
        &[0.5, 1.0, -2.0],
        &[Move::nearest("position", at(0.3, 0.2)), Move::line("position", at(0.3, 0.3))],
    );
    assert_kept(&Cell, &above.unwrap(), planner.dynamics());
}

#[test]
fn what_leaves_the_reach_has_no_solution_there() {
    let refused = refusal(&Planar, &[0.5, 0.8], Move::line("xy", Target::Xy([0.3, 0.0])));
    assert!(matches!(refused.reason, Reason::NoSolution(_) | Reason::Singular { .. }), "{refused}");
    let part = refused.sample.unwrap().part;
    assert!(part > 0.5 && part <= 1.0, "{refused}");
}

#[test]
fn a_path_along_the_edge_of_the_reach_is_singular() {
    // The edge itself, and then just inside of it.
    let refused = refusal(&Planar, &[0.0, 0.0], Move::line("xy", Target::Xy([0.2, 0.0])));
    let Reason::Singular { value, least } = refused.reason else { panic!("{refused}") };
    assert!(value < least && refused.sample.unwrap().index == 0, "{refused}");
}

#[test]
fn a_line_past_the_base_axis_would_turn_the_joint_too_fast() {
    // Cell's tool passes its base axis at a hundredth of a millimetre: joint 1 would turn by half in no time.
    let start = {
        let mut solutions = dh_runtime::SolutionSet::new();
        let elbow_up = [0.0, 2.2, -1.5];
        Cell.ik_within("position", &Target::Position([0.1, 1e-5, 0.7]), Some(&elbow_up), &mut solutions)
            .unwrap();
        solutions.nearest(&elbow_up).unwrap().q.to_vec()
    };
    let line = Move::line("position", Target::Position([-0.1, 1e-5, 0.7]));
    let refused = refusal(&Cell, &start, line);
    let near =
        matches!(refused.reason, Reason::Singular { .. } | Reason::TooFast { .. } | Reason::Jump { .. });
    assert!(near && (refused.sample.unwrap().part - 0.5).abs() < 0.05, "{refused}");
}

#[test]
fn a_line_on_which_the_arm_would_have_to_flip_jumps() {
    // With the elbow up only, a line on which joint 1 meets its limit has no other way to go on.
    let start = [2.9, 1.3, -1.8];
    let here = Kinematics::fk(&Cell, &start).unwrap().translation;
    let refused =
        refusal(&Cell, &start, Move::line("position", Target::Position([here[0], -here[1], here[2]])));
    let Reason::OutsideLimits { joint, value, max, .. } = &refused.reason else { panic!("{refused}") };
    assert!(joint.index == 0 && value > max, "{refused}");
}

#[test]
fn a_path_starts_where_the_problem_has_the_arm() {
    // The tool is not down here.
    let start = [0.1, -0.4, -1.0, 0.2, 0.3, 0.0];
    let refused = refusal(&MyCobot, &start, Move::line("tool_down", Target::Position([0.15, -0.1, 0.1])));
    assert!(matches!(refused.reason, Reason::NoStart(_)), "{refused}");
    assert_eq!(refused.sample.unwrap().index, 0);
}

#[test]
fn a_speed_that_the_joints_cannot_follow_is_refused_with_the_one_that_they_can() {
    let start = [0.4, 1.2];
    let line = |speed: f64| Move::line("xy", Target::Xy([0.12, 0.18])).speed(speed);
    let Reason::TooFast { needed, allowed, speed, possible, .. } = refusal(&Planar, &start, line(1.0)).reason
    else {
        panic!()
    };
    assert!(speed == 1.0 && needed > allowed && allowed == 1.0);
    assert!((possible - allowed / needed).abs() < 1e-12);
    assert!(planner(&Planar, every(10)).plan(&start, &[line(possible * 0.999)]).is_ok());
}

#[test]
fn servos_that_reach_less_than_the_joint_bound_the_motion() {
    // Joint 3's register ends at 512 of 4096: -0.75 pi, inside the table's -2.6.
    let refused = refusal(&Cell, &[0.0, 1.0, 0.0], Move::joints(&[0.0, 1.0, -2.5]));
    let Reason::OutsideLimits { joint, min, .. } = &refused.reason else { panic!("{refused}") };
    assert!(joint.index == 2 && (min + 0.75 * std::f64::consts::PI).abs() < 1e-12, "{refused}");
}

#[test]
fn a_driver_of_another_table_is_refused() {
    assert!(Planner::new(&Planar, &JointMap::of_table(&Cell).unwrap(), every(10)).is_err());
}

#[test]
fn out_of_what_is_forbidden_the_arm_may_go_but_no_deeper() {
    for pace in [every(10), Pace::PointToPoint] {
        let planner = planner(&Cell, pace);
        // The tool point 50 mm under the floor, and the wrist bent beyond what its servo reaches.
        let (under, bent) = ([0.5, -0.6, 0.0], [0.5, 1.0, -2.5]);
        assert!(depth(&Cell, &under) > 0.05);
        let reach = [0.5, 1.0, 0.0];
        for start in [under, bent] {
            planner.plan(&start, &[Move::joints(&reach)]).unwrap();
        }
        let deeper = planner.plan(&under, &[Move::joints(&[0.5, -0.7, 0.0])]).unwrap_err();
        assert!(matches!(deeper.reason, Reason::Forbidden(Rule::Bound { .. })), "{deeper}");
        // The way out leads further down first, though it ends above.
        let through = planner.plan(&under, &[Move::joints(&[0.5, -0.6, 2.5])]);
        let lowest = (0..=100).map(|i| depth(&Cell, &[0.5, -0.6, 0.025 * f64::from(i)])).fold(0.0, f64::max);
        assert_eq!(through.is_ok(), lowest <= depth(&Cell, &under) && is_allowed(&Cell, &[0.5, -0.6, 2.5]));
        let inside = planner.plan(&under, &[Move::joints(&[0.5, -0.6, -1.0]), Move::joints(&reach)]);
        assert!(inside.is_err(), "a move may not end there");
        let further = planner.plan(&bent, &[Move::joints(&[0.5, 1.0, -2.55])]).unwrap_err();
        assert!(matches!(further.reason, Reason::OutsideLimits { .. }), "{further}");
        let line = Move::line("position", Target::Position([0.4, 0.2, 0.3]));
        assert!(planner.plan(&under, &[line]).is_err(), "lines are for arms that stand where they may");
    }
}

#[test]
fn an_arm_that_stands_nearly_on_a_path_is_brought_onto_it() {
    for pace in [every(10), Pace::PointToPoint] {
        let planner = planner(&MyCobot, pace);
        // Tool down at (150, -100, 150) but for what a device that counts in hundredths of a degree leaves of it.
        let exact = planner.plan(
            &[-0.2, -0.1, -2.0, 0.6, 0.0, -0.2],
            &[Move::nearest("tool_down", Target::Position([0.15, -0.1, 0.15]))],
        );
        let exact = exact.unwrap().goal(0).unwrap().to_vec();
        let start = [-12.08, -8.42, -116.97, 35.4, 0.0, -12.08].map(f64::to_radians);
        let line = Move::line("tool_down", Target::Position([0.15, -0.1, 0.07]));
        let checked = planner.plan(&start, std::slice::from_ref(&line)).unwrap();
        assert_eq!(checked.start(), Some(start.as_slice()));
        assert_kept(&MyCobot, &checked, planner.dynamics());
        let tilt = |q: &[f64]| Kinematics::fk(&MyCobot, q).unwrap().z_axis()[2] + 1.0;
        assert!(tilt(&start) > 1e-9 && tilt(checked.goal(0).unwrap()) < 1e-12);
        assert!(planner.plan(&exact, std::slice::from_ref(&line)).unwrap().duration() <= checked.duration());
        let far = start.map(|q| q + 0.06);
        assert!(matches!(planner.plan(&far, &[line]).unwrap_err().reason, Reason::NotOnPath { .. }));
    }
}

/// Past the base axis joint 1 has to turn by nearly half a turn within some millimetres, for which it needs a moment;
/// the rest of the line is made at its speed.
#[test]
fn a_line_past_a_singularity_is_slow_only_there() {
    for (distance, pace) in [(0.02, every(4)), (0.005, every(10)), (0.002, Pace::PointToPoint)] {
        let planner = planner(&Cell, pace);
        let elbow_up = [0.0, 2.2, -1.5];
        let at = |y: f64| Target::Position([distance, y, 0.6]);
        let start = planner.plan(&elbow_up, &[Move::nearest("position", at(-0.2))]).unwrap();
        let start = start.goal(0).unwrap().to_vec();
        let checked = planner.plan(&start, &[Move::line("position", at(0.2))]).unwrap();
        assert_kept(&Cell, &checked, planner.dynamics());
        // At 0.1 m/s it would be 4 s, and joint 1 alone needs a second and a half for half a turn and as much again to
        // speed up and slow down; as slow as it must be at its slowest, it would be 10 s, 40 s and 100 s.
        println!("{distance} m: {:.2} s", checked.duration());
        assert!(checked.duration() < 8.0, "{distance} m: {:.2} s", checked.duration());
    }
}

/// Joints whose acceleration is there at once go along it no slower.
#[test]
fn a_jerk_without_bounds_leaves_the_line_as_fast() {
    let at = |y: f64| Target::Position([0.005, y, 0.6]);
    let start = planner(&Cell, every(10)).plan(&[0.0, 2.2, -1.5], &[Move::nearest("position", at(-0.2))]);
    let start = start.unwrap().goal(0).unwrap().to_vec();
    let [usual, sudden] = [&Cell as &dyn Kinematics, &Sudden].map(|arm| {
        let planner = planner(arm, every(10));
        let checked = planner.plan(&start, &[Move::line("position", at(0.2))]).unwrap();
        assert_kept(arm, &checked, planner.dynamics());
        checked.duration()
    });
    assert!(sudden < 1.01 * usual, "{sudden:.2} s, and with bounds {usual:.2} s");
}
