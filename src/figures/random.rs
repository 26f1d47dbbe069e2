//! Random numbers from seeds.

/// A small random generator (xorshift64*, Vigna 2016).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Returns the generator of a stream of a seed.
    pub fn new(seed: u32, stream: u32) -> Random {
        // SplitMix64's finaliser (Steele et al. 2014) makes neighbouring streams independent.
        let mut z = (u64::from(seed) << 32 | u64::from(stream)).wrapping_add(0x9E37_79B9_7F4A_7C15);
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        Random((z ^ z >> 31) | 1)
    }

    /// Returns a number in 0..1.
    pub fn unit(&mut self) -> f32 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 40) as f32 / (1u64 << 24) as f32
    }

    /// Returns a number about 0 with a variance of 1, within 3.
    pub fn bell(&mut self) -> f32 {
        ((0..3).map(|_| self.unit()).sum::<f32>() - 1.5) * 2.0
    }
}
