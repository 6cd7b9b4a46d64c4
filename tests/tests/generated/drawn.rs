//! The attribute on tables drawn at random: what it generates agrees with the oracle, and computes the bits of the
//! interpreter.
//!
//! The shipped tables are arms that people build. These are not, and reach ways through the printer that no arm takes.

use dh_runtime::{Kinematics, SolutionSet, Target, dh_robot};
use dh_tests::engine;
use dh_tests::engine::everything::computed;
use dh_tests::engine::forwards::{compare, tolerance};
use dh_tests::oracle::Oracle;
use std::f64::consts::PI;

macro_rules! drawn {
    ($($table:literal $name:ident),* $(,)?) => {
        $(
            #[dh_robot($table, warnings = "off")]
            struct $name;
        )*

        /// Every arm with the text of its table.
        fn arms() -> Vec<(&'static str, &'static str, Box<dyn Kinematics>)> {
            vec![$(($table, include_str!($table), Box::new($name))),*]
        }
    };
}

drawn!(
    "drawn/01.toml" Drawn01,
    "drawn/02.toml" Drawn02,
    "drawn/03.toml" Drawn03,
    "drawn/04.toml" Drawn04,
    "drawn/05.toml" Drawn05,
    "drawn/06.toml" Drawn06,
    "drawn/07.toml" Drawn07,
    "drawn/08.toml" Drawn08,
    "drawn/09.toml" Drawn09,
    "drawn/10.toml" Drawn10,
    "drawn/11.toml" Drawn11,
    "drawn/12.toml" Drawn12,
    "drawn/13.toml" Drawn13,
    "drawn/14.toml" Drawn14,
    "drawn/15.toml" Drawn15,
    "drawn/16.toml" Drawn16,
    "drawn/17.toml" Drawn17,
    "drawn/18.toml" Drawn18,
);

/// Joint values of an arm: half a turn or half a metre at most, the same ones on every run. The first are all 0.
fn joint_values(oracle: &Oracle, seed: u64) -> Vec<Vec<f64>> {
    let mut state = seed;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((state >> 40) as u32) / f64::from(1_u32 << 23) - 1.0
    };
    let chain = oracle.chain();
    let scales = || chain.joints.iter().map(|&row| if chain.rows[row].prismatic { 0.5 } else { PI });
    let mut drawn = vec![vec![0.0; oracle.dof()]];
    drawn.extend((1..20).map(|_| scales().map(|scale| scale * random()).collect()));
    drawn
}

/// The numbers that a target of the kinds in these tables prescribes.
fn numbers(target: &Target<f64>) -> Option<Vec<f64>> {
    match target {
        Target::Xy(position) => Some(position.to_vec()),
        Target::Rotation(rotation) => Some(rotation.concat()),
        Target::Pose(frame) => Some(frame.rows().to_vec()),
        _ => None,
    }
}

#[test]
fn forwards_agrees_with_the_oracle() {
    for ((name, text, arm), seed) in arms().into_iter().zip(1..) {
        let oracle = Oracle::read(text).unwrap();
        assert_eq!((arm.dof(), arm.rows()), (oracle.dof(), oracle.chain().rows.len()), "{name}");
        for q in joint_values(&oracle, seed) {
            compare(&*arm, &oracle, &q, tolerance(&oracle)).unwrap_or_else(|error| panic!("{name}: {error}"));
        }
    }
}

#[test]
fn bits_are_those_of_the_interpreter() {
    for ((name, text, arm), seed) in arms().into_iter().zip(1..) {
        let interpreter = engine::interpreter(text).unwrap();
        assert_eq!(arm.name(), interpreter.name());
        assert_eq!(arm.fingerprint(), interpreter.fingerprint());
        assert_eq!(arm.problems(), interpreter.problems());
        assert_eq!(arm.rules(), interpreter.rules());
        for q in joint_values(&Oracle::read(text).unwrap(), seed) {
            let tool = arm.fk(&q).unwrap();
            assert_eq!(computed(&*arm, &q, tool), computed(&*interpreter, &q, tool), "{name} at {q:?}");
        }
    }
}

/// Every solution is where the oracle says that it should be.
#[test]
fn solutions_meet_their_targets() {
    let mut solved = Vec::new();
    for ((name, text, arm), seed) in arms().into_iter().zip(1..) {
        let oracle = Oracle::read(text).unwrap();
        for problem in arm.problems() {
            let mut found = 0;
            for q in joint_values(&oracle, seed) {
                let target = Target::of_frame(problem.target, &arm.fk(&q).unwrap());
                let mut set = SolutionSet::new();
                // At the ends of its reach an arm is singular, and says so.
                if arm.ik_into(problem.name, &target, &mut set).is_err() {
                    continue;
                }
                for solution in set.iter() {
                    let [x, y, z, _] = oracle.fk(solution.q);
                    let rotation = [x, y, z].map(|[a, b, c, _]| [a, b, c]);
                    let there = match target {
                        Target::Xy(_) => vec![x[3], y[3]],
                        Target::Pose(_) => [x, y, z].concat(),
                        _ => rotation.concat(),
                    };
                    for (there, wanted) in there.iter().zip(numbers(&target).expect("no other kind")) {
                        assert!((there - wanted).abs() < 1e-9, "{name} at {q:?}: {there} for {wanted}");
                    }
                }
                found += usize::from(!set.is_empty());
            }
            solved.push((name, found));
        }
    }
    assert!(solved.len() >= 3 && solved.iter().all(|(_, found)| *found >= 10), "{solved:?}");
}
