//! Light that reaches the eye from a strand among many.
//!
//! This is dual scattering (Zinke, Yuksel, Weber and Keyser 2008) with a smooth count of crossed fibres in place of their switch
//! between lit and unlit. A point of a strand has one [`PointScatter`], and every light then costs two rows of a table and
//! arithmetic without branches. Everything is in single precision, as vectorised code and a shader repeat it.
// Inlined into the loops of a renderer; a call would prevent vectorisation.
#![allow(clippy::inline_always)]

use super::arithmetic::{clamp, exp};
use super::scattering::TILTS;
use super::table::Columns;
use super::{CosineStep, Fibre, LOBES, LongitudinalLobe, ManyTable, ScatterTable, distributions, variances};

/// Most fibres that are told apart between a point and a light.
pub const MAX_FIBRES: f32 = 40.0;
/// Largest variance of scattered light; a lobe that is wider is flat anyway.
const WIDEST: f32 = 20.0;
/// Backscattered light per radian of azimuth: `2 / pi` (Zinke et al. 2008, local multiple scattering). Their density factor of
/// 0.7 is 1 here, which agrees best with path tracing of layers of parallel fibres.
const BACKSCATTER: f32 = 2.0 * std::f32::consts::FRAC_1_PI;
/// Half of the azimuth over which backscattered light ends, around 90 degrees, in radians. A step would show as an edge.
const BACKSCATTER_EDGE: f32 = 0.2;

/// Everything that is the same for all points of hair with one kind of fibre.
#[derive(Clone, Debug)]
pub struct FibreTables {
    /// The fibre, with every value in its range.
    pub fibre: Fibre,
    /// Distribution of light that arrives directly.
    pub direct: ScatterTable,
    /// Distribution of light that many fibres scattered forward before.
    pub forward: ScatterTable,
    /// Multiple scattering.
    pub many: ManyTable,
    /// Variances of the lobes.
    pub variances: [f32; LOBES],
    /// Sine and cosine of the angle that each lobe adds to the eye's inclination.
    pub tilts: [[f32; 2]; LOBES],
}

impl FibreTables {
    /// Tables of a fibre.
    pub fn bake(fibre: &Fibre) -> Self {
        let fibre = fibre.clamped();
        let [direct, forward] = ScatterTable::bake(&fibre);
        let many = ManyTable::bake(&fibre);
        let mut tables =
            Self { fibre, direct, forward, many, variances: [0.0; LOBES], tilts: [[0.0; 2]; LOBES] };
        tables.set_longitudinal(fibre);
        tables
    }

    /// Takes over a fibre. Bakes the tables again only if the azimuthal roughness or the index of refraction changed.
    pub fn update(&mut self, fibre: &Fibre) {
        let fibre = fibre.clamped();
        if (fibre.roughness_around, fibre.index) == (self.fibre.roughness_around, self.fibre.index) {
            self.set_longitudinal(fibre);
        } else {
            *self = Self::bake(&fibre);
        }
    }

    fn set_longitudinal(&mut self, fibre: Fibre) {
        self.fibre = fibre;
        let v = variances(fibre.roughness_along);
        self.variances = v.map(|v| v as f32);
        self.tilts = TILTS.map(|tilts| {
            let angle = tilts * fibre.tilt;
            [angle.sin() as f32, angle.cos() as f32]
        });
    }
}

/// A light, relative to `N` points of strands.
#[derive(Clone, Copy, Debug)]
pub struct PointLight<const N: usize> {
    /// Sine and cosine of the inclination to the normal plane; the cosine is not negative.
    pub sin_theta: [f32; N],
    /// See `sin_theta`.
    pub cos_theta: [f32; N],
    /// Azimuth between light and eye, 0 to pi: the arc cosine of the dot product of both directions in the normal plane.
    pub phi: [f32; N],
    /// Mean count of fibres between the point and the light, `-ln(transmittance) / (extinction per fibre)`.
    pub fibres: [f32; N],
}

/// What `N` points of strands scatter toward the eye. It depends on the eye and the absorption, and on no light.
///
/// Each number is an array over the points, and each function is a few loops over them, which the compiler turns into vectors: a loop over
/// single points that calls all of this would be too long for it.
#[derive(Clone, Copy, Debug)]
pub struct PointScatter<const N: usize> {
    /// Rows of the tables for the eye's cosine.
    pub eye: [CosineStep; N],
    /// Sine and cosine of the eye's inclination, tilted for every lobe.
    pub tilted: [[[f32; N]; 2]; LOBES],
    /// Per channel: absorption per radius.
    pub sigma: [[f32; N]; 3],
    /// Per channel: share that a fibre scatters forward. Symbol: `a_f`.
    pub forward: [[f32; N]; 3],
    /// Per channel: variance of the forward scattering. Symbol: `b_f`.
    pub spread: [[f32; N]; 3],
    /// Per channel: backscattered light times `2 / pi`. Symbol: `A_b`.
    pub backscatter: [[f32; N]; 3],
    /// Variance of the backscattered light, the mean over the channels weighted by that light. Symbol: `v_b`.
    pub backscatter_variance: [f32; N],
    /// Per channel: distribution of the paths longer than TRT.
    pub rest: [[f32; N]; 3],
    /// Per channel: share of diffuse light that the strand scatters, `a_f + a_b`.
    pub albedo: [[f32; N]; 3],
}

impl<const N: usize> PointScatter<N> {
    /// Scattering toward an eye at an inclination, for an absorption per channel. Values that are not numbers count as zero.
    #[inline(always)]
    pub fn new(
        tables: &FibreTables,
        sin_theta: &[f32; N],
        cos_theta: &[f32; N],
        absorption: &[[f32; N]; 3],
    ) -> Self {
        let mut eye = [CosineStep::default(); N];
        let (mut sin, mut cos) = ([0.0; N], [0.0; N]);
        for lane in 0..N {
            sin[lane] = clamp(sin_theta[lane], -1.0, 1.0);
            cos[lane] = clamp(cos_theta[lane], 0.0, 1.0);
        }
        for lane in 0..N {
            eye[lane] = CosineStep::new(cos[lane]);
        }
        let mut scatter = Self {
            eye,
            tilted: [[[0.0; N]; 2]; LOBES],
            sigma: [[0.0; N]; 3],
            forward: [[0.0; N]; 3],
            spread: [[0.0; N]; 3],
            backscatter: [[0.0; N]; 3],
            backscatter_variance: [0.0; N],
            rest: [[0.0; N]; 3],
            albedo: [[0.0; N]; 3],
        };
        for (tilted, [tilt_sin, tilt_cos]) in scatter.tilted.iter_mut().zip(tables.tilts) {
            for lane in 0..N {
                tilted[0][lane] = sin[lane] * tilt_cos + cos[lane] * tilt_sin;
                tilted[1][lane] = (cos[lane] * tilt_cos - sin[lane] * tilt_sin).abs();
            }
        }
        let v = tables.variances[0];
        let (mut variance, mut weight) = ([0.0; N], [0.0; N]);
        for (sigma, absorption) in scatter.sigma.as_flattened_mut().iter_mut().zip(absorption.as_flattened())
        {
            *sigma = clamp(*absorption, 0.0, 1e6);
        }
        for c in 0..3 {
            let rows = tables.many.columns(&eye, &scatter.sigma[c]);
            for lane in 0..N {
                let returned = rows[4][lane];
                variance[lane] += (returned + 1e-9) * rows[5][lane];
                weight[lane] += returned + 1e-9;
                scatter.forward[c][lane] = rows[0][lane];
                scatter.spread[c][lane] = v * rows[2][lane];
                scatter.backscatter[c][lane] = BACKSCATTER * returned;
                scatter.rest[c][lane] = rows[7][lane];
                scatter.albedo[c][lane] = rows[0][lane] + rows[1][lane];
            }
        }
        for lane in 0..N {
            scatter.backscatter_variance[lane] = clamp(v * variance[lane] / weight[lane], 0.0, WIDEST);
        }
        scatter
    }

    /// Radiance toward the eye per unit of irradiance (on a surface perpendicular to the light), per channel.
    ///
    /// `variances` are those of the lobes at each point. `strength`, 0 to 1, is the share of light that was scattered by other fibres: at 0
    /// the strand only shows the light that reaches it directly, `exp(-fibres)` times the scattering of one fibre.
    ///
    /// With n fibres, `e = exp(-n)` of the light hits none of them and `psi = exp(-n (1 - a_f)) - e` is scattered forward by all
    /// that it hits, which follows from a Poisson distribution of the hits. The radiance is `e (f_s + f_b(0)) + psi (f_G +
    /// f_b(x))`, where x is the variance that the hits add, `b_f` each (Zinke et al. 2008, global and local multiple
    /// scattering). TT has an x per channel. The other lobes share its mean over the channels, weighted by psi, which halves the
    /// time.
    #[inline(always)]
    pub fn radiance(
        &self,
        tables: &FibreTables,
        variances: &[[f32; N]; LOBES],
        light: &PointLight<N>,
        strength: f32,
    ) -> [[f32; N]; 3] {
        let rows =
            [tables.direct.columns(&self.eye, &light.phi), tables.forward.columns(&self.eye, &light.phi)];
        let (mut n, mut unhit) = ([0.0; N], [0.0; N]);
        for lane in 0..N {
            n[lane] = clamp(light.fibres[lane], 0.0, MAX_FIBRES);
            unhit[lane] = exp(-n[lane]);
        }
        let (mut psi, mut added) = ([[0.0; N]; 3], [[0.0; N]; 3]);
        let (mut sum, mut weight) = ([0.0; N], [0.0; N]);
        for c in 0..3 {
            for lane in 0..N {
                let forward = self.forward[c][lane];
                let reached = exp(-n[lane] * (1.0 - forward));
                psi[c][lane] = clamp(reached - unhit[lane], 0.0, 1.0);
                // Variance that the hits add to light of a channel which was hit. Mean hits are n a_f / (1 - exp(-n a_f)), which is 1 for
                // n = 0. The small number makes it so.
                let hit = clamp(1.0 - unhit[lane] / reached, 0.0, 1.0);
                let hits = (n[lane] * forward + 1e-4) / (hit + 1e-4);
                added[c][lane] = clamp(self.spread[c][lane] * hits, 0.0, WIDEST);
                let share = psi[c][lane] + 1e-6;
                sum[lane] += share * added[c][lane];
                weight[lane] += share;
            }
        }
        let mut x = [0.0; N];
        for lane in 0..N {
            x[lane] = sum[lane] / weight[lane];
        }

        let once = [
            self.lobe(&variances[0], 0, light),
            self.lobe(&variances[1], 1, light),
            self.lobe(&variances[2], 2, light),
            self.lobe(&variances[3], 3, light),
        ];
        // TT carries most of the light of fair hair and is the narrowest, so each channel has its own. The longer paths are few;
        // after scattering they count to TRT, whose variance they have.
        let after_r = self.lobe(&plus(&variances[0], &x), 0, light);
        let after_trt = self.lobe(&plus(&variances[2], &x), 2, light);

        // Backscattered light leaves on the side of the light. Lobe 3 has no tilt.
        let mut back_once = self.lobe(&self.backscatter_variance, 3, light);
        let mut back_after = self.lobe(&plus(&self.backscatter_variance, &x), 3, light);
        for lane in 0..N {
            let from_side = std::f32::consts::FRAC_PI_2 - light.phi[lane];
            let same_side = clamp(0.5 + from_side * (0.5 / BACKSCATTER_EDGE), 0.0, 1.0);
            back_once[lane] *= same_side;
            back_after[lane] *= same_side;
        }
        let mut radiance = [[0.0; N]; 3];
        for c in 0..3 {
            let after_tt = self.lobe(&plus(&variances[1], &added[c]), 1, light);
            let (d, g) = (self.around(c, &rows[0]), self.around(c, &rows[1]));
            for lane in 0..N {
                let (rest, local) = (self.rest[c][lane], self.backscatter[c][lane]);
                let single = once[0][lane] * d[0][lane]
                    + once[1][lane] * d[1][lane]
                    + once[2][lane] * d[2][lane]
                    + once[3][lane] * rest;
                let global = after_r[lane] * g[0][lane]
                    + after_tt[lane] * g[1][lane]
                    + after_trt[lane] * (g[2][lane] + rest);
                radiance[c][lane] = unhit[lane] * (single + local * (strength * back_once[lane]))
                    + strength * psi[c][lane] * (global + local * back_after[lane]);
            }
        }
        radiance
    }

    /// The distributions of R, TT and TRT around the strand in a channel.
    #[inline(always)]
    fn around(&self, c: usize, rows: &Columns<N>) -> [[f32; N]; 3] {
        let mut lobes = [[0.0; N]; 3];
        for lane in 0..N {
            let row = [
                rows[0][lane],
                rows[1][lane],
                rows[2][lane],
                rows[3][lane],
                rows[4][lane],
                rows[5][lane],
                rows[6][lane],
                0.0,
            ];
            let [r, tt, trt] = distributions(&row, self.sigma[c][lane]);
            lobes[0][lane] = r;
            lobes[1][lane] = tt;
            lobes[2][lane] = trt;
        }
        lobes
    }

    /// Longitudinal lobes of `variance` at the light, with the tilt of lobe `p`.
    #[inline(always)]
    fn lobe(&self, variance: &[f32; N], p: usize, light: &PointLight<N>) -> [f32; N] {
        let mut lobe = [0.0; N];
        let [sin, cos] = &self.tilted[p];
        for lane in 0..N {
            let quick = LongitudinalLobe::quick(variance[lane]);
            lobe[lane] = quick.at(light.sin_theta[lane], light.cos_theta[lane], sin[lane], cos[lane]);
        }
        lobe
    }
}

#[inline(always)]
fn plus<const N: usize>(a: &[f32; N], b: &[f32; N]) -> [f32; N] {
    let mut sum = [0.0; N];
    for lane in 0..N {
        sum[lane] = a[lane] + b[lane];
    }
    sum
}
