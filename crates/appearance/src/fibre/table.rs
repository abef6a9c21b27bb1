//! Tables of the azimuthal distribution of a whole fibre, for every absorption.
// Inlined into the loops of a renderer; a call would prevent vectorisation.
#![allow(clippy::inline_always)]

use std::f64::consts::PI;

use rayon::prelude::*;

use super::arithmetic::{clamp, exp};
use super::{Fibre, FibrePath, Quadrature, TrimmedLogistic};

/// Steps of the azimuth, 0 to pi.
pub const AZIMUTHS: usize = 64;
/// Steps of the eye's cosine, [`SMALLEST_COSINE`] to 1.
pub const COSINES: usize = 16;
/// The smallest cosine of the tables; a smaller one counts as this.
pub const SMALLEST_COSINE: f32 = 0.05;
/// The smallest azimuthal roughness of the tables. The samples over the width of the fibre resolve no sharper lobe.
pub const SMOOTHEST_AROUND: f64 = 0.15;
/// Points over the width of the fibre.
pub(super) const WIDTH_POINTS: usize = 96;
/// Absorptions through which the fit passes exactly, besides zero.
const FITTED: [f64; 2] = [0.4, 2.0];

/// A row of a [`ScatterTable`]: the distribution of the lobes at one azimuth and eye, for every absorption sigma.
///
/// With `x = L sigma / (1 + c sigma)`:
///
/// | index | value | distribution, per radian |
/// |---|---|---|
/// | 0 | `D_R` | R: `D_R` |
/// | 1, 2, 3 | `D0`, `L`, `c` of TT | TT: `D0 exp(-x)` |
/// | 4, 5, 6 | `D0`, `L`, `c` of TRT | TRT: `D0 exp(-x)` |
/// | 7 | 0 | keeps rows at 32 bytes. The rest is the same at every azimuth and comes from [`super::ManyRow`] |
pub type ScatterRow = [f32; 8];

/// Distribution of scattered light over the azimuth, averaged over the width of the fibre.
///
/// The rows are a flat array of 64 x 16 rows of 8 values (32 KB). Row `j * 64 + i` is that of the azimuth `pi i / 63` and of the
/// eye's cosine `(r + (1 - r) j / 15)^2` with `r = sqrt(0.05)`, which are closer at grazing angles because reflection rises
/// there. Values between are interpolated bilinearly. The table depends on the azimuthal roughness and the index of refraction,
/// and on nothing else.
#[derive(Clone, Debug, PartialEq)]
pub struct ScatterTable {
    rows: Vec<ScatterRow>,
}

/// Two neighbouring rows of the eye's cosine and the weight of the second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CosineStep {
    /// The first of the two, 0 to 14.
    pub index: usize,
    /// Weight of the second, 0 to 1.
    pub fraction: f32,
}

impl CosineStep {
    /// The step of a cosine.
    #[inline(always)]
    pub fn new(cos_o: f32) -> Self {
        let low = SMALLEST_COSINE.sqrt();
        let position = (COSINES - 1) as f32 * (cos_o.max(0.0).sqrt() - low) / (1.0 - low);
        let (index, fraction) = step(position, COSINES);
        Self { index, fraction }
    }
}

/// Index and fraction of the position `x` among `count` entries. A position that is not a number counts as zero.
#[inline(always)]
pub(super) fn step(x: f32, count: usize) -> (usize, f32) {
    let x = clamp(x, 0.0, (count - 1) as f32);
    let index = (x as usize).min(count - 2);
    (index, x - index as f32)
}

/// The cosine of entry `j` of the tables.
pub(super) fn cosine(j: usize) -> f64 {
    let low = f64::from(SMALLEST_COSINE).sqrt();
    (low + (1.0 - low) * j as f64 / (COSINES - 1) as f64).powi(2).min(1.0)
}

/// Values of the rows of a table at `N` points, one array per value.
pub(super) type Columns<const N: usize> = [[f32; N]; 8];

/// Places between four rows of a table: the first of them, and the weights of the next one and of the one `stride` rows later.
pub(super) struct Between<const N: usize> {
    pub first: [usize; N],
    pub next: [f32; N],
    pub later: [f32; N],
    pub stride: usize,
}

impl<const N: usize> Between<N> {
    /// Bilinear means of the rows around each place; zero beyond the end.
    #[inline(always)]
    pub fn columns(&self, rows: &[[f32; 8]]) -> Columns<N> {
        let mut columns = [[0.0; N]; 8];
        for (lane, &first) in self.first.iter().enumerate() {
            let (x, y) = (self.next[lane], self.later[lane]);
            let weights = [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y];
            // One comparison in place of four.
            let Some(rows) = rows.get(first..first + self.stride + 2) else { continue };
            let (a, b, c, d) = (&rows[0], &rows[1], &rows[self.stride], &rows[self.stride + 1]);
            let mut mean = [0.0; 8];
            for k in 0..8 {
                mean[k] = weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k] + weights[3] * d[k];
            }
            for k in 0..8 {
                columns[k][lane] = mean[k];
            }
        }
        columns
    }
}

/// The values of one point.
#[inline(always)]
pub(super) fn row_of(columns: Columns<1>) -> [f32; 8] {
    columns.map(|[value]| value)
}

impl ScatterTable {
    /// The table of the distribution itself and that of its mean over 90 degrees to both sides, which is the distribution of
    /// light that many fibres scattered forward before ([`TrimmedLogistic::mean_over_half`]).
    pub fn bake(fibre: &Fibre) -> [Self; 2] {
        let fibre = fibre.clamped();
        let logistic = TrimmedLogistic::new(fibre.roughness_around.max(SMOOTHEST_AROUND));
        let rule = Quadrature::new(WIDTH_POINTS);
        let by_cosine: Vec<_> = (0..COSINES)
            .into_par_iter()
            .map(|j| rows_of_cosine(fibre.index, &logistic, cosine(j), &rule))
            .collect();
        [0, 1].map(|which| Self {
            rows: by_cosine.iter().flat_map(|rows| rows[which].iter().copied()).collect(),
        })
    }

    /// All values as a flat array of 8,192 numbers, for a buffer of the GPU.
    pub fn values(&self) -> &[f32] {
        self.rows.as_flattened()
    }

    /// The row at an eye and an azimuth; the sign of the azimuth has no effect.
    pub fn row(&self, eye: CosineStep, phi: f32) -> ScatterRow {
        row_of(self.columns(&[eye], &[phi]))
    }

    /// The rows of several eyes and azimuths, by value.
    #[inline(always)]
    pub(super) fn columns<const N: usize>(&self, eye: &[CosineStep; N], phi: &[f32; N]) -> Columns<N> {
        let mut at = Between { first: [0; N], next: [0.0; N], later: [0.0; N], stride: AZIMUTHS };
        for lane in 0..N {
            let position = phi[lane].abs() * ((AZIMUTHS - 1) as f32 / std::f32::consts::PI);
            let (i, x) = step(position, AZIMUTHS);
            at.first[lane] = eye[lane].index * AZIMUTHS + i;
            (at.next[lane], at.later[lane]) = (x, eye[lane].fraction);
        }
        at.columns(&self.rows)
    }
}

/// The distributions of R, TT and TRT in a row, for one absorption.
#[inline(always)]
pub fn distributions(row: &ScatterRow, sigma: f32) -> [f32; 3] {
    let tt = exp(-row[2] * sigma / (1.0 + row[3] * sigma));
    let trt = exp(-row[5] * sigma / (1.0 + row[6] * sigma));
    [row[0], row[1] * tt, row[4] * trt]
}

fn rows_of_cosine(
    index: f64,
    logistic: &TrimmedLogistic,
    cos_o: f64,
    rule: &Quadrature,
) -> [[ScatterRow; AZIMUTHS]; 2] {
    let sin_o = (1.0 - cos_o * cos_o).sqrt();
    let paths: Vec<_> = rule
        .points
        .iter()
        .map(|&(h, weight)| {
            let path = FibrePath::new(index, sin_o, cos_o, h);
            let attenuations =
                [0.0, FITTED[0], FITTED[1]].map(|s| path.attenuation(s).map(|a| 0.5 * weight * a));
            ([0, 1, 2].map(|p| path.exit_azimuth(p)), attenuations)
        })
        .collect();
    let mut rows = [[[0.0; 8]; AZIMUTHS]; 2];
    for (which, rows) in rows.iter_mut().enumerate() {
        // Per azimuth and lobe, the distribution at the three absorptions of the fit.
        let mut exact = [[[0.0; 3]; 3]; AZIMUTHS];
        for (i, d) in exact.iter_mut().enumerate() {
            let phi = PI * i as f64 / (AZIMUTHS - 1) as f64;
            for (exits, attenuations) in &paths {
                for p in 0..3 {
                    let from_exit = phi - exits[p];
                    let n = if which == 0 {
                        logistic.density(from_exit)
                    } else {
                        logistic.mean_over_half(from_exit)
                    };
                    for s in 0..3 {
                        d[p][s] += n * attenuations[s][p];
                    }
                }
            }
        }
        for (i, row) in rows.iter_mut().enumerate() {
            let d: [[f64; 3]; 3] =
                std::array::from_fn(|p| std::array::from_fn(|s| balanced(&exact, i, |d| d[p][s])));
            let ([tt, trt], r) = ([d[1], d[2]].map(fit), d[0][0]);
            *row = [r, tt[0], tt[1], tt[2], trt[0], trt[1], trt[2], 0.0].map(|x| x as f32);
        }
    }
    rows
}

/// The entry at azimuth `i` of a table of one of the `exact` values, so that straight lines between the entries deviate from the curve by
/// as much above as below.
///
/// Between exact entries `h` apart a line deviates from the curve by up to `h^2 / 8` times its second derivative. Entries that are moved by
/// half of that to the other side halve the error. The curve is even at both ends.
fn balanced(exact: &[[[f64; 3]; 3]; AZIMUTHS], i: usize, of: impl Fn(&[[f64; 3]; 3]) -> f64) -> f64 {
    let (before, after) = (&exact[i.abs_diff(1)], exact.get(i + 1).unwrap_or(&exact[AZIMUTHS - 2]));
    let here = of(&exact[i]);
    let moved = here - (of(before) - 2.0 * here + of(after)) / 16.0;
    // Values stay positive beside a steep edge.
    moved.max(0.5 * here)
}

/// `D0`, `L` and `c` of `D0 exp(-L sigma / (1 + c sigma))` through the values at zero and at [`FITTED`].
fn fit(d: [f64; 3]) -> [f64; 3] {
    // sigma over the optical depth is a straight line in sigma: 1/L + (c/L) sigma.
    let depth = |d_sigma: f64| (d[0].max(1e-300) / d_sigma.max(1e-300)).ln().max(1e-9);
    let [low, high] = [FITTED[0] / depth(d[1]), FITTED[1] / depth(d[2])];
    let slope = ((high - low) / (FITTED[1] - FITTED[0])).max(0.0);
    let at_zero = (low - slope * FITTED[0]).max(1e-6);
    [d[0], 1.0 / at_zero, slope / at_zero]
}
