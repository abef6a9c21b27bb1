//! The path of the head, for a camera that follows it.

use glam::Vec3;
use lovelock_motion::{Body, Clip, Pose, pose_at};

/// Spacing of the samples, seconds.
const SPACING_SECS: f64 = 1.0 / 30.0;

/// Maximum number of samples: over half an hour at full rate.
const MAX_SAMPLES: usize = 65_536;

/// Positions of the head joint over a clip, world space.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadPath {
    positions: Vec<Vec3>,
    spacing_secs: f64,
    looping: bool,
}

impl HeadPath {
    /// Samples the head of `body` over `clip`, or its position at rest.
    pub fn new(body: &Body, clip: Option<&Clip>, looping: bool) -> Self {
        let duration = clip.map_or(0.0, |clip| clip.duration_secs.max(0.0));
        let count = ((duration / SPACING_SECS).ceil() as usize).clamp(1, MAX_SAMPLES);
        let spacing_secs = if duration > 0.0 { duration / count as f64 } else { SPACING_SECS };
        let mut pose = Pose::default();
        let positions = (0..count)
            .map(|i| {
                pose_at(body, clip, i as f64 * spacing_secs, &mut pose);
                Vec3::from(pose.world_from_head.translation)
            })
            .collect();
        Self { positions, spacing_secs, looping }
    }

    /// Position of the head joint at `clip_secs`, averaged with a raised-cosine window of width `window_secs`.
    ///
    /// The window is centred, so the camera does not lag. The result depends only on the clip's time and is continuous.
    pub fn smoothed(&self, clip_secs: f64, window_secs: f64) -> Vec3 {
        let count = self.positions.len() as i64;
        // At least two samples wide, so that the path is continuous.
        let half =
            (window_secs.max(0.0) * 0.5).min(self.spacing_secs * count as f64 * 0.5).max(self.spacing_secs);
        let first = ((clip_secs - half) / self.spacing_secs).ceil() as i64;
        let last = ((clip_secs + half) / self.spacing_secs).floor() as i64;
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0_f32);
        for i in first..=last {
            let x = (i as f64 * self.spacing_secs - clip_secs) / half;
            let weight = (1.0 + (std::f64::consts::PI * x).cos()) as f32;
            let at = if self.looping { i.rem_euclid(count) } else { i.clamp(0, count - 1) };
            sum += self.positions[at as usize] * weight;
            weights += weight;
        }
        if weights > 0.0 { sum / weights } else { self.positions[0] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(positions: Vec<Vec3>, looping: bool) -> HeadPath {
        HeadPath { positions, spacing_secs: 0.1, looping }
    }

    #[test]
    fn a_still_head_gives_its_position() {
        let path = path(vec![Vec3::new(1.0, 2.0, 3.0); 40], true);
        for t in [0.0, 0.05, 1.234, 3.99, 100.0, -3.0] {
            assert!((path.smoothed(t, 1.5) - Vec3::new(1.0, 2.0, 3.0)).length() < 1e-5);
        }
    }

    #[test]
    fn a_steady_walk_is_followed_without_lag() {
        let path = path((0..100).map(|i| Vec3::X * i as f32 * 0.1).collect(), false);
        for t in [2.0, 3.3, 5.05] {
            assert!((f64::from(path.smoothed(t, 1.0).x) - t).abs() < 1e-3, "{t}");
        }
    }

    #[test]
    fn the_path_is_continuous_across_the_loop() {
        let circle = |i: usize| (i as f32 / 60.0 * std::f32::consts::TAU).sin_cos();
        let path = path((0..60).map(|i| Vec3::new(circle(i).0, 0.0, circle(i).1)).collect(), true);
        let mut before = path.smoothed(5.9, 0.8);
        for k in 1..400 {
            let now = path.smoothed(5.9 + f64::from(k) * 1e-3, 0.8);
            // The speed along the circle is about 1 m/s.
            assert!((now - before).length() < 2e-3, "a jump of {} at {k}", (now - before).length());
            before = now;
        }
    }

    #[test]
    fn a_tremor_is_smoothed_away() {
        let path = path((0..100).map(|i| Vec3::Y * if i % 2 == 0 { 0.01 } else { -0.01 }).collect(), true);
        assert!(path.smoothed(5.0, 1.2).y.abs() < 1e-4);
    }
}
