//! The attribute on every shipped table computes the bits of the interpreter: forwards, backwards, and in its refusals.

#![deny(warnings, missing_docs)]

use dh_runtime::{FULL_POSE, Kinematics, dh_robot};
use dh_tests::engine;
use dh_tests::engine::everything::computed;
use std::f64::consts::PI;
use std::sync::Mutex;

macro_rules! shipped {
    ($($table:literal $name:ident),* $(,)?) => {
        $(
            #[dh_robot($table)]
            struct $name;
        )*

        /// Every arm under the name of its table.
        fn arms() -> Vec<(&'static str, Box<dyn Kinematics + Send>)> {
            vec![$(($table, Box::new($name))),*]
        }
    };
}

shipped!(
    "baxter" Baxter,
    "crane_x7" CraneX7,
    "crane_x7_2r" CraneX7Planar,
    "crx10ia_l" Crx10iaL,
    "cylindrical" Cylindrical,
    "elbow3r" Elbow3R,
    "fr3" Fr3,
    "gantry" Gantry,
    "gen3" Gen3,
    "gen3_lite" Gen3Lite,
    "gofa5" Gofa5,
    "gp7" Gp7,
    "hc10" Hc10,
    "iiwa14" Iiwa14,
    "iiwa7" Iiwa7,
    "irb120" Irb120,
    "irb6640" Irb6640,
    "jaco2" Jaco2,
    "kr10_r1100" Kr10R1100,
    "kr6_r900" Kr6R900,
    "lite6" Lite6,
    "lrmate200id" Lrmate200id,
    "m0609" M0609,
    "m10ia" M10ia,
    "manocha_canny" ManochaCanny,
    "mycobot" MyCobot,
    "panda" Panda,
    "planar2r" Planar2R,
    "puma560" Puma560,
    "rh6frh5520" Rh6frh5520,
    "rizon4" Rizon4,
    "rtm2r" Rtm2R,
    "rv4fr" Rv4fr,
    "sawyer" Sawyer,
    "scara" Scara,
    "sia20d" Sia20d,
    "stanford" Stanford,
    "tm5_900" Tm5900,
    "tx2_60" Tx260,
    "uarm_swift_pro" UArmSwiftPro,
    "ur10" Ur10,
    "ur10e" Ur10e,
    "ur16e" Ur16e,
    "ur3e" Ur3e,
    "ur5" Ur5,
    "ur5e" Ur5e,
    "vs068" Vs068,
    "vx300s" Vx300s,
    "wx250" Wx250,
    "xarm5" Xarm5,
    "xarm6" Xarm6,
    "xarm7" Xarm7,
);

#[test]
fn every_shipped_table_is_here() {
    let names: Vec<_> = arms().iter().map(|(name, _)| *name).collect();
    assert_eq!(names, dh_robots::names().collect::<Vec<_>>());
}

/// Numbers between -1 and 1, the same on every run.
struct Random(u64);

impl Random {
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((self.0 >> 40) as u32) / f64::from(1_u32 << 23) - 1.0
    }
}

#[test]
fn bits_are_those_of_the_interpreter() {
    // One test for all, so that whoever is free takes the next arm.
    let queue = Mutex::new(arms().into_iter().zip(1..));
    let work = || {
        while let Some(((name, arm), number)) = queue.lock().ok().and_then(|mut queue| queue.next()) {
            assert_eq!(compare(name, &*arm, Random(number)), Ok(()));
        }
    };
    std::thread::scope(|scope| {
        scope.spawn(work);
        work();
    });
}

fn compare(name: &str, arm: &dyn Kinematics, mut random: Random) -> Result<(), String> {
    // Of the plan that `dhc` prints, which verifies it at more poses than the attribute.
    let interpreter = engine::shipped(name)?;
    assert_eq!(arm.name(), interpreter.name());
    assert_eq!(arm.fingerprint(), interpreter.fingerprint());
    assert_eq!(arm.problems(), interpreter.problems());
    assert_eq!(arm.rules(), interpreter.rules());
    assert_eq!(arm.redundancy(FULL_POSE), interpreter.redundancy(FULL_POSE));
    // Of seven joints each answer is a sweep and a search of the nearest: minutes where there is no closed form.
    let rounds = match arm.redundancy(FULL_POSE) {
        Some(redundancy) if redundancy.is_searched() => 1..2,
        Some(_) => 0..2,
        None => 0..12,
    };
    for round in rounds {
        let q: Vec<_> = (0..arm.dof()).map(|_| if round == 0 { 0.0 } else { PI * random.number() }).collect();
        let mut tool = arm.fk(&q).map_err(|error| error.to_string())?;
        match round % 6 {
            // Out of reach, in the middle of the arm, and no target at all.
            3 => tool.translation = tool.translation.map(|x| 4.0 * x),
            4 => tool.translation = [0.0; 3],
            5 if round > 6 => tool.rotation = [[f64::NAN; 3]; 3],
            _ => {}
        }
        assert_eq!(computed(arm, &q, tool), computed(&*interpreter, &q, tool), "{name} at {q:?}");
    }
    Ok(())
}

#[test]
fn typed_methods_know_the_arm_angle() {
    let q = [0.3, 0.5, -0.4, -1.2, 0.7, 0.9, 0.2];
    let arm_angle = Iiwa14.arm_angle(&q);
    let interpreter = engine::shipped("iiwa14").unwrap_or_else(|error| panic!("{error}"));
    let other = interpreter.arm_angle(FULL_POSE, &q).ok().flatten();
    assert!(other.is_some_and(|other| (other - arm_angle).abs() < 1e-14));
    let found = Iiwa14.ik_by_arm_angle(&Iiwa14.fk(&q), arm_angle).map(|found| {
        assert_eq!(found.len(), 8);
        found.iter().any(|solution| solution.q.iter().zip(q).all(|(own, q)| (own - q).abs() < 1e-12))
    });
    assert_eq!(found, Ok(true));
    assert_eq!(Kinematics::arm_angle(&Panda, FULL_POSE, &q), Ok(None::<f64>));
}
