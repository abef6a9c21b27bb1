//! Bare chains: chains at rest stay at rest, and substeps have the expected number and accuracy.

use crate::common::{STEP_SECS, bare, frame, head, straight, style};
use glam::{Affine3A, Vec3};
use lovelock_simulation::{Simulation, SimulationSettings};

/// A simulation of the guides on a head at rest at the origin.
fn at_rest(guides: &[Vec<Vec3>]) -> Simulation {
    let mut simulation = Simulation::new(style(guides));
    simulation.reset(&head(0.0, Affine3A::IDENTITY));
    simulation
}

/// Steps with a head that stands still; `seen` receives the simulation after every step.
fn stand(
    simulation: &mut Simulation,
    settings: &SimulationSettings,
    steps: u32,
    mut seen: impl FnMut(&Simulation),
) {
    for step in 1..=steps {
        let time_secs = f64::from(step) * f64::from(STEP_SECS);
        simulation.step(&head(time_secs, Affine3A::IDENTITY), settings, STEP_SECS);
        seen(simulation);
    }
}

fn tip(simulation: &Simulation) -> Vec3 {
    let guides = frame(simulation).guides;
    guides.point(0, guides.points_per_guide - 1)
}

#[test]
fn a_hanging_chain_stays_at_rest() {
    let guide = straight(Vec3::new(0.1, 1.5, 0.0), Vec3::NEG_Y, 30, 0.3);
    let mut simulation = at_rest(std::slice::from_ref(&guide));
    stand(&mut simulation, &bare(), 300, |_| ());
    let now = frame(&simulation).guides;
    for (i, rest) in guide.iter().enumerate() {
        // A metre and a half from the world's origin, f32 has a resolution of 1.2e-7.
        assert!((now.point(0, i) - *rest).length() < 5e-7, "point {i} moved");
    }
}

#[test]
fn more_substeps_are_more_accurate() {
    let path = |substeps: u32| {
        let mut simulation = at_rest(&[straight(Vec3::ZERO, Vec3::X, 30, 0.3)]);
        let mut tips = Vec::new();
        let settings = SimulationSettings { substeps, ..bare() };
        stand(&mut simulation, &settings, 18, |s| tips.push(tip(s)));
        tips
    };
    let truth = path(16);
    let error = |substeps: u32| {
        let squares: f32 = path(substeps).iter().zip(&truth).map(|(a, b)| (*a - *b).length_squared()).sum();
        (squares / truth.len() as f32).sqrt()
    };
    let (one, two, four, eight) = (error(1), error(2), error(4), error(8));
    assert!(one > two && two > four && four > eight, "{one} {two} {four} {eight}");
    assert!(four < 0.03, "a tenth of the length at the default: {four} m");
}

#[test]
fn a_fast_head_raises_the_number_of_substeps() {
    let guides = [straight(Vec3::ZERO, Vec3::NEG_Y, 30, 0.3)];
    let substeps = |speed: f32| {
        let mut simulation = at_rest(&guides);
        let place = Affine3A::from_translation(Vec3::X * (speed * STEP_SECS));
        simulation.step(&head(f64::from(STEP_SECS), place), &bare(), STEP_SECS).substeps
    };
    // Half a link of 1 cm per substep.
    assert_eq!(substeps(0.5), 4);
    assert_eq!(substeps(2.4), 8);
    assert_eq!(substeps(20.0), 16);
}
