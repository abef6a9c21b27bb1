//! The light of a lamp that stands somewhere: the twin of the functions `…_standing` in `frame.wgsl`.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use glam::{Vec2, Vec3};
use lovelock_shadow::ColumnMap;

use super::body_depth::DepthMap;
use super::math::{floor, index_of, max, min};
use crate::Light;
use crate::standing::StandingUniform;

/// A lamp with its maps.
pub(super) struct StandingLight<'a> {
    uniform: &'a StandingUniform,
    /// The views of the body.
    views: &'a [DepthMap],
    columns: &'a [ColumnMap],
}

impl<'a> StandingLight<'a> {
    /// Combines the uniform with its maps.
    pub fn new(uniform: &'a StandingUniform, views: &'a [DepthMap], columns: &'a [ColumnMap]) -> Self {
        Self { uniform, views, columns }
    }

    /// See [`super::view::LightView::arriving`].
    #[inline(always)]
    pub fn arriving<const N: usize>(&self, p: &[[f32; N]; 3]) -> ([[f32; N]; 3], [f32; N]) {
        let uniform = self.uniform;
        let (position, axis) = (uniform.position.to_array(), uniform.cone_axis.to_array());
        let mut toward = [[0.0; N]; 3];
        let mut squared = [0.0; N];
        let mut along = [0.0; N];
        for c in 0..3 {
            for lane in 0..N {
                let way = position[c] - p[c][lane];
                squared[lane] += way * way;
                along[lane] -= way * axis[c];
                toward[c][lane] = way;
            }
        }
        let mut share = [0.0; N];
        let mut inverse = [0.0; N];
        for lane in 0..N {
            let distance = squared[lane].sqrt();
            inverse[lane] = 1.0 / max(distance, 1e-6);
            let near = max(distance, uniform.radius);
            let t = along[lane] * inverse[lane] * uniform.cone_scale + uniform.cone_offset;
            let t = min(max(t, 0.0), 1.0);
            share[lane] = t * t * (3.0 - 2.0 * t) / (near * near);
        }
        for toward in &mut toward {
            for lane in 0..N {
                toward[lane] *= inverse[lane];
            }
        }
        (toward, share)
    }

    /// See [`super::view::LightView::past_body`].
    pub fn past_body<const N: usize>(
        &self,
        p: &[[f32; N]; 3],
        n: Option<&[[f32; N]; 3]>,
        bias: f32,
        disc: &[Vec2],
    ) -> [f32; N] {
        let at = |of: &[[f32; N]; 3], lane: usize| Vec3::new(of[0][lane], of[1][lane], of[2][lane]);
        std::array::from_fn(|lane| self.past_body_at(at(p, lane), n.map(|n| at(n, lane)), bias, disc))
    }

    fn past_body_at(&self, p: Vec3, n: Option<Vec3>, bias: f32, disc: &[Vec2]) -> f32 {
        let uniform = self.uniform;
        let way = uniform.position - p;
        let distance = max(way.length(), 1e-6);
        let l = way / distance;
        if !self.is_seen(p) {
            return 1.0;
        }
        let texel = distance * uniform.texel;
        // The disc lies in the plane of the surface, so that a flat surface does not shadow itself.
        let normal = n.unwrap_or(l);
        let cosine = max(normal.dot(l), 0.0);
        // Texels around a position are nearer by the slope of the plane over one texel; see `LightView::body_light`.
        let slope = 1.414 * max(1.0 - cosine * cosine, 0.0).sqrt() / max(cosine, 0.25);
        let start = p + l * (bias + texel * slope);
        let (y, z) = normal.any_orthonormal_pair();
        let soft = uniform.radius * Light::BLOCKER_METRES / max(distance, uniform.radius);
        let radius = max(min(soft, Light::MAX_SOFTNESS), texel);
        let mut sum = [0.0];
        for tap in disc {
            self.add_compared(start + (y * tap.x + z * tap.y) * radius, &mut sum);
        }
        sum[0] / disc.len() as f32
    }

    /// Whether a position is in the view of the body.
    fn is_seen(&self, p: Vec3) -> bool {
        let q = p - self.uniform.position;
        let at = self.uniform.shadow_from_world[self.uniform.body_side(q)] * p.extend(1.0);
        at.w > 0.0 && at.x.abs() <= at.w && at.y.abs() <= at.w
    }

    /// Adds the fraction of the light at a position that the body lets through.
    fn add_compared(&self, p: Vec3, sum: &mut [f32; 1]) {
        let q = p - self.uniform.position;
        let side = self.uniform.body_side(q);
        let at = self.uniform.shadow_from_world[side] * p.extend(1.0);
        let inverse = 1.0 / max(at.w, 1e-9);
        let (u, v) = (at.x * inverse * 0.5 + 0.5, 0.5 - at.y * inverse * 0.5);
        match self.views.get(side) {
            Some(view) => view.add_compared(&[u], &[v], &[at.z * inverse], sum),
            None => sum[0] += 1.0,
        }
    }

    /// The transmittance of all hair, for a point behind it.
    pub fn columns_light(&self, p: Vec3) -> f32 {
        // The map in whose middle the point is nearest: that whose fourth coordinate is largest.
        let places = self.columns.iter().map(|map| (map, map.uv_from_world * p.extend(1.0)));
        let nearest = places.filter(|(_, at)| at.w > 0.0).max_by(|(_, a), (_, b)| a.w.total_cmp(&b.w));
        nearest.map_or(1.0, |(map, at)| light_behind(map, [at.x / at.w, at.y / at.w]))
    }
}

/// The transmittance of a map at `u` and `v`; 1 beside it.
pub(super) fn light_behind(map: &ColumnMap, [u, v]: [f32; 2]) -> f32 {
    let inside = u >= 0.0 && v >= 0.0 && u <= 1.0 && v <= 1.0;
    if !inside || map.size == 0 {
        return 1.0;
    }
    let last = (map.size - 1) as f32;
    let texel = |c: f32| {
        let c = c * map.size as f32 - 0.5;
        let low = floor(c);
        let clamped = |c: f32| index_of(min(max(c, 0.0), last)) as usize;
        (clamped(low), clamped(low + 1.0), c - low)
    };
    let ((x0, x1, fx), (y0, y1, fy)) = (texel(u), texel(v));
    let size = map.size as usize;
    let t = |x: usize, y: usize| map.transmittance.get(y * size + x).copied().unwrap_or(1.0);
    let row = |y| t(x0, y) + (t(x1, y) - t(x0, y)) * fx;
    row(y0) + (row(y1) - row(y0)) * fy
}
