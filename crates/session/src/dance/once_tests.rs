//! Films of a motion whose last pose is not its first: every pose from the first to the last, and a blend only where it loops.

use std::ops::ControlFlow;

use lovelock_motion::{LoopBlend, Pose, pose_at, retarget};
use lovelock_project::Project;
use lovelock_project::files::Access;

use super::Dance;
use crate::progress::Progress;
use crate::testing::small_project;

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Half a second of the dance, whose ends differ.
fn open_ended() -> Project {
    let mut project = small_project();
    (project.motion.start_secs, project.motion.end_secs) = (1.0, Some(1.5));
    project.motion.loop_blend_secs = 0.2;
    project
}

fn opened(project: &Project) -> (Dance, Vec<String>) {
    let (dance, problems) = Dance::open(project, &Access::new(), 30.0, &mut go_on).expect("a dance");
    (dance, problems.iter().map(ToString::to_string).collect())
}

/// Largest distance between a joint of a scene at a time and that of its own clip without a blend, metres.
fn off(dance: &Dance, frame: u64, secs: f64) -> f32 {
    let scene = dance.scene();
    let clip = scene.clip.as_deref().expect("a clip");
    let plain = clip.clone().played_once();
    let (mut shown, mut plainly) = (Pose::default(), Pose::default());
    pose_at(&scene.body, Some(clip), scene.clip_secs(dance.secs_of(frame)), &mut shown);
    pose_at(&scene.body, Some(&plain), secs.min(plain.duration_secs.next_down()), &mut plainly);
    let joints = shown.world_from_joint.iter().zip(&plainly.world_from_joint);
    joints.map(|(a, b)| (a.translation - b.translation).length()).fold(0.0, f32::max)
}

#[test]
fn a_film_has_every_pose_from_the_first_to_the_last() {
    let (mut dance, notes) = opened(&open_ended());
    assert!(notes.iter().any(|note| note.contains("its last 0.20 s are blended")), "{notes:?}");
    assert_eq!((dance.frames(), dance.frames_of_round()), (16, 15));
    // Control: while it loops, its end is blended.
    assert!(off(&dance, 7, 7.0 / 30.0) < 1e-6 && off(&dance, 14, 14.0 / 30.0) > 0.01);
    // Frames of a second round need the blend.
    dance.play_once(&(0..17), &mut []);
    assert!(dance.scene().looping);
    let mut problems = dance.scene().notes.to_vec();
    dance.play_once(&(0..16), &mut problems);
    let notes: Vec<String> = problems.iter().map(ToString::to_string).collect();
    assert!(notes.iter().any(|note| note.contains("plays once")), "{notes:?}");
    assert!(!notes.iter().any(|note| note.contains("blended into")), "{notes:?}");
    for frame in 0..16 {
        assert!(off(&dance, frame, frame as f64 / 30.0) < 1e-6, "{frame}");
    }
    let start = dance.scene().position_secs(0.0);
    assert_eq!((start, dance.scene().position_secs(9.0)), (0.0, 0.5), "it ends with its last pose");
}

#[test]
fn a_motion_that_repeats_by_itself_is_recorded_for_one_round() {
    let (mut dance, notes) = opened(&small_project());
    assert!(!notes.iter().any(|note| note.contains("last pose")), "{notes:?}");
    assert_eq!(dance.frames(), dance.frames_of_round());
    dance.play_once(&(0..dance.frames()), &mut []);
    assert!(dance.scene().looping);
    // Once, its last pose is a frame.
    let mut once = small_project();
    once.motion.looping = false;
    assert_eq!(opened(&once).0.frames(), dance.frames() + 1);
}

#[test]
fn a_project_with_the_blend_at_the_start_keeps_it() {
    let mut project = open_ended();
    project.motion.loop_blend = LoopBlend::Start;
    let (mut dance, notes) = opened(&project);
    assert!(notes.iter().any(|note| note.contains("0.20 s shorter")), "{notes:?}");
    assert_eq!(dance.frames(), 9);
    let before = dance.scene().clone();
    dance.play_once(&(0..9), &mut []);
    assert!(std::sync::Arc::ptr_eq(&before, dance.scene()));
    assert!(off(&dance, 0, 0.0) > 0.01 && off(&dance, 8, 8.0 / 30.0) < 1e-6, "the start is blended");
}

#[test]
fn all_rows_of_a_file_are_played() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    let file = data.join("reports/open_ends_59_rows.bvh");
    let mut project = small_project();
    project.set_motion_file(&file);
    let mut access = Access::new();
    access.pick(&file);
    let (mut dance, mut problems) = Dance::open(&project, &access, 30.0, &mut go_on).expect("a dance");
    assert_eq!(dance.frames(), 59);
    dance.play_once(&(0..59), &mut problems);
    let motion = lovelock_motion::load_motion(&file).expect("a motion");
    let scene = dance.scene();
    let clip = retarget(&motion, &scene.body).expect("a clip");
    let (mut shown, mut row) = (Pose::default(), Pose::default());
    for frame in 0..59 {
        let secs = frame as f64 * motion.frame_secs;
        pose_at(&scene.body, scene.clip.as_deref(), scene.clip_secs(dance.secs_of(frame)), &mut shown);
        pose_at(&scene.body, Some(&clip), secs.min(clip.duration_secs.next_down()), &mut row);
        let joints = shown.world_from_joint.iter().zip(&row.world_from_joint);
        let off = joints.map(|(a, b)| (a.translation - b.translation).length()).fold(0.0, f32::max);
        assert!(off < 1e-3, "{frame}: {off} m");
    }
}
