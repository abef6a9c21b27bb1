//! Project files of versions 1 and 2, whose hair moved by other defaults.

use super::Project;

/// Drag and settling of every style then, 1/s.
const OLD_DRAG: f32 = 0.8;
const OLD_SETTLE: f32 = 2.0;

/// Replaces drag and settling that had their old defaults by those of the project's style. Values that the user chose are kept.
/// Otherwise the old defaults would count as chosen, and the simulation would no longer follow the style.
pub(super) fn migrate(project: &mut Project) {
    // One coefficient was that of skin and clothes.
    project.simulation.cloth_friction = project.simulation.friction;
    let style = project.hair.simulation();
    if project.simulation.drag == OLD_DRAG {
        project.simulation.drag = style.drag;
    }
    if project.simulation.settle == OLD_SETTLE {
        project.simulation.settle = style.settle;
    }
}
