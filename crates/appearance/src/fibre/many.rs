//! Light that reaches the eye from a strand among many.
//!
//! This is dual scattering (Zinke, Yuksel, Weber and Keyser 2008) with a smooth count of crossed fibres in place of their switch
//! between lit and unlit. A point of a strand has one [`PointScatter`], and every light then costs two rows of a table and
//! arithmetic without branches. Everything is in single precision, as vectorised code and a shader repeat it.
// Inlined into the loops of a renderer; a call would prevent vectorisation.
#![allow(clippy::inline_always)]

use super::arithmetic::{clamp, exp, three};
use super::scattering::TILTS;
use super::{
    CosineStep, Fibre, LOBES, LongitudinalLobe, ManyTable, ScatterRow, ScatterTable, distributions, variances,
};

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

/// A light, relative to a point of a strand.
#[derive(Clone, Copy, Debug)]
pub struct PointLight {
    /// Sine and cosine of the inclination to the normal plane; the cosine is not negative.
    pub sin_theta: f32,
    /// See `sin_theta`.
    pub cos_theta: f32,
    /// Azimuth between light and eye, 0 to pi: the arc cosine of the dot product of both directions in the normal plane.
    pub phi: f32,
    /// Mean count of fibres between the point and the light, `-ln(transmittance) / (extinction per fibre)`.
    pub fibres: f32,
}

/// What a point of a strand scatters toward the eye. It depends on the eye and the absorption, and on no light.
#[derive(Clone, Copy, Debug, Default)]
pub struct PointScatter {
    /// Rows of the tables for the eye's cosine.
    pub eye: CosineStep,
    /// Sine and cosine of the eye's inclination.
    pub sin_theta: f32,
    /// See `sin_theta`.
    pub cos_theta: f32,
    /// Sine and cosine of the eye's inclination, tilted for every lobe.
    pub tilted: [[f32; 2]; LOBES],
    /// Per channel: absorption per radius.
    pub sigma: [f32; 3],
    /// Per channel: share that a fibre scatters forward. Symbol: `a_f`.
    pub forward: [f32; 3],
    /// Per channel: variance of the forward scattering. Symbol: `b_f`.
    pub spread: [f32; 3],
    /// Per channel: backscattered light times `2 / pi`. Symbol: `A_b`.
    pub backscatter: [f32; 3],
    /// Variance of the backscattered light, the mean over the channels weighted by that light. Symbol: `v_b`.
    pub backscatter_variance: f32,
    /// Its longitudinal lobe.
    pub backscatter_lobe: LongitudinalLobe,
    /// Per channel: distribution of the paths longer than TRT.
    pub rest: [f32; 3],
    /// Per channel: share of diffuse light that the strand scatters, `a_f + a_b`.
    pub albedo: [f32; 3],
}

impl PointScatter {
    /// Scattering toward an eye at an inclination, for an absorption per channel. Values that are not numbers count as zero.
    #[inline(always)]
    pub fn new(tables: &FibreTables, sin_theta: f32, cos_theta: f32, sigma: [f32; 3]) -> Self {
        let sin_theta = clamp(sin_theta, -1.0, 1.0);
        let cos_theta = clamp(cos_theta, 0.0, 1.0);
        let eye = CosineStep::new(cos_theta);
        let sigma = sigma.map(|sigma| clamp(sigma, 0.0, 1e6));
        let rows = sigma.map(|sigma| tables.many.row(eye, sigma));
        let column = |k: usize| [rows[0][k], rows[1][k], rows[2][k]];
        let v = tables.variances[0];
        let (mut variance, mut weight) = (0.0, 0.0);
        for row in &rows {
            variance += (row[4] + 1e-9) * row[5];
            weight += row[4] + 1e-9;
        }
        let backscatter_variance = clamp(v * variance / weight, 0.0, WIDEST);
        Self {
            eye,
            sin_theta,
            cos_theta,
            tilted: tables.tilts.map(|[sin, cos]| {
                [sin_theta * cos + cos_theta * sin, (cos_theta * cos - sin_theta * sin).abs()]
            }),
            sigma,
            forward: column(0),
            spread: column(2).map(|ratio| v * ratio),
            backscatter: column(4).map(|share| BACKSCATTER * share),
            backscatter_variance,
            backscatter_lobe: LongitudinalLobe::quick(backscatter_variance),
            rest: column(7),
            albedo: [0, 1, 2].map(|c| rows[c][0] + rows[c][1]),
        }
    }

    /// Radiance toward the eye per unit of irradiance (on a surface perpendicular to the light), per channel.
    ///
    /// `strength`, 0 to 1, is the share of light that was scattered by other fibres: at 0 the strand only shows the light that
    /// reaches it directly, `exp(-fibres)` times the scattering of one fibre.
    ///
    /// With n fibres, `e = exp(-n)` of the light hits none of them and `psi = exp(-n (1 - a_f)) - e` is scattered forward by all
    /// that it hits, which follows from a Poisson distribution of the hits. The radiance is `e (f_s + f_b(0)) + psi (f_G +
    /// f_b(x))`, where x is the variance that the hits add, `b_f` each (Zinke et al. 2008, global and local multiple
    /// scattering). TT has an x per channel. The other lobes share its mean over the channels, weighted by psi, which halves the
    /// time.
    ///
    /// `rows` are those of both tables at the eye and the light's azimuth, first of direct light and then of light that was scattered
    /// forward; `lobes` are those of `variances`. It is arithmetic alone, so that a loop over several points vectorises after their rows
    /// are read.
    #[inline(always)]
    pub fn radiance_of_rows(
        &self,
        rows: &[ScatterRow; 2],
        variances: [f32; LOBES],
        lobes: [LongitudinalLobe; LOBES],
        light: &PointLight,
        strength: f32,
    ) -> [f32; 3] {
        let n = clamp(light.fibres, 0.0, MAX_FIBRES);
        let unhit = exp(-n);

        let reached = three(|c| exp(-n * (1.0 - self.forward[c])));
        let psi = three(|c| clamp(reached[c] - unhit, 0.0, 1.0));
        let added = [
            self.added(0, n, unhit, reached[0]),
            self.added(1, n, unhit, reached[1]),
            self.added(2, n, unhit, reached[2]),
        ];
        let share = three(|c| psi[c] + 1e-6);
        let x = (share[0] * added[0] + share[1] * added[1] + share[2] * added[2])
            / (share[0] + share[1] + share[2]);

        let once = [
            self.lobe_at(lobes[0], 0, light),
            self.lobe_at(lobes[1], 1, light),
            self.lobe_at(lobes[2], 2, light),
            self.lobe_at(lobes[3], 3, light),
        ];
        // TT carries most of the light of fair hair and is the narrowest, so each channel has its own. The longer paths are few;
        // after scattering they count to TRT, whose variance they have.
        let after_r = self.lobe_at(LongitudinalLobe::quick(variances[0] + x), 0, light);
        let after_tt = [
            self.lobe_at(LongitudinalLobe::quick(variances[1] + added[0]), 1, light),
            self.lobe_at(LongitudinalLobe::quick(variances[1] + added[1]), 1, light),
            self.lobe_at(LongitudinalLobe::quick(variances[1] + added[2]), 1, light),
        ];
        let after_trt = self.lobe_at(LongitudinalLobe::quick(variances[2] + x), 2, light);

        // Backscattered light leaves on the side of the light. Lobe 3 has no tilt.
        let same_side =
            clamp(0.5 + (std::f32::consts::FRAC_PI_2 - light.phi) * (0.5 / BACKSCATTER_EDGE), 0.0, 1.0);
        let back_once = same_side * self.lobe_at(self.backscatter_lobe, 3, light);
        let back_after =
            same_side * self.lobe_at(LongitudinalLobe::quick(self.backscatter_variance + x), 3, light);

        let direct = [unhit, strength * back_once, once[0], once[1], once[2], once[3]];
        let scattered = [strength, back_after, after_r, after_trt];
        [
            self.channel(0, rows, &direct, &scattered, psi[0], after_tt[0]),
            self.channel(1, rows, &direct, &scattered, psi[1], after_tt[1]),
            self.channel(2, rows, &direct, &scattered, psi[2], after_tt[2]),
        ]
    }

    /// Variance that the hits add to light of a channel which was hit.
    #[inline(always)]
    fn added(&self, c: usize, n: f32, unhit: f32, reached: f32) -> f32 {
        // Mean hits are n a_f / (1 - exp(-n a_f)), which is 1 for n = 0. The small number makes it so.
        let hit = clamp(1.0 - unhit / reached, 0.0, 1.0);
        let hits = (n * self.forward[c] + 1e-4) / (hit + 1e-4);
        clamp(self.spread[c] * hits, 0.0, WIDEST)
    }

    /// Radiance of a channel. `direct` is the light that no fibre hit, its backscattering and its four lobes; `scattered` is the
    /// strength, the backscattering and the lobes R and TRT of light that was hit, whose amount is `psi` and whose lobe TT
    /// `after_tt`.
    #[inline(always)]
    fn channel(
        &self,
        c: usize,
        rows: &[ScatterRow; 2],
        direct: &[f32; 6],
        scattered: &[f32; 4],
        psi: f32,
        after_tt: f32,
    ) -> f32 {
        let [unhit, back_once, once @ ..] = direct;
        let [strength, back_after, after_r, after_trt] = scattered;
        let (d, g) = (distributions(&rows[0], self.sigma[c]), distributions(&rows[1], self.sigma[c]));
        let single = once[0] * d[0] + once[1] * d[1] + once[2] * d[2] + once[3] * self.rest[c];
        let global = after_r * g[0] + after_tt * g[1] + after_trt * (g[2] + self.rest[c]);
        let local = self.backscatter[c];
        unhit * (single + local * back_once) + strength * psi * (global + local * back_after)
    }

    /// A longitudinal lobe at the light, with the tilt of lobe `p`.
    #[inline(always)]
    fn lobe_at(&self, lobe: LongitudinalLobe, p: usize, light: &PointLight) -> f32 {
        lobe.at(light.sin_theta, light.cos_theta, self.tilted[p][0], self.tilted[p][1])
    }
}
