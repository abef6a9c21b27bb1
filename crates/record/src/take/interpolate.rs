//! Between two frames of a take.

use glam::{Affine3A, DMat3, DQuat, DVec3};
use lovelock_groom::GuideFrame;

use super::TakeFrame;

/// Writes the instant at the fraction `t` (0 to 1) from `a` to `b` into `out`. `clip_secs` is the length of the clip,
/// over whose end the time of the clip may run between the two. Where the motion jumped or the guides are others, it is the nearer
/// of the two.
pub(super) fn between(a: &TakeFrame, b: &TakeFrame, t: f64, clip_secs: f64, out: &mut TakeFrame) {
    let layout = |frame: &TakeFrame| (frame.guides.guides.points_per_guide, frame.guides.guides.x.len());
    if b.jumped || layout(a) != layout(b) {
        out.clone_from(if t < 0.5 { a } else { b });
        return;
    }
    out.clone_from(a);
    out.guides.time_secs = a.guides.time_secs + (b.guides.time_secs - a.guides.time_secs) * t;
    out.clip_secs = mix_clip(a.clip_secs, b.clip_secs, t, clip_secs);

    mix_guides(&a.guides, &b.guides, t, &mut out.guides);
}

/// Writes the guides at the fraction `t` (0 to 1) from `a` to `b`, which have the same layout, into `out`: the head turns
/// and moves, each point goes straight in the head's space, and links keep a length between those of the two. The time of
/// `out` stays.
pub fn mix_guides(a: &GuideFrame, b: &GuideFrame, t: f64, out: &mut GuideFrame) {
    let (from, to) = (Head::new(&a.world_from_head), Head::new(&b.world_from_head));
    let turn = from.turn.slerp(to.turn, t);
    let place = from.place.lerp(to.place, t);
    out.world_from_head = Affine3A::from_rotation_translation(turn.as_quat(), place.as_vec3());
    let matrix = DMat3::from_quat(turn);

    let (old, new) = (&a.guides, &b.guides);
    let into = &mut out.guides;
    into.clone_from(old);
    let points = into.points_per_guide;
    for guide in 0..old.count() {
        let mut last = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
        for point in 0..points {
            let p = from.to_head(old.point(guide, point).as_dvec3());
            let q = to.to_head(new.point(guide, point).as_dvec3());
            let middle = p.lerp(q, t);
            let here = if point == 0 {
                middle
            } else {
                let length = p.distance(last.0) + (q.distance(last.1) - p.distance(last.0)) * t;
                let before = last.0.lerp(last.1, t);
                last.2 + (middle - before).normalize_or_zero() * length
            };
            last = (p, q, here);
            let world = (matrix * here + place).as_vec3();
            let i = guide * points + point;
            (into.x[i], into.y[i], into.z[i]) = (world.x, world.y, world.z);
        }
    }
}

/// Where the head is, in double precision.
struct Head {
    turn: DQuat,
    place: DVec3,
}

impl Head {
    fn new(transform: &Affine3A) -> Self {
        let matrix = DMat3::from_cols_array(&transform.matrix3.to_cols_array().map(f64::from));
        Self { turn: DQuat::from_mat3(&matrix).normalize(), place: transform.translation.as_dvec3() }
    }

    fn to_head(&self, world: DVec3) -> DVec3 {
        self.turn.inverse() * (world - self.place)
    }
}

/// The time of a clip between two frames; past its end it starts again.
fn mix_clip(a: f64, b: f64, t: f64, clip_secs: f64) -> f64 {
    if b >= a || clip_secs <= 0.0 {
        return a + (b - a) * t;
    }
    let on = a + (b + clip_secs - a) * t;
    if on < clip_secs { on } else { on - clip_secs }
}
