//! What is seen while time passes, without a clock: the thread's own turns, each told how much time has passed.

use std::sync::Arc;

use glam::Vec3;
use lovelock_motion::{Pose, pose_at};
use lovelock_project::Project;
use lovelock_project::files::Access;

use super::super::Outbox;
use super::super::load_thread::{LoadThread, Loaded};
use super::super::mailbox::{Mailbox, Wishes};
use super::{Inside, Scene};
use crate::clock::STEP_SECS;
use crate::engine::Engine;
use crate::latest::Slot;
use crate::scene::SceneLoader;
use crate::snapshot::FrameSnapshot;
use crate::testing::{load, small_project};

/// The thread's state and where it leaves its frames.
struct Driven {
    inside: Inside,
    frames: Slot<FrameSnapshot>,
    seen: u64,
}

impl Driven {
    /// A scene, its hair settled at the first frame, which is shown.
    fn new(project: &Project, scene: &Arc<Scene>) -> Self {
        let (outbox, _) = Outbox::new(Arc::new(|| ()));
        let loader = Arc::new(LoadThread::start(outbox.clone(), |_| ()).expect("a thread"));
        let frames = Slot::default();
        let inside =
            Inside::new(Mailbox::default(), frames.clone(), loader, outbox, Arc::default(), Arc::default());
        let mut driven = Self { inside, frames, seen: 0 };
        driven.put(project, scene);
        driven
    }

    /// Another scene; its hair lives to where time stands, where it does.
    fn put(&mut self, project: &Project, scene: &Arc<Scene>) {
        let loaded = Loaded::Scene(Arc::clone(scene), Arc::new(project.clone()));
        self.turn(Wishes { loaded: Some(loaded), ..Wishes::default() }, 0.0);
        self.arrive();
    }

    fn arrive(&mut self) {
        while self.inside.preroll.is_some() {
            self.turn(Wishes::default(), 0.0);
        }
    }

    fn turn(&mut self, wishes: Wishes, elapsed_secs: f64) {
        self.inside.turn(wishes, elapsed_secs);
    }

    /// What is shown next after so much time; none where nothing new is.
    fn after(&mut self, elapsed_secs: f64) -> Option<Arc<FrameSnapshot>> {
        self.frames.newer_than(&mut self.seen);
        self.turn(Wishes::default(), elapsed_secs);
        self.frames.newer_than(&mut self.seen)
    }

    fn picture(&mut self) -> Arc<FrameSnapshot> {
        let secs = self.inside.playback.picture_secs();
        self.after(secs).expect("a picture")
    }

    fn hash(&self) -> u64 {
        self.inside.engine.as_ref().expect("an engine").state_hash()
    }
}

#[test]
fn hair_that_a_newer_one_follows_does_not_settle_before_it() {
    let mut project = small_project();
    let mut driven = Driven::new(&project, &load(&project).0);
    driven.turn(Wishes { playing: Some(false), ..Wishes::default() }, 0.0);
    // A loader that stands still as it hands over what it has made.
    let (outbox, _) = Outbox::new(Arc::new(|| ()));
    let (go_on, gate) = std::sync::mpsc::sync_channel(2);
    let loader =
        Arc::new(LoadThread::start(outbox, move |_| gate.recv().unwrap_or_default()).expect("a thread"));
    driven.inside.loader = Arc::clone(&loader);
    let wanted = Arc::new(project.clone());
    let request = || loader.request(Arc::clone(&wanted), Access::new());
    let rest = || {
        while loader.is_busy() {
            std::thread::yield_now();
        }
    };
    request();
    rest();
    request();
    assert!(loader.is_busy());
    project.hair.groom.length *= 0.9;
    let other = Loaded::Scene(load(&project).0, Arc::new(project.clone()));
    driven.turn(Wishes { loaded: Some(other), ..Wishes::default() }, 0.0);
    let told = |driven: &Driven| driven.inside.settling.lock().expect("no panic").map(|told| told.done);
    for _ in 0..5 {
        assert!(driven.inside.preroll.is_none() && told(&driven) == Some(0), "it waits, and that is told");
        driven.turn(Wishes::default(), 0.1);
    }
    for _ in 0..2 {
        go_on.send(()).expect("a thread");
    }
    rest();
    driven.turn(Wishes::default(), 0.0);
    assert!(driven.inside.preroll.is_some(), "it settles");
    driven.arrive();
    assert_eq!(told(&driven), None);
}

fn slow(rate: f64) -> Wishes {
    Wishes { rate: Some(rate), ..Wishes::default() }
}

/// Points of the guides as the head sees them.
fn of_head(frame: &FrameSnapshot) -> Vec<Vec3> {
    let head_from_world = frame.guides.world_from_head.inverse();
    let guides = &frame.guides.guides;
    (0..guides.x.len())
        .map(|i| head_from_world.transform_point3(Vec3::new(guides.x[i], guides.y[i], guides.z[i])))
        .collect()
}

fn farthest(a: &[Vec3], b: &[Vec3]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// How far the head of a picture is from where the dance has it at the picture's time, metres.
fn head_error(frame: &FrameSnapshot) -> f32 {
    let mut pose = Pose::default();
    let scene = &frame.scene;
    pose_at(&scene.body, scene.clip.as_deref(), scene.clip_secs(frame.time_secs), &mut pose);
    (pose.world_from_head.translation - frame.guides.world_from_head.translation).length()
}

#[test]
fn slow_motion_moves_evenly_from_step_to_step_and_leaves_the_simulation_alone() {
    let project = small_project();
    let scene = load(&project).0;
    let mut twin = Engine::new(Arc::clone(&scene), project.simulation);
    twin.advance_to_step(100);
    let mut driven = Driven::new(&project, &scene);
    driven.after(100.0 * STEP_SECS);
    for _ in 0..96 {
        driven.after(STEP_SECS);
    }
    assert_eq!(driven.hash(), twin.state_hash(), "the control: at full speed each picture is a step");
    let mut last = twin.snapshot();
    driven.turn(slow(0.125), 0.0);
    for step in 100..106 {
        twin.step();
        let next = twin.snapshot();
        let moved = farthest(&of_head(&last), &of_head(&next));
        let mut before = of_head(&last);
        for part in 1..=8_u32 {
            let shown = driven.picture();
            let time_secs = (f64::from(step) + f64::from(part) / 8.0) * STEP_SECS;
            assert!((shown.time_secs - time_secs).abs() < 1e-9, "{} at {time_secs}", shown.time_secs);
            assert!(head_error(&shown) < 1e-3, "the head is {} m off", head_error(&shown));
            let now = of_head(&shown);
            let apart = farthest(&before, &now);
            assert!(
                (apart - moved / 8.0).abs() < 0.05 * moved / 8.0 + 2e-6,
                "{apart} of {moved}, part {part}"
            );
            before = now;
        }
        assert!(moved > 1e-4, "the control: hair moves");
        let off = farthest(&before, &of_head(&next));
        assert!(off < 2e-6, "the last part is the step: {off}");
        last = next;
    }
    // It is one step ahead of what is seen, or at it.
    let ahead = driven.hash();
    let same = ahead == twin.state_hash() || {
        twin.step();
        ahead == twin.state_hash()
    };
    assert!(same, "what is seen changes nothing");
}

#[test]
fn a_quicker_display_gets_pictures_between_steps() {
    let project = small_project();
    let scene = load(&project).0;
    let mut driven = Driven::new(&project, &scene);
    driven.turn(Wishes { display_hz: Some(240.0), ..Wishes::default() }, 0.0);
    let times: Vec<f64> = (0..41).map(|_| driven.picture().time_secs).collect();
    for pair in times.windows(2) {
        assert!((pair[1] - pair[0] - 1.0 / 240.0).abs() < 1e-6, "{pair:?}");
    }
    driven.turn(Wishes { display_hz: Some(60.0), ..Wishes::default() }, 0.0);
    driven.picture();
    for _ in 0..10 {
        let steps = driven.picture().time_secs / STEP_SECS;
        assert!((steps - steps.round()).abs() < 1e-9, "whole steps where the display shows sixty: {steps}");
    }
}

#[test]
fn a_pause_shows_a_whole_step_and_time_goes_on_from_it() {
    let project = small_project();
    let scene = load(&project).0;
    let mut driven = Driven::new(&project, &scene);
    driven.turn(slow(0.1), 0.0);
    let mut moving = driven.picture();
    for _ in 0..13 {
        moving = driven.picture();
    }
    let steps = moving.time_secs / STEP_SECS;
    assert!((steps - 1.4).abs() < 1e-6, "between two steps: {steps}");
    driven.frames.newer_than(&mut driven.seen);
    driven.turn(Wishes { playing: Some(false), ..Wishes::default() }, 0.0);
    let paused = driven.frames.newer_than(&mut driven.seen).expect("a picture");
    let mut twin = Engine::new(Arc::clone(&scene), project.simulation);
    twin.advance_to_step(2);
    assert_eq!((paused.guides.clone(), driven.hash()), (twin.snapshot().guides.clone(), twin.state_hash()));
    assert!(driven.after(1.0).is_none(), "time stands");
    driven.turn(Wishes { steps: 1, ..Wishes::default() }, 0.0);
    twin.step();
    assert_eq!(driven.frames.latest().expect("a picture").guides, twin.snapshot().guides, "one step on");
    driven.turn(Wishes { playing: Some(true), ..Wishes::default() }, 0.0);
    let steps = driven.picture().time_secs / STEP_SECS;
    assert!((steps - 3.1).abs() < 1e-6, "it goes on at once, and not back: {steps}");
}

#[test]
fn nothing_lies_between_an_instant_and_one_that_is_gone_to() {
    let project = small_project();
    let scene = load(&project).0;
    let mut driven = Driven::new(&project, &scene);
    driven.turn(slow(0.25), 0.0);
    for seek_secs in [3.0, 0.5, 6.0] {
        for _ in 0..7 {
            driven.picture();
        }
        driven.turn(Wishes { seek_secs: Some(seek_secs), ..Wishes::default() }, STEP_SECS);
        driven.arrive();
        let mut twin = Engine::new(Arc::clone(&scene), project.simulation);
        twin.seek(seek_secs);
        twin.settle();
        let there = driven.frames.latest().expect("a picture");
        assert_eq!(there.guides, twin.snapshot().guides, "settled hair, as it is");
        for part in 1..=9 {
            let shown = driven.picture();
            let after = shown.time_secs - there.time_secs - f64::from(part) * 0.25 * STEP_SECS;
            assert!(after.abs() < 1e-6, "part {part} is at {}", shown.time_secs);
            assert!(head_error(&shown) < 1e-3, "the head is {} m off", head_error(&shown));
        }
    }
}

#[test]
fn nothing_lies_between_two_styles() {
    let mut project = small_project();
    // The same body and dance each time, so that the hair goes on moving.
    let mut loader = SceneLoader::new();
    let mut load = |project: &Project| loader.load_now(project, &Access::new()).expect("a scene").0;
    let scene = load(&project);
    let mut driven = Driven::new(&project, &scene);
    driven.turn(slow(0.25), 0.0);
    let mut time_secs = 0.0;
    for length in [0.22, 0.3] {
        for _ in 0..6 {
            time_secs = driven.picture().time_secs;
        }
        project.hair.groom.length = length;
        let other = load(&project);
        driven.put(&project, &other);
        let shown = driven.frames.latest().expect("a picture");
        let step = driven.inside.engine.as_mut().expect("an engine").snapshot();
        assert!(Arc::ptr_eq(&shown.scene.style, &other.style), "it is seen at once");
        assert_eq!((shown.time_secs, &shown.guides), (step.time_secs, &step.guides), "a step as it is");
        let on = (shown.time_secs - time_secs) / STEP_SECS;
        assert!((0.0..1.0 + 1e-9).contains(&on), "and time does not go back: {on} steps");
        time_secs = shown.time_secs;
        for _ in 0..6 {
            let next = driven.picture();
            assert!(Arc::ptr_eq(&next.scene.style, &other.style));
            assert!((next.time_secs - time_secs - 0.25 * STEP_SECS).abs() < 1e-6, "{}", next.time_secs);
            time_secs = next.time_secs;
        }
    }
}

#[test]
fn where_the_motion_jumps_the_nearer_step_is_shown() {
    let project = small_project();
    let whole = load(&project).0;
    let clip = whole.clip.as_ref().expect("a clip");
    // Cut in the middle of a move: its end does not lead to its start.
    let cut = 151.0 * STEP_SECS;
    let cut_clip = lovelock_motion::Clip { duration_secs: cut, loops: false, ..(**clip).clone() };
    let scene = Arc::new(Scene { clip: Some(Arc::new(cut_clip)), ..(*whole).clone() });
    let mut twin = Engine::new(Arc::clone(&scene), project.simulation);
    twin.advance_to_step(150);
    let last = twin.snapshot();
    twin.step();
    let first = twin.snapshot();
    let apart = (last.guides.world_from_head.translation - first.guides.world_from_head.translation).length();
    assert!(first.report.jumped && apart > 0.02, "the control: the head jumps by {apart} m");
    let mut driven = Driven::new(&project, &scene);
    for _ in 0..150 {
        driven.after(STEP_SECS);
    }
    driven.turn(slow(0.2), 0.0);
    for part in 1..=5 {
        let shown = driven.picture();
        let nearer = if part <= 2 { &last } else { &first };
        let same = shown.guides.guides == nearer.guides.guides;
        assert!(same && head_error(&shown) < 1e-3, "part {part}");
    }
}
