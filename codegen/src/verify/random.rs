//! A small generator of pseudo-random numbers (splitmix64), so that every host verifies the same poses.

/// State of the generator.
#[derive(Debug, Clone)]
pub(super) struct Random(u64);

impl Random {
    /// A generator of a fixed sequence.
    pub(super) fn new(seed: u64) -> Self {
        Random(seed)
    }

    /// The next 64 bits.
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Evenly distributed in [min, max).
    pub(super) fn between(&mut self, min: f64, max: f64) -> f64 {
        let unit = (self.bits() >> 11) as f64 / (1_u64 << 53) as f64;
        min + (max - min) * unit
    }

    /// One of 0 .. count; 0 where there is nothing to choose from.
    pub(super) fn below(&mut self, count: usize) -> usize {
        (self.bits() % (count.max(1) as u64)) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::Random;

    #[test]
    fn sequence_is_fixed_and_stays_in_range() {
        let mut random = Random::new(0);
        assert_eq!(random.bits(), 0xe220_a839_7b1d_cdaf);
        let mut sum = 0.0;
        for _ in 0..1000 {
            let value = random.between(-2.0, 1.0);
            assert!((-2.0..1.0).contains(&value));
            assert!(random.below(3) < 3);
            sum += value;
        }
        assert!((sum / 1000.0 + 0.5).abs() < 0.1);
    }
}
