//! A spherical wrist, Rz(q1) Ry(q2) Rz(q3), through its singularity: where q2 is nearly 0, half the digits of its sine
//! are rounding.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod random;

use dh_core::{Float, Frame, IkError, Measure, Search, Solutions, Step, Target, Winding};
use random::Random;

fn fk<S: Float>([q1, q2, q3]: [S; 3]) -> Frame<S> {
    let about_z = |angle| Frame::from_rpy([S::ZERO; 3], [S::ZERO, S::ZERO, angle]);
    about_z(q1) * Frame::from_rpy([S::ZERO; 3], [S::ZERO, q2, S::ZERO]) * about_z(q3)
}

fn ik<S: Float>(rotation: [[S; 3]; 3]) -> Result<Solutions<3, S>, IkError<S>> {
    const STEP_1: Step = Step::new(0, 0b010, false, Measure::Ratio);
    const STEP_2: Step = Step::new(1, 0b001, false, Measure::Ratio);
    const STEP_3: Step = Step::new(2, 0b100, false, Measure::Ratio);
    let target = Target::Rotation(rotation).validate()?;
    let zero = S::ZERO;
    let windings = [0, 1, 2].map(|joint| Winding { joint, turn: S::TAU, carries: &[] });
    let [[r11, r12, r13], [r21, r22, r23], [_, _, r33]] = rotation;
    let mut search = Search::<3, S>::new(zero, &windings);
    for q2 in search.trig(STEP_1, S::ONE, zero, r33) {
        let (s2, _) = q2.sin_cos();
        for q1 in search.trig_pair(STEP_2, [s2, zero, r13], [zero, s2, r23]) {
            let (s1, c1) = q1.sin_cos();
            let cosine = [S::ONE, zero, c1 * r22 - s1 * r12];
            for q3 in search.trig_pair(STEP_3, cosine, [zero, S::ONE, c1 * r21 - s1 * r11]) {
                let (position_error, rotation_error) = target.errors(&fk([q1, q2, q3]));
                search.accept([q1, q2, q3], position_error, rotation_error);
            }
        }
    }
    search.finish()
}

/// At every distance from the singularity there is a solution, and its error is as small as the digits allow.
fn through_the_singularity<S: Float>(sines: &[f64]) {
    let mut random = Random(8);
    for sine in sines {
        for _ in 0..300 {
            let q = [random.between(-3.1, 3.1), S::from_f64(*sine), random.between(-3.1, 3.1)];
            let all = ik(fk(q).rotation).unwrap_or_else(|error| panic!("{q:?}: {error}"));
            for solution in &all {
                // The cosine gives the sine with an error of a rounding divided by it; next to 0, where that is more
                // than the sine itself, 0 is as good.
                let (sine, edge) = (S::from_f64(*sine), S::from_f64(4.0) * S::SQRT_EPSILON);
                let bound = if sine < edge { edge } else { S::from_f64(8.0) * S::EPSILON / sine };
                assert!(solution.residual() <= bound, "{q:?}: {}", solution.residual());
            }
            if *sine == 0.0 {
                assert_eq!((all.len(), all[0].free, all[0].q[0]), (1, Some(0), S::ZERO), "{q:?}: {all:?}");
            }
            if S::from_f64(*sine) > S::from_f64(32.0) * S::SQRT_EPSILON {
                assert_eq!((all.len(), all[0].free), (2, None), "{q:?}: {all:?}");
                assert!((all.nearest(&q).q[1] - q[1]).abs() <= S::EPSILON / q[1] * S::from_f64(4.0));
            }
        }
    }
}

#[test]
fn a_wrist_passes_through_its_singularity() {
    let sines = [0.0, 1e-17, 1e-12, 1e-9, 1e-8, 3e-8, 1e-7, 3e-7, 1e-6, 1e-4, 1e-2, 1.0];
    through_the_singularity::<f64>(&sines);
    through_the_singularity::<f32>(&[0.0, 1e-9, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 2e-2, 1.0]);
}
