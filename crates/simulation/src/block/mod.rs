//! Guides side by side: their state and the working memory of a step.

mod bending;
mod coupled;
mod lengths;

use glam::Vec3;
use lovelock_groom::Guides;

use crate::colliders::boxes::Boxes;
use crate::colliders::field::{PlaneRow, Search};
use crate::lanes::{LANES, Lane, Lane3, Map, ZERO, ZERO3, at, greater, lesser, put};
use crate::rest::RestShape;
pub(crate) use bending::{Bending, BendingKey};
pub(crate) use coupled::Coupled;
pub(crate) use lengths::{LengthScratch, project_position, project_velocity};

/// `LANES` guides. Rows are points, root first. Positions are in working space: the axes of the world, the
/// origin where the head was at the end of the last step, so that single precision is spent on hair and not
/// on the way to the dancer.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// The guide of each lane; lanes from `used` on repeat the last.
    pub(crate) guides: [u32; LANES],
    pub(crate) used: usize,
    pub(crate) rest: RestShape,
    /// Signed distance at rest of point `i` to collider `c` at `c * points + i`, metres.
    pub(crate) rest_distance: Vec<Lane>,
    /// Signed distance at rest of each point to the field of head and shoulders, metres; empty without one.
    pub(crate) field_distance: Vec<Lane>,
    /// Where at rest the skin is that was last found near each point; see [`PlaneRow::rest`].
    pub(crate) skin: Vec<Lane3>,

    /// How firmly ties hold each point; negative where none does.
    pub(crate) held: Vec<Lane>,

    pub(crate) position: Vec<Lane3>,
    pub(crate) velocity: Vec<Lane3>,
    /// The bend at rest in the frame of the last substep.
    pub(crate) bend: Vec<Lane3>,
    /// What contacts have moved each point by in the last substep, where they still do, metres.
    pub(crate) leans: Vec<Lane3>,
    /// Whether there is any of that; see [`Block::leans`].
    pub(crate) leaning: bool,
    pub(crate) bending: Bending,
    pub(crate) coupled: Coupled,
    /// Lent for the time of a step; empty between steps.
    pub(crate) work: Work,
    pub(crate) outcome: Outcome,
}

/// Working memory of a step: nothing in it outlives the step. Each thread has one and lends it to the blocks that it
/// takes through a step, so that it stays in the cache however many blocks there are.
#[derive(Clone, Debug, Default)]
pub(crate) struct Work {
    /// The pose at the beginning of the step, to which what has been lost is put back.
    pub(crate) good: Vec<Lane3>,
    /// Where points were at the beginning of the substep, once they have been laid.
    pub(crate) was: Vec<Lane3>,
    /// What forces add to velocities in a substep, and what they leave of them.
    pub(crate) push: Vec<Lane3>,
    pub(crate) keep: Vec<Lane>,
    pub(crate) next: Vec<Lane3>,
    /// The directions of the links of `next`.
    pub(crate) links: Vec<Lane3>,
    pub(crate) next_bend: Vec<Lane3>,
    pub(crate) residual: Vec<Lane3>,
    pub(crate) lengths: LengthScratch,
    /// What the points have learnt of the field.
    pub(crate) planes: Vec<PlaneRow>,
    /// The rows that look for skin.
    pub(crate) searches: Vec<Search>,
    /// The colliders near the block, and how deep they have closed over the roots.
    pub(crate) active: Vec<u32>,
    pub(crate) boxes: Boxes,
    pub(crate) buried: Vec<Lane>,
}

impl Work {
    /// Makes room for guides of `points` points. What is in the rows is of some other step.
    pub(crate) fn fit(&mut self, points: usize) {
        for rows in [
            &mut self.good,
            &mut self.was,
            &mut self.push,
            &mut self.next,
            &mut self.links,
            &mut self.next_bend,
            &mut self.residual,
        ] {
            rows.resize(points, ZERO3);
        }
        self.keep.resize(points, ZERO);
        self.planes.resize(points, PlaneRow::unknown(PlaneRow::NO_SKIN));
        self.lengths.fit(points);
    }
}

/// Shorter links are measured by this length, metres: single precision rounds the ends of a link of a micrometre by percents of it,
/// and nobody sees that.
const FINE: f32 = 1e-3;

/// Relative change of the length of a link, now `link`, whose length at rest is one over `inv`; 0 where that is 0, beyond the end
/// of a guide that was cut.
#[inline(always)]
pub(crate) fn stretch_of(link: Vec3, inv: f32) -> f32 {
    let change = (link.length_squared().sqrt() * inv - 1.0).abs();
    if inv > 0.0 { change * lesser(1.0, 1.0 / (FINE * inv)) } else { 0.0 }
}

/// What a block has to report of a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    pub(crate) max_stretch: f32,
    pub(crate) deepest: Depth,
    pub(crate) deepest_guide: u32,
    /// Points in skin of which only a guess is known, and the first of them: its guide and its number.
    pub(crate) unsure: u32,
    pub(crate) first_unsure: Option<(u32, u32)>,
    pub(crate) recovered: u32,
    /// The first lane that was put back.
    pub(crate) first_recovered: Option<usize>,
    /// Sum of `v^2 / 2` over the free points.
    pub(crate) energy: f64,
    pub(crate) max_speed_squared: f32,
}

/// How deep a point is inside a collider.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Depth {
    /// Metres.
    pub(crate) metres: f32,
    pub(crate) point: u32,
    /// Its index; [`crate::colliders::contact::FIELD`] for the field.
    pub(crate) collider: u32,
}

impl Block {
    pub(crate) fn new(guides: &Guides, lanes: [u32; LANES], used: usize, first_free: usize) -> Self {
        let points = guides.points_per_guide;
        Self {
            guides: lanes,
            used,
            rest: RestShape::new(guides, &lanes, first_free),
            rest_distance: Vec::new(),
            held: vec![Lane::splat(-1.0); points],
            field_distance: Vec::new(),
            skin: vec![PlaneRow::NO_SKIN; points],
            position: vec![ZERO3; points],
            velocity: vec![ZERO3; points],
            bend: vec![ZERO3; points],
            leans: vec![ZERO3; points],
            leaning: false,
            bending: Bending::new(points),
            coupled: Coupled::new(points),
            work: Work::default(),
            outcome: Outcome::default(),
        }
    }

    pub(crate) fn points(&self) -> usize {
        self.position.len()
    }

    /// The guide and the point at which `of` a lane and a point is largest, beginning with the point `first`; what is not a
    /// number is none.
    pub(crate) fn most(&self, first: usize, of: impl Fn(&Self, usize, usize) -> f32) -> Option<(u32, u32)> {
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

    /// Whether contacts still move any point.
    #[inline(always)]
    pub(crate) fn leans(&self) -> bool {
        let mut most = ZERO;
        for row in &self.leans {
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

    /// Puts the rest shape, without motion, where `from_head` carries it.
    pub(crate) fn place_at_rest(&mut self, from_head: &Map) {
        for i in 0..self.points() {
            for k in 0..LANES {
                put(&mut self.position[i], k, from_head.apply(at(&self.rest.position[i], k)));
                put(&mut self.bend[i], k, from_head.rotate(at(&self.rest.bend[i], k)));
            }
        }
        self.velocity.fill(ZERO3);
        self.leans.fill(ZERO3);
        self.leaning = false;
        self.skin.fill(PlaneRow::NO_SKIN);
        self.coupled.forget();
    }

    /// Moves everything rigidly, velocities included.
    pub(crate) fn carry(&mut self, by: &Map) {
        self.skin.fill(PlaneRow::NO_SKIN);
        self.leans.fill(ZERO3);
        self.leaning = false;
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

    /// Takes the motion of `old`, a block of the same guides in another style: each link keeps the turn that
    /// it has from its rest direction, and the lock is laid anew with its own lengths from its own root.
    pub(crate) fn adopt(&mut self, old: &Block, from_head: &Map) {
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
                    turn = turn.then_least(was, direction_or(link, was).0);
                    end += turn.apply(at(&self.rest.direction[i], k)) * self.rest.length[i][k];
                }
                put(&mut self.position[i], k, end);
                put(&mut self.bend[i], k, turn.apply(at(&self.rest.bend[i], k)));
            }
        }
        self.velocity.copy_from_slice(&old.velocity);
    }
}
