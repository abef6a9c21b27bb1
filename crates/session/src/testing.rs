//! Small projects, scenes and takes for tests.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use glam::Vec3;
use lovelock_project::error::Problem;
use lovelock_project::files::Access;
use lovelock_project::project::Project;
use lovelock_record::{CurveFrame, CurveScene, CurveWriter, FrameRate};

use crate::clock::STEP_SECS;
use crate::engine::Engine;
use crate::scene::{Scene, SceneLoader};
use crate::snapshot::FrameSnapshot;
use crate::take::{TakePlayer, TakeRecording};

/// The default project with little hair and a short pre-roll, so that tests are quick.
pub fn small_project() -> Project {
    let mut project = Project::default();
    project.hair.groom.wisps = 16;
    project.hair.groom.strands_per_wisp = 3;
    project.hair.groom.segments_per_strand = 8;
    project.timeline.preroll_secs = 0.5;
    project
}

/// The scene of a project and what is missing of it.
pub fn load(project: &Project) -> (Arc<Scene>, Vec<Problem>) {
    SceneLoader::new().load_now(project, &Access::new()).expect("a scene")
}

/// The small project's scene, loaded once for all tests.
pub fn scene() -> Arc<Scene> {
    static SCENE: OnceLock<Arc<Scene>> = OnceLock::new();
    Arc::clone(SCENE.get_or_init(|| load(&small_project()).0))
}

/// A scene whose hair is settled at the first frame as the project says.
pub fn settled(scene: Arc<Scene>, project: &Project) -> Engine {
    let mut engine = Engine::at_rest(scene, project.simulation, STEP_SECS);
    engine.follow(project);
    engine.settle();
    engine
}

fn points(frame: &FrameSnapshot) -> Vec<Vec3> {
    let guides = &frame.guides.guides;
    (0..guides.x.len()).map(|i| Vec3::new(guides.x[i], guides.y[i], guides.z[i])).collect()
}

/// The largest distance of a guide point between two instants, metres.
pub fn farthest(a: &FrameSnapshot, b: &FrameSnapshot) -> f32 {
    assert_eq!(a.guides.guides.x.len(), b.guides.guides.x.len());
    points(a).iter().zip(points(b)).map(|(a, b)| a.distance(b)).fold(0.0, f32::max)
}

/// Records `steps` of a project and returns each instant as it was simulated. `change` may change the project.
pub fn recorded(
    path: &Path,
    project: &Project,
    steps: u64,
    mut change: impl FnMut(u64, &mut Project),
) -> Vec<FrameSnapshot> {
    let mut loader = SceneLoader::new();
    let mut project = project.clone();
    let (scene, _) = loader.load_now(&project, &Access::new()).expect("a scene");
    let mut engine = settled(scene, &project);
    let mut take = TakeRecording::start(path, &Arc::new(project.clone()), &engine).expect("a take");
    let mut frames = vec![FrameSnapshot::clone(&engine.snapshot())];
    for step in 1..steps {
        let before = project.clone();
        change(step, &mut project);
        if project != before {
            let scene = loader.load_now(&project, &Access::new()).expect("a scene").0;
            assert!(take.set_scene(&scene).expect("a size"), "hair");
            engine.set_scene(scene);
            engine.set_settings(&project.simulation);
            take.change(&Arc::new(project.clone())).expect("a change");
        }
        engine.step();
        take.push(&engine).expect("a frame");
        frames.push(FrameSnapshot::clone(&engine.snapshot()));
    }
    let report = take.finish().expect("a whole take");
    assert_eq!((report.frames, report.path.as_path()), (steps, path));
    frames
}

/// The step at which the number of wisps of [`regrown`] increases.
pub const MORE: u64 = 40;
/// The step at which it returns to the old number.
pub const AGAIN: u64 = 70;

/// Records a take of 100 steps in which the number of guides changes twice.
pub fn regrown(path: &Path) -> Vec<FrameSnapshot> {
    recorded(path, &small_project(), 100, |step, project| match step {
        MORE => project.hair.groom.wisps = 21,
        AGAIN => project.hair.groom.wisps = 16,
        _ => {}
    })
}

/// How many guides a frame has.
pub fn guides(frame: &FrameSnapshot) -> usize {
    frame.guides.guides.count()
}

/// A take that plays without problems.
pub fn played(path: &Path) -> TakePlayer {
    let (player, problems) = TakePlayer::open(path, &Access::new()).expect("a take that plays");
    assert_eq!(problems, []);
    player
}

/// Number of the first frame of [`moving_curves`], which have 30 per second.
pub const CURVES_FIRST_FRAME: u64 = 6;

/// A point of a curve in a frame: strands of four or five points above the head, which swing.
fn point_of_curve(frame: u64, strand: usize, i: usize) -> Vec3 {
    let angle = 0.1 * strand as f32;
    let out = 0.08 + 0.03 * i as f32;
    Vec3::new(out * angle.cos(), 1.7 - 0.04 * i as f32 + 0.01 * frame as f32, out * angle.sin())
}

fn strands_of_curves() -> impl Iterator<Item = (usize, usize)> {
    (0..60).map(|strand| (strand, 4 + strand % 2))
}

/// The points of [`moving_curves`] in a frame.
pub fn points_of_curves(frame: u64) -> Vec<Vec3> {
    strands_of_curves()
        .flat_map(|(strand, count)| (0..count).map(move |i| point_of_curve(frame, strand, i)))
        .collect()
}

/// Writes curves over time as another program would, in the format of the extension.
///
/// # Panics
/// If the file cannot be written.
pub fn moving_curves(path: &Path, frames: u64) {
    let mut first_point = vec![0];
    for (_, count) in strands_of_curves() {
        first_point.push(first_point[first_point.len() - 1] + count as u32);
    }
    let count = first_point[first_point.len() - 1] as usize;
    let scene = CurveScene {
        rate: FrameRate { num: 30, den: 1 },
        first_frame: CURVES_FIRST_FRAME,
        frames,
        first_point,
        widths: vec![1e-4; count],
        colors: vec![Vec3::new(0.3, 0.05, 0.02); count],
        are_guides: false,
        marks: lovelock_groom::StrandMarks::default(),
        body: None,
    };
    let mut writer = CurveWriter::create(path, scene).expect("a file");
    for frame in 0..frames {
        let points = points_of_curves(frame);
        let axis = |k: usize| points.iter().map(|p| p[k]).collect::<Vec<_>>();
        let [x, y, z] = [0, 1, 2].map(axis);
        writer.push(&CurveFrame { points: [&x, &y, &z], body: None }).expect("a frame");
    }
    writer.finish().expect("a file");
}
