//! Beside singular solutions: what is found there hides nothing that is regular.

use super::{compiled, frame_of, is_near, is_of_problem};
use dh_codegen::plan;
use dh_codegen::plan::eval::Program;
use dh_core::{Kinematics, SolutionSet, Target, TargetKind};
use dh_tests::oracle::Oracle;
use std::f64::consts::{FRAC_PI_2, PI};

/// As a UR's, with a joint that follows, one that is reversed, and one that a constraint makes turn with another.
fn crowded(off: &str, more: &str) -> String {
    format!(
        "[robot]\nname = \"Crowded\"\nconvention = \"modified\"\n
        [[joint]]\nd = 0.15\n[[joint]]\nalpha = \"pi/2\"\n
        [[joint]]\na = -0.42\nalpha = {off}\ndirection = -1\n
        [[joint]]\na = -0.39\nd = 0.11\ncouple = {{ J3 = -1 }}\n
        [[joint]]\nalpha = \"pi/2\"\nd = 0.09\n
        [[joint]]\nalpha = \"-pi/2\"\nd = 0.08\ndirection = -1\n
        [tool]\nxyz = [0, 0, 0.1]\nrpy = [{off}, 0, 0]\n
        [[ik]]\nname = \"problem\"\ntarget = \"position_direction\"\nconstraints = [\"theta6 = theta1\"]\n{more}\n"
    )
}

fn between(a: &[f64], b: &[f64]) -> f64 {
    let away = a.iter().zip(b).map(|(a, b)| ((a - b + PI).rem_euclid(2.0 * PI) - PI).abs());
    away.fold(0.0, f64::max)
}

/// Where roots have met in threes and more, there is a crowd of joint values that meet the target; it left no room for others.
#[test]
fn a_crowd_about_a_singular_solution_leaves_room_for_regular_ones() {
    type Solved<'a> = (&'a str, &'a str, [[f64; 3]; 2], &'a [[f64; 6]]);
    let cases: [Solved<'_>; 2] = [
        (
            "1e-8",
            "",
            [
                [0.33, 0.069_999_996_1, -0.240_000_000_7],
                [-1.000_000_012_246_468_2e-8, 1.0, -9.999_999_938_767_66e-9],
            ],
            &[[2.498_092, 1.7016, 1.537_823, -1.767_546, 0.643_501, -2.498_092]],
        ),
        (
            "1e-4",
            "where = [\"theta4 >= 0\"]",
            [
                [-0.035_355_339_306_814_754, -0.134_350_288_177_956_63, 0.149_993_000_000_011_73],
                [0.707_156_779_115_396_2, -0.707_056_779_115_563_4, -2.928_932_168_602_187e-5],
            ],
            &[
                [-0.698_347, 0.5469, 2.776_38, -1.277_27, -1.483_828, 0.698_347],
                [-0.698_435, -0.546_902, -2.776_443, -1.864_49, 1.483_891, 0.698_435],
            ],
        ),
    ];
    for (off, more, [position, direction], regular) in cases {
        let text = crowded(off, more);
        let output = compiled(&text);
        assert!(is_near(&output.plan), "{text}");
        let program = Program::<f64>::new(&output.model, &output.plan).unwrap();
        let arm = program.interpreter().unwrap();
        let mut set = SolutionSet::new();
        arm.ik_into("problem", &Target::PositionDirection { position, direction }, &mut set).unwrap();
        for wanted in regular {
            let found = set.iter().any(|solution| between(solution.q, wanted) < 1e-5);
            assert!(found, "{off}: {wanted:?} is not among {set:?}");
        }
    }
}

/// At quarter turns, solutions at which the Jacobian is regular are those of the table solved at once.
#[test]
fn regular_solutions_beside_singular_ones_are_all_found() {
    for off in ["1e-8", "1e-4"] {
        let text = &crowded(off, "");
        let (oracle, output) = (Oracle::read(text).unwrap(), compiled(text));
        let mut other = output.plan.clone();
        other.functions.retain(|function| !is_of_problem(function));
        other.functions.push(plan::at_once(&output.model, Some(0)).unwrap());
        let programs = [&output.plan, &other].map(|plan| Program::new(&output.model, plan).unwrap());
        let [near, once] = programs.each_ref().map(|program| program.interpreter().unwrap());
        for number in 0..12_usize {
            let mut rest = 7 + 83 * number;
            let mut q = [(); 6].map(|()| {
                rest = rest * 5 + 3;
                (rest % 4) as f64 * FRAC_PI_2 - FRAC_PI_2
            });
            // The last joint is reversed.
            q[5] = -q[0];
            let target = Target::of_frame(TargetKind::PositionDirection, &frame_of(&oracle.fk(&q)));
            let mut sets = [SolutionSet::new(), SolutionSet::new()];
            let [ours, theirs] = &mut sets;
            near.ik_into("problem", &target, ours).unwrap();
            if once.ik_into("problem", &target, theirs).is_err() {
                continue;
            }
            for solution in theirs.iter() {
                // One that is regular stands alone.
                let alone = theirs.iter().filter(|one| between(one.q, solution.q) < 0.1).count() == 1;
                let known = ours.iter().any(|own| between(own.q, solution.q) < 1e-4);
                assert!(known || !alone, "{q:?}: {:?} is not among {ours:?}\n{text}", solution.q);
            }
        }
    }
}

/// With the hand square to axes that are nearly parallel, the general chain was sure of five solutions of six.
#[test]
fn an_odd_number_of_solutions_is_a_doubt() {
    for off in [5e-5, 1e-4, 2e-4] {
        let text = format!(
            "[robot]\nname = \"Odd\"\nconvention = \"standard\"\n
            [[joint]]\nd = 0.15\na = 0.03\nalpha = \"pi/2\"\n[[joint]]\na = 0.2\nalpha = {off:?}\n
            [[joint]]\na = 0.18\nalpha = {:?}\n[[joint]]\na = 0.02\nalpha = \"pi/2\"\nd = {off:?}\n[[joint]]\nd = 0.1\n
            [tool]\nxyz = [0.04, 0, 0.06]\nrpy = [0, \"pi/2\", 0]\n
            [[ik]]\nname = \"problem\"\ntarget = \"position_direction\"\n",
            -off
        );
        let (oracle, output) = (Oracle::read(&text).unwrap(), compiled(&text));
        assert!(is_near(&output.plan), "{text}");
        let program = Program::<f64>::new(&output.model, &output.plan).unwrap();
        let arm = program.interpreter().unwrap();
        let q = [1.0, 1.0, 1.0, -1.0, -1.0].map(|quarter| quarter * FRAC_PI_2);
        let target = Target::of_frame(TargetKind::PositionDirection, &frame_of(&oracle.fk(&q)));
        let mut set = SolutionSet::new();
        arm.ik_into("problem", &target, &mut set).unwrap();
        assert!(set.iter().any(|solution| between(solution.q, &q) < 1e-6), "{off:e}: {set:?}");
    }
}
