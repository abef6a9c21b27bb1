//! A sound file: a drum and a bass, in step with the shipped dance.

use std::f64::consts::TAU;

/// Samples per second.
const RATE: u32 = 44_100;
/// The beat of the shipped dance, seconds, and the beats until it starts again.
const BEAT_SECS: f64 = 0.6;
const BEATS: u32 = 16;

/// Frequencies of the bass, one for each two beats, hertz: A, A, F, G, twice.
const BASS: [f64; 4] = [55.0, 55.0, 43.654, 48.999];

/// The sound as a WAV file, one channel of 16 bits.
pub(super) fn beat() -> Vec<u8> {
    let count = (BEAT_SECS * f64::from(BEATS) * f64::from(RATE)).round() as u32;
    let mut noise = 0x2545_F491_u32;
    let samples = (0..count).map(|at| {
        let secs = f64::from(at) / f64::from(RATE);
        noise ^= noise << 13;
        noise ^= noise >> 17;
        noise ^= noise << 5;
        let hiss = f64::from(noise) / f64::from(u32::MAX) * 2.0 - 1.0;
        let value = kick(secs) + 0.5 * clap(secs, hiss) + 0.16 * hat(secs, hiss) + 0.32 * bass(secs);
        (value * 0.62 * 32_767.0).clamp(-32_767.0, 32_767.0) as i16
    });
    wav(&samples.collect::<Vec<i16>>())
}

/// Seconds since the last multiple of `period`, shifted by `offset`.
fn since(secs: f64, period: f64, offset: f64) -> f64 {
    (secs - offset).rem_euclid(period)
}

/// A drum on every beat: a sine whose frequency falls.
fn kick(secs: f64) -> f64 {
    let t = since(secs, BEAT_SECS, 0.0);
    let phase = 48.0 * t + 2.6 * (1.0 - (-t * 34.0).exp());
    (TAU * phase).sin() * (-t * 9.0).exp()
}

/// A clap on every second beat.
fn clap(secs: f64, hiss: f64) -> f64 {
    hiss * (-since(secs, 2.0 * BEAT_SECS, BEAT_SECS) * 22.0).exp()
}

/// A cymbal between the beats.
fn hat(secs: f64, hiss: f64) -> f64 {
    hiss * (-since(secs, BEAT_SECS, 0.5 * BEAT_SECS) * 45.0).exp()
}

/// A bass, twice in a beat.
fn bass(secs: f64) -> f64 {
    let note = BASS[(secs / (2.0 * BEAT_SECS)) as usize % BASS.len()];
    let t = since(secs, 0.5 * BEAT_SECS, 0.0);
    let wave = (TAU * note * secs).sin() + 0.4 * (2.0 * TAU * note * secs).sin();
    wave * (t * 200.0).min(1.0) * (-t * 4.0).exp()
}

fn wav(samples: &[i16]) -> Vec<u8> {
    let bytes = samples.len() as u32 * 2;
    let mut file = Vec::with_capacity(bytes as usize + 44);
    file.extend(b"RIFF");
    file.extend((36 + bytes).to_le_bytes());
    file.extend(b"WAVEfmt ");
    file.extend(16_u32.to_le_bytes());
    // PCM, one channel.
    file.extend([1, 0, 1, 0]);
    file.extend(RATE.to_le_bytes());
    file.extend((RATE * 2).to_le_bytes());
    file.extend([2, 0, 16, 0]);
    file.extend(b"data");
    file.extend(bytes.to_le_bytes());
    file.extend(samples.iter().flat_map(|sample| sample.to_le_bytes()));
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sound_is_as_long_as_the_dance_and_loudest_on_the_beats() {
        let file = beat();
        assert_eq!(file.len(), 44 + 2 * (9.6 * f64::from(RATE)) as usize);
        let at = |secs: f64| {
            let first = 44 + 2 * (secs * f64::from(RATE)) as usize;
            let window = &file[first..first + 2 * 2000];
            let samples = window.as_chunks::<2>().0.iter().map(|two| f64::from(i16::from_le_bytes(*two)));
            samples.map(|sample| sample * sample).sum::<f64>()
        };
        for beat in 1..15 {
            let secs = f64::from(beat) * BEAT_SECS;
            assert!(at(secs) > 2.0 * at(secs - 0.1), "beat {beat}");
        }
    }
}
