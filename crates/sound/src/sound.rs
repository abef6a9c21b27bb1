//! A sound in memory.

use std::ops::Range;

/// Samples per second of every [`Sound`], the rate of sound in films.
pub const RATE: u32 = 48_000;

/// A sound in memory: 16 bits, [`RATE`] samples per second, one or two channels.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sound {
    /// Samples, the channels of an instant beside each other.
    samples: Vec<i16>,
    /// 1 (mono) or 2 (left, right).
    channels: usize,
}

impl Sound {
    /// The memory of the samples, bytes.
    pub fn bytes(&self) -> u64 {
        2 * self.samples.capacity() as u64
    }

    /// A sound of interleaved samples. Anything but two channels is taken as one.
    pub fn new(mut samples: Vec<i16>, channels: usize) -> Self {
        let channels = if channels == 2 { 2 } else { 1 };
        samples.truncate(samples.len() / channels * channels);
        Self { samples, channels }
    }

    /// The nearest 16-bit value of a sample from -1 to 1. Values outside are clipped, and what is not a number becomes silence.
    pub fn quantised(sample: f32) -> i16 {
        // The conversion saturates, and gives 0 for NaN.
        (sample * 32_768.0).round() as i16
    }

    /// Number of channels, 1 or 2.
    pub fn channels(&self) -> usize {
        self.channels.max(1)
    }

    /// Number of instants with a sample per channel.
    pub fn frames(&self) -> usize {
        self.samples.len() / self.channels()
    }

    /// Duration, seconds.
    pub fn secs(&self) -> f64 {
        self.frames() as f64 / f64::from(RATE)
    }

    /// Left and right at an instant, from -1 to 1; silence outside the sound.
    pub fn stereo(&self, frame: i64) -> [f32; 2] {
        let channels = self.channels();
        let Some(at) = usize::try_from(frame).ok().filter(|&frame| frame < self.frames()) else {
            return [0.0; 2];
        };
        let value = |channel: usize| f32::from(self.samples[at * channels + channel]) / 32_768.0;
        [value(0), value(channels - 1)]
    }

    /// Left and right between two instants, by linear interpolation.
    pub fn stereo_between(&self, frame: f64) -> [f32; 2] {
        let before = frame.floor();
        let t = (frame - before) as f32;
        let (a, b) = (self.stereo(before as i64), self.stereo((before as i64).saturating_add(1)));
        [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]
    }

    /// The mean of the channels at some instants, from -1 to 1; silence outside the sound.
    pub fn mono(&self, frames: Range<i64>, out: &mut [f32]) {
        for (out, frame) in out.iter_mut().zip(frames) {
            let [left, right] = self.stereo(frame);
            *out = 0.5 * (left + right);
        }
    }

    /// Interleaved samples.
    pub fn samples(&self) -> &[i16] {
        &self.samples
    }
}

#[cfg(test)]
mod tests {
    use super::Sound;

    #[test]
    fn samples_are_found_by_their_instant_and_silence_lies_outside() {
        let stereo = Sound::new(vec![8192, -8192, 16_384, 0, 5], 2);
        assert_eq!((stereo.frames(), stereo.channels()), (2, 2), "an odd sample is left out");
        assert_eq!(stereo.stereo(1), [0.5, 0.0]);
        assert_eq!(stereo.stereo_between(0.5), [0.375, -0.125]);
        for outside in [-1, 2, i64::MAX, i64::MIN] {
            assert_eq!(stereo.stereo(outside), [0.0; 2]);
        }
        assert_eq!(Sound::new(vec![16_384], 1).stereo(0), [0.5, 0.5], "mono is on both sides");
        let none = Sound::default();
        assert_eq!((none.frames(), none.stereo(0)), (0, [0.0; 2]));
    }

    #[test]
    fn what_is_no_sample_is_clipped_or_silent() {
        let values = [0.0, 0.5, 1.0, -1.0, 7.0, f32::NEG_INFINITY, f32::NAN];
        assert_eq!(values.map(Sound::quantised), [0, 16_384, 32_767, -32_768, 32_767, -32_768, 0]);
    }
}
