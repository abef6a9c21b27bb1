//! A sound for tests.

use std::path::Path;

/// Samples per second.
const RATE: f64 = 48_000.0;
/// Samples of a click: 8 ms.
const CLICK: u64 = 400;

/// Clicks of noise at `bpm` beats per minute from the start on, one channel at 48 kHz, a third of the full amplitude.
pub fn clicks(bpm: f64, secs: f64) -> Vec<i16> {
    let period = 60.0 * RATE / bpm;
    (0..(secs * RATE) as u64)
        .map(|i| {
            let beat = ((i as f64 + 0.5) / period).floor() * period;
            let is_click = i < beat.round() as u64 + CLICK;
            if is_click { (i.wrapping_mul(7919) % 20_000) as i16 - 10_000 } else { 0 }
        })
        .collect()
}

/// Writes clicks, one every half second, as a WAV file of one channel at 48 kHz.
///
/// # Panics
/// If the file cannot be written.
pub fn click_track(path: &Path, secs: u32) {
    let data: Vec<u8> = clicks(120.0, f64::from(secs)).into_iter().flat_map(i16::to_le_bytes).collect();
    let mut bytes = b"RIFF".to_vec();
    bytes.extend((36 + data.len() as u32).to_le_bytes());
    bytes.extend(b"WAVEfmt \x10\0\0\0\x01\0\x01\0\x80\xBB\0\0\0\x77\x01\0\x02\0\x10\0data");
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(data);
    std::fs::write(path, bytes).expect("a file");
}
