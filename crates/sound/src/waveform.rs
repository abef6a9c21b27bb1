//! The outline of a sound, for drawing it at any width.

use crate::sound::{RATE, Sound};

/// Samples per entry of the finest level.
const FINEST: usize = 256;

/// The lowest and the highest sample of each part of a sound, at resolutions from a fixed number of samples to the whole sound. Each level has
/// half the entries of the level before, so all of them have at most 1/64 of the samples.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Waveform {
    frames: usize,
    levels: Vec<Vec<[i16; 2]>>,
}

impl Waveform {
    /// The outline of a sound, over both channels.
    pub fn of(sound: &Sound) -> Self {
        let join = |parts: &[[i16; 2]]| {
            parts.iter().fold([i16::MAX, i16::MIN], |[low, high], part| [low.min(part[0]), high.max(part[1])])
        };
        let blocks = sound.samples().chunks(FINEST * sound.channels());
        let extremes = |block: &[i16]| {
            block.iter().fold([i16::MAX, i16::MIN], |[low, high], &s| [low.min(s), high.max(s)])
        };
        let mut levels = vec![blocks.map(extremes).collect::<Vec<_>>()];
        while let Some(last) = levels.last().filter(|last| last.len() > 1) {
            let next = last.chunks(2).map(join).collect();
            levels.push(next);
        }
        Self { frames: sound.frames(), levels }
    }

    /// The lowest and the highest sample, from -1 to 1, in each of `columns` equal parts of the time from `secs[0]` to `secs[1]`; `None`
    /// for parts outside the sound. The level is chosen so that a part reads 8 to 16 entries, however long it is.
    pub fn columns(&self, secs: [f64; 2], columns: usize) -> Vec<Option<[f32; 2]>> {
        let per_column = (secs[1] - secs[0]) * f64::from(RATE) / columns.max(1) as f64;
        let wanted = (per_column / (8 * FINEST) as f64).max(1.0).log2().floor();
        // NaN becomes 0.
        let level = (wanted as usize).min(self.levels.len().saturating_sub(1));
        let (Some(entries), true) = (self.levels.get(level), per_column.is_finite() && per_column > 0.0)
        else {
            return vec![None; columns];
        };
        let entry_samples = (FINEST << level) as f64;
        let at = |column: usize| (secs[0] * f64::from(RATE) + column as f64 * per_column) / entry_samples;
        (0..columns)
            .map(|column| {
                let (from, to) = (at(column), at(column + 1));
                if to <= 0.0 || from >= self.frames as f64 / entry_samples {
                    return None;
                }
                let from = from.max(0.0) as usize;
                let to = (to.ceil() as usize).clamp(from + 1, entries.len());
                let [low, high] = entries[from..to]
                    .iter()
                    .fold([i16::MAX, i16::MIN], |[low, high], part| [low.min(part[0]), high.max(part[1])]);
                Some([low, high].map(|sample| f32::from(sample) / 32_768.0))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Waveform;
    use crate::sound::{RATE, Sound};

    #[test]
    fn the_outline_is_that_of_the_samples_at_every_width() {
        // Ten seconds: silence, and half a second of a square wave of 0.5 from second 4 on, with one sample of -1 in it.
        let mut samples = vec![0_i16; 10 * RATE as usize];
        for (i, sample) in samples[4 * 48_000..4 * 48_000 + 24_000].iter_mut().enumerate() {
            *sample = if i % 100 < 50 { 16_384 } else { -16_384 };
        }
        samples[4 * 48_000 + 12_345] = i16::MIN;
        let waveform = Waveform::of(&Sound::new(samples, 1));
        for columns in [1, 7, 10, 100, 1000, 20_000] {
            let outline = waveform.columns([0.0, 10.0], columns);
            let lowest = outline.iter().flatten().map(|part| part[0]).fold(0.0, f32::min);
            let highest = outline.iter().flatten().map(|part| part[1]).fold(0.0, f32::max);
            assert_eq!((lowest, highest, outline.len()), (-1.0, 0.5, columns));
            // Silence stays silent, up to the resolution of the level.
            let loud: Vec<_> =
                outline.iter().enumerate().filter(|(_, part)| **part != Some([0.0; 2])).collect();
            let (first, last) = (loud[0].0 as f64, loud[loud.len() - 1].0 as f64 + 1.0);
            let column = 10.0 / columns as f64;
            assert!((first * column - 4.0).abs() <= column + 0.011, "{columns}: from {}", first * column);
            assert!((last * column - 4.5).abs() <= column + 0.011, "{columns}: to {}", last * column);
        }
    }

    #[test]
    fn there_is_nothing_outside_the_sound() {
        let waveform = Waveform::of(&Sound::new(vec![100; 48_000], 1));
        let outline = waveform.columns([-1.0, 2.0], 3);
        assert_eq!(outline.iter().map(Option::is_some).collect::<Vec<_>>(), [false, true, false]);
        for bad in [[0.0, 0.0], [1.0, 0.0], [f64::NAN, 1.0], [0.0, f64::INFINITY]] {
            assert_eq!(waveform.columns(bad, 2), [None, None], "{bad:?}");
        }
        assert_eq!(Waveform::of(&Sound::default()).columns([0.0, 1.0], 2), [None, None]);
    }
}
