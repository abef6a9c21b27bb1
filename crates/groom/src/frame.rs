//! The curve and the moving frame of a wisp, which all its strands share.
//!
//! Guides are uniform Catmull-Rom curves whose parameter `u` counts links. The end segments use reflected phantom
//! points (`2 p0 - p1`), so that the curve reaches its ends with a tangent along the last link. Weights blend control
//! points, which equals blending the curves, because a Catmull-Rom curve is linear in its control points.
//!
//! The frame is carried along the mean of the wisp's guides by parallel transport: the smallest rotation from tangent
//! to tangent. At the root it is the frame of the rest shape, rotated with the head, whatever the guides do. Roots and
//! their offsets therefore stay exactly on the moving scalp, and the frame cannot flip between frames.
#![allow(clippy::inline_always, reason = "interpolation is compiled for several widths of vectors")]

use glam::{Affine3A, Mat3, Vec3, Vec3A};

use crate::{Guides, Wisp};

/// The three guides of one wisp at one instant, ready for evaluation.
///
/// Reusable: [`WispCurve::place`] keeps its buffers.
#[derive(Clone, Debug, Default)]
pub struct WispCurve {
    /// Control points of the three guides side by side, one entry per guide point.
    controls: Vec<[Vec3A; 3]>,
    /// The frame along each link.
    links: Vec<Link>,
}

/// The frame's tangent and normal at the root end of a link, and how they change to its tip end.
#[derive(Clone, Copy, Debug)]
struct Link {
    tangent: [f32; 3],
    tangent_change: [f32; 3],
    normal: [f32; 3],
    normal_change: [f32; 3],
}

/// A wisp may become this much wider than at rest before its strands are kept together.
const WIDER: f32 = 1.5;

/// A wisp is at least this wide, metres: so narrow hair may open a little.
const LEAST_RADIUS: f32 = 0.004;

/// Root mean square distance of the guides of a wisp from their mean, and the mean.
#[inline]
fn radius(of: &[Vec3A; 3]) -> (f32, Vec3A) {
    let mean = (of[0] + of[1] + of[2]) / 3.0;
    let squares = of.map(|p| (p - mean).length_squared());
    (((squares[0] + squares[1] + squares[2]) / 3.0).sqrt(), mean)
}

/// The radius up to which the guides of each wisp may open at each of their points, metres, in the layout of [`Guides`].
/// Without a limit where a guide belongs to no wisp.
pub fn widest_radii(rest: &Guides, wisps: &[Wisp]) -> Vec<f32> {
    let mut out = vec![f32::MAX; rest.x.len()];
    let points = rest.points_per_guide;
    for wisp in wisps {
        for p in 0..points {
            let of = wisp.guides.map(|g| Vec3A::from(rest.point(g as usize, p)));
            let widest = WIDER * radius(&of).0.max(LEAST_RADIUS);
            for g in wisp.guides {
                out[g as usize * points + p] = widest;
            }
        }
    }
    out
}

/// The limit of a wisp at point `p` of `points`; none if `widest` is empty.
#[inline]
fn widest_at(widest: &[f32], wisp: &Wisp, p: usize, points: usize) -> f32 {
    widest.get(wisp.guides[0] as usize * points + p).copied().unwrap_or(f32::MAX)
}

/// The guides of a wisp, moved toward their mean if they are further apart than `widest`.
///
/// A strand's weights sum to 1, so this is the same as pulling the weights toward 1/3: a wisp whose guides have parted, in
/// an old take or in a file, stays one lock.
#[inline]
fn narrowed(of: [Vec3A; 3], widest: f32) -> [Vec3A; 3] {
    let (radius, mean) = radius(&of);
    // False for NaN.
    if radius > widest { of.map(|p| mean + (p - mean) * (widest / radius)) } else { of }
}

/// The guides of a wisp as its strands follow them, if they are further apart than allowed anywhere; `None` if the strands
/// follow the guides themselves.
pub(crate) fn narrowed_guides(moved: &Guides, wisp: &Wisp, widest: &[f32]) -> Option<[Vec<Vec3>; 3]> {
    let points = moved.points_per_guide;
    let at = |p: usize| {
        let of = wisp.guides.map(|g| Vec3A::from(moved.point(g as usize, p)));
        (of, narrowed(of, widest_at(widest, wisp, p, points)))
    };
    // Most wisps are not wider than they may be: those need no memory.
    let changes = |p: usize| {
        let (of, now) = at(p);
        now != of && now.iter().all(|p| p.is_finite())
    };
    (0..points).any(changes).then(|| {
        let mut out = [(); 3].map(|()| Vec::with_capacity(points));
        for p in 0..points {
            for (guide, p) in out.iter_mut().zip(at(p).1) {
                guide.push(p.into());
            }
        }
        out
    })
}

/// One value per lane for each of x, y, z.
pub(crate) type Lanes<const N: usize> = [[f32; N]; 3];

impl WispCurve {
    /// The curve of `wisp` at rest, in head space.
    pub fn at_rest(rest: &Guides, wisp: &Wisp) -> Self {
        let mut curve = Self::default();
        curve.place(rest, wisp, &[], rest, Affine3A::IDENTITY);
        curve
    }

    /// Sets this to the curve of `wisp` at one instant.
    ///
    /// `rest` contains the guides at rest in head space, `moved` the same guides in world space (or in head space, with
    /// the identity as `world_from_head`), and `widest` is [`Hairstyle::widest`](crate::Hairstyle::widest). The guides of a
    /// wisp need at least 2 points.
    pub fn place(
        &mut self,
        rest: &Guides,
        wisp: &Wisp,
        widest: &[f32],
        moved: &Guides,
        world_from_head: Affine3A,
    ) {
        let points = moved.points_per_guide;
        assert!(points >= 2, "a guide needs at least 2 points");
        self.controls.clear();
        self.controls.extend((0..points).map(|p| {
            let of = wisp.guides.map(|g| Vec3A::from(moved.point(g as usize, p)));
            narrowed(of, widest_at(widest, wisp, p, points))
        }));

        let mean = |p: usize| (self.controls[p][0] + self.controls[p][1] + self.controls[p][2]) / 3.0;
        let [root_normal, _, root_tangent] = Self::root_frame(rest, wisp);
        let mut tangent = world_from_head.transform_vector3a(root_tangent.into());
        let mut normal = world_from_head.transform_vector3a(root_normal.into());
        self.links.clear();
        for p in 1..points {
            let chord = mean((p + 1).min(points - 1)) - mean(p - 1);
            let next = chord.normalize_or(tangent);
            let turned = transport(normal, tangent, next);
            self.links.push(Link {
                tangent: tangent.to_array(),
                tangent_change: (next - tangent).to_array(),
                normal: normal.to_array(),
                normal_change: (turned - normal).to_array(),
            });
            (tangent, normal) = (next, turned);
        }
    }

    /// The frame at the root of a wisp at rest, head space: normal, binormal and tangent. It turns with the head.
    pub fn root_frame(rest: &Guides, wisp: &Wisp) -> [Vec3; 3] {
        let mean =
            |p| wisp.guides.iter().map(|&g| Vec3A::from(rest.point(g as usize, p))).sum::<Vec3A>() / 3.0;
        let tangent = (mean(1) - mean(0)).normalize_or(Vec3A::Y);
        let normal = reference_normal(tangent);
        [normal, tangent.cross(normal), tangent].map(Vec3::from)
    }

    /// Points of one guide.
    pub fn points_per_guide(&self) -> usize {
        self.controls.len()
    }

    /// The guides' curves at `u` (in links, clamped to the curve), blended by `weights`; metres.
    pub fn blend(&self, weights: [f32; 3], u: f32) -> Vec3 {
        let (p, t) = locate(u, self.links.len());
        let at = |i: usize| mix(&self.controls[i], weights);
        let (a, b) = (at(p), at(p + 1));
        let before = if p > 0 { at(p - 1) } else { 2.0 * a - b };
        let after = if p + 1 < self.links.len() { at(p + 2) } else { 2.0 * b - a };
        let four = [before, a, b, after].map(|c| c.to_array());
        let [[x], [y], [z]] = catmull_rom(&four, [0], [t]);
        Vec3::new(x, y, z)
    }

    /// The frame at `u`: an orthonormal, right-handed matrix with the columns normal, binormal and tangent. Its
    /// transpose turns a displacement into an offset.
    pub fn frame(&self, u: f32) -> Mat3 {
        let (p, t) = locate(u, self.links.len());
        let axes = self.axes([p], [t]);
        let column = |[[x], [y], [z]]: Lanes<1>| Vec3::new(x, y, z);
        Mat3::from_cols(column(axes[0]), column(axes[1]), column(axes[2]))
    }

    /// A point of a strand: `blend(weights, u) + frame(u) * offset`.
    pub fn point(&self, weights: [f32; 3], u: f32, offset: Vec3) -> Vec3 {
        self.blend(weights, u) + self.frame(u) * offset
    }

    /// The offset from the blended curve at `u` to `point`: the inverse of [`WispCurve::point`].
    pub fn offset_to(&self, weights: [f32; 3], u: f32, point: Vec3) -> Vec3 {
        self.frame(u).transpose() * (point - self.blend(weights, u))
    }

    /// Control points blended by `weights` into `out`, with the phantom points before and after: those of link `p`
    /// are `p` to `p + 3`.
    pub(crate) fn blend_controls(&self, weights: [f32; 3], out: &mut Vec<[f32; 3]>) {
        let at = |i: usize| mix(&self.controls[i], weights);
        let last = self.controls.len() - 1;
        out.clear();
        out.push((2.0 * at(0) - at(1)).to_array());
        out.extend(self.controls.iter().map(|c| mix(c, weights).to_array()));
        out.push((2.0 * at(last) - at(last - 1)).to_array());
    }

    /// Normals, binormals and tangents at the fractions `t` of the links `p`.
    #[inline(always)]
    pub(crate) fn axes<const N: usize>(&self, p: [usize; N], t: [f32; N]) -> [Lanes<N>; 3] {
        let mut tangent = [[0.0; N]; 3];
        let mut normal = [[0.0; N]; 3];
        let mut tangent_change = [[0.0; N]; 3];
        let mut normal_change = [[0.0; N]; 3];
        for lane in 0..N {
            let link = &self.links[p[lane]];
            for axis in 0..3 {
                tangent[axis][lane] = link.tangent[axis];
                tangent_change[axis][lane] = link.tangent_change[axis];
                normal[axis][lane] = link.normal[axis];
                normal_change[axis][lane] = link.normal_change[axis];
            }
        }
        for axis in 0..3 {
            for lane in 0..N {
                tangent[axis][lane] += tangent_change[axis][lane] * t[lane];
                normal[axis][lane] += normal_change[axis][lane] * t[lane];
            }
        }
        orthonormal(tangent, normal)
    }
}

/// The link and the fraction of it at parameter `u` of a curve of `links` links.
#[inline(always)]
pub(crate) fn locate(u: f32, links: usize) -> (usize, f32) {
    let u = u.max(0.0).min(links as f32);
    let p = (u as i32).min(links as i32 - 1);
    (p as usize, u - p as f32)
}

/// Points of the uniform Catmull-Rom segments between `controls[p + 1]` and `controls[p + 2]`, at the fractions `t`.
#[inline(always)]
pub(crate) fn catmull_rom<const N: usize>(controls: &[[f32; 3]], p: [usize; N], t: [f32; N]) -> Lanes<N> {
    let mut c = [[[0.0; N]; 3]; 4];
    for lane in 0..N {
        let four = &controls[p[lane]..p[lane] + 4];
        for (k, control) in four.iter().enumerate() {
            for axis in 0..3 {
                c[k][axis][lane] = control[axis];
            }
        }
    }
    let mut basis = [[0.0; N]; 4];
    for lane in 0..N {
        let t = t[lane];
        let (t2, t3) = (t * t, t * t * t);
        basis[0][lane] = -0.5 * t + t2 - 0.5 * t3;
        basis[1][lane] = 1.0 - 2.5 * t2 + 1.5 * t3;
        basis[2][lane] = 0.5 * t + 2.0 * t2 - 1.5 * t3;
        basis[3][lane] = 0.5 * t3 - 0.5 * t2;
    }
    let mut point = [[0.0; N]; 3];
    for axis in 0..3 {
        for lane in 0..N {
            point[axis][lane] = c[0][axis][lane] * basis[0][lane]
                + c[1][axis][lane] * basis[1][lane]
                + c[2][axis][lane] * basis[2][lane]
                + c[3][axis][lane] * basis[3][lane];
        }
    }
    point
}

#[inline]
fn mix(controls: &[Vec3A; 3], w: [f32; 3]) -> Vec3A {
    controls[0] * w[0] + controls[1] * w[1] + controls[2] * w[2]
}

/// Gram-Schmidt: unit normals, binormals and tangents. The vectors interpolated between neighbouring guide points
/// vanish only where a guide folds back on itself; the axes are finite and orthonormal even there.
#[inline(always)]
fn orthonormal<const N: usize>(mut tangent: Lanes<N>, mut normal: Lanes<N>) -> [Lanes<N>; 3] {
    let mut binormal = [[0.0; N]; 3];
    let mut smallest = [0.0; N];
    for lane in 0..N {
        let [x, y, z] = [tangent[0][lane], tangent[1][lane], tangent[2][lane]];
        let squared = x * x + y * y + z * z;
        let scale = 1.0 / squared.sqrt();
        let [x, y, z] = [x * scale, y * scale, z * scale];
        let [nx, ny, nz] = [normal[0][lane], normal[1][lane], normal[2][lane]];
        let along = nx * x + ny * y + nz * z;
        let [nx, ny, nz] = [nx - along * x, ny - along * y, nz - along * z];
        let across = nx * nx + ny * ny + nz * nz;
        let scale = 1.0 / across.sqrt();
        let [nx, ny, nz] = [nx * scale, ny * scale, nz * scale];
        for (axis, value) in [x, y, z].into_iter().enumerate() {
            tangent[axis][lane] = value;
        }
        for (axis, value) in [nx, ny, nz].into_iter().enumerate() {
            normal[axis][lane] = value;
        }
        for (axis, value) in [y * nz - z * ny, z * nx - x * nz, x * ny - y * nx].into_iter().enumerate() {
            binormal[axis][lane] = value;
        }
        smallest[lane] = squared.min(across);
    }
    // This is also true for a NaN lane.
    if !smallest.iter().all(|&s| s > 1e-12) {
        for lane in (0..N).filter(|&lane| smallest[lane].is_nan() || smallest[lane] <= 1e-12) {
            let given = Vec3A::new(tangent[0][lane], tangent[1][lane], tangent[2][lane]);
            let along = given.normalize_or(Vec3A::Y);
            let across = reference_normal(along);
            for (axes, made) in
                [(&mut normal, across), (&mut binormal, along.cross(across)), (&mut tangent, along)]
            {
                for axis in 0..3 {
                    axes[axis][lane] = made[axis];
                }
            }
        }
    }
    [normal, binormal, tangent]
}

/// A unit vector square to the unit vector `tangent`, made from the axis least along it.
pub fn reference_normal(tangent: Vec3A) -> Vec3A {
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
pub fn transport(normal: Vec3A, from: Vec3A, to: Vec3A) -> Vec3A {
    let one_plus_cos = 1.0 + from.dot(to);
    let turned =
        if one_plus_cos > 1e-6 { normal - (from + to) * (normal.dot(to) / one_plus_cos) } else { normal };
    (turned - to * turned.dot(to)).normalize_or(reference_normal(to))
}
