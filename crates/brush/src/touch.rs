//! Which points of guides a brush touches, and how strongly.

use glam::Vec3;
use lovelock_base::numbers::smoothstep;
use lovelock_base::random::SplitMix64;
use lovelock_groom::{Bounded, Guides, Hairstyle, Obstacle};
use lovelock_style::hand::hand_input;
use rayon::prelude::*;

use crate::settings::BrushSettings;
use crate::stroke::Dab;

/// Distance from the body up to which hair on the far side of the head is told from hair in front, metres.
const NEAR: f32 = 0.12;

/// A guide that the brush touches.
#[derive(Clone, Debug)]
pub(crate) struct TouchedGuide {
    pub guide: usize,
    /// Its points as they are seen, head space, without the cut part.
    pub points: Vec<Vec3>,
    /// How strongly each point is touched.
    pub weights: Vec<f32>,
}

impl TouchedGuide {
    /// The strongest touch.
    pub fn most(&self) -> f32 {
        self.weights.iter().copied().fold(0.0, f32::max)
    }

    /// The weights, with hair beyond the brush touched as strongly as above: it follows what it hangs on.
    pub fn trailing(&self) -> Vec<f32> {
        let mut most = 0.0_f32;
        let trailing = self.weights.iter().map(|weight| {
            most = most.max(*weight);
            most
        });
        trailing.collect()
    }
}

/// The locks of a hairstyle.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wisps {
    /// The wisp of each guide.
    pub wisp: Vec<Option<usize>>,
    /// The guides of each wisp.
    pub guides: Vec<[usize; 3]>,
}

impl Wisps {
    pub fn of(style: &Hairstyle) -> Self {
        let guides: Vec<[usize; 3]> =
            style.wisps.iter().map(|wisp| wisp.guides.map(|g| g as usize)).collect();
        let mut wisp = vec![None; style.guides.count()];
        for (w, guides) in guides.iter().enumerate() {
            for guide in guides {
                wisp[*guide] = Some(w);
            }
        }
        Self { wisp, guides }
    }

    /// The guides of the lock of a guide.
    pub fn of_guide(&self, guide: usize) -> [usize; 3] {
        self.wisp.get(guide).copied().flatten().map_or([guide; 3], |wisp| self.guides[wisp])
    }

    /// Whether a guide is in the share of locks that a brush touches.
    fn is_in_share(&self, guide: usize, share: f32) -> bool {
        let lock = self.wisp.get(guide).copied().flatten().unwrap_or(guide);
        share >= 1.0 || SplitMix64::of_stream(0, lock as u64).unit() < share
    }
}

/// The guides that a dab touches.
pub(crate) fn touched(
    seen: &Guides,
    dab: &Dab,
    settings: &BrushSettings,
    locks: &Wisps,
    is_free: impl Fn(usize) -> bool + Sync,
    obstacle: &dyn Obstacle,
) -> Vec<TouchedGuide> {
    let radius = dab.radius;
    let distance = |p: Vec3| {
        let from = p - dab.centre;
        if settings.front_only { from.length() } else { (from - dab.view * from.dot(dab.view)).length() }
    };
    let strength = settings.strength * dab.pressure;
    if strength <= 0.0 || settings.share <= 0.0 {
        return Vec::new();
    }
    let count = seen.points_per_guide;
    (0..seen.count())
        .into_par_iter()
        .filter(|guide| is_free(*guide) && locks.is_in_share(*guide, settings.share))
        .filter(|guide| (0..count).any(|i| distance(seen.point(*guide, i)) < radius))
        .filter_map(|guide| {
            let points = hand_input(seen, guide, 1.0)?;
            let last = (points.len() - 1) as f32;
            let weight = |(i, p): (usize, &Vec3)| {
                let away = distance(*p);
                if away >= radius {
                    return 0.0;
                }
                let radial = settings.falloff.at(away / radius) * settings.along.at(i as f32 / last);
                strength * radial * if settings.front_only { front(*p, dab.view, obstacle) } else { 1.0 }
            };
            let weights: Vec<f32> =
                points.iter().enumerate().map(weight).map(|w| w.clamp(0.0, 1.0)).collect();
            let touches = weights.iter().any(|w| *w > 0.0);
            touches.then_some(TouchedGuide { guide, points, weights })
        })
        .collect()
}

/// 1 on the side of the head that is seen, 0 on the other.
fn front(p: Vec3, view: Vec3, obstacle: &dyn Obstacle) -> f32 {
    let (distance, normal) = Bounded(obstacle).distance(p);
    if distance > NEAR { 1.0 } else { smoothstep(-0.25, 0.05, -normal.dot(view)) }
}
