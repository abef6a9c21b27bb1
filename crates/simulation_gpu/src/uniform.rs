//! The constants of a step, as the shaders declare them in `step.wgsl`.

use bytemuck::{Pod, Zeroable};
use lovelock_simulation::Integrator;
use lovelock_simulation::device::{DeviceStep, FrameOffsets};

/// Twin of `Step` in `step.wgsl`, where its fields are explained.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct StepUniform {
    rebase: [f32; 3],
    blocks: u32,
    grid_low: [f32; 3],
    points: u32,
    distances_low: [f32; 3],
    first_free: u32,
    nodes_low: [f32; 3],
    colliders: u32,
    cells_low: [f32; 3],
    substeps: u32,
    distances_size: [u32; 3],
    integrator: u32,
    nodes_size: [u32; 3],
    sweeps: u32,
    cells_size: [u32; 3],
    stride: u32,
    counts_nearest: u32,
    has_field: u32,
    windy: u32,
    maps: u32,
    rows: u32,
    shapes: u32,
    wind: u32,
    solids: u32,
    solid_count: u32,
    lines: u32,
    line_count: u32,
    line_points: u32,
    h: f32,
    gravity: f32,
    support: f32,
    settle: f32,
    settle_rate: f32,
    cohesion: f32,
    air_shelter: f32,
    opening: f32,
    margin: f32,
    layering: f32,
    skin_friction: f32,
    cloth_friction: f32,
    reach: f32,
    strength: f32,
    inv_threshold: f32,
    anisotropy: f32,
    cell: f32,
    units: f32,
    full_mass: f32,
    follow_damping: f32,
    bend_gamma: f32,
    hold_reach: f32,
    lift: f32,
    step_secs: f32,
    spacing: f32,
    node_spacing: f32,
    cell_side: f32,
    samples: u32,
}

/// Twin of `Substep` in `step.wgsl`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SubstepUniform {
    pub(crate) index: u32,
    pub(crate) checks_factor: u32,
    pub(crate) is_last: u32,
    pub(crate) passed: f32,
}

/// The number of samples of the density grid along a guide of `points` points.
pub(crate) fn samples(points: usize, stride: usize) -> usize {
    (points - 1).div_ceil(stride.max(1)) + 1
}

impl StepUniform {
    pub(crate) fn new(step: &DeviceStep, at: &FrameOffsets) -> Self {
        let settings = step.settings();
        let (low, cell, stride, units) = step.lattice();
        let mut out = Self {
            rebase: step.rebase().to_array(),
            blocks: step.blocks() as u32,
            grid_low: low.to_array(),
            points: step.points() as u32,
            first_free: step.first_free() as u32,
            colliders: step.colliders() as u32,
            substeps: step.substeps() as u32,
            integrator: match step.integrator() {
                Integrator::Direct => 0,
                Integrator::Relaxation => 1,
                Integrator::FollowTheLeader => 2,
            },
            sweeps: settings.relaxation_sweeps,
            stride: stride as u32,
            counts_nearest: u32::from(step.counts_nearest()),
            windy: u32::from(at.windy),
            rows: at.rows,
            shapes: at.shapes,
            wind: at.wind,
            solids: at.solids,
            solid_count: at.solid_count,
            lines: at.lines,
            line_count: at.line_count,
            line_points: at.line_points,
            h: step.substep_secs(),
            gravity: settings.gravity,
            support: settings.style_support * settings.gravity,
            settle: step.settle(),
            settle_rate: settings.settle,
            cohesion: step.cohesion(),
            air_shelter: settings.air_shelter,
            opening: settings.locks.opening,
            margin: settings.skin_margin,
            layering: settings.layering,
            skin_friction: settings.friction,
            cloth_friction: settings.cloth_friction,
            reach: step.reach(),
            strength: settings.repulsion.strength,
            inv_threshold: 1.0 / settings.repulsion.threshold,
            anisotropy: settings.repulsion.anisotropy,
            cell,
            units,
            full_mass: step.full_mass(),
            follow_damping: settings.follow_damping,
            bend_gamma: step.bend_gamma(),
            hold_reach: settings.hold_reach,
            samples: samples(step.points(), stride) as u32,
            ..Self::default()
        };
        if let Some(field) = step.field() {
            let lattices = field.lattices();
            out.has_field = 1;
            (out.lift, out.step_secs, out.maps) = (lattices.lift, lattices.step_secs, lattices.maps as u32);
            let (low, spacing, size) = lattices.distances;
            (out.distances_low, out.spacing, out.distances_size) = (low.to_array(), spacing, size.to_array());
            let (low, spacing, size) = lattices.nodes;
            (out.nodes_low, out.node_spacing, out.nodes_size) = (low.to_array(), spacing, size.to_array());
            let (low, side, size) = lattices.cells;
            (out.cells_low, out.cell_side, out.cells_size) = (low.to_array(), side, size.to_array());
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use lovelock_gpu::layout_in_shader;

    use super::*;

    macro_rules! offsets {
        ($of:ty, $($field:ident),*) => {
            vec![$(offset_of!($of, $field)),*, size_of::<$of>()]
        };
    }

    #[test]
    fn the_constants_lie_where_the_shaders_read_them() {
        let step = offsets!(
            StepUniform,
            rebase,
            blocks,
            grid_low,
            points,
            distances_low,
            first_free,
            nodes_low,
            colliders,
            cells_low,
            substeps,
            distances_size,
            integrator,
            nodes_size,
            sweeps,
            cells_size,
            stride,
            counts_nearest,
            has_field,
            windy,
            maps,
            rows,
            shapes,
            wind,
            solids,
            solid_count,
            lines,
            line_count,
            line_points,
            h,
            gravity,
            support,
            settle,
            settle_rate,
            cohesion,
            air_shelter,
            opening,
            margin,
            layering,
            skin_friction,
            cloth_friction,
            reach,
            strength,
            inv_threshold,
            anisotropy,
            cell,
            units,
            full_mass,
            follow_damping,
            bend_gamma,
            hold_reach,
            lift,
            step_secs,
            spacing,
            node_spacing,
            cell_side,
            samples
        );
        let substep = offsets!(SubstepUniform, index, checks_factor, is_last, passed);
        for (name, source) in crate::shaders().into_iter().filter(|(name, _)| *name != "publish") {
            assert_eq!(layout_in_shader(&source, "Step"), step, "{name}");
            assert_eq!(layout_in_shader(&source, "Substep"), substep, "{name}");
        }
        // Control: another order of fields is another layout.
        let swapped = offsets!(SubstepUniform, checks_factor, index, is_last, passed);
        assert_ne!(substep, swapped);
    }
}
