//! The placement of cells and bricks in the world.

use glam::{IVec3, UVec3, Vec3};

use crate::bounds::{Bounds, SMALLEST_CELL, round_up_to_step};
use crate::{LightFrame, ShadowInput};

/// Cells along the edge of a brick.
pub(super) const BRICK: i32 = 8;

/// Cells on an infinite lattice along the axes of the world, one corner of which is the anchor, and the window of bricks that hair needs.
///
/// The size of a cell is rounded up to a sixteenth of an octave, so that it stays the same from frame to frame. The window decides only
/// what is stored: it does not move cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lattice {
    /// The fixed corner, world space.
    pub anchor: Vec3,
    /// Edge of a cell, metres.
    pub cell_size: f32,
    /// The first brick of the window, in bricks from the anchor.
    pub first: IVec3,
    /// Bricks of the window along each axis.
    pub bricks: UVec3,
}

/// The extent of hair along the axes of the world.
pub(super) fn extent(input: &ShadowInput) -> Bounds {
    ShadowInput { light: LightFrame::WORLD, ..*input }.bounds()
}

impl Lattice {
    /// The lattice with `resolution` cells along the longest edge of `extent`, along the axes of the world around the anchor.
    pub fn new(anchor: Vec3, resolution: u32, extent: &Bounds) -> Self {
        let is_some = extent.min.x <= extent.max.x;
        let (min, max) = if is_some { (extent.min, extent.max) } else { (Vec3::ZERO, Vec3::ZERO) };
        let wanted = (max - min).max_element() / resolution.max(1) as f32;
        // Lattice coordinates stay below 2^16, where f32 still resolves a hundredth of a cell.
        let farthest = min.abs().max(max.abs()).max_element();
        let cell_size = round_up_to_step(wanted.max(SMALLEST_CELL).max(farthest / 65_536.0));
        let cell = |p: Vec3| (p / cell_size).floor().as_ivec3();
        // Density is read up to a cell beside the hair, and rounding may move hair by one.
        let first = (cell(min) - 2).div_euclid(IVec3::splat(BRICK));
        let last = (cell(max) + 2).div_euclid(IVec3::splat(BRICK));
        Self { anchor, cell_size, first, bricks: (last - first + 1).as_uvec3() }
    }

    /// Coordinates in the window, in cells.
    #[inline]
    pub fn window_from_world(&self, p: Vec3) -> Vec3 {
        (p - self.anchor) * (1.0 / self.cell_size) - self.start()
    }

    /// The corner of the window, in cells from the anchor.
    pub fn start(&self) -> Vec3 {
        (self.first * BRICK).as_vec3()
    }

    /// Bricks of the window.
    pub fn count(&self) -> usize {
        self.bricks.element_product() as usize
    }

    /// The extent of the window, cells.
    #[inline]
    pub fn size(&self) -> Vec3 {
        (self.bricks * BRICK as u32).as_vec3()
    }

    /// Whether hair at a place of the window, in cells, casts a shadow: false for what is not finite or too far away.
    #[inline]
    pub fn holds(&self, p: Vec3) -> bool {
        p.cmpge(Vec3::ONE).all() && p.cmple(self.size() - 1.0).all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_holds_the_hair_with_a_cell_around_it_and_cells_follow_the_anchor_only() {
        for (min, max) in [
            (Vec3::splat(-0.2), Vec3::splat(0.2)),
            (Vec3::new(0.3, -4.0, 1.0), Vec3::new(0.5, -3.0, 1.01)),
            (Vec3::splat(-9000.0), Vec3::splat(9000.0)),
            (Vec3::ZERO, Vec3::ZERO),
        ] {
            let anchor = Vec3::new(0.5, 1.6, -0.25);
            for resolution in [16, 128, 512] {
                let lattice = Lattice::new(anchor, resolution, &Bounds { min, max, ignored: 0 });
                for corner in [min, max, min.with_x(max.x), max.with_z(min.z)] {
                    assert!(lattice.holds(lattice.window_from_world(anchor + corner)), "{min} {resolution}");
                }
                assert!(lattice.bricks.max_element() <= resolution / 8 + 3, "{lattice:?}");
                // A smaller extent with the same cells has the same borders of cells.
                let less = Bounds { min: min + 0.02 * (max - min), max, ignored: 0 };
                let other = Lattice::new(anchor, resolution, &less);
                if other.cell_size == lattice.cell_size {
                    let p = anchor + 0.3 * min + 0.7 * max;
                    let apart = lattice.window_from_world(p) - other.window_from_world(p);
                    assert!((apart - apart.round()).abs().max_element() < 1e-3, "whole cells apart: {apart}");
                }
            }
        }
        let nothing = Lattice::new(Vec3::ZERO, 128, &Bounds::EMPTY);
        assert!(nothing.count() <= 8 && nothing.cell_size > 0.0);
        assert!(!nothing.holds(Vec3::NAN) && !nothing.holds(Vec3::splat(1e30)));
    }
}
