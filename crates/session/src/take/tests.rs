//! Takes reproduce the simulation and the changes of the project. No test here needs a graphics adapter.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::error::ProblemKind;
use lovelock_project::files::Access;
use lovelock_record::{MAX_ERROR_M, TakeCondition};

use super::*;
use crate::scene::SceneLoader;
use crate::testing::{farthest, played, recorded, settled, small_project};

pub(super) fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dance.take");
    (folder, path)
}

#[test]
fn every_frame_comes_back_as_it_was_simulated_in_any_order() {
    let (_folder, path) = folder();
    let frames = recorded(&path, &small_project(), 130, |_, _| {});
    let mut player = played(&path);
    assert_eq!((player.frames(), player.condition()), (130, TakeCondition::Whole));
    assert!((player.duration_secs() - 129.0 / 60.0).abs() < 1e-9);
    for n in [0, 1, 64, 129, 128, 3, 60, 59] {
        let frame = player.snapshot(n as f64 / 60.0).expect("a frame");
        let off = farthest(&frame, &frames[n]);
        assert!(f64::from(off) <= MAX_ERROR_M, "frame {n} is {off} m off");
        assert_eq!(frame.time_secs, frames[n].time_secs);
        assert_eq!(frame.guides.world_from_head, frames[n].guides.world_from_head);
        // The body too, whose pose follows from the clip's time.
        assert_eq!(frame.skin.positions, frames[n].skin.positions, "frame {n}");
        assert!((frame.position_secs - n as f64 / 60.0).abs() < 1e-9);
    }
    // Control: the next frame differs by more than rounding.
    let beside = player.snapshot(65.0 / 60.0).expect("a frame");
    assert!(f64::from(farthest(&beside, &frames[64])) > 10.0 * MAX_ERROR_M);
}

#[test]
fn between_two_frames_hair_is_between_them() {
    let (_folder, path) = folder();
    let frames = recorded(&path, &small_project(), 40, |_, _| {});
    let mut player = played(&path);
    let middle = player.snapshot(20.5 / 60.0).expect("an instant");
    let whole = farthest(&frames[20], &frames[21]);
    for end in [&frames[20], &frames[21]] {
        let off = farthest(&middle, end);
        assert!((0.3 * whole..0.7 * whole).contains(&off), "{off} of {whole} m");
    }
    assert!((middle.time_secs - 0.5 * (frames[20].time_secs + frames[21].time_secs)).abs() < 1e-6);
}

#[test]
fn a_style_that_changed_meanwhile_changes_again() {
    let (_folder, path) = folder();
    let project = small_project();
    let longer = |project: &mut Project| project.hair.groom.length *= 1.2;
    recorded(&path, &project, 60, |step, project| {
        if step == 30 {
            longer(project);
            project.look.width_scale *= 1.5;
        }
    });
    let mut player = played(&path);
    let style_at = |player: &mut TakePlayer, frame: f64| {
        Arc::clone(&player.snapshot(frame / 60.0).expect("a frame").scene.style)
    };
    let (first, later) = (style_at(&mut player, 10.0), style_at(&mut player, 45.0));
    assert!(!Arc::ptr_eq(&first, &later) && first.guides != later.guides);
    assert!(Arc::ptr_eq(&first, &style_at(&mut player, 29.0)), "seeking back grows no hair again");
    assert!(Arc::ptr_eq(&later, &style_at(&mut player, 30.0)), "the change is at its frame");
    assert_eq!(player.project().look, project.look, "the take's project is that of the first frame");
}

#[test]
fn the_project_of_a_take_plays_it() {
    let (_folder, path) = folder();
    let mut project = small_project();
    project.lights.truncate(1);
    recorded(&path, &project, 3, |_, _| {});
    let (read, problems) = project_of_take(&path).expect("a project");
    assert_eq!(problems, []);
    assert_eq!(read.take.file.as_ref().map(|file| file.path.as_path()), Some(path.as_path()));
    assert_eq!(Project { take: lovelock_project::project::TakeSection::default(), ..read }, project);
}

#[test]
fn hair_that_does_not_fit_is_refused_and_changed_hair_is_reported() {
    let (folder, path) = folder();
    let hair = folder.path().join("tuft.hair");
    let strands = |roots: u32, bend: f32| {
        // Yuksel's layout: a header of 128 bytes, then points.
        let mut bytes = b"HAIR".to_vec();
        for number in [roots, roots * 3, 2] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(2_u32.to_le_bytes());
        bytes.resize(128, 0);
        for root in 0..roots {
            for point in 0..3 {
                let (x, y) = (root as f32 * 0.4, 170.0 - 8.0 * point as f32);
                for v in [x, y, bend * point as f32] {
                    bytes.extend(v.to_le_bytes());
                }
            }
        }
        bytes
    };
    std::fs::write(&hair, strands(40, 0.0)).expect("a file");
    let mut project = small_project();
    project.set_hair_file(&hair);
    let mut access = Access::new();
    access.pick(&hair);
    let (scene, _) = SceneLoader::new().load_now(&project, &access).expect("a scene");
    let engine = settled(scene, &project);
    let take = TakeRecording::start(&path, &Arc::new(project.clone()), &engine).expect("a take");
    take.finish().expect("a whole take");
    assert_eq!(
        TakePlayer::open(&path, &Access::new())
            .expect("a take")
            .1
            .iter()
            .filter(|p| p.place == lovelock_project::error::Place::Take)
            .count(),
        0
    );

    std::fs::write(&hair, strands(40, 1.0)).expect("a file");
    let (_, problems) = TakePlayer::open(&path, &Access::new()).expect("guides of the same layout");
    let told: Vec<_> = problems.iter().filter(|p| p.place == lovelock_project::error::Place::Take).collect();
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(told.iter().all(|problem| problem.kind == ProblemKind::Note));
    assert!(told[0].message.contains("tuft.hair has changed"), "{}", told[0].message);
    assert!(told[1].message.contains("the hairstyle has changed"), "{}", told[1].message);

    // The grown hairstyle replaces the missing file, and does not fit.
    std::fs::remove_file(&hair).expect("a file to remove");
    let error = TakePlayer::open(&path, &Access::new()).err().expect("a refusal");
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("dance.take") && error.to_string().contains("guides of"), "{error}");
}

#[test]
fn a_take_in_the_takes_folder_may_read_the_files_of_its_project() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut access = Access::new();
    for (take, inside) in [("takes/p-1.take", true), ("other/p-1.take", false), ("p-1.take", true)] {
        access.set_take(&folder.path().join(take));
        assert_eq!(access.allows(&folder.path().join("x.hair")), inside, "{take}");
        assert!(!access.allows(&folder.path().with_file_name("x.hair")), "{take}: not above the project");
    }
}

#[test]
fn frames_are_not_interpolated_across_a_jump() {
    let (_folder, path) = folder();
    let project = small_project();
    let (scene, _) = SceneLoader::new().load_now(&project, &Access::new()).expect("a scene");
    let mut engine = settled(scene, &project);
    let mut take = TakeRecording::start(&path, &Arc::new(project), &engine).expect("a take");
    for step in 1..20 {
        if step == 10 {
            engine.seek(4.0);
        }
        engine.step();
        take.push(&engine).expect("a frame");
    }
    take.finish().expect("a whole take");
    let mut player = played(&path);
    let at =
        |player: &mut TakePlayer, frame: f64| player.snapshot(frame / 60.0).expect("an instant").time_secs;
    let (before, after) = (at(&mut player, 9.0), at(&mut player, 10.0));
    assert!(after - before > 3.0, "{before} to {after}");
    for frame in [9.3, 9.7] {
        let time = at(&mut player, frame);
        assert!(time == before || time == after, "frame {frame} is at {time}, between {before} and {after}");
    }
    let between = at(&mut player, 8.5);
    assert!(
        between > at(&mut player, 8.0) && between < before,
        "control: neighbouring frames are interpolated"
    );
}

#[test]
fn a_lost_second_is_bridged_and_reported_once() {
    let (_folder, path) = folder();
    recorded(&path, &small_project(), 150, |_, _| {});
    let mut bytes = std::fs::read(&path).expect("a file");
    // Damage in the middle, because the header is at the start and the index at the end.
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x10;
    std::fs::write(&path, bytes).expect("a file");
    let (mut player, _) = TakePlayer::open(&path, &Access::new()).expect("a take that plays");
    let mut told = Vec::new();
    for frame in 0..150 {
        let snapshot = player.snapshot(f64::from(frame) / 60.0).expect("every instant shows something");
        assert!((snapshot.position_secs - f64::from(frame) / 60.0).abs() < 1e-9);
        told.extend(player.notices());
    }
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("dance.take") && told[0].contains("lost"), "{}", told[0]);
    assert!(!player.condition().is_whole());
}

#[test]
fn a_transport_loops_plays_backwards_and_stops_at_its_ends() {
    let (_folder, path) = folder();
    recorded(&path, &small_project(), 61, |_, _| {});
    let mut transport = TakeTransport::new(played(&path));
    transport.set_looping(false);
    assert!(!transport.advance(0.5) && transport.advance(0.75), "the end is at a second");
    assert!(transport.is_at_end(false) && !transport.is_at_end(true));
    assert!((transport.snapshot().expect("a frame").position_secs - 1.0).abs() < 1e-9);
    assert!(!transport.advance(-0.25) && transport.advance(-2.0), "backward playback stops at the start");
    assert!(transport.is_at_end(true));
    transport.step(-1);
    assert_eq!(transport.snapshot().expect("a frame").position_secs, 0.0);
    transport.set_looping(true);
    transport.step(-1);
    assert!((transport.snapshot().expect("a frame").position_secs - 1.0).abs() < 1e-9, "the last frame");
    assert!(!transport.advance(2.0 / 60.0));
    assert!((transport.snapshot().expect("a frame").position_secs - 1.0 / 60.0).abs() < 1e-9, "and round");
}

/// A take of the program before the extinction scale moved from the section `shadow` to the look of the hair.
#[test]
fn a_take_of_project_version_1_keeps_its_extinction() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/take/version_1.take");
    let (mut player, problems) = TakePlayer::open(&path, &Access::new()).expect("a take that plays");
    // The dancer has another scalp since.
    assert!(
        problems.iter().all(|problem| problem.cause.contains("the hairstyle has changed")),
        "{problems:?}"
    );
    let project = player.project();
    assert_eq!((project.look.extinction_scale, project.shadow.deep_opacity_maps.layers), (0.3, 6));
    let targets: Vec<_> = project.timeline.tracks.iter().map(|track| track.target.as_str()).collect();
    assert_eq!(targets, ["look/extinction_scale", "camera/distance"]);
    assert_eq!(player.frames(), 6);
    player.snapshot(0.05).expect("a frame");
}
