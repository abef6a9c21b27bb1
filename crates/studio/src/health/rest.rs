//! Where the style as it was drawn lies inside what it collides with.

use glam::Vec3;
use lovelock_groom::Hairstyle;
use lovelock_motion::{Body, Collider, signed_distance};
use rayon::prelude::*;
use serde::Serialize;

/// The deepest point of a style at rest inside a collider.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RestInside {
    /// How deep, metres.
    pub depth_m: f32,
    /// The guide.
    pub guide: u32,
    /// Its point.
    pub point: u32,
    /// The collider's name.
    pub collider: String,
}

/// Points at the root that are not looked at: the scalp carries them, and may lie under the round shapes that stand for it.
const ROOTS: usize = 3;

impl RestInside {
    /// Looks for it; none where no point is inside.
    pub fn find(style: &Hairstyle, body: &Body, colliders: &[Collider]) -> Option<Self> {
        let guides = &style.guides;
        let head = Vec3::from(body.skeleton.world_at_rest.get(body.head_joint)?.translation);
        let deepest_of = |guide: usize| {
            let mut deepest: Option<(f32, usize, usize)> = None;
            for point in ROOTS..guides.points_per_guide {
                let p = guides.point(guide, point) + head;
                for (c, collider) in colliders.iter().enumerate() {
                    let depth = -signed_distance(&collider.shape_at_rest, p);
                    if depth > deepest.map_or(0.0, |(most, ..)| most) {
                        deepest = Some((depth, point, c));
                    }
                }
            }
            deepest.map(|(depth, point, c)| (depth, guide, point, c))
        };
        // Equal depths: the first guide, whatever thread looked at it.
        let deepest = (0..guides.count()).into_par_iter().filter_map(deepest_of).reduce_with(|a, b| {
            let first = a.0 > b.0 || (a.0 == b.0 && a.1 < b.1);
            if first { a } else { b }
        });
        deepest.map(|(depth_m, guide, point, c)| Self {
            depth_m,
            guide: guide as u32,
            point: point as u32,
            collider: colliders[c].name.clone(),
        })
    }
}
