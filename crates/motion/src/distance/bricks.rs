//! Coarse cells near the surface, divided into finer ones.

use glam::UVec3;
use rayon::prelude::*;

use super::{
    Exact,
    lattice::{Lattice, WHOLE, interpolate},
    signs::{MeasuredPoint, sign_points},
};

/// Number of finer cells along each side of a coarse one.
pub(super) const CELLS: usize = 4;
const CORNERS: usize = CELLS + 1;

/// Distances at the corners of the finer cells of one coarse cell, x fastest, including all of its faces.
#[derive(Clone, Debug)]
pub(super) struct Brick([f32; CORNERS * CORNERS * CORNERS]);

impl Brick {
    fn index(at: UVec3) -> usize {
        (at.z as usize * CORNERS + at.y as usize) * CORNERS + at.x as usize
    }

    /// The distances at the eight corners of a finer cell, x fastest.
    pub(super) fn corners_of(&self, cell: UVec3) -> [f32; 8] {
        const LAYER: usize = CORNERS * CORNERS;
        let first = Self::index(cell);
        let corners: &[f32] = &self.0[first..first + LAYER + CORNERS + 2];
        [0, 1, CORNERS, CORNERS + 1, LAYER, LAYER + 1, LAYER + CORNERS, LAYER + CORNERS + 1]
            .map(|k| corners[k])
    }

    /// Measures exact distances at the corners that are not on the faces shared with the next cells.
    fn measure(exact: &Exact, lattice: &Lattice, cell: UVec3) -> Self {
        let low = lattice.position(cell);
        let step = lattice.cell / CELLS as f32;
        let mut points =
            own_corners().map(|at| MeasuredPoint { at: low + at.as_vec3() * step, distance: f32::MAX });
        let mut leaves = Vec::new();
        let mut guess = None;
        for block in 0..8 {
            let [x, y, z] = [block & 1, block >> 1 & 1, block >> 2].map(|k| 2 * k);
            let members: [usize; 8] =
                std::array::from_fn(|k| ((z + (k >> 2)) * CELLS + y + (k >> 1 & 1)) * CELLS + x + (k & 1));
            let centre = points[members[0]].at.midpoint(points[members[7]].at);
            let Some(hit) = exact.tree.closest(centre, guess) else { break };
            guess = Some(hit.triangle);
            // The closest point is no farther from a corner than through the centre.
            exact.tree.leaves_around(centre, hit.distance_squared.sqrt() + 2.0 * 0.867 * step, &mut leaves);
            for i in members {
                let hit = exact.tree.closest_of(&leaves, points[i].at, hit.triangle);
                points[i].distance = hit.distance_squared.sqrt();
            }
        }
        let distances = lattice.corners_of(cell);
        let around: [MeasuredPoint; 8] = std::array::from_fn(|k| MeasuredPoint {
            at: lattice.position(cell + UVec3::new(k as u32 & 1, k as u32 >> 1 & 1, k as u32 >> 2)),
            distance: distances[k],
        });
        sign_points(exact, &around, &mut points);
        let mut brick = Self([0.0; CORNERS * CORNERS * CORNERS]);
        for (at, point) in own_corners().into_iter().zip(&points) {
            brick.0[Self::index(at)] = point.distance;
        }
        brick
    }
}

/// The corners of finer cells that belong to this cell and to no other.
fn own_corners() -> [UVec3; CELLS * CELLS * CELLS] {
    std::array::from_fn(|i| {
        UVec3::new((i % CELLS) as u32, (i / CELLS % CELLS) as u32, (i / CELLS / CELLS) as u32)
    })
}

/// Divides the cells `near` the surface; `numbers` holds the index of each cell among them.
pub(super) fn make_bricks(exact: &Exact, lattice: &Lattice, numbers: &[u32], near: &[UVec3]) -> Vec<Brick> {
    let own: Vec<Brick> =
        near.par_iter().with_min_len(8).map(|&cell| Brick::measure(exact, lattice, cell)).collect();
    let number = |cell: UVec3| {
        let within = cell.cmplt(lattice.cells).all();
        if within { numbers[lattice.cell_index(cell)] } else { WHOLE }
    };
    (near.par_iter().zip(&own).with_min_len(64))
        .map(|(&cell, own_brick)| {
            let mut brick = own_brick.clone();
            let coarse = lattice.corners_of(cell);
            let sides = CORNERS as u32;
            for i in 0..sides.pow(3) {
                let at = UVec3::new(i % sides, i / sides % sides, i / sides / sides);
                let next = UVec3::new(at.x / CELLS as u32, at.y / CELLS as u32, at.z / CELLS as u32);
                let first = at.cmpeq(UVec3::ZERO);
                if next == UVec3::ZERO && !first.any() {
                    continue;
                }
                // On a face shared with an undivided cell, the finer corners follow its interpolation, so
                // that the distance is continuous.
                let divided = (0..8_u32).all(|k| {
                    let aside = UVec3::new(k & 1, k >> 1 & 1, k >> 2);
                    let back = aside * UVec3::new(first.x.into(), first.y.into(), first.z.into());
                    let ahead = aside * next;
                    // There is no neighbour outside the grid.
                    let beside = (cell + ahead).wrapping_sub(back);
                    beside.cmpge(lattice.cells).any() || number(beside) != WHOLE
                });
                let owner = number(cell + next);
                brick.0[Brick::index(at)] = if divided && owner != WHOLE {
                    own[owner as usize].0[Brick::index(at - next * CELLS as u32)]
                } else {
                    interpolate(&coarse, at.as_vec3() / CELLS as f32).0
                };
            }
            brick
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_of_a_finer_cell() {
        let brick = Brick(std::array::from_fn(|i| i as f32));
        let [a, .., b] = brick.corners_of(UVec3::splat(CELLS as u32 - 1));
        assert_eq!((a, b), (93.0, 124.0));
        assert_eq!(Brick::index(UVec3::ONE), 31);
        assert!(own_corners().iter().all(|at| at.cmplt(UVec3::splat(4)).all()));
        assert_eq!(own_corners()[21], UVec3::ONE);
    }
}
