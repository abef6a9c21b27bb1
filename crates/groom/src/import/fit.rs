//! Fits a groom to a scalp by a uniform scale and a shift that bring its roots to the skin.
//!
//! Iterative closest points (Besl, `McKay` 1992) without rotation, which the file's axes determine. The search starts
//! from several scales, ignores the roots that fit worst (a groom may reach down the neck), and favours the scale that
//! it started from, because a part of a scalp also fits at a smaller size.

use glam::Vec3;
use rayon::prelude::*;

use super::surface::Surface;
use crate::io::RootShape;

const ROOTS: usize = 400;
const STEPS: usize = 12;
/// Fraction of the roots that an iteration uses.
const TRUSTED: f32 = 0.8;
/// Weight of the starting scale against the fitted one.
const HOLD: f32 = 0.3;
/// Larger gaps count as this one, because the root is not on the scalp at all; metres.
const WORST_GAP: f32 = 0.03;
/// Cost of a change of size by the factor e, in metres of mean gap.
const COST_OF_SCALE: f32 = 0.015;
/// A sphere describes the roots well if they lie within this fraction of its radius.
const ROUND: f32 = 0.12;
/// Roots are centred about the plane x = 0 if their mean is within this fraction of their width from it.
const CENTRED: f32 = 0.1;

/// `head = scale * axes + shift`, where `axes` is the groom in metres and head axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    pub(super) scale: f32,
    pub(super) shift: Vec3,
}

/// Fits roots (metres, head axes, any origin) to the part of the scalp where hair grows.
pub(super) fn fit(roots: &[Vec3], skin: &Surface, may_scale: bool) -> Fit {
    let roots: Vec<Vec3> = roots.iter().step_by(roots.len().div_ceil(ROOTS).max(1)).copied().collect();
    let of_roots = RootShape::of_points(&roots);
    let of_skin = RootShape::of_points(&skin.corners().collect::<Vec<_>>());
    // Grooms are modelled about the plane x = 0. Roots that are centred about it are fitted with it in the middle of
    // the head.
    let mean_x = roots.iter().map(|root| root.x).sum::<f32>() / roots.len() as f32;
    let held_x = (mean_x.abs() < CENTRED * of_roots.bounds.size().x).then_some(of_skin.bounds.centre().x);
    let starts = starts(&of_roots, &of_skin, may_scale);
    let fits: Vec<(f32, Fit)> =
        starts.into_par_iter().map(|start| improve(&roots, skin, start, may_scale, held_x)).collect();
    let mut best = fits[0];
    for &(cost, fit) in &fits[1..] {
        if cost < best.0 {
            best = (cost, fit);
        }
    }
    best.1
}

/// Starting values: the groom's own size, the size from its sphere, the size from its box.
fn starts(of_roots: &RootShape, of_skin: &RootShape, may_scale: bool) -> Vec<Fit> {
    let spheres = match (of_roots.sphere, of_skin.sphere) {
        (Some(roots), Some(skin)) if roots.residual < ROUND => Some((roots, skin)),
        _ => None,
    };
    // Aligns the crowns in height, and the centres in the other axes.
    let by_box = |scale: f32| {
        let (roots, skin) = (of_roots.bounds, of_skin.bounds);
        let mut shift = skin.centre() - scale * roots.centre();
        shift.y = skin.max.y - scale * roots.max.y;
        Fit { scale, shift }
    };
    let by_sphere =
        |scale: f32| spheres.map(|(roots, skin)| Fit { scale, shift: skin.centre - scale * roots.centre });
    let mut starts = vec![by_box(1.0)];
    starts.extend(by_sphere(1.0));
    if may_scale {
        starts.extend(spheres.and_then(|(roots, skin)| by_sphere(skin.radius / roots.radius)));
        let longest = of_roots.bounds.size().max_element();
        if longest > 0.0 {
            starts.push(by_box(of_skin.bounds.size().max_element() / longest));
        }
    }
    starts
}

/// Iterates from one start; returns the cost and the result.
fn improve(roots: &[Vec3], skin: &Surface, start: Fit, may_scale: bool, held_x: Option<f32>) -> (f32, Fit) {
    let mut fit = start;
    fit.shift.x = held_x.unwrap_or(fit.shift.x);
    let mut gaps = vec![0.0; roots.len()];
    let mut targets = vec![Vec3::ZERO; roots.len()];
    let mut measure = |fit: &Fit, targets: &mut [Vec3]| {
        for ((&root, target), gap) in roots.iter().zip(targets).zip(&mut gaps) {
            let placed = fit.scale * root + fit.shift;
            *target = skin.closest(placed);
            *gap = placed.distance(*target);
        }
        gaps.clone()
    };
    for _ in 0..STEPS {
        let gaps = measure(&fit, &mut targets);
        let mut sorted = gaps.clone();
        let last = ((TRUSTED * roots.len() as f32) as usize).min(roots.len() - 1);
        let limit = *sorted.select_nth_unstable_by(last, f32::total_cmp).1;
        let trusted =
            || roots.iter().zip(&targets).zip(&gaps).filter(|(_, gap)| **gap <= limit).map(|(pair, _)| pair);
        let count = trusted().count() as f32;
        let mean_root = trusted().map(|(root, _)| *root).sum::<Vec3>() / count;
        let mean_target = trusted().map(|(_, target)| *target).sum::<Vec3>() / count;
        let (mut along, mut square) = (0.0, 0.0);
        for (root, target) in trusted() {
            let from_mean = *root - mean_root;
            along += from_mean.dot(*target - mean_target);
            square += from_mean.length_squared();
        }
        if may_scale && square > 0.0 {
            let least_squares = along / square;
            // The scale never crosses zero, which would turn the groom inside out.
            fit.scale = ((least_squares + HOLD * start.scale) / (1.0 + HOLD))
                .clamp(0.5 * start.scale, 2.0 * start.scale);
        }
        fit.shift = mean_target - fit.scale * mean_root;
        fit.shift.x = held_x.unwrap_or(fit.shift.x);
    }
    let gaps = measure(&fit, &mut targets);
    let gap = gaps.iter().map(|gap| gap.min(WORST_GAP)).sum::<f32>() / gaps.len() as f32;
    let cost = gap + COST_OF_SCALE * fit.scale.ln().abs();
    (if cost.is_finite() { cost } else { f32::INFINITY }, fit)
}
