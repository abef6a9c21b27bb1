//! Ribs: the lines along a cluster on which its layers are drawn.
//!
//! A place of the disk that is constant in `t` has constant weights of the three guides: with `M(t)` the map from the reference
//! triangle to the guides (see [`crate::disk`]), `P(t) = T + M(t) d = sum(w_g g(t))` with `w_g = 1/3 + 2/3 d . r_g`. The layers of a
//! cluster are therefore spanned by strands of a hairstyle of their own, which is interpolated, shadowed and lit as any other. What
//! the strands of the wisp do beside their guides (curl, frizz, clumping) widens or moves the ellipse, which the ribs' offsets hold.
//!
//! There are two rings of ribs, on the surface of the core and on that of the cluster. `P` is linear in the radius, so every layer lies
//! between them in fixed proportions.

use std::sync::Arc;

use glam::Vec2;
use lovelock_groom::{Hairstyle, StrandSet, Wisp, WispCurve};

use crate::section::{Section, weights_of};

/// How a cluster is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RibGrid {
    /// Layers from the core outward.
    pub layers: usize,
    /// Ribs, and hair shell volumes, around.
    pub around: usize,
    /// Hair shell volumes along; a rib has one point more.
    pub along: usize,
}

impl RibGrid {
    /// Points of a rib.
    pub fn points(&self) -> usize {
        self.along + 1
    }

    /// Points of the ribs of a cluster: those of the inner ring, rib after rib, then those of the outer one.
    pub fn rib_points(&self) -> usize {
        2 * self.around * self.points()
    }

    /// Boundary sectors of a cluster: layer after layer, in each of them rib after rib, from root to tip.
    pub fn cells(&self) -> usize {
        self.layers * self.around * self.points()
    }

    /// Hair shell volumes of a cluster.
    pub fn volumes(&self) -> usize {
        self.layers * self.around * self.along
    }

    /// The radius of the outer surface of a layer in the unit disk, for an empty core of radius `core`.
    pub fn radius(&self, layer: usize, core: f32) -> f32 {
        core + (1.0 - core) * self.outward(layer)
    }

    /// The radius in the middle of a layer, by which its density is measured: then the layers together block as much light as their
    /// strands do, whatever their number.
    pub fn middle_radius(&self, layer: usize, core: f32) -> f32 {
        core + (1.0 - core) * (layer as f32 + 0.5) / self.layers.max(1) as f32
    }

    /// Where the outer surface of a layer lies between the rings: 1 on the outer one.
    pub fn outward(&self, layer: usize) -> f32 {
        (layer + 1) as f32 / self.layers.max(1) as f32
    }

    /// The layer and the sector of a place of the unit disk, with the place inside of the sector, each 0 to 1. Places inside of the core
    /// are on the inner surface of the innermost layer, places outside of the disk on the outer surface.
    pub fn cell(&self, at: Vec2, core: f32) -> ([usize; 2], [f32; 2]) {
        let radial = ((at.length() - core) / (1.0 - core).max(1e-3)).clamp(0.0, 1.0) * self.layers as f32;
        let layer = (radial as usize).min(self.layers - 1);
        let turn = (at.y.atan2(at.x) / std::f32::consts::TAU).rem_euclid(1.0) * self.around as f32;
        let sector = (turn as usize).min(self.around - 1);
        ([layer, sector], [radial - layer as f32, (turn - sector as f32).clamp(0.0, 1.0)])
    }
}

/// The angle of a rib in the disk.
fn direction(rib: usize, around: usize) -> Vec2 {
    let angle = std::f32::consts::TAU * rib as f32 / around as f32;
    Vec2::new(angle.cos(), angle.sin())
}

/// A hairstyle of the ribs of all clusters, with the wisps and guides of `style`. `sections` holds those of each wisp; a wisp without any
/// has no ribs. `shade` gives the shade of a rib by its wisp and its number among the ribs of the wisp; its colours are those of the strand
/// nearest to it.
pub(crate) fn rib_style(
    style: &Hairstyle,
    sections: &[Vec<Section>],
    grid: RibGrid,
    core: f32,
    shade: impl Fn(usize, usize) -> f32,
) -> Arc<Hairstyle> {
    let mut set = StrandSet { first_point: vec![0], ..StrandSet::default() };
    let mut wisps = Vec::with_capacity(style.wisps.len());
    // One strand and not the mean of several: the light of mixed strands is the mean of theirs, which no mean of their pigment gives.
    let mut nearest = Vec::new();
    for (w, (wisp, sections)) in style.wisps.iter().zip(sections).enumerate() {
        let first_strand = set.wisp.len() as u32;
        let strand_count = if sections.is_empty() { 0 } else { 2 * grid.around as u32 };
        wisps.push(Wisp { guides: wisp.guides, first_strand, strand_count });
        if sections.is_empty() {
            continue;
        }
        let curve = WispCurve::at_rest(&style.guides, wisp);
        let first = wisp.first_strand as usize;
        for (ring, radius) in [core, 1.0].into_iter().enumerate() {
            for rib in 0..grid.around {
                let at = direction(rib, grid.around) * radius;
                let mean = sections.iter().map(|s| s.in_guides(at)).sum::<Vec2>() / sections.len() as f32;
                // Beyond the guides, offsets hold the rest: extrapolated weights would exaggerate how the wisp opens and closes.
                let weights = weights_of(mean.clamp_length_max(1.2));
                for section in sections {
                    let offset = curve.offset_to(weights, section.u, section.place(at));
                    set.guide_param.push(section.u);
                    set.offset_normal.push(offset.x);
                    set.offset_binormal.push(offset.y);
                    set.offset_tangent.push(offset.z);
                    set.taper.push(1.0);
                }
                set.wisp.push(w as u32);
                set.weights.push(weights);
                set.first_point.push(set.guide_param.len() as u32);
                set.shade.push(shade(w, ring * grid.around + rib));
                if !style.strands.colours.is_empty() {
                    nearest.push(first + nearest_strand(sections, at));
                }
            }
        }
    }
    set.colours = style.strands.colours.selected(nearest.into_iter());
    Arc::new(Hairstyle {
        name: style.name.clone(),
        wisps,
        guides: style.guides.clone(),
        widest: style.widest.clone(),
        strands: set,
        look: style.look,
        ..Hairstyle::default()
    })
}

/// The strand of a wisp, by its index there, that is nearest to a place of the disk.
fn nearest_strand(sections: &[Section], at: Vec2) -> usize {
    // Away from the root, where strands lie as they are seen.
    let section = &sections[sections.len() / 3];
    let apart = |place: Vec2| place.distance_squared(at);
    let nearest = section.crossings.iter().min_by(|a, b| apart(a.at).total_cmp(&apart(b.at)));
    nearest.map_or(0, |crossing| crossing.strand)
}
