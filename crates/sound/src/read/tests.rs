use std::io::Write as _;

use lovelock_testkit::fuzz::damaged;

use super::*;

/// Reads bytes as a file.
fn read(bytes: &[u8]) -> Result<(Sound, Source), SoundError> {
    let mut file = tempfile::Builder::new().prefix("sound ü ").tempfile().expect("a file");
    file.write_all(bytes).expect("written");
    read_sound(file.path(), &mut |_| ControlFlow::Continue(()))
}

/// A WAV file of any contents. `format` 1 is integers and 3 floats.
fn wav(format: u16, channels: u16, rate: u32, bits: u16, data: &[u8]) -> Vec<u8> {
    let block = channels.wrapping_mul(bits / 8);
    let mut out = b"RIFF".to_vec();
    out.extend((36 + data.len() as u32).to_le_bytes());
    out.extend(b"WAVEfmt \x10\0\0\0");
    out.extend(format.to_le_bytes());
    out.extend(channels.to_le_bytes());
    out.extend(rate.to_le_bytes());
    out.extend(rate.wrapping_mul(u32::from(block)).to_le_bytes());
    out.extend(block.to_le_bytes());
    out.extend(bits.to_le_bytes());
    out.extend(b"data");
    out.extend((data.len() as u32).to_le_bytes());
    out.extend(data);
    out
}

/// Samples of a sine of 440 Hz on every channel.
fn sine(rate: u32, secs: f64, channels: usize, amplitude: f64) -> Vec<f32> {
    let frames = (f64::from(rate) * secs) as usize;
    let value =
        |i: usize| (amplitude * (std::f64::consts::TAU * 440.0 * i as f64 / f64::from(rate)).sin()) as f32;
    (0..frames).flat_map(|i| std::iter::repeat_n(value(i), channels)).collect()
}

fn bytes_16(samples: &[f32]) -> Vec<u8> {
    samples.iter().flat_map(|&s| Sound::quantised(s).to_le_bytes()).collect()
}

/// The largest difference of a sound from a sine of 440 Hz, apart from its first and last 50 ms.
fn error_of(sound: &Sound, amplitude: f64) -> f64 {
    let value = |i: i64| amplitude * (std::f64::consts::TAU * 440.0 * i as f64 / f64::from(RATE)).sin();
    let inner = 2400..sound.frames() as i64 - 2400;
    inner.map(|i| (f64::from(sound.stereo(i)[0]) - value(i)).abs()).fold(0.0, f64::max)
}

#[test]
fn a_sine_keeps_its_amplitude_length_and_phase_at_every_rate() {
    for rate in [8_000, 22_050, 44_100, 48_000, 96_000, 192_000] {
        for channels in [1_u16, 2] {
            let data = bytes_16(&sine(rate, 0.5, usize::from(channels), 0.5));
            let (sound, source) = read(&wav(1, channels, rate, 16, &data)).expect("a sound");
            assert_eq!(
                (source.rate, source.channels, source.format.as_str()),
                (rate, channels.into(), "WAV (pcm_s16le)")
            );
            assert_eq!((sound.frames(), sound.channels()), (24_000, channels.into()), "{rate}");
            let error = error_of(&sound, 0.5);
            assert!(error < 0.002, "{rate}: {error}");
            assert!(source.notes.is_empty(), "{:?}", source.notes);
        }
    }
    // Negative control: another amplitude is noticed.
    let (sound, _) = read(&wav(1, 1, 48_000, 16, &bytes_16(&sine(48_000, 0.5, 1, 0.5)))).expect("a sound");
    assert!(error_of(&sound, 0.51) > 0.008);
}

#[test]
fn floats_and_other_widths_are_read_and_what_is_no_number_is_silent() {
    let samples = sine(48_000, 0.25, 1, 0.5);
    let floats: Vec<u8> = samples.iter().flat_map(|s| s.to_le_bytes()).collect();
    let whole = |s: &f32, scale: f64| (f64::from(*s) * scale) as i32;
    let of_24: Vec<u8> =
        samples.iter().flat_map(|s| whole(s, 8_388_608.0).to_le_bytes()[..3].to_vec()).collect();
    let of_8: Vec<u8> = samples.iter().map(|s| (f64::from(*s) * 127.0 + 128.0) as u8).collect();
    for (format, bits, data, most) in [(3, 32, &floats, 1e-4), (1, 24, &of_24, 1e-4), (1, 8, &of_8, 0.02)] {
        let (sound, _) = read(&wav(format, 1, 48_000, bits, data)).expect("a sound");
        let error = error_of(&sound, 0.5);
        assert!(error < most, "{bits} bits: {error}");
    }
    let bad: Vec<u8> =
        [f32::NAN, f32::INFINITY, 5.0, -5.0, 0.25].iter().flat_map(|s| s.to_le_bytes()).collect();
    let (sound, _) = read(&wav(3, 1, 48_000, 32, &bad)).expect("a sound");
    assert_eq!(sound.samples(), [0, 0, i16::MAX, i16::MIN, 8192]);
}

#[test]
fn more_than_two_channels_are_mixed_to_one() {
    let data = bytes_16(&[0.4, 0.0, 0.0, 0.0, 0.2, 0.0]).repeat(1000);
    let (sound, source) = read(&wav(1, 6, 48_000, 16, &data)).expect("a sound");
    assert_eq!((sound.channels(), sound.frames(), source.channels), (1, 1000, 6));
    assert!((sound.stereo(500)[0] - 0.1).abs() < 1e-3);
    assert_eq!(source.notes, ["its 6 channels are mixed to one"]);
}

/// Half a second of 440 Hz by FFmpeg, with an amplitude of 0.5.
const TONES: [(&str, &[u8]); 3] = [
    ("MP3", include_bytes!("fixtures/tone.mp3")),
    ("Ogg Vorbis", include_bytes!("fixtures/tone.ogg")),
    ("FLAC", include_bytes!("fixtures/tone.flac")),
];

#[test]
fn each_format_is_read_by_its_contents() {
    for (format, bytes) in TONES {
        assert!(is_sound(&bytes[..12]), "{format}");
        let (sound, source) = read(bytes).unwrap_or_else(|error| panic!("{format}: {error}"));
        assert_eq!(source.format, format);
        assert!((sound.secs() - 0.5).abs() < 0.03, "{format}: {} s", sound.secs());
        // Power is independent of the delay that an encoder adds.
        let inner = sound.samples()[4800..19_200].iter().map(|&s| (f64::from(s) / 32_768.0).powi(2));
        let amplitude = (2.0 * inner.sum::<f64>() / 14_400.0).sqrt();
        // LAME lowers the amplitude by 5 %.
        assert!((amplitude - 0.5).abs() < 0.03, "{format}: {amplitude}");
    }
    assert!(is_sound(&wav(1, 1, 48_000, 16, &[0; 8])));
    for other in [&b"glTF\x02\0\0\0...."[..], b"RIFF....AVI ", b"\xFF\xD8\xFF\xE0....", b"\xFF\xFE", b""] {
        assert!(!is_sound(other), "{other:?}");
    }
}

#[test]
fn what_is_no_sound_is_refused_in_a_sentence() {
    let data = [0; 64];
    let long = wav(1, 1, 4_000, 8, &vec![128; 4_000 * 1801]);
    let cases: [(&str, Vec<u8>, &str); 11] = [
        ("empty", Vec::new(), "empty file"),
        ("text", b"This is a letter and no sound at all. ".repeat(20), "no sound"),
        ("zeros", vec![0; 5000], "no sound of a known format; must be a sound: WAV"),
        (
            "AIFF",
            [&b"FORM\0\0\x10\0AIFFCOMM"[..], &[0; 5000]].concat(),
            "the format AIFF; must be a sound: WAV",
        ),
        ("Opus", [&b"OggS"[..], &[0; 24], b"OpusHead", &[0; 99]].concat(), "the format Opus"),
        ("no samples", wav(1, 2, 44_100, 16, &[]), "no samples"),
        ("no channels", wav(1, 0, 44_100, 16, &data), "channel count"),
        ("rate 0", wav(1, 1, 0, 16, &data), "0"),
        ("rate 4 GHz", wav(1, 1, u32::MAX, 16, &data), "4294967295 samples per second"),
        ("half an hour and a second", long, "30 minutes"),
        ("a picture", b"\x89PNG\r\n\x1a\n".repeat(100), "no sound"),
    ];
    for (what, bytes, word) in cases {
        let error = read(&bytes).expect_err(what).to_string();
        assert!(
            error.contains(word) && error.contains("sound ü") && error.lines().count() == 1,
            "{what}: {error}"
        );
    }
    let missing =
        read_sound(Path::new("/nowhere/ü.wav"), &mut |_| ControlFlow::Continue(())).expect_err("missing");
    assert!(missing.to_string().contains("/nowhere/ü.wav: could not be read"), "{missing}");
    let folder = tempfile::tempdir().expect("a folder");
    let error =
        read_sound(folder.path(), &mut |_| ControlFlow::Continue(())).expect_err("a folder").to_string();
    assert!(error.contains("could not be read"), "{error}");
}

#[test]
fn a_file_that_is_cut_is_read_up_to_there() {
    let whole = wav(1, 1, 48_000, 16, &bytes_16(&sine(48_000, 1.0, 1, 0.5)));
    let (sound, _) = read(&whole[..44 + 48_000]).expect("half of it");
    assert!((sound.secs() - 0.5).abs() < 0.03, "{} s", sound.secs());
    for (format, bytes) in TONES {
        for length in 0..bytes.len() {
            // Every length of the head, then every seventh.
            if length > 300 && length % 7 != 0 {
                continue;
            }
            if let Ok((sound, _)) = read(&bytes[..length]) {
                assert!(sound.secs() <= 0.55, "{format} of {length} bytes: {} s", sound.secs());
            }
        }
    }
}

/// Reads bytes and checks what a sound guarantees. Returns whether they were accepted.
fn holds_its_promise(bytes: &[u8]) -> bool {
    let Ok((sound, source)) = read(bytes) else { return false };
    assert!((1..=MAX_CHANNELS).contains(&source.channels) && RATES.contains(&source.rate));
    // A stated rate of 4 kHz in place of 192 kHz lengthens a sound 48 times, and a file may be made longer.
    assert!(sound.secs() < 600.0, "{} s of {} bytes", sound.secs(), bytes.len());
    true
}

/// Runs the damaged copies of a file through its reader.
fn run(name: &str, file: &[u8]) {
    let counts = damaged(name, &[file.to_vec()], 400, holds_its_promise);
    assert!(counts.accepted > counts.inputs / 20, "much damage leaves something to read: {counts:?}");
}

#[test]
fn damaged_sound_wav() {
    run("wav", &wav(1, 2, 44_100, 16, &bytes_16(&sine(44_100, 0.02, 2, 0.5))));
}

#[test]
fn damaged_sound_mp3() {
    run("mp3", TONES[0].1);
}

/// An Ogg file whose pages have the checksums of their bytes, so that damage gets past the container.
fn with_checksums(mut bytes: Vec<u8>) -> Vec<u8> {
    let mut at = 0;
    while bytes.get(at..at + 27).is_some_and(|head| head.starts_with(b"OggS")) {
        let segments = usize::from(bytes[at + 26]);
        let Some(sizes) = bytes.get(at + 27..at + 27 + segments) else { break };
        let end = at + 27 + segments + sizes.iter().map(|&size| usize::from(size)).sum::<usize>();
        let Some(page) = bytes.get_mut(at..end) else { break };
        page[22..26].fill(0);
        let checksum = page.iter().fold(0_u32, |sum, &byte| {
            (0..8).fold(sum ^ u32::from(byte) << 24, |sum, _| {
                if sum >> 31 == 1 { sum << 1 ^ 0x04C1_1DB7 } else { sum << 1 }
            })
        });
        page[22..26].copy_from_slice(&checksum.to_le_bytes());
        at = end;
    }
    bytes
}

#[test]
fn damaged_sound_ogg() {
    let whole = TONES[1].1;
    assert!(with_checksums(whole.to_vec()) == whole, "the checksums are those of the format");
    let counts = damaged("ogg", &[whole.to_vec()], 400, |bytes| {
        holds_its_promise(bytes) | holds_its_promise(&with_checksums(bytes.to_vec()))
    });
    // Measured: 14 of 400, because most of a short file is the codebooks. Without the checksums none.
    assert!(counts.accepted > counts.inputs / 100, "some damage leaves something to read: {counts:?}");
}

#[test]
fn damaged_sound_flac() {
    run("flac", TONES[2].1);
}

#[test]
fn reading_reports_progress_and_can_be_cancelled() {
    let data = wav(1, 1, 48_000, 16, &bytes_16(&sine(48_000, 4.0, 1, 0.5)));
    let mut file = tempfile::NamedTempFile::new().expect("a file");
    file.write_all(&data).expect("written");
    let mut seen = Vec::new();
    read_sound(file.path(), &mut |part| {
        seen.push(part);
        ControlFlow::Continue(())
    })
    .expect("a sound");
    assert!(seen.windows(2).all(|w| w[0] <= w[1]) && seen[seen.len() - 1] > 0.9, "{seen:?}");
    let stopped = read_sound(file.path(), &mut |part| {
        if part > 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(matches!(stopped, Err(SoundError::Cancelled)));
}

/// A WAV file of a sine of one second whose lengths are replaced; `after` follows the samples.
fn with_lengths(form: &[u8], riff: u32, data: u32, after: &[u8]) -> Vec<u8> {
    let mut bytes = wav(1, 1, 22_050, 16, &bytes_16(&sine(22_050, 1.0, 1, 0.5)));
    bytes[..4].copy_from_slice(form);
    bytes[4..8].copy_from_slice(&riff.to_le_bytes());
    bytes[40..44].copy_from_slice(&data.to_le_bytes());
    bytes.extend(after);
    bytes
}

#[test]
fn headers_that_state_no_or_a_wrong_length_are_played_to_the_end() {
    const SAMPLES: u32 = 44_100;
    let list = b"LIST\x0c\0\0\0INFOISFT\0\0\0\0";
    for (what, bytes, note) in [
        ("RIFF 0", with_lengths(b"RIFF", 0, SAMPLES, &[]), ""),
        ("RIFF 0, chunks after", with_lengths(b"RIFF", 0, SAMPLES, list), ""),
        ("data 0", with_lengths(b"RIFF", 0, 0, &[]), "no length"),
        ("data ffffffff", with_lengths(b"RIFF", u32::MAX, u32::MAX, &[]), "no length"),
        ("data 7fffffff", with_lengths(b"RIFF", 0x7fff_fff0, 0x7fff_ff00, &[]), "of which 44100 are there"),
        ("RIFF too short", with_lengths(b"RIFF", 40, SAMPLES, &[]), ""),
        ("RF64 without ds64", with_lengths(b"RF64", u32::MAX, u32::MAX, &[]), "no length"),
        ("BW64", with_lengths(b"BW64", u32::MAX, SAMPLES, &[]), ""),
        ("odd end", with_lengths(b"RIFF", 0, 0, &[0]), "no length"),
        ("no chunk after", with_lengths(b"RIFF", 0, SAMPLES, &[0; 9]), "9 bytes after the sound"),
    ] {
        assert!(is_sound(&bytes[..12]), "{what}");
        let (sound, source) = read(&bytes).expect(what);
        assert_eq!(sound.frames(), 48_000, "{what}: {:?}", source.notes);
        assert!(error_of(&sound, 0.5) < 0.002, "{what}");
        assert_eq!(source.notes.len(), usize::from(!note.is_empty()), "{what}: {:?}", source.notes);
        assert!(source.notes.iter().all(|found| found.contains(note)), "{what}: {:?}", source.notes);
    }
    // Negative controls: half of the samples stated, none there, none of any length.
    let (half, _) = read(&with_lengths(b"RIFF", 0, SAMPLES / 2, &[])).expect("half");
    assert_eq!(half.frames(), 24_000);
    for bytes in [wav(1, 1, 22_050, 16, &[]), [&wav(1, 1, 22_050, 16, &[]), &list[..]].concat()] {
        let error = read(&bytes).expect_err("no samples").to_string();
        assert!(error.contains("the `data` chunk is empty"), "{error}");
    }
    let error = read(&with_lengths(b"RIFX", 0, 0, &[])).expect_err("big-endian").to_string();
    assert!(error.contains("RIFX"), "{error}");
}

#[test]
fn sizes_of_64_bits_odd_chunks_and_other_formats_of_a_wav_file() {
    let samples = bytes_16(&sine(22_050, 1.0, 1, 0.5));
    let plain = wav(1, 1, 22_050, 16, &samples);
    let (format, data) = (&plain[12..36], &plain[36..]);
    let size = (samples.len() as u64).to_le_bytes();
    let large = [
        b"RF64\xff\xff\xff\xffWAVEds64\x1c\0\0\0",
        &[0; 8][..],
        &size,
        &[0; 12],
        format,
        b"data\xff\xff\xff\xff",
    ];
    let large = [&large.concat()[..], &samples, b"LIST\x04\0\0\0INFO"].concat();
    let odd = |padding: &[u8]| [b"RIFF\0\0\0\0WAVEbext\x03\0\0\0abc", padding, format, data].concat();
    let mut floats = wav(
        0xfffe,
        1,
        22_050,
        32,
        &sine(22_050, 1.0, 1, 0.5).iter().flat_map(|s| s.to_le_bytes()).collect::<Vec<u8>>(),
    );
    floats[16] = 40;
    // Extensible, with a wrong size of the extension and no number of valid bits.
    let extension =
        [&[0, 0, 0, 0, 4, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0x10, 0][..], &[0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71]]
            .concat();
    floats.splice(36..36, extension);
    let mut packed = plain.clone();
    packed[34] = 12;
    for (what, bytes) in [
        ("RF64", large),
        ("padded", odd(&[0])),
        ("unpadded", odd(&[])),
        ("extensible", floats),
        ("12 bits in 16", packed),
        ("MP3", [&wav(0x55, 1, 44_100, 0, &[])[..40], &0_u32.to_le_bytes(), TONES[0].1].concat()),
    ] {
        let (sound, source) = read(&bytes).expect(what);
        let frames = if what == "MP3" { 24_000 } else { 48_000 };
        assert!(sound.frames().abs_diff(frames) < 1400, "{what}: {} {:?}", sound.frames(), source.notes);
        assert!(what == "MP3" || error_of(&sound, 0.5) < 0.002, "{what}");
    }
}

#[test]
fn wrong_lengths_in_mp3_ogg_and_flac_do_not_cut_the_sound() {
    let [mp3, ogg, flac] = TONES.map(|(_, bytes)| bytes.to_vec());
    let frames = |bytes: &[u8]| read(bytes).map(|(sound, source)| (sound.frames(), source.notes));
    let whole = [&mp3, &ogg, &flac].map(|bytes| frames(bytes).expect("a sound").0);
    // The number of frames in the tag of MP3: none, one, and more than there are.
    let tag = mp3.windows(4).position(|four| four == b"Xing" || four == b"Info").expect("a tag");
    for count in [0_u32, 1, 5, u32::MAX] {
        let mut bytes = mp3.clone();
        bytes[tag + 8..tag + 12].copy_from_slice(&count.to_be_bytes());
        let (found, notes) = frames(&bytes).expect("a sound");
        assert!(found >= whole[0] && found < whole[0] + 2400, "{count}: {found} of {} {notes:?}", whole[0]);
        assert_eq!(notes.len(), usize::from(count < 6), "{count}: {notes:?}");
    }
    // The position at the end of every page of Ogg.
    for position in [0_u64, 10] {
        let mut bytes = ogg.clone();
        let mut at = 0;
        while let Some(page) = bytes[at..].windows(4).position(|four| four == b"OggS") {
            bytes[at + page + 6..at + page + 14].copy_from_slice(&position.to_le_bytes());
            at += page + 4;
        }
        let (found, notes) = frames(&with_checksums(bytes)).expect("a sound");
        assert!(
            found + 100 >= whole[1] && found < whole[1] + 2400,
            "{position}: {found} of {} {notes:?}",
            whole[1]
        );
    }
    // The total of FLAC: unknown, one, and an hour.
    for total in [0_u64, 1, 44_100 * 3600] {
        let mut bytes = flac.clone();
        bytes[21] &= 0xf0;
        bytes[22..26].copy_from_slice(&(total as u32).to_be_bytes());
        let (found, notes) = frames(&bytes).expect("a sound");
        assert_eq!(found, whole[2], "{total}: {notes:?}");
    }
}

#[test]
fn recordings_with_wrong_headers_last_as_long_as_they_do() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    for name in ["riff_size_0_data_ok.wav", "data_size_0.wav"] {
        let path = data.join("reports").join(name);
        let (sound, _) = read_sound(&path, &mut |_| ControlFlow::Continue(())).expect(name);
        assert!((sound.secs() - 2.0).abs() < 0.01, "{name}: {} s", sound.secs());
        for (from, to, clicks) in
            [(0.49, 0.53, true), (0.99, 1.03, true), (1.49, 1.53, true), (0.6, 0.95, false)]
        {
            let frames = (from * 48_000.0) as i64..(to * 48_000.0) as i64;
            let loudest = frames.map(|frame| sound.stereo(frame)[0].abs()).fold(0.0, f32::max);
            assert_eq!(loudest > 0.05, clicks, "{name} from {from} s: {loudest}");
        }
    }
}
