//! Brings samples to [`RATE`] as they arrive.

use audioadapter_buffers::direct::InterleavedSlice;
use rubato::{Fft, FixedSync, Indexing, Resampler as _, ResamplerConstructionError};

use crate::sound::{RATE, Sound};

/// Samples per channel that are converted at once.
const CHUNK: usize = 1024;

/// Brings samples to [`RATE`] as they arrive, and stores them with 16 bits.
pub(super) struct Resampler {
    channels: usize,
    /// The rate of the input over [`RATE`], and the converter where they differ.
    converter: Option<Fft<f32>>,
    /// Samples that wait for a whole chunk, and those of a converted chunk.
    waiting: Vec<f32>,
    converted: Vec<f32>,
    /// Instants of the input so far, and of the output at its end.
    taken: u64,
    rate: u32,
    /// Converted instants before the first one of the sound: the delay of the converter.
    surplus: usize,
    out: Vec<i16>,
}

impl Resampler {
    /// For samples with `rate` per second.
    pub(super) fn new(rate: u32, channels: usize) -> Result<Self, ResamplerConstructionError> {
        let converter = if rate == RATE {
            None
        } else {
            Some(Fft::new(rate as usize, RATE as usize, CHUNK, channels, FixedSync::Input)?)
        };
        let surplus = converter.as_ref().map_or(0, rubato::Resampler::output_delay);
        let (waiting, converted, out) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self { channels, converter, waiting, converted, taken: 0, rate, surplus, out })
    }

    /// Instants converted so far.
    pub(super) fn frames(&self) -> usize {
        self.out.len() / self.channels
    }

    /// Takes interleaved samples.
    pub(super) fn push(&mut self, samples: &[f32]) {
        self.taken += (samples.len() / self.channels) as u64;
        let Some(converter) = &self.converter else {
            self.out.extend(samples.iter().map(|&sample| Sound::quantised(sample)));
            return;
        };
        let chunk = converter.input_frames_next() * self.channels;
        self.waiting.extend_from_slice(samples);
        let mut used = 0;
        while self.waiting.len() - used >= chunk {
            self.convert(used, None);
            used += chunk;
        }
        self.waiting.drain(..used);
    }

    /// Converts the chunk of waiting samples at `from`, of which only `partial` instants may exist.
    fn convert(&mut self, from: usize, partial: Option<usize>) {
        let Some(converter) = &mut self.converter else { return };
        let frames = converter.output_frames_next();
        self.converted.resize(frames * self.channels, 0.0);
        let input = &self.waiting[from..];
        let input = InterleavedSlice::new(input, self.channels, input.len() / self.channels);
        let output = InterleavedSlice::new_mut(&mut self.converted, self.channels, frames);
        let (Ok(input), Ok(mut output)) = (input, output) else { return };
        let indexing = Indexing { partial_len: partial, ..Indexing::default() };
        // Sizes are those that the converter asked for, so it cannot refuse them.
        let Ok((_, made)) = converter.process_into_buffer(&input, &mut output, Some(&indexing)) else {
            return;
        };
        let skipped = self.surplus.min(made);
        self.surplus -= skipped;
        let kept = &self.converted[skipped * self.channels..made * self.channels];
        self.out.extend(kept.iter().map(|&sample| Sound::quantised(sample)));
    }

    /// The converted sound. Its duration is that of the samples.
    pub(super) fn finish(mut self) -> Vec<i16> {
        let wanted =
            (self.taken as f64 * f64::from(RATE) / f64::from(self.rate)).round() as usize * self.channels;
        if let Some(chunk) = self.converter.as_ref().map(rubato::Resampler::input_frames_next) {
            let left = self.waiting.len() / self.channels;
            self.waiting.resize(chunk * self.channels, 0.0);
            self.convert(0, Some(left));
            // What the converter still holds.
            let mut rounds = 0;
            while self.out.len() < wanted && rounds < 1000 {
                self.convert(0, Some(0));
                rounds += 1;
            }
        }
        self.out.resize(wanted, 0);
        self.out
    }
}
