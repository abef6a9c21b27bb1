//! Transfers the motion of one skeleton to another by world rotations relative to rest.
//!
//! For each source joint an *alignment* `A` is computed: the world rotation that brings the target's rest
//! pose into the zero pose of the source ([`align`]). With the source's rotation `Q` in a frame, the target's
//! joint rotates by `Q * A` from its own rest. The root follows the midpoint of the source's hips, scaled by
//! the length of the legs, and the figure is put on the ground ([`ground`]).

mod align;
mod ground;
mod twist;

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};

use crate::face;
use crate::humanoid::{Humanoid, Role, Side};
use crate::{Body, Clip, Interpolation, JointTracks, MotionError, MotionFile, Skeleton, Track};
use align::Alignment;

/// The source of a target joint's rotation: a source joint, or an interpolation between two.
#[derive(Clone, Copy, Debug)]
struct Source {
    a: usize,
    b: usize,
    fraction: f32,
}

/// The corresponding joints and everything else that is constant over the frames.
struct Plan<'a> {
    motion: &'a MotionFile,
    skeleton: &'a Skeleton,
    source: Humanoid,
    target: Humanoid,
    /// For each target joint.
    sources: Vec<Option<Source>>,
    alignment: Alignment,
    /// World rotation of each target joint at rest.
    rest_rotations: Vec<Quat>,
    /// Ratio of the leg lengths of target and source.
    scale: f32,
}

/// Transfers a motion to a body.
///
/// The clip starts at the body's own position facing +Z, has one key per frame, and stands on the ground at y
/// = 0. Rest poses may differ (T-pose, A-pose, or implausible poses).
///
/// # Errors
/// If hips, head, thighs or upper arms cannot be found by name or shape; the error contains the side.
pub fn retarget(motion: &MotionFile, body: &Body) -> Result<Clip, MotionError> {
    let plan = Plan::new(motion, body)?;
    let mut turns = plan.turns();
    let start = plan.start_turn(&turns);
    turns.iter_mut().flatten().for_each(|q| *q = start * *q);
    let hips = plan.hips_path(start, &turns);
    let mut driven: Vec<bool> = plan.sources.iter().map(Option::is_some).collect();
    for joint in twist::drive(plan.skeleton, &plan.target, &driven, &mut turns) {
        driven[joint] = true;
    }
    let mut clip = plan.clip(&driven, &turns, &hips);
    (clip.start_secs, clip.lead_secs) = (motion.start_secs, motion.lead_secs);
    face::follow(motion, body, &mut clip);
    ground::set_on_ground(body, &plan.target, &mut clip);
    close_loop(body, &mut clip, motion);
    Ok(clip)
}

impl<'a> Plan<'a> {
    fn new(motion: &'a MotionFile, body: &'a Body) -> Result<Self, MotionError> {
        let skeleton = &body.skeleton;
        let (source, target) = (motion.humanoid(), Humanoid::of_any_skeleton(skeleton));
        let needed = Side::BOTH
            .iter()
            .flat_map(|&s| [Role::Thigh(s), Role::Shin(s), Role::UpperArm(s), Role::Forearm(s)]);
        let missing: Vec<String> = [Role::Hips, Role::Head]
            .into_iter()
            .chain(needed)
            .flat_map(|role| {
                [(&source, "the motion"), (&target, "the body")].map(|(f, of)| (role, f.get(role), of))
            })
            .filter(|(_, joint, _)| joint.is_none())
            .map(|(role, _, of)| format!("{} of {of}", role.label()))
            .collect();
        if !missing.is_empty() {
            let problem =
                format!("neither the name nor the place of any joint tells the {}", missing.join(", the "));
            return Err(MotionError::Retarget {
                motion: motion.name.clone(),
                body: body.name.clone(),
                problem,
            });
        }
        let turned = sampled_turns(motion);
        let alignment = Alignment::new(motion, &source, skeleton, &target, &turned);
        let mut rest_rotations: Vec<Quat> = Vec::with_capacity(skeleton.joints.len());
        for joint in &skeleton.joints {
            let parent = joint.parent.map_or(Quat::IDENTITY, |p| rest_rotations[p]);
            rest_rotations.push((parent * joint.rotation).normalize());
        }
        let scale = leg_length(&target, |j| skeleton.rest_position(j))
            / leg_length(&source, {
                let rest = motion.rest();
                move |j| rest[j]
            });
        let scale = if scale.is_finite() && scale > 0.0 { scale } else { 1.0 };
        let stiff = has_stiff_neck(&source, &turned);
        let sources = sources(&source, &target, skeleton.joints.len(), stiff);
        Ok(Self { motion, skeleton, source, target, sources, alignment, rest_rotations, scale })
    }

    /// World rotation of each mapped target joint relative to its rest: frame by frame, joint by joint;
    /// identity for joints that are not mapped.
    fn turns(&self) -> Vec<Vec<Quat>> {
        let count = self.motion.joints.len();
        let mut world = vec![Quat::IDENTITY; count];
        (0..self.motion.frames)
            .map(|frame| {
                for (j, joint) in self.motion.joints.iter().enumerate() {
                    let local = self.motion.rotations[frame * count + j];
                    world[j] = joint.parent.map_or(local, |p| (world[p] * local).normalize());
                }
                let turn = |j: usize| world[j] * self.alignment.of(j);
                self.sources
                    .iter()
                    .map(|source| match source {
                        None => Quat::IDENTITY,
                        Some(s) if s.fraction == 0.0 => turn(s.a),
                        Some(s) => turn(s.a).slerp(turn(s.b), s.fraction),
                    })
                    .collect()
            })
            .collect()
    }

    /// The rotation about Y that makes the hips face +Z in the first frame.
    fn start_turn(&self, turns: &[Vec<Quat>]) -> Quat {
        let hips = self.target.get(Role::Pelvis).or(self.target.get(Role::Hips));
        let Some((first, hips)) = turns.first().zip(hips) else { return Quat::IDENTITY };
        let facing = first[hips] * Vec3::Z;
        if facing.x.hypot(facing.z) < 1e-3 {
            return Quat::IDENTITY;
        }
        Quat::from_rotation_y(-facing.x.atan2(facing.z))
    }

    /// World position of the target's hips joint in each frame, metres; heights are those of the source,
    /// scaled.
    fn hips_path(&self, start: Quat, turns: &[Vec<Quat>]) -> Vec<Vec3> {
        let thighs = |figure: &Humanoid| Side::BOTH.map(|s| figure.get(Role::Thigh(s)));
        let middle = |joints: [Option<usize>; 2], at: &dyn Fn(usize) -> Vec3| {
            joints.iter().flatten().map(|&j| at(j)).sum::<Vec3>() * 0.5
        };
        let hips = self.target.get(Role::Hips).unwrap_or(0);
        let carrier = self.target.get(Role::Pelvis).unwrap_or(hips);
        let hips_at_rest = self.skeleton.rest_position(hips);
        // The hips joint may be anywhere in the pelvis; the midpoint between the thighs is the same in all
        // rigs.
        let middle_at_rest = middle(thighs(&self.target), &|j| self.skeleton.rest_position(j));
        let mut world: Vec<Affine3A> = Vec::new();
        let mut first = None;
        (0..self.motion.frames)
            .map(|frame| {
                self.motion.world(frame, &mut world);
                let at = start * middle(thighs(&self.source), &|j| world[j].translation.into()) * self.scale;
                let origin = *first.get_or_insert(at * Vec3::new(1.0, 0.0, 1.0));
                let home = middle_at_rest * Vec3::new(1.0, 0.0, 1.0);
                at - origin + home - turns[frame][carrier] * (middle_at_rest - hips_at_rest)
            })
            .collect()
    }

    /// Local tracks of all mapped joints.
    fn clip(&self, driven: &[bool], turns: &[Vec<Quat>], hips_path: &[Vec3]) -> Clip {
        let times: Arc<[f32]> =
            (0..self.motion.frames).map(|f| (f as f64 * self.motion.frame_secs) as f32).collect();
        let hips = self.target.get(Role::Hips).unwrap_or(0);
        let joints = &self.skeleton.joints;
        let mut world = vec![Quat::IDENTITY; joints.len()];
        let mut rotations: Vec<Vec<Quat>> =
            driven.iter().map(|&d| Vec::with_capacity(if d { turns.len() } else { 0 })).collect();
        for frame in turns {
            for (j, joint) in joints.iter().enumerate() {
                let parent = joint.parent.map_or(Quat::IDENTITY, |p| world[p]);
                if driven[j] {
                    world[j] = (frame[j] * self.rest_rotations[j]).normalize();
                    rotations[j].push((parent.conjugate() * world[j]).normalize());
                } else {
                    world[j] = (parent * joint.rotation).normalize();
                }
            }
        }
        // Nothing above the hips moves.
        let above =
            joints[hips].parent.map_or(Affine3A::IDENTITY, |p| self.skeleton.world_at_rest[p].inverse());
        let path = hips_path.iter().map(|&p| above.transform_point3(p)).collect();
        let track = |values| Track { times: times.clone(), values, interpolation: Interpolation::Linear };
        let mut path =
            Some(Track { times: times.clone(), values: path, interpolation: Interpolation::Linear });
        let tracks =
            rotations.into_iter().enumerate().filter(|(_, r)| !r.is_empty()).map(|(joint, r)| JointTracks {
                joint,
                translation: if joint == hips { path.take() } else { None },
                rotation: Some(track(r)),
                scale: None,
            });
        let mut clip = Clip { name: self.motion.name.clone(), joints: tracks.collect(), ..Clip::default() };
        clip.duration_secs = clip.keys_end_secs();
        clip
    }
}

/// Number of frames that are sampled to determine how joints are held.
const SAMPLES: usize = 100;

/// World rotations of all joints of a motion in about [`SAMPLES`] frames.
fn sampled_turns(motion: &MotionFile) -> Vec<Vec<Quat>> {
    let mut world = Vec::new();
    let frames = (0..motion.frames).step_by((motion.frames / SAMPLES).max(1));
    let turns = frames.map(|frame| {
        motion.world(frame, &mut world);
        world.iter().map(|m| Quat::from_mat3a(&m.matrix3)).collect()
    });
    turns.collect()
}

/// A neck that rotates by no more than this relative to the chest was not captured, radians.
const STIFF: f32 = 0.01;

/// Whether the neck is missing or always moves with the chest, so that the head alone bends.
fn has_stiff_neck(source: &Humanoid, turned: &[Vec<Quat>]) -> bool {
    let chest = source.spine.last().copied().or(source.get(Role::Hips));
    let (Some(chest), Some(head)) = (chest, source.get(Role::Head)) else { return false };
    let bends = |joint: usize| {
        let against = |world: &Vec<Quat>| world[chest].conjugate() * world[joint];
        let first = turned.first().map_or(Quat::IDENTITY, against);
        turned.iter().map(|world| first.angle_between(against(world))).fold(0.0, f32::max)
    };
    bends(head) > STIFF && source.neck.iter().all(|&joint| bends(joint) <= STIFF)
}

/// Pairs target joints with source joints by role, and joints of spine and neck by their position in the
/// chain. If the source's neck is stiff, the target's neck takes a share of the head's bend; otherwise all of
/// it would be at the skull, and the nape would fold.
fn sources(source: &Humanoid, target: &Humanoid, joints: usize, stiff_neck: bool) -> Vec<Option<Source>> {
    let mut sources = vec![None; joints];
    let whole = |j: usize| Source { a: j, b: j, fraction: 0.0 };
    let pelvis = source.get(Role::Pelvis).or(source.get(Role::Hips));
    let base = source.get(Role::Hips);
    for (role, joint) in target.roles() {
        let found = match role {
            // A target whose hips are also its pelvis rotates like the legs.
            Role::Hips if target.get(Role::Pelvis).is_none() => pelvis,
            Role::Pelvis => pelvis,
            Role::Chest | Role::Neck => None,
            role => source.get(role),
        };
        if let Some(found) = found {
            sources[joint] = Some(whole(found));
        }
    }
    let chest = source.spine.last().copied().or(base);
    for (chain, on, below) in [(&target.spine, &source.spine, base), (&target.neck, &source.neck, chest)] {
        let Some(below) = below else { continue };
        for (i, &joint) in chain.iter().enumerate() {
            // The joints of a chain share its bend, and the last one has all of it. Position 0 is the joint
            // that carries the chain.
            let place = (i + 1) as f32 * on.len() as f32 / chain.len() as f32;
            let at = |k: usize| if k == 0 { below } else { on[(k - 1).min(on.len() - 1)] };
            let low = place.floor() as usize;
            let fraction = place - place.floor();
            sources[joint] = Some(if on.is_empty() {
                whole(below)
            } else if fraction < 1e-4 {
                whole(at(low))
            } else {
                Source { a: at(low), b: at(low + 1), fraction }
            });
        }
    }
    if let (true, Some(a), Some(head)) =
        (stiff_neck, source.neck.last().copied().or(chest), source.get(Role::Head))
    {
        for (i, &joint) in target.neck.iter().enumerate() {
            let fraction = (i + 1) as f32 / (target.neck.len() + 1) as f32;
            sources[joint] = Some(Source { a, b: head, fraction });
        }
    }
    sources
}

/// Mean length of thigh and shin (only of the thigh if there are no feet), metres.
fn leg_length(figure: &Humanoid, rest: impl Fn(usize) -> Vec3) -> f32 {
    let length = |side: Side| {
        let joints =
            [Role::Thigh(side), Role::Shin(side), Role::Foot(side)].map(|role| figure.get(role).map(&rest));
        joints.windows(2).filter_map(|pair| Some(pair[0]?.distance(pair[1]?))).sum::<f32>()
    };
    Side::BOTH.into_iter().map(length).sum::<f32>() * 0.5
}

/// Makes a clip repeat: unchanged if its ends meet; with one more key, equal to the first, if the step from
/// the last key to the first is like any other (cycles are often stored without the repeated frame).
fn close_loop(body: &Body, clip: &mut Clip, motion: &MotionFile) {
    clip.detect_loop(body);
    let Some(step) = motion.cycle_step().filter(|_| !clip.loops) else { return };
    let step_secs = step as f64 * motion.frame_secs;
    if !clip.seam(body).is_step_like(clip.last_step(body, step_secs)) {
        return;
    }
    let Some(times) = clip.joints.first().and_then(|j| j.rotation.as_ref()).map(|r| r.times.clone()) else {
        return;
    };
    let last = motion.frames.saturating_sub(1) as f64 * motion.frame_secs;
    let times: Arc<[f32]> = times.iter().copied().chain([(last + step_secs) as f32]).collect();
    for joint in &mut clip.joints {
        if let Some(track) = &mut joint.rotation {
            track.values.push(track.values[0]);
            track.times = times.clone();
        }
        if let Some(track) = &mut joint.translation {
            track.values.push(track.values[0]);
            track.times = times.clone();
        }
    }
    clip.duration_secs = clip.keys_end_secs();
    clip.added_secs = step_secs;
    clip.loops = true;
}
