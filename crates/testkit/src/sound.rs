//! A sound for tests.

use std::path::Path;

/// Writes clicks, one every half second, as a WAV file of one channel at 48 kHz.
///
/// # Panics
/// If the file cannot be written.
pub fn click_track(path: &Path, secs: u32) {
    let sample = |i: u32| if i % 24_000 < 400 { (i * 7919 % 20_000) as i16 - 10_000 } else { 0 };
    let data: Vec<u8> = (0..secs * 48_000).map(sample).flat_map(i16::to_le_bytes).collect();
    let mut bytes = b"RIFF".to_vec();
    bytes.extend((36 + data.len() as u32).to_le_bytes());
    bytes.extend(b"WAVEfmt \x10\0\0\0\x01\0\x01\0\x80\xBB\0\0\0\x77\x01\0\x02\0\x10\0data");
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(data);
    std::fs::write(path, bytes).expect("a file");
}
