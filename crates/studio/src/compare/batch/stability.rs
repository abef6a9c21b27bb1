//! How still a method stands: under shifts of its map, and from frame to frame.

use std::sync::Arc;

use glam::Vec3;
use lovelock_metrics::{Stability, flicker, pop, swim};
use lovelock_render::{FrameInput, Light, Picture, Renderer};
use lovelock_shadow::LightFrame;

use super::hair::Hair;
use super::truth::{Truth, converge};
use super::work::Tell;
use crate::{FootprintTruth, FrameSnapshot, NamedTruth, Project, Reference, StudioError};

/// Shifts of the map.
const SHIFTS: usize = 6;

/// Pictures that nobody looks at are this large.
const SMALL: u32 = 16;

/// What all frames of all truths may take together, bytes.
const MOST_BYTES: u64 = 4 << 30;

/// Random numbers in 0..1 that are the same everywhere (Steele, Lea, Flood 2014, split-mix of 64 bits).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 24) as f32
    }
}

/// Transmittance of the first light at every strand point, as `renderer` draws with it.
fn drawn(renderer: &mut Renderer, input: &FrameInput) -> Result<Vec<f32>, StudioError> {
    renderer.picture(input, SMALL, SMALL, &mut Picture::default())?;
    Ok(renderer.transmittance(0)?)
}

/// Draws `hair` by the settings of `project` with its maps moved by less than a texel of `cell_size` on each axis of the light,
/// to the same places for every method.
///
/// # Errors
/// As drawing, or what `tell` returns, which is asked before each draw.
pub(super) fn swimming(
    renderer: &mut Renderer,
    (hair, project, light): (&Hair, &Project, &Light),
    cell_size: f32,
    tell: &mut Tell,
) -> Result<Stability, StudioError> {
    let axes = LightFrame::new(light.direction);
    let mut random = Random(7);
    let mut shifts = Vec::with_capacity(SHIFTS);
    for _ in 0..SHIFTS {
        tell()?;
        let shift = cell_size * Vec3::new(random.unit(), random.unit(), random.unit());
        let world_from_head = hair.head_moved_by(axes.world_from_light(shift));
        shifts.push(drawn(renderer, &FrameInput { world_from_head, ..hair.frame_input(project) })?);
    }
    Ok(swim(&shifts))
}

/// The frames of a comparison, and what is true in them.
pub(super) struct Film {
    snapshots: Vec<Arc<FrameSnapshot>>,
    /// For each truth its transmittance, frame after frame; none where it is not known.
    truths: Vec<Option<Vec<Vec<f32>>>>,
}

impl Film {
    /// # Errors
    /// More frames than fit in memory, with the numbers.
    pub(super) fn check(frames: u64, points: usize, truths: usize) -> Result<(), String> {
        let bytes = frames.saturating_mul(points as u64).saturating_mul(4 * (truths as u64 + 1));
        if bytes > MOST_BYTES {
            return Err(format!(
                "pop and flicker over {frames} frames of {points} points need {} MiB, more than the limit of {} MiB: ask \
                 for fewer frames",
                bytes >> 20,
                MOST_BYTES >> 20
            ));
        }
        Ok(())
    }

    /// Finds the truth in every frame; `tell` is called before each. `reference` is told how well those of frames after the
    /// first converged (of each frame that which changed most), and which could not be had.
    ///
    /// # Errors
    /// What `tell` returns.
    pub(super) fn new(
        (first_frame, snapshots): (u64, Vec<Arc<FrameSnapshot>>),
        project: &Project,
        light: &Light,
        known: &[Truth],
        reference: &mut Reference,
        mut tell: impl FnMut() -> Result<(), StudioError>,
    ) -> Result<Self, StudioError> {
        let mut truths: Vec<_> =
            known.iter().map(|truth| truth.transmittance.is_ok().then(Vec::new)).collect();
        for (frame, snapshot) in snapshots.iter().enumerate() {
            let hair = Hair::new(Arc::clone(snapshot), project);
            let name = format!("frame {}", first_frame + frame as u64);
            let mut worst: Option<FootprintTruth> = None;
            for (of_truth, known) in truths.iter_mut().zip(known) {
                let Some(frames) = of_truth else { continue };
                tell()?;
                let found = if let (0, Ok(found)) = (frame, &known.transmittance) {
                    Ok(found.clone())
                } else {
                    let (found, facts) = converge((&hair, project, light), &known.settings);
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
        Ok(Self { snapshots, truths })
    }

    /// Pop, and flicker against the truth of this number.
    ///
    /// # Errors
    /// As drawing, or what `tell` returns, which is asked before each frame.
    pub(super) fn watch(
        &self,
        renderer: &mut Renderer,
        project: &Project,
        truth: usize,
        tell: &mut Tell,
    ) -> Result<(Stability, Option<Stability>), StudioError> {
        let mut frames = Vec::with_capacity(self.snapshots.len());
        for snapshot in &self.snapshots {
            tell()?;
            let hair = Hair::new(Arc::clone(snapshot), project);
            frames.push(drawn(renderer, &hair.frame_input(project))?);
        }
        let truth = self.truths.get(truth).and_then(Option::as_ref);
        Ok((pop(&frames), truth.map(|truth| flicker(&frames, truth))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_that_does_not_fit_is_refused_with_the_numbers() {
        assert_eq!(Film::check(30, 100_000, 2), Ok(()));
        let error = Film::check(10_000, 1_000_000, 2).expect_err("110 GiB");
        assert!(error.contains("10000 frames") && error.contains("4096 MiB"), "{error}");
        assert!(Film::check(u64::MAX, usize::MAX, 9).is_err());
    }

    #[test]
    fn shifts_are_less_than_a_texel_and_differ() {
        let mut random = Random(7);
        let all: Vec<f32> = (0..3 * SHIFTS).map(|_| random.unit()).collect();
        assert!(all.iter().all(|shift| (0.0..1.0).contains(shift)));
        assert!(all.iter().enumerate().all(|(i, a)| all[..i].iter().all(|b| a != b)));
    }
}
