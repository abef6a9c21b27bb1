//! All measurements of one entrant.

use lovelock_project::error::ProjectError;
use lovelock_render::{FrameInput, Renderer, ValueRenderer};

use super::entrants::{Entrant, file_name};
use super::maps::{Kind, at_pixels};
use super::pictures::picture_error;
use super::probe::Probe;
use super::stability::Watched;
use super::swim::swimming;
use super::work::{CheckCancel, References, Work};
use super::{banding, draw, maps, stray};
use crate::changes::StabilityReport;
use crate::report::FrameError;

impl Work<'_> {
    /// Measures one entrant. `check_cancel` is called before each draw.
    ///
    /// # Errors
    /// The error of `check_cancel`, or if something does not fit in memory or cannot be written. The entrant's report contains the
    /// numbers measured by then.
    pub(super) fn measure(
        &self,
        entrant: &mut Entrant,
        references: &References,
        (truth, cell_size): (usize, Option<f32>),
        (renderer, values, probes): (&mut Renderer, &mut ValueRenderer, &mut [Probe]),
        check_cancel: &mut CheckCancel,
    ) -> Result<(), ProjectError> {
        let project = entrant.contender.applied_to(self.project);
        let input = references.hair.frame_input(&project);
        let name = file_name(&entrant.report.name);
        let report = &mut entrant.report;
        let drawn = draw::draw(renderer, &input, self.size, self.request.draws, report, check_cancel)?;
        let [width, height] = self.size;
        report.files.picture = Some(self.folder.picture(&name, (width, height, &drawn.picture.rgba))?);
        if let Some(reference) = references.pictures.of(renderer.backend()) {
            let (difference, seen) = picture_error(&drawn.picture, reference, references.hair_pixels)
                .map_err(ProjectError::work)?;
            report.flip = Some(difference.flip);
            (report.psnr_db, report.ssim) = (difference.psnr_db, difference.ssim);
            report.files.picture_error = self.pixel_map(&name, maps::PICTURE_ERROR, &seen)?;
        }
        // The points at which light reaches clusters are not those of the strands.
        if !entrant.contender.draws_strands() {
            return Ok(());
        }

        let shadow_input = references.hair.shadow_input(&project, &self.lights[0]);
        for probe in probes {
            probe.ask(renderer, &shadow_input, &project.shadow, &report.name)?;
        }
        if let Ok(truth) = &references.truths.0[truth].transmittance {
            report.transmittance =
                Some(draw::transmittance_error(&drawn.transmittance, truth, references.points));
            let error: Vec<f32> =
                drawn.transmittance.iter().zip(truth).map(|(test, truth)| test - truth).collect();
            report.files.transmittance_error =
                self.point_map(&name, maps::TRANSMITTANCE_ERROR, &error, (values, &input))?;
        }
        if let Ok(truth) = &references.truths.0[references.common].transmittance {
            report.transmittance_common =
                Some(draw::transmittance_error(&drawn.transmittance, truth, references.points));
        }
        if let Some(points) = references.points
            && !points.is_made_by(&entrant.contender.shadow, cell_size)
        {
            report.transmittance_at_points = Some(draw::transmittance_error(
                &drawn.transmittance,
                &points.transmittance,
                references.points,
            ));
        }
        if self.request.quick && references.film.is_none() {
            return Ok(());
        }
        let mut stability = StabilityReport::default();
        if !self.request.quick {
            report.banding = banding::slab(&entrant.contender.shadow);
            report.stray = stray::stray(&entrant.contender.shadow);
            let swim = swimming(renderer, references.shifted, (&project, &self.lights[0]), check_cancel)?;
            report.files.swim = self.point_map(&name, maps::SWIM, &swim.per_point, (values, &input))?;
            (stability.swim, stability.swim_p99) = (Some(swim.rms), Some(swim.p99));
        }
        if let Some(film) = references.film {
            let Watched { pop, flicker, errors } = film.watch(renderer, &project, truth, check_cancel)?;
            stability.film_rmse = whole_film(&errors);
            report.frame_errors = errors;
            (stability.pop, stability.pop_p99) = (Some(pop.max), Some(pop.p99));
            report.files.pop = self.point_map(&name, maps::POP, &pop.per_point, (values, &input))?;
            if let Some(flicker) = flicker {
                stability.flicker = Some(flicker.rms);
                report.files.flicker =
                    self.point_map(&name, maps::FLICKER, &flicker.per_point, (values, &input))?;
            }
        }
        report.stability = Some(stability);
        if let Some(sweep) = references.light_sweep {
            report.light_sweep =
                Some(sweep.watch(renderer, (references.hair, &project), truth, check_cancel)?);
        }
        Ok(())
    }

    /// Renders values per strand point as a map and writes it.
    fn point_map(
        &self,
        name: &str,
        kind: Kind,
        numbers: &[f32],
        (values, input): (&mut ValueRenderer, &FrameInput),
    ) -> Result<Option<String>, ProjectError> {
        let pixels = at_pixels(values, input, numbers, self.size)?;
        self.pixel_map(name, kind, &pixels)
    }

    /// Writes values per pixel as a map.
    pub(super) fn pixel_map(
        &self,
        name: &str,
        kind: Kind,
        numbers: &[f32],
    ) -> Result<Option<String>, ProjectError> {
        let Some((width, height, rgba)) = kind.painted(self.size[0], self.size[1], numbers) else {
            return Ok(None);
        };
        self.folder.picture(&format!("{name}.{}", kind.id), (width, height, &rgba)).map(Some)
    }
}

/// The root mean square error over all frames; `None` without frames.
fn whole_film(errors: &[FrameError]) -> Option<f64> {
    let squares: f64 = errors.iter().map(|error| error.rmse * error.rmse).sum();
    (!errors.is_empty()).then(|| (squares / errors.len() as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_film_is_the_root_mean_square_over_its_frames() {
        let of = |rmse| FrameError { rmse, bias: 0.0 };
        let found = whole_film(&[of(0.3), of(0.4)]).expect("frames");
        assert!((found - 0.125_f64.sqrt()).abs() < 1e-12);
        assert_eq!(whole_film(&[]), None);
    }
}
