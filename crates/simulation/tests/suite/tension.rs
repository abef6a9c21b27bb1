//! The forces on a chain: gravity and the pull of its ends, and nothing in between.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Vec3};
use lovelock_groom::Hairstyle;
use lovelock_simulation::{Integrator, Simulation, SimulationSettings};

use crate::common::catenary::off_the_catenary;
use crate::common::{STEP_SECS, bare, frame, head, straight, style};

const G: f32 = 9.81;

/// Length of a chain and distance of its held ends, metres.
const LENGTH: f32 = 0.5;
const APART: f32 = 0.3;

/// A chain of `links` links whose tip a tie holds beside its root, in two straight parts that meet below, off
/// the middle.
fn hung(links: usize) -> Arc<Hairstyle> {
    let left = links / 2 - 2;
    let a = LENGTH * left as f32 / links as f32;
    let b = LENGTH - a;
    let x = (a * a - b * b + APART * APART) / (2.0 * APART);
    let low = Vec3::new(x, -(a * a - x * x).sqrt(), 0.0);
    let points: Vec<_> = (0..=links)
        .map(|i| {
            let after = i.saturating_sub(left) as f32 / (links - left) as f32;
            (low * (i.min(left) as f32 / left as f32)).lerp(Vec3::X * APART, after)
        })
        .collect();
    let mut held = vec![-1.0; links + 1];
    held[links] = 1e4;
    let style = style(&[points]);
    Arc::new(Hairstyle { held, ..Hairstyle::clone(&style) })
}

/// Rest positions of the points of that chain in a head rotated by `lean`, head space.
fn at_rest(links: usize, lean: f32) -> Vec<DVec3> {
    let mut simulation = Simulation::new(hung(links));
    let pose = Affine3A::from_rotation_z(lean);
    simulation.reset(&head(0.0, pose));
    let settings = SimulationSettings { drag: 4.0, ..bare() };
    let points = |s: &Simulation| -> Vec<_> { (0..=links).map(|i| frame(s).guides.point(0, i)).collect() };
    let (mut last, mut moved) = (points(&simulation), f32::INFINITY);
    for step in 1..=1200 {
        simulation.step(&head(f64::from(step) / 60.0, pose), &settings, STEP_SECS);
        let now = points(&simulation);
        moved = now.iter().zip(&last).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        last = now;
    }
    assert!(moved < 1e-5, "it still moves by {moved} m per step");
    let head_from_world = pose.inverse();
    last.into_iter().map(|p| head_from_world.transform_point3(p).as_dvec3()).collect()
}

#[test]
fn a_guide_tied_at_its_tip_hangs_as_a_catenary() {
    let off = |points: &[DVec3]| off_the_catenary(points, f64::from(LENGTH), f64::from(APART));
    for links in [10, 40] {
        let found = off(&at_rest(links, 0.0));
        println!("deviation from the catenary with {links} links: {found} m");
        // Measured: 1.3 and 1.6 mm. Length factors are reused until a link has rotated by a tenth of a
        // radian, so a guide may come to rest slightly off its curve. Computed in every substep they leave
        // 1.4 and 0.17 mm.
        assert!(found < 2e-3, "{found} m with {links} links");
    }
    // Control: in a tilted head the curve is another one.
    let leant = off(&at_rest(40, 0.3));
    println!("{leant} m in a tilted head");
    assert!(leant > 0.01, "{leant} m");
}

/// Momentum change of a falling chain per substep that is caused neither by gravity nor by the pull along its
/// first link, relative to that of gravity; RMS over a second.
fn unexplained_momentum(integrator: Integrator, substeps_per_sec: u32) -> f64 {
    let links = 30;
    let mut simulation = Simulation::new(style(&[straight(Vec3::ZERO, Vec3::X, links, 0.3)]));
    simulation.reset(&head(0.0, Affine3A::IDENTITY));
    let h = 1.0 / f64::from(substeps_per_sec);
    let settings = SimulationSettings { substeps: 1, integrator, ..bare() };
    let points =
        |s: &Simulation| -> Vec<_> { (0..=links).map(|i| frame(s).guides.point(0, i).as_dvec3()).collect() };
    let given = DVec3::NEG_Y * f64::from(G) * h * links as f64;
    let (mut was, mut before, mut sum) = (points(&simulation), DVec3::ZERO, 0.0);
    for step in 1..=substeps_per_sec {
        simulation.step(&head(f64::from(step) * h, Affine3A::IDENTITY), &settings, h as f32);
        let now = points(&simulation);
        let momentum = now.iter().zip(&was).map(|(a, b)| *a - *b).sum::<DVec3>() / h;
        // The constraint force at the first link acts along it.
        let pull = (was[1] - was[0]).normalize_or_zero();
        sum += (momentum - before - given).reject_from(pull).length_squared();
        (was, before) = (now, momentum);
    }
    (sum / f64::from(substeps_per_sec)).sqrt() / given.length()
}

#[test]
fn only_gravity_and_the_first_link_change_the_momentum_of_a_chain() {
    for integrator in Integrator::ALL {
        let [coarse, fine] = [240, 960].map(|rate| unexplained_momentum(integrator, rate));
        println!("{integrator:?}: {coarse} of gravity's at 240 substeps per second, {fine} at 960");
        match integrator {
            // Measured: 0.9 and 0.28 %, 2.7 and 0.81 %; first order would give a quarter.
            Integrator::Direct => assert!(coarse < 0.012 && fine < 0.4 * coarse, "{coarse} {fine}"),
            Integrator::Relaxation => assert!(coarse < 0.035 && fine < 0.4 * coarse, "{coarse} {fine}"),
            // Control: follow-the-leader returns only a part of the leader's displacement, and only in
            // velocities. 43 and 57 %.
            Integrator::FollowTheLeader => assert!(coarse > 0.3 && fine > 0.3, "{coarse} {fine}"),
        }
    }
}
