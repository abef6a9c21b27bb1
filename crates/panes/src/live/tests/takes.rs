//! Panes with takes of their own.

use std::path::Path;

use lovelock_project::files::FileRef;
use lovelock_session::take::TakePlayer;
use lovelock_session::testing::{CURVES_FIRST_FRAME, moving_curves, recorded};

use super::*;

/// A take of the small project in a wind, a quarter of a second long.
fn windy(path: &Path) {
    let mut project = small_project();
    project.simulation.wind.speed = 12.0;
    recorded(path, &project, 16, |_, _| {});
}

#[test]
fn a_pane_shows_its_own_take_at_the_time_of_all() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("windy.take");
    windy(&path);
    let mut rig = Rig::new(Box::new(Renderer::open_for), Backend::Cpu, &[ShadowMethod::VoxelMap; 2]);
    rig.project.compare.panes[1].take = Some(FileRef::new(&path));
    let mut access = Access::new();
    access.pick(&path);
    let mut at = |secs: f64| {
        rig.snapshot = Arc::new(FrameSnapshot { position_secs: secs, ..FrameSnapshot::clone(&rig.snapshot) });
        rig.draw(LiveRequest { access: access.clone(), ..rig.request(&[0, 1]) });
        [0, 1].map(|pane| {
            rig.live.pane(pane).and_then(lovelock_session::latest::Latest::latest).expect("a pane")
        })
    };
    let [own, start] = at(0.0);
    assert_eq!((&own.problem, &start.problem), (&None, &None));
    assert!(pixels(&own) != pixels(&start), "the take is another one");
    let [again, end] = at(0.2);
    assert!(pixels(&own) == pixels(&again), "what the window shows has not moved");
    assert!(pixels(&start) != pixels(&end), "the take has gone on");
    assert!(end.label().contains("take windy"), "{}", end.label());

    // It is the picture that the take itself gives.
    let (mut player, _) = TakePlayer::open(&path, &access).expect("a take");
    let snapshot = player.snapshot(0.2).expect("a frame");
    let project = end.contender.applied_to(&rig.project).compared();
    let camera = snapshot.camera(&project.camera);
    let mut picture = Picture::default();
    let input = snapshot.frame_input(&project, &camera);
    Renderer::open(Backend::Cpu)
        .expect("the processor")
        .picture(&input, 64, 48, &mut picture)
        .expect("a picture");
    assert!(picture == pixels(&end));
}

#[test]
fn a_take_that_is_not_allowed_or_not_there_is_said_in_its_pane_and_costs_no_other() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("gone.take");
    let mut rig = Rig::new(Box::new(Renderer::open_for), Backend::Cpu, &[ShadowMethod::VoxelMap; 2]);
    rig.project.compare.panes[1].take = Some(FileRef::new(&path));
    for allowed in [false, true] {
        let mut access = Access::new();
        if allowed {
            access.pick(&path);
        }
        rig.draw(LiveRequest { access, ..rig.request(&[0, 1]) });
        let [own, other] = [0, 1].map(|pane| {
            rig.live.pane(pane).and_then(lovelock_session::latest::Latest::latest).expect("a pane")
        });
        assert!(own.problem.is_none() && !own.image.is_empty());
        assert!(other.problem.as_ref().is_some_and(|why| why.contains("gone.take")), "{:?}", other.problem);
    }
}

/// The picture of curves around `project`, so many seconds after their first frame.
fn picture_of_curves(path: &Path, access: &Access, project: &Project, secs: f64) -> Picture {
    let (mut player, _) = TakePlayer::open_for(path, access, project).expect("curves");
    let snapshot = player.snapshot(secs).expect("a frame");
    let shown = project.compare.panes[1].applied_to(project).compared();
    let camera = snapshot.camera(&shown.camera);
    let mut picture = Picture::default();
    let input = snapshot.frame_input(&shown, &camera);
    let mut renderer = Renderer::open(Backend::Cpu).expect("the processor");
    renderer.picture(&input, 64, 48, &mut picture).expect("a picture");
    picture
}

#[test]
fn a_pane_of_curves_is_in_step_with_a_simulation_and_follows_the_motion_of_the_project() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("c.abc");
    moving_curves(&path, 9);
    let mut rig = Rig::new(Box::new(Renderer::open_for), Backend::Cpu, &[ShadowMethod::VoxelMap; 2]);
    rig.project.compare.panes[1].take = Some(FileRef::new(&path));
    let access = access_to(&path);
    // The curves begin 0.2 s into the dance; 0.1 s later they have gone on by three frames.
    let start = CURVES_FIRST_FRAME as f64 / 30.0;
    let at = start + 0.1;
    let snapshot = FrameSnapshot { position_secs: at, time_secs: at, ..FrameSnapshot::clone(&rig.snapshot) };
    rig.snapshot = Arc::new(snapshot);
    let shown = |rig: &Rig| {
        rig.draw(LiveRequest { access: access.clone(), ..rig.request(&[1]) });
        let pane = rig.pane(1);
        assert_eq!(pane.problem, None);
        pixels(&pane)
    };
    let drawn = shown(&rig);
    assert!(drawn == picture_of_curves(&path, &access, &rig.project, 0.1));
    // Control: out of step by the start of the curves.
    assert!(drawn != picture_of_curves(&path, &access, &rig.project, at));
    assert!(shown(&rig) == drawn, "control: nothing has changed");

    // Another motion of the project moves the body under the curves.
    rig.project.motion.source = lovelock_project::project::MotionSource::Rest;
    let resting = shown(&rig);
    assert!(resting != drawn && resting == picture_of_curves(&path, &access, &rig.project, 0.1));
}

fn access_to(path: &Path) -> Access {
    let mut access = Access::new();
    access.pick(path);
    access
}
