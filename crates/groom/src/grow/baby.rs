//! Baby hairs: the short, fine hairs along the hairline.

use lovelock_base::numbers::smoothstep;
use lovelock_base::random::SplitMix64;

/// Lengths of baby hairs, metres.
const LENGTHS: [f32; 2] = [0.008, 0.030];
/// Wavelengths of their waves, and the largest amplitude, metres.
const WAVE_LENGTHS: [f32; 2] = [0.010, 0.022];
const WAVE: f32 = 0.0006;

/// The properties of one baby hair.
#[derive(Clone, Copy)]
pub(super) struct Baby {
    /// Its length, metres.
    pub length: f32,
    /// Its width at the root relative to that of other strands.
    pub width: f32,
    /// Slope of its path across the combed direction, and how the slope changes, per metre.
    slope: f32,
    bend: f32,
    wave: f32,
    wave_length: f32,
    phase: f32,
}

impl Baby {
    /// Fraction of the length over which it thins: it has never been cut.
    pub(super) const TAPER: f32 = 0.9;
    /// How much closer to the skin than the guides it lies, as a fraction.
    pub(super) const DEPTH: f32 = 0.7;
    /// Radius of its curls relative to that of long hair, which forms them over more than its length.
    pub(super) const CURL: f32 = 0.3;

    /// One of many that differ by chance.
    pub(super) fn new(rng: &mut SplitMix64) -> Self {
        let between = |[low, high]: [f32; 2], t: f32| low + (high - low) * t;
        // Short ones are more frequent.
        let length = between(LENGTHS, rng.unit().powi(2));
        Self {
            length,
            width: 0.3 + 0.2 * rng.unit(),
            slope: 0.4 * rng.bell(),
            bend: 8.0 * rng.bell(),
            wave: WAVE * (0.3 + 0.7 * rng.unit()),
            wave_length: between(WAVE_LENGTHS, rng.unit()),
            phase: rng.angle(),
        }
    }

    /// Its distance from the combed path, metres, after `arc` metres from the root.
    pub(super) fn sideways(&self, arc: f32) -> f32 {
        let turn = std::f32::consts::TAU * arc / self.wave_length;
        let wave = self.wave * smoothstep(0.0, 0.006, arc) * (turn + self.phase).sin();
        (self.slope + self.bend * arc) * arc + wave
    }
}
