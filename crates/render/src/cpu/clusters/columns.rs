//! Draws columns of hair shell volumes, layer by layer.

// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use std::f32::consts::TAU;

use glam::Vec2;
use lovelock_base::simd::Width;
use lovelock_base::simd_versions;
use lovelock_satf::{
    Cell, ClusterHair, ClusterSettings, ClusterShading, ClusterView, Database, LocalShadow, shadow,
};

use super::pixels::{Covered, LANES, Triangle, cover_simd};
use super::records::{Angles, Layer, Map, bilinear};
use super::sink::Sink;
use super::vertices::{Vertex, corners};
use crate::MAX_LIGHTS;
use crate::cpu::hair::list::{Fragment, covered_samples};
use crate::cpu::math::{log2, max, mix, three};
use crate::cpu::strand_points::PARTS;
use crate::cpu::surface::raster::SurfaceSamples;
use crate::cpu::tile::STRIDE;

/// Fragments of a smaller opacity are left out.
const FAINTEST: f32 = 1.0 / 1024.0;

/// The columns of a tile.
pub(super) struct Columns<'a> {
    pub width: Width,
    pub hair: &'a ClusterHair,
    pub database: &'a Database,
    pub vertices: &'a [Vertex],
    pub settings: &'a ClusterSettings,
    /// Lights that are on.
    pub lights: usize,
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

    /// Passes the fragments of a layer of a column to `sink`. `covered` is working space.
    pub fn draw<S: Sink>(&self, column: usize, index: usize, covered: &mut Covered, sink: &mut S) {
        let grid = self.hair.grid;
        let corners = corners(grid, column).map(|v| &self.vertices[v]);
        let layer = self.layer(column, index, corners);
        covered.len = 0;
        for (triangle, places) in TRIANGLES {
            let triangle = Triangle { corners: triangle.map(|k| layer.corners[k]), places };
            cover_simd(self.width, &triangle, self.samples, sink, covered);
        }
        // Most layers are behind others.
        if covered.len == 0 {
            return;
        }
        let angles = angles_of(corners);
        let map = |layer: &Layer, angles: &Angles, lights: usize| {
            let [a, b, c, d] = layer.corners;
            let width = 0.5 * (distance(a, b) + distance(c, d));
            // As many texels as pixels.
            let mip = log2(max(32.0 / max(width, 1e-3), 1.0));
            Map::new(self.database, self.settings, layer, (angles, lights), mip)
        };
        let shadowing = |(column, index, passed): (usize, usize, Option<Passed>)| {
            let corners = self::corners(grid, column).map(|v| &self.vertices[v]);
            let layer = self.layer(column, index, corners);
            let angles = angles_of(corners);
            let angles = passed.map_or(angles, |passed| angles.of_light(passed.light));
            // Only what they let through counts.
            let map = map(&layer, &angles, 0);
            OuterLayer { layer, map, angles, passed }
        };
        let outer = self.toward_lights(column, index, &angles).into_iter().map(shadowing).collect();
        let map = map(&layer, &angles, self.lights);
        let own = OwnLayer { layer, map, angles, outer, quad: column * grid.layers + index };
        shade_simd(self.width, self, &own, covered, sink);
    }

    /// The layers that shadow a layer: their columns, their numbers, and the passing light if it is not there where the eye sees the
    /// shadowed place.
    fn toward_lights(
        &self,
        column: usize,
        index: usize,
        angles: &Angles,
    ) -> Vec<(usize, usize, Option<Passed>)> {
        let grid = self.hair.grid;
        let outer = (index + 1..grid.layers).map(|outer| (column, outer, None));
        match self.settings.local_shadow {
            LocalShadow::Map => Vec::new(),
            LocalShadow::Layers | LocalShadow::Linear | LocalShadow::Exponential => outer.collect(),
            LocalShadow::Directional => {
                let (rib, section) = (column / grid.along, column % grid.along);
                let first = rib / grid.around * grid.around;
                let sector = TAU / grid.around as f32;
                let here = (rib - first) as f32 * sector + 0.5 * sector;
                let radii: Vec<f32> =
                    (0..grid.layers).map(|layer| grid.radius(layer, self.hair.core)).collect();
                let mut met = Vec::new();
                for light in 0..self.lights {
                    let toward = Vec2::from_angle(here + angles.light_in_middle(light));
                    shadow::crossings(&radii, index, here, toward, |crossing| {
                        let at = crossing.u / sector;
                        let rib = first + at as usize % grid.around;
                        let passed = Passed { light, u: at.fract() };
                        met.push((rib * grid.along + section, crossing.layer, Some(passed)));
                    });
                }
                met
            }
        }
    }

    /// The fraction of a light that other layers let through to a place on a layer (Xu et al., equation 12). If light passes elsewhere
    /// than where the eye sees that place, it is that of light `light`.
    fn own_shadow(&self, between: &[OuterLayer], light: usize, [u, t]: [f32; 2]) -> f32 {
        let of_light = |outer: &&OuterLayer| outer.passed.is_none_or(|passed| passed.light == light);
        let opacities = between.iter().filter(of_light).map(|outer| {
            let OuterLayer { layer, map, angles, passed } = outer;
            let u = passed.map_or(u, |passed| passed.u);
            let ([opacity], _) = map.at(layer, [&[u], &[t]], &[bilinear(angles.cos_view, u, t)]);
            opacity
        });
        shadow::transmittance(self.settings.local_shadow, self.settings.shadow_strength, opacities)
    }

    /// The fractions of all lights that other layers let through to a place on a layer.
    fn own_shadows(&self, between: &[OuterLayer], place: [f32; 2]) -> [f32; MAX_LIGHTS] {
        let mut through = [1.0; MAX_LIGHTS];
        if self.settings.local_shadow == LocalShadow::Directional {
            for (light, through) in through.iter_mut().enumerate().take(self.lights) {
                *through = self.own_shadow(between, light, place);
            }
        } else if !between.is_empty() {
            through = [self.own_shadow(between, 0, place); MAX_LIGHTS];
        }
        through
    }

    /// The layer `index` of a column.
    fn layer(&self, column: usize, index: usize, corners: [&Vertex; 4]) -> Layer {
        let grid = self.hair.grid;
        let (rib, i) = (column / grid.along, column % grid.along);
        let (cluster, rib) = (rib / grid.around, rib % grid.around);
        let outward = grid.outward(index);
        let radius = grid.radius(index, self.hair.core);
        let [a, b, c, d] = corners;
        let middle = grid.middle_radius(index, self.hair.core);
        let arc = [a, c].map(|v| self.depth * v.inverse_arc / middle);
        let cell = |side: usize, section: usize| {
            self.hair.cell(cluster, index, (rib + side + grid.around - 1) % grid.around, i + section)
        };
        Layer {
            corners: [a, b, c, d].map(|v| {
                let [x, y, z] = three(|k| mix(v.at[0][k], v.at[1][k], outward));
                [x - self.origin[0], y - self.origin[1], z]
            }),
            lit: [a, b, c, d].map(|v| {
                let [inner, outer] = &v.lit;
                std::array::from_fn(|part| three(|k| mix(inner[part][k], outer[part][k], outward)))
            }),
            cells: [0, 1, 2].map(|side| [cell(side, 0), cell(side, 1)]),
            depths: arc,
            thickness: (1.0 - self.hair.core) / (grid.layers as f32 * radius),
        }
    }
}

/// Where a light passes across a layer.
#[derive(Clone, Copy)]
struct Passed {
    light: usize,
    u: f32,
}

/// A layer that shadows another one. What it lets through does not depend on light unless a light passes elsewhere than where the eye sees
/// the shadowed place.
struct OuterLayer {
    layer: Layer,
    map: Map,
    angles: Angles,
    passed: Option<Passed>,
}

/// A layer whose pixels are shaded.
struct OwnLayer {
    layer: Layer,
    map: Map,
    angles: Angles,
    outer: Vec<OuterLayer>,
    quad: usize,
}

simd_versions! {
    /// [`shade`] for the vectors of `width`.
    fn shade_simd<S: Sink>(columns: &Columns, own: &OwnLayer, covered: &Covered, sink: &mut S) -> () {
        shade(columns, own, covered, sink)
    }
}

/// Passes the fragments of a layer to `sink`.
#[inline(always)]
fn shade<S: Sink>(columns: &Columns, own: &OwnLayer, covered: &Covered, sink: &mut S) {
    let OwnLayer { layer, map, angles, .. } = own;
    let hash = own.quad as f32 * 0.618_034;
    let hash = hash - hash.floor();
    // The part of a light that does not depend on the reflectance, and the factor of the reflectance.
    let detail = columns.settings.detail;
    let (even, slopes) = match columns.settings.shading {
        ClusterShading::AsStrands => (1.0 - detail, map.inverse_mean.map(|inverse| detail * inverse)),
        ClusterShading::Paper => (0.0, [1.0; MAX_LIGHTS]),
    };
    let lights = columns.lights.min(MAX_LIGHTS);
    let channels: [_; PARTS] =
        std::array::from_fn(|part| [0, 1, 2].map(|k| [0, 1, 2, 3].map(|q| layer.lit[q][part][k])));
    for first in (0..covered.len).step_by(LANES) {
        let of = |values: &'_ [f32]| values[first..].first_chunk::<LANES>().copied().unwrap_or([0.0; LANES]);
        let (u, t) = (of(&covered.u), of(&covered.t));
        let mut cos_view = [0.0; LANES];
        for lane in 0..LANES {
            cos_view[lane] = bilinear(angles.cos_view, u[lane], t[lane]);
        }
        let (alpha, reflected) = map.at(layer, [&u, &t], &cos_view);
        // Ambient light, which no record reflects and no layer shadows, and what records reflect of each light.
        let mut colors = [[[0.0; 3]; LANES]; PARTS];
        for lane in 0..LANES {
            colors[0][lane] = three(|k| bilinear(channels[0][k], u[lane], t[lane]));
        }
        for light in 0..lights {
            for lane in 0..LANES {
                let gain = max(even + slopes[light] * reflected[light][lane], 0.0);
                let channels = &channels[1 + light];
                colors[1 + light][lane] = three(|k| bilinear(channels[k], u[lane], t[lane]) * gain);
            }
        }
        for lane in 0..LANES.min(covered.len - first) {
            let n = first + lane;
            let (alpha, at) = (alpha[lane], covered.at[n] as usize);
            if alpha < FAINTEST || alpha.is_nan() {
                continue;
            }
            let through = columns.own_shadows(&own.outer, [u[lane], t[lane]]);
            let mut color = colors[0][lane];
            for (light, through) in through.iter().enumerate().take(lights) {
                for k in 0..3 {
                    color[k] += colors[1 + light][lane][k] * through;
                }
            }
            if columns.settings.view == ClusterView::Records {
                color = record_color(layer.cells[1][usize::from(t[lane] > 0.5)]);
            }
            let opaque = if S::TAKES_SAMPLES {
                let [x, y] = columns.origin;
                covered_samples(alpha, [(at % STRIDE) as f32 + x, (at / STRIDE) as f32 + y], hash)
            } else {
                0
            };
            let (depth, seen) = (covered.depth[n], covered.samples[n]);
            sink.take(at, Fragment { depth, alpha, color, seen, covered: opaque });
        }
    }
}

/// The two triangles of a quadrilateral: its corners, and where they lie between ribs and sections.
const TRIANGLES: [([usize; 3], [[f32; 2]; 3]); 2] =
    [([0, 1, 3], [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), ([0, 3, 2], [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]])];

/// The angles at the corners of the layers of a column.
fn angles_of(corners: [&Vertex; 4]) -> Angles {
    Angles {
        view: unwrapped(corners.map(|v| v.angles[0])),
        lights: std::array::from_fn(|light| unwrapped(corners.map(|v| v.angles[1 + light]))),
        cos_view: corners.map(|v| v.cos_view),
        sin_view: 0.25 * corners.iter().map(|v| v.sin_view).sum::<f32>(),
    }
}

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
