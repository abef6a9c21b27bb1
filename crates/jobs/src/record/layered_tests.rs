//! Recordings with layers: transparent, linear and blurred frames, and resumed sequences.

use std::ops::ControlFlow;
use std::path::Path;

use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_record::SequenceFormat;
use lovelock_render::Backend;
use lovelock_session::dance::Dance;
use lovelock_session::progress::Progress;
use lovelock_session::testing::small_project;
use lovelock_testkit::suite::sample;

use super::*;

const SIZE: (u32, u32) = (64, 48);

fn request(out: &Path) -> RecordRequest {
    RecordRequest {
        out: out.to_owned(),
        frames: Some(2..5),
        size: Some(SIZE),
        backend: Some(Backend::Cpu),
        ..RecordRequest::default()
    }
}

fn done(project: &Project, request: &RecordRequest) -> RecordReport {
    record(project, request, &mut |_| ControlFlow::Continue(())).expect("a recording")
}

fn refused(project: &Project, request: &RecordRequest) -> String {
    let error = record(project, request, &mut |_| ControlFlow::Continue(())).expect_err("refused");
    assert_eq!(error.exit_code(), 2, "{error}");
    error.to_string()
}

/// All files of a folder with their bytes, by name.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry"));
    let mut all: Vec<_> = entries
        .map(|entry| (entry.file_name().to_string_lossy().into_owned(), std::fs::read(entry.path())))
        .map(|(name, bytes)| (name, bytes.expect("a file")))
        .collect();
    all.sort();
    all
}

/// The pixels of a PNG file, four bytes each.
fn pixels(path: &Path) -> Vec<u8> {
    let file = std::io::BufReader::new(std::fs::File::open(path).expect("a picture"));
    let mut decoder = png::Decoder::new(file);
    decoder.set_transformations(png::Transformations::ALPHA);
    let mut reader = decoder.read_info().expect("a picture");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut pixels).expect("a picture");
    pixels
}

#[test]
fn a_transparent_frame_is_clear_beside_the_figure_and_opaque_on_it() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name);
    let clear = RecordRequest { transparent: true, ..request(&at("clear")) };
    let report = done(&small_project(), &clear);
    assert!(report.transparent && report.format == "png");
    done(&small_project(), &request(&at("drawn")));
    let (clear, drawn) = (pixels(&at("clear/frame_000003.png")), pixels(&at("drawn/frame_000003.png")));
    let alphas: Vec<u8> = clear.chunks_exact(4).map(|pixel| pixel[3]).collect();
    assert!(alphas.contains(&0) && alphas.contains(&255) && alphas.iter().any(|&a| a > 0 && a < 255));
    assert!(drawn.chunks_exact(4).all(|pixel| pixel[3] == 255), "the control");
    for (clear, drawn) in
        clear.chunks_exact(4).zip(drawn.chunks_exact(4)).filter(|(clear, _)| clear[3] == 255)
    {
        // Fully covered pixels look the same, within a step for hair that transmits a thousandth.
        assert!(clear.iter().zip(drawn).all(|(a, b)| a.abs_diff(*b) <= 2), "{clear:?} {drawn:?}");
    }
    // An animated PNG stores alpha as well; a film cannot.
    done(&small_project(), &RecordRequest { transparent: true, ..request(&at("a.apng")) });
    assert!(pixels(&at("a.apng")).chunks_exact(4).any(|pixel| pixel[3] == 0));
    let film = RecordRequest { transparent: true, ..request(&at("a.mp4")) };
    assert!(refused(&small_project(), &film).contains("H.264 stores no alpha"));
    let mut project = small_project();
    project.recording.transparent = true;
    assert!(refused(&project, &request(&at("a.mp4"))).contains("H.264"), "the project says so too");
    assert!(!at("a.mp4").exists());
}

#[test]
fn a_blurred_frame_is_the_mean_of_its_instants_and_the_same_each_time_long_suite() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name);
    let blurred = |name: &str, frames, subframes, degrees| {
        let request = RecordRequest {
            frames: Some(frames),
            motion_blur: Some(subframes),
            shutter_degrees: Some(degrees),
            format: Some(SequenceFormat::Exr),
            ..request(&at(name))
        };
        done(&small_project(), &request)
    };
    let light = |path: &str| {
        let image = exr_light(&at(path));
        assert_eq!(image.len(), (SIZE.0 * SIZE.1) as usize);
        image
    };
    let apart = |a: &[[f32; 4]], b: &[[f32; 4]]| {
        let sum: f32 = a.iter().zip(b).map(|(a, b)| (0..3).map(|c| (a[c] - b[c]).abs()).sum::<f32>()).sum();
        sum / a.len() as f32
    };
    let report = blurred("one", 2..6, 4, 360.0);
    assert_eq!((report.motion_blur, report.shutter_degrees), (4, 360.0));
    blurred("two", 2..6, 4, 360.0);
    assert!(contents(&at("one")) == contents(&at("two")), "the same bytes");
    blurred("late", 4..6, 4, 360.0);
    let file = |folder: &str| std::fs::read(at(folder).join("frame_000004.exr")).expect("a frame");
    assert!(file("one") == file("late"), "a frame alone is the frame among others");
    // Two samples over half of a frame of 1/30 s lie an eighth of it before and after, which are frames at eight times the rate.
    // The simulation has steps of 1/60 s here and 1/240 s there, so the results are close but not equal.
    blurred("half", 4..5, 2, 180.0);
    blurred("sharp", 4..5, 1, 180.0);
    let (half, sharp) = (light("half/frame_000004.exr"), light("sharp/frame_000004.exr"));
    let (whole, more) = (light("one/frame_000004.exr"), apart(&light("one/frame_000004.exr"), &sharp));
    let less = apart(&half, &sharp);
    println!("half a shutter {less}, all of it {more}");
    assert!(less > 1e-4 && more > less, "the longer it is open the more it blurs: {less} {more}");
    assert!(apart(&whole, &half) > 1e-4);
    // A closed shutter does not blur; the mean of equal halves only rounds.
    blurred("shut", 4..5, 4, 0.0);
    assert!(apart(&light("shut/frame_000004.exr"), &sharp) < 1e-4);
}

/// The light of an EXR file.
fn exr_light(path: &Path) -> Vec<[f32; 4]> {
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| (size.width(), vec![[0.0_f32; 4]; size.area()]),
        |(width, pixels), at, (r, g, b, a): (f32, f32, f32, f32)| {
            pixels[at.y() * *width + at.x()] = [r, g, b, a];
        },
    );
    image.expect("an EXR file").layer_data.channel_data.pixels.1
}

#[test]
fn instants_between_steps_lie_between_them() {
    let project = small_project();
    let open = || {
        let mut progress = |_| ControlFlow::Continue(());
        let (mut dance, _) =
            Dance::open(&project, &lovelock_project::files::Access::new(), 30.0, &mut progress)
                .expect("a dance");
        dance.begin(0, 0.1, &mut progress).expect("begun");
        dance
    };
    let tip = |snapshot: &lovelock_session::snapshot::FrameSnapshot| {
        let guides = &snapshot.guides.guides;
        guides.point(3, guides.points_per_guide - 1)
    };
    let mut dance = open();
    let steps = [6.0, 6.25, 6.5, 7.0, 7.5, 8.0].map(|step| dance.snapshot_at(step / 60.0).expect("there"));
    let at = steps.each_ref().map(|snapshot| tip(snapshot));
    for (between, (a, b)) in [(1, (0, 3)), (2, (0, 3)), (4, (3, 5))] {
        let (whole, part) = (at[a].distance(at[b]), at[a].distance(at[between]));
        assert!(whole > 1e-5 && part > 0.1 * whole && part < 0.9 * whole, "{between}: {part} of {whole}");
    }
    assert!((steps[2].time_secs - 6.5 / 60.0).abs() < 1e-9);
    assert!(steps[2].skin.positions != steps[0].skin.positions, "the body moves too");
    // At a step it is the step itself.
    let mut plain = open();
    for (index, frame) in [(0, 3), (5, 4)] {
        let snapshot = plain.snapshot(frame).expect("there");
        assert_eq!(tip(&snapshot), at[index], "frame {frame}");
    }
}

#[test]
fn a_stopped_sequence_is_resumed_and_other_settings_are_refused_by_name() {
    for (format, blur) in sample([(SequenceFormat::Exr, 3), (SequenceFormat::Png, 1)], 2) {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        let wanted = |name: &str| RecordRequest {
            frames: Some(2..8),
            format: Some(format),
            motion_blur: Some(blur),
            resume: true,
            ..request(&at(name))
        };
        let whole = done(&small_project(), &wanted("whole"));
        assert_eq!((whole.frames, whole.frames_kept), (6, 0));
        let mut stop = |what| match what {
            Progress::Frame { done: 3, .. } => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        let stopped = record(&small_project(), &wanted("parts"), &mut stop);
        assert!(matches!(stopped, Err(ProjectError::Cancelled)));
        let kept = contents(&at("parts")).len() as u64 - 1;
        assert!((1..=3).contains(&kept), "{kept} and a manifest");

        let mut project = small_project();
        project.lights[0].intensity *= 1.1;
        let before = contents(&at("parts"));
        assert!(refused(&project, &wanted("parts")).contains("lights changed"));
        for (other, said) in [
            (RecordRequest { size: Some((60, 48)), ..wanted("parts") }, "size was 64x48 and is 60x48 now"),
            (RecordRequest { label: true, ..wanted("parts") }, "label was false and is true now"),
            (RecordRequest { transparent: true, ..wanted("parts") }, "background was drawn"),
            (RecordRequest { motion_blur: Some(7), ..wanted("parts") }, "motion blur was"),
            (RecordRequest { fps: Some(24.0), ..wanted("parts") }, "rate was 30 and is 24 now"),
        ] {
            let error = refused(&small_project(), &other);
            assert!(error.contains(said) && error.contains("parts"), "{error}");
        }
        assert!(before == contents(&at("parts")), "nothing of it was touched");

        let mut told = Vec::new();
        let mut listen = |what| {
            match what {
                Progress::Kept { done, .. } => told.push(("kept", done)),
                Progress::Frame { done, .. } => told.push(("drawn", done)),
                _ => {}
            }
            ControlFlow::Continue(())
        };
        let parts = record(&small_project(), &wanted("parts"), &mut listen).expect("the rest");
        assert_eq!((parts.frames, parts.frames_kept), (6, kept));
        assert_eq!(told.iter().filter(|(what, _)| *what == "kept").count() as u64, kept);
        assert_eq!(told.last(), Some(&("drawn", 6)));
        assert!(contents(&at("whole")) == contents(&at("parts")), "{format:?}: byte for byte");
    }
    let dir = tempfile::tempdir().expect("a folder");
    let film = RecordRequest { resume: true, ..request(&dir.path().join("a.mp4")) };
    assert!(refused(&small_project(), &film).contains("only a folder of images"));
}

#[test]
fn unsupported_settings_are_refused_with_a_message() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name);
    let exr = Some(SequenceFormat::Exr);
    let sheet = lovelock_panes::sheet::Sheet {
        columns: None,
        wipe: None,
        view: lovelock_panes::view::LiveView::default(),
        figures: true,
        colors: [[0; 3]; 9],
    };
    for (wrong, said) in [
        (RecordRequest { motion_blur: Some(0), ..request(&at("x")) }, "must be 1 (none) to 64"),
        (RecordRequest { motion_blur: Some(65), ..request(&at("x")) }, "65 samples"),
        (RecordRequest { shutter_degrees: Some(361.0), ..request(&at("x")) }, "must be 0 to 360"),
        (RecordRequest { shutter_degrees: Some(f32::NAN), ..request(&at("x")) }, "must be 0 to 360"),
        (RecordRequest { format: exr, ..request(&at("x.mp4")) }, "EXR files need a folder"),
        (RecordRequest { size: Some((63, 47)), ..request(&at("x.mp4")) }, "such as 62x46"),
        (RecordRequest { format: exr, panes: Some(sheet), ..request(&at("x")) }, "panes side by side"),
    ] {
        let error = refused(&small_project(), &wrong);
        assert!(error.contains(said), "{error}");
    }
    assert_eq!(std::fs::read_dir(dir.path()).expect("a folder").count(), 0, "nothing was written");
    let mut project = small_project();
    project.recording.format = SequenceFormat::Exr;
    done(&project, &request(&at("x.mp4")));
}
