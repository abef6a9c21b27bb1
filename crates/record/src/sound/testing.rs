//! A sound for tests.

use super::{SOUND_RATE, SoundSource};

/// Clicks of 2 kHz with a duration of 5 ms: one every second from `first_secs` on, on the left only if there are two channels.
pub(crate) struct Clicks {
    pub(crate) channels: u16,
    pub(crate) first_secs: f64,
    /// The next sample that is expected: recordings ask without gaps.
    pub(crate) next: u64,
}

impl Clicks {
    pub(crate) fn new(channels: u16, first_secs: f64) -> Self {
        Self { channels, first_secs, next: 0 }
    }

    /// The sample at an instant.
    pub(crate) fn value(&self, sample: u64) -> f32 {
        let secs = sample as f64 / f64::from(SOUND_RATE) - self.first_secs;
        let within = secs.rem_euclid(1.0);
        if secs < 0.0 || within > 0.005 {
            return 0.0;
        }
        (0.7 * (within * 2000.0 * std::f64::consts::TAU).sin()) as f32
    }
}

impl SoundSource for Clicks {
    fn channels(&self) -> u16 {
        self.channels
    }

    fn fill(&mut self, first: u64, out: &mut [f32]) {
        assert_eq!(first, self.next);
        let channels = usize::from(self.channels);
        for (i, instant) in out.chunks_exact_mut(channels).enumerate() {
            instant.fill(0.0);
            instant[0] = self.value(first + i as u64);
        }
        self.next += (out.len() / channels) as u64;
    }
}
