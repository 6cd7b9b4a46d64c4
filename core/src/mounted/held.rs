//! Problems that say how the hand is turned, before anything is solved: constraints that hold it, or all but its yaw.

use crate::frame::{matrix_product, sub, transpose};
use crate::unknowns::Unknowns;
use crate::{Float, Frame, Kinematics, ProblemInfo, Target};

/// What should be 0 of a rotation is, to this many machine epsilons.
const SAME: f64 = 64.0;

/// So many sets of joint values tell whether the hand turns: what is the same at a few drawn at random is the same
/// everywhere, since it is an analytic function of them.
const SAMPLES: u32 = 4;

/// The target of the arm's own tool frame where a mounted tool is to meet `target`, both in the frame that the arm
/// stands on. `None` where it depends on the joint values, or says more than of a place and a yaw.
pub(super) fn without_tool<S: Float>(
    arm: &dyn Kinematics<S>,
    info: &ProblemInfo<'_>,
    free: &[S],
    target: &Target<S>,
    tool: &Frame<S>,
) -> Option<Target<S>> {
    let unknowns = Unknowns::of(arm, info, free, S::ONE);
    let hand = |number| {
        let padded = unknowns.q(&unknowns.sample(arm, number));
        arm.fk(padded.get(..arm.dof())?).ok().map(|frame| frame.rotation)
    };
    let first = hand(0)?;
    let (mut turns, mut tilts) = (false, false);
    for number in 1..SAMPLES {
        let [[_, r12, r13], [r21, _, r23], [r31, r32, _]] =
            matrix_product(&hand(number)?, &transpose(&first));
        let differs = |entries: &[S]| entries.iter().any(|x| x.abs() > S::from_f64(SAME) * S::EPSILON);
        turns |= differs(&[r12, r21]);
        tilts |= differs(&[r13, r23, r31, r32]);
    }
    // Half a turn about z differs from none in r11 alone; no sample is exactly that.
    if tilts {
        return None;
    }
    let heading = |rotation: [[S; 3]; 3]| {
        let [x, y, _] = Frame { rotation, ..Frame::IDENTITY }.x_axis();
        (y, x)
    };
    let turned = |yaw: S| {
        let (y, x) = heading(matrix_product(&first, &tool.rotation));
        let level = S::from_f64(SAME) * S::EPSILON;
        // A tool whose x axis stands upright has no yaw.
        let turn = (y.hypot(x) > level).then(|| yaw - y.atan2(x))?;
        let about_z = Frame::from_rpy([S::ZERO; 3], [S::ZERO, S::ZERO, turn]);
        Some(matrix_product(&about_z.rotation, &first))
    };
    let place = |rotation: [[S; 3]; 3], position: [S; 3]| {
        let lever = Frame { rotation, ..Frame::IDENTITY }.transform_vector(tool.translation);
        Frame { rotation, translation: sub(position, lever) }
    };
    let frame = match *target {
        Target::Position(position) if !turns => place(first, position),
        Target::Xy([x, y]) if !turns => place(first, [x, y, S::ZERO]),
        Target::PositionYaw { position, yaw } if turns => place(turned(yaw)?, position),
        Target::XyYaw { position: [x, y], yaw } if turns => place(turned(yaw)?, [x, y, S::ZERO]),
        _ => return None,
    };
    Some(Target::of_frame(info.target, &frame))
}
