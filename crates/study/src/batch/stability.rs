//! Temporal stability of a method over the frames of a film.

use std::sync::Arc;

use lovelock_metrics::{Errors, Stability, errors, flicker, pop};
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_render::{FrameInput, Light, Picture, Renderer};
use lovelock_session::snapshot::FrameSnapshot;

use super::hair::{Hair, LitHair};
use super::truth::{Truth, converge};
use super::work::CheckCancel;
use crate::report::{FootprintTruth, FrameError, NamedTruth, Reference};

/// Size of images that are rendered only for their transmittance, pixels.
pub(super) const SMALL: u32 = 16;

/// Memory limit of all frames of all ground truths together, bytes.
const MAX_BYTES: u64 = 4 << 30;

/// Transmittance of the first light at every strand point, as used by `renderer`.
pub(super) fn drawn(renderer: &mut Renderer, input: &FrameInput) -> Result<Vec<f32>, ProjectError> {
    renderer.picture(input, SMALL, SMALL, &mut Picture::default())?;
    Ok(renderer.transmittance(0)?)
}

/// Checks whether the transmittance of that many frames and points fits in memory, for every ground truth and one method.
///
/// # Errors
/// What does not fit, with numbers.
pub(super) fn fits(what: &str, frames: u64, points: usize, truths: usize) -> Result<(), String> {
    let bytes = frames.saturating_mul(points as u64).saturating_mul(4 * (truths as u64 + 1));
    if bytes > MAX_BYTES {
        return Err(format!(
            "{what} over {frames} frames of {points} points need {} MiB, more than the limit of {} MiB: compare fewer \
             frames or points at once",
            bytes >> 20,
            MAX_BYTES >> 20
        ));
    }
    Ok(())
}

/// What a method does over the frames of a film.
pub(super) struct Watched {
    pub pop: Stability,
    /// Against the ground truth.
    pub flicker: Option<Stability>,
    /// Errors of each frame against the ground truth; empty if it is unknown.
    pub errors: Vec<FrameError>,
}

/// The frames of a comparison and their ground truth.
pub(super) struct Film {
    snapshots: Vec<Arc<FrameSnapshot>>,
    /// Transmittance per ground truth and frame; `None` if unknown.
    truths: Vec<Option<Vec<Vec<f32>>>>,
}

impl Film {
    /// Computes the ground truth of every frame; `check_cancel` is called before each. `reference` receives the convergence of the
    /// frames after the first (of the ground truth that changed most), and the missing ones.
    ///
    /// # Errors
    /// The error of `check_cancel`.
    pub(super) fn new(
        (first_frame, snapshots): (u64, &[Arc<FrameSnapshot>]),
        project: &Project,
        light: &Light,
        known: &[Truth],
        reference: &mut Reference,
        mut check_cancel: impl FnMut() -> Result<(), ProjectError>,
    ) -> Result<Self, ProjectError> {
        let mut truths: Vec<_> =
            known.iter().map(|truth| truth.transmittance.is_ok().then(Vec::new)).collect();
        for (frame, snapshot) in snapshots.iter().enumerate() {
            let hair = Hair::new(Arc::clone(snapshot), project);
            let name = format!("frame {}", first_frame + frame as u64);
            let mut worst: Option<FootprintTruth> = None;
            for (of_truth, known) in truths.iter_mut().zip(known) {
                let Some(frames) = of_truth else { continue };
                check_cancel()?;
                let found = if let (0, Ok(found)) = (frame, &known.transmittance) {
                    Ok(found.clone())
                } else {
                    let (found, facts) = converge(LitHair { hair: &hair, project, light }, &known.settings);
                    if found.is_ok() && worst.as_ref().is_none_or(|worst| worst.change < facts.change) {
                        worst = Some(facts);
                    }
                    found
                };
                match found {
                    Ok(found) => frames.push(found),
                    Err(error) => {
                        *of_truth = None;
                        reference.refused.push(format!("the truth of {name}: {error}"));
                    }
                }
            }
            reference.others.extend(worst.map(|facts| NamedTruth::new(name, &facts)));
        }
        Ok(Self { snapshots: snapshots.to_vec(), truths })
    }

    /// Pop, and flicker and errors against the ground truth of this number.
    ///
    /// # Errors
    /// As rendering, or the error of `check_cancel`, which is called before each frame.
    pub(super) fn watch(
        &self,
        renderer: &mut Renderer,
        project: &Project,
        truth: usize,
        check_cancel: &mut CheckCancel,
    ) -> Result<Watched, ProjectError> {
        let mut frames = Vec::with_capacity(self.snapshots.len());
        for snapshot in &self.snapshots {
            check_cancel()?;
            let hair = Hair::new(Arc::clone(snapshot), project);
            frames.push(drawn(renderer, &hair.frame_input(project))?);
        }
        let truth = self.truths.get(truth).and_then(Option::as_ref);
        let of_frames = truth.map(|truth| {
            let of = |(frame, truth): (&Vec<f32>, &Vec<f32>)| errors(frame, truth);
            frames
                .iter()
                .zip(truth)
                .map(of)
                .map(|Errors { rmse, bias, .. }| FrameError { rmse, bias })
                .collect()
        });
        Ok(Watched {
            pop: pop(&frames),
            flicker: truth.map(|truth| flicker(&frames, truth)),
            errors: of_frames.unwrap_or_default(),
        })
    }

    /// The snapshots of the frames.
    pub(super) fn snapshots(&self) -> &[Arc<FrameSnapshot>] {
        &self.snapshots
    }

    /// The ground truth of this number in a frame.
    pub(super) fn truth(&self, truth: usize, frame: usize) -> Option<&[f32]> {
        Some(self.truths.get(truth)?.as_ref()?.get(frame)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_that_does_not_fit_is_refused_with_the_numbers() {
        assert_eq!(fits("pop", 30, 100_000, 2), Ok(()));
        let error = fits("pop", 10_000, 1_000_000, 2).expect_err("110 GiB");
        assert!(error.contains("10000 frames") && error.contains("4096 MiB"), "{error}");
        assert!(fits("pop", u64::MAX, usize::MAX, 9).is_err());
    }
}
