//! The seeded random numbers of growing and importing.

/// `SplitMix64` (Steele, Lea, Flood 2014): 64 bits of state, equal on every machine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rng(u64);

impl Rng {
    /// A stream of its own for each pair of `seed` and `stream`.
    pub(crate) fn new(seed: u32, stream: u64) -> Self {
        let mut rng = Self((u64::from(seed) << 32) ^ stream.wrapping_mul(0xd1b5_4a32_d192_ed03));
        rng.next();
        rng
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in 0..1.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1 << 24) as f32
    }

    /// Uniform in -1..1.
    pub(crate) fn signed(&mut self) -> f32 {
        2.0 * self.unit() - 1.0
    }

    /// Bell-shaped about 0 with a standard deviation of 1, never beyond 3.5: the sum of four uniforms, scaled.
    pub(crate) fn bell(&mut self) -> f32 {
        (self.unit() + self.unit() + self.unit() + self.unit() - 2.0) * 1.732_050_8
    }

    /// An angle in 0..2 pi.
    pub(crate) fn angle(&mut self) -> f32 {
        self.unit() * std::f32::consts::TAU
    }
}
