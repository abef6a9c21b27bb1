//! Limp hair that stands out of a plate in rows: without shape memory it collapses into one sheet unless hair
//! repels hair.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_groom::{GuideFrame, Guides, Hairstyle, StrandSet};
use lovelock_simulation::{Simulation, SimulationSettings, StepInput};

/// Rows, hairs per row, and points per hair.
const SIZE: (usize, usize, usize) = (14, 18, 25);
/// Distance between rows and between the hairs of a row, metres, and length of a hair.
const GAP: f32 = 0.008;
const LENGTH: f32 = 0.18;

/// Hair without shape memory and without friction.
pub fn settings(grid: bool) -> SimulationSettings {
    let mut settings = SimulationSettings {
        style_support: 0.0,
        stiffness_root: 0.0,
        stiffness_tip: 0.0,
        hold: 0.0,
        clamped_links: 0,
        ..SimulationSettings::default()
    };
    if !grid {
        (settings.repulsion.strength, settings.repulsion.cohesion) = (0.0, 0.0);
    }
    settings
}

/// Lets it fall for `steps` steps; returns the guides and the remaining fraction of the rest volume.
pub fn fall(settings: &SimulationSettings, steps: u32) -> (Guides, f32) {
    let (rows, across, points) = SIZE;
    let mut guides = Guides { points_per_guide: points, ..Guides::default() };
    for row in 0..rows {
        for n in 0..across {
            // Bristles that already hang a little, so that all fall to the same side.
            let root = Vec3::new(n as f32 * GAP, row as f32 * GAP, 0.0);
            let along = Vec3::new(0.0, -0.5, 1.0).normalize_or(Vec3::Z);
            let hair: Vec<Vec3> =
                (0..points).map(|i| root + along * (LENGTH * i as f32 / (points - 1) as f32)).collect();
            guides.push(&hair);
        }
    }
    let strands = StrandSet { first_point: vec![0], ..StrandSet::default() };
    let mut simulation = Simulation::new(Arc::new(Hairstyle { guides, strands, ..Hairstyle::default() }));
    let input = |step: u32| StepInput::new(f64::from(step) / 60.0, Affine3A::IDENTITY, &[]);
    simulation.reset(&input(0));
    let mut kept = 1.0;
    for step in 1..=steps {
        let report = simulation.step(&input(step), settings, 1.0 / 60.0);
        kept = report.hair_volume / report.hair_volume_at_rest;
    }
    let mut frame = GuideFrame::at_rest(&Guides::default(), Affine3A::IDENTITY, 0.0);
    simulation.frame(&mut frame);
    (frame.guides, kept)
}
