//! The uniform of the shaders, and the maps of the lights.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use glam::{Mat4, Vec2, Vec3};
use lovelock_appearance::fibre::FibreTables;
use lovelock_groom::HairLook;
use lovelock_shadow::ColumnMap;

use super::body_depth::DepthMap;
use super::math::{exp, max, min, most, pow, three};
use super::standing::{StandingLight, light_behind};
use crate::MAX_LIGHTS;
use crate::ambient::AmbientGrid;
use crate::fibre::FibreLight;
use crate::uniform::{FrameUniform, WIDE_BLUR, WIDE_LAMP};

/// Taps of a soft shadow on a surface. Six taps would show bands.
const SURFACE_TAPS: usize = 12;
/// Taps of a soft shadow on a surface whose edge is wide: twelve would show as that many edges beside each other.
const WIDE_TAPS: usize = 48;
/// Taps of a soft shadow on a strand point, which its neighbours blur.
const STRAND_TAPS: usize = 3;

/// The picture's settings with the maps of its lights.
pub(super) struct View<'a> {
    pub uniform: &'a FrameUniform,
    pub lights: Vec<LightView<'a>>,
    /// Golden-angle discs for surfaces and for strands, as in the shader.
    pub surface_disc: [Vec2; SURFACE_TAPS],
    wide_disc: [Vec2; WIDE_TAPS],
    pub strand_disc: [Vec2; STRAND_TAPS],
    /// Light from all directions among the hair.
    pub grid: &'a AmbientGrid,
    /// How strands are shaded.
    pub shading: ShadingView<'a>,
    /// The light from all directions on surfaces: [`FrameUniform::surround`] as plain numbers, so that loops over them vectorise.
    surround: [[f32; 3]; 9],
    /// The colour of skin where hair has its roots.
    pub root: [f32; 3],
}

/// How strands are shaded, with what that needs: see [`lovelock_groom::HairShading`].
pub(super) enum ShadingView<'a> {
    Fibre(FibreView<'a>),
    TwoHighlights,
    KajiyaKay,
}

/// Scattering by fibres.
pub(super) struct FibreView<'a> {
    pub tables: &'a FibreTables,
    pub lights: [FibreLight; MAX_LIGHTS],
}

/// One light.
pub(super) struct LightView<'a> {
    /// The direction in which the light travels.
    pub direction: Vec3,
    /// The fraction that contributes to highlights.
    pub specular: f32,
    pub radiance: Vec3,
    /// Blur of the body's shadow, as a fraction of the map's edge.
    blur: f32,
    /// The size of a texel, as a fraction of the map's edge.
    texel: f32,
    /// Whether the edge of the body's shadow is wide.
    wide: bool,
    /// Unit vectors along the map's edges, to the right and down.
    edges: [Vec3; 2],
    shadow_from_world: Mat4,
    depth: &'a DepthMap,
    columns: Option<&'a ColumnMap>,
    /// What replaces all of this for a light that stands somewhere.
    standing: Option<StandingLight<'a>>,
}

impl<'a> View<'a> {
    /// Combines the uniform with the maps of its lights.
    pub fn new(
        uniform: &'a FrameUniform,
        (grid, shading): (&'a AmbientGrid, ShadingView<'a>),
        depth: &'a [Vec<DepthMap>],
        columns: &'a [Vec<ColumnMap>],
        texels: u32,
    ) -> Self {
        let count = (uniform.light_count as usize).min(MAX_LIGHTS);
        let columns = |k: usize| columns.get(k).map_or(&[][..], Vec::as_slice);
        let lights = uniform.lights[..count]
            .iter()
            .zip(&uniform.standing)
            .zip(depth)
            .enumerate()
            .filter_map(|(k, ((light, standing), views))| Some((k, light, standing, views, views.first()?)))
            .map(|(k, light, standing, views, depth)| LightView {
                direction: light.direction,
                specular: light.specular,
                radiance: light.radiance,
                blur: light.blur.max(1.0) / texels as f32,
                texel: 1.0 / texels as f32,
                wide: if standing.is_standing() {
                    standing.radius > WIDE_LAMP
                } else {
                    light.blur > WIDE_BLUR
                },
                edges: [
                    light.shadow_from_world.row(0).truncate().normalize_or_zero(),
                    -light.shadow_from_world.row(1).truncate().normalize_or_zero(),
                ],
                shadow_from_world: light.shadow_from_world,
                depth,
                columns: columns(k).first(),
                standing: standing.is_standing().then(|| StandingLight::new(standing, views, columns(k))),
            })
            .collect();
        let surround = uniform.surround.map(|of| [of.x, of.y, of.z]);
        let (surface_disc, wide_disc, strand_disc) = (disc(), disc(), disc());
        let root = uniform.root_absorption.to_array().map(|absorption| {
            let stretched = pow(max(absorption, 0.0), HairLook::STRETCH);
            0.3 * (exp(-HairLook::BODY_PATH * stretched) + HairLook::SURFACE_SHARE)
        });
        Self { uniform, lights, surface_disc, wide_disc, strand_disc, grid, shading, surround, root }
    }

    /// The taps of the soft shadow of a light on the body.
    pub fn body_disc(&self, light: &LightView<'_>) -> &[Vec2] {
        if light.wide { &self.wide_disc } else { &self.surface_disc }
    }

    /// Points of each fine strand; 1 if stored strands are drawn.
    pub fn points_per_strand(&self) -> usize {
        self.uniform.points_per_strand.max(1) as usize
    }

    /// Light from all directions on a surface with the unit normal `n`: irradiance over pi.
    #[inline(always)]
    pub fn ambient(&self, n: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = n;
        let basis = [1.0, y, z, x, 1.5 * y * y - 0.5, y * z, y * x, z * z - x * x, 2.0 * x * z];
        let mut sum = [0.0; 3];
        for k in 0..9 {
            for c in 0..3 {
                sum[c] += self.surround[k][c] * basis[k];
            }
        }
        three(|c| max(sum[c], 0.0))
    }

    /// [`View::ambient`] of several normals.
    #[inline(always)]
    pub fn ambient_of<const N: usize>(&self, n: &[[f32; N]; 3]) -> [[f32; N]; 3] {
        let mut out = [[0.0; N]; 3];
        for lane in 0..N {
            let [r, g, b] = self.ambient([n[0][lane], n[1][lane], n[2][lane]]);
            out[0][lane] = r;
            out[1][lane] = g;
            out[2][lane] = b;
        }
        out
    }

    /// The mean light from all directions: irradiance over pi, averaged over the directions of surfaces.
    pub fn ambient_mean(&self) -> [f32; 3] {
        three(|c| max(self.uniform.surround[0][c], 0.0))
    }
}

/// A golden-angle disc: uniform for any number of taps, and the same for every pixel, so that it does not flicker.
fn disc<const N: usize>() -> [Vec2; N] {
    std::array::from_fn(|k| {
        let angle = 2.399_963_2 * k as f32;
        Vec2::new(angle.cos(), angle.sin()) * ((k as f32 + 0.5) / N as f32).sqrt()
    })
}

impl LightView<'_> {
    /// The unit vectors from positions toward the light, and the share of its brightness that arrives at each if nothing is between.
    #[inline(always)]
    pub fn arriving<const N: usize>(&self, p: &[[f32; N]; 3]) -> ([[f32; N]; 3], [f32; N]) {
        match &self.standing {
            Some(standing) => standing.arriving(p),
            None => ((-self.direction).to_array().map(|c| [c; N]), [1.0; N]),
        }
    }

    /// The fraction of the light that the body lets through to positions on surfaces with the unit normals `n`, or to points without a
    /// surface; see [`LightView::body_light`].
    #[inline(always)]
    pub fn past_body<const N: usize>(
        &self,
        p: &[[f32; N]; 3],
        n: Option<&[[f32; N]; 3]>,
        bias: f32,
        disc: &[Vec2],
    ) -> [f32; N] {
        if let Some(standing) = &self.standing {
            return standing.past_body(p, n, bias, disc);
        }
        match n {
            Some(n) => self.body_light(p, &self.lean_of(n), bias, disc),
            None => self.body_light(p, &[[0.0; N]; 3], bias, disc),
        }
    }

    /// The components of the unit normals `n` along u, v and toward the light.
    #[inline(always)]
    fn lean_of<const N: usize>(&self, n: &[[f32; N]; 3]) -> [[f32; N]; 3] {
        let axes = [self.edges[0], self.edges[1], -self.direction];
        let mut lean = [[0.0; N]; 3];
        for (lean, axis) in lean.iter_mut().zip(axes) {
            for lane in 0..N {
                lean[lane] = n[0][lane] * axis.x + n[1][lane] * axis.y + n[2][lane] * axis.z;
            }
        }
        lean
    }

    /// The fraction of the light that the body lets through to positions, which are moved `bias` metres toward the light first: the
    /// mean over the taps of `disc`.
    ///
    /// The disc lies in the plane of the surface, given by `lean`, so that a flat surface does not shadow itself. For points without a
    /// surface `lean` is zero and the disc is perpendicular to the light.
    #[inline(always)]
    fn body_light<const N: usize>(
        &self,
        p: &[[f32; N]; 3],
        lean: &[[f32; N]; 3],
        bias: f32,
        disc: &[Vec2],
    ) -> [f32; N] {
        let m = &self.shadow_from_world;
        let (rx, ry, rz) = (m.row(0), m.row(1), m.row(2));
        let toward = self.direction;
        let mut u = [0.0; N];
        let mut v = [0.0; N];
        let mut z = [0.0; N];
        let mut inside = [0.0; N];
        let mut steep = [0.0; N];
        for lane in 0..N {
            let (x, y, w) =
                (p[0][lane] - toward.x * bias, p[1][lane] - toward.y * bias, p[2][lane] - toward.z * bias);
            u[lane] = (rx.x * x + rx.y * y + rx.z * w + rx.w) * 0.5 + 0.5;
            v[lane] = 0.5 - (ry.x * x + ry.y * y + ry.z * w + ry.w) * 0.5;
            // Texels around a position are nearer by the slope of the plane over one texel. The slope is limited, because at grazing
            // angles it would be too large for other surfaces.
            let leans = lean[0][lane].abs() + lean[1][lane].abs();
            let nearer = self.texel * leans / max(lean[2][lane], 0.25);
            z[lane] = rz.x * x + rz.y * y + rz.z * w + rz.w - nearer;
            steep[lane] = leans;
            // One comparison vectorises, four do not.
            let seen = min(min(u[lane], 1.0 - u[lane]), min(v[lane], 1.0 - v[lane])) >= 0.0;
            inside[lane] = if seen { 1.0 } else { 0.0 };
        }
        if most(&inside) <= 0.0 {
            return [1.0; N];
        }
        if let Some(all) = self.depth.all_alike(&u, &v, &z, self.blur, most(&steep)) {
            let mut out = [1.0; N];
            for lane in 0..N {
                out[lane] = if inside[lane] > 0.0 { all } else { 1.0 };
            }
            return out;
        }
        let mut turn = [[0.0; N]; 2];
        for lane in 0..N {
            let inverse = 1.0 / (1.0 + max(lean[2][lane], 0.0));
            (turn[0][lane], turn[1][lane]) = (lean[0][lane] * inverse, lean[1][lane] * inverse);
        }
        let mut sum = [0.0; N];
        let (mut tap_u, mut tap_v, mut tap_z) = ([0.0; N], [0.0; N], [0.0; N]);
        for tap in disc {
            let tap = *tap * self.blur;
            for lane in 0..N {
                // The map is as deep as it is wide, so its three coordinates can be rotated together.
                let deeper = tap.x * lean[0][lane] + tap.y * lean[1][lane];
                tap_u[lane] = u[lane] + tap.x - turn[0][lane] * deeper;
                tap_v[lane] = v[lane] + tap.y - turn[1][lane] * deeper;
                tap_z[lane] = z[lane] + deeper;
            }
            self.depth.add_compared(&tap_u, &tap_v, &tap_z, &mut sum);
        }
        let share = 1.0 / disc.len() as f32;
        for lane in 0..N {
            sum[lane] = if inside[lane] > 0.0 { sum[lane] * share } else { 1.0 };
        }
        sum
    }

    /// Whether the maps do not cover the bounds of positions.
    pub fn is_beside<const N: usize>(&self, p: &[[f32; N]; 3]) -> bool {
        if self.standing.is_some() {
            return false;
        }
        let m = &self.shadow_from_world;
        let columns = self.columns.map(|map| &map.uv_from_world);
        let beside = |m: &Mat4, low: f32, high: f32| {
            [m.row(0), m.row(1)].into_iter().any(|row| {
                let at = |i: usize| row.x * p[0][i] + row.y * p[1][i] + row.z * p[2][i] + row.w;
                (0..N).all(|i| at(i) < low) || (0..N).all(|i| at(i) > high)
            })
        };
        beside(m, -1.0, 1.0) && columns.is_none_or(|m| beside(m, 0.0, 1.0))
    }

    /// The transmittance of all hair, for a point behind it.
    pub fn columns_light(&self, p: Vec3) -> f32 {
        if let Some(standing) = &self.standing {
            return standing.columns_light(p);
        }
        let Some(map) = self.columns else { return 1.0 };
        let m = &map.uv_from_world;
        let at = m.x_axis * p.x + m.y_axis * p.y + m.z_axis * p.z + m.w_axis;
        light_behind(map, [at.x, at.y])
    }
}
