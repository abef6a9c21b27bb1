//! Converged transmittance: the reference for the error of a finite resolution.
//!
//! Strands are ribbons of the width with which they block light, with uniform optical depth. A point receives the mean of the
//! light over the footprint of one texel around it. Both are sampled by subtexels, twice as many along each edge in every round,
//! until the result hardly changes.

mod footprint;
mod ribbons;
mod strips;

use crate::methods::exact::cpu::{sort_and_sum, sum_before};
use crate::methods::texels::TexelFrame;
use crate::methods::texels::fragments::Fragments;
use crate::methods::voxel_map::longest_strand;
use crate::perspective::{Projected, perspective_of};
use crate::{ShadowError, ShadowInput, ShadowSettings};
use footprint::Footprint;
use glam::Vec3;
use rayon::prelude::*;
use ribbons::Ribbons;
use strips::Strips;

/// The RMS change of transmittance over the points, in the round that doubles the samples for the last time, below which the
/// result counts as converged. From four subtexels to eight it is about 3e-3 on hair.
pub const CONVERGED_CHANGE: f32 = 2e-3;

/// The most subtexels along the edge of a texel.
pub const MAX_CONVERGED_SAMPLES: u32 = 32;

/// The samples of a light with soft shadows in the first round, and the most.
const LEAST_LIGHT_SAMPLES: u32 = 8;
/// See [`LEAST_LIGHT_SAMPLES`].
const MAX_LIGHT_SAMPLES: u32 = 64;

/// The first round that may be the last: two coarser rounds could agree because both miss features below a subtexel.
const LEAST_SAMPLES: u32 = 4;

/// Transmittance averaged over footprints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Converged {
    /// Transmittance of each point, 0 to 1.
    pub transmittance: Vec<f32>,
    /// Subtexels along the edge of a texel in the last round.
    pub samples: u32,
    /// Samples of the light in the last round: 1 of one with hard shadows.
    pub light_samples: u32,
    /// RMS change in the last round. Above [`CONVERGED_CHANGE`] only if [`MAX_CONVERGED_SAMPLES`] was reached.
    pub change: f32,
    /// Samples and RMS change of every round but the first.
    pub changes: Vec<(u32, f32)>,
}

/// The mean of the light over the box of one texel around each of the points `x`, `y`, `z` (world space, metres; slices of the
/// same length), to within [`CONVERGED_CHANGE`]. The light of an area is the mean over at least 16 samples of it, whatever number methods use. A point that is not finite gets 1.
///
/// The texel is that of the map of the method in `settings`: a cell of the voxel map, and for `none` the texel of `exact`. Only what strands are (their width, `extinction_scale`) enters beside it. The result is the same for any
/// number of threads. Time grows with the square of the samples and with the area around the points; memory is bounded,
/// because the light plane is processed in strips.
///
/// # Errors
/// [`ShadowError::TooLarge`] of the method `exact` if one row of subtexels needs more than the memory limit in the settings
/// of `exact`.
pub fn converged(
    input: &ShadowInput,
    settings: &ShadowSettings,
    [x, y, z]: [&[f32]; 3],
) -> Result<Converged, ShadowError> {
    assert!(x.len() == y.len() && y.len() == z.len(), "slices of one length");
    if input.light.area.samples > 1 {
        return converged_area(input, settings, [x, y, z]);
    }
    converged_hard(input, settings, [x, y, z])
}

/// [`converged`] for a light with soft shadows: the mean over twice as many samples of it, and as many again, until the result hardly
/// changes or there are [`MAX_LIGHT_SAMPLES`].
fn converged_area(
    input: &ShadowInput,
    settings: &ShadowSettings,
    points: [&[f32]; 3],
) -> Result<Converged, ShadowError> {
    let mean = |count: u32| -> Result<Converged, ShadowError> {
        let mut sums = vec![0.0; points[0].len()];
        let mut all = Converged::default();
        for light in input.light.sampled(input.anchor, count) {
            let found = converged_hard(&ShadowInput { light, ..*input }, settings, points)?;
            sums.iter_mut().zip(&found.transmittance).for_each(|(sum, t)| *sum += t);
            all.join(&found, &[]);
        }
        all.transmittance = sums.into_iter().map(|sum| sum / count as f32).collect();
        Ok(all)
    };
    let mut count = LEAST_LIGHT_SAMPLES;
    let mut last = mean(count)?;
    loop {
        count *= 2;
        let mut next = mean(count)?;
        let light_change = rms_change(&last.transmittance, &next.transmittance);
        next.light_samples = count;
        if light_change <= CONVERGED_CHANGE || count >= MAX_LIGHT_SAMPLES {
            next.change = next.change.max(light_change);
            return Ok(next);
        }
        last = next;
    }
}

/// The root mean square of the differences.
fn rms_change(a: &[f32], b: &[f32]) -> f32 {
    let squares: f64 = a.iter().zip(b).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum();
    (squares / b.len().max(1) as f64).sqrt() as f32
}

/// [`converged`] for a light with hard shadows.
fn converged_hard(
    input: &ShadowInput,
    settings: &ShadowSettings,
    [x, y, z]: [&[f32]; 3],
) -> Result<Converged, ShadowError> {
    let Some(perspective) = perspective_of(input, settings) else {
        return converged_parallel(input, settings, [x, y, z]);
    };
    let mut all = Converged { transmittance: vec![1.0; x.len()], light_samples: 1, ..Converged::default() };
    let longest = longest_strand(input.strands);
    let faces = perspective.faces().len() as u32;
    let settings = &if faces > 1 { settings.for_sides() } else { *settings };
    for (at, face) in perspective.faces().iter().enumerate() {
        let Some(face) = face else { continue };
        let point = |i: usize| Vec3::new(x[i], y[i], z[i]);
        let these: Vec<_> = (0..x.len()).filter(|i| perspective.face_of(point(*i)) == at).collect();
        let places: Vec<_> = these.iter().map(|i| face.project(point(*i))).collect();
        let [x, y, z] = [0, 1, 2].map(|axis| places.iter().map(|p| p[axis]).collect::<Vec<_>>());
        let projected = Projected::new(input, face, longest, false);
        let found = converged_parallel(&projected.input(input, face, faces), settings, [&x, &y, &z])?;
        all.join(&found, &these);
    }
    Ok(all)
}

impl Converged {
    /// Puts what was found for the points `these` in their places. Of samples and changes the larger ones remain.
    fn join(&mut self, found: &Self, these: &[usize]) {
        these.iter().zip(&found.transmittance).for_each(|(i, t)| self.transmittance[*i] = *t);
        self.samples = self.samples.max(found.samples);
        self.change = self.change.max(found.change);
        for &(samples, change) in &found.changes {
            match self.changes.iter_mut().find(|(known, _)| *known == samples) {
                Some((_, known)) => *known = known.max(change),
                None => self.changes.push((samples, change)),
            }
        }
    }
}

/// [`converged`] for light that is parallel.
fn converged_parallel(
    input: &ShadowInput,
    settings: &ShadowSettings,
    [x, y, z]: [&[f32]; 3],
) -> Result<Converged, ShadowError> {
    let bounds = input.bounds();
    let frame = settings.footprint(input, &bounds);
    let axes = frame.axes();
    let place = |((x, y), z): ((&f32, &f32), &f32)| axes.transform(Vec3::new(*x, *y, *z));
    let places: Vec<_> = x.par_iter().zip(y).zip(z).map(place).collect();

    let mut scratch = Fragments::default();
    let mut samples = 1;
    let mut last = round(input, settings, &frame, &places, samples, &mut scratch)?;
    let mut change = f32::INFINITY;
    let mut changes = Vec::new();
    while samples < LEAST_SAMPLES || (change > CONVERGED_CHANGE && samples < MAX_CONVERGED_SAMPLES) {
        samples *= 2;
        let next = round(input, settings, &frame, &places, samples, &mut scratch)?;
        change = rms_change(&last, &next);
        changes.push((samples, change));
        last = next;
    }
    Ok(Converged { transmittance: last, samples, light_samples: 1, change, changes })
}

/// Transmittance with `samples` subtexels along the edge of a texel.
fn round(
    input: &ShadowInput,
    settings: &ShadowSettings,
    frame: &TexelFrame,
    places: &[Vec3],
    samples: u32,
    scratch: &mut Fragments,
) -> Result<Vec<f32>, ShadowError> {
    let ribbons = Ribbons::new(input, frame, samples, places);
    let strips = Strips::new(input, settings, frame, &ribbons)?;
    // The light lost in each footprint, in subtexels.
    let mut lost = vec![0.0_f64; places.len()];
    for rows in strips.rows {
        let strip = ribbons.within(&rows);
        scratch.draw(input, frame, (strip.columns(), rows.len() as u32), &strip);
        scratch.bands().into_par_iter().with_max_len(1).for_each(|mut band| {
            band.for_each_texel(|_, fragments| sort_and_sum(fragments));
        });
        lost.par_iter_mut().zip(places).with_min_len(64).for_each(|(lost, place)| {
            let Some(footprint) = Footprint::new(*place, samples) else { return };
            let light = |column, row| {
                let texel = scratch.place(column, row - rows.start);
                crate::exp::exp_of_minus(sum_before(scratch.texel(texel), place.z))
            };
            *lost += footprint.lost(&rows, strip.columns(), light);
        });
    }
    let area = f64::from(samples).powi(2);
    Ok(lost.into_iter().map(|lost| (1.0 - lost / area).clamp(0.0, 1.0) as f32).collect())
}
