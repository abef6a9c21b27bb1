//! Hair of known geometry.

use glam::Vec3;
use lovelock_groom::{GroomSettings, Hairstyle, NoObstacle, PlainHead, WispCurve, grow};

use crate::{Layer, Operation, apply_layer};

/// Straight guides of 0.31 m in one direction, rooted on the plain head.
pub fn straight(direction: Vec3) -> Hairstyle {
    let settings = GroomSettings { wisps: 12, strands_per_wisp: 3, ..GroomSettings::default() };
    let mut style = grow(&settings, &PlainHead.scalp(16), &PlainHead).expect("hair");
    let guides = &mut style.guides;
    let per = guides.points_per_guide;
    for g in 0..guides.count() {
        let root = guides.point(g, 0);
        for i in 0..per {
            let p = root + direction * (0.31 * i as f32 / (per - 1) as f32);
            (guides.x[g * per + i], guides.y[g * per + i], guides.z[g * per + i]) = (p.x, p.y, p.z);
        }
    }
    style
}

/// The hair after one operation, without a body.
pub fn acted(operation: impl Into<Operation>, style: &Hairstyle) -> Hairstyle {
    apply_layer(&Layer::of(operation), 1.0, style, &NoObstacle).expect("a change")
}

/// Unit direction of a link of a guide.
pub fn direction(style: &Hairstyle, guide: usize, link: usize) -> Vec3 {
    (style.guides.point(guide, link + 1) - style.guides.point(guide, link)).normalize_or_zero()
}

/// Angle between the first and the last link of a guide.
pub fn turn_between(style: &Hairstyle, guide: usize) -> f32 {
    let last = style.guides.points_per_guide - 2;
    direction(style, guide, 0).angle_between(direction(style, guide, last))
}

/// The points of a strand at rest.
pub fn places(style: &Hairstyle, strand: usize) -> Vec<Vec3> {
    let set = &style.strands;
    let curve = WispCurve::at_rest(&style.guides, &style.wisps[set.wisp[strand] as usize]);
    let range = set.first_point[strand] as usize..set.first_point[strand + 1] as usize;
    let offset = |i: usize| Vec3::new(set.offset_normal[i], set.offset_binormal[i], set.offset_tangent[i]);
    range.map(|i| curve.point(set.weights[strand], set.guide_param[i], offset(i))).collect()
}
