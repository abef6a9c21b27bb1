//! The density of hair in a sector: one block of a cross-section of a cluster.

use std::f32::consts::TAU;

use glam::Vec2;

/// Width of a sector; its height, from the inner to the outer edge, is 1.
pub const WIDTH: f32 = 1.5;
/// Grid points across, along the tangential coordinate s.
pub const ACROSS: usize = 16;
/// Grid points in height, along the radial coordinate t.
pub const HEIGHT: usize = 8;
/// The larger of the two distances between grid points.
const CELL: f32 = 1.0 / HEIGHT as f32;

/// A density field on a grid of [`ACROSS`] × [`HEIGHT`] points, the means of equal cells.
///
/// The tangential coordinate s is in 0..1 and periodic: the neighbours of a sector look like the sector, so that no seam
/// shows between them. The radial coordinate t is 0 at the inner edge and 1 at the outer one. A sector is [`WIDTH`] wide
/// and 1 high; density is optical depth per unit of length, so its mean is the optical depth along the radius.
#[derive(Clone, Debug, PartialEq)]
pub struct Sector {
    /// Density, row after row from the inner edge.
    density: [f32; ACROSS * HEIGHT],
}

/// The density of hair and its gradient at one point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Local {
    pub(crate) density: f32,
    /// Change of density per unit of length along s and t.
    pub(crate) gradient: Vec2,
}

impl Sector {
    /// The same density everywhere: `optical_depth` along the radius.
    pub fn uniform(optical_depth: f32) -> Self {
        Self { density: [optical_depth; ACROSS * HEIGHT] }
    }

    /// Without hair.
    pub fn empty() -> Self {
        Self::uniform(0.0)
    }

    /// Adds a strand, a gaussian around `(s, t)` with the standard deviation `sigma` in units of length, that adds
    /// `depth` to the sector's optical depth. What would lie beyond the inner and outer edges is spread over the rest.
    pub fn add(&mut self, at: Vec2, sigma: f32, depth: f32) {
        let mut columns = [0.0; ACROSS];
        for (i, column) in columns.iter_mut().enumerate() {
            let apart = (i as f32 + 0.5) / ACROSS as f32 - at.x;
            // A sector is 1.5 wide and a strand's gaussian is not: one period is enough.
            *column = gaussian((apart - apart.round()) * WIDTH, sigma);
        }
        let mut rows = [0.0; HEIGHT];
        for (j, row) in rows.iter_mut().enumerate() {
            *row = gaussian((j as f32 + 0.5) / HEIGHT as f32 - at.y, sigma);
        }
        let sum = columns.iter().sum::<f32>() * rows.iter().sum::<f32>();
        if sum > 0.0 {
            let scale = depth * (ACROSS * HEIGHT) as f32 / sum;
            for (j, row) in rows.iter().enumerate() {
                for (i, column) in columns.iter().enumerate() {
                    self.density[j * ACROSS + i] += scale * row * column;
                }
            }
        }
    }

    /// The standard deviation of the gaussian of a strand with `radius`, both in units of length: never so small that the
    /// grid could miss the strand.
    pub fn sigma(radius: f32) -> f32 {
        radius.max(0.75 * CELL)
    }

    /// Optical depth along the radius, the mean over s: the first feature.
    pub fn optical_depth(&self) -> f32 {
        self.density.iter().sum::<f32>() / self.density.len() as f32
    }

    /// The centroids of the density along s and t, each in 0..=1; the middle without hair.
    pub fn centroid(&self) -> Vec2 {
        let mut sum = Vec2::ZERO;
        for (i, &density) in self.density.iter().enumerate() {
            let (across, up) = ((i % ACROSS) as f32 + 0.5, (i / ACROSS) as f32 + 0.5);
            sum += density * Vec2::new(across / ACROSS as f32, up / HEIGHT as f32);
        }
        let total: f32 = self.density.iter().sum();
        if total > 0.0 { sum / total } else { Vec2::splat(0.5) }
    }

    /// The mirror image: s becomes 1 − s.
    pub fn mirrored(&self) -> Self {
        let mut out = self.clone();
        for row in out.density.chunks_exact_mut(ACROSS) {
            row.reverse();
        }
        out
    }

    /// The density at a grid point.
    fn at(&self, across: usize, up: usize) -> f32 {
        self.density[up * ACROSS + across]
    }

    /// Density and gradient at all grid points, for [`Field::at`].
    pub(crate) fn field(&self) -> Field {
        let mut points = Box::new([Local::default(); ACROSS * HEIGHT]);
        for up in 0..HEIGHT {
            let (below, above) = (up.saturating_sub(1), (up + 1).min(HEIGHT - 1));
            for across in 0..ACROSS {
                let (left, right) = ((across + ACROSS - 1) % ACROSS, (across + 1) % ACROSS);
                let along_s = (self.at(right, up) - self.at(left, up)) * ACROSS as f32 / (2.0 * WIDTH);
                let along_t = (self.at(across, above) - self.at(across, below)) * HEIGHT as f32
                    / (above - below) as f32;
                points[up * ACROSS + across] =
                    Local { density: self.at(across, up), gradient: Vec2::new(along_s, along_t) };
            }
        }
        Field(points)
    }
}

/// The density and gradient of a sector between its grid points.
pub(crate) struct Field(Box<[Local; ACROSS * HEIGHT]>);

impl Field {
    /// The value at `(s, t)`: bilinear, periodic in s and constant beyond the outermost grid points in t.
    #[inline]
    pub(crate) fn at(&self, at: Vec2) -> Local {
        let x = (at.x - at.x.floor()) * ACROSS as f32 - 0.5;
        let y = (at.y * HEIGHT as f32 - 0.5).clamp(0.0, (HEIGHT - 1) as f32);
        let (left, up) = (x.floor(), (y as usize).min(HEIGHT - 2));
        let (fx, fy) = (x - left, y - up as f32);
        let left = (left as i32).rem_euclid(ACROSS as i32) as usize;
        let right = (left + 1) % ACROSS;
        let row = |up: usize| {
            let (a, b) = (&self.0[up * ACROSS + left], &self.0[up * ACROSS + right]);
            (a.density + (b.density - a.density) * fx, a.gradient + (b.gradient - a.gradient) * fx)
        };
        let ((d0, g0), (d1, g1)) = (row(up), row(up + 1));
        Local { density: d0 + (d1 - d0) * fy, gradient: g0 + (g1 - g0) * fy }
    }
}

fn gaussian(x: f32, sigma: f32) -> f32 {
    (-0.5 * (x / sigma) * (x / sigma)).exp()
}

/// The azimuth number `k` of [`crate::layout::ANGLES`] as a direction `(sin, cos)`: along s and t. Exact mirror images.
pub(crate) fn direction(k: usize) -> Vec2 {
    // The sine of the first quarter turn gives all others without rounding errors of their own.
    let quarter = |k: usize| (TAU * k as f32 / 16.0).sin();
    let sine = |k: usize| match k % 16 {
        0 | 8 => 0.0,
        4 => 1.0,
        12 => -1.0,
        k @ 1..4 => quarter(k),
        k @ 5..8 => quarter(8 - k),
        k @ 9..12 => -quarter(k - 8),
        k => -quarter(16 - k),
    };
    Vec2::new(sine(k), sine(k + 4))
}
