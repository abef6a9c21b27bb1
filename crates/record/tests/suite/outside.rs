//! Films checked by other programs, if they are installed, and against a limit of the operating system.

use lovelock_record::{FilmQuality, FilmSettings, FilmWriter, keep_unfinished};
use std::path::Path;
use std::process::Command;

const SETTINGS: FilmSettings =
    FilmSettings { width: 320, height: 180, fps: 30.0, quality: FilmQuality::High };

/// Red on the left, green on the right, and a moving white bar.
fn picture(frame: u32) -> Vec<u8> {
    let pixel = |x: u32| match x {
        x if x / 8 == frame % 40 => [255, 255, 255, 255],
        0..160 => [200, 30, 30, 255],
        _ => [30, 160, 40, 255],
    };
    (0..180).flat_map(|_| (0..320).flat_map(pixel)).collect()
}

fn write(path: &Path) {
    let mut film = FilmWriter::create(path, SETTINGS).unwrap();
    (0..45).for_each(|frame| film.push(&picture(frame)).unwrap());
    film.finish().unwrap();
}

fn run(program: &str, arguments: &[&str], path: &Path) -> Option<(bool, Vec<u8>, String)> {
    let mut command = Command::new(program);
    for argument in arguments {
        if *argument == "FILM" {
            command.arg(path)
        } else {
            command.arg(argument)
        };
    }
    let Ok(output) = command.output() else {
        println!("skipped: no {program} on this machine");
        return None;
    };
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    Some((output.status.success(), output.stdout, errors))
}

#[test]
fn ffprobe_sees_what_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.mp4");
    write(&path);
    let arguments = ["-v", "error", "-count_frames", "-show_streams", "-show_format", "-of", "flat", "FILM"];
    let Some((good, text, errors)) = run("ffprobe", &arguments, &path) else {
        return;
    };
    assert!(good && errors.is_empty(), "{errors}");
    let text = String::from_utf8(text).unwrap();
    for line in [
        "streams.stream.0.codec_name=\"h264\"",
        "streams.stream.0.width=320",
        "streams.stream.0.height=180",
        "streams.stream.0.pix_fmt=\"yuv420p\"",
        "streams.stream.0.color_range=\"tv\"",
        "streams.stream.0.color_space=\"bt709\"",
        "streams.stream.0.color_primaries=\"bt709\"",
        "streams.stream.0.color_transfer=\"iec61966-2-1\"",
        "streams.stream.0.chroma_location=\"left\"",
        "streams.stream.0.r_frame_rate=\"30/1\"",
        "streams.stream.0.avg_frame_rate=\"30/1\"",
        "streams.stream.0.nb_frames=\"45\"",
        "streams.stream.0.nb_read_frames=\"45\"",
        "streams.stream.0.duration=\"1.500000\"",
        "format.duration=\"1.500000\"",
    ] {
        assert!(text.contains(line), "no line {line} in\n{text}");
    }
}

#[test]
fn ffmpeg_decodes_the_colours_that_went_in() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.mp4");
    write(&path);
    let arguments = ["-v", "error", "-xerror", "-i", "FILM", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"];
    let Some((good, pixels, errors)) = run("ffmpeg", &arguments, &path) else {
        return;
    };
    assert!(good && errors.is_empty(), "{errors}");
    assert_eq!(pixels.len(), 45 * 320 * 180 * 3);
    let mut worst = 0;
    for (frame, decoded) in pixels.chunks_exact(320 * 180 * 3).enumerate() {
        let wanted = picture(frame as u32);
        for (x, (pixel, wanted)) in decoded.chunks_exact(3).zip(wanted.chunks_exact(4)).enumerate() {
            // The middles of the two fields, away from edges that are blurred by chroma subsampling and encoding.
            if [40, 280].contains(&(x % 320)) && ![4, 5, 6, 34, 35, 36].contains(&(frame % 40)) {
                let off = pixel.iter().zip(wanted).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0);
                worst = worst.max(off);
            }
        }
    }
    // The quantiser's step at 20 is 6.5 codes, so errors are up to 3, and twice that in blue because of chroma. A wrong range
    // or the matrix of standard definition gives errors of 15 and more in these colours.
    assert!(worst <= 6, "colours off by {worst}");
}

/// The operating system limits the size of the file (`ulimit -f`) in a second process of this test.
#[cfg(unix)]
#[test]
fn a_limit_of_the_system_stops_the_film_and_leaves_what_plays() {
    const FOLDER: &str = "LOVELOCK_TEST_LIMITED_FOLDER";
    if let Some(folder) = std::env::var_os(FOLDER) {
        let path = Path::new(&folder).join("film.mp4");
        let mut film = FilmWriter::create(&path, SETTINGS).unwrap();
        let ended = (0..10_000).find_map(|frame| film.push(&picture(frame)).err());
        println!("ended by: {}", ended.expect("the limit holds"));
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let this = std::env::current_exe().unwrap();
    let name = "outside::a_limit_of_the_system_stops_the_film_and_leaves_what_plays";
    // If the signal is ignored, `write` returns an error at the limit.
    let script = format!("trap '' XFSZ; ulimit -f 64 && exec \"$0\" --exact {name} --nocapture");
    let output = Command::new("bash").arg("-c").arg(script).arg(this).env(FOLDER, folder.path()).output();
    let Ok(output) = output else {
        println!("skipped: no bash on this machine");
        return;
    };
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}\n{}", String::from_utf8_lossy(&output.stderr));
    assert!(text.contains("ended by: ") && text.contains("film.mp4: could not write frame"), "{text}");
    assert!(text.contains("File too large"), "{text}");
    let film = folder.path().join("film.mp4");
    assert!(!film.exists(), "it is not complete");
    let kept = keep_unfinished(&film).unwrap().expect("what plays");
    assert!(kept.frames >= 16 && film.exists(), "{kept:?}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}
