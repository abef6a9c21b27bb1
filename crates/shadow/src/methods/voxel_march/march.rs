//! The march from a point to the light.

use glam::Vec3;

use super::grid::{Around, DEPTH_ONE, Density};
use super::lattice::BRICK;

/// Hair that begins farther away than this is not seen, cells: there the places of steps are rounded.
const FARTHEST: f32 = 1e6;

/// A ray through the window, in cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// Where it starts.
    pub from: Vec3,
    /// Unit length.
    pub along: Vec3,
    /// Its length; may be infinite.
    pub length: f32,
}

impl Way {
    /// Where it enters and leaves a box from the origin to `size`; the first is not below 0.
    pub fn within(&self, size: Vec3) -> [f32; 2] {
        let (mut near, mut far) = (0.0_f32, self.length);
        for axis in 0..3 {
            let inverse = 1.0 / self.along[axis];
            let (a, b) = (-self.from[axis] * inverse, (size[axis] - self.from[axis]) * inverse);
            // NaN where the ray runs along a side of the box: it is within.
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        [near, far]
    }

    /// Optical depth along the way, by steps of `step` cells; the density of a step is read at its part `part`.
    pub fn depth(&self, density: &Density, step: f32, part: f32) -> f32 {
        let [near, far] = self.within(density.lattice.size());
        // False for NaN.
        let is_seen = near < far && near < FARTHEST && self.from.is_finite();
        if !is_seen {
            return 0.0;
        }
        let mut sum = 0.0;
        let mut i = (near / step - part).ceil().max(0.0) as i32;
        loop {
            let t = (i as f32 + part) * step;
            let goes_on = t < far;
            if !goes_on {
                return sum * (step / DEPTH_ONE);
            }
            let q = self.from + self.along * t - 0.5;
            i += match density.at(q) {
                Around::Nothing => 1,
                Around::Empty(corner) => steps_out(q - corner, self.along, step),
                Around::Hair(depth) => {
                    sum += depth;
                    1
                }
            };
        }
    }
}

/// The steps from a place within a brick to the first one that is not. Density is 0 at the border of a brick without hair, so that
/// rounding there does not matter.
#[inline]
fn steps_out(within: Vec3, along: Vec3, step: f32) -> i32 {
    let mut out = f32::INFINITY;
    for axis in 0..3 {
        let side = if along[axis] > 0.0 { BRICK as f32 } else { 0.0 };
        let at = (side - within[axis]) / along[axis];
        // NaN where the ray runs along the side.
        out = if at < out { at } else { out };
    }
    ((out / step).ceil() as i32).clamp(1, 64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::voxel_march::Lattice;
    use crate::methods::voxel_march::grid::{BRICK_WORDS, brick_at, places};
    use glam::UVec3;

    /// A window whose cells with `is_hair` have an optical depth of 1/16.
    fn filled(is_hair: impl Fn(UVec3) -> bool) -> (Lattice, Vec<u32>, Vec<u32>) {
        let bounds = crate::Bounds { min: Vec3::ZERO, max: Vec3::ONE, ignored: 0 };
        let lattice = Lattice::new(Vec3::ZERO, 32, &bounds);
        let (mut index, mut cells) = (vec![0_u32; lattice.count()], Vec::new());
        let size = lattice.bricks * BRICK as u32;
        for cell in (0..size.element_product())
            .map(|i| UVec3::new(i % size.x, i / size.x % size.y, i / (size.x * size.y)))
        {
            if is_hair(cell) {
                for (brick, at) in places(&lattice, cell) {
                    if index[brick as usize] == 0 {
                        index[brick as usize] = (cells.len() / BRICK_WORDS) as u32 + 1;
                        cells.resize(cells.len() + BRICK_WORDS, 0);
                    }
                    cells[(index[brick as usize] - 1) as usize * BRICK_WORDS + at as usize] = 1 << 16;
                }
            }
        }
        (lattice, index, cells)
    }

    fn depth((lattice, index, cells): &(Lattice, Vec<u32>, Vec<u32>), way: Way, step: f32) -> f32 {
        way.depth(&Density { lattice, index, cells }, step, 0.5)
    }

    #[test]
    fn a_slab_and_two_with_a_gap_have_the_depth_of_their_cells() {
        // Eight cells of 1/16 are 1/2, from x = 10 to x = 18; a second slab of four from 24 on.
        for (two, all) in [(false, 0.5), (true, 0.75)] {
            let made = filled(|c| (10..18).contains(&c.x) || two && (24..28).contains(&c.x));
            for step in [0.25, 0.5, 1.0] {
                for (x, before) in [(3.0, 0.0), (14.0, 0.25), (21.0, 0.5), (31.0, all)] {
                    let way =
                        Way { from: Vec3::new(x, 16.2, 15.7), along: Vec3::NEG_X, length: f32::INFINITY };
                    let found = depth(&made, way, step);
                    assert!((found - before).abs() < 1e-5, "{two}, {step}, {x}: {found}");
                    // A light that stands 5 cells away sees the hair between.
                    let found = depth(&made, Way { length: 5.0, ..way }, step);
                    let near = (0..5).filter(|c| {
                        let at = x - 0.5 - *c as f32;
                        (10.0..18.0).contains(&at) || two && (24.0..28.0).contains(&at)
                    });
                    assert!((found - near.count() as f32 / 16.0).abs() < 0.04, "{two}, {step}, {x}: {found}");
                }
            }
            // Slanted by 60 degrees, the way through the slab is twice as long.
            let along = Vec3::new(-0.5, 0.75_f32.sqrt(), 0.0);
            let from = Vec3::new(22.0, 1.0, 15.0);
            let found = depth(&made, Way { from, along, length: f32::INFINITY }, 0.25);
            assert!((found - 1.0).abs() < 0.01, "{found}");
        }
    }

    #[test]
    fn a_card_between_bricks_is_seen_from_all_sides_and_empty_space_is_skipped_without_loss() {
        for at in [8, 15, 16, 17, 24] {
            let made = filled(|c| c.y == at);
            for from in
                [Vec3::new(15.3, 35.0, 17.9), Vec3::new(20.0, 30.0, 1.3), Vec3::new(12.0, 400.0, 20.0)]
            {
                let way = Way { from, along: Vec3::NEG_Y, length: f32::INFINITY };
                let found = depth(&made, way, 1.0);
                assert!((found - 1.0 / 16.0).abs() < 1e-5, "{at} from {from}: {found}");
                let up = Way { from: from.with_y(-3.5), along: Vec3::Y, length: f32::INFINITY };
                assert!((depth(&made, up, 0.5) - 1.0 / 16.0).abs() < 1e-5, "{at} from below {from}");
                assert_eq!(depth(&made, Way { along: Vec3::Y, ..way }, 1.0), 0.0, "behind it nothing");
            }
        }
        let made = filled(|_| true);
        for broken in [Vec3::NAN, Vec3::splat(f32::INFINITY), Vec3::splat(1e9), Vec3::splat(f32::MAX)] {
            let way = Way { from: broken, along: Vec3::NEG_Y, length: f32::INFINITY };
            assert_eq!(depth(&made, way, 1.0), 0.0, "{broken}");
        }
        assert_eq!(made.1[brick_at(made.0.bricks, UVec3::ZERO) as usize], 1);
    }
}
