//! Sound of films and sequences.

mod opus;
mod wav;

pub(crate) use opus::{OpusEncoding, PACKET, PRE_SKIP};
pub(crate) use wav::write_wav;

/// Samples per second of the sound in films and of the file beside a sequence.
pub const SOUND_RATE: u32 = 48_000;

/// Where the sound of a recording comes from.
pub trait SoundSource: Send {
    /// Number of channels, 1 or 2.
    fn channels(&self) -> u16;

    /// Fills `out` with interleaved samples from -1 to 1, the first of them `first / SOUND_RATE` seconds after the start of the
    /// recording's first frame. Recordings ask for them in order and without gaps.
    fn fill(&mut self, first: u64, out: &mut [f32]);
}

/// The number of samples that last as long as `frames` images.
pub(crate) fn samples_of(frames: u64, rate: crate::FrameRate) -> u64 {
    let exact = u128::from(frames) * u128::from(rate.den) * u128::from(SOUND_RATE);
    ((exact + u128::from(rate.num) / 2) / u128::from(rate.num)) as u64
}

#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
