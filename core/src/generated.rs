//! What generated code needs at its edges: slices into arrays and back, targets into numbers.

use crate::target::{Numbers, Target, TargetKind};
use crate::{Float, Frame, IkError, LengthError};

/// Joint values as an array.
///
/// # Errors
/// Where there are not `N`.
pub fn joint_array<const N: usize, S>(q: &[S]) -> Result<&[S; N], LengthError> {
    q.try_into().map_err(|_| LengthError { expected: N, got: q.len() })
}

/// Copies values to the beginning of `out`, and says how many.
///
/// # Errors
/// Where `out` is too short.
pub fn copy_into<T: Copy>(values: &[T], out: &mut [T]) -> Result<usize, LengthError> {
    let error = LengthError { expected: values.len(), got: out.len() };
    out.get_mut(..values.len()).ok_or(error)?.copy_from_slice(values);
    Ok(values.len())
}

impl<S: Float> Target<S> {
    /// [`Target::validate`], for a problem that takes this kind of target only.
    ///
    /// # Errors
    /// [`IkError::WrongTarget`], or those of [`Target::validate`].
    pub fn validate_as(&self, expected: TargetKind) -> Result<Self, IkError<S>> {
        if self.kind() == expected { self.validate() } else { Err(IkError::WrongTarget { expected }) }
    }
}

impl<S: Float> Target<S> {
    /// [`Target::validate`], of a pose.
    ///
    /// # Errors
    /// [`IkError::WrongTarget`], or those of [`Target::validate`].
    pub fn validate_pose(&self) -> Result<Frame<S>, IkError<S>> {
        let Self::Pose(pose) = self else {
            return Err(IkError::WrongTarget { expected: TargetKind::Pose });
        };
        pose.validated()
    }
}

impl<S: Float> Numbers<S> {
    /// The first `K` numbers; 0 for those that the target does not have.
    pub fn array<const K: usize>(&self) -> [S; K] {
        let mut array = [S::ZERO; K];
        for (to, from) in array.iter_mut().zip(self.iter()) {
            *to = *from;
        }
        array
    }
}

#[cfg(test)]
mod tests {
    use super::{copy_into, joint_array};
    use crate::{IkError, LengthError, Target, TargetKind};

    #[test]
    fn lengths_are_checked() {
        assert_eq!(joint_array::<2, _>(&[1.0, 2.0]), Ok(&[1.0, 2.0]));
        assert_eq!(joint_array::<2, f64>(&[1.0]), Err(LengthError { expected: 2, got: 1 }));
        let mut out = [0; 3];
        assert_eq!(copy_into(&[1, 2], &mut out), Ok(2));
        assert_eq!(out, [1, 2, 0]);
        assert_eq!(copy_into(&[0; 4], &mut out), Err(LengthError { expected: 4, got: 3 }));
    }

    #[test]
    fn a_target_of_another_kind_is_refused() {
        let target = Target::Xy([1.0, 2.0]);
        let expected = TargetKind::Pose;
        assert_eq!(target.validate_as(expected), Err(IkError::WrongTarget { expected }));
        assert_eq!(target.validate_as(TargetKind::Xy), Ok(target));
        assert_eq!(target.numbers().array(), [1.0, 2.0, 0.0]);
    }
}
