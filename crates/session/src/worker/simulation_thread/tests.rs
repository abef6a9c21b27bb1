//! Frames shown during playback, without a clock: the tests call the thread's turns with given elapsed times.

use std::sync::Arc;

use glam::Vec3;
use lovelock_motion::{Pose, pose_at};
use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_render::{Backend, GpuRenderer, Picture, ShadowMethod};

use super::super::load_thread::{LoadThread, Loaded};
use super::super::mailbox::{Mailbox, Requests};
use super::super::{Outbox, Shared};
use super::{Scene, SimulationThread};
use crate::clock::STEP_SECS;
use crate::engine::{Engine, kernels_for_tests};
use crate::latest::Latest;
use crate::scene::SceneLoader;
use crate::snapshot::FrameSnapshot;
use crate::testing::load;
use crate::window_device::WindowDevice;

/// As [`crate::testing::small_project`], with the pre-roll of an engine that follows no project.
fn small_project() -> Project {
    let mut project = crate::testing::small_project();
    project.timeline = Project::default().timeline;
    project
}

/// The thread's state and its published frames.
struct Driven {
    inside: SimulationThread,
    frames: Latest<FrameSnapshot>,
    seen: u64,
}

impl Driven {
    /// A scene with settled hair at the first frame, which is shown.
    fn new(project: &Project, scene: &Arc<Scene>) -> Self {
        Self::on(WindowDevice::default(), project, scene)
    }

    /// The same beside the device of a window.
    fn on(window: WindowDevice, project: &Project, scene: &Arc<Scene>) -> Self {
        let (outbox, _) = Outbox::new(Arc::new(|| ()));
        let loader = Arc::new(LoadThread::start(outbox.clone(), |_| ()).expect("a thread"));
        let shared = Shared::new(Mailbox::default(), loader);
        let frames = shared.frames.clone();
        let inside = SimulationThread::new(shared, outbox, window);
        let mut driven = Self { inside, frames, seen: 0 };
        driven.put(project, scene);
        driven
    }

    /// Sets another scene and completes its pre-roll, if there is one.
    fn put(&mut self, project: &Project, scene: &Arc<Scene>) {
        let loaded = Loaded::Scene(Arc::clone(scene), Arc::new(project.clone()));
        self.turn(Requests { loaded: Some(loaded), ..Requests::default() }, 0.0);
        self.arrive();
    }

    fn arrive(&mut self) {
        while self.inside.preroll.is_some() {
            self.turn(Requests::default(), 0.0);
        }
    }

    fn turn(&mut self, requests: Requests, elapsed_secs: f64) {
        self.inside.turn(requests, elapsed_secs);
    }

    /// The frame shown after an elapsed time; `None` if there is no new one.
    fn after(&mut self, elapsed_secs: f64) -> Option<Arc<FrameSnapshot>> {
        self.frames.newer_than(&mut self.seen);
        self.turn(Requests::default(), elapsed_secs);
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
fn hair_does_not_settle_while_newer_hair_is_loading() {
    let mut project = small_project();
    let mut driven = Driven::new(&project, &load(&project).0);
    driven.turn(Requests { playing: Some(false), ..Requests::default() }, 0.0);
    // A loader that blocks while it delivers its result.
    let (outbox, _) = Outbox::new(Arc::new(|| ()));
    let (go_on, gate) = std::sync::mpsc::sync_channel(2);
    let loader =
        Arc::new(LoadThread::start(outbox, move |_| gate.recv().unwrap_or_default()).expect("a thread"));
    driven.inside.shared.loader = Arc::clone(&loader);
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
    driven.turn(Requests { loaded: Some(other), ..Requests::default() }, 0.0);
    let told =
        |driven: &Driven| driven.inside.shared.settling.lock().expect("no panic").map(|told| told.done);
    for _ in 0..5 {
        assert!(
            driven.inside.preroll.is_none() && told(&driven) == Some(0),
            "settling waits, and is reported"
        );
        driven.turn(Requests::default(), 0.1);
    }
    for _ in 0..2 {
        go_on.send(()).expect("a thread");
    }
    rest();
    driven.turn(Requests::default(), 0.0);
    assert!(driven.inside.preroll.is_some(), "it settles");
    driven.arrive();
    assert_eq!(told(&driven), None);
}

fn slow(rate: f64) -> Requests {
    Requests { rate: Some(rate), ..Requests::default() }
}

/// Points of the guides in head space.
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

/// Distance of the head in a frame from its position in the motion at that time, metres.
fn head_error(frame: &FrameSnapshot) -> f32 {
    let mut pose = Pose::default();
    let scene = &frame.scene;
    pose_at(&scene.body, scene.clip.as_deref(), scene.clip_secs(frame.time_secs), &mut pose);
    (pose.world_from_head.translation - frame.guides.world_from_head.translation).length()
}

#[test]
fn slow_motion_is_even_and_does_not_change_the_simulation() {
    let project = small_project();
    let scene = load(&project).0;
    let mut twin = Engine::new(Arc::clone(&scene), project.simulation);
    twin.advance_to_step(100);
    let mut driven = Driven::new(&project, &scene);
    driven.after(100.0 * STEP_SECS);
    for _ in 0..96 {
        driven.after(STEP_SECS);
    }
    assert_eq!(driven.hash(), twin.state_hash(), "control: at full speed each image is a step");
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
        assert!(off < 2e-6, "the last fraction is the step itself: {off}");
        last = next;
    }
    // The simulation is at most one step ahead of the shown frame.
    let ahead = driven.hash();
    let same = ahead == twin.state_hash() || {
        twin.step();
        ahead == twin.state_hash()
    };
    assert!(same, "showing frames does not change the simulation");
}

#[test]
fn a_faster_display_gets_images_between_steps() {
    let project = small_project();
    let scene = load(&project).0;
    let mut driven = Driven::new(&project, &scene);
    driven.turn(Requests { display_hz: Some(240.0), ..Requests::default() }, 0.0);
    let times: Vec<f64> = (0..41).map(|_| driven.picture().time_secs).collect();
    for pair in times.windows(2) {
        assert!((pair[1] - pair[0] - 1.0 / 240.0).abs() < 1e-6, "{pair:?}");
    }
    driven.turn(Requests { display_hz: Some(60.0), ..Requests::default() }, 0.0);
    driven.picture();
    for _ in 0..10 {
        let steps = driven.picture().time_secs / STEP_SECS;
        assert!((steps - steps.round()).abs() < 1e-9, "whole steps at 60 Hz: {steps}");
    }
}

#[test]
fn a_pause_shows_a_whole_step_and_playback_continues_from_it() {
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
    driven.turn(Requests { playing: Some(false), ..Requests::default() }, 0.0);
    let paused = driven.frames.newer_than(&mut driven.seen).expect("a picture");
    let mut twin = Engine::new(Arc::clone(&scene), project.simulation);
    twin.advance_to_step(2);
    assert_eq!((paused.guides.clone(), driven.hash()), (twin.snapshot().guides.clone(), twin.state_hash()));
    assert!(driven.after(1.0).is_none(), "time stands");
    driven.turn(Requests { steps: 1, ..Requests::default() }, 0.0);
    twin.step();
    assert_eq!(driven.frames.latest().expect("a picture").guides, twin.snapshot().guides, "one step on");
    driven.turn(Requests { playing: Some(true), ..Requests::default() }, 0.0);
    let steps = driven.picture().time_secs / STEP_SECS;
    assert!((steps - 3.1).abs() < 1e-6, "it continues at once and does not go back: {steps}");
}

#[test]
fn frames_are_not_interpolated_across_a_seek() {
    let project = small_project();
    let scene = load(&project).0;
    let mut driven = Driven::new(&project, &scene);
    driven.turn(slow(0.25), 0.0);
    for seek_secs in [3.0, 0.5, 6.0] {
        for _ in 0..7 {
            driven.picture();
        }
        driven.turn(Requests { seek_secs: Some(seek_secs), ..Requests::default() }, STEP_SECS);
        driven.arrive();
        let mut twin = Engine::new(Arc::clone(&scene), project.simulation);
        twin.seek(seek_secs);
        twin.settle();
        let there = driven.frames.latest().expect("a picture");
        assert_eq!(there.guides, twin.snapshot().guides, "settled hair, not interpolated");
        for part in 1..=9 {
            let shown = driven.picture();
            let after = shown.time_secs - there.time_secs - f64::from(part) * 0.25 * STEP_SECS;
            assert!(after.abs() < 1e-6, "part {part} is at {}", shown.time_secs);
            assert!(head_error(&shown) < 1e-3, "the head is {} m off", head_error(&shown));
        }
    }
}

#[test]
fn frames_are_not_interpolated_between_styles() {
    let mut project = small_project();
    // The same body and motion each time, so that the hair keeps moving.
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
        assert!(Arc::ptr_eq(&shown.scene.style, &other.style), "it is shown at once");
        assert_eq!((shown.time_secs, &shown.guides), (step.time_secs, &step.guides), "a whole step");
        let on = (shown.time_secs - time_secs) / STEP_SECS;
        assert!((0.0..1.0 + 1e-9).contains(&on), "and time does not run back: {on} steps");
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
fn the_nearer_step_is_shown_across_a_jump() {
    let project = small_project();
    let whole = load(&project).0;
    let clip = whole.clip.as_ref().expect("a clip");
    // Trim in the middle of a move, so that the end does not lead to the start.
    let cut = 151.0 * STEP_SECS;
    let cut_clip = lovelock_motion::Clip { duration_secs: cut, loops: false, ..(**clip).clone() };
    let scene = Arc::new(Scene { clip: Some(Arc::new(cut_clip)), ..(*whole).clone() });
    let mut twin = Engine::new(Arc::clone(&scene), project.simulation);
    twin.advance_to_step(150);
    let last = twin.snapshot();
    twin.step();
    let first = twin.snapshot();
    let apart = (last.guides.world_from_head.translation - first.guides.world_from_head.translation).length();
    assert!(first.report.jumped && apart > 0.02, "control: the head jumps by {apart} m");
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

#[test]
fn the_simulation_waits_while_a_take_is_opened() {
    let project = small_project();
    let (scene, _) = load(&project);
    let mut driven = Driven::new(&project, &scene);
    driven.inside.playback.set_playing(true);
    let mut takes = project.clone();
    takes.take.file = Some(lovelock_project::files::FileRef::new("/a/take.take"));
    let takes = Arc::new(takes);
    driven.inside.shared.loader = Arc::new(LoadThread::that_never_ends(Arc::clone(&takes)));
    driven.inside.project = Some(takes);
    let before = driven.hash();
    for _ in 0..5 {
        driven.turn(Requests::default(), 2.0 * STEP_SECS);
    }
    assert_eq!(driven.hash(), before);
    // Control: the same turns move hair that waits for nothing.
    driven.inside.project = Some(Arc::new(project));
    for _ in 0..5 {
        driven.turn(Requests::default(), 2.0 * STEP_SECS);
    }
    assert_ne!(driven.hash(), before);
}

/// The image of a frame by a renderer on the device of the window, with its guides from there or from memory.
fn drawn(renderer: &mut GpuRenderer, frame: &FrameSnapshot, project: &Project, from_device: bool) -> Vec<u8> {
    let mut frame = frame.clone();
    frame.resident = frame.resident.filter(|_| from_device);
    let (camera, mut picture) = (frame.camera(&project.camera), Picture::default());
    let input = frame.measured_input(project, &camera);
    renderer.picture(&input, 96, 96, &mut picture).expect("a picture");
    picture.rgba
}

/// The share of bytes that differ by more than one step.
fn share_apart(a: &[u8], b: &[u8]) -> f64 {
    let apart = a.iter().zip(b).filter(|(a, b)| a.abs_diff(**b) > 1).count();
    apart as f64 / a.len() as f64
}

#[test]
fn hair_that_the_device_of_the_window_simulates_is_drawn_from_there() {
    let Some(kernels) = kernels_for_tests() else { return };
    let gpu = kernels.gpu();
    let mut project = small_project();
    project.picture.simulate = Backend::Gpu;
    project.shadow.method = ShadowMethod::None;
    let scene = load(&project).0;
    let mut twin = Engine::new(Arc::clone(&scene), project.simulation);
    twin.follow(&project);
    let mut driven = Driven::on(WindowDevice::simulating(Arc::clone(gpu)), &project, &scene);
    driven.turn(
        Requests { project: Some((Arc::new(project.clone()), Access::new())), ..Requests::default() },
        0.0,
    );
    let same = |frame: &FrameSnapshot, twin: &mut Engine| {
        while twin.time_secs() + 1e-9 < frame.time_secs {
            twin.step();
        }
        assert_eq!(frame.guides, twin.snapshot().guides, "at {} s", frame.time_secs);
        assert!(frame.on_device && frame.resident.is_some(), "at {} s", frame.time_secs);
    };
    driven.picture();
    let early = driven.picture();
    same(&early, &mut twin);
    for _ in 0..20 {
        same(&driven.picture(), &mut twin);
    }
    assert!(twin.time_secs() > 20.5 * STEP_SECS, "images are a step behind at most");
    assert!(twin.snapshot().resident.is_none(), "control: a device beside that of the window");
    // Between steps, the device mixes them as the CPU does.
    driven.turn(slow(0.4), 0.0);
    // The first images stand until there are two steps.
    let shown: Vec<_> = (0..9).map(|_| driven.picture()).skip(3).collect();
    let are_even = |shown: &[Arc<FrameSnapshot>], steps: f64| {
        for pair in shown.windows(2) {
            let apart = (pair[1].time_secs - pair[0].time_secs) / STEP_SECS;
            assert!((apart - steps).abs() < 1e-4, "{apart} steps in place of {steps}");
        }
    };
    are_even(&shown, 0.4);
    // More than one step from image to image.
    driven.turn(slow(1.5), 0.0);
    let quick: Vec<_> = (0..9).map(|_| driven.picture()).skip(3).collect();
    are_even(&quick, 1.5);
    let mut renderer = GpuRenderer::new(gpu).expect("a renderer");
    let frame = &shown[4];
    let [there, here] = [true, false].map(|from_device| drawn(&mut renderer, frame, &project, from_device));
    let mut other = FrameSnapshot::clone(frame);
    other.resident.clone_from(&early.resident);
    let control = share_apart(&drawn(&mut renderer, &other, &project, true), &here);
    let apart = share_apart(&there, &here);
    println!("{apart} of the bytes differ, {control} with the guides of another instant");
    // Measured: none, and 0.0007 after half of the time.
    assert!(apart < 1e-4 && control > 5e-4, "{apart}, {control}");
    // A pause shows the step that was begun.
    driven.turn(Requests { playing: Some(false), rate: Some(1.0), ..Requests::default() }, 0.0);
    same(&driven.frames.latest().expect("a picture"), &mut twin);
    assert_eq!(driven.hash(), twin.state_hash());
    // A change of the host goes on from the whole state.
    project.picture.simulate = Backend::Cpu;
    twin.follow(&project);
    driven.turn(
        Requests {
            project: Some((Arc::new(project.clone()), Access::new())),
            steps: 1,
            ..Requests::default()
        },
        0.0,
    );
    twin.step();
    let frame = driven.frames.latest().expect("a picture");
    assert!(!frame.on_device && frame.resident.is_none());
    assert_eq!(frame.guides, twin.snapshot().guides);
}
