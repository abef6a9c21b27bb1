//! Where the strands of a plait run.
//!
//! The middle of bundle `k` moves on a figure of eight across the braid: `x = 2 r sin p`, `y = 1.3 r sin 2p`, with the phase
//! `p = 2 pi (s / P + k / 3)`, the bundle's radius `r` and the period `P` of three crossings on one side. When two bundles cross, `y` of one
//! is that of the other with the opposite sign, 2.25 r apart: they touch. The braid is 6 r wide and 4.6 r thick.

use std::f32::consts::TAU;

use glam::Vec2;
use lovelock_base::numbers::smoothstep;

use super::Braid;
use crate::cord::CordStrand;

/// How far bundles swing to each side and in depth, in their radii.
const ASIDE: f32 = 2.0;
const DEEP: f32 = 1.3;
/// Thickness of a braid, as a share of its width.
pub const THICKNESS: f32 = (2.0 * DEEP + 2.0) / (2.0 * ASIDE + 2.0);
/// Crossings on one side in a period.
const CROSSINGS: f32 = 3.0;
/// Radius of the end tie and of the tassel, in the radii of bundles.
const NECK: f32 = 1.15;
const TASSEL: f32 = 1.7;

/// The shape of one braid.
pub struct Weave {
    radius: f32,
    period: f32,
    tightness: f32,
    taper: f32,
    /// Where the braid ends and the tassel begins, and how long that is, metres.
    end: f32,
    tassel: f32,
    flyaways: f32,
}

impl Weave {
    /// The shape of a braid whose hair is `length` metres long from its start.
    pub fn new(braid: &Braid, length: f32) -> Self {
        let tassel = braid.tassel.min(0.8 * length);
        Self {
            radius: braid.width / (2.0 * ASIDE + 2.0),
            period: CROSSINGS * braid.pitch,
            tightness: braid.tightness,
            taper: braid.taper,
            end: length - tassel,
            tassel: tassel.max(0.005),
            flyaways: braid.flyaways,
        }
    }

    /// Radius of a bundle at a distance from the start, metres.
    pub fn radius(&self, metres: f32) -> f32 {
        let gone = (metres / self.end.max(1e-3)).clamp(0.0, 1.0);
        self.radius * (1.0 - self.taper * gone.powf(1.3))
    }

    /// The middle of a bundle, and the slope of its path, at a distance from the start.
    pub fn middle(&self, bundle: usize, metres: f32) -> (Vec2, Vec2) {
        let radius = self.radius(metres);
        let phase = TAU * (metres / self.period + bundle as f32 / 3.0);
        let (sin, cos) = phase.sin_cos();
        let rate = TAU / self.period * radius;
        let slope = Vec2::new(ASIDE * cos, 2.0 * DEEP * (2.0 * cos * cos - 1.0)) * rate;
        (Vec2::new(ASIDE * sin, DEEP * 2.0 * sin * cos) * radius, slope)
    }

    /// Where a strand runs across the braid at a distance from its start, metres.
    pub fn place(&self, strand: &CordStrand, metres: f32) -> Vec2 {
        let bundle = ((strand.rank * 3.0) as usize).min(2);
        let radius = self.radius(metres);
        let loose = 1.0 - self.tightness;
        let [a, b, c, leaves] = strand.chance;
        let mut disc = strand.disc;
        // Strands of a bundle run side by side and change places slowly; in loose braids more so.
        let turn = TAU * metres / self.period;
        let wander = 0.06 + 0.22 * loose;
        disc += Vec2::new((turn * (0.5 + 0.5 * a) + TAU * b).sin(), (turn * (0.5 + 0.5 * b) + TAU * c).cos())
            * wander;
        // A little more than touching, so that no light shines through between bundles.
        disc *= 1.06 + 0.12 * loose;
        if leaves < self.flyaways {
            let out = 0.25 + 0.5 * a;
            disc += disc.normalize_or(Vec2::X) * out * (0.5 + 0.5 * (turn * (0.6 + b) + TAU * c).sin());
        }
        let (middle, slope) = self.middle(bundle, metres);
        // The section of a bundle that runs aslant is longer in that direction.
        let steep = slope.length();
        let along = slope / steep.max(1e-6);
        let stretched = disc + along * (disc.dot(along) * ((1.0 + steep * steep).sqrt() - 1.0));
        let woven = middle + stretched * radius;
        let tied = smoothstep(self.end - 0.25 * self.period, self.end, metres);
        if tied == 0.0 {
            return woven;
        }
        // All bundles become one, which opens beyond the end tie and thins toward the tips.
        let beyond = ((metres - self.end) / self.tassel).max(0.0);
        let opens = NECK + (TASSEL - NECK) * smoothstep(0.0, 0.35, beyond);
        let thins = 1.0 - 0.45 * smoothstep(0.3, 1.2, beyond);
        let spread = Vec2::from_angle(TAU * (strand.rank + 0.15 * (a - 0.5))) * strand.disc.length();
        woven.lerp(spread * (radius * opens * thins), tied)
    }
}
