//! Small projects, scenes and takes for tests.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use glam::Vec3;
use lovelock_project::error::Problem;
use lovelock_project::files::Access;
use lovelock_project::project::Project;

use crate::engine::Engine;
use crate::scene::{Scene, SceneLoader};
use crate::snapshot::FrameSnapshot;
use crate::take::{TakePlayer, TakeRecording};

/// The default project with little hair, so that tests are quick.
pub fn small_project() -> Project {
    let mut project = Project::default();
    project.hair.groom.wisps = 16;
    project.hair.groom.strands_per_wisp = 3;
    project.hair.groom.segments_per_strand = 8;
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
    let mut engine = Engine::new(scene, project.simulation);
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
