//! A backflip from key poses, for any figure whose limbs are known: a motion that needs no file.

use std::sync::Arc;

use glam::{Mat3A, Quat, Vec3};

use crate::humanoid::{Humanoid, Role, Side};
use crate::{Body, Clip, Interpolation, JointTracks, Track, pose::rotation_of};

/// One key pose. Angles in degrees, relative to standing with the arms down.
struct Key {
    time_secs: f32,
    /// Height of the hips relative to standing, metres on a figure of 1.7 m; in the air the parabola of the
    /// flight is added.
    height: f32,
    /// Backward rotation of the whole figure about the hips.
    turn: f32,
    /// Forward bend of knees, hips and trunk.
    knee: f32,
    hip: f32,
    trunk: f32,
    /// Arms swung forward and up.
    arm: f32,
    /// Backward bend of the head.
    head: f32,
}

const fn key(time_secs: f32, height: f32, turn: f32, bends: [f32; 3], arm: f32, head: f32) -> Key {
    let [knee, hip, trunk] = bends;
    Key { time_secs, height, turn, knee, hip, trunk, arm, head }
}

/// Takeoff and landing, seconds.
const FLIGHT: [f32; 2] = [0.78, 1.44];
/// Standing, crouching, takeoff, tucked, opening, landing, standing.
const KEYS: [Key; 11] = [
    key(0.00, 0.00, 0.0, [0.0, 0.0, 0.0], 0.0, 0.0),
    key(0.25, 0.00, 0.0, [0.0, 0.0, 0.0], 60.0, 0.0),
    key(0.58, -0.24, -14.0, [85.0, 75.0, 20.0], -50.0, -10.0),
    key(0.78, 0.06, 12.0, [8.0, -4.0, -10.0], 150.0, 25.0),
    key(0.92, 0.00, 75.0, [70.0, 60.0, 10.0], 110.0, 30.0),
    key(1.08, 0.00, 190.0, [120.0, 110.0, 35.0], 65.0, 10.0),
    key(1.24, 0.00, 285.0, [95.0, 85.0, 25.0], 60.0, 15.0),
    key(1.44, 0.00, 352.0, [25.0, 30.0, 10.0], 80.0, 5.0),
    key(1.62, -0.22, 368.0, [80.0, 75.0, 25.0], 70.0, -5.0),
    key(2.05, 0.00, 360.0, [0.0, 0.0, 0.0], 10.0, 0.0),
    key(2.40, 0.00, 360.0, [0.0, 0.0, 0.0], 0.0, 0.0),
];
/// Keys per second of the clip.
const RATE: f32 = 60.0;
const GRAVITY: f32 = 9.81;

/// A standing backflip of 2.4 s that loops; `None` if hips, thighs, shins, upper arms or head are unknown.
pub fn backflip(body: &Body) -> Option<Clip> {
    let figure = Humanoid::of_skeleton(&body.skeleton);
    let hips = figure.get(Role::Hips)?;
    let legs =
        [Side::Left, Side::Right].map(|s| Some((figure.get(Role::Thigh(s))?, figure.get(Role::Shin(s))?)));
    let arms = [Side::Left, Side::Right].map(|s| figure.get(Role::UpperArm(s)));
    let ([Some(left), Some(right)], [Some(arm_left), Some(arm_right)]) = (legs, arms) else { return None };
    let head = figure.get(Role::Head)?;
    let count = (KEYS[KEYS.len() - 1].time_secs * RATE) as usize;
    let times: Arc<[f32]> = (0..=count).map(|i| i as f32 / RATE).collect();
    let size = body.height() / 1.7;
    let mut joints = Vec::new();
    let mut track = |joint: usize, about_x: &dyn Fn(&Key) -> f32, before: Quat| {
        let values = times.iter().map(|&t| {
            let turn = Quat::from_rotation_x(at(t, about_x).to_radians()) * before;
            in_parent(body, joint, turn)
        });
        let rotation = Some(Track {
            times: Arc::clone(&times),
            values: values.collect(),
            interpolation: Interpolation::Linear,
        });
        joints.push(JointTracks { joint, rotation, ..JointTracks::default() });
    };
    track(hips, &|k| -k.turn, Quat::IDENTITY);
    for (thigh, shin) in [left, right] {
        track(thigh, &|k| -k.hip, Quat::IDENTITY);
        track(shin, &|k| k.knee, Quat::IDENTITY);
    }
    for arm in [arm_left, arm_right] {
        track(arm, &|k| -k.arm, arm_down(body, arm));
    }
    let spine: Vec<usize> = figure.spine.iter().copied().filter(|&j| j != hips).collect();
    for &joint in &spine {
        track(joint, &|k| k.trunk / spine.len() as f32, Quat::IDENTITY);
    }
    let neck: Vec<usize> = figure.neck.iter().copied().chain([head]).collect();
    for &joint in &neck {
        track(joint, &|k| -k.head / neck.len() as f32, Quat::IDENTITY);
    }
    let rest = &body.skeleton.joints[hips];
    let parent = rest.parent.map_or(Mat3A::IDENTITY, |p| body.skeleton.world_at_rest[p].matrix3);
    let values = times.iter().map(|&t| {
        let up = Vec3::Y * (height(t) * size);
        rest.translation + Vec3::from(parent.inverse() * glam::Vec3A::from(up))
    });
    joints[0].translation = Some(Track {
        times: Arc::clone(&times),
        values: values.collect(),
        interpolation: Interpolation::Linear,
    });
    joints.sort_by_key(|j| j.joint);
    let mut clip = Clip { name: "backflip".into(), joints, ..Clip::default() };
    clip.duration_secs = clip.keys_end_secs();
    clip.detect_loop(body);
    Some(clip)
}

/// Interpolates the keys at a time with cubics whose slopes come from the neighbouring keys (Catmull-Rom).
fn at(time: f32, of: &dyn Fn(&Key) -> f32) -> f32 {
    let after = KEYS.partition_point(|k| k.time_secs <= time).clamp(1, KEYS.len() - 1);
    let [a, b] = [&KEYS[after - 1], &KEYS[after]];
    let slope = |k: usize| {
        if k == 0 || k + 1 == KEYS.len() {
            return 0.0;
        }
        let [before, after] = [&KEYS[k - 1], &KEYS[k + 1]];
        (of(after) - of(before)) / (after.time_secs - before.time_secs)
    };
    let spacing = b.time_secs - a.time_secs;
    let u = ((time - a.time_secs) / spacing).clamp(0.0, 1.0);
    let (u2, u3) = (u * u, u * u * u);
    of(a) * (2.0 * u3 - 3.0 * u2 + 1.0)
        + of(b) * (3.0 * u2 - 2.0 * u3)
        + spacing * (slope(after - 1) * (u3 - 2.0 * u2 + u) + slope(after) * (u3 - u2))
}

/// Height of the hips above standing, metres; in the air a parabola from takeoff to landing.
fn height(time: f32) -> f32 {
    let [from, to] = FLIGHT;
    let of = |k: &Key| k.height;
    if (from..to).contains(&time) {
        let (t, whole) = (time - from, to - from);
        let ends = at(from, &of) + (at(to, &of) - at(from, &of)) * t / whole;
        ends + 0.5 * GRAVITY * t * (whole - t)
    } else {
        at(time, &of)
    }
}

/// Converts a rotation in the axes of the rest pose's world to one relative to the parent.
fn in_parent(body: &Body, joint: usize, turn: Quat) -> Quat {
    let own = &body.skeleton.joints[joint];
    let parent = own.parent.map_or(Quat::IDENTITY, |p| rotation_of(&body.skeleton.world_at_rest[p].matrix3));
    (parent.conjugate() * turn * parent * own.rotation).normalize()
}

/// The rotation that makes an arm hang straight down, slightly to the side.
fn arm_down(body: &Body, arm: usize) -> Quat {
    let skeleton = &body.skeleton;
    let child = (0..skeleton.joints.len()).find(|&j| {
        skeleton.joints[j].parent == Some(arm)
            && skeleton.rest_position(j).distance(skeleton.rest_position(arm)) > 0.02
    });
    let Some(child) = child else { return Quat::IDENTITY };
    let along = (skeleton.rest_position(child) - skeleton.rest_position(arm)).normalize_or(Vec3::NEG_Y);
    let aside = 0.2 * along.x.signum();
    Quat::from_rotation_arc(along, Vec3::new(aside, -1.0, 0.0).normalize_or(Vec3::NEG_Y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Pose, load_character, pose_at};

    #[test]
    fn values_pass_through_their_keys() {
        for key in &KEYS {
            assert!((at(key.time_secs, &|k| k.turn) - key.turn).abs() < 1e-3);
        }
        assert!((height(0.5 * (FLIGHT[0] + FLIGHT[1])) - (0.03 + GRAVITY * 0.66 * 0.66 / 8.0)).abs() < 1e-3);
    }

    #[test]
    fn the_dancer_flips_backward_and_lands() {
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb");
        let body = load_character(&file).expect("the shipped dancer loads").body;
        let clip = backflip(&body).expect("she has limbs");
        assert!(clip.loops, "the last pose equals the first");
        let mut pose = Pose::default();
        let mut up = |time: f64| {
            pose_at(&body, Some(&clip), time, &mut pose);
            let hips = pose.world_from_joint[0].translation;
            let head = pose.world_from_head;
            (head.transform_vector3(Vec3::Y), Vec3::from(head.translation), Vec3::from(hips))
        };
        let (stand, above, _) = up(0.0);
        assert!(stand.y > 0.99 && above.y > 1.4);
        // Halfway through she is upside down above the ground; before that she moves backward.
        let (over, head, hips) = up(1.08);
        assert!(over.y < -0.5 && head.y > 0.5 && hips.y > head.y, "{over} {head} {hips}");
        assert!(up(0.92).1.z < -0.2, "the head moves backward first: {}", up(0.92).1);
        let (mut last, mut fastest) = (up(0.0).1, 0.0_f32);
        for i in 1..=144 {
            let now = up(f64::from(i) / 60.0).1;
            fastest = fastest.max((now - last).length() * 60.0);
            last = now;
        }
        assert!((3.0..12.0).contains(&fastest), "the head moves at {fastest} m/s");
        assert!(backflip(&Body::default()).is_none());
    }
}
