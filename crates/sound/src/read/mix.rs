//! Mixes more than two channels to one.

/// Brings samples of any number of channels to one or two.
pub(super) struct Mix {
    channels: usize,
}

impl Mix {
    /// For a file with this many channels, at least one.
    pub(super) fn new(channels: usize) -> Self {
        Self { channels: channels.max(1) }
    }

    /// The number of channels that remain, 1 or 2.
    pub(super) fn channels(&self) -> usize {
        if self.channels == 2 { 2 } else { 1 }
    }

    /// Mixes interleaved samples in place. What is not a number becomes silence.
    pub(super) fn mix(&self, samples: &mut Vec<f32>) {
        for sample in samples.iter_mut().filter(|sample| !sample.is_finite()) {
            *sample = 0.0;
        }
        if self.channels <= 2 {
            return;
        }
        let frames = samples.len() / self.channels;
        for frame in 0..frames {
            let at = frame * self.channels;
            samples[frame] = samples[at..at + self.channels].iter().sum::<f32>() / self.channels as f32;
        }
        samples.truncate(frames);
    }
}
