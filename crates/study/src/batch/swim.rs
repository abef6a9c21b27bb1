//! How still a method stands while its map is shifted, frame by frame.

use std::sync::Arc;

use glam::Vec3;
use lovelock_metrics::{Stability, swim};
use lovelock_project::Project;
use lovelock_project::error::StudioError;
use lovelock_render::{FrameInput, Light, Renderer};
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_shadow::LightFrame;

use super::hair::Hair;
use super::stability::drawn;
use super::truth::cell_size;
use super::work::Tell;

/// Shifts of the map in each frame.
const SHIFTS: usize = 6;

/// The most frames that are shifted: every one costs as many draws as there are shifts.
const MOST_FRAMES: usize = 8;

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

/// Which of `frames` frames are shifted: all of a few, and of many so many that lie evenly from the first to the last.
pub(super) fn frames_shifted(frames: usize) -> Vec<usize> {
    let count = frames.min(MOST_FRAMES);
    // Whole numbers, rounded to the nearest; the product of two lengths of lists in memory fits.
    (0..count).map(|i| (i * (frames - 1) + (count - 1) / 2) / (count - 1).max(1)).collect()
}

/// Draws each of `snapshots` by the settings of `project` with its maps moved by less than a texel on each axis of the light,
/// to the same places for every method, and tells how much each point's transmittance deviates, over all frames.
///
/// # Errors
/// As drawing, or what `tell` returns, which is asked before each draw.
pub(super) fn swimming(
    renderer: &mut Renderer,
    snapshots: &[Arc<FrameSnapshot>],
    (project, light): (&Project, &Light),
    tell: &mut Tell,
) -> Result<Stability, StudioError> {
    let axes = LightFrame::new(light.direction);
    let mut random = Random(7);
    let mut frames = Vec::with_capacity(snapshots.len());
    for snapshot in snapshots {
        tell()?;
        let hair = Hair::new(Arc::clone(snapshot), project);
        let cell_size = cell_size((&hair, project, light), &project.shadow).unwrap_or(0.0);
        let mut shifts = Vec::with_capacity(SHIFTS);
        for _ in 0..SHIFTS {
            tell()?;
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
        let mut random = Random(7);
        let all: Vec<f32> = (0..3 * SHIFTS * MOST_FRAMES).map(|_| random.unit()).collect();
        assert!(all.iter().all(|shift| (0.0..1.0).contains(shift)));
        assert!(all.iter().enumerate().all(|(i, a)| all[..i].iter().all(|b| a != b)));
    }

    #[test]
    fn a_few_frames_are_all_shifted_and_many_evenly() {
        assert_eq!(frames_shifted(0), [0; 0]);
        assert_eq!(frames_shifted(1), [0]);
        assert_eq!(frames_shifted(4), [0, 1, 2, 3]);
        assert_eq!(frames_shifted(MOST_FRAMES), (0..MOST_FRAMES).collect::<Vec<_>>());
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
