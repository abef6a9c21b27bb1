//! What brushes did to the strands of locks.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};
use lovelock_groom::fine::lock_numbers;
use lovelock_groom::{Hairstyle, StrandSet, WispCurve};

use crate::Scope;
use crate::hand::{HandChannel, HandEdit};
use crate::strands::{displace, refine_where};

/// Points that a turn of a curl has at least.
const POINTS_PER_TURN: f32 = 9.0;

/// The edits of all guides of a hairstyle, as strands follow them.
pub(super) struct StrandEdits<'a> {
    /// The edit of each guide.
    pub edits: &'a [Option<HandEdit>],
    /// The links of each guide before it was cut.
    pub links: &'a [usize],
    /// Where and how strongly they act.
    pub scope: &'a Scope<'a>,
}

impl StrandEdits<'_> {
    pub fn apply(&self, style: &mut Hairstyle) {
        self.displace(style);
        self.widen(style);
        self.remove(style);
    }

    /// Whether some guide of each wisp has one of these channels.
    fn wisps(&self, style: &Hairstyle, kinds: &[HandChannel]) -> Option<Vec<bool>> {
        let has = |guide: &u32| {
            let edit = self.edits[*guide as usize].as_ref();
            edit.is_some_and(|edit| kinds.iter().any(|kind| !edit.channels[*kind as usize].is_empty()))
        };
        let all: Vec<bool> = style.wisps.iter().map(|wisp| wisp.guides.iter().any(has)).collect();
        all.contains(&true).then_some(all)
    }

    /// The guides of a strand with its part of each: none is negative, and they sum to 1.
    fn parts(style: &Hairstyle, set: &StrandSet, strand: usize) -> [(usize, f32); 3] {
        let guides = style.wisps[set.wisp[strand] as usize].guides;
        let weights = set.weights[strand].map(|w| w.max(0.0));
        let sum: f32 = weights.iter().sum();
        std::array::from_fn(|k| (guides[k] as usize, if sum > 0.0 { weights[k] / sum } else { 1.0 / 3.0 }))
    }

    /// A channel of a strand at a place along its guides, in links.
    fn channel(&self, parts: &[(usize, f32); 3], kind: HandChannel, u: f32) -> f32 {
        let of = |(guide, part): &(usize, f32)| {
            let edit = self.edits[*guide].as_ref();
            part * edit.map_or(kind.neutral(), |edit| edit.channel(kind, u / self.links[*guide] as f32))
        };
        parts.iter().map(of).sum()
    }

    fn pitch(&self, parts: &[(usize, f32); 3]) -> f32 {
        let of = |(guide, part): &(usize, f32)| {
            part * self.edits[*guide].as_ref().map_or(HandEdit::PITCH, |edit| edit.pitch)
        };
        parts.iter().map(of).sum::<f32>().max(HandEdit::PITCHES[0])
    }

    /// Spreads, twists and curls strands.
    fn displace(&self, style: &mut Hairstyle) {
        use HandChannel::{Curl, Spread, Twist};
        let Some(acts) = self.wisps(style, &[Spread, Curl, Twist]) else { return };
        if let Some(curled) = self.wisps(style, &[Curl]) {
            let strengths = self.scope.strands(style);
            let segments: Vec<Option<(f32, f32)>> = (0..style.strands.count())
                .map(|strand| {
                    let parts = Self::parts(style, &style.strands, strand);
                    let curls = strengths[strand] != 0.0 && curled[style.strands.wisp[strand] as usize];
                    curls.then(|| (0.0, self.pitch(&parts) / POINTS_PER_TURN))
                })
                .collect();
            refine_where(style, |strand| segments[strand]);
        }
        let locks = lock_numbers(&style.strands);
        let curves: Vec<Option<WispCurve>> = (style.wisps.iter().zip(&acts))
            .map(|(wisp, acts)| acts.then(|| WispCurve::at_rest(&style.guides, wisp)))
            .collect();
        let old = style.clone();
        let set = &old.strands;
        displace(style, self.scope, |point| {
            let Some(curve) = &curves[point.wisp] else { return point.offset };
            let u = point.place * set.guide_param[set.first_point[point.strand + 1] as usize - 1];
            let parts = Self::parts(&old, set, point.strand);
            let strength = point.strength * self.scope.along(point.place);
            let [spread, curl, twist] = [Spread, Curl, Twist].map(|kind| {
                let value = self.channel(&parts, kind, u);
                kind.neutral() + (value - kind.neutral()) * strength
            });
            let mut offset = point.offset;
            if spread != 1.0 || twist != 0.0 {
                let apart = curve.blend(set.weights[point.strand], u) - curve.blend([1.0 / 3.0; 3], u);
                let across = (curve.frame(u).transpose() * apart).truncate();
                let whole = (across + offset.truncate()) * spread.max(0.0);
                offset = (Vec2::from_angle(TAU * twist).rotate(whole) - across).extend(offset.z);
            }
            if curl != 0.0 {
                let lock = usize::from(locks[point.strand]) + point.wisp * 64;
                let phase = self.scope.random(0, lock).angle();
                let angle = phase + TAU * point.metres / self.pitch(&parts);
                offset += Vec3::new(angle.cos(), angle.sin(), 0.0) * curl;
            }
            offset
        });
    }

    fn widen(&self, style: &mut Hairstyle) {
        let Some(acts) = self.wisps(style, &[HandChannel::Width]) else { return };
        let strengths = self.scope.strands(style);
        for (strand, strength) in strengths.into_iter().enumerate() {
            let set = &style.strands;
            if strength == 0.0 || !acts[set.wisp[strand] as usize] {
                continue;
            }
            let parts = Self::parts(style, set, strand);
            let range = set.first_point[strand] as usize..set.first_point[strand + 1] as usize;
            let end = set.guide_param[range.end - 1].max(1e-6);
            for i in range {
                let u = style.strands.guide_param[i];
                let factor = self.channel(&parts, HandChannel::Width, u) - 1.0;
                let factor = 1.0 + factor * strength * self.scope.along(u / end);
                style.strands.taper[i] *= factor.max(0.0);
            }
        }
    }

    /// Leaves out the strands of removed locks.
    fn remove(&self, style: &mut Hairstyle) {
        if !self.edits.iter().flatten().any(|edit| edit.removed) {
            return;
        }
        let strengths = self.scope.strands(style);
        let stays = |strand: usize| {
            let removed = |(guide, part): (usize, f32)| {
                if self.edits[guide].as_ref().is_some_and(|edit| edit.removed) { part } else { 0.0 }
            };
            let parts = Self::parts(style, &style.strands, strand);
            strengths[strand] < 0.5 || parts.map(removed).iter().sum::<f32>() <= 0.5
        };
        let stays: Vec<bool> = (0..style.strands.count()).map(stays).collect();
        if stays.contains(&false) {
            let set = std::mem::take(&mut style.strands);
            style.strands =
                set.shortened(&mut style.wisps, |strand| if stays[strand] { usize::MAX } else { 0 });
        }
    }
}
