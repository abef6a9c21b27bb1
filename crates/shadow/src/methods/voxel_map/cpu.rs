//! The quick voxel map: the stages of a build, and lookups in parallel.

use glam::{Mat4, Vec3, Vec4};
use lovelock_groom::Strands;
use rayon::prelude::*;

use super::deposit::Deposit;
use super::grid::{DEPTH_ONE, Grid, Span};
use super::lattice::{Bounds, Lattice};
use super::layout::{Layout, TILE_EDGE};
use super::lookup::{Lookup, behind_all};
use super::simd::{self, Width};
use super::{VoxelDeposit, VoxelFilter, VoxelMapSettings, sum};
use crate::{ColumnMap, CpuShadow, ShadowInput, ShadowReport, ShadowSettings};

/// Points that are worth a worker of their own.
const POINTS_PER_WORKER: usize = 4096;
/// Most private grids: beyond, merging them costs more than it saves.
const MOST_GRIDS: usize = 8;
/// Most cells of all private grids together, which bounds their address space to 1 GiB.
const MOST_CELLS: usize = 1 << 28;
/// Points of one parallel piece of a lookup.
const POINTS_PER_LOOKUP: usize = 4096;

/// A voxel map; everything is lit until it is built.
///
/// Every worker adds its strands to a grid of its own. Sums of integers make the map the same for any number
/// of them.
#[derive(Clone, Debug, Default)]
pub struct VoxelMap {
    built: Option<Built>,
}

#[derive(Clone, Debug)]
struct Built {
    layout: Layout,
    lattice: Lattice,
    filter: VoxelFilter,
    width: Width,
    /// The first one holds the map once it is built.
    grids: Vec<Grid>,
    /// Slices with hair in them, a tile.
    touched: Vec<Span>,
    /// Slices that are summed, a tile.
    filled: Vec<Span>,
    report: ShadowReport,
}

impl VoxelMap {
    /// Where the cells of the last build lie; `None` before the first.
    pub fn lattice(&self) -> Option<&Lattice> {
        self.built.as_ref().map(|built| &built.lattice)
    }

    fn build_with(&mut self, input: &ShadowInput, settings: &ShadowSettings, width: Width) {
        let bounds = bounds(input);
        let lattice = Lattice::new(input, &settings.voxel_map, &bounds);
        let layout = Layout::new(lattice.resolution);
        let grids = grid_count(&layout, input.strands.points());
        let built = match self.built.take() {
            Some(built) if built.layout == layout => self.built.insert(built),
            // The old one is freed before the new one is made.
            _ => self.built.insert(Built {
                layout,
                lattice,
                filter: settings.voxel_map.filter,
                width,
                grids: Vec::new(),
                touched: Vec::new(),
                filled: Vec::new(),
                report: ShadowReport::default(),
            }),
        };
        built.lattice = lattice;
        built.filter = settings.voxel_map.filter;
        built.width = width;
        built.grids.truncate(grids);
        built.grids.resize_with(grids, || Grid::new(&layout));
        let samples = built.deposit(input, settings);
        sum::touched_spans(&layout, &built.grids, &mut built.touched);
        sum::dilate(&layout, &built.touched, &mut built.filled);
        sum::sum_along_light(&layout, &mut built.grids, &built.filled);
        built.report = ShadowReport {
            memory_bytes: built.memory_bytes(),
            cells_touched: built.filled.iter().map(|span| span.cells().len() as u64).sum(),
            cells_total: u64::from(layout.resolution).pow(3),
            cell_size: lattice.cell_size,
            samples,
            points_ignored: bounds.ignored,
        };
    }
}

impl Built {
    /// Empties the grids and adds the strands to them; says how many samples that were.
    fn deposit(&mut self, input: &ShadowInput, settings: &ShadowSettings) -> u64 {
        let (layout, width, filled) = (self.layout, self.width, &self.filled);
        let deposit = Deposit {
            layout,
            lattice: self.lattice,
            depth: fixed_point_depth(input, settings, &self.lattice),
            by_point: settings.voxel_map.deposit == VoxelDeposit::PointCount,
        };
        let (strands, pieces) = (input.strands, self.grids.len());
        self.grids
            .par_iter_mut()
            .enumerate()
            .with_max_len(1)
            .map(|(piece, grid)| {
                // The first grid holds the last map, the others what their workers put there.
                if piece == 0 {
                    grid.clear_spans(&layout, filled);
                } else {
                    grid.clear(&layout);
                }
                let (first, last) = (
                    first_strand(strands, piece, pieces),
                    first_strand(strands, piece + 1, pieces),
                );
                simd::deposit(width, &deposit, strands, first, last, grid)
            })
            .sum()
    }

    fn lookup(&self) -> Option<Lookup<'_>> {
        Some(Lookup {
            layout: self.layout,
            lattice: &self.lattice,
            cells: &self.grids.first()?.cells,
            touched: &self.touched,
            filled: &self.filled,
            as_printed: self.filter == VoxelFilter::Paper,
        })
    }

    fn memory_bytes(&self) -> u64 {
        let grids: usize = self
            .grids
            .iter()
            .map(|grid| grid.cells.len() * 4 + grid.touched.len())
            .sum();
        (grids + (self.touched.len() + self.filled.len()) * size_of::<Span>()) as u64
    }
}

/// Bounds of all points, in parallel.
fn bounds(input: &ShadowInput) -> Bounds {
    let points = input.strands.points();
    let piece = 16_384;
    (0..points.div_ceil(piece))
        .into_par_iter()
        .map(|at| {
            let first = at * piece;
            Bounds::of(
                input.strands,
                first,
                piece.min(points - first),
                &input.light,
                input.anchor,
            )
        })
        .reduce(|| Bounds::EMPTY, Bounds::join)
}

/// What a segment one cell long across the light, or a point, adds to its cell, in fixed point.
fn fixed_point_depth(input: &ShadowInput, settings: &ShadowSettings, lattice: &Lattice) -> f32 {
    let VoxelMapSettings {
        deposit,
        point_extinction,
        ..
    } = settings.voxel_map;
    let scale = settings.safe_extinction_scale();
    let depth = match deposit {
        // τ = s_ext w ℓ sinθ / ds², with ℓ sinθ in units of ds.
        VoxelDeposit::Length => scale * input.strand_width / lattice.cell_size,
        // τ = f ds.
        VoxelDeposit::PointCount => scale * point_extinction * lattice.cell_size,
    };
    if depth > 0.0 {
        (depth * DEPTH_ONE).min(1e30)
    } else {
        0.0
    }
}

/// How many private grids to use here and now.
fn grid_count(layout: &Layout, points: usize) -> usize {
    let useful = rayon::current_num_threads()
        .min(points / POINTS_PER_WORKER)
        .min(MOST_GRIDS);
    useful.min(MOST_CELLS / layout.cells()).max(1)
}

/// The strand at which piece `piece` of `pieces` begins: pieces have about equally many points.
fn first_strand(strands: &Strands, piece: usize, pieces: usize) -> usize {
    if piece == pieces {
        return strands.count();
    }
    let point = (strands.points() * piece / pieces) as u32;
    strands
        .first_point
        .partition_point(|first| *first < point)
        .min(strands.count())
}

impl CpuShadow for VoxelMap {
    fn build(&mut self, input: &ShadowInput, settings: &ShadowSettings) {
        self.build_with(input, settings, Width::widest());
    }

    fn transmittance(&self, p: Vec3) -> f32 {
        self.built
            .as_ref()
            .and_then(Built::lookup)
            .map_or(1.0, |lookup| lookup.one(p))
    }

    fn transmittance_at(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        assert!(
            x.len() == out.len() && y.len() == out.len() && z.len() == out.len(),
            "slices of one length"
        );
        let Some((lookup, width)) = self
            .built
            .as_ref()
            .and_then(|built| Some((built.lookup()?, built.width)))
        else {
            out.fill(1.0);
            return;
        };
        let piece = POINTS_PER_LOOKUP;
        let points = x
            .par_chunks(piece)
            .zip(y.par_chunks(piece))
            .zip(z.par_chunks(piece));
        points
            .zip(out.par_chunks_mut(piece))
            .for_each(|(((x, y), z), out)| simd::lookup(width, &lookup, x, y, z, out));
    }

    fn report(&self) -> ShadowReport {
        self.built
            .as_ref()
            .map_or_else(ShadowReport::default, |built| built.report)
    }

    fn column_map(&self) -> Option<ColumnMap> {
        let built = self.built.as_ref()?;
        let (layout, lattice) = (&built.layout, &built.lattice);
        let cells = &built.grids.first()?.cells;
        let n = layout.resolution;
        let mut transmittance = vec![1.0; (n * n) as usize];
        for (j, row) in transmittance.chunks_exact_mut(n as usize).enumerate() {
            for (k, out) in row.iter_mut().enumerate() {
                let (j, k) = (j as u32, k as u32);
                let last =
                    built.filled[((j / TILE_EDGE) * layout.tiles_per_edge + k / TILE_EDGE) as usize].last;
                if last >= 0 {
                    *out = behind_all(cells[layout.address(last as u32, j, k) as usize]);
                }
            }
        }
        // Rows of the map run along the second axis across the light.
        let n = n as f32;
        let first = lattice.first.as_vec3();
        let row = |axis: usize| {
            let per_map = lattice.axes_per_cell[axis] / n;
            per_map.extend(-per_map.dot(lattice.anchor) - first[axis] / n)
        };
        let uv_from_world = Mat4::from_cols(row(2), row(1), row(0), Vec4::W).transpose();
        Some(ColumnMap {
            size: layout.resolution,
            transmittance,
            uv_from_world,
        })
    }
}
