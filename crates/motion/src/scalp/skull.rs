//! The skull within a head: the largest ball that fits, and the ellipsoid around the skin above it.

use glam::{DMat4, DVec3, DVec4, UVec3, Vec3};
use rayon::prelude::*;

/// The signed distance of a body, in head space, metres; negative inside.
pub(super) type Distance<'a> = &'a (dyn Fn(Vec3) -> f32 + Sync);

/// Half the size of the skull of the shipped dancer, metres. Hair of the usual size belongs to it.
pub(super) const USUAL: Vec3 = Vec3::new(0.0777, 0.0749, 0.0959);

/// Samples along the longest side of the head in search of the ball.
const SAMPLES: f32 = 18.0;
/// A ball smaller than this fraction of the head's longest side is no skull: the skin is a sheet, or open.
const SMALLEST: f32 = 0.07;
/// The farthest that the middle of the skull is below the top of a figure without joints, in radii of the ball.
const BELOW_TOP: f32 = 1.8;
/// The part of the height of a figure without joints in which its head is.
const TOP: f32 = 0.2;
/// Skin farther from the middle than this, in radii of the ball, belongs to something else.
const FAR: f32 = 2.0;

/// An ellipsoid that stands for the skull, without neck, nose and ears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skull {
    /// Its middle, head space, metres.
    pub middle: Vec3,
    /// Half of its size, metres.
    pub half: Vec3,
}

impl Skull {
    /// A skull of this height with the proportions of the shipped dancer's.
    pub(super) fn of_height(middle: Vec3, height: f32) -> Self {
        Self { middle, half: USUAL * (0.5 * height / USUAL.y) }
    }

    /// A place relative to the skull: its surface is at a distance of 1. x is toward the wearer's left, y up, z toward the face.
    pub fn relative(&self, place: Vec3) -> Vec3 {
        (place - self.middle) / self.half
    }

    /// The place with these relative coordinates.
    pub fn place(&self, relative: Vec3) -> Vec3 {
        self.middle + relative * self.half
    }

    /// The size of the skull as a multiple of that of the shipped dancer.
    pub fn scale(&self) -> f32 {
        ((self.half / USUAL).element_product()).cbrt()
    }

    /// Finds the skull in a head with these vertices. `alone` says that the vertices may also be those of a whole figure, whose head is
    /// at its top. `None` where the skin encloses no skull.
    pub(super) fn find(head: &[Vec3], alone: bool, distance: Distance<'_>) -> Option<Self> {
        Self::within(head, alone, distance).or_else(|| {
            // Beside a whole figure its head is small, so the search is repeated at its top.
            let (low, high) = bounds(head).filter(|_| alone)?;
            let least = high.y - TOP * (high.y - low.y);
            let top: Vec<Vec3> = head.iter().copied().filter(|p| p.y > least).collect();
            Self::within(&top, alone, distance)
        })
    }

    fn within(head: &[Vec3], alone: bool, distance: Distance<'_>) -> Option<Self> {
        let (low, high) = bounds(head)?;
        let size = (high - low).max_element();
        let step = size / SAMPLES;
        let counts = ((high - low) / step).ceil().as_uvec3().max(UVec3::ONE);
        let depth = |p: Vec3| {
            // Within the head, so that it lies in no neck behind it.
            let depth = (-distance(p)).min(1.05 * (p - low).min(high - p).min_element());
            // A figure without joints: the head is what is near its top.
            let too_low = alone && high.y - p.y > BELOW_TOP * depth;
            if too_low || !depth.is_finite() { f32::NEG_INFINITY } else { depth }
        };
        let place = |i: u32| {
            let [x, y, z] = [i % counts.x, i / counts.x % counts.y, i / counts.x / counts.y];
            low + (UVec3::new(x, y, z).as_vec3() + 0.5) * (high - low) / counts.as_vec3()
        };
        let deepest = (0..counts.element_product()).into_par_iter().map(|i| (depth(place(i)), i)).reduce(
            || (f32::NEG_INFINITY, u32::MAX),
            |a, b| if b.0 > a.0 || (b.0 == a.0 && b.1 < a.1) { b } else { a },
        );
        let (mut radius, mut middle) = (deepest.0, place(deepest.1.min(counts.element_product() - 1)));
        let mut by = step;
        while by > 0.01 * step {
            let better = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z]
                .into_iter()
                .map(|to| middle + to * by)
                .map(|p| (depth(p), p))
                .filter(|(d, _)| *d > radius)
                .max_by(|a, b| a.0.total_cmp(&b.0));
            match better {
                Some((d, p)) => (radius, middle) = (d, p),
                None => by *= 0.5,
            }
        }
        if radius.is_nan() || radius <= SMALLEST * size {
            return None;
        }
        let mut skull = Self { middle, half: Vec3::splat(radius) };
        for _ in 0..3 {
            skull = skull.around(radius, distance);
        }
        Some(skull)
    }

    /// The ellipsoid around the skin above the middle: least squares, without what stands out.
    fn around(mut self, radius: f32, distance: Distance<'_>) -> Self {
        let beside = |to: Vec3| surface(self.middle, to, FAR * radius, distance);
        if let Some((left, right)) = beside(Vec3::X).zip(beside(Vec3::NEG_X)) {
            self.middle.x += 0.5 * (left - right);
        }
        let mut points: Vec<Vec3> = (0..400)
            .map(|i| {
                // Directions spread over the sphere, of which the upper part is used.
                let (y, turn) = (1.0 - (i as f32 + 0.5) / 400.0 * 1.15, i as f32 * 2.399_963);
                let across = (1.0 - y * y).max(0.0).sqrt();
                Vec3::new(across * turn.sin(), y, across * turn.cos())
            })
            .filter_map(|d| Some(d * surface(self.middle, d, FAR * radius, distance)? / radius))
            .collect();
        let mut found = None;
        for _ in 0..4 {
            let Some(fit) = ellipsoid(&points) else { break };
            found = Some(fit);
            let (at, half): (Vec3, Vec3) = fit;
            points.retain(|p| (((*p - at) / half).length() - 1.0).abs() < 0.2);
        }
        let Some((at, half)) = found else { return self };
        let at = at.clamp(Vec3::splat(-0.5), Vec3::splat(0.5));
        Self {
            middle: self.middle + at * radius,
            half: half.clamp(Vec3::splat(0.8), Vec3::splat(1.8)) * radius,
        }
    }
}

/// Distance from `from` along the unit vector `direction` to the outermost skin within `reach`; `None` if the body goes on there, or
/// has no skin.
pub(super) fn surface(from: Vec3, direction: Vec3, reach: f32, distance: Distance<'_>) -> Option<f32> {
    let mut t = reach;
    let least = 1e-4 * reach;
    for step in 0..200 {
        let d = distance(from + direction * t);
        if d <= least {
            return (step > 0).then_some(t);
        }
        t -= d;
        if t.is_nan() || t <= 0.0 {
            break;
        }
    }
    None
}

/// Middle and half of the size of the ellipsoid with axes along x, y and z through points, whose middle is at the height 0; least
/// squares. `None` if the points lie on no ellipsoid.
fn ellipsoid(points: &[Vec3]) -> Option<(Vec3, Vec3)> {
    if points.len() < 40 {
        return None;
    }
    // qx x² + qy y² + qz z² + l z = 1. Heads are even on both sides.
    let (mut normal, mut right) = (DMat4::ZERO, DVec4::ZERO);
    for p in points {
        let p = p.as_dvec3();
        let row = DVec4::new(p.x * p.x, p.y * p.y, p.z * p.z, p.z);
        normal += DMat4::from_cols(row * row.x, row * row.y, row * row.z, row * row.w);
        right += row;
    }
    if normal.determinant().abs() < 1e-9 {
        return None;
    }
    let q = normal.inverse() * right;
    let least = q.truncate().min_element();
    if least.is_nan() || least <= 1e-3 {
        return None;
    }
    let z = -0.5 * q.w / q.z;
    let total = 1.0 + q.z * z * z;
    let half = (DVec3::splat(total) / q.truncate()).map(f64::sqrt);
    half.is_finite().then(|| (Vec3::new(0.0, 0.0, z as f32), half.as_vec3()))
}

fn bounds(points: &[Vec3]) -> Option<(Vec3, Vec3)> {
    let finite = points.iter().copied().filter(|p| p.is_finite());
    let (low, high) = finite.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
    let size = (high - low).max_element();
    (size.is_finite() && size > 0.0).then_some((low, high))
}
