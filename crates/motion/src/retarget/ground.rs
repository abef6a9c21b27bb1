//! Puts the feet on the ground: corrects the height of a retargeted clip.

use std::collections::VecDeque;

use glam::{Affine3A, Vec3};

use crate::humanoid::{Humanoid, Role, Side};
use crate::{Body, Clip, Pose, pose_at};

/// Longest time between ground contacts, seconds: a jump of 0.4 m, higher than dancers leap; the drift of
/// captured heights is slower.
const LONGEST_JUMP_SECS: f32 = 0.55;

/// Points of the soles, each fixed to a joint.
struct Soles {
    points: Vec<(usize, Vec3)>,
}

impl Soles {
    /// Number of tracked points per foot: enough for heel, ball and toes.
    const POINTS: usize = 96;

    fn new(body: &Body, figure: &Humanoid) -> Self {
        let skeleton = &body.skeleton;
        let mut points = Vec::new();
        for side in Side::BOTH {
            let Some(foot) = figure.get(Role::Foot(side)).or(figure.get(Role::Shin(side))) else { continue };
            let of_foot: Vec<usize> = (0..body.mesh.positions.len())
                .filter(|&v| skeleton.is_below(body.dominant_joint(v), foot))
                .collect();
            let lowest = of_foot.iter().map(|&v| body.mesh.positions[v].y).fold(f32::MAX, f32::min);
            let height = skeleton.rest_position(foot).y - lowest;
            // The sole: the lowest part of the foot.
            let sole: Vec<usize> = of_foot
                .into_iter()
                .filter(|&v| body.mesh.positions[v].y < lowest + 0.4 * height.max(0.0))
                .collect();
            if sole.is_empty() {
                let p = skeleton.rest_position(foot);
                points.push(Self::fixed(body, foot, Vec3::new(p.x, 0.0, p.z)));
            }
            for k in 0..sole.len().min(Self::POINTS) {
                let v = sole[k * sole.len() / sole.len().min(Self::POINTS)];
                points.push(Self::fixed(body, body.dominant_joint(v), body.mesh.positions[v]));
            }
            // Heel and toe matter most, so the ends of the sole are always included.
            for pick in [f32::total_cmp, |a: &f32, b: &f32| b.total_cmp(a)] {
                if let Some(&v) =
                    sole.iter().min_by(|&&a, &&b| pick(&body.mesh.positions[a].z, &body.mesh.positions[b].z))
                {
                    points.push(Self::fixed(body, body.dominant_joint(v), body.mesh.positions[v]));
                }
            }
        }
        Self { points }
    }

    fn fixed(body: &Body, joint: usize, world: Vec3) -> (usize, Vec3) {
        (joint, body.skeleton.world_at_rest[joint].inverse().transform_point3(world))
    }

    fn lowest(&self, world_from_joint: &[Affine3A]) -> f32 {
        self.points.iter().map(|(j, p)| world_from_joint[*j].transform_point3(*p).y).fold(f32::MAX, f32::min)
    }
}

/// Shifts the hips in every frame so that the feet stand on y = 0.
///
/// The ground is the lowest position of the soles within a time window around each frame, which follows the
/// drift of captured heights and ignores jumps. Then frame by frame a sole that is nearly on the ground is
/// put on it, which compensates for different proportions, and one that is high is left. The correction is
/// smoothed over time; any remaining penetration is lifted.
pub(super) fn set_on_ground(body: &Body, figure: &Humanoid, clip: &mut Clip) {
    let soles = Soles::new(body, figure);
    let Some(hips) = figure.get(Role::Hips) else { return };
    let Some(tracks) = clip.joints.iter().position(|t| t.joint == hips && t.translation.is_some()) else {
        return;
    };
    let times = match &clip.joints[tracks].translation {
        Some(path) if !soles.points.is_empty() => path.times.clone(),
        _ => return,
    };
    let mut pose = Pose::default();
    let heights: Vec<f32> = times
        .iter()
        .enumerate()
        .map(|(i, &t)| {
            // The time of the last key would wrap to the first.
            let t = if i + 1 == times.len() { f64::from(t).next_down() } else { f64::from(t) };
            pose_at(body, Some(clip), t, &mut pose);
            soles.lowest(&pose.world_from_joint)
        })
        .collect();
    let frame_secs = times.get(1).map_or(1.0, |t| t - times[0]);
    let lift = corrections(&heights, frame_secs, body.height());
    let above =
        body.skeleton.joints[hips].parent.map_or(Affine3A::IDENTITY, |p| body.skeleton.world_at_rest[p]);
    let up_in_parent = above.inverse().transform_vector3(Vec3::Y);
    if let Some(path) = &mut clip.joints[tracks].translation {
        for (p, &lift) in path.values.iter_mut().zip(&lift) {
            *p += lift * up_in_parent;
        }
    }
}

/// The height correction of each frame, given the height of its lowest sole point.
fn corrections(heights: &[f32], frame_secs: f32, body_height: f32) -> Vec<f32> {
    let window = (LONGEST_JUMP_SECS / frame_secs.max(1e-4)).max(1.0);
    let reach = (window * 0.5) as usize;
    let lowest = windowed(heights, reach, f32::min);
    let ground = smoothed(&lowest, window * 0.5);
    // Within 2 % of the body's height (3.5 cm) a sole is assumed to stand; beyond 6 % (10 cm) it is not.
    let (near, far) = (0.02 * body_height, 0.06 * body_height);
    let wanted: Vec<f32> = heights
        .iter()
        .zip(&ground)
        .map(|(&h, &ground)| {
            let above = h - ground;
            let share = ((far - above) / (far - near).max(1e-6)).clamp(0.0, 1.0);
            -above * share
        })
        .collect();
    // A tenth of a second: shorter than a step, longer than the jitter of captured feet.
    let width = 0.1 / frame_secs.max(1e-4);
    let smooth = smoothed(&wanted, width);
    let penetration: Vec<f32> =
        (0..heights.len()).map(|i| (ground[i] - heights[i] - smooth[i]).max(0.0)).collect();
    // The smoothed maximum of the nearby penetrations lifts everything without a kink.
    let reach = (width as usize / 2).max(1);
    let lift = smoothed(&windowed(&penetration, reach, f32::max), reach as f32 * 0.5);
    (0..heights.len()).map(|i| smooth[i] + lift[i] - ground[i]).collect()
}

/// The minimum or maximum within `reach` frames of each, in linear time by a queue of candidates.
fn windowed(values: &[f32], reach: usize, pick: fn(f32, f32) -> f32) -> Vec<f32> {
    let mut queue: VecDeque<usize> = VecDeque::new();
    let mut next = 0;
    (0..values.len())
        .map(|i| {
            while next < values.len() && next <= i + reach {
                while queue.back().is_some_and(|&b| pick(values[b], values[next]) == values[next]) {
                    queue.pop_back();
                }
                queue.push_back(next);
                next += 1;
            }
            while queue.front().is_some_and(|&f| f + reach < i) {
                queue.pop_front();
            }
            queue.front().map_or(values[i], |&f| values[f])
        })
        .collect()
}

/// Gaussian mean over time; `width` is two standard deviations, in frames. End values are repeated.
fn smoothed(values: &[f32], width: f32) -> Vec<f32> {
    let sigma = width * 0.5;
    let reach = (3.0 * sigma).ceil() as isize;
    if sigma < 0.1 {
        return values.to_vec();
    }
    let kernel: Vec<f32> = (-reach..=reach).map(|k| (-0.5 * (k as f32 / sigma).powi(2)).exp()).collect();
    let total: f32 = kernel.iter().sum();
    let last = values.len() as isize - 1;
    (0..=last)
        .map(|i| {
            let sum: f32 = kernel
                .iter()
                .enumerate()
                .map(|(k, w)| w * values[(i + k as isize - reach).clamp(0, last) as usize])
                .sum();
            sum / total
        })
        .collect()
}
