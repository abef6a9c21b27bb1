//! Landmarks of the head, the parting, the whorl, and the direction of combing.

use glam::Vec3;

use crate::{GroomSettings, ScalpIndex};
use lovelock_base::numbers::smoothstep;
use lovelock_base::random::SplitMix64;

/// Points of the parting's polyline.
const PART_POINTS: usize = 28;
/// Angle of the whorl behind the top of the head, radians.
const WHORL_BACK: f32 = 0.52;
/// Angle before the top of the head at which the parting ends on the forehead, radians.
const PART_FRONT: f32 = 1.25;

/// A point of the parting.
#[derive(Clone, Copy)]
struct PartPoint {
    position: Vec3,
    normal: Vec3,
}

/// The position of a point relative to the parting.
#[derive(Clone, Copy)]
pub(super) struct OnPart {
    /// Unit direction of the parting at the nearest point, toward the forehead.
    pub along: Vec3,
    /// Outward normal of the scalp at the parting.
    pub normal: Vec3,
    /// Signed distance from the parting's line, metres; positive on the wearer's left.
    pub aside: f32,
    /// 1 in front of the whorl, 0 behind it.
    pub front: f32,
}

/// The landmarks of a head and the combing of its hair.
pub(super) struct Comb {
    /// Middle of the box of the hairy scalp, head space, metres.
    pub centre: Vec3,
    /// Half of that box.
    pub half: Vec3,
    /// The whorl at the crown, around which hair turns.
    pub whorl: Vec3,
    parting: Vec<PartPoint>,
    part_strength: f32,
    sweep: f32,
}

impl Comb {
    /// Finds the landmarks of a scalp; `None` if no hair may grow on it.
    pub(super) fn new(settings: &GroomSettings, index: &ScalpIndex<'_>) -> Option<Self> {
        let scalp = index.scalp();
        let hairy = |t: &&[u32; 3]| t.iter().any(|&v| scalp.mask[v as usize] >= settings.hairline);
        let vertices = scalp.triangles.iter().filter(hairy).flatten().map(|&v| scalp.positions[v as usize]);
        let (low, high) =
            vertices.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        if !low.is_finite() || !high.is_finite() {
            return None;
        }
        let centre = 0.5 * (low + high);
        let half = (0.5 * (high - low)).max(Vec3::splat(1e-3));

        let mut rng = SplitMix64::of_stream(settings.seed, 0xc0b);
        let wobble = [rng.angle(), rng.angle()];
        let mut parting = Vec::with_capacity(PART_POINTS);
        for k in 0..PART_POINTS {
            let t = k as f32 / (PART_POINTS - 1) as f32;
            let angle = -WHORL_BACK + (WHORL_BACK + PART_FRONT) * t;
            // A comb's line is never quite straight: it deviates by up to a millimetre.
            let wander = 0.0009 * ((9.0 * t + wobble[0]).sin() + (23.0 * t + wobble[1]).sin());
            // The whorl of a side parting is off-centre too, but less.
            let aside = settings.part_position * (0.4 + 0.6 * smoothstep(0.0, 0.7, t)) + wander;
            let out = Vec3::new(0.0, angle.cos() * half.y, angle.sin() * half.z) * 1.02;
            let hit = index.closest(centre + out + Vec3::X * aside)?;
            parting.push(PartPoint { position: hit.position, normal: hit.normal });
        }
        Some(Self {
            centre,
            half,
            whorl: parting[0].position,
            parting,
            part_strength: settings.part_strength,
            sweep: settings.sweep,
        })
    }

    /// The position of `p` relative to the parting.
    pub(super) fn on_part(&self, p: Vec3) -> OnPart {
        let mut best = (f32::INFINITY, 0, 0.0);
        for (k, pair) in self.parting.windows(2).enumerate() {
            let (a, b) = (pair[0].position, pair[1].position);
            let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0);
            let d2 = p.distance_squared(a + (b - a) * t);
            if d2 < best.0 {
                best = (d2, k, t);
            }
        }
        let (_, k, t) = best;
        let (a, b) = (self.parting[k], self.parting[k + 1]);
        let along = (b.position - a.position).normalize_or(Vec3::Z);
        let normal = a.normal.lerp(b.normal, t).normalize_or(Vec3::Y);
        let foot = a.position.lerp(b.position, t);
        let first = (self.parting[1].position - self.whorl).normalize_or(Vec3::Z);
        OnPart {
            along,
            normal,
            aside: (p - foot).dot(normal.cross(along)),
            front: smoothstep(-0.012, 0.022, (p - self.whorl).dot(first)),
        }
    }

    /// The side of `p` as in [`Comb::side`], times how strictly a cell of roots must stay on it: 0 behind the whorl,
    /// otherwise up to 1.
    pub(super) fn divided_side(&self, p: Vec3) -> f32 {
        let on = self.on_part(p);
        on.front * self.part_strength * if on.aside < 0.0 { -1.0 } else { 1.0 }
    }

    /// The side of the parting on which `p` lies: 1 on the wearer's left, -1 on the right.
    pub(super) fn side(&self, p: Vec3) -> f32 {
        if self.on_part(p).aside < 0.0 { -1.0 } else { 1.0 }
    }

    /// The combing direction of hair of `side` at `p`, where the surface has the normal `n`: a unit vector in the
    /// surface. `fringe` in 0..=1 turns it toward the forehead.
    pub(super) fn flow(&self, p: Vec3, n: Vec3, side: f32, fringe: f32) -> Vec3 {
        let on = self.on_part(p);
        let away = on.normal.cross(on.along) * side;
        let combed = away * self.part_strength
            - on.along * (1.0 - self.part_strength)
            - on.along
                * (self.sweep
                    * smoothstep(0.02, 0.09, p.z - self.whorl.z)
                    * smoothstep(-0.1, 0.4, (p.y - self.centre.y) / self.half.y));
        let fringed = combed.lerp(on.along + 0.35 * away, fringe);
        // Around the whorl, hair leaves in a spiral that straightens within a few centimetres.
        let radial = p - self.whorl;
        let turn = 0.9 * (-radial.length() / 0.025).exp();
        let spiral = radial.normalize_or(-on.along) + turn * on.normal.cross(radial.normalize_or(-on.along));
        let flow = spiral.lerp(fringed, on.front.max(fringe));
        // In front of the ears and behind them, hair grows down and slightly back.
        let low = smoothstep(0.1, -0.4, (p.y - self.centre.y) / self.half.y);
        let flow = flow.lerp(Vec3::new(0.0, -1.0, -0.35), low);
        (flow - n * flow.dot(n)).normalize_or((away - n * away.dot(n)).normalize_or(Vec3::X))
    }

    /// 1 for roots beside the face, 0 for those behind the ears.
    pub(super) fn frontness(&self, p: Vec3) -> f32 {
        smoothstep(0.25, 0.95, (p.z - self.centre.z) / self.half.z)
    }

    /// Height of `p` on the hairy scalp: 0 at its lowest edge, 1 at the top.
    pub(super) fn rank(&self, p: Vec3) -> f32 {
        ((p.y - self.centre.y) / self.half.y * 0.5 + 0.5).clamp(0.0, 1.0)
    }
}
