//! Compares the pose in which all rotations of the source are zero with the rest pose of the target.
//!
//! If that zero pose is a standing pose, the trunks differ only in the direction that they face, and only
//! limbs are aligned bone by bone (T-pose against A-pose). If it is not a plausible pose (exporters that lay
//! every bone along +X), every bone is aligned, from the hips outward, by the smallest rotation that remains
//! after its parent's; this is the rotation that the first frame of such an exporter undoes. Some rigs also
//! roll bones about themselves by half or a quarter turn. That is detected from the motion, in which no joint
//! is twisted so far.

use std::f32::consts::PI;

use glam::{Mat3, Quat, Vec3};

use crate::humanoid::{Humanoid, Role, Side};
use crate::{MotionFile, Skeleton};

/// For each source joint the rotation from the target's rest pose to the source's zero pose, in the world.
pub(super) struct Alignment {
    turns: Vec<Quat>,
}

impl Alignment {
    pub(super) fn of(&self, joint: usize) -> Quat {
        self.turns[joint]
    }

    pub(super) fn new(
        motion: &MotionFile,
        source: &Humanoid,
        skeleton: &Skeleton,
        target: &Humanoid,
        turned: &[Vec<Quat>],
    ) -> Self {
        let mut builder = Builder {
            motion,
            source,
            target,
            source_rest: motion.rest(),
            target_rest: (0..skeleton.joints.len()).map(|j| skeleton.rest_position(j)).collect(),
            turns: vec![Quat::IDENTITY; motion.joints.len()],
            turned,
        };
        let is_standing = builder.is_standing();
        builder.trunk(is_standing);
        for side in Side::BOTH {
            builder.arm(side, is_standing);
            builder.leg(side, is_standing);
        }
        if !is_standing {
            builder.flatten_feet();
            builder.head();
        }
        Self { turns: builder.turns }
    }
}

struct Builder<'a> {
    motion: &'a MotionFile,
    source: &'a Humanoid,
    target: &'a Humanoid,
    source_rest: Vec<Vec3>,
    target_rest: Vec<Vec3>,
    turns: Vec<Quat>,
    /// World rotations of all joints in some frames.
    turned: &'a [Vec<Quat>],
}

/// Rigs roll arms and legs by multiples of this. These joints roll so far themselves that smaller multiples
/// could not be detected, radians.
const HALF: f32 = PI;

/// Rigs roll collar bones and feet by multiples of this, radians.
const QUARTER: f32 = PI / 2.0;

/// A roll is attributed to the rig from this fraction of a multiple on, because people also hold their hands
/// up for a while.
const LEAST_MULTIPLE: f32 = 0.75;

impl Builder<'_> {
    fn source_at(&self, role: Role) -> Option<Vec3> {
        self.source.get(role).map(|j| self.source_rest[j])
    }

    /// Direction of the bone between two roles in the source's zero pose.
    fn source_bone(&self, from: Role, to: Role) -> Option<Vec3> {
        (self.source_at(to)? - self.source_at(from)?).try_normalize()
    }

    fn target_bone(&self, from: Role, to: Role) -> Option<Vec3> {
        (self.target_rest[self.target.get(to)?] - self.target_rest[self.target.get(from)?]).try_normalize()
    }

    fn set(&mut self, role: Role, turn: Quat) {
        if let Some(j) = self.source.get(role) {
            self.turns[j] = turn;
        }
    }

    /// Whether the zero pose has the head above the hips and the feet below, with nearly vertical legs.
    fn is_standing(&self) -> bool {
        let up = |from: Role, to: Role| self.source_bone(from, to).map_or(1.0, |d| d.y);
        let legs =
            Side::BOTH.map(|s| up(Role::Shin(s), Role::Thigh(s)).min(up(Role::Foot(s), Role::Shin(s))));
        up(Role::Hips, Role::Head) > 0.7 && legs[0].min(legs[1]) > 0.6
    }

    /// The frame of the hips: left along X, up along the spine, orthogonalised against X.
    fn hips(&self, is_standing: bool) -> Quat {
        let sides = Side::BOTH.map(|s| self.source_at(Role::Thigh(s)));
        let [Some(left), Some(right)] = sides else { return Quat::IDENTITY };
        let Some(x) = (left - right).try_normalize() else { return Quat::IDENTITY };
        let hips = self.source_at(Role::Hips).unwrap_or_default();
        let mut first_up =
            self.source.spine.iter().chain(&self.source.neck).map(|&j| self.source_rest[j] - hips);
        let up =
            if is_standing { Vec3::Y } else { first_up.find_map(Vec3::try_normalize).unwrap_or(Vec3::Y) };
        let Some(y) = (up - x * up.dot(x)).try_normalize() else { return Quat::IDENTITY };
        if is_standing {
            // Only the facing direction counts: tilted hips in a file do not belong to a pose.
            let forward = x.cross(Vec3::Y);
            return Quat::from_rotation_y(forward.x.atan2(forward.z));
        }
        Quat::from_mat3(&Mat3::from_cols(x, y, x.cross(y))).normalize()
    }

    fn trunk(&mut self, is_standing: bool) {
        let hips = self.hips(is_standing);
        self.turns.fill(hips);
        if is_standing {
            return;
        }
        // In a standing figure spine, neck and head point up, whatever bends the joints of a rig describe.
        let mut turn = hips;
        let mut chain: Vec<usize> = self.source.spine.iter().chain(&self.source.neck).copied().collect();
        chain.extend(self.source.get(Role::Head));
        for (i, &j) in chain.iter().enumerate() {
            let bone = match chain.get(i + 1) {
                Some(&next) => self.source_rest[next] - self.source_rest[j],
                None => self.motion.joints[j].end.unwrap_or_default(),
            };
            if let Some(bone) = bone.try_normalize() {
                turn = swing(turn, Vec3::Y, bone);
            }
            self.turns[j] = turn;
        }
    }

    fn chest(&self) -> Quat {
        let chest = self.source.spine.last().copied().or(self.source.get(Role::Hips));
        chest.map_or(Quat::IDENTITY, |j| self.turns[j])
    }

    /// The alignment `turn` of a role, whose bone points along `axis` at rest, without the multiple of `part`
    /// by which the joint is rolled relative to its carrier on average.
    fn without_rig_roll(
        &self,
        role: Role,
        carrier: Option<usize>,
        axis: Vec3,
        turn: Quat,
        part: f32,
    ) -> Quat {
        let (Some(joint), Some(carrier)) = (self.source.get(role), carrier) else { return turn };
        let (mut sin, mut cos, mut all) = (0.0, 0.0, 0.0);
        for world in self.turned {
            let held = world[carrier] * self.turns[carrier];
            let against = held.conjugate() * (world[joint] * turn);
            // Sine and cosine of twice the half angle, weighted by certainty, which is zero where the bone
            // points back.
            let (along, w) = (against.xyz().dot(axis), against.w);
            (sin, cos, all) =
                (sin + 2.0 * along * w, cos + w * w - along * along, all + w * w + along * along);
        }
        let is_certain = sin.hypot(cos) > 0.5 * all;
        let roll = sin.atan2(cos);
        let multiples = (roll.abs() / part + 1.0 - LEAST_MULTIPLE).floor();
        if !is_certain || multiples < 1.0 {
            return turn;
        }
        (turn * Quat::from_axis_angle(axis, -roll.signum() * multiples * part)).normalize()
    }

    fn arm(&mut self, side: Side, is_standing: bool) {
        let mut turn = self.chest();
        let mut carrier = self.source.spine.last().copied().or(self.source.get(Role::Hips));
        if let Some(bone) =
            self.source_bone(Role::Clavicle(side), Role::UpperArm(side)).filter(|_| !is_standing)
        {
            let aside = Vec3::X * side.sign();
            turn = self.without_rig_roll(
                Role::Clavicle(side),
                carrier,
                aside,
                swing(turn, aside, bone),
                QUARTER,
            );
        }
        self.set(Role::Clavicle(side), turn);
        carrier = self.source.get(Role::Clavicle(side)).or(carrier);
        for (from, to) in
            [(Role::UpperArm(side), Role::Forearm(side)), (Role::Forearm(side), Role::Hand(side))]
        {
            if let (Some(target), Some(source)) = (self.target_bone(from, to), self.source_bone(from, to)) {
                turn = swing(turn, target, source);
                if !is_standing {
                    turn = self.without_rig_roll(from, carrier, target, turn, HALF);
                }
            }
            self.set(from, turn);
            carrier = self.source.get(from).or(carrier);
        }
        if let Some(bone) = self.target_bone(Role::Forearm(side), Role::Hand(side)).filter(|_| !is_standing) {
            turn = self.without_rig_roll(Role::Hand(side), carrier, bone, turn, HALF);
        }
        self.set(Role::Hand(side), turn);
    }

    fn leg(&mut self, side: Side, is_standing: bool) {
        let pelvis = self.source.get(Role::Pelvis).or(self.source.get(Role::Hips));
        let trunk = pelvis.map_or(Quat::IDENTITY, |j| self.turns[j]);
        let (mut turn, mut carrier) = (trunk, pelvis);
        for (from, to) in [(Role::Thigh(side), Role::Shin(side)), (Role::Shin(side), Role::Foot(side))] {
            if let (Some(target), Some(source)) = (self.target_bone(from, to), self.source_bone(from, to)) {
                turn = swing(turn, target, source);
                if !is_standing {
                    turn = self.without_rig_roll(from, carrier, target, turn, HALF);
                }
            }
            self.set(from, turn);
            carrier = self.source.get(from).or(carrier);
        }
        let bones = (
            self.target_bone(Role::Foot(side), Role::Toe(side)),
            self.source_bone(Role::Foot(side), Role::Toe(side)),
        );
        let foot = match bones {
            (Some(target), Some(source)) if is_standing => {
                // Both soles are level whatever the height of the ankles: only the direction of the toes
                // counts.
                let (a, b) = (trunk * target, source);
                Quat::from_rotation_y(b.x.atan2(b.z) - a.x.atan2(a.z)) * trunk
            }
            _ if is_standing => trunk,
            (Some(target), Some(source)) => {
                self.without_rig_roll(Role::Foot(side), carrier, target, swing(turn, target, source), QUARTER)
            }
            _ => turn,
        };
        self.set(Role::Foot(side), foot);
        self.set(Role::Toe(side), foot);
        if let (Some(bone), false) = (self.target_bone(Role::Foot(side), Role::Toe(side)), is_standing)
            && let Some(end) = self.source.get(Role::Toe(side)).and_then(|j| self.motion.joints[j].end)
            && let (Some(forward), Some(end)) =
                ((bone * Vec3::new(1.0, 0.0, 1.0)).try_normalize(), end.try_normalize())
        {
            // Toes are level at rest, although the bone of the foot slopes.
            self.set(Role::Toe(side), swing(foot, forward, end));
        }
    }

    /// Corrects the alignment of the feet so that the soles are level in the frames in which an ankle is
    /// lowest, where it stands. In some files one foot never stands, so both are corrected alike.
    fn flatten_feet(&mut self) {
        let feet: Vec<(Side, usize)> =
            Side::BOTH.iter().filter_map(|&s| Some((s, self.source.get(Role::Foot(s))?))).collect();
        let mirror = |side: Side| Vec3::new(side.sign(), 1.0, 1.0);
        let mut world = Vec::new();
        let mut samples: Vec<(f32, Vec3)> = Vec::new();
        for frame in 0..self.motion.frames {
            self.motion.world(frame, &mut world);
            for &(side, foot) in &feet {
                let turn = Quat::from_mat3a(&world[foot].matrix3) * self.turns[foot];
                samples.push((world[foot].translation.y, mirror(side) * (turn.conjugate() * Vec3::Y)));
            }
        }
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Few enough samples that a single moment of standing is enough in a dance on the toes.
        let lowest = samples.len().div_ceil(33);
        let up = samples[..lowest].iter().map(|(_, up)| *up).sum::<Vec3>().normalize_or(Vec3::Y);
        // Feet that never stand give no information.
        if up.y > 0.5 {
            for (side, foot) in feet {
                self.turns[foot] *=
                    Quat::from_rotation_arc(Vec3::Y, (mirror(side) * up).normalize_or(Vec3::Y));
            }
        }
    }

    /// Chooses the alignment of the head. Its frame may follow that of the neck or the hips, and its end site
    /// may point anywhere; people mostly hold their heads like their chests.
    fn head(&mut self) {
        let (Some(head), Some(hips)) = (self.source.get(Role::Head), self.source.get(Role::Hips)) else {
            return;
        };
        let chest = self.source.spine.last().copied().unwrap_or(hips);
        let neck = self.source.neck.last().copied().unwrap_or(chest);
        let candidates = [self.turns[head], self.turns[neck], self.turns[hips]];
        let mut scores = [0.0; 3];
        for world in self.turned {
            let held = world[chest] * self.turns[chest];
            for (score, candidate) in scores.iter_mut().zip(candidates) {
                *score += (world[head] * candidate).dot(held).abs();
            }
        }
        let best = (0..3).fold(0, |best, k| if scores[k] > scores[best] + 1e-3 { k } else { best });
        self.turns[head] = candidates[best];
    }
}

/// `turn` followed by the smallest rotation that brings a bone, which points along `target` at rest, along
/// `source`.
fn swing(turn: Quat, target: Vec3, source: Vec3) -> Quat {
    (Quat::from_rotation_arc((turn * target).normalize_or(source), source) * turn).normalize()
}
