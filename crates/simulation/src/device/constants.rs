//! The constants of the definition by name, so that a device computes with the same numbers.

use glam::IVec3;

use crate::{block, colliders, grid, rates, rope, solver, wake};

/// The constants of the simulator by name.
pub fn constants() -> Vec<(&'static str, f64)> {
    let lists: [&[(&str, f64)]; 10] = [
        &solver::FORCE_CONSTANTS,
        &solver::SUBSTEP_CONSTANTS,
        &solver::LOCK_CONSTANTS,
        &rates::CONSTANTS,
        &rope::CONSTANTS,
        &wake::CONSTANTS,
        &block::CONSTANTS,
        &colliders::CONSTANTS,
        &colliders::field::CONSTANTS,
        &grid::CONSTANTS,
    ];
    lists.concat()
}

/// Cells of the density grid along each axis.
pub fn grid_size() -> IVec3 {
    grid::SIDES
}
