//! Interpolation between two frames of guides.

use glam::{Affine3A, DMat3, DQuat, DVec3};
use lovelock_groom::GuideFrame;

/// Writes the guides at the fraction `t` (0 to 1) from `a` to `b`, which have the same layout, into `out`. The head's rotation
/// is interpolated by slerp and its position linearly; points move in straight lines in head space; each link's length lies
/// between its lengths in `a` and `b`. The time of `out` is left as it is.
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

/// The transform of the head in double precision.
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
