//! Guides stored side by side: their state and the working memory of a step.

mod bending;
mod coupled;
mod in_rope;
mod lengths;

use glam::Vec3;
use lovelock_groom::Guides;

use crate::colliders::boxes::Boxes;
use crate::colliders::field::{PlaneRow, Search};
use crate::factors::FactorRows;
use crate::lanes::{LANES, Lane, Lane3, Map, ZERO, ZERO3, at, greater, lesser, put};
use crate::packing::Lanes;
use crate::rest::RestShape;
pub(crate) use bending::Bending;
pub use bending::BendingKey;
pub(crate) use coupled::Coupled;
pub(crate) use in_rope::{InRope, NO_ROPE};
pub(crate) use lengths::{LengthScratch, project_position, project_velocity};

/// The constants of bends and lengths by name, for other devices.
pub(crate) const CONSTANTS: [(&str, f64); 6] = {
    let ([a, b, c, d], [e, f]) = (bending::CONSTANTS, coupled::CONSTANTS);
    [a, b, c, d, e, f]
};

/// A block of `LANES` guides. Rows are points, root first. Positions are in working space: the axes of the
/// world, with the origin at the head's position at the end of the last step, so that single precision
/// resolves the hair well wherever the dancer stands.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// The guide in each lane. Lanes from `used` on repeat the last guide.
    pub(crate) guides: [u32; LANES],
    pub(crate) used: usize,
    /// The first `3 * locks` lanes hold whole locks; see [`crate::packing`].
    pub(crate) locks: usize,
    pub(crate) rest: RestShape,
    /// Signed rest distance of point `i` to collider `c` at `c * points + i`, metres.
    pub(crate) rest_distance: Vec<Lane>,
    /// Signed rest distance of each point to the field of head and shoulders, metres; empty without a field.
    pub(crate) field_distance: Vec<Lane>,
    /// Rest position of the skin that was last found near each point; see [`PlaneRow::rest`].
    pub(crate) skin: Vec<Lane3>,

    /// Strength with which ties hold each point, 1/s; negative where no tie holds it.
    pub(crate) tie_hold: Vec<Lane>,
    /// The factors of the hairstyle on its guides, if any differs from 1.
    pub(crate) factors: Option<Box<FactorRows>>,
    /// The ropes that its guides belong to, if any.
    pub(crate) in_rope: Option<Box<InRope>>,

    pub(crate) position: Vec<Lane3>,
    pub(crate) velocity: Vec<Lane3>,
    /// The rest bend in the frame of the last substep.
    pub(crate) bend: Vec<Lane3>,
    /// Accumulated displacement of each point by contacts that still act on it, metres.
    pub(crate) contact_push: Vec<Lane3>,
    /// Whether any entry of `contact_push` is not zero.
    pub(crate) has_contact_push: bool,
    pub(crate) bending: Bending,
    pub(crate) coupled: Coupled,
    /// Lent by the thread for the duration of a step; empty between steps.
    pub(crate) work: Work,
    pub(crate) outcome: Outcome,
}

/// Working memory of a step; nothing in it outlives the step. Each thread owns one and lends it to the blocks
/// that it steps, so that it stays in the cache however many blocks there are.
#[derive(Clone, Debug, Default)]
pub(crate) struct Work {
    /// The pose at the beginning of the step, which non-finite guides are reset to.
    pub(crate) start_pose: Vec<Lane3>,
    /// Positions at the beginning of the substep, once the points have been placed.
    pub(crate) previous: Vec<Lane3>,
    /// Velocity that the forces add per substep, and the factor by which they scale the old velocity.
    pub(crate) push: Vec<Lane3>,
    pub(crate) keep: Vec<Lane>,
    /// How densely hair surrounds each point, 0 to 1.
    pub(crate) inside: Vec<Lane>,
    /// How densely hair that the head carries surrounds each point, 0 to 1: less the further the point is from its
    /// place at rest.
    pub(crate) carried: Vec<Lane>,
    pub(crate) next: Vec<Lane3>,
    /// The directions of the links of `next`.
    pub(crate) links: Vec<Lane3>,
    pub(crate) next_bend: Vec<Lane3>,
    pub(crate) residual: Vec<Lane3>,
    pub(crate) lengths: LengthScratch,
    /// What is known of the field around the points.
    pub(crate) planes: Vec<PlaneRow>,
    /// The rows whose skin is being searched.
    pub(crate) searches: Vec<Search>,
    /// The colliders near the block, and how much deeper than at rest they enclose the roots.
    pub(crate) active: Vec<u32>,
    pub(crate) boxes: Boxes,
    pub(crate) root_penetration: Vec<Lane>,
}

impl Work {
    /// Resizes the rows for guides of `points` points. The contents are left over from another step.
    pub(crate) fn fit(&mut self, points: usize) {
        for rows in [
            &mut self.start_pose,
            &mut self.previous,
            &mut self.push,
            &mut self.next,
            &mut self.links,
            &mut self.next_bend,
            &mut self.residual,
        ] {
            rows.resize(points, ZERO3);
        }
        self.keep.resize(points, ZERO);
        self.inside.resize(points, ZERO);
        self.carried.resize(points, ZERO);
        self.planes.resize(points, PlaneRow::unknown(PlaneRow::NO_SKIN));
        self.lengths.fit(points);
    }
}

/// Links shorter than this are measured relative to it, metres: single precision rounds the ends of a link of
/// a micrometre by several per cent of its length, which is invisible.
const SHORTEST_LINK: f32 = 1e-3;

/// Relative length change of `link`, whose inverse rest length is `inv`. 0 where `inv` is 0, beyond the end
/// of a guide that was cut.
#[inline(always)]
pub(crate) fn stretch_of(link: Vec3, inv: f32) -> f32 {
    let change = (link.length_squared().sqrt() * inv - 1.0).abs();
    if inv > 0.0 { change * lesser(1.0, 1.0 / (SHORTEST_LINK * inv)) } else { 0.0 }
}

/// What a block reports about a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    pub(crate) max_stretch: f32,
    pub(crate) deepest: Depth,
    pub(crate) deepest_guide: u32,
    /// Number of points near skin whose position is only a guess, and the guide and index of the first.
    pub(crate) unsure: u32,
    pub(crate) first_unsure: Option<(u32, u32)>,
    pub(crate) recovered: u32,
    /// The first lane that was reset.
    pub(crate) first_recovered: Option<usize>,
    /// Sum of `v^2 / 2` over the free points.
    pub(crate) energy: f64,
    pub(crate) max_speed_squared: f32,
}

/// Places of a guide that differ by less count as the same, square metres: its links are off by as little until the next step.
const ROUNDING_SQUARED: f32 = 1e-12;

/// Penetration of a point into a collider.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Depth {
    /// Metres.
    pub(crate) metres: f32,
    pub(crate) point: u32,
    /// Index of the collider; [`crate::colliders::contact::FIELD`] for the field.
    pub(crate) collider: u32,
}

impl Block {
    pub(crate) fn new(guides: &Guides, lanes: &Lanes, first_free: usize) -> Self {
        let points = guides.points_per_guide;
        Self {
            guides: lanes.guides,
            used: lanes.used,
            locks: lanes.locks,
            rest: RestShape::new(guides, lanes, first_free),
            rest_distance: Vec::new(),
            tie_hold: vec![Lane::splat(-1.0); points],
            factors: None,
            in_rope: None,
            field_distance: Vec::new(),
            skin: vec![PlaneRow::NO_SKIN; points],
            position: vec![ZERO3; points],
            velocity: vec![ZERO3; points],
            bend: vec![ZERO3; points],
            contact_push: vec![ZERO3; points],
            has_contact_push: false,
            bending: Bending::new(points),
            coupled: Coupled::new(points),
            work: Work::default(),
            outcome: Outcome::default(),
        }
    }

    pub(crate) fn points(&self) -> usize {
        self.position.len()
    }

    /// The guides of the block.
    pub(crate) fn lanes(&self) -> Lanes {
        Lanes { guides: self.guides, used: self.used, locks: self.locks }
    }

    /// The guide and point from `first` on at which `of(lane, point)` is largest. NaNs are ignored.
    pub(crate) fn argmax(&self, first: usize, of: impl Fn(&Self, usize, usize) -> f32) -> Option<(u32, u32)> {
        let places = (0..self.used).flat_map(|k| (first..self.points()).map(move |i| (k, i)));
        let (mut most, mut found) = (0.0, None);
        for (k, i) in places {
            let value = of(self, k, i);
            if value > most {
                (most, found) = (value, Some((self.guides[k], i as u32)));
            }
        }
        found
    }

    /// Whether contacts still displace any point.
    #[inline(always)]
    pub(crate) fn any_contact_push(&self) -> bool {
        let mut most = ZERO;
        for row in &self.contact_push {
            for k in 0..LANES {
                most[k] = greater(most[k], at(row, k).length_squared());
            }
        }
        most.iter().any(|&squared| squared > 0.0)
    }

    /// [`stretch_of`] the link that ends at point `i` of lane `k`.
    pub(crate) fn stretch(&self, k: usize, i: usize) -> f32 {
        let (a, b, inv) =
            (at(&self.position[i - 1], k), at(&self.position[i], k), self.rest.inv_length[i][k]);
        stretch_of(b - a, inv)
    }

    /// Places the guides in their rest shape, at rest, with the transform `from_head`.
    pub(crate) fn place_at_rest(&mut self, from_head: &Map) {
        for i in 0..self.points() {
            for k in 0..LANES {
                put(&mut self.position[i], k, from_head.apply(at(&self.rest.position[i], k)));
                put(&mut self.bend[i], k, from_head.rotate(at(&self.rest.bend[i], k)));
            }
        }
        self.velocity.fill(ZERO3);
        self.contact_push.fill(ZERO3);
        self.has_contact_push = false;
        self.skin.fill(PlaneRow::NO_SKIN);
        self.coupled.reset();
    }

    /// Moves the block rigidly, including its velocities.
    pub(crate) fn move_rigidly(&mut self, by: &Map) {
        self.skin.fill(PlaneRow::NO_SKIN);
        self.contact_push.fill(ZERO3);
        self.has_contact_push = false;
        for i in 0..self.points() {
            for k in 0..LANES {
                let p = by.apply(at(&self.position[i], k));
                put(&mut self.position[i], k, p);
                for row in [&mut self.velocity[i], &mut self.bend[i]] {
                    let v = by.rotate(at(row, k));
                    put(row, k, v);
                }
            }
        }
    }

    /// Takes over the motion of `old`, a block of the same guides in another style: each link keeps its
    /// rotation relative to its rest direction, and the guide is rebuilt from its own root with its own link
    /// lengths.
    pub(crate) fn copy_motion(&mut self, old: &Block, from_head: &Map) {
        use crate::lanes::{Turn, direction_or};
        let head = Turn::new(glam::Quat::from_mat3(&from_head.turn));
        for k in 0..LANES {
            let mut turn = head;
            let mut end = Vec3::ZERO;
            for i in 0..self.points() {
                if i == 0 {
                    end = from_head.apply(at(&self.rest.position[0], k));
                } else {
                    let was = turn.apply(at(&old.rest.direction[i], k));
                    let link = at(&old.position[i], k) - at(&old.position[i - 1], k);
                    turn = turn.then_exact(was, direction_or(link, was).0);
                    end += turn.apply(at(&self.rest.direction[i], k)) * self.rest.length[i][k];
                }
                put(&mut self.position[i], k, end);
                put(&mut self.bend[i], k, turn.apply(at(&self.rest.bend[i], k)));
            }
        }
        self.velocity.copy_from_slice(&old.velocity);
    }

    /// Gives the guide in lane `k` the places that it has in lane `lane` of `old`, if both have the same rest shape or those places are nearly
    /// its own: what [`Block::copy_motion`] computes differs from them by rounding, and hair that nobody touches should stay where it is.
    /// `with_bends` says whether `old` has its bends.
    pub(crate) fn keep_places(&mut self, k: usize, old: &Block, lane: usize, with_bends: bool) {
        let points = self.points();
        let same3 = |a: &[Lane3], b: &[Lane3]| (0..points).all(|i| at(&a[i], k) == at(&b[i], lane));
        let (own, rest) = (&self.rest, &old.rest);
        let same = old.points() == points
            && same3(&own.position, &rest.position)
            && same3(&own.direction, &rest.direction)
            && same3(&own.bend, &rest.bend)
            && (0..points).all(|i| own.length[i][k] == rest.length[i][lane]);
        let is_near = |i: usize| {
            at(&self.position[i], k).distance_squared(at(&old.position[i], lane)) < ROUNDING_SQUARED
        };
        if same {
            for i in 0..points {
                put(&mut self.position[i], k, at(&old.position[i], lane));
                if with_bends {
                    put(&mut self.bend[i], k, at(&old.bend[i], lane));
                }
            }
        } else if old.points() == points && (0..points).all(is_near) {
            for i in 0..points {
                put(&mut self.position[i], k, at(&old.position[i], lane));
            }
        }
    }

    /// Computes what moves beside positions and velocities from the positions; see [`Block::copy_motion`].
    pub(crate) fn rebuild(&mut self, from_head: &Map) {
        let mut moved = self.clone();
        moved.copy_motion(self, from_head);
        self.bend = moved.bend;
        self.contact_push.fill(ZERO3);
        self.has_contact_push = false;
        self.skin.fill(PlaneRow::NO_SKIN);
        self.coupled.reset();
    }
}
