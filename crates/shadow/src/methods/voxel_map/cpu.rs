//! The voxel map on the CPU: the stages of a build, and parallel lookups.

use glam::Vec3;
use lovelock_base::simd::Width;
use lovelock_groom::Strands;
use rayon::prelude::*;

use super::deposit::{Deposit, deposit_simd};
use super::free_grids::FreeGrids;
use super::grid::{DEPTH_ONE, Grid};
use super::lattice::Lattice;
use super::layout::Layout;
use super::lookup::{Lookup, behind_all, look_up_simd};
use super::projected::deposit_projected;
use super::{CELL, VoxelDeposit, VoxelFilter, VoxelMapSettings, sum};
use crate::bounds::{Bounds, bounds_simd};
use crate::cpu::safe_extinction;
use crate::exp::{DEPTH_STEPS, exp_of_minus_steps};
use crate::{
    ColumnMap, CpuShadow, RayMark, RayStructure, ShadowError, ShadowInput, ShadowReport, ShadowSettings,
};

/// Points per worker: with fewer, another worker does not pay off.
const POINTS_PER_WORKER: usize = 4096;
/// Pieces of strands per grid, so that a worker that becomes free while another map is built can take a part of it.
const PIECES_PER_GRID: usize = 4;
/// The most private grids. Merging more of them costs more than it saves.
const MAX_GRIDS: usize = 8;
/// The most cells of all private grids together, which bounds their address space to 1 GiB.
const MAX_CELLS: usize = 1 << 28;
/// Points per parallel task of the bounds.
const POINTS_PER_BOUNDS: usize = 1 << 14;
/// Points per parallel task of a lookup.
const POINTS_PER_LOOKUP: usize = 4096;

/// A voxel map; everything is lit until it is built.
///
/// Strands are added in pieces, and each piece to any grid that no other worker uses at the time: a map that is built by one worker while
/// others build other maps needs only one. Cells hold integers, so the map is the same for any number of workers and grids.
#[derive(Clone, Debug, Default)]
pub struct VoxelMap {
    built: Option<BuiltMap>,
}

#[derive(Clone, Debug)]
struct BuiltMap {
    layout: Layout,
    lattice: Lattice,
    filter: VoxelFilter,
    width: Width,
    /// The first one holds the map after the build; the last build may have left out others.
    grids: Vec<Grid>,
    /// Bits of the groups of slices that contain hair, per tile.
    touched: Vec<u64>,
    report: ShadowReport,
}

impl VoxelMap {
    /// Where the cells of the last build lie; `None` before the first.
    pub fn lattice(&self) -> Option<&Lattice> {
        self.built.as_ref().map(|built| &built.lattice)
    }

    /// Optical depth, in steps of 1/4096, at the front and the back face of a cell of the last build. The first index runs along
    /// the light. `None` before the first build and outside the window.
    pub fn faces(&self, [i, j, k]: [u32; 3]) -> Option<[u16; 2]> {
        let built = self.built.as_ref()?;
        if [i, j, k].iter().any(|c| *c >= built.layout.resolution) {
            return None;
        }
        let word = built.lookup()?.cell_anywhere(built.layout.address(i, j, k) as usize);
        Some([word as u16, (word >> 16) as u16])
    }

    fn build_with(&mut self, input: &ShadowInput, settings: &ShadowSettings, width: Width) {
        let bounds = input.projected.map_or_else(|| bounds(width, input), |projected| projected.bounds);
        let lattice = Lattice::new(input, &settings.voxel_map, &bounds);
        let layout = Layout::new(lattice.resolution);
        let grids = grid_count(&layout, input.strands.points());
        let built = match self.built.take() {
            Some(built) if built.layout == layout => self.built.insert(built),
            // The old one is freed before the new one is made.
            _ => self.built.insert(BuiltMap {
                layout,
                lattice,
                filter: settings.voxel_map.filter,
                width,
                grids: Vec::new(),
                touched: Vec::new(),
                report: ShadowReport::default(),
            }),
        };
        built.lattice = lattice;
        built.filter = settings.voxel_map.filter;
        built.width = width;
        built.grids.truncate(grids);
        built.grids.resize_with(grids, || Grid::new(&layout));
        let (samples, used) = built.deposit(input, settings);
        let grids = &mut built.grids[..used];
        sum::touched(grids, &mut built.touched);
        sum::sum_along_light(width, &layout, grids, &built.touched);
        built.report = ShadowReport {
            memory_bytes: built.memory_bytes(),
            cells_touched: built.cells_in_use(),
            cells_total: u64::from(layout.resolution).pow(3),
            cell_size: lattice.cell_size,
            samples,
            points_ignored: bounds.ignored,
            scratch_bytes: 0,
            needed_bytes: 0,
            fallbacks: 0,
        };
    }
}

impl BuiltMap {
    /// Clears grids and adds the strands to them. Returns the number of samples, and of the grids that are used: the first ones.
    fn deposit(&mut self, input: &ShadowInput, settings: &ShadowSettings) -> (u64, usize) {
        let (layout, width) = (self.layout, self.width);
        let deposit = Deposit {
            layout,
            lattice: self.lattice,
            depth: fixed_point_depth((input.extinction_scale, input.strand_width), settings, &self.lattice),
            by_point: settings.voxel_map.deposit == VoxelDeposit::PointCount,
            squares: settings.voxel_map.deposit.squares(),
        };
        let strands = input.strands;
        let pieces = piece_count(self.grids.len(), strands.points());
        let free = FreeGrids::new(&mut self.grids);
        let samples = (0..pieces)
            .into_par_iter()
            .with_max_len(1)
            .map(|piece| {
                let mut taken = free.take();
                if std::mem::take(&mut taken.is_new) {
                    taken.grid.clear(&layout);
                }
                let (first, last) =
                    (first_strand(strands, piece, pieces), first_strand(strands, piece + 1, pieces));
                let samples = match &input.projected {
                    None => deposit_simd(width, &deposit, strands, first, last, taken.grid),
                    Some(projected) => {
                        deposit_projected(&deposit, (strands, projected), first..last, taken.grid)
                    }
                };
                free.give_back(taken);
                samples
            })
            .sum();
        let used = free.used();
        self.grids[..used].par_iter_mut().for_each(|grid| grid.take_marks(&layout));
        (samples, used)
    }

    fn lookup(&self) -> Option<Lookup<'_>> {
        let map = self.grids.first()?;
        Some(Lookup {
            layout: self.layout,
            lattice: &self.lattice,
            cells: &map.cells,
            touched: &self.touched,
            filled: &map.used,
            filter: self.filter,
        })
    }

    /// Cells that the last build summed.
    fn cells_in_use(&self) -> u64 {
        let groups: u64 = self
            .grids
            .first()
            .map_or(0, |map| map.used.iter().map(|used| u64::from(used.count_ones())).sum());
        groups << self.layout.group_len_shift()
    }

    fn memory_bytes(&self) -> u64 {
        let grids =
            self.grids.iter().map(|grid| grid.cells.len() * 4 + grid.marks.len() + grid.used.len() * 8);
        (grids.sum::<usize>() + self.touched.len() * 8) as u64
    }
}

/// Bounds of all points, in parallel.
fn bounds(width: Width, input: &ShadowInput) -> Bounds {
    let Strands { x, y, z, .. } = input.strands;
    let pieces = x
        .par_chunks(POINTS_PER_BOUNDS)
        .zip(y.par_chunks(POINTS_PER_BOUNDS))
        .zip(z.par_chunks(POINTS_PER_BOUNDS));
    pieces
        .map(|((x, y), z)| bounds_simd(width, x, y, z, &input.light, input.anchor))
        .reduce(|| Bounds::EMPTY, Bounds::join)
}

/// What a segment one cell long across the light, or a point, adds to its cell, in fixed point.
pub(super) fn fixed_point_depth(
    (extinction_scale, strand_width): (f32, f32),
    settings: &ShadowSettings,
    lattice: &Lattice,
) -> f32 {
    let VoxelMapSettings { deposit, point_extinction, .. } = settings.voxel_map;
    let scale = safe_extinction(extinction_scale);
    let depth = match deposit {
        // τ = s_ext w ℓ sinθ / ds², with ℓ sinθ in units of ds.
        VoxelDeposit::Length | VoxelDeposit::Isotropic => scale * strand_width / lattice.cell_size,
        // τ = f ds.
        VoxelDeposit::PointCount => scale * point_extinction * lattice.cell_size,
    };
    if depth > 0.0 { (depth * DEPTH_ONE).min(1e30) } else { 0.0 }
}

/// The number of private grids for this map in the current thread pool.
fn grid_count(layout: &Layout, points: usize) -> usize {
    let useful = rayon::current_num_threads().min(points / POINTS_PER_WORKER).min(MAX_GRIDS);
    useful.min(MAX_CELLS / layout.cells()).max(1)
}

/// The number of pieces of strands. No more than grids if there are fewer of these than threads, so that every worker finds a free one.
fn piece_count(grids: usize, points: usize) -> usize {
    let most = if grids < rayon::current_num_threads() { grids } else { grids * PIECES_PER_GRID };
    most.min(points / POINTS_PER_WORKER).max(1)
}

/// The first strand of piece `piece` of `pieces`, which have about the same number of points.
fn first_strand(strands: &Strands, piece: usize, pieces: usize) -> usize {
    if piece == pieces {
        return strands.count();
    }
    let point = (strands.points() * piece / pieces) as u32;
    strands.first_point.partition_point(|first| *first < point).min(strands.count())
}

impl CpuShadow for VoxelMap {
    fn build(&mut self, input: &ShadowInput, settings: &ShadowSettings) -> Result<(), ShadowError> {
        self.build_with(input, settings, Width::widest());
        Ok(())
    }

    fn transmittance(&self, p: Vec3) -> f32 {
        self.built.as_ref().and_then(BuiltMap::lookup).map_or(1.0, |lookup| lookup.one(p))
    }

    fn transmittance_at(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        assert!(x.len() == out.len() && y.len() == out.len() && z.len() == out.len(), "slices of one length");
        let Some((lookup, width)) =
            self.built.as_ref().and_then(|built| Some((built.lookup()?, built.width)))
        else {
            out.fill(1.0);
            return;
        };
        let piece = POINTS_PER_LOOKUP;
        let points = x.par_chunks(piece).zip(y.par_chunks(piece)).zip(z.par_chunks(piece));
        points
            .zip(out.par_chunks_mut(piece))
            .for_each(|(((x, y), z), out)| look_up_simd(width, &lookup, x, y, z, out));
    }

    fn report(&self) -> ShadowReport {
        self.built.as_ref().map_or_else(ShadowReport::default, |built| built.report)
    }

    fn column_map(&self) -> Option<ColumnMap> {
        let built = self.built.as_ref()?;
        let layout = &built.layout;
        let lookup = built.lookup()?;
        let n = layout.resolution;
        let mut transmittance = vec![1.0; (n * n) as usize];
        for (j, row) in transmittance.chunks_exact_mut(n as usize).enumerate() {
            for (k, out) in row.iter_mut().enumerate() {
                let last = layout.address(n - 1, j as u32, k as u32) as usize;
                *out = behind_all(lookup.cell_anywhere(last));
            }
        }
        Some(ColumnMap { size: n, transmittance, uv_from_world: built.lattice.uv_from_world() })
    }

    fn along_ray(&self, p: Vec3) -> RayStructure {
        let Some(built) = &self.built else { return RayStructure::default() };
        let at = built.lattice.window_from_world(p);
        let n = built.layout.resolution;
        // False for NaN.
        let within = |c: f32| c >= 0.0 && c < n as f32;
        if !(within(at.y) && within(at.z) && at.x.is_finite()) {
            return RayStructure::default();
        }
        let mark = |i: u32| {
            let [front, back] = self.faces([i, at.y as u32, at.z as u32])?.map(f32::from);
            let [start, end] = [i, i + 1].map(|face| (face as f32 - at.x) * built.lattice.cell_size);
            let (optical_depth, transmittance) = ((back - front) / DEPTH_STEPS, exp_of_minus_steps(back));
            Some(RayMark { kind: CELL, start, end, optical_depth, transmittance })
        };
        let mut marks: Vec<_> = (0..n).filter_map(mark).collect();
        if marks.iter().all(|mark| mark.optical_depth <= 0.0) {
            marks.clear();
        }
        RayStructure { marks }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::LightFrame;

    /// Strands that wind through a box, with a NaN point and a segment across the whole box.
    fn strands() -> Strands {
        strands_of(300)
    }

    fn strands_of(count: u32) -> Strands {
        let mut made = Strands::default();
        let mut first_point = vec![0];
        for strand in 0..count {
            for point in 0..=20_u32 {
                let (s, p) = (strand as f32, point as f32);
                made.x.push(0.1 * (0.7 * s + 0.2 * p).sin());
                made.y.push(1.5 - 0.01 * p + 0.02 * (1.3 * s).cos());
                made.z.push(if strand == 7 && point == 3 {
                    f32::NAN
                } else {
                    0.1 * (1.1 * s + 0.3 * p).cos()
                });
            }
            first_point.push(made.x.len() as u32);
        }
        (made.x[21], made.y[21], made.z[21]) = (0.5, 1.0, 0.5);
        made.first_point = Arc::from(first_point);
        made
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let strands = strands();
        let light = LightFrame::new(Vec3::new(0.2, -1.0, 0.3));
        let input = ShadowInput {
            strands: &strands,
            strand_width: 2e-3,
            extinction_scale: 0.15,
            light,
            anchor: Vec3::Y,
            maps: 1,
            projected: None,
        };
        for filter in [VoxelFilter::Closest, VoxelFilter::Centred, VoxelFilter::Paper] {
            let mut settings = ShadowSettings::default();
            settings.voxel_map.filter = filter;
            let answers = |width: Width| {
                let mut map = VoxelMap::default();
                map.build_with(&input, &settings, width);
                let mut out = vec![f32::NAN; strands.points()];
                map.transmittance_at(&strands.x, &strands.y, &strands.z, &mut out);
                let columns = map.column_map().map(|columns| columns.transmittance);
                (out.iter().map(|t| t.to_bits()).collect::<Vec<_>>(), columns, map.report())
            };
            let baseline = answers(Width::Baseline);
            for &width in Width::ALL.iter().filter(|width| width.is_available()) {
                assert!(answers(width) == baseline, "{width:?}");
            }
        }
    }

    #[test]
    fn a_map_is_the_same_by_any_number_of_threads_also_after_builds_with_other_numbers() {
        // Enough points for several grids.
        let strands = strands_of(2000);
        let input = ShadowInput {
            strands: &strands,
            strand_width: 2e-3,
            extinction_scale: 0.15,
            light: LightFrame::new(Vec3::new(0.2, -1.0, 0.3)),
            anchor: Vec3::Y,
            maps: 1,
            projected: None,
        };
        let settings = ShadowSettings::default();
        let mut one = VoxelMap::default();
        let faces = |map: &VoxelMap| -> Vec<_> {
            (0..128 * 128 * 128)
                .step_by(7)
                .map(|i: u32| map.faces([i & 127, i >> 7 & 127, i >> 14]).expect("inside"))
                .collect()
        };
        let build = |map: &mut VoxelMap, threads: usize, input: &ShadowInput| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| map.build(input, &settings)).expect("a map");
        };
        build(&mut one, 1, &input);
        let wanted = faces(&one);
        assert!(wanted.iter().any(|[front, back]| front != back), "hair is in the map");
        let mut map = VoxelMap::default();
        for threads in [3, 1, 2, 1024, 9, 3] {
            // Other hair before, which must not stay in any grid.
            let other = ShadowInput { extinction_scale: 0.3, ..input };
            build(&mut map, threads, &other);
            assert!(faces(&map) != wanted, "control: {threads}");
            build(&mut map, threads, &input);
            assert!(faces(&map) == wanted, "{threads} threads");
        }
    }

    #[test]
    fn pieces_cover_every_strand_once() {
        let mut strands = strands();
        for (pieces, first_point) in
            [(3, Arc::clone(&strands.first_point)), (2, Arc::from([0_u32, 0, 0])), (4, Arc::from([0_u32]))]
        {
            strands.x.truncate(first_point[first_point.len() - 1] as usize);
            strands.first_point = first_point;
            let starts: Vec<_> = (0..=pieces).map(|piece| first_strand(&strands, piece, pieces)).collect();
            assert_eq!((starts[0], starts[pieces]), (0, strands.count()));
            assert!(starts.is_sorted());
        }
    }
}
