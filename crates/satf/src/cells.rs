//! What each hair shell volume of a cluster holds: the mass of its strands, and the sector of the database that looks like them.

use glam::Vec2;
use half::f16;
use lovelock_groom::HairLook;

use crate::features::{Curl, Features, SectorRef, depth_of};
use crate::layout::DEPTHS;
use crate::ribs::RibGrid;
use crate::section::Section;

/// A strand stands for hair around it as far as this fraction of the distance to its neighbours, as the deviation of a gaussian.
const SPREAD: f32 = 0.45;

/// A boundary sector, packed: the sector of the database in 15 bits, whether it is mirrored, and the strands in it as a half float.
///
/// The strands are a sum of tapers, a number of strands of full width. Times the width of a strand, divided by the length of the sector's
/// arc, that is the sector's optical depth along the radius; it follows the cluster as it opens and narrows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct Cell(pub u32);

impl Cell {
    fn new(sector: SectorRef, strands: f32) -> Self {
        let mirrored = u32::from(sector.mirrored) << 15;
        Self(sector.index & 0x7fff | mirrored | u32::from(f16::from_f32(strands).to_bits()) << 16)
    }

    /// The number of strands.
    pub fn strands(self) -> f32 {
        f16::from_bits((self.0 >> 16) as u16).to_f32()
    }

    /// Whether both refer to the same sector of the database.
    pub fn has_sector_of(self, other: Self) -> bool {
        self.0 & 0xffff == other.0 & 0xffff
    }

    /// The sector of the database for an optical depth.
    pub fn sector(self, optical_depth: f32) -> SectorRef {
        let index = self.0 & 0x7fff;
        let ratio = optical_depth / depth_of(index as usize % DEPTHS);
        SectorRef {
            index,
            mirrored: self.0 & 0x8000 != 0,
            // False for NaN.
            tau_ratio: if ratio > 0.0 { ratio.min(1e6) } else { 0.0 },
        }
    }

    /// The same sector with other strands in it.
    #[must_use]
    pub fn with_strands(self, strands: f32) -> Self {
        Self(self.0 & 0xffff | u32::from(f16::from_f32(strands).to_bits()) << 16)
    }
}

/// The sum of what strands contribute to a sector.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    strands: f32,
    /// Weighted places inside of the sector, and their weight.
    places: [f32; 2],
    weight: f32,
}

/// The cells of a cluster, in the order of layer, rib and section. `width` is that of one strand, metres. `curls` says whether curled
/// sectors differ from straight ones.
pub(crate) fn cells_of(sections: &[Section], grid: RibGrid, core: f32, width: f32, curls: bool) -> Vec<Cell> {
    let points = grid.points();
    let mut cells = vec![Cell::default(); grid.cells()];
    let mut sums = Vec::new();
    let mut own: Vec<Option<Vec2>> = Vec::new();
    for (i, section) in sections.iter().enumerate() {
        sums.clear();
        sums.resize(grid.layers * grid.around, Sum::default());
        add_strands(section, grid, core, &mut sums);
        let reach = sideways(section, sections.get(i + 1).or(sections.get(i.wrapping_sub(1))), &mut own);
        let radius = section.shape.determinant().abs().sqrt();
        for (rib, sum) in sums.iter().enumerate() {
            let arc = std::f32::consts::TAU * grid.middle_radius(rib / grid.around, core) * radius
                / grid.around as f32;
            let [s, t] = sum.places.map(|place| if sum.weight > 0.0 { place / sum.weight } else { 0.5 });
            let features = Features {
                optical_depth: sum.strands * width / arc.max(1e-6),
                s_centroid: s,
                t_centroid: t,
                curl: if curls { Curl::of_reach(reach * radius / arc.max(1e-6)) } else { Curl::Straight },
            };
            cells[rib * points + i] = Cell::new(SectorRef::of(&features), sum.strands);
        }
    }
    hold_patterns(&mut cells, grid);
    cells
}

/// Spreads the strands of a section over its sectors: each as a gaussian as wide as the gap to its neighbours, because a stored strand
/// stands for the hair around it.
fn add_strands(section: &Section, grid: RibGrid, core: f32, sums: &mut [Sum]) {
    let count = section.crossings.len().max(1) as f32;
    let deviation = SPREAD * (std::f32::consts::PI / count).sqrt();
    for crossing in &section.crossings {
        let ([layer, sector], place) = grid.cell(crossing.at, core);
        let radius = crossing.at.length().clamp(core.max(0.05), 1.0);
        let around = deviation / (radius * std::f32::consts::TAU) * grid.around as f32;
        let outward = deviation / (1.0 - core).max(0.05) * grid.layers as f32;
        let at = [sector as f32 + place[0], layer as f32 + place[1]];
        let span = ((3.0 * around).ceil() as i32).min(grid.around as i32 / 2);
        let mut shares = [(0_usize, 0.0_f32); 64];
        let mut used = 0;
        let mut total = 0.0;
        for step in -span..=span {
            if used == shares.len() {
                break;
            }
            let k = sector as i32 + step;
            let share = between(at[0], around, k as f32);
            shares[used] = (k.rem_euclid(grid.around as i32) as usize, share);
            total += share;
            used += 1;
        }
        let radial: f32 = (0..grid.layers).map(|j| between(at[1], outward, j as f32)).sum();
        for j in 0..grid.layers {
            let share = between(at[1], outward, j as f32) / radial.max(1e-9);
            for &(k, around) in &shares[..used] {
                sums[j * grid.around + k].strands += crossing.taper * share * around / total.max(1e-9);
            }
        }
        let own = &mut sums[layer * grid.around + sector];
        own.places[0] += place[0] * crossing.taper;
        own.places[1] += place[1] * crossing.taper;
        own.weight += crossing.taper;
    }
}

/// The part of a gaussian around `middle` that lies between `from` and `from + 1`, by a logistic curve.
fn between(middle: f32, deviation: f32, from: f32) -> f32 {
    let below = |x: f32| 1.0 / (1.0 + (-1.702 * (x - middle) / deviation.max(1e-3)).exp());
    (below(from + 1.0) - below(from)).max(0.0)
}

/// How far strands move sideways from one section to the next, in radii of the section: the root of the mean square.
fn sideways(section: &Section, next: Option<&Section>, own: &mut Vec<Option<Vec2>>) -> f32 {
    let Some(next) = next else { return 0.0 };
    own.clear();
    for crossing in &section.crossings {
        own.resize(own.len().max(crossing.strand + 1), None);
        own[crossing.strand] = Some(crossing.at);
    }
    let moves = next.crossings.iter().filter_map(|c| Some((c.at - (*own.get(c.strand)?)?).length_squared()));
    let (sum, count) = moves.fold((0.0, 0_u32), |(sum, count), square| (sum + square, count + 1));
    (sum / count.max(1) as f32).sqrt()
}

/// Gives the cells of a rib one pattern as long as their strands stay the same: the sector in the middle of the rib. Straight strands
/// keep their places in the disk, and patterns that change from section to section would look like cuts across the hair.
fn hold_patterns(cells: &mut [Cell], grid: RibGrid) {
    let points = grid.points();
    for rib in cells.chunks_mut(points) {
        let most = rib.iter().copied().max_by(|a, b| a.strands().total_cmp(&b.strands())).unwrap_or_default();
        for cell in rib {
            *cell = most.with_strands(cell.strands());
        }
    }
}

/// The width of a stored strand toward the eye, metres: hair of this look, divided among `strands`.
pub fn strand_width(look: &HairLook, strands: usize) -> f32 {
    look.diameter * look.width_scale * look.real_hairs / strands.max(1) as f32
}
