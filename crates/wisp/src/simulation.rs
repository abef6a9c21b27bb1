//! The simulator.

use std::sync::Arc;

use glam::Affine3A;
use lovelock_groom::{GuideFrame, Hairstyle};

use crate::{SimulationSettings, StepInput, StepReport};

/// Hair in motion: the guides of one hairstyle.
#[derive(Debug)]
pub struct Simulation {
    style: Arc<Hairstyle>,
    world_from_head: Affine3A,
    time_secs: f64,
}

impl Simulation {
    /// Hair of `style` at rest on a head at the world's origin.
    pub fn new(style: Arc<Hairstyle>) -> Self {
        Self { style, world_from_head: Affine3A::IDENTITY, time_secs: 0.0 }
    }

    /// Carries the rest shape to the head of `input`, without motion.
    pub fn reset(&mut self, input: &StepInput) {
        self.world_from_head = input.world_from_head;
        self.time_secs = input.time_secs;
    }

    /// Moves on by `dt_secs`, while the body moves from where it was to `input`.
    pub fn step(&mut self, input: &StepInput, settings: &SimulationSettings, dt_secs: f32) -> StepReport {
        let _ = (settings, dt_secs);
        self.reset(input);
        StepReport::default()
    }

    /// Writes the guides as they are now into `frame`, without allocating where it already fits.
    pub fn frame(&self, frame: &mut GuideFrame) {
        *frame = GuideFrame::at_rest(&self.style.guides, self.world_from_head, self.time_secs);
    }

    /// A fingerprint of the state: equal states have equal ones.
    pub fn state_hash(&self) -> u64 {
        0
    }

    /// Changes the hairstyle and carries the motion over where the guides' layout is the same.
    pub fn set_style(&mut self, style: Arc<Hairstyle>) {
        self.style = style;
    }
}
