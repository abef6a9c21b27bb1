//! Pixels of any number averaged onto a small picture, and values that no light has replaced on the way.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::LARGEST_RADIANCE;
use crate::environment::error::{MAX_HEIGHT, MAX_WIDTH, Problem};

/// Size of the picture that the light is taken from, width and height. Three orders of harmonics need far less; the
/// direction of the sun is found to within its own diameter.
const REDUCED: [usize; 2] = [512, 256];

/// What stands for an infinity: the largest half-precision float, as a half that overflowed is where most come from.
const INFINITY: f32 = 65_504.0;

/// What was found in a picture and mended. Counts are of pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Notes {
    /// With a component that is not a number, taken as 0, or an infinity, taken as 65504, or as 0 where negative.
    pub not_finite: u64,
    /// With a negative component, taken as 0.
    pub negative: u64,
    /// With a component above [`LARGEST_RADIANCE`], taken as that.
    pub too_bright: u64,
    /// Of the display window of an `OpenEXR` picture that the file does not store, taken as black.
    pub missing: u64,
    /// The width is not twice the height. The picture is stretched over the sphere all the same.
    pub stretched: bool,
}

impl Notes {
    /// One sentence per kind of finding, for the interface; none for a picture in order.
    pub fn messages(&self) -> Vec<String> {
        let mut messages = Vec::new();
        let mut note = |count: u64, what: &str| {
            if count > 0 {
                messages.push(format!("{count} {} {what}", if count == 1 { "pixel" } else { "pixels" }));
            }
        };
        note(self.not_finite, "not finite: set to 0, or to 65504 where infinite");
        note(self.negative, "negative: set to 0");
        note(self.too_bright, "brighter than 1e10: set to 1e10");
        note(self.missing, "not stored in the file: set to black");
        if self.stretched {
            messages.push("the width is not twice the height: stretched over the whole sphere".to_owned());
        }
        messages
    }
}

/// A small picture; its texels are uniform in latitude and longitude.
#[derive(Clone, Debug)]
pub(in crate::environment) struct Reduced {
    pub width: usize,
    pub height: usize,
    /// Radiance, row by row from the top.
    pub texels: Vec<DVec3>,
}

impl Reduced {
    pub fn rows(&self) -> impl Iterator<Item = &[DVec3]> {
        self.texels.chunks_exact(self.width)
    }

    /// Sines of the latitude at the upper and the lower border of a row.
    pub fn sines(&self, row: usize) -> (f64, f64) {
        (sine(row as f64 / self.height as f64), sine((row + 1) as f64 / self.height as f64))
    }

    /// Solid angle of a texel of a row, steradians.
    pub fn solid_angle(&self, row: usize) -> f64 {
        let (top, bottom) = self.sines(row);
        (top - bottom) * TAU / self.width as f64
    }

    /// Unit vector to the centre of a texel.
    pub fn direction(&self, at: usize) -> DVec3 {
        let (column, row) = (at % self.width, at / self.width);
        let azimuth = PI - TAU * (column as f64 + 0.5) / self.width as f64;
        let (y, across) = (PI * (0.5 - (row as f64 + 0.5) / self.height as f64)).sin_cos();
        DVec3::new(across * azimuth.sin(), y, across * azimuth.cos())
    }
}

/// Averages pixels onto a small picture, in any order of rows and parts of rows.
///
/// Every pixel is weighed by its solid angle, so the light of the whole sphere is kept.
#[derive(Clone, Debug)]
pub(in crate::environment) struct Reducer {
    size: [usize; 2],
    target: [usize; 2],
    sums: Vec<DVec3>,
    /// One row of sums, kept to save allocations.
    line: Vec<DVec3>,
    notes: Notes,
    added: u64,
}

impl Reducer {
    /// For a picture of `width` x `height` pixels, refused before anything is allocated where it is too large.
    pub fn new(width: u64, height: u64) -> Result<Self, Problem> {
        if width == 0 || height == 0 {
            return Err(Problem::Empty { width, height });
        }
        if width > u64::from(MAX_WIDTH) || height > u64::from(MAX_HEIGHT) {
            return Err(Problem::TooLarge { width, height });
        }
        Ok(Self::onto([width as usize, height as usize], REDUCED))
    }

    /// As [`Reducer::new`], onto a picture of the same shape with at most `side` pixels along its longest side.
    pub fn within(width: u64, height: u64, side: u32) -> Result<Self, Problem> {
        let whole = Self::new(width, height)?.size;
        let scale = (f64::from(side) / whole[0].max(whole[1]) as f64).min(1.0);
        Ok(Self::onto(whole, whole.map(|of| ((of as f64 * scale).round() as usize).max(1))))
    }

    /// From one size onto another, or onto the same where the other is larger. Both are at least 1 x 1.
    pub fn onto(size: [usize; 2], target: [usize; 2]) -> Self {
        let target = [target[0].min(size[0]), target[1].min(size[1])];
        let notes = Notes { stretched: size[0] != 2 * size[1], ..Notes::default() };
        let sums = vec![DVec3::ZERO; target[0] * target[1]];
        Self { size, target, sums, line: vec![DVec3::ZERO; target[0]], notes, added: 0 }
    }

    pub fn size(&self) -> [u32; 2] {
        self.size.map(|side| side as u32)
    }

    /// What was found so far; complete after the last pixel.
    pub fn notes(&self) -> Notes {
        let whole = (self.size[0] * self.size[1]) as u64;
        Notes { missing: whole.saturating_sub(self.added), ..self.notes }
    }

    /// Adds pixels of row `y`, from column `x` to the right. What lies outside of the picture is ignored.
    pub fn add(&mut self, x: usize, y: usize, pixels: impl IntoIterator<Item = [f32; 3]>) {
        let ([width, height], [columns, rows]) = (self.size, self.target);
        if x >= width || y >= height {
            return;
        }
        self.line.fill(DVec3::ZERO);
        for (pixel, at) in pixels.into_iter().zip(x..width) {
            let texel = mended(pixel, &mut self.notes);
            self.added += 1;
            // A pixel is no wider than a texel and lies in one or in two of them.
            let (first, share) = split(at, width, columns);
            self.line[first] += texel * share;
            if share < 1.0 {
                self.line[first + 1] += texel * (1.0 - share);
            }
        }
        let (first, share) = split(y, height, rows);
        let (top, bottom) = (y as f64 / height as f64, (y + 1) as f64 / height as f64);
        let border = if share < 1.0 { (first + 1) as f64 / rows as f64 } else { bottom };
        let above = sine(top) - sine(border);
        let below = sine(border) - sine(bottom);
        for (row, weight) in [(first, above), (first + 1, below)] {
            if weight > 0.0 && row < rows {
                let sums = &mut self.sums[row * columns..(row + 1) * columns];
                for (sum, &line) in sums.iter_mut().zip(&self.line) {
                    *sum += line * weight;
                }
            }
        }
    }

    /// The means of all pixels; those that were not added count as black.
    pub fn finish(&self) -> Reduced {
        let [width, height] = self.target;
        let mut reduced = Reduced { width, height, texels: self.sums.clone() };
        let pixels_per_texel = self.size[0] as f64 / width as f64;
        for row in 0..height {
            let (top, bottom) = reduced.sines(row);
            let scale = 1.0 / ((top - bottom) * pixels_per_texel);
            for texel in &mut reduced.texels[row * width..(row + 1) * width] {
                *texel *= scale;
            }
        }
        reduced
    }
}

/// Sine of the latitude at `v`, the part of the height from the top.
fn sine(v: f64) -> f64 {
    (PI * v).cos()
}

/// The first of `targets` that pixel `at` of `pixels` covers, and the part of the pixel in it.
fn split(at: usize, pixels: usize, targets: usize) -> (usize, f64) {
    // In units in which a pixel is `targets` wide and a target `pixels`.
    let first = at * targets / pixels;
    let inside = (first + 1) * pixels - at * targets;
    (first, if inside >= targets { 1.0 } else { inside as f64 / targets as f64 })
}

/// A pixel as light can be, with what was replaced counted.
fn mended(pixel: [f32; 3], notes: &mut Notes) -> DVec3 {
    if pixel.iter().all(|value| (0.0..=LARGEST_RADIANCE).contains(value)) {
        return DVec3::from_array(pixel.map(f64::from));
    }
    let any = |is: fn(&f32) -> bool| u64::from(pixel.iter().any(is));
    notes.not_finite += any(|value| !value.is_finite());
    notes.negative += any(|value| value.is_finite() && *value < 0.0);
    notes.too_bright += any(|value| value.is_finite() && *value > LARGEST_RADIANCE);
    DVec3::from_array(pixel.map(|value| {
        f64::from(match value {
            _ if value.is_nan() => 0.0,
            f32::INFINITY => INFINITY,
            _ => value.clamp(0.0, LARGEST_RADIANCE),
        })
    }))
}

/// Luminance of linear Rec. 709.
pub(in crate::environment) fn luminance(rgb: DVec3) -> f64 {
    rgb.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}
