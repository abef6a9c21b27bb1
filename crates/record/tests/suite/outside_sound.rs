//! The sound of films, checked by other programs if they are installed.

use lovelock_record::{
    FilmQuality, FilmSettings, FilmWriter, OutputKind, PictureSink, SOUND_NAME, SOUND_RATE, SinkSettings,
    SoundSource, read_film,
};
use std::path::Path;
use std::process::Command;

/// Clicks of 5 ms with 2 kHz, at the times of some frames of 30 frames per second.
struct Clicks;

/// Frames whose start has a click.
const FRAMES: [u64; 4] = [6, 30, 47, 80];

impl SoundSource for Clicks {
    fn channels(&self) -> u16 {
        2
    }

    fn fill(&mut self, first: u64, out: &mut [f32]) {
        for (i, instant) in out.chunks_exact_mut(2).enumerate() {
            let sample = first + i as u64;
            let since = FRAMES.iter().filter_map(|frame| sample.checked_sub(frame * 1600)).min();
            let since = since.map_or(1.0, |since| since as f64 / f64::from(SOUND_RATE));
            let value =
                if since < 0.005 { 0.7 * (since * 2000.0 * std::f64::consts::TAU).sin() } else { 0.0 };
            instant.fill(value as f32);
        }
    }
}

/// A film or a sequence of 90 frames: white where there is a click, otherwise black.
fn write(path: &Path) {
    let mut sink =
        PictureSink::for_path(path, SinkSettings { frames: 90, ..SinkSettings::new(64, 64, 30.0) }).unwrap();
    sink.set_sound(Box::new(Clicks)).unwrap();
    for frame in 0..90 {
        let value = if FRAMES.contains(&frame) { 255 } else { 0 };
        sink.push(&[value; 64 * 64 * 4]).unwrap();
    }
    sink.finish().unwrap();
}

fn run(program: &str, arguments: &[&str], path: &Path) -> Option<Vec<u8>> {
    let arguments = arguments
        .iter()
        .map(|argument| if *argument == "FILE" { path.as_os_str() } else { argument.as_ref() });
    let Ok(output) = Command::new(program).args(arguments).output() else {
        println!("skipped: no {program} on this machine");
        return None;
    };
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && errors.is_empty(), "{program}: {errors}");
    Some(output.stdout)
}

/// The samples of the left side where a click begins.
fn onsets(samples: &[i16]) -> Vec<usize> {
    let mut found: Vec<usize> = Vec::new();
    for (i, sample) in samples.iter().enumerate() {
        if sample.unsigned_abs() > 6000 && found.last().is_none_or(|last| i - last > 4800) {
            found.push(i);
        }
    }
    found
}

fn assert_in_step(samples: &[i16]) {
    let wanted: Vec<usize> = FRAMES.iter().map(|frame| *frame as usize * 1600).collect();
    let found = onsets(samples);
    assert_eq!(found.len(), wanted.len(), "{found:?}");
    for (found, wanted) in found.iter().zip(&wanted) {
        let late_ms = (*found as f64 - *wanted as f64) / 48.0;
        println!("click {late_ms:+.2} ms from its frame");
        assert!(late_ms.abs() < 2.0, "{found} in place of {wanted}");
    }
}

fn words(bytes: &[u8]) -> Vec<i16> {
    bytes.chunks_exact(2).map(|pair| i16::from_le_bytes([pair[0], pair[1]])).collect()
}

#[test]
fn ffprobe_and_ffmpeg_find_the_sound_in_step_with_the_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.mp4");
    write(&path);
    let info = read_film(&path).unwrap();
    assert_eq!(
        (info.frames, info.duration_secs),
        (90, 3.0),
        "the images are found as in a film without sound"
    );
    let arguments = ["-v", "error", "-count_frames", "-show_streams", "-show_format", "-of", "flat", "FILE"];
    let Some(text) = run("ffprobe", &arguments, &path) else { return };
    let text = String::from_utf8(text).unwrap();
    for line in [
        "streams.stream.0.codec_name=\"h264\"",
        "streams.stream.0.nb_read_frames=\"90\"",
        "streams.stream.0.duration=\"3.000000\"",
        "streams.stream.1.codec_name=\"opus\"",
        "streams.stream.1.sample_rate=\"48000\"",
        "streams.stream.1.channels=2",
        "streams.stream.1.start_time=\"0.000000\"",
        "format.duration=\"3.000000\"",
    ] {
        assert!(text.contains(line), "no line {line} in\n{text}");
    }
    let arguments = ["-v", "error", "-xerror", "-i", "FILE", "-map", "0:a", "-ac", "1", "-f", "s16le", "-"];
    let sound = words(&run("ffmpeg", &arguments, &path).expect("it was there"));
    assert!((sound.len() as i64 - 144_000).abs() < 960, "{} samples of 3 s", sound.len());
    assert_in_step(&sound);
    // After a jump to second 2 the sound is in step as well.
    let arguments = ["-v", "error", "-ss", "2", "-i", "FILE", "-map", "0:a", "-ac", "1", "-f", "s16le", "-"];
    let late = onsets(&words(&run("ffmpeg", &arguments, &path).expect("it was there")));
    assert!(late.len() == 1 && (late[0] as i64 - 32_000).abs() < 960, "{late:?}");
}

#[test]
fn a_sequence_has_its_sound_beside_it_and_a_preview_has_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames");
    write(&path);
    let data = std::fs::read(path.join(SOUND_NAME)).unwrap();
    assert_eq!(data.len(), 44 + 3 * 48_000 * 4);
    let left: Vec<i16> = words(&data[44..]).into_iter().step_by(2).collect();
    assert_in_step(&left);
    if let Some(text) = run("ffprobe", &["-v", "error", "-show_streams", "FILE"], &path.join(SOUND_NAME)) {
        let text = String::from_utf8(text).unwrap();
        assert!(text.contains("codec_name=pcm_s16le") && text.contains("duration=3.000000"), "{text}");
    }
    let preview = folder.path().join("small.apng");
    assert_eq!(OutputKind::of(&preview).unwrap(), OutputKind::Preview);
    write(&preview);
    assert!(!folder.path().join(SOUND_NAME).exists());
}

#[test]
fn films_with_the_same_sound_have_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["a.mp4", "b.mp4"].map(|name| folder.path().join(name));
    write(&a);
    write(&b);
    assert!(std::fs::read(&a).unwrap() == std::fs::read(&b).unwrap());
    // Negative control: without sound the film is smaller.
    let silent = folder.path().join("c.mp4");
    let settings = FilmSettings { width: 64, height: 64, fps: 30.0, quality: FilmQuality::High };
    let mut film = FilmWriter::create(&silent, settings).unwrap();
    (0..90).for_each(|_| film.push(&[0; 64 * 64 * 4]).unwrap());
    film.finish().unwrap();
    assert!(std::fs::metadata(&silent).unwrap().len() + 1000 < std::fs::metadata(&a).unwrap().len());
}
