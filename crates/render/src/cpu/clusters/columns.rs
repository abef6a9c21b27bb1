//! Draws columns of hair shell volumes, layer by layer.

use lovelock_satf::{Cell, ClusterHair, ClusterLighting, ClusterSettings, ClusterView, Database};

use super::pixels::each_pixel;
use super::records::{Layer, Place};
use super::sink::Sink;
use super::vertices::{Vertex, corners};
use crate::cpu::hair::list::{Fragment, covered_samples};
use crate::cpu::math::{log2, max, mix, saturate, three};
use crate::cpu::surface::raster::SurfaceSamples;
use crate::cpu::tile::STRIDE;

/// Fragments of a smaller opacity are left out.
const FAINTEST: f32 = 1.0 / 1024.0;

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

impl Columns<'_> {
    /// The layers of `columns` from near to far, as `column * layers + layer` in the low half.
    pub fn sort(&self, columns: &[u32], order: &mut Vec<u64>) {
        let grid = self.hair.grid;
        order.clear();
        for &column in columns {
            let corners = corners(grid, column as usize).map(|v| &self.vertices[v]);
            let [inner, outer] = [0, 1].map(|ring| corners.iter().map(|v| v.at[ring][2]).sum::<f32>());
            for layer in 0..grid.layers {
                // Depths are positive, so their bits rise with them.
                let depth = max(mix(inner, outer, grid.outward(layer)), 0.0);
                let key = u64::from(u32::MAX - depth.to_bits()) << 32;
                order.push(key | u64::from(column * grid.layers as u32 + layer as u32));
            }
        }
        order.sort_unstable();
    }

    /// Passes the fragments of a layer of a column to `sink`.
    pub fn draw<S: Sink>(&self, column: usize, index: usize, sink: &mut S) {
        let grid = self.hair.grid;
        let corners = corners(grid, column).map(|v| &self.vertices[v]);
        let [a, b, c, d] = corners;
        let angles = [0, 1].map(|k| unwrapped(corners.map(|v| v.angles[k])));
        {
            let layer = self.layer(column, index, corners, angles);
            let width = 0.5
                * (distance(layer.corners[0], layer.corners[1])
                    + distance(layer.corners[2], layer.corners[3]));
            // Texels in a pixel.
            let mip = log2(max(32.0 / max(width, 1e-3), 1.0));
            for (triangle, parameters) in TRIANGLES {
                let points = triangle.map(|k| layer.corners[k]);
                each_pixel(points, self.samples, sink, |weights, covered, at, sink| {
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
                    sink.take(at, Fragment { depth, alpha, color, seen: covered, covered: opaque });
                });
            }
        }
    }

    /// The layer `index` of a column.
    pub(super) fn layer(
        &self,
        column: usize,
        index: usize,
        corners: [&Vertex; 4],
        angles: [[f32; 4]; 2],
    ) -> Layer {
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
}

/// The two triangles of a quadrilateral: its corners, and where they lie between ribs and sections.
const TRIANGLES: [([usize; 3], [[f32; 2]; 3]); 2] =
    [([0, 1, 3], [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), ([0, 3, 2], [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]])];

/// Angles that are less than half a turn from the first one.
fn unwrapped(angles: [f32; 4]) -> [f32; 4] {
    let turn = std::f32::consts::TAU;
    angles.map(|angle| angle - turn * ((angle - angles[0]) / turn).round())
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
