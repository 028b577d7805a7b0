//! Pseudo-random numbers that are the same on every machine.

/// A generator of pseudo-random numbers: SplitMix64 (Steele, Lea & Flood 2014). It holds the state, at first the seed.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// Returns the next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number in `low .. high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// Returns a number in −1 .. 1.
    pub fn signed(&mut self) -> f64 {
        self.between(-1.0, 1.0)
    }

    /// Returns a vector of numbers in −1 .. 1.
    pub fn vector<const D: usize>(&mut self) -> [f64; D] {
        core::array::from_fn(|_| self.signed())
    }

    /// Returns `D` rows of `D` numbers in −`size` .. `size`.
    pub fn rows<const D: usize>(&mut self, size: f64) -> [[f64; D]; D] {
        core::array::from_fn(|_| self.vector().map(|x| x * size))
    }
}
