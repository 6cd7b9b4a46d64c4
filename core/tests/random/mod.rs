//! Reproducible random numbers.

use dh_core::Float;

/// `SplitMix64` \[Steele, Lea, Flood 2014\].
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Uniform in `from` to `to`.
    pub(crate) fn between<S: Float>(&mut self, from: f64, to: f64) -> S {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^= bits >> 31;
        let unit = (bits >> 11) as f64 / (1_u64 << 53) as f64;
        S::from_f64(from + unit * (to - from))
    }
}
