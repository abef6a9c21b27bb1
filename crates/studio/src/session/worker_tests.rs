//! The simulation thread, driven as the window drives it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use super::tests::small_project;
use super::*;
use crate::Access;

/// Long enough for the slowest machine; a test that passes waits for a fraction of it.
const PATIENCE_MS: f64 = 60_000.0;

fn start(project: crate::Project) -> (Worker, Arc<AtomicU64>) {
    let woken = Arc::new(AtomicU64::new(0));
    let count = Arc::clone(&woken);
    let wake: Wake = Arc::new(move || {
        count.fetch_add(1, Ordering::Relaxed);
    });
    (Worker::start(Arc::new(project), Access::new(), wake).expect("threads"), woken)
}

fn wait<T>(what: &str, mut ready: impl FnMut() -> Option<T>) -> T {
    let watch = crate::Stopwatch::start();
    while watch.ms() < PATIENCE_MS {
        if let Some(value) = ready() {
            return value;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    panic!("waited in vain for {what}");
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
    assert_eq!(worker.frame().expect("a frame").time_secs, frame.time_secs, "it is paused");
    worker.step(-2);
    wait("two steps back", || worker.frame().filter(|now| now.time_secs < frame.time_secs));
    worker.restart();
    wait("the first frame", || worker.frame().filter(|frame| frame.time_secs == 0.0));
    assert!(matches!(worker.poll_event(), Some(Event::Loaded { problems, .. }) if problems.is_empty()));
}

#[test]
fn other_hair_is_loaded_aside_and_lights_load_nothing() {
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
fn a_motion_that_ends_says_so_and_plays_again() {
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
fn a_panic_becomes_an_event_and_the_thread_lives() {
    let (worker, _) = start(small_project());
    let good = wait("a frame", || worker.frame());
    // A hairstyle with half of its numbers missing, which no loader lets through.
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
