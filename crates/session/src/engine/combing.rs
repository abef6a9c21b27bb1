//! The transition of strands between ties, while their guides are simulated.
//!
//! A tie flattens the strands of a wisp, and lets them spread again beyond its ring. When hair is tied in motion, the simulation
//! moves the guides. The offsets of strands from their guides are blended over the same time, so that nothing jumps.

use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::{GuideFrame, Hairstyle, WispCurve};
use rayon::prelude::*;

use crate::scene::Scene;

/// Duration of the transition, seconds, the same as that of the guides.
const COMB_SECS: f64 = 0.7;

/// Strands in transition.
#[derive(Clone, Debug)]
pub(super) struct Combing {
    /// Offsets of strands at the start, in the frames of the new wisps.
    from: Vec<Vec3>,
    /// How wide wisps may be at the start, in the layout of guides.
    from_widest: Vec<f32>,
    secs: f64,
}

impl Combing {
    /// The transition from the strands of `from` to those of `to`, whose guides are at `now`. `None` unless both are the same strands
    /// with different ties.
    pub(super) fn between(from: &Hairstyle, to: &Hairstyle, now: &GuideFrame) -> Option<Self> {
        let (a, b) = (&from.strands, &to.strands);
        let same = a.first_point == b.first_point && a.guide_param == b.guide_param && from.wisps == to.wisps;
        if !same || from.held == to.held || now.guides.points_per_guide < 2 {
            return None;
        }
        // The frame of a wisp is derived from its rest shape, which has changed.
        let of_wisp = |wisp: &lovelock_groom::Wisp| {
            let [old, new] = [from, to].map(|style| {
                let mut curve = WispCurve::default();
                curve.place(&style.guides, wisp, &style.widest, &now.guides, now.world_from_head);
                curve
            });
            let first = a.first_point[wisp.first_strand as usize] as usize;
            let end = a.first_point[(wisp.first_strand + wisp.strand_count) as usize] as usize;
            let offset = |i: usize| Vec3::new(a.offset_normal[i], a.offset_binormal[i], a.offset_tangent[i]);
            let turned = move |i: usize| {
                let u = a.guide_param[i];
                new.frame(u).transpose() * (old.frame(u) * offset(i))
            };
            (first, (first..end).map(turned).collect::<Vec<_>>())
        };
        let mut all = vec![Vec3::ZERO; a.guide_param.len()];
        for (first, offsets) in from.wisps.par_iter().map(of_wisp).collect::<Vec<_>>() {
            all[first..first + offsets.len()].copy_from_slice(&offsets);
        }
        Some(Self { from: all, from_widest: from.widest.clone(), secs: 0.0 })
    }

    /// Advances the time. Returns whether the transition continues.
    pub(super) fn advance(&mut self, secs: f64) -> bool {
        self.secs += secs;
        self.secs < COMB_SECS
    }

    /// The style with the current strands, on the way to `to`.
    pub(super) fn style(&self, to: &Hairstyle) -> Arc<Hairstyle> {
        self.style_at(self.secs, to)
    }

    /// The style with its strands `secs` after the start.
    fn style_at(&self, secs: f64, to: &Hairstyle) -> Arc<Hairstyle> {
        let t = (secs / COMB_SECS).clamp(0.0, 1.0) as f32;
        let t = t * t * (3.0 - 2.0 * t);
        let mut style = to.clone();
        let set = &mut style.strands;
        let rows = set.offset_normal.iter_mut().zip(&mut set.offset_binormal).zip(&mut set.offset_tangent);
        for (((x, y), z), from) in rows.zip(&self.from) {
            let now = from.lerp(Vec3::new(*x, *y, *z), t);
            (*x, *y, *z) = (now.x, now.y, now.z);
        }
        for (widest, from) in style.widest.iter_mut().zip(&self.from_widest) {
            *widest = from + (*widest - from) * t;
        }
        Arc::new(style)
    }

    /// `scene` with its strands as they were `ago_secs` before now.
    pub(super) fn scene(&self, scene: &Scene, ago_secs: f64) -> Arc<Scene> {
        Arc::new(Scene { style: self.style_at(self.secs - ago_secs, &scene.style), ..scene.clone() })
    }
}
