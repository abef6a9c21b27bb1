//! The curve and the moving frame of a wisp: the maths that every strand shares.
//!
//! Guides are uniform Catmull-Rom curves of parameter `u` in links, whose end segments use reflected phantom
//! points (`2 p0 - p1`), so that the ends are reached with a tangent along the last link. Weights blend control
//! points, which is the same as blending the curves, since a Catmull-Rom curve is linear in its control points.
//!
//! The frame is carried along the mean of the wisp's guides by the smallest rotation from tangent to tangent
//! (parallel transport). At the root it is the frame of the rest shape turned with the head, whatever the guides
//! do: roots and their offsets therefore stay on the moving scalp exactly, and the frame cannot flip from one
//! instant to the next.

use glam::{Affine3A, Mat3, Vec3, Vec3A};

use crate::{Guides, Wisp};

/// The three guides of one wisp at one instant, ready to be evaluated.
///
/// Made once and reused: [`WispCurve::place`] keeps its buffers.
#[derive(Clone, Debug, Default)]
pub struct WispCurve {
    /// Control points of the three guides side by side, one a guide point.
    controls: Vec<[Vec3A; 3]>,
    /// Unit normal of the frame, one a guide point.
    pub(crate) normals: Vec<Vec3A>,
    /// Unit tangent of the frame, one a guide point.
    pub(crate) tangents: Vec<Vec3A>,
}

impl WispCurve {
    /// The curve of `wisp` at rest, in head space.
    pub fn at_rest(rest: &Guides, wisp: &Wisp) -> Self {
        let mut curve = Self::default();
        curve.place(rest, wisp, rest, Affine3A::IDENTITY);
        curve
    }

    /// Makes this the curve of `wisp` at one instant.
    ///
    /// `rest` holds the guides at rest in head space; `moved` the same guides in world space (or in head space,
    /// with the identity as `world_from_head`). A wisp needs guides of at least 2 points.
    pub fn place(&mut self, rest: &Guides, wisp: &Wisp, moved: &Guides, world_from_head: Affine3A) {
        let points = moved.points_per_guide;
        assert!(points >= 2, "a guide needs at least 2 points");
        let guides = wisp.guides.map(|g| g as usize);
        self.controls.clear();
        self.controls
            .extend((0..points).map(|p| guides.map(|g| Vec3A::from(moved.point(g, p)))));

        let mean = |p: usize| (self.controls[p][0] + self.controls[p][1] + self.controls[p][2]) / 3.0;
        let rest_mean = |p: usize| {
            guides
                .iter()
                .map(|&g| Vec3A::from(rest.point(g, p)))
                .sum::<Vec3A>()
                / 3.0
        };
        let root_tangent = (rest_mean(1) - rest_mean(0)).normalize_or(Vec3A::Y);
        let mut tangent = world_from_head.transform_vector3a(root_tangent);
        let mut normal = world_from_head.transform_vector3a(reference_normal(root_tangent));
        self.tangents.clear();
        self.normals.clear();
        self.tangents.push(tangent);
        self.normals.push(normal);
        for p in 1..points {
            let chord = mean((p + 1).min(points - 1)) - mean(p - 1);
            let next = chord.normalize_or(tangent);
            normal = transport(normal, tangent, next);
            tangent = next;
            self.tangents.push(tangent);
            self.normals.push(normal);
        }
    }

    /// Points of one guide.
    pub fn points_per_guide(&self) -> usize {
        self.controls.len()
    }

    /// The guides' curves at `u` (in links, clamped to the curve), blended by `weights`; metres.
    pub fn blend(&self, weights: [f32; 3], u: f32) -> Vec3 {
        let last = self.controls.len() - 1;
        let (p, t) = locate(u, last);
        let at = |i: usize| mix(&self.controls[i], weights);
        let (a, b) = (at(p), at(p + 1));
        let before = if p > 0 { at(p - 1) } else { 2.0 * a - b };
        let after = if p + 2 <= last { at(p + 2) } else { 2.0 * b - a };
        catmull_rom([before, a, b, after], t).into()
    }

    /// The frame at `u`: an exactly orthonormal, right-handed matrix of columns normal, binormal, tangent, whose
    /// transpose turns a displacement into an offset.
    pub fn frame(&self, u: f32) -> Mat3 {
        let (p, t) = locate(u, self.controls.len() - 1);
        let (normal, binormal, tangent) = self.axes(p, t);
        Mat3::from_cols(normal.into(), binormal.into(), tangent.into())
    }

    /// A strand's point: `blend(weights, u) + frame(u) * offset`.
    pub fn point(&self, weights: [f32; 3], u: f32, offset: Vec3) -> Vec3 {
        self.blend(weights, u) + self.frame(u) * offset
    }

    /// The offset that carries the blended curve at `u` to `point`: the inverse of [`WispCurve::point`].
    pub fn offset_to(&self, weights: [f32; 3], u: f32, point: Vec3) -> Vec3 {
        self.frame(u).transpose() * (point - self.blend(weights, u))
    }

    /// Control points blended by `weights` into `out`, with the phantom points before and after.
    pub(crate) fn blend_controls(&self, weights: [f32; 3], out: &mut Vec<Vec3A>) {
        out.clear();
        out.push(Vec3A::ZERO);
        out.extend(self.controls.iter().map(|c| mix(c, weights)));
        let n = out.len();
        out[0] = 2.0 * out[1] - out[2];
        out.push(2.0 * out[n - 1] - out[n - 2]);
    }

    /// Normal, binormal, tangent at the fraction `t` of link `p`.
    #[inline]
    pub(crate) fn axes(&self, p: usize, t: f32) -> (Vec3A, Vec3A, Vec3A) {
        orthonormal(
            self.tangents[p] + (self.tangents[p + 1] - self.tangents[p]) * t,
            self.normals[p] + (self.normals[p + 1] - self.normals[p]) * t,
        )
    }
}

/// The link and the fraction of it at parameter `u` of a curve of `last` links.
#[inline]
pub(crate) fn locate(u: f32, last: usize) -> (usize, f32) {
    let u = u.max(0.0).min(last as f32);
    let p = (u as usize).min(last - 1);
    (p, u - p as f32)
}

/// A point of the uniform Catmull-Rom segment between `c[1]` and `c[2]`.
#[inline]
pub(crate) fn catmull_rom(c: [Vec3A; 4], t: f32) -> Vec3A {
    let (t2, t3) = (t * t, t * t * t);
    c[0] * (-0.5 * t + t2 - 0.5 * t3)
        + c[1] * (1.0 - 2.5 * t2 + 1.5 * t3)
        + c[2] * (0.5 * t + 2.0 * t2 - 1.5 * t3)
        + c[3] * (0.5 * t3 - 0.5 * t2)
}

#[inline]
fn mix(controls: &[Vec3A; 3], w: [f32; 3]) -> Vec3A {
    controls[0] * w[0] + controls[1] * w[1] + controls[2] * w[2]
}

/// Gram-Schmidt: unit normal, binormal and tangent. Interpolated tangents and normals of neighbouring guide
/// points vanish only where a guide folds back on itself; the axes are finite even there.
#[inline]
fn orthonormal(tangent: Vec3A, normal: Vec3A) -> (Vec3A, Vec3A, Vec3A) {
    let tt = tangent.dot(tangent);
    if tt < 1e-12 {
        return folded(normal);
    }
    let tangent = tangent * (1.0 / tt.sqrt());
    let across = normal - tangent * normal.dot(tangent);
    let nn = across.dot(across);
    if nn < 1e-12 {
        return folded(tangent);
    }
    let normal = across * (1.0 / nn.sqrt());
    (normal, tangent.cross(normal), tangent)
}

/// Any orthonormal axes for the degenerate middle of a fold, about `axis` where it has a length.
#[cold]
fn folded(axis: Vec3A) -> (Vec3A, Vec3A, Vec3A) {
    let tangent = axis.normalize_or(Vec3A::Y);
    let normal = reference_normal(tangent);
    (normal, tangent.cross(normal), tangent)
}

/// A unit vector square to the unit vector `tangent`, made from the axis least along it.
pub(crate) fn reference_normal(tangent: Vec3A) -> Vec3A {
    let size = tangent.abs();
    let axis = if size.x <= size.y && size.x <= size.z {
        Vec3A::X
    } else if size.y <= size.z {
        Vec3A::Y
    } else {
        Vec3A::Z
    };
    (axis - tangent * axis.dot(tangent)).normalize_or(Vec3A::X)
}

/// Carries `normal`, square to the unit vector `from`, by the smallest rotation from `from` to the unit vector
/// `to`. Where they oppose, the rotation is the half turn about the normal itself.
pub(crate) fn transport(normal: Vec3A, from: Vec3A, to: Vec3A) -> Vec3A {
    let one_plus_cos = 1.0 + from.dot(to);
    let turned = if one_plus_cos > 1e-6 {
        normal - (from + to) * (normal.dot(to) / one_plus_cos)
    } else {
        normal
    };
    (turned - to * turned.dot(to)).normalize_or(reference_normal(to))
}
