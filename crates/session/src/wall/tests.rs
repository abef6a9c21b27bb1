use lovelock_project::variants::{Locks, vary};
use lovelock_render::{Backend, Picture};
use lovelock_testkit::wait::{wait_for, wait_until};

use super::thread::Instant;
use super::*;

fn small() -> Project {
    let mut project = Project::default();
    project.picture.backend = Backend::Cpu;
    project.hair.groom.wisps = 24;
    project.hair.groom.strands_per_wisp = 6;
    project
}

fn request(project: &Arc<Project>, variants: &[Arc<Project>], time_secs: f64) -> WallRequest {
    WallRequest {
        project: Arc::clone(project),
        variants: variants.to_vec(),
        access: Access::new(),
        time_secs,
        playing: true,
        size: [48, 40],
    }
}

/// The images of all variants after the next round.
fn drawn(wall: &Wall, request: WallRequest) -> Vec<Picture> {
    let (cells, mut seen) = (request.variants.len(), wall.rounds().number());
    wall.request(request);
    wait_for("the wall", || wall.rounds().newer_than(&mut seen));
    let picture = |cell: &Latest<WallCell>| {
        let cell = cell.latest().expect("a cell");
        assert_eq!(cell.problem, None);
        match &cell.image {
            Image::Memory(picture) => (**picture).clone(),
            Image::Device(_) => panic!("an image of the processor is in memory"),
        }
    };
    wall.cells.iter().take(cells).map(picture).collect()
}

fn hair_pixels(a: &Picture, b: &Picture) -> usize {
    a.rgba.chunks(4).zip(b.rgba.chunks(4)).filter(|(a, b)| a != b).count()
}

#[test]
fn each_cell_shows_its_own_variant_and_moves() {
    let project = Arc::new(small());
    let variants: Vec<_> = [0, 1, 2]
        .map(|seed| {
            if seed == 0 {
                Arc::clone(&project)
            } else {
                Arc::new(vary(&project, seed, 1.0, &Locks::default()))
            }
        })
        .to_vec();
    let wall = Wall::start(WindowDevice::default(), || {}).expect("a thread");
    let first = drawn(&wall, request(&project, &variants, 0.0));
    assert_eq!(first.len(), 3);
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        assert!(hair_pixels(&first[a], &first[b]) > 60, "cells {a} and {b} show the same");
    }
    let later = drawn(&wall, request(&project, &variants, 0.4));
    assert!(hair_pixels(&first[0], &later[0]) > 60, "time passes");
    // The same variant twice gives the same image: what differs above is the hair.
    let wall = Wall::start(WindowDevice::default(), || {}).expect("a thread");
    let twice = drawn(&wall, request(&project, &[Arc::clone(&project), Arc::clone(&project)], 0.4));
    assert_eq!(hair_pixels(&twice[0], &twice[1]), 0);
}

#[test]
fn an_unreadable_hairstyle_is_a_sentence_in_its_cell() {
    let project = Arc::new(small());
    let mut broken = small();
    broken.set_hair_file("/nowhere/at all.hair");
    let variants = [Arc::clone(&project), Arc::new(broken)];
    let wall = Wall::start(WindowDevice::default(), || {}).expect("a thread");
    let pictures = drawn(&wall, request(&project, &variants, 0.0));
    assert_eq!(pictures.len(), 2, "the grown hair stands in for it, as in the window");
}

#[test]
fn a_far_time_a_huge_one_and_no_variants_are_no_panic() {
    let project = Arc::new(small());
    let wall = Wall::start(WindowDevice::default(), || {}).expect("a thread");
    for time_secs in [0.0, 5.0, 1e6, -3.0] {
        drawn(&wall, request(&project, &[Arc::clone(&project)], time_secs));
    }
    assert!(drawn(&wall, request(&project, &[], 0.0)).is_empty());
}

#[test]
fn slow_rounds_dance_slowly_and_jumps_are_followed() {
    let project = Arc::new(small());
    let at = |secs| request(&project, &[], secs);
    let mut instant = Instant::default();
    assert_eq!(instant.next(&at(10.0)), 10.0, "the first request");
    assert_eq!(instant.next(&at(10.1)), 10.1, "a round that is quick enough");
    // The next requests come 0.4 s later each: the cells take at most 4 steps of 1/30 s.
    let slow = instant.next(&at(10.5));
    assert!((slow - (10.1 + 4.0 / 30.0)).abs() < 1e-9, "{slow}");
    let slower = instant.next(&at(10.9));
    assert!((slower - (10.1 + 8.0 / 30.0)).abs() < 1e-9, "{slower}");
    assert_eq!(instant.next(&at(3.0)), 3.0, "backwards");
    assert_eq!(instant.next(&at(30.0)), 30.0, "further than the clock");
    instant.next(&at(30.4));
    let still = WallRequest { playing: false, ..at(30.4) };
    assert_eq!(instant.next(&still), 30.4, "a paused wall shows the instant itself");
}

#[test]
fn a_wall_that_rests_keeps_nothing_and_is_drawn_again() {
    let project = Arc::new(small());
    let variants = [Arc::clone(&project), Arc::new(vary(&project, 1, 1.0, &Locks::default()))];
    let wall = Wall::start(WindowDevice::default(), || {}).expect("a thread");
    let before = drawn(&wall, request(&project, &variants, 0.0));
    // Counted after the images are handed over.
    wait_until("what two simulations and renderers hold", || wall.held_bytes() > 1_000_000);
    wall.rest();
    wait_until("the rest", || !wall.busy().load(std::sync::atomic::Ordering::Relaxed));
    assert_eq!(wall.held_bytes(), 0);
    assert!(wall.cells.iter().all(|cell| cell.latest().is_none()), "no images");
    assert_eq!(Arc::strong_count(&variants[1]), 1, "nobody has the variant any more");
    assert!(drawn(&wall, request(&project, &variants, 0.0)) == before, "the same images again");
}
