//! WAV files beside sequences.

use super::{SOUND_RATE, SoundSource};
use crate::partial::{PartialFile, open_file};
use std::io::{self, Write};
use std::path::Path;

/// Samples per channel that are written at once.
const BLOCK: u64 = 4096;

/// The most samples per channel: the format stores the number of bytes in 32 bits. Of two channels these are six hours.
const MAX: u64 = (u32::MAX as u64 - 64) / 4;

/// Writes `samples` samples per channel as 16-bit PCM, under a temporary name first. Returns the size of the file in bytes.
pub(crate) fn write_wav(path: &Path, source: &mut dyn SoundSource, samples: u64) -> io::Result<u64> {
    let samples = samples.min(MAX);
    let channels = source.channels().clamp(1, 2);
    let bytes = (samples * u64::from(channels) * 2) as u32;
    let mut file = PartialFile::create(path, &open_file)?;
    let mut head = b"RIFF".to_vec();
    head.extend((bytes + 36).to_le_bytes());
    head.extend(b"WAVEfmt ");
    head.extend(16_u32.to_le_bytes());
    head.extend(1_u16.to_le_bytes()); // Whole numbers.
    head.extend(channels.to_le_bytes());
    head.extend(SOUND_RATE.to_le_bytes());
    head.extend((SOUND_RATE * u32::from(channels) * 2).to_le_bytes());
    head.extend((channels * 2).to_le_bytes());
    head.extend(16_u16.to_le_bytes());
    head.extend(b"data");
    head.extend(bytes.to_le_bytes());
    file.write_all(&head)?;
    let mut block = Vec::new();
    let mut at = 0;
    while at < samples {
        let count = BLOCK.min(samples - at);
        block.resize(count as usize * usize::from(channels), 0.0_f32);
        source.fill(at, &mut block);
        for sample in &block {
            // The conversion saturates, and gives 0 for NaN.
            file.write_all(&((sample * 32_768.0).round() as i16).to_le_bytes())?;
        }
        at += count;
    }
    file.commit(true)?;
    Ok(u64::from(bytes) + 44)
}
