//! The grid and the march on the CPU: the definition of the method.

use std::sync::atomic::AtomicU32;

use glam::Vec3;
use lovelock_base::settings::Settings;
use rayon::prelude::*;

use super::bricks::{bricks_of, depth_per_cell, fill};
use super::grid::{Around, BRICK_WORDS, DEPTH_ONE, Density};
use super::lattice::{BRICK, Lattice, extent};
use super::march::Way;
use super::{STEP, VoxelMarchSettings};
use crate::exp::exp_of_minus;
use crate::methods::texels::place_hash;
use crate::world::{ColumnViews, ToLight, column_map};
use crate::{
    ColumnMap, CpuShadow, RayMark, RayStructure, ShadowError, ShadowInput, ShadowMethod, ShadowReport,
    ShadowSettings,
};

/// Points per parallel task of a lookup.
const POINTS_PER_LOOKUP: usize = 256;
/// The most texels along the edge of the transmittance behind all hair, each of which marches.
pub(super) const MOST_COLUMNS: u32 = 256;

/// The grid of [`ShadowMethod::VoxelMarch`]; everything is lit until it is built.
///
/// Each light has a copy of the same grid, because maps do not know of each other. On the GPU lights share it.
#[derive(Debug, Default)]
pub struct VoxelMarch {
    built: Option<Built>,
    cells: Vec<u32>,
}

#[derive(Debug)]
struct Built {
    settings: VoxelMarchSettings,
    lattice: Lattice,
    to_light: ToLight,
    index: Vec<u32>,
    columns: ColumnViews,
    report: ShadowReport,
}

/// Bytes of an index and of bricks.
pub(super) fn bytes(bricks_of_window: u64, bricks: u64) -> u64 {
    4 * bricks_of_window + 4 * BRICK_WORDS as u64 * bricks
}

impl VoxelMarch {
    /// Where the cells of the last build lie; `None` before the first.
    pub fn lattice(&self) -> Option<&Lattice> {
        self.built.as_ref().map(|built| &built.lattice)
    }

    fn build_into(&mut self, input: &ShadowInput, settings: &ShadowSettings) -> Result<Built, ShadowError> {
        let settings = settings.voxel_march.clamped();
        let extent = extent(input);
        let lattice = Lattice::new(input.anchor, settings.resolution, &extent);
        let each = depth_per_cell(input.extinction_scale, input.strand_width, lattice.cell_size);
        let (index, count) = bricks_of(input, &lattice, each);
        let needed_bytes = bytes(index.len() as u64, count as u64);
        let limit_bytes = input.share_of(settings.memory_limit_bytes);
        if needed_bytes > limit_bytes {
            let (method, maps) = (ShadowMethod::VoxelMarch, input.maps.max(1));
            return Err(ShadowError::TooLarge { method, needed_bytes, limit_bytes, maps });
        }
        let mut cells: Vec<AtomicU32> = Vec::new();
        let samples = fill(input, &lattice, each, (&index, count), &mut cells);
        self.cells = cells.into_iter().map(AtomicU32::into_inner).collect();
        let report = ShadowReport {
            memory_bytes: 4 * (index.capacity() + self.cells.capacity()) as u64,
            cells_touched: (count * (BRICK * BRICK * BRICK) as usize) as u64,
            cells_total: u64::from(settings.resolution).pow(3),
            cell_size: lattice.cell_size,
            samples,
            points_ignored: extent.ignored,
            needed_bytes,
            ..ShadowReport::default()
        };
        let columns = columns_of(input, &settings, &lattice);
        Ok(Built { settings, lattice, to_light: ToLight::of(&input.light), index, columns, report })
    }

    fn density<'a>(&'a self, built: &'a Built) -> Density<'a> {
        Density { lattice: &built.lattice, index: &built.index, cells: &self.cells }
    }

    fn light_at(&self, built: &Built, p: Vec3) -> f32 {
        let Some((along, distance)) = built.to_light.from(p) else { return 1.0 };
        let way = Way {
            from: built.lattice.window_from_world(p),
            along,
            length: distance * (1.0 / built.lattice.cell_size),
        };
        let part = if built.settings.jitter { place_hash(p.to_array())[0] } else { 0.5 };
        exp_of_minus(way.depth(&self.density(built), built.settings.step, part))
    }
}

fn columns_of(input: &ShadowInput, settings: &VoxelMarchSettings, lattice: &Lattice) -> ColumnViews {
    let size = (settings.resolution.min(MOST_COLUMNS), 2.0 * lattice.cell_size);
    ColumnViews::new(&input.light, input.anchor, size, &input.bounds())
}

impl CpuShadow for VoxelMarch {
    fn build(&mut self, input: &ShadowInput, settings: &ShadowSettings) -> Result<(), ShadowError> {
        self.built = None;
        self.cells = Vec::new();
        self.built = Some(self.build_into(input, settings)?);
        Ok(())
    }

    fn transmittance(&self, p: Vec3) -> f32 {
        self.built.as_ref().map_or(1.0, |built| self.light_at(built, p))
    }

    fn transmittance_at(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        assert!(x.len() == out.len() && y.len() == out.len() && z.len() == out.len(), "slices of one length");
        let Some(built) = &self.built else {
            out.fill(1.0);
            return;
        };
        let points = x.par_iter().zip(y).zip(z).zip(out).with_min_len(POINTS_PER_LOOKUP);
        points.for_each(|(((x, y), z), out)| *out = self.light_at(built, Vec3::new(*x, *y, *z)));
    }

    fn report(&self) -> ShadowReport {
        self.built.as_ref().map_or_else(ShadowReport::default, |built| built.report)
    }

    fn column_map(&self) -> Option<ColumnMap> {
        self.column_maps().into_iter().next()
    }

    fn column_maps(&self) -> Vec<ColumnMap> {
        let Some(built) = &self.built else { return Vec::new() };
        let map = |view| column_map(view, |p| self.light_at(built, p));
        built.columns.0.iter().flatten().map(map).collect()
    }

    fn along_ray(&self, p: Vec3) -> RayStructure {
        let Some((built, (toward, to_lamp))) =
            self.built.as_ref().and_then(|built| Some((built, built.to_light.from(p)?)))
        else {
            return RayStructure::default();
        };
        let (cell, step) = (built.lattice.cell_size, built.settings.step);
        let from = built.lattice.window_from_world(p);
        let density = self.density(built);
        let reach = |along: Vec3, length: f32| {
            let [near, far] = Way { from, along, length }.within(built.lattice.size());
            // False for NaN, and where the ray misses the window.
            if near < far && near < 1e6 { (far / step).ceil() as i32 } else { 0 }
        };
        let (before, behind) = (reach(toward, to_lamp / cell), reach(-toward, f32::INFINITY));
        let mut marks = Vec::new();
        let mut sum = 0.0;
        // From the light on: the steps of a point at the end of one of them.
        for i in -before..behind {
            let q = from - toward * ((i as f32 + 0.5) * step) - 0.5;
            let Around::Hair(depth) = density.at(q) else { continue };
            let optical_depth = depth * (step / DEPTH_ONE);
            if optical_depth > 0.0 {
                sum += optical_depth;
                let [start, end] = [i, i + 1].map(|at| at as f32 * step * cell);
                let transmittance = exp_of_minus(sum);
                marks.push(RayMark { kind: STEP, start, end, optical_depth, transmittance });
            }
        }
        RayStructure { marks }
    }
}
