//! Panes with takes of their own.

use std::path::Path;

use lovelock_project::files::FileRef;
use lovelock_session::take::TakePlayer;
use lovelock_session::testing::recorded;

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
