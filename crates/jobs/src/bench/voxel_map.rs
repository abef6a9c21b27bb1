//! `lovelock bench voxel-map`: the voxel map against the published loop, in one run.
//!
//! Every loop fills the density, sums it along the light and looks up the filtered transmittance of every point once. The published
//! loop has its cells as printed, and in the best order. Each is timed on one thread and on all, so that a ratio never compares different
//! numbers of threads. All use the printed density and filter (one per point), and their results are compared before they are timed.
//! The map as the program uses it, which adds the length of segments, is timed too.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_base::clock::Stopwatch;
use lovelock_base::random::SplitMix64;
use lovelock_groom::{GroomSettings, GuideFrame, PlainHead, Preset, Strands, grow, interpolate};
use lovelock_project::error::ProjectError;
use lovelock_render::{ShadowSettings, VoxelDeposit, VoxelFilter};
use lovelock_shadow::voxel_map::VoxelMap;
use lovelock_shadow::voxel_map::published::{CellOrder, PublishedMap};
use lovelock_shadow::{CpuShadow, LightFrame, ShadowInput};
use rayon::ThreadPool;
use serde::Serialize;

/// Copies of the published smooth hairstyle of 103,850 points: about 100 K, 1 M and 10 M points.
const COPIES: [usize; 3] = [1, 10, 96];

/// Cells along each edge.
const RESOLUTIONS: [u32; 2] = [128, 256];

/// The largest difference of transmittance between two loops. The map keeps optical depth in steps of 1/4096 and adds a point in steps of
/// 2⁻²⁰.
const TOLERANCE: f32 = 1e-3;

/// Rounds of all loops: at least the first number, and at most the second within [`SECS`].
const ROUNDS: [u32; 2] = [2, 12];
/// Seconds after which no further round begins.
const SECS: f64 = 2.0;
/// Milliseconds for which a loop repeats within a round; a longer loop runs once.
const ROUND_MS: f64 = 20.0;

/// The paper's *f* for the fewest points and 128³ cells.
const EXTINCTION: f32 = 50.0;

/// The results of all sizes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VoxelMapReport {
    /// A row for each number of points, resolution and number of threads: one, and all if there are several.
    pub rows: Vec<VoxelMapRow>,
}

/// The times of one number of points, one resolution and one number of threads: the fastest of all runs, milliseconds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VoxelMapRow {
    /// Points that are added and looked up.
    pub points: usize,
    /// Cells along each edge.
    pub resolution: u32,
    /// Threads of the map and of the published loop.
    pub threads: usize,
    /// The published loop with the cells as printed, `[i][j][k]`.
    pub as_printed_ms: f64,
    /// The published loop in its best order, `[j][k][i]`.
    pub best_order_ms: f64,
    /// The map.
    pub map_ms: f64,
    /// The map as the program uses it: density by length and the centred filter.
    pub by_length_ms: f64,
    /// The largest difference of transmittance between the loops.
    pub largest_difference: f32,
}

impl VoxelMapRow {
    /// How many times faster the map is than the loop as printed.
    fn times_printed(&self) -> f64 {
        self.as_printed_ms / self.map_ms
    }

    /// How many times faster the map is than the loop in its best order.
    fn times_best(&self) -> f64 {
        self.best_order_ms / self.map_ms
    }

    /// Nanoseconds of the map per point.
    fn ns_per_point(&self) -> f64 {
        1e6 * self.map_ms / self.points as f64
    }
}

impl VoxelMapReport {
    /// How the time on all threads grows from the fewest to the most points, for each resolution: the factor on the points, and that on
    /// the time.
    fn growth(&self) -> Vec<(u32, f64, f64)> {
        let threads = self.rows.iter().map(|row| row.threads).max().unwrap_or(0);
        let rows = || self.rows.iter().filter(move |row| row.threads == threads);
        let of = |resolution| rows().filter(move |row| row.resolution == resolution);
        let mut resolutions: Vec<_> = self.rows.iter().map(|row| row.resolution).collect();
        resolutions.sort_unstable();
        resolutions.dedup();
        let growth = |resolution| {
            let (first, last) = (of(resolution).next()?, of(resolution).next_back()?);
            let points = last.points as f64 / first.points as f64;
            (points > 1.0).then_some((resolution, points, last.map_ms / first.map_ms))
        };
        resolutions.into_iter().filter_map(growth).collect()
    }
}

/// Measures all sizes. `progress` is called before each, and may cancel.
///
/// # Errors
/// If the loops do not agree, hair cannot be grown, or [`ProjectError::Cancelled`].
pub(super) fn measure(
    progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
) -> Result<VoxelMapReport, ProjectError> {
    measure_sizes(&COPIES, &RESOLUTIONS, progress)
}

fn measure_sizes(
    copies: &[usize],
    resolutions: &[u32],
    progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
) -> Result<VoxelMapReport, ProjectError> {
    let style = grow(&GroomSettings::preset(Preset::Smooth), &PlainHead.scalp(48), &PlainHead)
        .map_err(ProjectError::work)?;
    let mut strands = Strands::default();
    interpolate(&style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0), &mut strands);
    let all = rayon::current_num_threads();
    let pools = std::iter::once(1).chain((all > 1).then_some(all));
    let pools: Vec<_> = pools
        .map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build())
        .collect::<Result<_, _>>()
        .map_err(ProjectError::work)?;
    let mut rows = Vec::new();
    for &copies in copies {
        let strands = copied(&strands, copies);
        for &resolution in resolutions {
            if progress(&format!("voxel-map, {} points, {resolution}³ cells", strands.points())).is_break() {
                return Err(ProjectError::Cancelled);
            }
            rows.extend(Loops::new(&strands, resolution, copies).time(&pools)?);
        }
    }
    Ok(VoxelMapReport { rows })
}

/// The strands, each `copies` times within a centimetre: hair of the same shape with more points.
fn copied(strands: &Strands, copies: usize) -> Strands {
    let mut random = SplitMix64::new(1);
    let points = copies * strands.points();
    let mut made = Strands {
        x: Vec::with_capacity(points),
        y: Vec::with_capacity(points),
        z: Vec::with_capacity(points),
        ..Strands::default()
    };
    let mut first_point = vec![0];
    for ends in strands.first_point.windows(2) {
        let of = ends[0] as usize..ends[1] as usize;
        for copy in 0..copies {
            let offset = if copy == 0 { Vec3::ZERO } else { 0.005 * random.signed_vec3() };
            made.x.extend(strands.x[of.clone()].iter().map(|x| x + offset.x));
            made.y.extend(strands.y[of.clone()].iter().map(|y| y + offset.y));
            made.z.extend(strands.z[of.clone()].iter().map(|z| z + offset.z));
            first_point.push(made.x.len() as u32);
        }
    }
    made.first_point = Arc::from(first_point);
    made
}

/// All loops over the same strands.
struct Loops<'a> {
    input: ShadowInput<'a>,
    /// The printed density and filter.
    printed: ShadowSettings,
    /// The program's own.
    by_length: ShadowSettings,
    /// The map with the printed density, and by length: on one thread, then on all. Each keeps its memory.
    maps: [[VoxelMap; 2]; 2],
    published: [PublishedMap; 2],
    out: Vec<f32>,
}

impl<'a> Loops<'a> {
    /// The loops over `strands`, with empty maps.
    fn new(strands: &'a Strands, resolution: u32, copies: usize) -> Self {
        let mut by_length = ShadowSettings::default();
        by_length.voxel_map.resolution = resolution;
        let mut printed = by_length;
        printed.voxel_map.deposit = VoxelDeposit::PointCount;
        printed.voxel_map.filter = VoxelFilter::Paper;
        // A cell of a finer map contains fewer points, and a point adds less in hair of more points.
        let fineness = (resolution as f32 / 128.0).powi(3);
        printed.voxel_map.point_extinction = EXTINCTION * fineness / copies as f32;
        let input = ShadowInput {
            strands,
            strand_width: 80e-6 * 100_000.0 / strands.count() as f32,
            extinction_scale: 0.15,
            light: LightFrame::new(Vec3::new(0.4, -1.0, -0.5)),
            anchor: Vec3::ZERO,
            maps: 1,
            projected: None,
        };
        let orders = [CellOrder::AsPrinted, CellOrder::AlongLight];
        let published = orders.map(|order| PublishedMap::new(resolution, order));
        let maps = std::array::from_fn(|_| std::array::from_fn(|_| VoxelMap::default()));
        Self { input, printed, by_length, maps, published, out: vec![0.0; strands.points()] }
    }

    /// Runs a map, one of those for one thread (0) or for all (1): with the printed density (0), or as the program uses it (1).
    fn run_map(&mut self, threads: usize, which: usize) -> Result<(), ProjectError> {
        let settings = if which == 1 { &self.by_length } else { &self.printed };
        let map = &mut self.maps[threads][which];
        map.build(&self.input, settings).map_err(ProjectError::work)?;
        let Strands { x, y, z, .. } = self.input.strands;
        map.transmittance_at(x, y, z, &mut self.out);
        Ok(())
    }

    /// Runs the published loop: as printed (0) or in its best order (1).
    fn run_published(&mut self, order: usize) {
        // The loop has the cells of the map, which must be built before.
        let Some(lattice) = self.maps[0][0].lattice().copied() else { return };
        let depth = self.input.extinction_scale * self.printed.voxel_map.point_extinction * lattice.cell_size;
        let map = &mut self.published[order];
        map.build(&lattice, self.input.strands, depth);
        map.filter(&lattice, self.input.strands, &mut self.out);
    }

    /// The largest difference between the loops.
    fn difference(&mut self) -> Result<f32, ProjectError> {
        self.run_map(0, 0)?;
        let wanted = self.out.clone();
        let mut largest = 0.0_f32;
        for order in 0..self.published.len() {
            self.run_published(order);
            let differences = self.out.iter().zip(&wanted).map(|(a, b)| (a - b).abs());
            largest = differences.fold(largest, f32::max);
        }
        if largest > TOLERANCE {
            return Err(ProjectError::work(format!(
                "voxel-map: the loops differ by {largest} in transmittance; must be at most {TOLERANCE}"
            )));
        }
        Ok(largest)
    }

    /// A row for each of the pools, of one thread and of all.
    fn time(mut self, pools: &[ThreadPool]) -> Result<Vec<VoxelMapRow>, ProjectError> {
        let largest_difference = self.difference()?;
        let mut least = vec![[f64::INFINITY; 4]; pools.len()];
        let whole = Stopwatch::start();
        let mut rounds = 0;
        while rounds < ROUNDS[0] || rounds < ROUNDS[1] && whole.secs() < SECS {
            for which in 0..4 {
                for (threads, (pool, least)) in pools.iter().zip(&mut least).enumerate() {
                    let ms = pool.install(|| self.run_for_a_round(threads, which))?;
                    least[which] = least[which].min(ms);
                }
            }
            rounds += 1;
        }
        let row = |(pool, least): (&ThreadPool, [f64; 4])| {
            let [as_printed_ms, best_order_ms, map_ms, by_length_ms] = least;
            VoxelMapRow {
                points: self.input.strands.points(),
                resolution: self.printed.voxel_map.resolution,
                threads: pool.current_num_threads(),
                as_printed_ms,
                best_order_ms,
                map_ms,
                by_length_ms,
                largest_difference,
            }
        };
        Ok(pools.iter().zip(least).map(row).collect())
    }

    /// Repeats one of the loops, both orders and both maps, for [`ROUND_MS`]. Returns the time of the fastest run, milliseconds.
    fn run_for_a_round(&mut self, threads: usize, which: usize) -> Result<f64, ProjectError> {
        let round = Stopwatch::start();
        let mut least = f64::INFINITY;
        loop {
            let watch = Stopwatch::start();
            match which {
                0 | 1 => self.run_published(which),
                _ => self.run_map(threads, which - 2)?,
            }
            least = least.min(watch.ms());
            if round.ms() > ROUND_MS {
                return Ok(least);
            }
        }
    }
}

impl fmt::Display for VoxelMapReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "voxel-map: density, sum along the light and one filtered lookup per point; the fastest run, milliseconds"
        )?;
        writeln!(
            f,
            "{:>12}{:>8}{:>9}{:>12}{:>12}{:>10}{:>10}{:>10}{:>10}{:>12}{:>12}",
            "points",
            "cells",
            "threads",
            "as printed",
            "best order",
            "map",
            "times",
            "times",
            "ns/point",
            "by length",
            "difference"
        )?;
        for row in &self.rows {
            let [printed, best] = [row.times_printed(), row.times_best()].map(|times| format!("{times:.1}"));
            writeln!(
                f,
                "{:>12}{:>8}{:>9}{:>12.2}{:>12.2}{:>10.2}{printed:>10}{best:>10}{:>10.2}{:>12.2}{:>12.5}",
                row.points,
                format!("{}³", row.resolution),
                row.threads,
                row.as_printed_ms,
                row.best_order_ms,
                row.map_ms,
                row.ns_per_point(),
                row.by_length_ms,
                row.largest_difference
            )?;
        }
        writeln!(
            f,
            "  times: as printed and best order, divided by map, each on the same number of threads; by length: the map as the program \
             uses it"
        )?;
        for (resolution, points, time) in self.growth() {
            writeln!(
                f,
                "  growth at {resolution}³: {points:.0} times the points take {time:.0} times as long"
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_keep_the_strands_and_stay_near_them() {
        let strands = Strands {
            first_point: Arc::from([0, 2, 5]),
            x: vec![0.0, 1.0, 2.0, 3.0, 4.0],
            y: vec![0.0; 5],
            z: vec![1.0; 5],
        };
        let made = copied(&strands, 3);
        assert_eq!(&*made.first_point, [0, 2, 4, 6, 9, 12, 15]);
        assert_eq!(&made.x[..2], [0.0, 1.0]);
        let near = made.x[6..9].iter().zip(&strands.x[2..]).all(|(a, b)| (a - b).abs() < 0.01);
        assert!(near && made.points() == 15, "{:?}", made.x);
    }

    #[test]
    fn the_loops_agree_on_hair_that_is_neither_black_nor_lit() {
        let mut silent = |_: &str| ControlFlow::Continue(());
        let report = measure_sizes(&[1], &[32], &mut silent).expect("they agree");
        let mut threads = vec![1, rayon::current_num_threads()];
        threads.dedup();
        assert_eq!(report.rows.iter().map(|row| row.threads).collect::<Vec<_>>(), threads);
        for row in &report.rows {
            assert_eq!((row.points, row.resolution), (103_850, 32));
            assert!(row.as_printed_ms > 0.0 && row.map_ms > 0.0 && row.largest_difference > 0.0, "{row:?}");
        }
        assert!(report.growth().is_empty());
        let mut cancel = |_: &str| ControlFlow::Break(());
        assert!(matches!(measure_sizes(&[1], &[32], &mut cancel), Err(ProjectError::Cancelled)));
    }

    #[test]
    fn loops_that_differ_are_an_error() {
        let style =
            grow(&GroomSettings::preset(Preset::Smooth), &PlainHead.scalp(48), &PlainHead).expect("hair");
        let mut strands = Strands::default();
        interpolate(&style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0), &mut strands);
        let mut loops = Loops::new(&strands, 32, 1);
        loops.difference().expect("they agree");
        let mean = loops.out.iter().sum::<f32>() / loops.out.len() as f32;
        assert!((0.05..0.95).contains(&mean), "{mean}");
        loops.printed.voxel_map.filter = VoxelFilter::Centred;
        let error = loops.difference().expect_err("another filter");
        assert!(error.to_string().starts_with("voxel-map: the loops differ by 0."), "{error}");
    }

    #[test]
    fn ratios_and_growth_by_hand() {
        let row = |points, threads, map_ms| VoxelMapRow {
            points,
            resolution: 128,
            threads,
            as_printed_ms: 60.0,
            best_order_ms: 12.0,
            map_ms,
            by_length_ms: 2.0,
            largest_difference: 1e-4,
        };
        let rows = [(100_000, 1, 2.0), (100_000, 2, 1.0), (10_000_000, 1, 120.0), (10_000_000, 2, 90.0)];
        let report =
            VoxelMapReport { rows: rows.map(|(points, threads, ms)| row(points, threads, ms)).to_vec() };
        assert_eq!(report.growth(), [(128, 100.0, 90.0)]);
        let text = report.to_string();
        let numbers: Vec<_> = text.lines().nth(3).expect("a row").split_whitespace().collect();
        assert_eq!(
            numbers,
            ["100000", "128³", "2", "60.00", "12.00", "1.00", "60.0", "12.0", "10.00", "2.00", "0.00010"]
        );
        assert!(text.contains("growth at 128³: 100 times the points take 90 times as long"), "{text}");
    }
}
