//! What the layers of a column let through and reflect, from the records of the database.

use lovelock_satf::{Cell, LocalShadow, RecordLookup, SectorRef};

use super::columns::Columns;
use super::vertices::Vertex;
use crate::cpu::math::{exp, exp2, log2, max, min, mix, pow};

/// Sine of the angle between eye and hair below which the azimuth of the eye is not defined well: five degrees.
const ALONG_HAIR: f32 = 0.087;

/// One layer of a column: a quadrilateral between two ribs and two sections.
pub(super) struct Layer {
    /// Pixels from the corner of the tile, and depths.
    pub corners: [[f32; 3]; 4],
    pub colors: [[f32; 3]; 4],
    /// Boundary sectors at both sections, of the layer and of its neighbours to both sides: `[side][section]`.
    pub cells: [[Cell; 2]; 3],
    /// Optical depth of one strand at both sections.
    pub depths: [f32; 2],
    /// Thickness of the layer as a fraction of its radius.
    pub thickness: f32,
    /// One over the mean reflectance in the middle; 1 where light is as published.
    pub inverse_mean: f32,
}

/// A place on the outer surface of a layer.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// From rib to rib and from section to section, 0 to 1.
    pub u: f32,
    pub t: f32,
    pub angles: [f32; 2],
    pub cos_view: f32,
    pub sin_view: f32,
    pub mip: f32,
}

impl Columns<'_> {
    /// Opacity and reflectance of a layer, between both of its boundary sectors and, near their ribs, the neighbouring ones.
    pub(super) fn look_up(&self, layer: &Layer, place: Place) -> (f32, f32) {
        let own = self.between_sections(layer, 1, place);
        // Sectors with different records are blended over two texels.
        let blended = min(0.5, exp2(place.mip) / 32.0);
        let (side, distance) = if place.u < 0.5 { (0, place.u) } else { (2, 1.0 - place.u) };
        if distance >= blended || self.settings.lookup == RecordLookup::Nearest {
            return own;
        }
        let other = self.between_sections(layer, side, place);
        let share = 0.5 * (1.0 - distance / blended);
        (mix(own.0, other.0, share), mix(own.1, other.1, share))
    }

    /// Opacity and reflectance between the two boundary sectors (Xu et al., equation 7).
    fn between_sections(&self, layer: &Layer, side: usize, place: Place) -> (f32, f32) {
        let [low, high] = layer.cells[side];
        let curved = curved(place.cos_view, layer.thickness);
        let depths = [low.strands() * layer.depths[0] * curved, high.strands() * layer.depths[1] * curved];
        if low.0 & 0xffff == high.0 & 0xffff {
            return self.record(low, mix(depths[0], depths[1], place.t), place);
        }
        let (a, b) = (self.record(low, depths[0], place), self.record(high, depths[1], place));
        (mix(a.0, b.0, place.t), mix(a.1, b.1, place.t))
    }

    /// Opacity and reflectance of a record.
    fn record(&self, cell: Cell, depth: f32, place: Place) -> (f32, f32) {
        let of = cell.sector(depth);
        if of.tau_ratio <= 0.0 {
            return (0.0, 1.0);
        }
        let Place { angles, u, mip, .. } = place;
        let (stored, mut reflected) = match self.settings.lookup {
            RecordLookup::Interpolated => self.database.sample_stored(of, angles, u, mip),
            RecordLookup::Nearest => {
                self.database.sample_nearest(SectorRef { tau_ratio: 1.0, ..of }, angles, u, mip)
            }
        };
        let mut alpha = 1.0 - pow(1.0 - stored, of.tau_ratio);
        if place.sin_view < ALONG_HAIR {
            let any = self.database.sample_any_view(of, angles[1], u, mip);
            let share = place.sin_view / ALONG_HAIR;
            (alpha, reflected) = (mix(any.0, alpha, share), mix(any.1, reflected, share));
        }
        (alpha, reflected)
    }

    /// The light that outer layers let through to a place on layer `index` (Xu et al., equation 12).
    pub(super) fn own_shadow(
        &self,
        column: usize,
        index: usize,
        (corners, angles): ([&Vertex; 4], [[f32; 4]; 2]),
        place: Place,
    ) -> f32 {
        let strength = self.settings.shadow_strength;
        let outer = |f: &dyn Fn(f32) -> f32, place: Place| -> f32 {
            (index + 1..self.hair.grid.layers)
                .map(|outer| f(self.look_up(&self.layer(column, outer, corners, angles), place).0))
                .sum()
        };
        let depth_of = |alpha: f32| -log2(max(1.0 - alpha, 1e-4)) * std::f32::consts::LN_2;
        match self.settings.local_shadow {
            LocalShadow::Map => 1.0,
            LocalShadow::Layers => exp(-strength * outer(&depth_of, place)),
            LocalShadow::Linear => max(1.0 - strength * outer(&|alpha| alpha, place), 0.0),
            LocalShadow::Directional => {
                let toward = Place { angles: [place.angles[1]; 2], cos_view: 1.0, sin_view: 1.0, ..place };
                exp(-strength * outer(&depth_of, toward))
            }
        }
    }
}

/// The way of a ray, whose azimuth has the cosine `cos`, through a layer as a fraction of that through a flat one of the same thickness, `thickness` being relative to the
/// radius. Near the silhouette a ray leaves the layer through the surface by which it came in; half of that way belongs to each of the
/// two faces.
fn curved(cos: f32, thickness: f32) -> f32 {
    let cos = min(cos.abs(), 1.0);
    let inner = (1.0 - thickness) * (1.0 - thickness) - (1.0 - cos * cos);
    let way = if inner > 0.0 { cos - inner.sqrt() } else { cos };
    way * max(cos, 1.0 / 6.0) / max(thickness, 1e-3)
}
