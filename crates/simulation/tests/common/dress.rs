//! Hair in the hands of somebody: grown on the figure, cut and tied in any order, as the program does it.

use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::{
    Blade, GroomSettings, GuideFrame, Guides, HairTie, Haircut, Hairstyle, Preset, TieKind, TieReach, grow,
    tied, trimmed,
};
use lovelock_simulation::Simulation;

use super::any::Bytes;
use super::figure::FIGURE;

/// The most that is grown and tied in one drive, because it is dear beside a step.
const MOST_WORK: u32 = 6;

pub struct Dress {
    base: Arc<Hairstyle>,
    /// What it was grown from; none for bare chains.
    groom: Option<GroomSettings>,
    cut: Haircut,
    ties: Vec<HairTie>,
    worn: Arc<Hairstyle>,
    work: u32,
}

impl Dress {
    pub fn new(base: Arc<Hairstyle>) -> Self {
        let worn = Arc::clone(&base);
        Self { base, groom: None, cut: Haircut::default(), ties: Vec::new(), worn, work: 0 }
    }

    /// Some hair on the figure's head: few short guides, so that drives are quick.
    pub fn grown(input: &mut Bytes) -> Self {
        let preset = Preset::ALL[input.byte() as usize % Preset::ALL.len()];
        let groom = GroomSettings {
            seed: input.byte().into(),
            wisps: 8,
            strands_per_wisp: 2,
            segments_per_strand: 4 + u32::from(input.byte() % 20),
            length: any_length(input),
            ..GroomSettings::preset(preset)
        };
        Self { groom: Some(groom), ..Self::new(grow_on_figure(&groom)) }
    }

    pub fn worn(&self) -> Arc<Hairstyle> {
        Arc::clone(&self.worn)
    }

    /// Other ties, or none; whether that gathers anything.
    pub fn tie(&mut self, input: &mut Bytes) -> bool {
        self.ties = (0..input.byte() % 3).map(|_| any_tie(input)).collect();
        self.wear();
        !self.worn.held.is_empty() && self.worn.held.iter().any(|hold| *hold >= 0.0)
    }

    /// Cuts the hair as it is now; whether that meets any.
    pub fn cut(&mut self, input: &mut Bytes, simulation: &Simulation) -> bool {
        let mut frame = GuideFrame::at_rest(&Guides::default(), glam::Affine3A::IDENTITY, 0.0);
        simulation.frame(&mut frame);
        let blade = if input.byte().is_multiple_of(2) {
            Blade::Plane { point: 0.3 * input.vector(), normal: input.vector() }
        } else {
            Blade::Sphere { centre: 0.3 * input.vector(), radius: 0.3 * input.number() }
        };
        let Some(cut) = Haircut::of(&self.worn, &frame, &blade.moved(&frame.world_from_head)) else {
            return false;
        };
        self.cut = self.cut.and(&cut);
        self.wear();
        true
    }

    /// The same hair of another length; whether there is any that was grown.
    pub fn regrow(&mut self, input: &mut Bytes) -> bool {
        let Some(groom) = &mut self.groom else { return false };
        if self.work >= MOST_WORK {
            return false;
        }
        self.work += 1;
        groom.length = any_length(input);
        self.base = grow_on_figure(groom);
        self.wear();
        true
    }

    /// What is worn: cut first, then tied, as the program has it.
    fn wear(&mut self) {
        self.worn = Arc::clone(&self.base);
        if !self.cut.is_empty() {
            self.worn = Arc::new(trimmed(&self.worn, &self.cut));
        }
        if !self.ties.is_empty() && self.work < MOST_WORK {
            self.work += 1;
            self.worn = Arc::new(tied(&self.worn, &self.ties, &*FIGURE));
        }
        self.worn.check().expect("hair that is cut and tied is sound");
    }
}

/// Short hair, and hair that is long enough for a tie, metres.
fn any_length(input: &mut Bytes) -> f32 {
    0.05 + 0.95 * input.unit()
}

fn grow_on_figure(groom: &GroomSettings) -> Arc<Hairstyle> {
    Arc::new(grow(groom, &FIGURE.scalp, &*FIGURE).expect("hair grows on the figure"))
}

/// Rings about a head of usual size, and any at all.
fn any_tie(input: &mut Bytes) -> HairTie {
    let mut tie = HairTie::default();
    if input.byte().is_multiple_of(2) {
        tie.kind = TieKind::Bun;
    }
    tie.reach = [TieReach::All, TieReach::BehindEars, TieReach::AbovePlane, TieReach::InSphere]
        [input.byte() as usize % 4];
    if input.byte().is_multiple_of(4) {
        (tie.at, tie.axis) = (input.vector(), input.vector());
        (tie.radius, tie.tightness) = (input.number(), input.number());
        (tie.bun_radius, tie.bun_coils) = (input.number(), input.number());
        (tie.plane_point, tie.plane_normal) = (input.vector(), input.vector());
        (tie.sphere_centre, tie.sphere_radius) = (input.vector(), input.number());
    } else {
        tie.at += 0.1 * Vec3::new(input.unit() - 0.5, input.unit() - 0.5, input.unit() - 0.5);
        tie.tightness = input.unit();
    }
    tie
}
