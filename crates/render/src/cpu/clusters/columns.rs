//! Rasterises the layers of a column of hair shell volumes, and looks up what they let through and reflect.

use lovelock_satf::{
    Cell, ClusterHair, ClusterLighting, ClusterSettings, ClusterView, Database, LocalShadow, RecordLookup,
};

use super::vertices::{Vertex, corners};
use crate::cpu::hair::list::{Fragment, Fragments, covered_samples};
use crate::cpu::math::{exp, exp2, log2, max, min, mix, pow, saturate, three};
use crate::cpu::surface::raster::{SAMPLES, SurfaceSamples};
use crate::cpu::tile::{STRIDE, TILE};

/// Fragments of a smaller opacity are left out.
const FAINTEST: f32 = 1.0 / 1024.0;
/// Sine of the angle between eye and hair below which the azimuth of the eye is not defined well: five degrees.
const ALONG_HAIR: f32 = 0.087;

/// The columns of a tile.
pub(super) struct Columns<'a> {
    pub hair: &'a ClusterHair,
    pub database: &'a Database,
    pub vertices: &'a [Vertex],
    pub settings: &'a ClusterSettings,
    /// Optical depth of a strand times the length of the arc that it lies in, metres.
    pub depth: f32,
    pub origin: [f32; 2],
    pub samples: &'a SurfaceSamples,
}

/// One layer of a column: a quadrilateral between two ribs and two sections.
struct Layer {
    /// Pixels from the corner of the tile, and depths.
    corners: [[f32; 3]; 4],
    colors: [[f32; 3]; 4],
    /// Boundary sectors at both sections, of the layer and of its neighbours to both sides: `[side][section]`.
    cells: [[Cell; 2]; 3],
    /// Optical depth of one strand at both sections.
    depths: [f32; 2],
    /// Thickness of the layer as a fraction of its radius.
    thickness: f32,
    /// One over the mean reflectance in the middle; 1 where light is as published.
    inverse_mean: f32,
}

/// A place on the outer surface of a layer.
#[derive(Clone, Copy)]
struct Place {
    /// From rib to rib and from section to section, 0 to 1.
    u: f32,
    t: f32,
    angles: [f32; 2],
    cos_view: f32,
    sin_view: f32,
    mip: f32,
}

impl Columns<'_> {
    /// Adds the fragments of all layers of a column.
    pub fn draw(&self, column: usize, out: &mut Fragments) {
        let grid = self.hair.grid;
        let corners = corners(grid, column).map(|v| &self.vertices[v]);
        let [a, b, c, d] = corners;
        let angles = [0, 1].map(|k| unwrapped(corners.map(|v| v.angles[k])));
        for index in 0..grid.layers {
            let layer = self.layer(column, index, corners, angles);
            let width = 0.5
                * (distance(layer.corners[0], layer.corners[1])
                    + distance(layer.corners[2], layer.corners[3]));
            // Texels in a pixel.
            let mip = log2(max(32.0 / max(width, 1e-3), 1.0));
            for (triangle, parameters) in TRIANGLES {
                let points = triangle.map(|k| layer.corners[k]);
                self.each_pixel(points, out, |weights, covered, at, out| {
                    let mixed = |of: [f32; 3]| weights[0] * of[0] + weights[1] * of[1] + weights[2] * of[2];
                    let (u, t) = (mixed(parameters.map(|p| p[0])), mixed(parameters.map(|p| p[1])));
                    let (u, t) = (saturate(u), saturate(t));
                    let bilinear = |of: [f32; 4]| mix(mix(of[0], of[1], u), mix(of[2], of[3], u), t);
                    let place = Place {
                        u,
                        t,
                        angles: angles.map(bilinear),
                        cos_view: bilinear([a.cos_view, b.cos_view, c.cos_view, d.cos_view]),
                        sin_view: bilinear([a.sin_view, b.sin_view, c.sin_view, d.sin_view]),
                        mip,
                    };
                    let (alpha, reflected) = self.look_up(&layer, place);
                    if alpha < FAINTEST {
                        return;
                    }
                    let gain = match self.settings.lighting {
                        ClusterLighting::AsStrands => {
                            1.0 + self.settings.detail * (reflected * layer.inverse_mean - 1.0)
                        }
                        ClusterLighting::Paper => reflected,
                    };
                    let gain = max(gain, 0.0) * self.own_shadow(column, index, (corners, angles), place);
                    let color = match self.settings.view {
                        ClusterView::Hair => {
                            three(|k| bilinear([0, 1, 2, 3].map(|q| layer.colors[q][k])) * gain)
                        }
                        ClusterView::Records => record_color(layer.cells[1][usize::from(t > 0.5)]),
                    };
                    let depth = mixed(points.map(|p| p[2]));
                    let pixel =
                        [(at % STRIDE) as f32 + self.origin[0], (at / STRIDE) as f32 + self.origin[1]];
                    let hash = (column * grid.layers + index) as f32 * 0.618_034;
                    let opaque = covered_samples(alpha, pixel, hash - hash.floor());
                    out.push(at, Fragment { depth, alpha, color, seen: covered, covered: opaque });
                });
            }
        }
    }

    /// The layer `index` of a column.
    fn layer(&self, column: usize, index: usize, corners: [&Vertex; 4], angles: [[f32; 4]; 2]) -> Layer {
        let grid = self.hair.grid;
        let (rib, i) = (column / grid.along, column % grid.along);
        let (cluster, rib) = (rib / grid.around, rib % grid.around);
        let outward = grid.outward(index);
        let radius = grid.radius(index, self.hair.core);
        let [a, b, c, d] = corners;
        let arc = [a, c].map(|v| self.depth * v.inverse_arc / radius);
        let cell = |side: usize, section: usize| {
            self.hair.cell(cluster, index, (rib + side + grid.around - 1) % grid.around, i + section)
        };
        let cells = [0, 1, 2].map(|side| [cell(side, 0), cell(side, 1)]);
        let inverse_mean = match self.settings.lighting {
            ClusterLighting::AsStrands => {
                let middle = angles.map(|of| 0.25 * (of[0] + of[1] + of[2] + of[3]));
                1.0 / max(self.database.mean_reflectance(cells[1][0].sector(1.0), middle), 0.02)
            }
            ClusterLighting::Paper => 1.0,
        };
        Layer {
            corners: [a, b, c, d].map(|v| {
                let [x, y, z] = three(|k| mix(v.at[0][k], v.at[1][k], outward));
                [x - self.origin[0], y - self.origin[1], z]
            }),
            colors: [a, b, c, d].map(|v| three(|k| mix(v.color[0][k], v.color[1][k], outward))),
            cells,
            depths: arc,
            thickness: (1.0 - self.hair.core) / (grid.layers as f32 * radius),
            inverse_mean,
        }
    }

    /// Opacity and reflectance of a layer, between both of its boundary sectors and, near their ribs, the neighbouring ones.
    fn look_up(&self, layer: &Layer, place: Place) -> (f32, f32) {
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
    fn own_shadow(
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

    /// Calls `visit` for each pixel of the tile of which a triangle covers samples that the body does not hide: with the barycentric
    /// coordinates of its middle, those samples, and its index in the tile.
    fn each_pixel(
        &self,
        [a, b, c]: [[f32; 3]; 3],
        out: &mut Fragments,
        mut visit: impl FnMut([f32; 3], u32, usize, &mut Fragments),
    ) {
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let tile = TILE as f32;
        let low = |k: usize| max(min(min(a[k], b[k]), c[k]), 0.0);
        let high = |k: usize| min(max(max(a[k], b[k]), c[k]), tile - 1.0);
        let (left, top, right, bottom) = (low(0), low(1), high(0), high(1));
        if !(left <= right && top <= bottom) {
            return;
        }
        // Edges in one direction, so that the neighbour on the other side of an edge finds the opposite sign.
        let edge = |p: [f32; 3], q: [f32; 3]| {
            let (dx, dy) = ((q[0] - p[0]) / area, (q[1] - p[1]) / area);
            move |x: f32, y: f32| dx * (y - p[1]) - dy * (x - p[0])
        };
        let edges = (edge(b, c), edge(c, a), edge(a, b));
        for y in top as usize..=bottom as usize {
            for x in left as usize..=right as usize {
                let weights = |x: f32, y: f32| [edges.0(x, y), edges.1(x, y), edges.2(x, y)];
                let mut covered = 0;
                for (s, [sx, sy]) in SAMPLES.into_iter().enumerate() {
                    let inside = weights(x as f32 + sx, y as f32 + sy).iter().all(|&w| w >= 0.0);
                    covered |= u32::from(inside) << s;
                }
                if covered == 0 {
                    continue;
                }
                let middle = weights(x as f32 + 0.5, y as f32 + 0.5).map(|w| max(w, 0.0));
                let inverse = 1.0 / (middle[0] + middle[1] + middle[2]);
                let middle = middle.map(|w| w * inverse);
                let depth = middle[0] * a[2] + middle[1] * b[2] + middle[2] * c[2];
                let at = y * STRIDE + x;
                for (s, body) in self.samples.depths(at).into_iter().enumerate() {
                    covered &= !(u32::from(depth < body) << s);
                }
                if covered != 0 {
                    visit(middle, covered, at, out);
                }
            }
        }
    }
}

/// The two triangles of a quadrilateral: its corners, and where they lie between ribs and sections.
const TRIANGLES: [([usize; 3], [[f32; 2]; 3]); 2] =
    [([0, 1, 3], [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), ([0, 3, 2], [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]])];

/// Angles that are less than half a turn from the first one.
fn unwrapped(angles: [f32; 4]) -> [f32; 4] {
    let turn = std::f32::consts::TAU;
    angles.map(|angle| angle - turn * ((angle - angles[0]) / turn).round())
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

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    ((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1])).sqrt()
}

/// A colour for a record: hues for patterns, brighter for denser ones.
fn record_color(cell: Cell) -> [f32; 3] {
    let index = cell.0 & 0x7fff;
    let hue = (index / 16) as f32 * 0.618_034;
    let bright = 0.15 + 0.85 * (index % 16) as f32 / 15.0;
    three(|k| {
        let wave = (hue + k as f32 / 3.0).fract();
        bright * (0.5 + 0.5 * (wave * std::f32::consts::TAU).cos())
    })
}
