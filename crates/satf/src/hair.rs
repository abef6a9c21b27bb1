//! The clusters of a hairstyle.

use std::collections::HashMap;
use std::sync::Arc;

use glam::Affine3A;
use lovelock_groom::{GuideFrame, HairLook, Hairstyle, StrandSet, Strands, Wisp, interpolate};
use rayon::prelude::*;

use crate::cells::{Cell, cells_of, strand_width};
use crate::ribs::{RibGrid, rib_style};
use crate::section::{Section, sections_of};
use crate::settings::ClusterSettings;

/// The most hair shell volumes of a hairstyle.
const MAX_VOLUMES: usize = 400_000;

/// Every wisp of a hairstyle as a layered generalised disk. Constant until hairstyle or settings change.
#[derive(Clone, Debug)]
pub struct ClusterHair {
    /// A hairstyle of the ribs, with the guides of the original. Its strands are ordered by cluster, ring and rib.
    pub ribs: Arc<Hairstyle>,
    /// The hairstyle that casts shadows in place of the original: some strands of each wisp, which are as much wider. The original
    /// itself if its wisps have few strands.
    pub casters: Arc<Hairstyle>,
    /// How each cluster is divided.
    pub grid: RibGrid,
    /// Radius of the empty core, as a fraction of the section.
    pub core: f32,
    /// The boundary sectors of each macro-cluster in the order of [`RibGrid::cells`].
    pub cells: Vec<Cell>,
    /// For each cluster, its macro-cluster and by how many ribs it is turned: `macro * around + turn`.
    pub shapes: Vec<u32>,
    /// The number of strands that the hairstyle stores, for which the clusters stand.
    pub strands: usize,
}

impl ClusterHair {
    /// The clusters of `style`, whose sectors look as those of strands about `width` metres wide; see [`nominal_width`].
    pub fn new(style: &Arc<Hairstyle>, settings: &ClusterSettings, width: f32) -> Self {
        let wisps = style.wisps.iter().filter(|w| w.strand_count > 0).count();
        let grid = settings.grid(wisps, mean_length(style), MAX_VOLUMES);
        let core = settings.core.clamp(0.0, 0.9);
        let sections: Vec<Vec<Section>> = if style.check().is_ok() {
            style.wisps.par_iter().map(|wisp| sections_of(style, wisp, grid.along)).collect()
        } else {
            // Strands of such a style can only be given, not placed by guides.
            vec![Vec::new(); style.wisps.len()]
        };
        let each: Vec<Vec<Cell>> = sections
            .par_iter()
            .filter(|sections| !sections.is_empty())
            .map(|sections| cells_of(sections, grid, core, width, settings.curls))
            .collect();
        let ribs =
            rib_style(style, &sections, grid, core, |wisp, rib| shade_of(style, wisp, &sections[wisp], rib));
        let (cells, shapes) = shared(&each, grid, settings.macro_tolerance);
        Self { ribs, casters: casters_of(style), grid, core, cells, shapes, strands: style.strands.count() }
    }

    /// The number of clusters.
    pub fn clusters(&self) -> usize {
        self.shapes.len()
    }

    /// The number of macro-clusters.
    pub fn macro_clusters(&self) -> usize {
        self.cells.len() / self.grid.cells().max(1)
    }

    /// Bytes of the boundary sectors, and what they would be if no cluster shared those of another.
    pub fn bytes(&self) -> [u64; 2] {
        let own = self.cells.len() * size_of::<Cell>() + self.shapes.len() * size_of::<u32>();
        let alone = self.clusters() * self.grid.cells() * size_of::<Cell>();
        [own as u64, alone as u64]
    }

    /// The boundary sector of a cluster at a rib and a section.
    pub fn cell(&self, cluster: usize, layer: usize, rib: usize, section: usize) -> Cell {
        let RibGrid { around, .. } = self.grid;
        let shape = self.shapes[cluster] as usize;
        let rib = (rib + shape % around) % around;
        let first = shape / around * self.grid.cells();
        self.cells[first + (layer * around + rib) * self.grid.points() + section]
    }
}

/// The mean length of strands at rest, metres, from some of them.
fn mean_length(style: &Arc<Hairstyle>) -> f32 {
    if style.check().is_err() {
        return 0.0;
    }
    let mut strands = Strands::default();
    interpolate(style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0), &mut strands);
    let step = (strands.count() / 500).max(1);
    let ends = strands.first_point.windows(2).step_by(step);
    let lengths = ends.map(|ends| {
        let points = ends[0] as usize..ends[1] as usize;
        points.clone().skip(1).map(|i| strands.point(i).distance(strands.point(i - 1))).sum::<f32>()
    });
    let (sum, count) = lengths.filter(|l| l.is_finite()).fold((0.0, 0), |(s, n), l| (s + l, n + 1));
    sum / count.max(1) as f32
}

/// Of hairstyles of more strands, only so many cast shadows where clusters are drawn.
const CASTERS: usize = 3500;
/// The fewest strands of a wisp that cast shadows.
const FEWEST_CASTERS: usize = 12;

/// A part of the strands of each wisp, evenly.
fn casters_of(style: &Arc<Hairstyle>) -> Arc<Hairstyle> {
    let set = &style.strands;
    let step = (set.count() / CASTERS).max(1);
    if step == 1 || style.check().is_err() {
        return Arc::clone(style);
    }
    let mut kept = StrandSet { first_point: vec![0], ..StrandSet::default() };
    let mut wisps = Vec::with_capacity(style.wisps.len());
    let mut chosen = Vec::new();
    for wisp in &style.wisps {
        let count = wisp.strand_count as usize;
        let keep = (count / step).max(FEWEST_CASTERS).min(count);
        wisps.push(Wisp { first_strand: kept.wisp.len() as u32, strand_count: keep as u32, ..*wisp });
        for k in 0..keep {
            let s = wisp.first_strand as usize + k * count / keep;
            let points = set.first_point[s] as usize..set.first_point[s + 1] as usize;
            chosen.push(s);
            kept.wisp.push(set.wisp[s]);
            kept.weights.push(set.weights[s]);
            kept.shade.push(set.shade[s]);
            for (to, from) in [
                (&mut kept.guide_param, &set.guide_param),
                (&mut kept.offset_normal, &set.offset_normal),
                (&mut kept.offset_binormal, &set.offset_binormal),
                (&mut kept.offset_tangent, &set.offset_tangent),
                (&mut kept.taper, &set.taper),
            ] {
                to.extend_from_slice(&from[points.clone()]);
            }
            kept.first_point.push(kept.guide_param.len() as u32);
        }
    }
    kept.colours = set.colours.selected(chosen.into_iter());
    Arc::new(Hairstyle { wisps, strands: kept, ..(**style).clone() })
}

/// The width of strands by which sectors are chosen, metres: [`strand_width`] rounded to a power of two, so that clusters stay the same
/// while the width changes a little. Their optical depth follows the width itself.
pub fn nominal_width(look: &HairLook, strands: usize) -> f32 {
    let width = strand_width(look, strands);
    if width > 0.0 { width.log2().round().clamp(-40.0, 10.0).exp2() } else { 0.0 }
}

/// The shade of a rib: that of one of the strands of its wisp, so that clusters vary as strands do.
fn shade_of(style: &Hairstyle, wisp: usize, sections: &[Section], rib: usize) -> f32 {
    let Some(first) = sections.first() else { return 0.5 };
    let count = first.crossings.len().max(1);
    let strand = first.crossings.get(rib.wrapping_mul(7) % count).map_or(0, |crossing| crossing.strand);
    let at = style.wisps[wisp].first_strand as usize + strand;
    style.strands.shade.get(at).copied().unwrap_or(0.5)
}

/// Macro-clusters (level two of the hierarchy): clusters whose strands lie alike, up to a turn about their middle, share the boundary
/// sectors of the first of them. Returns those, and for each cluster `macro * around + turn`.
///
/// Two clusters are alike if their masses, added up along the ribs, differ by at most `tolerance` of the whole. With 0 only equal ones
/// share.
fn shared(each: &[Vec<Cell>], grid: RibGrid, tolerance: f32) -> (Vec<Cell>, Vec<u32>) {
    let mut cells = Vec::new();
    let mut shapes = Vec::with_capacity(each.len());
    let mut equal: HashMap<&[Cell], u32> = HashMap::new();
    let mut leaders: Vec<Vec<f32>> = Vec::new();
    for own in each {
        if let Some(&shape) = equal.get(&own[..]) {
            shapes.push(shape);
            continue;
        }
        let profile = profile(own, grid);
        let found = leaders.iter().enumerate().find_map(|(m, leader)| {
            let turn = (0..grid.around).find(|&turn| unlike(&profile, leader, grid, turn) <= tolerance)?;
            Some((m * grid.around + turn) as u32)
        });
        let shape = found.unwrap_or_else(|| {
            cells.extend_from_slice(own);
            leaders.push(profile);
            ((leaders.len() - 1) * grid.around) as u32
        });
        equal.insert(&own[..], shape);
        shapes.push(shape);
    }
    (cells, shapes)
}

/// Strands of each rib in three parts of its length: root, middle and tip.
fn profile(cells: &[Cell], grid: RibGrid) -> Vec<f32> {
    let points = grid.points();
    let third = points.div_ceil(3);
    let ribs = cells.chunks(points).flat_map(|rib| rib.chunks(third));
    ribs.map(|part| part.iter().map(|cell| cell.strands()).sum()).collect()
}

/// The difference of two profiles as a fraction of the first, with the second turned.
fn unlike(a: &[f32], b: &[f32], grid: RibGrid, turn: usize) -> f32 {
    let parts = a.len() / (grid.layers * grid.around).max(1);
    let total: f32 = a.iter().sum();
    let mut sum = 0.0;
    for layer in 0..grid.layers {
        for rib in 0..grid.around {
            let at = (layer * grid.around + rib) * parts;
            let other = (layer * grid.around + (rib + turn) % grid.around) * parts;
            for part in 0..parts {
                sum += (a[at + part] - b[other + part]).abs();
            }
        }
    }
    if total > 0.0 { sum / total } else { 0.0 }
}
