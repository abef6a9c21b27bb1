use super::{FilmQuality, FilmSettings, FilmWriter};
use crate::partial::failing::small_disk;
use crate::{FilmReader, RecordError, keep_unfinished, read_film};
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::Path;

const SMALL: FilmSettings = FilmSettings { width: 96, height: 64, fps: 25.0, quality: FilmQuality::High };

/// A warm gradient with a lighter disc that moves two pixels per frame, and narrow stripes that move with it.
fn picture(settings: FilmSettings, frame: u64) -> Vec<u8> {
    let (width, height) = (settings.width as i32, settings.height as i32);
    let shift = frame as i32 * 2;
    let mut rgba = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let (dx, dy) = (x - width / 4 - shift, y - height / 2);
            let inside = dx * dx + dy * dy < height * height / 9;
            let stripe = if inside { ((dx as f32 * 0.9).sin() * 40.0) as i32 } else { 0 };
            let base = if inside { [190, 130, 80] } else { [60 + x * 80 / width, 50 + y * 60 / height, 70] };
            rgba.extend(base.map(|c| (c + stripe).clamp(0, 255) as u8));
            rgba.push(255);
        }
    }
    rgba
}

fn write(path: &Path, settings: FilmSettings, frames: u64) {
    let mut film = FilmWriter::create(path, settings).unwrap();
    for frame in 0..frames {
        film.push(&picture(settings, frame)).unwrap();
    }
    let report = film.finish().unwrap();
    assert_eq!(report.frames, frames);
    assert_eq!(report.bytes, fs::metadata(path).unwrap().len());
    assert_eq!(report.duration_secs, frames as f64 / settings.fps);
}

fn decode(path: &Path) -> Vec<Vec<u8>> {
    let mut reader = FilmReader::open(path).unwrap();
    let mut frames = vec![Vec::new()];
    while reader.next_frame(frames.last_mut().unwrap()).unwrap() {
        frames.push(Vec::new());
    }
    frames.pop();
    frames
}

/// Peak signal to noise ratio over R, G and B, in decibels.
fn psnr_db(a: &[u8], b: &[u8]) -> f64 {
    assert_eq!(a.len(), b.len());
    let colours = a.chunks_exact(4).zip(b.chunks_exact(4)).flat_map(|(a, b)| a[..3].iter().zip(&b[..3]));
    let sum: u64 = colours.map(|(a, b)| u64::from(a.abs_diff(*b)).pow(2)).sum();
    10.0 * (255.0 * 255.0 * (a.len() / 4 * 3) as f64 / sum as f64).log10()
}

#[test]
fn a_film_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("new folder/ein Tänzchen.mp4");
    // More frames than in a chunk and than between two key frames.
    write(&path, SMALL, 40);
    let info = read_film(&path).unwrap();
    assert_eq!((info.width, info.height, info.frames, info.codec.as_str()), (96, 64, 40, "avc1"));
    assert!((info.duration_secs - 1.6).abs() < 1e-12);
    let frames = decode(&path);
    assert_eq!(frames.len(), 40);
    for (index, frame) in frames.iter().enumerate() {
        let quality = psnr_db(frame, &picture(SMALL, index as u64));
        // More than 35 dB is regarded as good. The halved chroma resolution lowers it at the edges of the stripes.
        assert!(quality > 35.0, "frame {index}: {quality:.1} dB");
        // Negative control: the image three frames later differs.
        let other = psnr_db(frame, &picture(SMALL, index as u64 + 3));
        assert!(other < 30.0, "frame {index} looks like {}: {other:.1} dB", index + 3);
    }
    assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1, "only the film remains");
}

#[test]
fn finer_quality_is_nearer_and_larger() {
    let folder = tempfile::tempdir().unwrap();
    let mut last = (0.0, 0);
    for quality in FilmQuality::ALL {
        let settings = FilmSettings { quality, ..SMALL };
        let path = folder.path().join(format!("{}.mp4", quality.id()));
        write(&path, settings, 6);
        let found = (psnr_db(&decode(&path)[5], &picture(settings, 5)), fs::metadata(&path).unwrap().len());
        assert!(found.0 > last.0 && found.1 > last.1, "{quality:?}: {found:?} after {last:?}");
        last = found;
    }
}

#[test]
fn the_same_pictures_give_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (folder.path().join("a.mp4"), folder.path().join("b.mp4"));
    write(&a, SMALL, 12);
    write(&b, SMALL, 12);
    assert_eq!(fs::read(a).unwrap(), fs::read(b).unwrap());
}

#[test]
fn broadcast_rates_have_exact_lengths() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    let settings = FilmSettings { fps: 29.97, ..SMALL };
    let mut film = FilmWriter::create(&path, settings).unwrap();
    (0..30).for_each(|frame| film.push(&picture(settings, frame)).unwrap());
    film.finish().unwrap();
    assert_eq!(read_film(&path).unwrap().duration_secs, 30.0 * 1001.0 / 30_000.0);
}

#[test]
fn invalid_requests_are_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("missing/a.mp4");
    for (width, height, fps, word) in [
        (1281, 720, 30.0, "1280x720"),
        (1280, 721, 30.0, "even"),
        (0, 0, 30.0, "16"),
        (8, 8, 30.0, "16"),
        (4096, 2160, 30.0, "3840"),
        (3840, 3840, 30.0, "2160"),
        (1280, 720, 0.0, "240"),
        (1280, 720, f64::NAN, "240"),
    ] {
        let settings = FilmSettings { width, height, fps, quality: FilmQuality::High };
        let error = FilmWriter::create(&path, settings).unwrap_err();
        assert!(error.is_request() && error.to_string().contains(word), "{error}");
    }
    assert!(FilmWriter::create(folder.path(), SMALL).unwrap_err().is_request());
    let empty = FilmWriter::create(&folder.path().join("a.mp4"), SMALL).unwrap();
    assert!(empty.finish().unwrap_err().is_request());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn the_smallest_and_the_tall_film_play() {
    let folder = tempfile::tempdir().unwrap();
    for (width, height) in [(16, 16), (18, 130), (250, 34)] {
        let settings = FilmSettings { width, height, ..SMALL };
        let path = folder.path().join(format!("{width}x{height}.mp4"));
        write(&path, settings, 3);
        assert_eq!(decode(&path).len(), 3, "{width}x{height}");
    }
}

#[test]
fn a_frame_of_another_size_is_refused_and_the_film_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    let mut film = FilmWriter::create(&path, SMALL).unwrap();
    assert!(matches!(film.push(&[0; 12]), Err(RecordError::FrameSize { found: 12, wanted: 24_576, .. })));
    film.push(&picture(SMALL, 0)).unwrap();
    assert_eq!(film.finish().unwrap().frames, 1);
}

#[test]
fn a_cancel_leaves_the_old_film_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    write(&path, SMALL, 2);
    let before = fs::read(&path).unwrap();
    let mut film = FilmWriter::create(&path, SMALL).unwrap();
    film.push(&picture(SMALL, 9)).unwrap();
    film.cancel();
    assert_eq!(fs::read(&path).unwrap(), before);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_recording_that_cannot_go_on_leaves_what_plays() {
    for (panics, leaves) in [(false, true), (true, true), (false, false), (true, false)] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mp4");
        let mut film = FilmWriter::create(&path, SMALL).unwrap();
        if !leaves {
            film = film.leaving_nothing();
        }
        (0..30).for_each(|frame| film.push(&picture(SMALL, frame)).unwrap());
        if panics {
            let ended = catch_unwind(AssertUnwindSafe(|| {
                let _film = film;
                resume_unwind(Box::new("nothing draws"));
            }));
            assert!(ended.is_err());
        } else {
            film.leave();
        }
        let kept = keep_unfinished(&path).unwrap().map(|kept| kept.frames);
        assert_eq!(kept, leaves.then_some(16), "{panics}");
        if leaves {
            assert_eq!(decode(&path).len(), 16);
        } else {
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        }
    }
}

#[test]
fn a_full_disk_stops_the_film_and_leaves_what_plays() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole.mp4");
    write(&whole, SMALL, 30);
    let length = fs::metadata(&whole).unwrap().len();
    // From no room for the first bytes to one byte too few for the tables at the end.
    for room in [0, 20, 100, length / 2, length - 1] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mp4");
        let push_all = || {
            let mut film = FilmWriter::create_on(&path, SMALL, &small_disk(room))?;
            for frame in 0..30 {
                film.push(&picture(SMALL, frame))?;
            }
            film.finish()
        };
        let error = push_all().unwrap_err();
        let RecordError::Io { source, .. } = &error else { panic!("{error:?}") };
        assert_eq!(source.kind(), std::io::ErrorKind::StorageFull);
        assert!(!error.is_request() && error.to_string().contains("a.mp4"), "{error}");
        // The tables of the first chunk of images, if there was room for it.
        let left = fs::read_dir(folder.path()).unwrap().count();
        let kept = keep_unfinished(&path).unwrap().map_or(0, |kept| kept.frames);
        assert!(
            [(0, 0), (2, 16)].contains(&(left, kept)),
            "{room} bytes of room: {left} files, {kept} frames"
        );
        assert!(if room <= 100 { kept == 0 } else { kept == 16 || room < length - 1 });
        if kept > 0 {
            assert_eq!(decode(&path), decode(&whole)[..16]);
        }
    }
}

#[test]
fn after_an_error_the_film_stays_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let mut film = FilmWriter::create_on(&folder.path().join("a.mp4"), SMALL, &small_disk(2_000)).unwrap();
    while film.push(&picture(SMALL, 0)).is_ok() {
        // A still image takes few bytes per frame, so the buffer in front of the disk holds some hundred frames.
    }
    assert!(matches!(film.push(&picture(SMALL, 1)), Err(RecordError::Stopped { .. })));
    assert!(matches!(film.finish(), Err(RecordError::Stopped { .. })));
}

#[cfg(target_os = "linux")]
#[test]
fn the_full_device_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    let mut film = FilmWriter::create_on(&path, SMALL, &crate::partial::failing::full_device).unwrap();
    film.push(&picture(SMALL, 0)).unwrap();
    let error = film.finish().unwrap_err();
    assert!(error.to_string().contains("No space left on device"), "{error}");
    assert!(!path.exists());
}
