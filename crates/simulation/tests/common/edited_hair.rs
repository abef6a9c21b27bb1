//! Hair under edit: grown on the figure, cut and tied in any order, in the same way as the program does.

use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::{
    Blade, GroomSettings, GuideFrame, Guides, HairTie, Haircut, Hairstyle, Preset, TieKind, TieReach, grow,
    tied, trimmed,
};
use lovelock_simulation::Simulation;

use super::any::Bytes;
use super::figure::FIGURE;

/// Limit of growing and tying per drive, because they cost much more than a step.
const MAX_WORK: u32 = 6;

pub struct EditedHair {
    base: Arc<Hairstyle>,
    /// The settings it was grown from; none for bare chains.
    groom: Option<GroomSettings>,
    cut: Haircut,
    ties: Vec<HairTie>,
    result: Arc<Hairstyle>,
    work: u32,
}

impl EditedHair {
    pub fn new(base: Arc<Hairstyle>) -> Self {
        let result = Arc::clone(&base);
        Self { base, groom: None, cut: Haircut::default(), ties: Vec::new(), result, work: 0 }
    }

    /// Some hair on the figure's head: few short guides, so that drives are fast.
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

    pub fn result(&self) -> Arc<Hairstyle> {
        Arc::clone(&self.result)
    }

    /// Replaces the ties; returns whether they gather any hair.
    pub fn tie(&mut self, input: &mut Bytes) -> bool {
        self.ties = (0..input.byte() % 3).map(|_| any_tie(input)).collect();
        self.update();
        !self.result.held.is_empty() && self.result.held.iter().any(|hold| *hold >= 0.0)
    }

    /// Cuts the hair in its current pose; returns whether that cuts any.
    pub fn cut(&mut self, input: &mut Bytes, simulation: &Simulation) -> bool {
        let mut frame = GuideFrame::at_rest(&Guides::default(), glam::Affine3A::IDENTITY, 0.0);
        simulation.frame(&mut frame);
        let blade = if input.byte().is_multiple_of(2) {
            Blade::Plane { point: 0.3 * input.vector(), normal: input.vector() }
        } else {
            Blade::Sphere { centre: 0.3 * input.vector(), radius: 0.3 * input.number() }
        };
        let Some(cut) = Haircut::of(&self.result, &frame, &blade.moved(&frame.world_from_head)) else {
            return false;
        };
        self.cut = self.cut.and(&cut);
        self.update();
        true
    }

    /// Grows the same hair at another length; returns whether it was grown hair.
    pub fn regrow(&mut self, input: &mut Bytes) -> bool {
        let Some(groom) = &mut self.groom else { return false };
        if self.work >= MAX_WORK {
            return false;
        }
        self.work += 1;
        groom.length = any_length(input);
        self.base = grow_on_figure(groom);
        self.update();
        true
    }

    /// The resulting hair: cut first, then tied, as in the program.
    fn update(&mut self) {
        self.result = Arc::clone(&self.base);
        if !self.cut.is_empty() {
            self.result = Arc::new(trimmed(&self.result, &self.cut));
        }
        if !self.ties.is_empty() && self.work < MAX_WORK {
            self.work += 1;
            self.result = Arc::new(tied(&self.result, &self.ties, &*FIGURE));
        }
        self.result.check().expect("hair that is cut and tied is sound");
    }
}

/// Short hair, and hair that is long enough for a tie, metres.
fn any_length(input: &mut Bytes) -> f32 {
    0.05 + 0.95 * input.unit()
}

fn grow_on_figure(groom: &GroomSettings) -> Arc<Hairstyle> {
    Arc::new(grow(groom, &FIGURE.scalp, &*FIGURE).expect("hair grows on the figure"))
}

/// Rings about a head of ordinary size, and arbitrary ones.
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
