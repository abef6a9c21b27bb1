//! The field as plain numbers, for other devices.

use glam::{UVec3, Vec3};

use super::MovingField;
use super::cells::NONE;
use crate::contents::Stamp;

/// Placement of the lattices of a field, head space.
#[derive(Clone, Copy, Debug)]
pub struct FieldLattices {
    /// The first point of the distances, metres, their spacing, and their number along each axis.
    pub distances: (Vec3, f32, UVec3),
    /// The same of the nodes with the weightings.
    pub nodes: (Vec3, f32, UVec3),
    /// The lowest corner of the cells that hold the body, their side, and their number along each axis.
    pub cells: (Vec3, f32, UVec3),
    /// Outward displacement of the surface, metres.
    pub lift: f32,
    /// Duration of the step, seconds.
    pub step_secs: f32,
    /// Number of maps.
    pub maps: usize,
}

impl MovingField {
    /// The content of [`MovingField::write_rest`].
    pub fn stamp(&self) -> Stamp {
        self.stamp
    }

    /// Where its lattices are.
    pub fn lattices(&self) -> FieldLattices {
        let of = |lattice: &lovelock_motion::FieldLattice| (lattice.low, lattice.spacing, lattice.size);
        let cells = self.occupancy.grid;
        FieldLattices {
            distances: of(self.field.distance_lattice()),
            nodes: of(self.field.node_lattice()),
            cells: (cells.low, cells.cell, cells.size),
            lift: self.lift,
            step_secs: self.dt_secs,
            maps: self.now.len(),
        }
    }

    /// Writes what does not move: the bits of the distances, and for each node its weighting, plus 65,536 if the head alone moves it and
    /// the seven nodes after it.
    pub fn write_rest(&self, out: &mut Vec<u32>) {
        out.clear();
        out.extend(self.field.distances().iter().map(|distance| distance.to_bits()));
        let nodes = self.field.slot_of_node().iter().zip(&self.head_alone);
        out.extend(nodes.map(|(&slot, &alone)| u32::from(slot) | u32::from(alone) << 16));
    }

    /// Writes the bits of the maps to rest at the start and at the end of the step, sixteen numbers each, and for each cell the
    /// weighting of the nearest skin that other joints than the head move, plus 65,536 near skin of the head and 131,072
    /// where it is tested without need.
    pub fn write_step(&self, out: &mut Vec<u32>) {
        out.clear();
        for map in self.before.iter().chain(&self.now) {
            out.extend(map.numbers().map(f32::to_bits));
        }
        let (heads, cells) = (&self.occupancy.head, &self.occupancy.nearest);
        out.extend(heads.iter().zip(cells).enumerate().map(|(n, (&head, &nearest))| {
            let slot = if nearest == NONE { 0 } else { nearest & 0xffff };
            let forced = self.occupancy.is_forced(n);
            slot | u32::from(head | forced) << 16 | u32::from(forced) << 17
        }));
    }
}
