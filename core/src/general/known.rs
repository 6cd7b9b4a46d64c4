//! Solutions that were found, to tell new ones from them.

use super::{JOINTS, waves};

/// Solutions that were found.
pub(crate) struct Known {
    list: [[f64; JOINTS]; 2 * waves::MAX_ROOTS],
    len: usize,
    prismatic: [bool; JOINTS],
    tolerance: f64,
    /// How many more have a positive determinant than a negative one.
    excess: i32,
    /// How many have neither, as far as rounding tells.
    undecided: i32,
}

/// A determinant (reaches, rad) up to here may have either sign: that of a solution that has met another.
const UNDECIDED: f64 = 1e-6;

impl Known {
    /// None yet; two that are nearer than the tolerance are one.
    pub(crate) const fn new(prismatic: [bool; JOINTS], tolerance: f64) -> Self {
        let list = [[0.0; JOINTS]; 2 * waves::MAX_ROOTS];
        Self { list, len: 0, prismatic, tolerance, excess: 0, undecided: 0 }
    }

    /// How many there are.
    pub(super) const fn len(&self) -> usize {
        self.len
    }

    /// The solution at this place.
    pub(crate) fn get(&self, place: usize) -> Option<[f64; JOINTS]> {
        self.list.get(place).filter(|_| place < self.len).copied()
    }

    /// Whether some must be missing: as a target goes out of reach its solutions vanish in pairs, of determinants of either sign.
    pub(crate) const fn is_lopsided(&self) -> bool {
        self.excess.abs() > self.undecided
    }

    /// Whether it was found before.
    pub(crate) fn contains(&self, solution: &[f64; JOINTS]) -> bool {
        let mut known = self.list.iter().take(self.len);
        known.any(|other| same(other, solution, self.prismatic, self.tolerance))
    }

    /// Whether it is new, and there is room for it.
    pub(crate) fn insert(&mut self, solution: &[f64; JOINTS], determinant: f64) -> bool {
        if self.contains(solution) {
            return false;
        }
        let Some(place) = self.list.get_mut(self.len) else { return false };
        *place = *solution;
        self.len += 1;
        if libm::fabs(determinant) <= UNDECIDED {
            self.undecided += 1;
        } else {
            self.excess += if determinant < 0.0 { -1 } else { 1 };
        }
        true
    }
}

/// Whether two sets of joint values are one but for whole turns.
#[inline]
pub(crate) fn same(a: &[f64; JOINTS], b: &[f64; JOINTS], prismatic: [bool; JOINTS], tolerance: f64) -> bool {
    const TURN: f64 = core::f64::consts::TAU;
    a.iter().zip(b).zip(prismatic).all(|((a, b), slides)| {
        let apart = libm::fabs(a - b);
        // Which half of a turn they are apart can't be foreseen: most are told from each other without asking.
        let (off, beyond) = (libm::fabs(apart - TURN), apart > TURN + tolerance);
        let nearest = if slides || apart < off { apart } else { off };
        nearest <= tolerance
            || (beyond && !slides && libm::fabs(crate::Float::wrap_angle(a - b)) <= tolerance)
    })
}
