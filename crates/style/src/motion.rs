//! Changing how guides move: the factors of a hairstyle on the settings of the simulation.

use lovelock_groom::{Hairstyle, MotionFactors};

use crate::Scope;
use crate::guides::shape_of;

/// Multiplies the factors in one list at the guides on which the layer acts. The factor of a point is `1 + (factor - 1) s`, where `s` is
/// the strength of the layer at the root times its ramp at the point: a blend in a straight line, so that a factor of 0 can be faded in.
/// It is never below 0.
pub fn scale(
    style: &mut Hairstyle,
    scope: &Scope<'_>,
    factor: f32,
    list: impl Fn(&mut MotionFactors) -> &mut Vec<f32>,
) {
    let points = style.guides.points_per_guide;
    let mut own = vec![1.0_f32; style.guides.x.len()];
    for (guide, strength) in scope.guides(style).into_iter().enumerate() {
        if strength == 0.0 {
            continue;
        }
        // The end of a guide that was cut is its tip.
        let last =
            shape_of(&style.guides, guide, strength, None).map_or(points, |shape| shape.points.len()) - 1;
        for (i, own) in own[guide * points..(guide + 1) * points].iter_mut().enumerate() {
            let place = i.min(last) as f32 / last as f32;
            *own = (1.0 + (factor - 1.0) * strength * scope.along(place)).max(0.0);
        }
    }
    if own.iter().all(|own| *own == 1.0) {
        return;
    }
    let list = list(&mut style.motion);
    list.resize(own.len(), 1.0);
    let [low, high] = MotionFactors::RANGE;
    for (now, own) in list.iter_mut().zip(own) {
        *now = (*now * own).clamp(low, high);
    }
}
