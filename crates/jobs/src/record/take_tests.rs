//! Takes recorded without a window, and takes in which the number of guides changes.

use std::ops::ControlFlow;
use std::path::PathBuf;

use lovelock_project::error::ProjectError;
use lovelock_record::{SequenceFormat, frame_name};
use lovelock_render::{Backend, CpuRenderer, Picture};
use lovelock_session::progress::Progress;
use lovelock_session::take::project_of_take;
use lovelock_session::testing::{AGAIN, MORE, guides, played, regrown, small_project};
use lovelock_testkit::suite::sample;

use super::*;
use crate::info::info;

pub(super) fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dance.take");
    (folder, path)
}

#[test]
fn without_a_window_every_step_is_recorded_and_a_cancelled_take_leaves_nothing() {
    let (folder, path) = folder();
    let request =
        RecordRequest { out: path.clone(), frames: Some(3..9), fps: Some(30.0), ..RecordRequest::default() };
    let report =
        record_take(&small_project(), &request, &mut |_| ControlFlow::Continue(())).expect("a recording");
    assert_eq!((report.frames, report.fps, report.guides), (12, 60.0, 48));
    let mut player = played(&path);
    assert!((player.snapshot(0.0).expect("a frame").time_secs - 0.1).abs() < 1e-6, "frame 3 at 30 a second");

    let cancelled = folder.path().join("cancelled.take");
    let request = RecordRequest { out: cancelled, ..request };
    let stopped = record_take(&small_project(), &request, &mut |progress| match progress {
        Progress::Frame { .. } => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    });
    assert!(matches!(stopped, Err(ProjectError::Cancelled)));
    let left: Vec<_> =
        std::fs::read_dir(folder.path()).expect("a folder").flatten().map(|e| e.file_name()).collect();
    assert_eq!(left, ["dance.take"]);
}

#[test]
fn a_take_of_a_motion_with_open_ends_has_its_last_pose() {
    let (_folder, path) = folder();
    let mut project = small_project();
    (project.motion.start_secs, project.motion.end_secs) = (1.0, Some(1.2));
    let request = RecordRequest { out: path.clone(), fps: Some(30.0), ..RecordRequest::default() };
    let report = record_take(&project, &request, &mut |_| ControlFlow::Continue(())).expect("a recording");
    // Seven frames of two steps.
    assert_eq!(report.frames, 14);
    assert!(report.notes.iter().any(|note| note.contains("plays once")), "{:?}", report.notes);
    let (stored, _) = project_of_take(&path).expect("a project");
    assert!(!stored.motion.looping && project.motion.looping);
    let mut player = played(&path);
    let last = player.snapshot(0.2).expect("the last frame");
    let clip = player.scene().clip.clone().expect("a clip");
    assert!((clip.duration_secs - 0.2).abs() < 1e-6);
    let mut pose = lovelock_motion::Pose::default();
    let plain = (*clip).clone().played_once();
    lovelock_motion::pose_at(&player.scene().body, Some(&plain), 0.2_f64.next_down(), &mut pose);
    let off = last.pose.world_from_joint.iter().zip(&pose.world_from_joint);
    let off = off.map(|(a, b)| (a.translation - b.translation).length()).fold(0.0, f32::max);
    assert!(off < 1e-3, "{off} m");
}

#[test]
fn info_counts_the_guides_from_each_frame_where_they_change() {
    let (_folder, path) = folder();
    let frames = regrown(&path);
    let (few, many) = (guides(&frames[0]), guides(&frames[50]));
    let told = info(&path).expect("a take").to_string();
    let points = frames[0].guides.guides.points_per_guide;
    for (guides, frame) in [(many, MORE), (few, AGAIN)] {
        let line = format!("{guides} of {points} points from frame {frame}\n");
        assert!(told.contains(&line), "{line:?} in {told}");
    }
}

#[test]
fn films_show_it_and_curves_name_the_frame() {
    let (_folder, path) = folder();
    regrown(&path);
    let (project, _) = project_of_take(&path).expect("a project");
    let mut request = RecordRequest {
        out: path.with_file_name("frames"),
        frames: Some(18..22),
        fps: Some(30.0),
        size: Some((64, 48)),
        backend: Some(Backend::Cpu),
        motion_blur: Some(3),
        ..RecordRequest::default()
    };
    request.access.pick(&path);
    let report = record(&project, &request, &mut |_| ControlFlow::Continue(())).expect("a film");
    assert_eq!(report.frames, 4);
    // Without blur a frame is the image of its snapshot.
    let frames = path.with_file_name("sharp");
    let sharp = RecordRequest { out: frames.clone(), motion_blur: None, ..request.clone() };
    record(&project, &sharp, &mut |_| ControlFlow::Continue(())).expect("a film");
    let mut player = played(&path);
    for n in 18..22_u32 {
        let snapshot = player.snapshot(f64::from(n) / 30.0).expect("a frame");
        let camera = snapshot.camera(&project.camera);
        let mut picture = Picture::default();
        let input = snapshot.frame_input(&project, &camera);
        CpuRenderer::default().picture(&input, 64, 48, &mut picture).expect("a picture");
        let file =
            std::fs::File::open(frames.join(frame_name(n.into(), SequenceFormat::Png))).expect("a picture");
        let mut decoder = png::Decoder::new(std::io::BufReader::new(file));
        decoder.set_transformations(png::Transformations::ALPHA);
        let mut reader = decoder.read_info().expect("a picture");
        let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
        reader.next_frame(&mut pixels).expect("a picture");
        assert!(pixels == picture.rgba, "frame {n}");
    }

    let all = [CurveSource::Guides, CurveSource::Strands]
        .into_iter()
        .flat_map(|source| ["a.usdc", "a.glb"].map(|name| (source, name)));
    // Each source and each format is among every third.
    for (source, name) in sample(all, 3) {
        let out = path.with_file_name(name);
        let request = RecordRequest {
            out: out.clone(),
            fps: Some(30.0),
            curves: Some(source),
            access: request.access.clone(),
            ..RecordRequest::default()
        };
        let write = |frames| {
            let request = RecordRequest { frames: Some(frames), ..request.clone() };
            record_curves(&project, &request, &mut |_| ControlFlow::Continue(()))
        };
        let error = write(18..22).expect_err("two sizes").to_string();
        assert!(error.contains("frame 20: the structure of the hair changes here"), "{error}");
        assert!(!out.exists());
        write(20..22).expect("one size");
        std::fs::remove_file(&out).expect("a file");
    }
}
