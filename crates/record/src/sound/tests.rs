use super::testing::Clicks;
use super::*;
use crate::{FilmQuality, FrameRate};
use opus_rs::OpusDecoder;

/// Encodes and decodes two seconds.
fn decoded(channels: u16, quality: FilmQuality) -> (Vec<f32>, usize) {
    let mut encoding =
        OpusEncoding::new(Box::new(Clicks::new(channels, 0.25)), quality.sound_bits()).unwrap();
    // In parts, as a film does it.
    let mut packets = Vec::new();
    for part in 1..=10 {
        packets.extend(encoding.packets_until(part * 9600).unwrap());
    }
    let mut decoder = OpusDecoder::new(SOUND_RATE as i32, usize::from(channels)).unwrap();
    let mut samples = Vec::new();
    for packet in &packets {
        let mut part = vec![0.0; PACKET * usize::from(channels)];
        assert_eq!(decoder.decode(packet, PACKET, &mut part).unwrap(), PACKET);
        samples.extend(part);
    }
    (samples, packets.iter().map(Vec::len).sum())
}

#[test]
fn a_sound_survives_and_its_delay_is_the_stated_one() {
    let mut sizes = Vec::new();
    for (channels, quality) in [(1, FilmQuality::Draft), (2, FilmQuality::High), (2, FilmQuality::Best)] {
        let (samples, bytes) = decoded(channels, quality);
        let clicks = Clicks::new(channels, 0.25);
        let error = |delay: u64| {
            let each = samples.chunks_exact(usize::from(channels)).skip(delay as usize).zip(0..40_000);
            let (mut wrong, mut power) = (0.0, 0.0);
            for (instant, i) in each {
                wrong += (instant[0] - clicks.value(i)).powi(2);
                power += clicks.value(i).powi(2);
            }
            wrong / power
        };
        let best = (90..150).min_by(|a, b| error(*a).total_cmp(&error(*b))).unwrap();
        assert_eq!(best, u64::from(PRE_SKIP), "{channels} channels");
        assert!(error(best) < 0.05, "{channels} channels: {}", error(best));
        assert!(error(best + 5) > 0.3, "control");
        if channels == 2 {
            let right: f32 = samples.chunks_exact(2).map(|instant| instant[1].abs()).fold(0.0, f32::max);
            assert!(right < 0.05, "the right stays silent: {right}");
        }
        sizes.push(bytes);
    }
    assert!(sizes[0] < sizes[1] && sizes[1] <= sizes[2] && sizes[2] < 2 * 256_000 / 8 * 5 / 4, "{sizes:?}");
}

#[test]
fn extreme_samples_are_encoded() {
    struct Extreme;
    impl SoundSource for Extreme {
        fn channels(&self) -> u16 {
            2
        }
        fn fill(&mut self, first: u64, out: &mut [f32]) {
            let values = [f32::NAN, f32::INFINITY, -9e30, 1.0, -1.0, 0.0];
            out.iter_mut().enumerate().for_each(|(i, s)| *s = values[(i / 7 + first as usize) % 6]);
        }
    }
    let mut encoding = OpusEncoding::new(Box::new(Extreme), FilmQuality::High.sound_bits()).unwrap();
    assert_eq!(encoding.packets_until(48_000).unwrap().len(), 51);
}

#[test]
fn a_wav_file_has_the_samples_of_its_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ü.wav");
    let samples = samples_of(7, FrameRate::from_fps(29.97).unwrap());
    assert_eq!(samples, 11_211, "7 frames of 1001/30000 s");
    let mut clicks = Clicks::new(2, 0.1);
    let bytes = write_wav(&path, &mut clicks, samples).unwrap();
    let data = std::fs::read(&path).unwrap();
    assert_eq!((data.len() as u64, bytes), (11_211 * 4 + 44, bytes));
    let word = |at: usize| u32::from_le_bytes(data[at..at + 4].try_into().unwrap());
    assert_eq!((word(4), word(24), word(40)), (data.len() as u32 - 8, 48_000, 11_211 * 4));
    let left = |i: usize| i16::from_le_bytes(data[44 + 4 * i..46 + 4 * i].try_into().unwrap());
    for i in [0, 4799, 4806, 4900, 11_210] {
        assert!((f32::from(left(i)) / 32_768.0 - clicks.value(i as u64)).abs() < 1e-4, "{i}");
    }
    assert_ne!(left(4806), 0);
}
