//! The scene and its simulation. No test here needs a graphics adapter.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::Vec3;
use lovelock_motion::Clip;
use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProjectError};
use lovelock_project::files::Access;
use lovelock_simulation::SimulationSettings;

use crate::scene::*;
use crate::snapshot::FrameSnapshot;
use crate::testing::{load, scene, settled, small_project};

/// A speed that hair never reaches in the dance, where the head turns at a few metres per second.
const WHIP_METRES_PER_SEC: f32 = 15.0;

/// The guides' points relative to the head.
pub(super) fn in_head_space(frame: &FrameSnapshot) -> Vec<Vec3> {
    let head_from_world = frame.guides.world_from_head.inverse();
    let guides = &frame.guides.guides;
    (0..guides.x.len())
        .map(|i| head_from_world.transform_point3(Vec3::new(guides.x[i], guides.y[i], guides.z[i])))
        .collect()
}

pub(super) fn farthest(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn the_default_project_is_a_dancer_with_hair() {
    let (scene, problems) = load(&Project::default());
    assert_eq!(problems, []);
    assert!(scene.duration_secs() >= 8.0 && scene.loops_smoothly());
    assert_eq!(scene.clip.as_ref().map(|clip| clip.name.as_str()), Some("dance"));
    assert_eq!(scene.style.strands.segments(), 100_500);
    assert!(!scene.colliders.is_empty());
    let body = &scene.body;
    let head = Vec3::from(body.skeleton.world_at_rest[body.head_joint].translation);
    assert!((1.3..1.7).contains(&head.y), "the head joint is at {head}");
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let scene = scene();
    let hash_with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut engine = settled(Arc::clone(&scene), &small_project());
            engine.advance_to_step(40);
            (engine.state_hash(), engine.snapshot().guides.clone())
        })
    };
    let one = hash_with(1);
    assert_eq!(hash_with(2), one);
    assert_eq!(hash_with(8), one);
    let mut engine = settled(Arc::clone(&scene), &small_project());
    engine.advance_to_step(41);
    assert_ne!(engine.state_hash(), one.0, "control: the hash changes with a step");
}

#[test]
fn a_restart_clears_all_state() {
    let scene = scene();
    let mut fresh = settled(Arc::clone(&scene), &small_project());
    let mut played = settled(scene, &small_project());
    played.advance_to_step(33);
    played.seek(5.0);
    played.step();
    played.restart();
    assert_eq!(played.state_hash(), fresh.state_hash());
    fresh.step();
    played.step();
    assert_eq!(played.state_hash(), fresh.state_hash());
}

#[test]
fn hair_is_settled_at_the_first_frame() {
    let mut project = small_project();
    project.motion.source = lovelock_project::project::MotionSource::Rest;
    let mut engine = settled(load(&project).0, &small_project());
    let before = in_head_space(&engine.snapshot());
    engine.advance_to_step(60);
    let after = in_head_space(&engine.snapshot());
    // The remaining movement after one second is invisible: a few millimetres at the tips.
    assert!(farthest(&before, &after) < 0.02, "hair moved by {} m", farthest(&before, &after));
}

#[test]
fn a_seek_moves_the_hair_rigidly_and_does_not_whip_it() {
    let mut engine = settled(scene(), &small_project());
    engine.advance_to_step(30);
    for time_secs in [3.7, 0.2, 6.1, 1.9] {
        let before = in_head_space(&engine.snapshot());
        engine.seek(time_secs);
        let frame = engine.snapshot();
        assert!((frame.time_secs - time_secs).abs() < crate::clock::STEP_SECS);
        if frame.report.jumped {
            let moved = farthest(&before, &in_head_space(&frame));
            assert!(moved < 1e-3, "hair moved by {moved} m relative to the head");
        }
        for _ in 0..20 {
            engine.step();
            let speed = engine.snapshot().report.max_speed;
            assert!(speed < WHIP_METRES_PER_SEC, "{speed} m/s after a seek to {time_secs}");
        }
    }
    assert!(engine.totals().jumps > 0, "the dance moves the head between those times");
}

#[test]
fn a_loop_is_seamless_where_the_clip_allows() {
    let scene = scene();
    let mut engine = settled(Arc::clone(&scene), &small_project());
    let frames = (scene.duration_secs() / crate::clock::STEP_SECS) as u64;
    engine.seek((frames - 40) as f64 * crate::clock::STEP_SECS);
    engine.settle();
    engine.advance_to_step(frames - 5);
    engine.clear_totals();
    for _ in 0..15 {
        engine.step();
        assert!(engine.snapshot().report.max_speed < WHIP_METRES_PER_SEC);
    }
    assert_eq!(engine.totals().jumps, 0);
    assert!(engine.position_secs() < 1.0, "the timeline has started again");
    assert!(engine.totals().max_stretch < 1e-3);
}

#[test]
fn a_clip_without_loop_moves_the_hair_rigidly_over_its_seam() {
    let whole = scene();
    let clip = whole.clip.as_ref().expect("a clip");
    // Trim the clip where the head is far from its start.
    let start = whole.head_path.smoothed(0.0, 0.0);
    let cut = (1..80)
        .map(|i| f64::from(i) * 0.1)
        .max_by(|a, b| {
            let away = |t: &f64| whole.head_path.smoothed(*t, 0.0).distance(start);
            away(a).total_cmp(&away(b))
        })
        .expect("a time");
    let cut_clip = Clip { duration_secs: cut, loops: false, ..(**clip).clone() };
    let scene = Arc::new(Scene { clip: Some(Arc::new(cut_clip)), ..(*whole).clone() });
    assert!(!scene.loops_smoothly());
    let mut engine = settled(Arc::clone(&scene), &small_project());
    let seam = (cut / crate::clock::STEP_SECS) as u64;
    engine.seek((seam - 40) as f64 * crate::clock::STEP_SECS);
    engine.settle();
    engine.advance_to_step(seam - 3);
    engine.clear_totals();
    for _ in 0..20 {
        engine.step();
        assert!(engine.snapshot().report.max_speed < WHIP_METRES_PER_SEC);
    }
    assert_eq!(
        engine.totals().jumps,
        1,
        "the head moves by {} m",
        whole.head_path.smoothed(cut, 0.0).distance(start)
    );
}

#[test]
fn a_sudden_move_of_the_head_would_whip_the_hair() {
    // Negative control of the tests above: a move just below the distance of a jump exceeds the same bound.
    let scene = scene();
    let mut simulation = lovelock_simulation::Simulation::new(Arc::clone(&scene.style));
    let at = |x: f32| glam::Affine3A::from_translation(Vec3::new(x, 1.5, 0.0));
    let input = |time_secs, x| lovelock_simulation::StepInput::new(time_secs, at(x), &[]);
    simulation.reset(&input(0.0, 0.0));
    let report = simulation.step(&input(1.0 / 60.0, 0.45), &SimulationSettings::default(), 1.0 / 60.0);
    assert!(!report.jumped && report.max_speed > WHIP_METRES_PER_SEC, "{report:?}");
}

#[test]
fn a_motion_without_a_loop_ends_at_its_last_pose() {
    let mut project = small_project();
    project.motion.looping = false;
    let scene = load(&project).0;
    let mut engine = settled(Arc::clone(&scene), &small_project());
    engine.seek(scene.duration_secs() + 5.0);
    assert!(engine.is_at_end());
    assert_eq!(engine.position_secs(), scene.duration_secs());
    let last = scene.clip_secs(1e9);
    assert!(last < scene.clip.as_ref().expect("a clip").duration_secs && last > 1.0);
}

#[test]
fn only_changed_parts_are_loaded_again() {
    let access = Access::new();
    let mut loader = SceneLoader::new();
    let mut project = small_project();
    let (first, _) = loader.load_now(&project, &access).expect("a scene");
    project.look.eumelanin = 5.0;
    project.hair.groom.look.eumelanin = 5.0;
    project.camera.distance = 1.0;
    project.motion.speed = 0.5;
    let (second, _) = loader.load_now(&project, &access).expect("a scene");
    assert!(Arc::ptr_eq(&first.style, &second.style) && Arc::ptr_eq(&first.head_path, &second.head_path));
    assert_eq!(second.duration_secs(), 2.0 * first.duration_secs());
    project.hair.groom.length = 0.2;
    let (third, _) = loader.load_now(&project, &access).expect("a scene");
    assert!(!Arc::ptr_eq(&second.style, &third.style), "other hair");
    assert!(Arc::ptr_eq(&second.body, &third.body) && Arc::ptr_eq(&second.colliders, &third.colliders));
}

#[test]
fn a_part_that_fails_keeps_the_old_one() {
    let dir = tempfile::tempdir().expect("a folder");
    let broken = dir.path().join("broken.hair");
    std::fs::write(&broken, b"HAIR and nothing else").expect("a file");
    let mut access = Access::new();
    access.pick(&broken);
    let mut loader = SceneLoader::new();
    let mut project = small_project();
    let (before, _) = loader.load_now(&project, &access).expect("a scene");
    project.set_hair_file(&broken);
    project.set_motion_file(dir.path().join("gone.bvh"));
    let (after, problems) = loader.load_now(&project, &access).expect("a scene");
    assert!(Arc::ptr_eq(&before.style, &after.style));
    assert!(before.clip.as_ref().map(Arc::as_ptr) == after.clip.as_ref().map(Arc::as_ptr));
    let places: Vec<_> = problems.iter().map(|problem| problem.place).collect();
    assert_eq!(places, [Place::Motion, Place::Hair], "{problems:?}");
    assert!(problems.iter().all(Problem::is_failure));
    assert!(
        problems[1].message.contains("broken.hair") && problems[1].message.contains("is kept"),
        "{problems:?}"
    );
}

#[test]
fn a_project_with_all_files_missing_still_moves() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut project = small_project();
    project.set_body_file(dir.path().join("gone.glb"));
    project.set_motion_file(dir.path().join("gone.bvh"));
    project.set_hair_file(dir.path().join("gone.hair"));
    let access = Access::for_project(&dir.path().join("p.lovelock"));
    let (scene, problems) = SceneLoader::new().load_now(&project, &access).expect("a scene");
    assert_eq!(problems.len(), 3, "{problems:?}");
    assert!(scene.duration_secs() > 1.0 && scene.style.strands.count() > 0);
    for (problem, name) in problems.iter().zip(["gone.glb", "gone.bvh", "gone.hair"]) {
        assert!(problem.message.contains(name), "{problem}");
    }
}

#[test]
fn a_missing_clip_is_named_with_the_existing_ones() {
    let mut project = small_project();
    project.motion.clip = "polka".to_owned();
    let (scene, problems) = load(&project);
    assert!(matches!(&problems[..], [p] if p.message.contains("`polka`") && p.message.contains("`dance`")));
    assert!(scene.clip.is_some());
}

#[test]
fn a_load_can_be_cancelled() {
    let cancelled = AtomicBool::new(true);
    let mut control = LoadControl { cancelled: &cancelled, progress: &mut |_, _| {} };
    let result = SceneLoader::new().load(&small_project(), &Access::new(), &mut control);
    assert!(matches!(result, Err(ProjectError::Cancelled)));
}

#[test]
fn a_load_can_be_cancelled_while_a_file_is_read() {
    const POINTS: usize = 300_000;
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("large.usda");
    let text = format!(
        "#usda 1.0\ndef BasisCurves \"a\"\n{{\n uniform token type = \"linear\"\n int[] curveVertexCounts = [{POINTS}]\n\
         point3f[] points = [{}]\n}}\n",
        "(1.5, 2.5, 3.5), ".repeat(POINTS)
    );
    std::fs::write(&path, text).expect("a file");
    let mut project = small_project();
    project.set_hair_file(&path);
    let mut access = Access::new();
    access.pick(&path);
    let cancelled = AtomicBool::new(false);
    let mut reports_after = None;
    let mut progress = |what: &str, _: f32| {
        reports_after = reports_after.map(|reports: u32| reports + 1);
        if what == "reading the hair" {
            cancelled.store(true, std::sync::atomic::Ordering::Relaxed);
            reports_after.get_or_insert(0);
        }
    };
    let mut control = LoadControl { cancelled: &cancelled, progress: &mut progress };
    let result = SceneLoader::new().load(&project, &access, &mut control);
    assert!(matches!(result, Err(ProjectError::Cancelled)));
    assert_eq!(reports_after.expect("it took longer than a report"), 0, "it is left at the next look");
}

#[test]
fn other_hair_appears_without_a_whip_and_time_continues() {
    let access = Access::new();
    let mut loader = SceneLoader::new();
    let mut project = small_project();
    let mut engine = settled(loader.load_now(&project, &access).expect("a scene").0, &project);
    engine.advance_to_step(100);
    for change in [
        |p: &mut Project| p.hair.groom.length = 0.25,
        |p: &mut Project| p.hair.groom.wisps = 20,
        |p: &mut Project| p.motion.speed = 0.7,
    ] {
        let clip_secs = engine.scene().clip_secs(engine.time_secs());
        change(&mut project);
        if engine.set_scene(loader.load_now(&project, &access).expect("a scene").0) {
            engine.settle();
        }
        let now = engine.scene().clip_secs(engine.time_secs());
        assert!(
            (now - clip_secs).abs() < 2.0 * crate::clock::STEP_SECS,
            "the pose goes on: {clip_secs} to {now}"
        );
        for step in 0..20 {
            engine.step();
            let report = engine.snapshot().report;
            // Hair of another length may start inside the body and is pushed out at once.
            assert!(step < 3 || report.max_speed < 0.5 * WHIP_METRES_PER_SEC, "step {step}: {report:?}");
        }
    }
}

#[test]
fn unshared_snapshots_are_reused() {
    let mut engine = settled(scene(), &small_project());
    let first = Arc::as_ptr(&engine.snapshot());
    let held = engine.snapshot();
    assert_eq!(Arc::as_ptr(&held), first, "the first one was unused");
    let other = engine.snapshot();
    assert_ne!(Arc::as_ptr(&other), first, "the first one is in use");
    let step = held.step;
    engine.step();
    engine.snapshot();
    assert_eq!(held.step, step, "snapshots in use do not change");
}

#[test]
fn the_camera_follows_without_trembling() {
    let scene = scene();
    let section = lovelock_project::project::CameraSection::default();
    let mut before = camera_at(&section, &scene, 0.0);
    let path: Vec<f32> = (1..=(scene.duration_secs() * 60.0) as u64)
        .map(|frame| {
            let now = camera_at(&section, &scene, frame as f64 / 60.0);
            let moved = now.target.distance(before.target);
            assert!((now.eye - now.target - (before.eye - before.target)).length() < 1e-5);
            before = now;
            moved
        })
        .collect();
    // At most a brisk walking speed, and no outliers.
    assert!(path.iter().all(|&moved| moved < 1.6 / 60.0), "{:?}", path.iter().copied().fold(0.0, f32::max));
    for pair in path.windows(2) {
        assert!((pair[1] - pair[0]).abs() < 0.003, "{pair:?}");
    }
}

#[test]
fn the_head_stays_in_the_picture_through_the_whole_dance() {
    let scene = scene();
    let mut pose = lovelock_motion::Pose::default();
    for frame in 0..(scene.duration_secs() * 30.0) as u64 {
        let time_secs = frame as f64 / 30.0;
        lovelock_motion::pose_at(&scene.body, scene.clip.as_deref(), scene.clip_secs(time_secs), &mut pose);
        let clip_from_world =
            camera_at(&lovelock_project::project::CameraSection::default(), &scene, time_secs)
                .clip_from_world(16.0 / 9.0);
        // Chin, crown, and the back of the head with its hair.
        for part in [Vec3::new(0.0, -0.05, 0.08), Vec3::new(0.0, 0.2, 0.0), Vec3::new(0.0, 0.05, -0.15)] {
            let p = clip_from_world * pose.world_from_head.transform_point3(part).extend(1.0);
            let (x, y) = (p.x / p.w, p.y / p.w);
            assert!(x.abs() < 0.97 && y.abs() < 0.97, "at {time_secs:.2} s the head is at {x:.2}, {y:.2}");
        }
    }
}

#[test]
fn framing_puts_the_hair_in_the_picture() {
    let mut engine = settled(scene(), &small_project());
    engine.advance_to_step(50);
    let frame = engine.snapshot();
    let guides = &frame.guides.guides;
    let points = || (0..guides.x.len()).map(|i| Vec3::new(guides.x[i], guides.y[i], guides.z[i]));
    for mode in [lovelock_project::project::CameraMode::Follow, lovelock_project::project::CameraMode::Fixed]
    {
        for aspect in [1.78, 0.6] {
            let section = lovelock_project::project::CameraSection {
                mode,
                ..lovelock_project::project::CameraSection::default()
            };
            let framed = frame_points(&section, &frame.scene, frame.time_secs, points(), aspect);
            let clip = frame.camera(&framed).clip_from_world(aspect);
            let mut largest = 0.0_f32;
            for p in points() {
                let p = clip * p.extend(1.0);
                largest = largest.max((p.x / p.w).abs()).max((p.y / p.w).abs());
            }
            assert!((0.5..1.0).contains(&largest), "{mode:?}, {aspect}: {largest}");
        }
    }
    let none = frame_points(
        &lovelock_project::project::CameraSection::default(),
        &frame.scene,
        0.0,
        std::iter::empty(),
        1.0,
    );
    assert_eq!(none, lovelock_project::project::CameraSection::default());
}
