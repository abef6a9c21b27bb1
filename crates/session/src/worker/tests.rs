//! The simulation thread, used as the window uses it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use lovelock_brush::{BrushSettings, Tool};
use lovelock_project::files::Access;
use lovelock_style::hand::HandEdits;
use lovelock_style::operations::Hand;
use lovelock_style::{Layer, Operation};
use lovelock_testkit::wait::wait_for as wait;

use super::*;
use crate::scene::SceneLoader;
use crate::testing::{settled, small_project};

fn start(project: lovelock_project::Project) -> (Worker, Arc<AtomicU64>) {
    let woken = Arc::new(AtomicU64::new(0));
    let count = Arc::clone(&woken);
    let wake: Wake = Arc::new(move || {
        count.fetch_add(1, Ordering::Relaxed);
    });
    (Worker::start(Arc::new(project), Access::new(), &WindowDevice::default(), wake).expect("threads"), woken)
}

#[test]
fn it_plays_pauses_steps_and_seeks() {
    let (worker, woken) = start(small_project());
    let first = wait("a frame", || worker.frame());
    wait("time to pass", || worker.frame().filter(|frame| frame.step > first.step + 2));
    assert!(woken.load(Ordering::Relaxed) > 2);
    worker.set_playing(false);
    worker.seek(3.0);
    wait("the seek", || worker.frame().filter(|frame| (frame.time_secs - 3.0).abs() < 0.02));
    worker.step(3);
    let frame = wait("three steps", || worker.frame().filter(|frame| frame.time_secs > 3.04));
    std::thread::sleep(Duration::from_millis(60));
    assert_eq!(worker.frame().expect("a frame").time_secs, frame.time_secs, "playback is paused");
    worker.step(-2);
    wait("two steps back", || worker.frame().filter(|now| now.time_secs < frame.time_secs));
    worker.restart();
    wait("the first frame", || worker.frame().filter(|frame| frame.time_secs == 0.0));
    assert!(matches!(worker.poll_event(), Some(Event::Loaded { problems, .. }) if problems.is_empty()));
}

#[test]
fn other_hair_is_loaded_in_the_background_and_lights_load_nothing() {
    let mut project = small_project();
    let (worker, _) = start(project.clone());
    wait("the first scene", || worker.poll_event());
    project.lights.clear();
    project.camera.distance = 1.0;
    worker.set_project(Arc::new(project.clone()), Access::new());
    project.hair.groom.wisps = 20;
    worker.set_project(Arc::new(project), Access::new());
    let style = wait("the other hair", || match worker.poll_event() {
        Some(Event::Loaded { scene, .. }) => Some(Arc::clone(&scene.style)),
        _ => None,
    });
    wait("it to dance", || worker.frame().filter(|frame| Arc::ptr_eq(&frame.scene.style, &style)));
    assert!(worker.poll_event().is_none(), "one load for one change of hair");
    assert_eq!(worker.load_progress(), None);
}

#[test]
fn the_end_of_a_motion_is_reported_and_it_plays_again() {
    let mut project = small_project();
    project.motion.looping = false;
    let (worker, _) = start(project);
    let frame = wait("a frame", || worker.frame());
    worker.seek(frame.scene.duration_secs() - 0.05);
    wait("the end", || worker.poll_event().filter(|event| matches!(event, Event::EndReached)));
    worker.set_playing(true);
    wait("the start", || worker.frame().filter(|frame| frame.position_secs < 1.0));
}

#[test]
fn a_panic_becomes_an_event_and_the_thread_continues() {
    let (worker, _) = start(small_project());
    let good = wait("a frame", || worker.frame());
    // A hairstyle with half of its numbers missing, which the loader would reject.
    let mut style = (*good.scene.style).clone();
    style.guides.y.truncate(style.guides.y.len() / 2);
    let bad = Arc::new(Scene { style: Arc::new(style), ..(*good.scene).clone() });
    worker.put_scene(bad);
    wait("the panic", || {
        worker.poll_event().filter(|event| matches!(event, Event::Panicked { thread: "simulation", .. }))
    });
    worker.put_scene(Arc::clone(&good.scene));
    let step = worker.frame().expect("the last frame stays").step;
    worker.seek(1.0);
    wait("frames again", || worker.frame().filter(|frame| frame.step != step || frame.time_secs >= 1.0));
}

/// Waits until the hair is settled at a time, and returns that frame.
fn settled_at(worker: &Worker, secs: f64) -> Arc<FrameSnapshot> {
    wait("settled hair", || {
        let there = worker.frame().filter(|frame| (frame.time_secs - secs).abs() < 1e-6);
        // The end of settling is published after its frame.
        there.filter(|_| worker.settling().is_none()).and(worker.frame())
    })
}

/// Waits until the hair is settled at a time, and compares it with an engine that settles there.
fn sees_settled_hair(worker: &Worker, project: &lovelock_project::Project, secs: f64) {
    let shown = settled_at(worker, secs);
    let mut engine = settled(Arc::clone(&shown.scene), project);
    engine.seek(secs);
    engine.settle();
    assert_eq!(engine.snapshot().guides, shown.guides);
}

#[test]
fn hair_is_settled_where_scrubbing_ends() {
    let (worker, _) = start(small_project());
    let first = wait("a frame", || worker.frame());
    worker.set_playing(false);
    let end = 250.0 * crate::clock::STEP_SECS;
    for step in 0..60 {
        worker.seek(end - f64::from(60 - step) * crate::clock::STEP_SECS);
        std::thread::sleep(Duration::from_millis(1));
    }
    worker.seek(end);
    let shown = settled_at(&worker, end);
    let mut engine = settled(Arc::clone(&first.scene), &small_project());
    engine.seek(end);
    assert_ne!(engine.snapshot().guides, shown.guides, "control: hair that was only moved rigidly");
    engine.settle();
    assert_eq!(engine.snapshot().guides, shown.guides);
    worker.step(-2);
    engine.step_back(2);
    engine.settle();
    assert_eq!(engine.snapshot().guides, settled_at(&worker, 248.0 * crate::clock::STEP_SECS).guides);
}

#[test]
fn hair_loaded_while_paused_is_settled() {
    let mut project = small_project();
    let (worker, _) = start(project.clone());
    wait("a frame", || worker.frame());
    worker.set_playing(false);
    let secs = 100.0 * crate::clock::STEP_SECS;
    worker.seek(secs);
    let before = settled_at(&worker, secs);
    project.hair.groom.wisps = 20;
    worker.set_project(Arc::new(project.clone()), Access::new());
    wait("the other hair", || worker.frame().filter(|frame| !Arc::ptr_eq(&frame.scene, &before.scene)));
    sees_settled_hair(&worker, &project, secs);
}

#[test]
fn settings_changed_while_paused_settle_the_hair_again() {
    let mut project = small_project();
    let (worker, _) = start(project.clone());
    wait("a frame", || worker.frame());
    worker.set_playing(false);
    let secs = 100.0 * crate::clock::STEP_SECS;
    worker.seek(secs);
    let before = settled_at(&worker, secs);
    // As if dragged: several changes in a row.
    for gravity in [5.0, 4.0, 3.0, 2.0] {
        project.simulation.gravity = gravity;
        project.simulation.style_support = 0.0;
        worker.set_project(Arc::new(project.clone()), Access::new());
        std::thread::sleep(Duration::from_millis(3));
    }
    let mut engine = settled(Arc::clone(&before.scene), &project);
    engine.seek(secs);
    engine.settle();
    let wanted = engine.snapshot();
    assert_ne!(wanted.guides, before.guides, "the control: other settings, other hair");
    wait("hair by the last settings", || worker.frame().filter(|frame| frame.guides == wanted.guides));
    assert!((wanted.time_secs - secs).abs() < 1e-6, "time stands");
}

#[test]
fn settling_can_be_cancelled_and_playback_continues() {
    let mut project = small_project();
    // Long enough to be observed in progress.
    project.timeline.preroll_secs = 30.0;
    project.hair.groom.wisps = 200;
    let (worker, _) = start(project);
    let progress = wait("progress of a pre-roll", || worker.settling());
    assert!(progress.done < progress.total && progress.total >= 1800, "{progress:?}");
    assert_eq!(wait("hair at rest meanwhile", || worker.frame()).step, 0);
    worker.cancel_settle();
    wait("time to pass", || worker.frame().filter(|frame| frame.step > 2));
    assert_eq!(worker.settling(), None);
}

#[test]
fn looking_back_shows_settled_hair_and_keeps_the_totals() {
    let (worker, _) = start(small_project());
    let measured = |secs: f64| {
        wait("a worst stretch", || {
            worker
                .frame()
                .filter(|frame| frame.time_secs > secs && frame.totals.worst_stretch_found.is_some())
        })
    };
    measured(0.3);
    worker.set_playing(false);
    // The pause is certain once the thread has answered a request that came after it.
    let paused = 7.0 * crate::clock::STEP_SECS;
    worker.look_back(paused);
    let frame = settled_at(&worker, paused);
    let found = frame.totals.worst_stretch_found.expect("found");
    let secs = found.at_secs.expect("the dance has a timeline");
    assert!(found.place.is_finite(), "{found:?}");
    worker.look_back(secs);
    let back = settled_at(&worker, secs);
    assert_eq!(back.totals.worst_stretch_found, Some(found));
    assert_eq!(back.totals.max_stretch, frame.totals.max_stretch);
    // An ordinary seek resets the totals.
    worker.seek(secs);
    wait("counting anew", || worker.frame().filter(|frame| frame.totals.steps == 0));
}

#[test]
fn a_replaced_load_is_not_reported_as_cancelled() {
    let mut project = small_project();
    let (worker, _) = start(project.clone());
    wait("the first scene", || worker.poll_event());
    for wisps in 20..60 {
        project.hair.groom.wisps = wisps;
        // Grown hair reads no file, but the files differ, so the previous load is cancelled.
        project.hair.file = Some(lovelock_project::files::FileRef::new(format!("/{wisps}.hair")));
        worker.set_project(Arc::new(project.clone()), Access::new());
        std::thread::sleep(Duration::from_millis(3));
    }
    let mut told = Vec::new();
    wait("the last hair", || {
        told.extend(worker.poll_event());
        worker.frame().filter(|frame| frame.scene.style.wisps.len() == 59)
    });
    told.extend(std::iter::from_fn(|| worker.poll_event()));
    assert!(told.iter().all(|event| matches!(event, Event::Loaded { .. })), "{told:?}");
}

#[test]
fn a_cancelled_load_keeps_the_scene_and_the_next_one_loads() {
    let mut project = small_project();
    let (worker, _) = start(project.clone());
    let before = wait("a frame", || worker.frame());
    wait("the first scene", || worker.poll_event());
    project.hair.groom.strands_per_wisp = 200;
    // On a busy machine the load may be done first; then another one is cancelled.
    wait("a load that was given up", || {
        project.hair.groom.wisps = if project.hair.groom.wisps == 400 { 300 } else { 400 };
        worker.set_project(Arc::new(project.clone()), Access::new());
        wait("a load", || worker.load_progress().map(drop).or_else(|| worker.poll_event().map(drop)));
        worker.cancel_load();
        assert_eq!(worker.load_progress(), None, "the progress is cleared at once");
        let event = wait("the result", || worker.poll_event());
        matches!(event, Event::LoadCancelled).then_some(())
    });
    assert!(worker.frame().is_some_and(|frame| frame.step >= before.step), "the scene plays on");
    project.hair.groom.wisps = 20;
    worker.set_project(Arc::new(project), Access::new());
    wait("the next hair", || worker.frame().filter(|frame| frame.scene.style.wisps.len() == 20));
}

#[test]
fn hair_dragged_while_paused_settles_after_release() {
    let mut project = lovelock_project::Project::default();
    project.timeline.preroll_secs = 0.25;
    let (worker, _) = start(project.clone());
    wait("a frame", || worker.frame());
    worker.set_playing(false);
    let secs = 100.0 * crate::clock::STEP_SECS;
    worker.seek(secs);
    settled_at(&worker, secs);
    while worker.poll_event().is_some() {}
    let mut loads = 0;
    wait("hair while it is dragged", || {
        project.hair.groom.length += 1e-5;
        worker.set_project(Arc::new(project.clone()), Access::new());
        loads += u32::from(worker.poll_event().is_some_and(|event| matches!(event, Event::Loaded { .. })));
        (loads == 2).then_some(())
    });
    let (last, _) = SceneLoader::new().load_now(&project, &Access::new()).expect("a scene");
    let is_last = |frame: &FrameSnapshot| frame.scene.style.guides == last.style.guides;
    wait("the last hair", || worker.frame().filter(|frame| is_last(frame)));
    sees_settled_hair(&worker, &project, secs);
}

#[test]
fn a_dragged_slider_shows_intermediate_hair() {
    // Growing takes much longer than the time between two requests.
    let mut project = lovelock_project::Project::default();
    let (worker, _) = start(project.clone());
    wait("the first scene", || worker.poll_event());
    let mut lengths = Vec::new();
    wait("hair while it is dragged", || {
        project.hair.groom.length += 1e-5;
        worker.set_project(Arc::new(project.clone()), Access::new());
        if let Some(Event::Loaded { scene, .. }) = worker.poll_event() {
            let guides = &scene.style.guides;
            let first = |guide: usize| f64::from(guides.point(guide, 1).distance(guides.point(guide, 0)));
            lengths.push((0..guides.count()).map(first).sum::<f64>());
        }
        (lengths.len() == 3).then_some(())
    });
    assert!(lengths.is_sorted() && lengths[0] < lengths[2], "each is newer than the one before: {lengths:?}");
}

/// The next report of a brush.
fn brushed(worker: &Worker) -> StrokeReport {
    wait("a brush", || match worker.poll_event() {
        Some(Event::Brushed(brushed)) => Some(brushed),
        _ => None,
    })
}

/// A worker that is paused at the start.
fn paused(project: &lovelock_project::Project) -> Worker {
    let (worker, _) = start(project.clone());
    wait("a frame", || worker.frame());
    worker.set_playing(false);
    worker.seek(0.0);
    worker
}

/// A stroke of the comb in a layer.
fn combing(layer: u32, id: u64, after: Option<u64>) -> StrokeStart {
    let settings = BrushSettings { radius: 0.08, front_only: false, ..BrushSettings::default() };
    StrokeStart { id, layer, tool: Tool::Comb, inverted: false, settings, edits: HandEdits::default(), after }
}

/// A sample of a stroke forward from the tip of the first guide of a frame.
fn comb_sample(frame: &FrameSnapshot, i: u8) -> StrokeSample {
    let guides = &frame.scene.style.guides;
    StrokeSample {
        position: guides.point(0, guides.points_per_guide - 1) + glam::Vec3::Z * 0.01 * f32::from(i),
        view: glam::Vec3::NEG_Z,
        drag: glam::Vec3::Z * 0.01 * f32::from(i.min(1)),
        pressure: 1.0,
        time_secs: 0.0,
    }
}

#[test]
fn strokes_wait_for_their_layer_and_report_what_they_do() {
    let mut project = small_project();
    let worker = paused(&project);
    let frame = settled_at(&worker, 0.0);
    let layer = project.hair.stack.push(Layer::of(Hand::default())).expect("room");
    let begin = |id, after| combing(layer, id, after);
    let sample = |i: u8| comb_sample(&frame, i);
    worker.begin_stroke(begin(1, None));
    worker.stroke_to(1, (0..6).map(sample).collect());
    worker.end_stroke(1);
    // The layer comes after the stroke.
    worker.set_project(Arc::new(project.clone()), Access::new());
    let first = wait("its end", || Some(brushed(&worker)).filter(|brushed| brushed.ended));
    assert!(!first.edits.is_empty() && first.stroke == 1);
    // The next goes on from there, although the project does not have it yet.
    worker.begin_stroke(begin(2, Some(1)));
    worker.stroke_to(2, (0..6).map(sample).collect());
    worker.end_stroke(2);
    let second = wait("its end", || Some(brushed(&worker)).filter(|brushed| brushed.ended));
    assert!(second.edits != first.edits && second.edits.count() >= first.edits.count());
    // Paused hair that was brushed stays as it was left.
    // The frame of its last dab comes a moment after the report.
    let (mut last, mut looks) = (worker.frame(), 0);
    let left = wait("a frame that stays", || {
        std::thread::sleep(Duration::from_millis(50));
        let before = std::mem::replace(&mut last, worker.frame())?;
        looks = if last.as_ref().is_some_and(|now| Arc::ptr_eq(now, &before)) { looks + 1 } else { 0 };
        last.clone().filter(|_| looks == 8)
    });
    project.hair.stack.layers[0].operation = Operation::Hand(Hand { edits: second.edits.clone() });
    worker.set_project(Arc::new(project), Access::new());
    let now = wait("the layer's hair", || {
        worker.frame().filter(|frame| match &frame.scene.source.stack.layers[..] {
            [layer] => matches!(&layer.operation, Operation::Hand(hand) if hand.edits == second.edits),
            _ => false,
        })
    });
    assert!(crate::testing::farthest(&left, &now) < 1e-4);
    assert_eq!(worker.settling(), None);
    // Without physics, the hair is that of the layer.
    worker.set_still(true);
    wait("the hair at rest", || worker.frame().filter(|frame| !Arc::ptr_eq(frame, &now)));
    let style = &now.scene.style;
    let rest = worker.frame().expect("a frame");
    let guide = (0..style.guides.count()).map(|guide| {
        let last = style.guides.points_per_guide - 1;
        let wanted = rest.guides.world_from_head.transform_point3(style.guides.point(guide, last));
        wanted.distance(rest.guides.guides.point(guide, last))
    });
    assert!(guide.fold(0.0, f32::max) < 1e-3);
    // A stroke in a layer that never comes ends without a change, and so does one that is cancelled.
    let nowhere = StrokeStart { layer: 77, ..begin(3, Some(2)) };
    worker.begin_stroke(nowhere);
    worker.stroke_to(3, (0..6).map(sample).collect());
    worker.end_stroke(3);
    worker.begin_stroke(begin(4, Some(3)));
    worker.end_stroke(4);
    let lost = wait("its end", || Some(brushed(&worker)).filter(|brushed| brushed.ended));
    assert!(lost.stroke == 3 && lost.edits.is_empty());
    let fourth = wait("its end", || Some(brushed(&worker)).filter(|brushed| brushed.ended));
    assert!(fourth.stroke == 4 && fourth.edits.is_empty(), "what another layer got is not taken over");
}

#[test]
fn hair_of_strokes_that_are_undone_settles_again() {
    let plain = small_project();
    let worker = paused(&plain);
    let frame = settled_at(&worker, 0.0);
    let mut project = plain.clone();
    let layer = project.hair.stack.push(Layer::of(Hand::default())).expect("room");
    // One that moves hair, and one beside it.
    let beside = |i: u8| {
        let mut sample = comb_sample(&frame, i);
        sample.position += glam::Vec3::Y;
        sample
    };
    let with = |edits: &HandEdits| {
        let mut project = project.clone();
        project.hair.stack.layers[0].operation = Operation::Hand(Hand { edits: edits.clone() });
        Arc::new(project)
    };
    let shows = |edits: &HandEdits| {
        wait("their hair", || {
            worker.frame().filter(|frame| frame.scene.source.stack.hand(layer) == Some(edits))
        })
    };
    worker.set_project(Arc::new(project.clone()), Access::new());
    worker.begin_stroke(combing(layer, 1, None));
    worker.stroke_to(1, (0..6).map(|i| comb_sample(&frame, i)).collect());
    worker.end_stroke(1);
    let first = wait("its end", || Some(brushed(&worker)).filter(|brushed| brushed.ended));
    assert!(!first.edits.is_empty());
    worker.set_project(with(&first.edits), Access::new());
    let combed = shows(&first.edits);
    worker.begin_stroke(combing(layer, 2, Some(1)));
    worker.stroke_to(2, (0..6).map(beside).collect());
    worker.end_stroke(2);
    let second = wait("its end", || Some(brushed(&worker)).filter(|brushed| brushed.ended));
    assert!(second.stroke == 2 && second.edits == first.edits, "it is beside the hair");
    // Both are undone.
    for undone in [Arc::new(project.clone()), Arc::new(plain.clone())] {
        worker.set_project(Arc::clone(&undone), Access::new());
        wait("the hair without them", || {
            let now = worker.frame().filter(|frame| frame.scene.source.stack == undone.hair.stack)?;
            (crate::testing::farthest(&frame, &now) < 1e-4).then_some(())
        });
    }
    assert!(crate::testing::farthest(&frame, &combed) > 1e-3, "control: the stroke has moved hair");
}
