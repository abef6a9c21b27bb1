//! The shapes that a body gets, and their initial placement.

use glam::{Affine3A, Mat3A, Vec3};
use lovelock_base::statistics::lower_quantile;

use super::{
    groups::{Kind, Part, parts},
    refine::{Fit, refine},
    shape::signed_distance,
};
use crate::{Body, Collider, ColliderShape};

/// Distance of the skull's shape below the scalp, so that hair is rooted outside it, metres.
const SKULL_INSET: f32 = 0.002;
/// Name of the shape below the scalp.
const SKULL: &str = "skull";
/// Distance of other shapes below the skin, metres.
const SKIN_INSET: f32 = 0.001;
/// Share of the vertices with hair from which a part is no head but a whole skin with fur: any shape around it
/// would hold roots of hair, and the distance field of the skin does without shapes.
const FURRED: f32 = 0.8;
/// Largest height of a slice of the trunk, metres.
const SLICE: f32 = 0.13;
/// Most slices of a part of the trunk, and of a figure without joints.
const MAX_SLICES: usize = 4;
const MAX_SLICES_OF_WHOLE: usize = 12;
/// How deep the head of a figure without joints may be in the shapes of the rest, metres.
const HEAD_IN_BODY: f32 = 0.002;
/// Largest number of vertices used by the refinement.
const POINTS: usize = 6_000;

/// Fits spheres, capsules and ellipsoids to the resting surface of a body, first part by part and then all
/// together.
///
/// Each vertex belongs to the joint with the largest weight. The skull is an ellipsoid slightly below the
/// scalp; face, neck, shoulders and limbs are tapered capsules; the trunk consists of horizontal capsules.
/// The order of the result is fixed, head first.
pub fn fit_colliders(body: &Body) -> Vec<Collider> {
    let parts = parts(body);
    let mut labels: Vec<(String, usize)> = Vec::new();
    let mut fits: Vec<Fit> = Vec::new();
    for part in &parts {
        let shapes = match part.kind {
            Kind::Head => head_shapes(part),
            Kind::Trunk => slices(part, &part.points, MAX_SLICES),
            Kind::Whole => slices(part, &below_head(part), MAX_SLICES_OF_WHOLE),
            Kind::Ignored => Vec::new(),
            Kind::Neck | Kind::Limb => vec![(part.name.clone(), limb(part), SKIN_INSET)],
        };
        for (name, shape, inset) in shapes {
            // The skull is fitted to the scalp alone; points of ears and neck would distort it.
            fits.push(Fit { shape, inset, fixed: name == SKULL });
            labels.push((name, part.joint));
        }
    }
    let count: usize = parts.iter().map(|p| p.points.len()).sum();
    let step = count.div_ceil(POINTS).max(1);
    let points: Vec<Vec3> = parts.iter().flat_map(|p| &p.points).step_by(step).copied().collect();
    refine(&mut fits, &points, 14);
    if let [head, Part { kind: Kind::Whole, end: Some(neck), joint, .. }] = &parts[..] {
        let above = |p: &&Vec3| p.y > neck.y;
        let below = fits.iter_mut().zip(&labels).filter(|(_, (_, of))| of == joint);
        below.for_each(|(fit, _)| keep_out(&mut fit.shape, head.points.iter().filter(above)));
    }
    let named = labels.into_iter().zip(fits);
    named.map(|((name, joint), fit)| Collider { name, joint, shape_at_rest: fit.shape }).collect()
}

/// Skull, face and jaw.
fn head_shapes(part: &Part) -> Vec<(String, ColliderShape, f32)> {
    let scalp: Vec<Vec3> =
        part.points.iter().zip(&part.scalp).filter(|(_, s)| **s > 0.5).map(|(p, _)| *p).collect();
    if scalp.len() as f32 > FURRED * part.points.len() as f32 {
        return Vec::new();
    }
    let (low, high) = (percentile(&part.points, 0.05), percentile(&part.points, 0.95));
    let fitted = if scalp.len() < 24 { None } else { skull(&scalp) };
    // Heads of animals and machines: an ellipsoid around everything.
    // A scalp that is a sheet, such as a lawn, lies on a ball that is larger than all of the part.
    let fits = |half: Vec3| half.cmpge(0.25 * (high - low)).all() && half.cmple(high - low).all();
    let Some((centre, half)) = fitted.filter(|(c, half)| fits(*half) && part.contains(*c)) else {
        return vec![("head".into(), ellipsoid(0.5 * (low + high), 0.5 * (high - low)), SKULL_INSET)];
    };
    let mut shapes = vec![(SKULL.into(), ellipsoid(centre, half), SKULL_INSET)];
    // The face: from the cheeks to the jaw, in front of the centre of the skull and below it.
    let face: Vec<Vec3> = part
        .points
        .iter()
        .zip(&part.scalp)
        .filter(|(p, s)| **s < 0.1 && p.z > centre.z - 0.1 * half.z && p.y < centre.y)
        .map(|(p, _)| *p)
        .collect();
    if face.len() >= 12 {
        let (low, high) = (percentile(&face, 0.05), percentile(&face, 0.95));
        let width = 0.5 * (high.x - low.x);
        let cheeks = 0.8 * width;
        let chin = 0.45 * width;
        let front = high.z;
        shapes.push((
            "face".into(),
            capsule(
                Vec3::new(centre.x, centre.y - 0.15 * half.y, front - cheeks),
                Vec3::new(centre.x, low.y + chin, front - 1.15 * chin),
                cheeks,
                chin,
            ),
            SKIN_INSET,
        ));
        for (name, sign) in [("jaw left", 1.0), ("jaw right", -1.0)] {
            // From below the ear to the chin.
            let back = Vec3::new(
                centre.x + sign * 0.55 * width,
                low.y + 0.5 * (centre.y - low.y),
                centre.z + 0.1 * half.z,
            );
            let tip = Vec3::new(centre.x + sign * 0.2 * width, low.y + chin, front - 1.3 * chin);
            shapes.push((name.into(), capsule(back, tip, 0.3 * width, 0.8 * chin), SKIN_INSET));
        }
    }
    shapes
}

/// Centre and radii of an axis-aligned ellipsoid through the scalp, by linear least squares on
/// `A x² + B y² + C z² + D x + E y + F z = 1`.
fn skull(scalp: &[Vec3]) -> Option<(Vec3, Vec3)> {
    let (middle, half) = bounds(scalp);
    let size = half.max_element().max(1e-3);
    let mut normal = [[0.0_f64; 6]; 6];
    let mut right = [0.0_f64; 6];
    for p in scalp {
        // Centred and scaled, to limit rounding errors.
        let q = ((*p - middle) / size).as_dvec3();
        let row = [q.x * q.x, q.y * q.y, q.z * q.z, q.x, q.y, q.z];
        for i in 0..6 {
            right[i] += row[i];
            for j in 0..6 {
                normal[i][j] += row[i] * row[j];
            }
        }
    }
    for (i, row) in normal.iter_mut().enumerate() {
        row[i] += 1e-6 * scalp.len() as f64;
    }
    let fitted = super::refine::solve(normal, right).and_then(|[a, b, c, d, e, f]| {
        if a.min(b).min(c) <= 0.0 {
            return None;
        }
        let centre = glam::DVec3::new(-d / (2.0 * a), -e / (2.0 * b), -f / (2.0 * c));
        let level = 1.0 + a * centre.x * centre.x + b * centre.y * centre.y + c * centre.z * centre.z;
        let radii = glam::DVec3::new(level / a, level / b, level / c).map(f64::sqrt);
        let (centre, radii) = (middle + centre.as_vec3() * size, radii.as_vec3() * size);
        // A nearly flat scalp may fit a giant ellipsoid.
        (radii.is_finite() && radii.max_element() < 2.0 * size && centre.distance(middle) < size)
            .then_some((centre, radii))
    });
    let (centre, radii) = fitted?;
    // Shrinks it until it lies below the scalp, except for the deepest twentieth.
    let mut depths: Vec<f32> = scalp.iter().map(|&p| signed_distance(&ellipsoid(centre, radii), p)).collect();
    depths.sort_by(f32::total_cmp);
    let lift = depths[depths.len() / 20].clamp(-3.0 * SKULL_INSET, 0.0);
    Some((centre, radii + (lift.min(-SKULL_INSET))))
}

/// The points of a figure without joints that are not beside its head, as raised arms are.
fn below_head(part: &Part) -> Vec<Vec3> {
    let top = part.end.map_or(f32::INFINITY, |neck| neck.y);
    part.points.iter().copied().filter(|p| p.y < top).collect()
}

/// Shrinks a capsule until no point is deep in it.
fn keep_out<'a>(shape: &mut ColliderShape, points: impl Iterator<Item = &'a Vec3>) {
    let depth = points.map(|&p| -signed_distance(shape, p)).fold(0.0, f32::max) - HEAD_IN_BODY;
    if let ColliderShape::Capsule { radius_a, radius_b, .. } = shape
        && depth > 0.0
    {
        (*radius_a, *radius_b) = ((*radius_a - depth).max(1e-3), (*radius_b - depth).max(1e-3));
    }
}

/// Horizontal capsules across some points of a part, one per slice.
fn slices(part: &Part, points: &[Vec3], most: usize) -> Vec<(String, ColliderShape, f32)> {
    let (low, high) = (percentile(points, 0.02), percentile(points, 0.98));
    let slices = ((high.y - low.y) / SLICE).ceil().clamp(1.0, most as f32) as usize;
    (0..slices)
        .filter_map(|i| {
            let bottom = low.y + (high.y - low.y) * i as f32 / slices as f32;
            let top = low.y + (high.y - low.y) * (i + 1) as f32 / slices as f32;
            let slice: Vec<Vec3> = points.iter().copied().filter(|p| (bottom..=top).contains(&p.y)).collect();
            // A few stray vertices do not make a slice.
            if slice.len() < 12 || slice.len() * (3 * slices).max(12) < points.len() {
                return None;
            }
            let (a, b) = (percentile(&slice, 0.04), percentile(&slice, 0.96));
            let (centre, half) = (0.5 * (a + b), 0.5 * (b - a));
            let radius = half.z.min(half.x).max(1e-3);
            let reach = Vec3::X * (half.x - radius).max(1e-3);
            let name = if slices == 1 { part.name.clone() } else { format!("{} slice {}", part.name, i + 1) };
            Some((name, capsule(centre - reach, centre + reach, radius, radius), SKIN_INSET))
        })
        .collect()
}

/// A tapered capsule along a bone; its radii are the median distances in the nearer and the farther half.
fn limb(part: &Part) -> ColliderShape {
    let points = &part.points;
    if let (Some(begin), Some(end)) = (part.begin, part.end) {
        // A shoulder: along the slope from the neck to the arm, thin enough to start below the skin.
        let length = begin.distance(end);
        return capsule(begin.lerp(end, 0.3), begin.lerp(end, 0.85), 0.3 * length, 0.25 * length);
    }
    let mean = points.iter().sum::<Vec3>() / points.len() as f32;
    let direction =
        part.end.map_or_else(|| principal_axis(points, mean), |end| (end - mean).normalize_or(Vec3::Y));
    let along = |p: &Vec3| (*p - mean).dot(direction);
    let mut places: Vec<f32> = points.iter().map(along).collect();
    places.sort_by(f32::total_cmp);
    let (from, to) = (places[places.len() / 20], places[places.len() - 1 - places.len() / 20]);
    let radius = |near: bool| {
        let half = points.iter().filter(|p| (along(p) < 0.5 * (from + to)) == near);
        let mut radii: Vec<f32> = half.map(|p| (*p - mean - direction * along(p)).length()).collect();
        radii.sort_by(f32::total_cmp);
        radii.get(radii.len() / 2).copied().unwrap_or(0.01).max(1e-3)
    };
    let (near, far) = (radius(true), radius(false));
    // The round ends extend beyond the centres, so the centres are moved inward by a part of the radius.
    let (a, b) = (from + 0.5 * near, to - 0.5 * far);
    let (a, b) = if a < b { (a, b) } else { (0.5 * (a + b), 0.5 * (a + b)) };
    capsule(mean + direction * a, mean + direction * b, near, far)
}

/// Direction of the largest spread of the points, by power iteration on their covariance.
fn principal_axis(points: &[Vec3], mean: Vec3) -> Vec3 {
    let mut covariance = Mat3A::ZERO;
    for p in points {
        let d = *p - mean;
        covariance += Mat3A::from_cols((d * d.x).into(), (d * d.y).into(), (d * d.z).into());
    }
    let mut axis = glam::Vec3A::new(0.577, 0.578, 0.576);
    for _ in 0..32 {
        axis = (covariance * axis).normalize_or(glam::Vec3A::Y);
    }
    axis.into()
}

fn capsule(a: Vec3, b: Vec3, radius_a: f32, radius_b: f32) -> ColliderShape {
    ColliderShape::Capsule { a, b, radius_a, radius_b }
}

fn ellipsoid(centre: Vec3, radii: Vec3) -> ColliderShape {
    ColliderShape::Ellipsoid {
        from_unit: Affine3A::from_scale_rotation_translation(
            radii.max(Vec3::splat(1e-3)),
            glam::Quat::IDENTITY,
            centre,
        ),
    }
}

fn bounds(points: &[Vec3]) -> (Vec3, Vec3) {
    let low = points.iter().fold(Vec3::INFINITY, |a, &b| a.min(b));
    let high = points.iter().fold(Vec3::NEG_INFINITY, |a, &b| a.max(b));
    (0.5 * (low + high), 0.5 * (high - low))
}

/// A quantile along each axis separately.
fn percentile(points: &[Vec3], quantile: f32) -> Vec3 {
    let along = |axis: usize| {
        let mut values: Vec<f32> = points.iter().map(|p| p[axis]).collect();
        lower_quantile(&mut values, quantile).unwrap_or_default()
    };
    Vec3::new(along(0), along(1), along(2))
}
