use std::path::Path;

use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_project::Project;
use lovelock_project::error::Place;
use lovelock_project::files::Access;
use lovelock_render::HairPose;

use super::{TakePlayer, project_of_cache, project_of_take};
use crate::dance::Dance;
use crate::testing::{CURVES_FIRST_FRAME, moving_curves, points_of_curves, small_project};

/// Number of frames of the tests' curves.
const FRAMES: u64 = 5;

fn write(path: &Path, frames: u64) {
    moving_curves(path, frames);
}

fn points(frame: u64) -> Vec<Vec3> {
    points_of_curves(frame)
}

/// The largest distance between each point of the strands and the closest wanted point.
fn off(strands: &Strands, wanted: &[Vec3]) -> f32 {
    assert_eq!(strands.points(), wanted.len());
    let nearest = |p: Vec3| wanted.iter().map(|w| w.distance(p)).fold(f32::INFINITY, f32::min);
    (0..strands.points()).map(|i| nearest(strands.point(i))).fold(0.0, f32::max)
}

#[test]
fn curves_of_another_program_play_at_their_times() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["ü cache.abc", "b.usdc", "c.usda"] {
        plays(&folder.path().join(name));
    }
}

fn plays(path: &Path) {
    write(path, FRAMES);
    let project = project_of_cache(&small_project(), path).expect("a project");
    assert_ne!(project.look.eumelanin, Project::default().look.eumelanin, "the colour of the file");
    let (mut player, problems) = TakePlayer::open_for(path, &Access::new(), &project).expect("curves");
    assert_eq!(problems, []);
    assert!(player.is_cache());
    let notes: Vec<_> = player.scene().notes.iter().filter(|note| note.place == Place::Take).collect();
    assert!(notes[0].message.contains("Unit: read from the file"), "{notes:?}");
    assert_eq!((player.frames(), player.header().strands), (FRAMES, 60));
    assert!((player.duration_secs() - 4.0 / 30.0).abs() < 1e-9);
    for frame in [0, 3, 1, FRAMES - 1] {
        let secs = frame as f64 / 30.0;
        let snapshot = player.snapshot(secs).expect("a frame");
        let strands = snapshot.strands.as_ref().expect("strands");
        assert!(off(strands, &points(frame)) < 1e-6, "frame {frame}");
        // Negative control.
        assert!(off(strands, &points(frame + 1)) > 1e-3, "frame {frame}");
        assert_eq!(*strands.first_point, *snapshot.scene.style.strands.first_point);
        assert!((snapshot.time_secs - (CURVES_FIRST_FRAME + frame) as f64 / 30.0).abs() < 1e-9);
        let camera = snapshot.camera(&project.camera);
        let input = snapshot.frame_input(&project, &camera);
        assert!(matches!(input.hair, HairPose::Strands(_)));
        let mut copied = Strands::default();
        snapshot.interpolate(&mut copied);
        assert_eq!(copied.x, strands.x);
        // The guides are on the curves: their roots are roots, their tips are tips.
        let guides = &snapshot.guides.guides;
        let root = guides.point(0, 0);
        let roots: Vec<Vec3> = strands_roots(strands);
        assert!(roots.iter().any(|p| p.distance(root) < 2e-3), "{root}");
    }
    // Half-way between two frames each point is half-way.
    let between = player.snapshot(1.5 / 30.0).expect("a frame");
    let wanted: Vec<Vec3> = points(1).iter().zip(points(2)).map(|(a, b)| a.lerp(b, 0.5)).collect();
    assert!(off(between.strands.as_ref().expect("strands"), &wanted) < 1e-6);
    // The body dances: it is where the dance is at the time of the file.
    let (scene, _) = crate::testing::load(&small_project());
    let mut pose = lovelock_motion::Pose::default();
    lovelock_motion::pose_at(&scene.body, scene.clip.as_deref(), 6.0 / 30.0, &mut pose);
    let first = player.snapshot(0.0).expect("a frame");
    assert!(first.guides.world_from_head.translation.distance(pose.world_from_head.translation) < 1e-5);
}

fn strands_roots(strands: &Strands) -> Vec<Vec3> {
    (0..strands.count()).map(|strand| strands.point(strands.first_point[strand] as usize)).collect()
}

#[test]
fn a_cache_is_a_dance_without_a_simulation() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.abc");
    write(&path, FRAMES);
    let (project, _) = project_of_take(&path).expect("a project");
    let mut access = Access::new();
    access.pick(&path);
    let go_on = &mut |_| std::ops::ControlFlow::Continue(());
    let (mut dance, problems) = Dance::open(&project, &access, 30.0, go_on).expect("a dance");
    assert_eq!((dance.frames(), problems), (FRAMES, vec![]));
    assert!(dance.check(&(0..FRAMES)).is_ok() && dance.check(&(0..FRAMES + 1)).is_err());
    let snapshot = dance.snapshot(2).expect("a frame");
    assert!(off(snapshot.strands.as_ref().expect("strands"), &points(2)) < 1e-6);
    let refused = dance.close(&(0..FRAMES)).expect_err("no loop").to_string();
    assert!(refused.contains("a.abc"), "{refused}");
}

#[test]
fn curves_of_one_time_and_other_files_do_not_play() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.abc");
    write(&path, 1);
    let error = project_of_take(&path).expect_err("one time").to_string();
    assert!(error.contains("a.abc: found curves at one time"), "{error}");
    std::fs::write(&path, b"HAIR and more").expect("a file");
    assert!(project_of_take(&path).is_err());
}
