//! Seeded random numbers: the same sequence on every machine.

use glam::Vec3;

/// `SplitMix64` (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators"): 64 bits of state.
#[derive(Clone, Copy, Debug)]
pub struct SplitMix64(u64);

impl SplitMix64 {
    /// A generator whose state starts at `seed`.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// A separate sequence for each pair of `seed` and `stream`.
    pub fn of_stream(seed: u32, stream: u64) -> Self {
        let mut random = Self((u64::from(seed) << 32) ^ stream.wrapping_mul(0xd1b5_4a32_d192_ed03));
        random.bits();
        random
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in 0..1, in steps of 2⁻²⁴.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1_u64 << 24) as f32
    }

    /// Uniform in 0..1, in steps of 2⁻⁵³.
    pub fn unit_f64(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in -1..1.
    pub fn signed(&mut self) -> f32 {
        2.0 * self.unit() - 1.0
    }

    /// Uniform in the cube whose coordinates are in -1..1.
    pub fn signed_vec3(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    /// Bell-shaped with mean 0 and standard deviation 1, never beyond ±3.5: the scaled sum of four uniform numbers.
    pub fn bell(&mut self) -> f32 {
        (self.unit() + self.unit() + self.unit() + self.unit() - 2.0) * 1.732_050_8
    }

    /// Uniform in 0..2π, radians.
    pub fn angle(&mut self) -> f32 {
        self.unit() * std::f32::consts::TAU
    }
}

#[cfg(test)]
mod tests {
    use super::SplitMix64;

    #[test]
    fn the_sequence_is_the_published_one() {
        // The first outputs for the seed 1234567, as in the reference implementation by Vigna (2015).
        let mut random = SplitMix64::new(1_234_567);
        let expected = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!([(); 5].map(|()| random.bits()), expected);
    }

    #[test]
    fn numbers_stay_in_their_ranges() {
        let mut random = SplitMix64::of_stream(3, 5);
        for _ in 0..10_000 {
            assert!((0.0..1.0).contains(&random.unit()) && (0.0..1.0).contains(&random.unit_f64()));
            assert!((-1.0..1.0).contains(&random.signed()) && random.bell().abs() < 3.5);
        }
    }

    #[test]
    fn streams_of_one_seed_differ() {
        let first = |stream| SplitMix64::of_stream(1, stream).bits();
        assert_ne!(first(0), first(1));
    }
}
