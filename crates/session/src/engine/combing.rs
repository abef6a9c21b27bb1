//! Strands that go over from one way of being gathered to another, while their guides are simulated there.
//!
//! A tie combs the strands of a wisp flat, and lets them open again beyond its ring. Guides that are tied in motion go
//! over by being simulated; where strands leave their guides follows in the same time, so that nothing jumps.

use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::{GuideFrame, Hairstyle, WispCurve};
use rayon::prelude::*;

use crate::scene::Scene;

/// How long it takes, seconds: as long as ties take to hold the guides.
const COMB_SECS: f64 = 0.7;

/// Strands on their way.
#[derive(Clone, Debug)]
pub(super) struct Combing {
    /// Where strands were at the start, as offsets in the frames that wisps have now.
    from: Vec<Vec3>,
    secs: f64,
}

impl Combing {
    /// From the strands of `from` to those of `to`, whose guides are at `now`; none where they are not the same strands,
    /// gathered by other ties.
    pub(super) fn between(from: &Hairstyle, to: &Hairstyle, now: &GuideFrame) -> Option<Self> {
        let (a, b) = (&from.strands, &to.strands);
        let same = a.first_point == b.first_point && a.guide_param == b.guide_param && from.wisps == to.wisps;
        if !same || from.held == to.held || now.guides.points_per_guide < 2 {
            return None;
        }
        // The frame of a wisp begins as that of its shape at rest, which is another one now.
        let of_wisp = |wisp: &lovelock_groom::Wisp| {
            let [old, new] = [from, to].map(|style| {
                let mut curve = WispCurve::default();
                curve.place(&style.guides, wisp, &now.guides, now.world_from_head);
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
        Some(Self { from: all, secs: 0.0 })
    }

    /// Time passes; returns whether they are still on their way.
    pub(super) fn advance(&mut self, secs: f64) -> bool {
        self.secs += secs;
        self.secs < COMB_SECS
    }

    /// The style as its strands are now, on their way to `to`.
    pub(super) fn style(&self, to: &Hairstyle) -> Arc<Hairstyle> {
        self.style_at(self.secs, to)
    }

    /// The style as its strands are `secs` after they set out.
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
        Arc::new(style)
    }

    /// `scene` with its strands as they were `ago_secs` before now.
    pub(super) fn scene(&self, scene: &Scene, ago_secs: f64) -> Arc<Scene> {
        Arc::new(Scene { style: self.style_at(self.secs - ago_secs, &scene.style), ..scene.clone() })
    }
}
