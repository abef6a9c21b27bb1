//! Stability of a method while its map is shifted.

use std::sync::Arc;

use glam::Vec3;
use lovelock_base::random::SplitMix64;
use lovelock_metrics::{Stability, swim};
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_render::{FrameInput, Light, Renderer, light_frame};
use lovelock_session::snapshot::FrameSnapshot;

use super::hair::{Hair, LitHair};
use super::stability::drawn;
use super::truth::cell_size;
use super::work::CheckCancel;

/// Number of shifts of the map per frame.
const SHIFTS: usize = 6;

/// Maximum number of frames with shifts; each frame needs one draw per shift.
const MAX_FRAMES: usize = 8;

/// The frames out of `frames` that are shifted: all if there are few, otherwise an even selection from the first to the last.
pub(super) fn frames_shifted(frames: usize) -> Vec<usize> {
    let count = frames.min(MAX_FRAMES);
    // Integer rounding to nearest; the product of two list lengths does not overflow.
    (0..count).map(|i| (i * (frames - 1) + (count - 1) / 2) / (count - 1).max(1)).collect()
}

/// Renders each of `snapshots` with the settings of `project` and maps that are shifted by less than a texel on each axis of the
/// light, by the same shifts for every method. Returns the deviation of each point's transmittance over all frames.
///
/// # Errors
/// As rendering, or the error of `check_cancel`, which is called before each draw.
pub(super) fn swimming(
    renderer: &mut Renderer,
    snapshots: &[Arc<FrameSnapshot>],
    (project, light): (&Project, &Light),
    check_cancel: &mut CheckCancel,
) -> Result<Stability, ProjectError> {
    let mut random = SplitMix64::new(7);
    let mut frames = Vec::with_capacity(snapshots.len());
    for snapshot in snapshots {
        check_cancel()?;
        let hair = Hair::new(Arc::clone(snapshot), project);
        let axes = light_frame(light, hair.head());
        let cell_size = cell_size(LitHair { hair: &hair, project, light }, &project.shadow).unwrap_or(0.0);
        let mut shifts = Vec::with_capacity(SHIFTS);
        for _ in 0..SHIFTS {
            check_cancel()?;
            let shift = cell_size * Vec3::new(random.unit(), random.unit(), random.unit());
            let world_from_head = hair.head_moved_by(axes.world_from_light(shift));
            shifts.push(drawn(renderer, &FrameInput { world_from_head, ..hair.frame_input(project) })?);
        }
        frames.push(swim(&shifts));
    }
    Ok(Stability::over_frames(&frames))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifts_are_less_than_a_texel_and_differ() {
        let mut random = SplitMix64::new(7);
        let all: Vec<f32> = (0..3 * SHIFTS * MAX_FRAMES).map(|_| random.unit()).collect();
        assert!(all.iter().all(|shift| (0.0..1.0).contains(shift)));
        assert!(all.iter().enumerate().all(|(i, a)| all[..i].iter().all(|b| a != b)));
    }

    #[test]
    fn a_few_frames_are_all_shifted_and_many_evenly() {
        assert_eq!(frames_shifted(0), [0; 0]);
        assert_eq!(frames_shifted(1), [0]);
        assert_eq!(frames_shifted(4), [0, 1, 2, 3]);
        assert_eq!(frames_shifted(MAX_FRAMES), (0..MAX_FRAMES).collect::<Vec<_>>());
        assert_eq!(frames_shifted(99), [0, 14, 28, 42, 56, 70, 84, 98]);
        for frames in 1..200 {
            let shifted = frames_shifted(frames);
            let gaps: Vec<usize> = shifted.windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert_eq!((shifted[0], shifted.last()), (0, Some(&(frames - 1))), "{frames}");
            let (low, high) = (gaps.iter().min().unwrap_or(&1), gaps.iter().max().unwrap_or(&1));
            assert!(*low > 0 && high - low <= 1, "{frames}: {shifted:?}");
        }
    }
}
