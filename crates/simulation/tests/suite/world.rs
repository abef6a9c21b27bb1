//! Ties, cuts, wind and volume: external influences on the dancer's hair.

use glam::{Affine3A, Vec3};
use lovelock_groom::{
    Blade, GroomSettings, HairTie, Haircut, Preset, Strands, TieKind, interpolate, trimmed,
};
use lovelock_motion::{ColliderShape, PlacedCollider};
use lovelock_simulation::{Simulation, SimulationSettings, StepInput};
use std::sync::Arc;

use crate::common::{STEP_SECS, Stage, frame, head, straight, style};

fn few(preset: Preset) -> Stage {
    grown(preset, 24)
}

fn grown(preset: Preset, wisps: u32) -> Stage {
    Stage::grown(&GroomSettings { wisps, strands_per_wisp: 4, ..GroomSettings::preset(preset) })
}

/// Simulates seconds of the dance, from its start.
fn dance(
    stage: &mut Stage,
    simulation: &mut Simulation,
    secs: f64,
    each: &mut dyn FnMut(&Simulation, Affine3A),
) {
    let settings = SimulationSettings::default();
    for step in 1..=(secs * 60.0) as u32 {
        let input = stage.at(Some(f64::from(step) / 60.0));
        let report = simulation.step(&input, &settings, STEP_SECS);
        assert!(report.max_stretch < 1e-5, "step {step}: {report:?}");
        // As for loose hair: between colliders, and in front of one that moves at 5 m/s, a point may lag by 1
        // mm.
        assert!(report.max_penetration_m < 1e-3, "step {step}: {report:?}");
        assert_eq!(report.recovered_guides, 0);
        each(simulation, input.world_from_head);
    }
}

#[test]
fn a_tie_holds_the_hair_in_its_ring_and_the_tail_swings() {
    // A bun of fewer wisps is too thin to hold together.
    let mut stage = grown(Preset::Long, 60);
    for kind in [TieKind::Ponytail, TieKind::Bun] {
        stage.style = Arc::clone(&stage.loose);
        stage.tie(&[HairTie { kind, ..HairTie::default() }]);
        let style = Arc::clone(&stage.style);
        let n = style.guides.points_per_guide;
        let held = |hold: &dyn Fn(f32) -> bool| -> Vec<usize> {
            (0..style.held.len()).filter(|i| hold(style.held[*i])).collect()
        };
        let ring = held(&|h| h >= 4000.0);
        let firm = held(&|h| h >= 60.0);
        assert!(ring.len() >= 2 * 150, "only {} points are in the ring", ring.len());
        let mut simulation = stage.simulation(Some(0.0));
        let (mut in_ring, mut on_head, mut tips) = (0.0_f32, 0.0_f32, 0.0_f32);
        dance(&mut stage, &mut simulation, 3.0, &mut |simulation, world_from_head| {
            let now = frame(simulation).guides;
            let away = |i: usize| {
                let rest = world_from_head.transform_point3(style.guides.point(i / n, i % n));
                (now.point(i / n, i % n) - rest).length()
            };
            in_ring = ring.iter().map(|i| away(*i)).fold(in_ring, f32::max);
            on_head = firm.iter().map(|i| away(*i)).fold(on_head, f32::max);
            tips = (0..style.guides.count()).map(|g| away(g * n + n - 1)).fold(tips, f32::max);
        });
        println!("{kind:?}: ring {in_ring} m, firm {on_head} m, tips {tips} m");
        // Measured: 0.2 mm in the ring, whose radius is 14 mm.
        assert!(in_ring < 0.003, "{kind:?}: hair moves by {in_ring} m in its ring");
        assert!(on_head < 0.02, "{kind:?}: hair before the ring moves by {on_head} m");
        match kind {
            TieKind::Ponytail => assert!(tips > 0.2, "a tail that moves by {tips} m does not swing"),
            TieKind::Bun => assert!(tips < 0.06, "a bun that moves by {tips} m comes off"),
        }
    }
}

#[test]
fn hair_cut_in_motion_continues_from_where_it_was() {
    let mut stage = few(Preset::Long);
    let mut simulation = stage.simulation(Some(0.0));
    dance(&mut stage, &mut simulation, 0.8, &mut |_, _| {});
    let before = frame(&simulation);
    let blade = Blade::Plane { point: Vec3::new(0.0, -0.02, 0.0), normal: Vec3::new(0.0, -1.0, 0.2) };
    let cut =
        Haircut::of(&stage.style, &before, &blade.moved(&before.world_from_head)).expect("it meets hair");
    let met = cut.kept.iter().filter(|k| **k < 1.0).count();
    assert!(met > 16, "only {met} guides are cut");
    let short = Arc::new(trimmed(&stage.style, &cut));
    let mut whole = simulation.clone();
    simulation.set_style(Arc::clone(&short));
    let after = frame(&simulation);

    // Guides up to their new ends, and strands: nothing moves by more than the rounding of 31 links in f32.
    let n = short.guides.points_per_guide;
    let (mut most, mut compared) = (0.0_f32, 0);
    for g in 0..short.guides.count() {
        for i in 0..n {
            if i == 0 || short.guides.point(g, i) != short.guides.point(g, i - 1) {
                most = most.max((before.guides.point(g, i) - after.guides.point(g, i)).length());
                compared += 1;
            }
        }
    }
    let (mut old, mut new) = (Strands::default(), Strands::default());
    interpolate(&stage.style, &before, &mut old);
    interpolate(&short, &after, &mut new);
    assert!(new.points() < old.points());
    let mut strands = 0.0_f32;
    for s in 0..short.strands.count() {
        let (a, b) = (old.first_point[s] as usize, new.first_point[s] as usize);
        let left = new.first_point[s + 1] as usize - b - 1;
        strands = (0..left).map(|i| old.point(a + i).distance(new.point(b + i))).fold(strands, f32::max);
    }
    println!("guides {most} m over {compared} points, strands {strands} m");
    assert!(most < 2e-5 && strands < 2e-5, "guides jump by {most} m, strands by {strands} m");

    // It continues: a step later the remaining hair is close to where the whole hair would be, and nothing
    // has stretched.
    let settings = SimulationSettings::default();
    let input = stage.at(Some(0.8 + 1.0 / 60.0));
    let report = simulation.step(&input, &settings, STEP_SECS);
    whole.step(&input, &settings, STEP_SECS);
    assert!(report.max_stretch < 1e-5 && report.recovered_guides == 0, "{report:?}");
    let (cut_now, whole_now) = (frame(&simulation).guides, frame(&whole).guides);
    let middle = |g: usize| (cut_now.point(g, 6) - whole_now.point(g, 6)).length();
    assert!((0..short.guides.count()).map(middle).fold(0.0, f32::max) < 0.02);
    dance(&mut stage, &mut simulation, 1.0, &mut |_, _| {});
    // Control: another hairstyle does move the drawn hair.
    let mut other = whole.clone();
    let longer =
        GroomSettings { wisps: 24, strands_per_wisp: 4, length: 0.5, ..GroomSettings::preset(Preset::Long) };
    let was = frame(&other).guides.point(5, 20);
    other.set_style(Stage::grown(&longer).style);
    assert!((frame(&other).guides.point(5, 20) - was).length() > 1e-3);
}

#[test]
fn the_head_shelters_hair_behind_it_only() {
    // A straight guide 10 cm in front of a head of 9 cm, one behind it, and one far aside.
    let guide = |x: f32, z: f32| straight(Vec3::new(x, 0.08, z), Vec3::NEG_Y, 15, 0.15);
    let guides = style(&[guide(-0.16, 0.0), guide(0.16, 0.0), guide(0.0, 0.6)]);
    let shape = ColliderShape::Capsule { a: Vec3::ZERO, b: Vec3::ZERO, radius_a: 0.09, radius_b: 0.09 };
    let skull = [PlacedCollider { shape, world_from_rest: Affine3A::IDENTITY }];
    let blown = |sheltering: f32| {
        let mut settings = SimulationSettings {
            stiffness_root: 14.0,
            drag: 4.0,
            hold: 0.0,
            ..SimulationSettings::default()
        };
        settings.wind.speed = 4.0;
        (settings.wind.gusts, settings.wind.turbulence, settings.wind.sheltering) = (0.0, 0.0, sheltering);
        let mut simulation = Simulation::new(Arc::clone(&guides));
        let input =
            |step: u32| StepInput { colliders: &skull, ..head(f64::from(step) / 60.0, Affine3A::IDENTITY) };
        simulation.reset(&input(0));
        for step in 1..=90 {
            simulation.step(&input(step), &settings, STEP_SECS);
        }
        let now = frame(&simulation).guides;
        [0, 1, 2].map(|g| now.point(g, 15).x - guides.guides.point(g, 15).x)
    };
    let ([front, behind, aside], [front_open, behind_open, aside_open]) = (blown(1.0), blown(0.0));
    println!("sheltered: {front} {behind} {aside}; open: {front_open} {behind_open} {aside_open}");
    assert_eq!((front, aside), (front_open, aside_open), "nothing shelters in front and aside");
    assert!(behind_open > 0.03 && behind < 0.4 * behind_open, "behind: {behind} of {behind_open} m");
}
