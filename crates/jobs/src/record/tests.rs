use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{Arc, OnceLock};

use lovelock_project::error::ProjectError;
use lovelock_render::{Backend, Gpu, ShadowMethod};
use lovelock_session::progress::Progress;
use lovelock_session::testing::small_project;

use super::*;

fn request(out: &Path) -> RecordRequest {
    RecordRequest {
        out: out.to_owned(),
        frames: Some(2..5),
        size: Some((64, 48)),
        ..RecordRequest::default()
    }
}

/// Records, or skips the test if there is no adapter.
fn try_record(
    request: &RecordRequest,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Option<Result<RecordReport, ProjectError>> {
    static GPU: OnceLock<Option<Arc<Gpu>>> = OnceLock::new();
    let gpu = GPU
        .get_or_init(|| Gpu::open().inspect_err(|error| lovelock_testkit::skip_without_adapter(error)).ok());
    let request = RecordRequest { gpu: Some(Arc::clone(gpu.as_ref()?)), ..request.clone() };
    Some(record(&small_project(), &request, progress))
}

#[test]
fn wrong_requests_are_refused_before_any_work() {
    let dir = tempfile::tempdir().expect("a folder");
    let film = dir.path().join("x.mp4");
    let sequence = dir.path().join("frames");
    let wrong = [
        ("odd size", RecordRequest { size: Some((63, 48)), ..request(&film) }),
        ("no rate", RecordRequest { fps: Some(0.0), ..request(&film) }),
        ("no frames", RecordRequest { frames: Some(5..5), ..request(&film) }),
        ("an unknown ending", request(&dir.path().join("x.gif"))),
        ("no name", request(Path::new(""))),
        ("too large", RecordRequest { size: Some((8192, 8192)), ..request(&sequence) }),
    ];
    for (what, request) in wrong {
        let mut told = 0;
        let error = record(&small_project(), &request, &mut |_| {
            told += 1;
            ControlFlow::Continue(())
        })
        .expect_err(what);
        assert_eq!(error.exit_code(), 2, "{what}: {error}");
        assert_eq!(told, 0, "{what}");
        assert_eq!(error.to_string().lines().count(), 1);
    }
    assert_eq!(std::fs::read_dir(dir.path()).expect("a folder").count(), 0, "nothing was written");
}

#[test]
fn a_shadow_that_is_refused_leaves_no_folder() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut project = small_project();
    // The smallest possible limit is 16 MiB for all lights; this hair needs more.
    (project.hair.groom.wisps, project.hair.groom.strands_per_wisp) = (300, 40);
    project.shadow.exact.memory_limit_bytes = 0;
    let request = RecordRequest {
        frames: Some(0..1),
        shadow: Some(ShadowMethod::Exact),
        backend: Some(Backend::Cpu),
        ..request(&dir.path().join("new/frames"))
    };
    let error =
        record(&project, &request, &mut |_| ControlFlow::Continue(())).expect_err("too little memory");
    assert_eq!(error.exit_code(), 1, "{error}");
    assert!(error.to_string().contains("exact needs"), "{error}");
    assert_eq!(std::fs::read_dir(dir.path()).expect("a folder").count(), 0, "nothing is left");
}

#[test]
fn a_sequence_and_a_film_have_the_same_simulation() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut frames = Vec::new();
    let mut progress = |what| {
        if let Progress::Frame { done, total, .. } = what {
            frames.push((done, total));
        }
        ControlFlow::Continue(())
    };
    let Some(film) = try_record(&request(&dir.path().join("a.mp4")), &mut progress) else { return };
    let film = film.expect("a film");
    let sequence = try_record(&request(&dir.path().join("frames")), &mut |_| ControlFlow::Continue(()));
    let sequence = sequence.expect("an adapter").expect("a sequence");
    assert_eq!(film.state_hash, sequence.state_hash);
    assert_eq!((film.frames, sequence.frames), (3, 3));
    assert_eq!(frames, [(1, 3), (2, 3), (3, 3)]);
    assert!(
        dir.path().join("frames/frame_000002.png").is_file()
            && dir.path().join("frames/frame_000004.png").is_file()
    );
    assert!(film.frame_ms > 0.0 && film.stage_ms.draw > 0.0 && film.max_stretch < 1e-3);
    let later = RecordRequest { frames: Some(4..5), ..request(&dir.path().join("later")) };
    let later = try_record(&later, &mut |_| ControlFlow::Continue(())).expect("an adapter").expect("a frame");
    assert_eq!(later.state_hash, film.state_hash, "frame 4 is the same, recorded alone");
    assert_eq!(
        std::fs::read(dir.path().join("later/frame_000004.png")).expect("a picture"),
        std::fs::read(dir.path().join("frames/frame_000004.png")).expect("a picture"),
    );
}

#[test]
fn a_cancelled_film_leaves_nothing() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut progress = |what| match what {
        Progress::Frame { done: 2, .. } => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    };
    let Some(result) = try_record(&request(&dir.path().join("a.mp4")), &mut progress) else { return };
    assert!(matches!(result, Err(ProjectError::Cancelled)));
    assert_eq!(std::fs::read_dir(dir.path()).expect("a folder").count(), 0);
}

#[test]
fn the_report_has_the_keys_that_were_promised() {
    let report = RecordReport {
        out: "a b/ü.mp4".into(),
        frames: 1,
        frames_kept: 0,
        first_frame: 0,
        fps: 30.0,
        width: 2,
        height: 2,
        backend: "gpu".to_owned(),
        adapter: "x".to_owned(),
        shadow: "voxel-map".to_owned(),
        draw: "strands".to_owned(),
        transparency: "sorted".to_owned(),
        format: "mp4".to_owned(),
        sound: false,
        transparent: false,
        motion_blur: 1,
        lens_samples: 1,
        shutter_degrees: 180.0,
        strands: 1,
        segments: 1,
        frame_ms: 1.0,
        stage_ms: StageMedians::default(),
        passes_ms: [("draw/points".to_owned(), 1.5)].into(),
        shadow_bytes: 1,
        draw_bytes: 1,
        max_stretch: 0.0,
        max_penetration_m: 0.0,
        recovered_guides: 0,
        health: Vec::new(),
        state_hash: "0000000000000abc".to_owned(),
        bytes: 1,
        steps_per_frame: 2,
        notes: Vec::new(),
    };
    let json = serde_json::to_value(&report).expect("JSON");
    for key in [
        "out",
        "frames",
        "fps",
        "width",
        "height",
        "backend",
        "adapter",
        "shadow",
        "draw",
        "transparency",
        "strands",
        "segments",
        "frame_ms",
        "stage_ms",
        "passes_ms",
        "shadow_bytes",
        "draw_bytes",
        "max_stretch",
        "max_penetration_m",
        "recovered_guides",
        "health",
        "state_hash",
    ] {
        assert!(!json[key].is_null(), "no `{key}` in {json}");
    }
    for stage in ["motion", "simulate", "interpolate", "shadow", "draw", "encode"] {
        assert!(json["stage_ms"][stage].is_number(), "{stage}");
    }
    assert_eq!((&json["out"], &json["state_hash"]), (&"a b/ü.mp4".into(), &"0000000000000abc".into()));
}

#[test]
fn a_take_from_the_middle_is_drawn_by_the_frames_of_the_dance() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name);
    let quiet = &mut |_| ControlFlow::Continue(());
    let take = RecordRequest { out: at("d.take"), frames: Some(40..43), ..RecordRequest::default() };
    crate::record::record_take(&small_project(), &take, quiet).expect("a take");
    let (mut plain, _) = lovelock_session::take::project_of_take(&at("d.take")).expect("its project");
    plain.set_take(at("d.take"));
    plain.look.eumelanin = 8.0;
    // Tracks follow the timeline of the original motion: black long before frame 40.
    let mut tracked = plain.clone();
    let keys = [(0.0, 0.1), (1.0, 8.0)]
        .map(|(secs, value)| lovelock_project::tracks::Key { secs, value: vec![value] });
    let track = lovelock_project::tracks::Track {
        target: "look/eumelanin".to_owned(),
        keys: keys.into(),
        ..lovelock_project::tracks::Track::default()
    };
    tracked.timeline.tracks = vec![track];
    let mut draw = |project: &lovelock_project::Project,
                    out: &str,
                    frames: std::ops::Range<u64>,
                    dance_time| {
        let mut access = lovelock_project::files::Access::new();
        access.pick(&at("d.take"));
        let frames = Some(frames);
        let own =
            RecordRequest { frames, backend: Some(Backend::Cpu), dance_time, access, ..request(&at(out)) };
        record(project, &own, quiet)
    };
    let error = draw(&tracked, "own", 40..43, false).expect_err("by its own frames it has no frame 40");
    assert!(error.to_string().contains("frames 0..3"), "{error}");
    let error = draw(&tracked, "dance", 39..43, true).expect_err("nor of the dance one before");
    assert!(error.to_string().contains("frames 40..43"), "{error}");
    draw(&tracked, "dance", 40..43, true).expect("pictures");
    draw(&plain, "plain", 0..3, false).expect("pictures");
    draw(&tracked, "own", 0..3, false).expect("pictures");
    for (dance, own) in [(40, 0), (42, 2)] {
        let read = |folder: &str, frame: u32| {
            std::fs::read(at(folder).join(format!("frame_{frame:06}.png"))).expect("a picture")
        };
        assert!(read("dance", dance) == read("plain", own), "frame {dance}");
        assert!(read("dance", dance) != read("own", own), "control: another position on the timeline");
    }
    let mut looped = plain.clone();
    looped.recording.seamless = true;
    let error = draw(&looped, "loop", 40..43, true).expect_err("refused");
    assert!(error.to_string().contains("--dance-time"), "{error}");
}

#[test]
fn a_sequence_gets_the_sound_of_its_frames_and_a_missing_one_is_a_note() {
    let dir = tempfile::tempdir().expect("a folder");
    let file = dir.path().join("clicks.wav");
    lovelock_testkit::click_track(&file, 8);
    let mut project = small_project();
    project.set_sound_file(&file);
    project.sound.offset_secs = -0.4;
    let mut access = lovelock_project::files::Access::new();
    access.pick(&file);
    let quiet = &mut |_| ControlFlow::Continue(());
    // Frames 2 to 4 at 30 per second are the seconds 0.0667 to 0.1667, in which the click of second 0.5 of the sound is heard.
    let own = RecordRequest {
        fps: Some(30.0),
        backend: Some(Backend::Cpu),
        access,
        ..request(&dir.path().join("frames"))
    };
    let report = record(&project, &own, quiet).expect("pictures");
    assert!(report.sound && report.notes.is_empty(), "{:?}", report.notes);
    let data = std::fs::read(dir.path().join("frames").join(lovelock_record::SOUND_NAME)).expect("a sound");
    let samples: Vec<i16> =
        data[44..].chunks_exact(2).map(|pair| i16::from_le_bytes([pair[0], pair[1]])).collect();
    assert_eq!(samples.len(), 4800);
    let first = samples.iter().position(|sample| *sample != 0).expect("a click");
    assert!(first.abs_diff(1600) <= 1, "0.1 s is 1600 samples after frame 2: {first}");

    project.sound.muted = true;
    let silent = RecordRequest { out: dir.path().join("silent"), ..own.clone() };
    assert!(!record(&project, &silent, quiet).expect("pictures").sound);
    project.sound.muted = false;
    std::fs::remove_file(&file).expect("removed");
    let report = record(&project, &RecordRequest { out: dir.path().join("missing"), ..own }, quiet);
    let report = report.expect("pictures");
    assert!(
        !report.sound && report.notes.iter().any(|note| note.contains("the recording is silent")),
        "{report:?}"
    );
}
