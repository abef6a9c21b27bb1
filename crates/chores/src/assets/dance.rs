//! Generates motion from a score: smooth curves through the key poses, steps that keep planted feet in place, and inverse
//! kinematics for the limbs.

use std::f32::consts::TAU;

use glam::{Quat, Vec2, Vec3};
use lovelock_base::numbers::smoothstep;

use super::glb::SampledClip;
use super::ik::{align, angle_about, reach, twist_about};
use super::rig::{self, Rig, RigJoint};
use super::score::{ArmPose, Score, Step};

/// Keys per second in the file.
pub(super) const RATE: f32 = 60.0;
/// Width in seconds of the bell filter that smooths every curve, so that the motion passes through key poses without stopping.
const ROUNDING_SECS: f32 = 0.055;
/// Delay of the arms and the head behind the trunk, in seconds.
const ARM_LAG_SECS: f32 = 0.05;
const HEAD_LAG_SECS: f32 = 0.07;
/// Largest extension of a leg, as a fraction of its length, before its heel rises.
const LEG_STRETCH: f32 = 0.988;

/// Distance from the ball of the foot to the end of the slipper in metres.
const TOE_LENGTH: f32 = 0.10;

/// One pose: rotations of the joints relative to their parents, and the position of the hips.
#[derive(Clone)]
pub(super) struct LocalPose {
    /// By joint.
    pub(super) rotations: Vec<Quat>,
    /// World space, metres.
    pub(super) hips: Vec3,
}

/// Value of the closed cubic through `keys` at `beat` (Catmull and Rom, uneven spacing).
fn spline<const N: usize>(keys: &[(f32, [f32; N])], period: f32, beat: f32) -> [f32; N] {
    let n = keys.len();
    if n == 1 {
        return keys[0].1;
    }
    let beat = beat.rem_euclid(period);
    let after = keys.partition_point(|key| key.0 <= beat) as isize;
    let key = |i: isize| -> (f32, &[f32; N]) {
        let wrapped = i.rem_euclid(n as isize) as usize;
        (keys[wrapped].0 + period * i.div_euclid(n as isize) as f32, &keys[wrapped].1)
    };
    let [(t0, p0), (t1, p1), (t2, p2), (t3, p3)] =
        [key(after - 2), key(after - 1), key(after), key(after + 1)];
    let h = t2 - t1;
    let t = (beat - t1) / h;
    let (tt, ttt) = (t * t, t * t * t);
    std::array::from_fn(|c| {
        let (a, b, d) = ((p1[c] - p0[c]) / (t1 - t0), (p2[c] - p1[c]) / h, (p3[c] - p2[c]) / (t3 - t2));
        // The nearer neighbour has more weight in the slope at a key.
        let m1 = (a * h + b * (t1 - t0)) / (h + t1 - t0) * h;
        let m2 = (b * (t3 - t2) + d * h) / (h + t3 - t2) * h;
        (2.0 * ttt - 3.0 * tt + 1.0) * p1[c]
            + (ttt - 2.0 * tt + t) * m1
            + (3.0 * tt - 2.0 * ttt) * p2[c]
            + (ttt - tt) * m2
    })
}

impl Score {
    /// A curve smoothed by a bell filter of width [`ROUNDING_SECS`].
    fn curve<const N: usize>(&self, keys: &[(f32, [f32; N])], secs: f32) -> [f32; N] {
        let mut out = [0.0; N];
        let mut total = 0.0;
        for tap in -4..=4_i8 {
            let x = f32::from(tap) * 0.5;
            let weight = (-0.5 * x * x).exp();
            total += weight;
            let value = spline(keys, self.beats, (secs + x * ROUNDING_SECS) / self.beat_secs);
            for c in 0..N {
                out[c] += weight * value[c];
            }
        }
        out.map(|v| v / total)
    }

    /// Rotation of the body about the vertical in radians.
    fn heading(&self, secs: f32) -> f32 {
        let beat = secs / self.beat_secs;
        self.turns.iter().map(|turn| turn.turns * TAU * ease(turn.beats, beat)).sum()
    }

    /// Position of the ball of a foot, on the ground or held in the air, and how far it is raised.
    fn ball(&self, side: usize, secs: f32, under_hips: Vec2) -> (Vec3, f32) {
        let beat = secs / self.beat_secs;
        let mut from = self.stance[side];
        for step in &self.steps[side] {
            if beat < step.lift {
                break;
            }
            if beat < step.land {
                return self.swing(from, step, secs, under_hips);
            }
            from = step.to;
        }
        (Vec3::new(from[0], self.ball_y, from[1]), 0.0)
    }

    fn swing(&self, from: [f32; 2], step: &Step, secs: f32, under_hips: Vec2) -> (Vec3, f32) {
        let beat = secs / self.beat_secs;
        let on_ground = |p: [f32; 2]| Vec3::new(p[0], self.ball_y, p[1]);
        let whole = [step.lift, step.land];
        let t = ((beat - step.lift) / (step.land - step.lift)).clamp(0.0, 1.0);
        let Some(held) = step.held else {
            let rise = step.height * (4.0 * t * (1.0 - t)).powi(2);
            let up = smoothstep(0.0, 0.35, t) * smoothstep(1.0, 0.65, t);
            return (on_ground(from).lerp(on_ground(step.to), ease(whole, beat)) + Vec3::Y * rise, 0.6 * up);
        };
        let up = (0.38 * (step.land - step.lift)).min(0.85);
        let leave = ease([step.lift, step.lift + up], beat);
        let in_air = (leave * (1.0 - ease([step.land - up, step.land], beat))).clamp(0.0, 1.0);
        let turned = Quat::from_rotation_y(self.heading(secs)) * held;
        let place = Vec3::new(under_hips.x, 0.0, under_hips.y) + turned;
        let ground = if t < 0.5 { from } else { step.to };
        // A foot brushes along the floor before it rises: the height is proportional to the square of the distance.
        let mut at = on_ground(ground).lerp(place, in_air);
        at.y = self.ball_y + (place.y - self.ball_y) * in_air.powf(1.4);
        (at, in_air)
    }

    /// The pose of an arm and the speed of its wrist, in arm lengths per second.
    fn arm_at(&self, side: usize, secs: f32) -> (ArmPose, Vec3) {
        let keys: Vec<(f32, [f32; 10])> = self.arms[side]
            .iter()
            .map(|(beat, pose)| {
                let mut row = [0.0; 10];
                row[..3].copy_from_slice(&pose.wrist);
                row[3..6].copy_from_slice(&pose.pole);
                row[6..9].copy_from_slice(&pose.palm);
                row[9] = Vec3::from(pose.wrist).length();
                (*beat, row)
            })
            .collect();
        let part = |row: [f32; 10], at: usize| Vec3::new(row[at], row[at + 1], row[at + 2]);
        // The wrist moves on arcs about the shoulder, so its distance is interpolated separately.
        let wrist = |row: [f32; 10]| part(row, 0).normalize_or(-Vec3::Y) * row[9];
        let now = self.curve(&keys, secs - ARM_LAG_SECS);
        let (before, after) = (self.curve(&keys, secs - 0.13), self.curve(&keys, secs - 0.07));
        let speed = (wrist(after) - wrist(before)) / 0.06;
        let pose = ArmPose {
            wrist: wrist(now).to_array(),
            pole: part(now, 3).to_array(),
            palm: part(now, 6).to_array(),
        };
        (pose, speed)
    }

    /// The pose at a time.
    fn pose(&self, rig: &Rig, secs: f32, heel_radians: [f32; 2]) -> LocalPose {
        let joints = &rig.joints;
        let mut world = vec![Quat::IDENTITY; joints.len()];
        let mut place: Vec<Vec3> = joints.iter().map(|joint| joint.rest).collect();
        let [x, y, z] = self.curve(&self.hips, secs);
        place[rig::HIPS] = joints[rig::HIPS].rest + Vec3::new(x, y, z);
        let tilt = self.curve(&self.tilt, secs);
        let heading = Quat::from_rotation_y(self.heading(secs));
        world[rig::HIPS] = heading * bend(tilt, 1.0);
        let back = self.curve(&self.back, secs);
        let head = self.curve(&self.head, secs - HEAD_LAG_SECS);
        let follow = |world: &mut Vec<Quat>, place: &mut Vec<Vec3>, joint: usize, local: Quat| {
            let parent = joints[joint].parent.unwrap_or(0);
            world[joint] = world[parent] * local;
            place[joint] = place[parent] + world[parent] * (joints[joint].rest - joints[parent].rest);
        };
        for (joint, share) in [(rig::SPINE, 0.34), (rig::SPINE_1, 0.36), (rig::CHEST, 0.30)] {
            follow(&mut world, &mut place, joint, bend(back, share));
        }
        follow(&mut world, &mut place, rig::NECK, bend(head, 0.45));
        follow(&mut world, &mut place, rig::HEAD, bend(head, 0.55));
        for (side, heel) in heel_radians.into_iter().enumerate() {
            self.arm(rig, secs, side, &mut world, &mut place);
            self.leg(joints, secs, side, heel, &mut world, &mut place);
        }
        let rotations = (0..joints.len())
            .map(|j| joints[j].parent.map_or(world[j], |p| world[p].inverse() * world[j]).normalize())
            .collect();
        LocalPose { rotations, hips: place[rig::HIPS] }
    }

    fn arm(&self, rig: &Rig, secs: f32, side: usize, world: &mut [Quat], place: &mut [Vec3]) {
        let joints = &rig.joints;
        let sign = if side == 0 { 1.0 } else { -1.0 };
        let first = rig::CLAVICLE + side * rig::ARM_JOINTS;
        let joint = |offset: usize| first + offset;
        let at_rest = |offset: usize| joints[first + offset].rest;
        let chest = world[rig::CHEST];
        let (pose, speed) = self.arm_at(side, secs);
        let mirrored = |p: [f32; 3]| Vec3::new(p[0] * sign, p[1], p[2]);
        let wrist = mirrored(pose.wrist);
        let lengths = [
            at_rest(rig::UPPER_ARM).distance(at_rest(rig::FOREARM)),
            at_rest(rig::FOREARM).distance(at_rest(rig::HAND)),
        ];
        let span = lengths[0] + lengths[1];
        // The collar bone rises with a raised arm, and moves forward with an arm that reaches across.
        let raise = 0.40 * smoothstep(-0.15, 1.0, wrist.y) - 0.03;
        let forward = 0.22 * smoothstep(0.3, 1.0, wrist.z) - 0.18 * smoothstep(0.1, -0.5, wrist.z);
        let collar = Quat::from_rotation_z(sign * raise) * Quat::from_rotation_y(-sign * forward);
        world[first] = chest * collar;
        place[first] = place[rig::CHEST] + chest * (joints[first].rest - joints[rig::CHEST].rest);
        let shoulder = place[first] + world[first] * (at_rest(rig::UPPER_ARM) - at_rest(0));
        let unmoved = place[first] + chest * (at_rest(rig::UPPER_ARM) - at_rest(0));
        let target = unmoved + chest * (wrist * span);
        let offset = (target - shoulder).clamp_length_max(0.985 * span);
        let bent = reach(offset, lengths, chest * mirrored(pose.pole));
        let upper_rest = (at_rest(rig::FOREARM) - at_rest(rig::UPPER_ARM)).normalize_or(Vec3::X);
        let fore_rest = (at_rest(rig::HAND) - at_rest(rig::FOREARM)).normalize_or(Vec3::X);
        let hinge_rest = upper_rest.cross(fore_rest).normalize_or(Vec3::Y);
        let upper = align((upper_rest, hinge_rest), (bent.first, bent.hinge));
        let fore = align((fore_rest, hinge_rest), (bent.second, bent.hinge));
        // Half of the upper arm's roll is taken back at the shoulder.
        let roll = twist_about(world[first].inverse() * upper, upper_rest);
        world[joint(rig::UPPER_ARM)] = upper;
        world[joint(rig::UPPER_ARM_TWIST)] = upper * Quat::from_axis_angle(upper_rest, -0.6 * roll);
        world[joint(rig::FOREARM)] = fore;
        // The palm turns as requested, within the range of a forearm.
        let palm = rig.palm * Vec3::new(sign, 1.0, 1.0);
        let palm_rest = (palm - fore_rest * palm.dot(fore_rest)).normalize_or(-Vec3::Y);
        let wanted = chest * mirrored(pose.palm);
        let turn = 1.4 * (angle_about(bent.second, fore * palm_rest, wanted) / 1.4).tanh();
        let twisted = |share: f32| fore * Quat::from_axis_angle(fore_rest, share * turn);
        world[joint(rig::FOREARM_TWIST)] = twisted(rig.forearm_twist());
        // The hand trails the wrist's motion.
        let hand = twisted(1.0);
        let drag = (hand.inverse() * (chest * mirrored(speed.to_array()))).clamp_length_max(3.0);
        let bend = fore_rest.cross(-drag) * 0.16 + fore_rest.cross(palm_rest) * 0.14;
        world[joint(rig::HAND)] = hand * Quat::from_scaled_axis(bend);
    }

    fn leg(
        &self,
        joints: &[RigJoint],
        secs: f32,
        side: usize,
        heel: f32,
        world: &mut [Quat],
        place: &mut [Vec3],
    ) {
        let first = rig::THIGH + side * rig::LEG_JOINTS;
        let at_rest = |offset: usize| joints[first + offset].rest;
        let hips = world[rig::HIPS];
        let hip = place[rig::HIPS] + hips * (at_rest(0) - joints[rig::HIPS].rest);
        let (foot, toes, ankle) = self.foot(joints, secs, side, heel, place[rig::HIPS]);
        let thigh_rest = (at_rest(rig::SHIN) - at_rest(0)).normalize_or(-Vec3::Y);
        let shin_rest = (at_rest(rig::FOOT) - at_rest(rig::SHIN)).normalize_or(-Vec3::Y);
        let hinge_rest = thigh_rest.cross(shin_rest).normalize_or(Vec3::X);
        let lengths =
            [at_rest(0).distance(at_rest(rig::SHIN)), at_rest(rig::SHIN).distance(at_rest(rig::FOOT))];
        // The knee points over the foot, and outward when the foot is lifted high.
        let up = self.ball(side, secs, place[rig::HIPS].xz_pair()).1;
        let sign = if side == 0 { 1.0 } else { -1.0 };
        let ahead = Quat::from_rotation_y(self.heading(secs));
        let outward = ahead * Vec3::new(sign * (0.25 + 0.75 * up), 0.0, 1.0 - 0.25 * up);
        let bent = reach(ankle - hip, lengths, outward);
        let thigh = align((thigh_rest, hinge_rest), (bent.first, bent.hinge));
        world[first] = thigh;
        let roll = twist_about(hips.inverse() * thigh, thigh_rest);
        world[first + rig::THIGH_TWIST] = thigh * Quat::from_axis_angle(thigh_rest, -0.6 * roll);
        world[first + rig::SHIN] = align((shin_rest, hinge_rest), (bent.second, bent.hinge));
        world[first + rig::FOOT] = foot;
        world[first + rig::TOES] = toes;
    }

    /// Rotations of the foot and the toes, and the place of the ankle.
    fn foot(&self, joints: &[RigJoint], secs: f32, side: usize, heel: f32, hips: Vec3) -> (Quat, Quat, Vec3) {
        let first = rig::THIGH + side * rig::LEG_JOINTS;
        let sign = if side == 0 { 1.0 } else { -1.0 };
        let (ball, up) = self.ball(side, secs, hips.xz_pair());
        let flat = Quat::from_rotation_y(self.heading(secs) + sign * self.turnout.to_radians());
        let ankle_from_ball = joints[first + rig::FOOT].rest - joints[first + rig::TOES].rest;
        let across =
            Vec3::Y.cross(Vec3::new(-ankle_from_ball.x, 0.0, -ankle_from_ball.z)).normalize_or(Vec3::X);
        let foot = flat * Quat::from_axis_angle(across, heel + 0.75 * up);
        // A lifted foot is pointed to the toes' ends; a standing one keeps them flat.
        let clearance = ((ball.y - self.ball_y) / TOE_LENGTH).clamp(0.0, 1.0).asin();
        let toes = flat * Quat::from_axis_angle(across, (up * (heel + 1.05 * up)).min(clearance));
        (foot, toes, ball + foot * ankle_from_ball)
    }

    /// How far the heel must rise so that the leg can reach, in radians.
    fn needed_heel(&self, joints: &[RigJoint], secs: f32, side: usize) -> f32 {
        let first = rig::THIGH + side * rig::LEG_JOINTS;
        let rest_of = |offset: usize| joints[first + offset].rest;
        let [x, y, z] = self.curve(&self.hips, secs);
        let hips = joints[rig::HIPS].rest + Vec3::new(x, y, z);
        let tilt = self.curve(&self.tilt, secs);
        let turned = Quat::from_rotation_y(self.heading(secs)) * bend(tilt, 1.0);
        let hip = hips + turned * (rest_of(0) - joints[rig::HIPS].rest);
        let length =
            rest_of(0).distance(rest_of(rig::SHIN)) + rest_of(rig::SHIN).distance(rest_of(rig::FOOT));
        let far =
            |heel: f32| self.foot(joints, secs, side, heel, hips).2.distance(hip) > LEG_STRETCH * length;
        let asked = self.curve(&self.heels, secs)[side].max(0.0).to_radians();
        let (mut low, mut high) = (asked, 1.2);
        if !far(low) {
            return low;
        }
        for _ in 0..20 {
            let middle = 0.5 * (low + high);
            if far(middle) { low = middle } else { high = middle }
        }
        high
    }

    /// Every pose of the clip at [`RATE`] keys per second, with the first one repeated at the end.
    pub(super) fn sample(&self, rig: &Rig) -> SampledClip {
        self.fitted(rig).sample_fitted(rig)
    }

    /// The score with its lengths scaled to a figure.
    fn fitted(&self, rig: &Rig) -> Self {
        let k = rig.scale();
        let mut score = self.clone();
        score.hips.iter_mut().for_each(|(_, place)| *place = place.map(|v| v * k));
        score.stance = score.stance.map(|p| p.map(|v| v * k));
        for step in score.steps.iter_mut().flatten() {
            step.to = step.to.map(|v| v * k);
            step.height *= k;
            step.held = step.held.map(|p| p * k);
        }
        score.ball_y = rig.joints[rig::THIGH + rig::TOES].rest.y;
        score
    }

    fn sample_fitted(&self, rig: &Rig) -> SampledClip {
        let joints = &rig.joints;
        let frames = (self.beats * self.beat_secs * RATE).round() as usize;
        let secs = |frame: usize| frame as f32 / RATE;
        let heels: [Vec<f32>; 2] = std::array::from_fn(|side| {
            let needed: Vec<f32> = (0..frames).map(|f| self.needed_heel(joints, secs(f), side)).collect();
            smooth_above(&needed, 5)
        });
        let poses: Vec<LocalPose> =
            (0..frames).map(|f| self.pose(rig, secs(f), [heels[0][f], heels[1][f]])).collect();
        let closed = || (0..=frames).map(|f| &poses[f % frames]);
        SampledClip {
            name: self.name,
            times: (0..=frames).map(secs).collect(),
            rotations: (0..joints.len()).map(|j| closed().map(|pose| pose.rotations[j]).collect()).collect(),
            hips: closed().map(|pose| pose.hips).collect(),
            weights: Vec::new(),
        }
    }
}

/// A smooth closed curve that is never below `values`: the largest value within `reach` frames, averaged twice.
fn smooth_above(values: &[f32], reach: usize) -> Vec<f32> {
    let n = values.len();
    let window = |of: &[f32], i: usize, reach: usize| -> Vec<f32> {
        (0..=2 * reach).map(|k| of[(i + n + k - reach) % n]).collect()
    };
    let highest: Vec<f32> =
        (0..n).map(|i| window(values, i, 2 * reach).into_iter().fold(f32::MIN, f32::max)).collect();
    let mean = |of: &[f32]| -> Vec<f32> {
        (0..n).map(|i| window(of, i, reach).iter().sum::<f32>() / (2 * reach + 1) as f32).collect()
    };
    mean(&mean(&highest))
}

/// A share of a bend given in degrees: forward, sideways toward the left, turn to the left.
fn bend(degrees: [f32; 3], share: f32) -> Quat {
    let [forward, left, turn] = degrees.map(|v| v.to_radians() * share);
    Quat::from_rotation_y(turn) * Quat::from_rotation_x(forward) * Quat::from_rotation_z(-left)
}

/// 0 before the first beat, 1 after the second; position, speed and acceleration are smooth (quintic).
fn ease(beats: [f32; 2], beat: f32) -> f32 {
    let t = ((beat - beats[0]) / (beats[1] - beats[0])).clamp(0.0, 1.0);
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// The two horizontal coordinates of a point.
trait Horizontal {
    fn xz_pair(&self) -> Vec2;
}

impl Horizontal for Vec3 {
    fn xz_pair(&self) -> Vec2 {
        Vec2::new(self.x, self.z)
    }
}

/// Positions of the vertices and transforms of the joints in one pose, as a reader of the file computes them.
pub(super) fn world_of(joints: &[RigJoint], pose: &LocalPose) -> Vec<(Quat, Vec3)> {
    let mut out: Vec<(Quat, Vec3)> = Vec::with_capacity(joints.len());
    for (joint, rotation) in joints.iter().zip(&pose.rotations) {
        out.push(match joint.parent {
            None => (*rotation, pose.hips),
            Some(p) => (out[p].0 * *rotation, out[p].1 + out[p].0 * (joint.rest - joints[p].rest)),
        });
    }
    out
}

/// Turn to the left and bend forward of the head relative to the ribs at a time of a score, degrees.
pub(super) fn head_turn(score: &Score, secs: f32) -> [f32; 2] {
    let [forward, _, left] = score.curve(&score.head, secs - HEAD_LAG_SECS);
    [left, forward]
}
