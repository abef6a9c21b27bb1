//! The map of any method with a record for each texel.

use glam::Vec3;
use lovelock_base::simd::Width;
use rayon::prelude::*;

use super::fragments::{Fragment, Fragments, needed_bytes, refit, sum_over_segments};
use super::frame::TexelFrame;
use super::gaussian::{GaussianLines, line_deviation};
use super::lines::{FilteredLines, Lines, Steps};
use super::lookup::{self, Lookup};
use super::{LineProfile, MapScale, TexelFilter, TexelMethod};
use crate::cpu::safe_extinction;
use crate::exp::exp_of_minus;
use crate::{
    ColumnMap, CpuShadow, RayMark, RayStructure, ShadowError, ShadowInput, ShadowReport, ShadowSettings,
};

/// Points per parallel task of a lookup.
const POINTS_PER_LOOKUP: usize = 2048;

/// The largest optical depth of a fragment, so that sums stay finite; e^−10⁴ is 0 in any float.
const MAX_DEPTH_PER_FRAGMENT: f32 = 1e4;

/// The map of a method with a record for each texel; everything is lit until it is built.
///
/// Only texels with hair have a record.
#[derive(Clone, Debug)]
pub struct TexelMap<M: TexelMethod> {
    fragments: Fragments,
    /// The index of the record of each texel plus 1; 0 where it has none.
    slots: Vec<u32>,
    cells: Vec<M::Cell>,
    width: Width,
    built: Option<BuiltMap<M>>,
}

#[derive(Clone, Copy, Debug)]
struct BuiltMap<M> {
    method: M,
    frame: TexelFrame,
    report: ShadowReport,
}

impl<M: TexelMethod> Default for TexelMap<M> {
    fn default() -> Self {
        Self {
            fragments: Fragments::default(),
            slots: Vec::new(),
            cells: Vec::new(),
            width: Width::widest(),
            built: None,
        }
    }
}

impl<M: TexelMethod> TexelMap<M> {
    /// The placement of the texels of the last build; `None` before the first.
    pub fn frame(&self) -> Option<&TexelFrame> {
        self.built.as_ref().map(|built| &built.frame)
    }

    /// The record of a texel of the last build; `None` where there is no hair.
    pub fn record(&self, column: u32, row: u32) -> Option<&[M::Cell]> {
        let built = self.built.as_ref()?;
        if column >= built.frame.resolution || row >= built.frame.resolution {
            return None;
        }
        let slot = (self.slots[self.fragments.place(column, row)] as usize).checked_sub(1)?;
        let cells = built.method.cells();
        Some(&self.cells[slot * cells..(slot + 1) * cells])
    }

    /// The fragments of the texel that contains a point, as [`TexelMethod::fill`] left them, and the depth of the point. Empty
    /// beside the map.
    pub(crate) fn fragments_at(&self, p: Vec3) -> (&[Fragment], f32) {
        let Some((_, texel, depth)) = self.texel_of(p) else { return (&[], 0.0) };
        (self.fragments.texel(texel), depth)
    }

    /// The texel that contains a point, and the depth of the point; `None` beside the map.
    fn texel_of(&self, p: Vec3) -> Option<(&BuiltMap<M>, usize, f32)> {
        let built = self.built.as_ref()?;
        let p = built.frame.texel_from_world(p);
        let end = built.frame.resolution as f32;
        // False for NaN.
        let inside = p.x >= 0.0 && p.x < end && p.y >= 0.0 && p.y < end && p.z.is_finite();
        inside.then(|| (built, self.fragments.place(p.x as u32, p.y as u32), p.z))
    }

    /// Returns an error if the map would exceed its limit. Allocates nothing.
    fn check(needed_bytes: u64, method: &M, input: &ShadowInput) -> Result<(), ShadowError> {
        let limit_bytes = input.share_of(method.memory_limit_bytes());
        if needed_bytes > limit_bytes {
            let maps = input.maps.max(1);
            return Err(ShadowError::TooLarge { method: M::METHOD, needed_bytes, limit_bytes, maps });
        }
        Ok(())
    }

    /// Memory of the records, of the sorted fragments, and memory that only sorting needs, bytes.
    fn memory_bytes(&self) -> (u64, u64, u64) {
        let (sorted, loose) = self.fragments.memory_bytes();
        let records = 4 * self.slots.capacity() + size_of::<M::Cell>() * self.cells.capacity();
        (records as u64, sorted, loose)
    }

    fn build_into(
        &mut self,
        input: &ShadowInput,
        settings: &ShadowSettings,
    ) -> Result<BuiltMap<M>, ShadowError> {
        let method = M::new(settings);
        let bounds = input.bounds();
        let frame = TexelFrame::new(input, method.resolution(), &bounds);
        let depth_per_texel = depth_per_texel(input.extinction_scale, input.strand_width, &frame);
        let extinction_scale = safe_extinction(input.extinction_scale);
        let method = method.within(&MapScale { frame: &frame, extinction_scale, depth_per_texel });
        let resolution = frame.resolution;
        let texels = u64::from(resolution).pow(2);
        let lines = Lines { resolution, depth_per_texel };
        let gaussian = |width: f32| GaussianLines {
            lines,
            deviation: line_deviation(width, input.strand_width, &frame),
        };
        let count = sum_over_segments(input, &frame, |from, to| {
            let steps = Steps::new(from, to);
            let per_step = match method.profile() {
                LineProfile::Thin => 1,
                LineProfile::TwoTexels => FilteredLines::PER_STEP,
                LineProfile::Gaussian(width) => gaussian(width).per_step(&steps),
            };
            per_step * steps.count()
        });
        // Slots, and the memory that sorting needs.
        let sorting = needed_bytes(input, resolution, count).saturating_add(4 * texels);
        Self::check(sorting, &method, input)?;
        let cell_bytes = size_of::<M::Cell>() as u64 * method.cells() as u64;
        // The buffers of the last build are freed if they and the new ones together would exceed the limit.
        let (records, sorted, loose) = self.memory_bytes();
        let most = sorting + texels.min(count) * cell_bytes;
        if records + sorted + loose + most > input.share_of(method.memory_limit_bytes()) {
            *self = Self { width: self.width, ..Self::default() };
        }

        let size = (resolution, resolution);
        match method.profile() {
            LineProfile::Thin => self.fragments.draw(input, &frame, size, &lines),
            LineProfile::TwoTexels => self.fragments.draw(input, &frame, size, &FilteredLines(lines)),
            LineProfile::Gaussian(width) => self.fragments.draw(input, &frame, size, &gaussian(width)),
        }
        let in_use: u64 = self.fragments.in_use().iter().sum();
        let needed_bytes = sorting + in_use * cell_bytes;
        Self::check(needed_bytes, &method, input)?;
        self.fill(&method, in_use as usize);

        let (records, sorted, loose) = self.memory_bytes();
        let (map, scratch) =
            if M::READS_FRAGMENTS { (records + sorted, loose) } else { (records, sorted + loose) };
        let report = ShadowReport {
            memory_bytes: map,
            cells_touched: in_use,
            cells_total: texels,
            cell_size: frame.texel_size,
            samples: count,
            points_ignored: bounds.ignored,
            scratch_bytes: scratch,
            needed_bytes,
            fallbacks: self.fallbacks(&method),
        };
        Ok(BuiltMap { method, frame, report })
    }

    /// The number of records that cannot be read as they should be.
    fn fallbacks(&self, method: &M) -> u64 {
        let cells = method.cells().max(1);
        self.cells
            .par_chunks_exact(cells)
            .with_min_len(4096)
            .filter(|record| method.falls_back(record))
            .count() as u64
    }

    /// Computes the records of all `in_use` texels with fragments.
    fn fill(&mut self, method: &M, in_use: usize) {
        let cells = method.cells();
        self.slots.clear();
        refit(&mut self.slots, self.fragments.texels());
        refit(&mut self.cells, in_use * cells);
        let in_band = self.fragments.in_use().to_vec();
        let slots = self.slots.chunks_exact_mut(self.fragments.band_texels());
        let (mut rest, mut slot) = (&mut self.cells[..], 0);
        let mut work = Vec::with_capacity(in_band.len());
        for ((band, slots), in_band) in self.fragments.bands().into_iter().zip(slots).zip(in_band) {
            let (records, after) = std::mem::take(&mut rest).split_at_mut(in_band as usize * cells);
            rest = after;
            work.push((band, slots, slot, records));
            slot += in_band as u32;
        }
        work.into_par_iter().with_max_len(1).for_each(|(mut band, slots, mut slot, mut records)| {
            band.for_each_texel(|texel, fragments| {
                let (record, after) = std::mem::take(&mut records).split_at_mut(cells);
                records = after;
                slot += 1;
                slots[texel] = slot;
                method.fill(fragments, record);
            });
        });
    }
}

/// Optical depth of a piece of strand whose length across the light is one texel: `s w ℓ sinθ / A` with ℓ sinθ = t and
/// A = t², for texels of edge t.
pub(crate) fn depth_per_texel(extinction_scale: f32, strand_width: f32, frame: &TexelFrame) -> f32 {
    let depth = safe_extinction(extinction_scale) * strand_width / frame.texel_size;
    if depth > 0.0 { depth.min(MAX_DEPTH_PER_FRAGMENT) } else { 0.0 }
}

impl<M: TexelMethod> TexelMap<M> {
    fn lookup<'a>(&'a self, built: &'a BuiltMap<M>) -> Lookup<'a, M> {
        Lookup {
            method: &built.method,
            frame: &built.frame,
            fragments: &self.fragments,
            slots: &self.slots,
            cells: &self.cells,
        }
    }
}

impl<M: TexelMethod> CpuShadow for TexelMap<M> {
    fn build(&mut self, input: &ShadowInput, settings: &ShadowSettings) -> Result<(), ShadowError> {
        self.built = None;
        match self.build_into(input, settings) {
            Ok(built) => self.built = Some(built),
            Err(error) => {
                *self = Self::default();
                return Err(error);
            }
        }
        Ok(())
    }

    fn transmittance(&self, p: Vec3) -> f32 {
        let mut out = [1.0];
        self.transmittance_at(&[p.x], &[p.y], &[p.z], &mut out);
        out[0]
    }

    fn transmittance_at(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        assert!(x.len() == out.len() && y.len() == out.len() && z.len() == out.len(), "slices of one length");
        let Some(built) = &self.built else {
            out.fill(1.0);
            return;
        };
        let lookup = self.lookup(built);
        let filter = built.method.filter();
        let run = |x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]| {
            let read = match filter {
                TexelFilter::Nearest => lookup::nearest,
                TexelFilter::Bilinear => lookup::bilinear,
                TexelFilter::Jitter => lookup::jittered,
            };
            read(self.width, &lookup, x, y, z, out);
        };
        if out.len() <= POINTS_PER_LOOKUP {
            run(x, y, z, out);
            return;
        }
        let piece = POINTS_PER_LOOKUP;
        let points = x.par_chunks(piece).zip(y.par_chunks(piece)).zip(z.par_chunks(piece));
        points.zip(out.par_chunks_mut(piece)).for_each(|(((x, y), z), out)| run(x, y, z, out));
    }

    fn report(&self) -> ShadowReport {
        self.built.as_ref().map_or_else(ShadowReport::default, |built| built.report)
    }

    fn column_map(&self) -> Option<ColumnMap> {
        let built = self.built.as_ref()?;
        let lookup = self.lookup(built);
        let size = built.frame.resolution;
        let mut transmittance = vec![1.0; (size * size) as usize];
        let texels = transmittance.par_iter_mut().enumerate().with_min_len(4096);
        texels.for_each(|(texel, out)| *out = lookup.behind(texel));
        Some(ColumnMap { size, transmittance, uv_from_world: built.frame.uv_from_world() })
    }

    fn fragments_before(&self, points: &[Vec3]) -> Option<Vec<u32>> {
        let count = |p: &Vec3| {
            let (fragments, depth) = self.fragments_at(*p);
            fragments.partition_point(|fragment| fragment.depth() < depth) as u32
        };
        // Fragments that are read are sorted by depth.
        M::READS_FRAGMENTS.then(|| points.par_iter().with_min_len(4096).map(count).collect())
    }

    fn along_ray(&self, p: Vec3) -> RayStructure {
        let mut marks = Vec::new();
        let Some((built, texel, here)) = self.texel_of(p) else { return RayStructure::default() };
        let Some(slot) = (self.slots[texel] as usize).checked_sub(1) else { return RayStructure::default() };
        let (method, cells) = (&built.method, built.method.cells());
        let record = &self.cells[slot * cells..(slot + 1) * cells];
        let fragments = if M::READS_FRAGMENTS { self.fragments.texel(texel) } else { &[] };
        method.pieces(fragments, record, &mut |kind, depths, optical_depth| {
            let [start, end] = depths.map(|depth| (depth - here) * built.frame.depth_range);
            // A fragment at exactly this depth does not count as before it.
            let behind = method.depth_before(fragments, record, depths[1].next_up());
            marks.push(RayMark { kind, start, end, optical_depth, transmittance: exp_of_minus(behind) });
        });
        RayStructure { marks }
    }
}

#[cfg(test)]
mod tests;
