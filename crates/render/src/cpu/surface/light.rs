//! Shading of the visible body in a tile.

use lovelock_base::memory::list_bytes;
use lovelock_base::simd::Width;
use lovelock_motion::{Body, Skin};

use super::edges::Edges;
use super::material_shading::MaterialBatch;
use super::materials::{Facet, PlacedMaterials};
use super::places::{Part, PartsIn, shade_parts_simd};
use super::raster::{NOTHING, SurfaceSamples};
use super::seeds::{SAME_SURFACE, Seeds};
use super::shading::{LANES, SurfaceBatch, shade_batch_simd};
use super::{Attributes, PlacedSurface};
use crate::cpu::tile::{HairPlanes, STRIDE, SurfacePlanes, TILE, UNSEEN};
use crate::cpu::view::View;

/// The positions of a tile that are collected for shading.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceLight {
    batch: SurfaceBatch,
    /// The last triangle, with its edges in this tile.
    last: Option<(u32, Edges)>,
    /// Those of a body with materials, and the triangles that they show.
    materials: MaterialBatch,
    parts: Vec<Part>,
    facets: Vec<Facet>,
    seeds: Seeds,
}

/// The body: its placement in the picture, and its mesh and surface.
type Surface<'a> = (&'a PlacedSurface, (&'a Body, &'a Skin));

/// What a pixel shows of one surface.
#[derive(Clone, Copy)]
struct Shown {
    triangle: u32,
    x: usize,
    y: usize,
    /// The fraction of the pixel.
    weight: f32,
    /// Depth of the surface if it fills the pixel, and 0 otherwise.
    depth: f32,
}

/// A tile whose body is shaded.
#[derive(Clone, Copy)]
struct TileIn<'a> {
    origin: [f32; 2],
    surface: Surface<'a>,
    samples: &'a SurfaceSamples,
    hair: &'a HairPlanes,
}

impl SurfaceLight {
    /// The memory beyond its own size, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.parts) + list_bytes(&self.facets)
    }

    /// Shades the visible body in a tile; `is_exact` finds the body's shadow at every pixel.
    #[expect(clippy::too_many_arguments, reason = "called once")]
    pub fn shade_tile(
        &mut self,
        width: Width,
        view: &View,
        origin: [f32; 2],
        surface: Surface,
        (samples, hair): (&SurfaceSamples, &HairPlanes),
        is_exact: bool,
        out: &mut SurfacePlanes,
    ) {
        self.seeds.is_exact = is_exact;
        let tile = TileIn { origin, surface, samples, hair };
        match &surface.0.materials {
            Some(materials) => self.shade_materials(width, view, (&tile, materials), out),
            None => self.shade_plain(width, view, &tile, out),
        }
    }

    /// Shades a body without materials.
    fn shade_plain(&mut self, width: Width, view: &View, tile: &TileIn, out: &mut SurfacePlanes) {
        (self.batch.count, self.last) = (0, None);
        for y in 0..TILE {
            for x in 0..TILE {
                tile.each_shown([x, y], out, |shown, out| {
                    self.push(tile, shown);
                    if self.batch.count == LANES {
                        self.flush(width, view, out);
                    }
                });
            }
        }
        if self.batch.count > 0 {
            self.flush(width, view, out);
        }
    }

    /// Shades a body with materials: first the places of [`Seeds`], then what is between them.
    fn shade_materials(
        &mut self,
        width: Width,
        view: &View,
        (tile, materials): (&TileIn, &PlacedMaterials),
        out: &mut SurfacePlanes,
    ) {
        self.facets.clear();
        self.seeds.clear();
        for are_places in [true, false] {
            self.parts.clear();
            for y in 0..TILE {
                for x in 0..TILE {
                    if Seeds::place(x, y).is_some() == are_places {
                        tile.each_shown([x, y], out, |shown, _| self.collect(tile, materials, shown));
                    }
                }
            }
            // By material, in the order of pixels: the index of a triangle's first part grows with them.
            self.parts.sort_unstable_by_key(|part| {
                (part.past_body.is_some(), part.material, part.pixel, part.facet)
            });
            let (body, _) = tile.surface.1;
            let is_alike = |a: &Part, b: &Part| {
                (a.past_body.is_some(), a.material) == (b.past_body.is_some(), b.material)
            };
            for parts in self.parts.chunk_by(is_alike).flat_map(|parts| parts.chunks(LANES)) {
                let input = PartsIn { surface: tile.surface.0, materials, body, facets: &self.facets, parts };
                shade_parts_simd(width, view, &input, &mut self.materials, out);
                for (lane, part) in parts.iter().enumerate().filter(|(_, part)| part.depth > 0.0) {
                    if let Some(place) = Seeds::place(part.x.into(), part.y.into()) {
                        self.seeds.put(place, part.depth, self.materials.past_body.map(|lit| lit[lane]));
                    }
                }
            }
        }
    }

    /// Adds a part of a pixel to the list.
    fn collect(&mut self, tile: &TileIn, materials: &PlacedMaterials, shown: Shown) {
        let Shown { triangle, x, y, weight, depth } = shown;
        if self.facets.last().is_none_or(|facet| facet.id != triangle) {
            let (placed, (body, skin)) = tile.surface;
            let corners = body.mesh.triangles[triangle as usize].map(|i| placed.vertices[i as usize]);
            let Some(facet) = materials.facet((body, skin), triangle, corners, tile.origin) else { return };
            self.facets.push(facet);
        }
        let facet = self.facets.len() - 1;
        let is_between = depth > 0.0 && Seeds::place(x, y).is_none();
        self.parts.push(Part {
            facet: facet as u32,
            material: self.facets[facet].material as u32,
            x: x as u16,
            y: y as u16,
            pixel: (y * STRIDE + x) as u32,
            weight,
            depth,
            past_body: if is_between { self.seeds.between(x, y, depth) } else { None },
        });
    }

    /// Adds the position on a triangle at the centre of a pixel to the batch.
    fn push(&mut self, tile: &TileIn, shown: Shown) {
        let Shown { triangle, x, y, weight, .. } = shown;
        let edges = match self.last {
            Some((id, edges)) if id == triangle => edges,
            _ => {
                let (placed, (body, _)) = tile.surface;
                let corners = body.mesh.triangles[triangle as usize].map(|i| placed.vertices[i as usize]);
                let Some(edges) = Edges::new(corners, tile.origin) else { return };
                self.last = Some((triangle, edges));
                edges
            }
        };
        let mixed = mixed(tile.surface, triangle, shares_at(&edges, [x as f32 + 0.5, y as f32 + 0.5]));
        let batch = &mut self.batch;
        let lane = batch.count;
        for axis in 0..3 {
            batch.position[axis][lane] = mixed[axis];
            batch.normal[axis][lane] = mixed[3 + axis];
            batch.albedo[axis][lane] = mixed[6 + axis];
        }
        batch.scalp[lane] = mixed[9];
        for (k, plane) in batch.hair.iter_mut().enumerate() {
            plane[lane] = mixed[10 + k];
        }
        (batch.pixel[lane], batch.weight[lane]) = (y * STRIDE + x, weight);
        batch.count += 1;
    }

    fn flush(&mut self, width: Width, view: &View, out: &mut SurfacePlanes) {
        shade_batch_simd(width, view, &mut self.batch);
        for lane in 0..self.batch.count {
            for (plane, color) in out.color.iter_mut().zip(&self.batch.color) {
                plane[self.batch.pixel[lane]] += self.batch.weight[lane] * color[lane];
            }
        }
        self.batch.count = 0;
    }
}

impl TileIn<'_> {
    /// Passes the surfaces that a pixel shows to `shade`, and sets the fraction that they cover.
    fn each_shown(
        &self,
        [x, y]: [usize; 2],
        out: &mut SurfacePlanes,
        mut shade: impl FnMut(Shown, &mut SurfacePlanes),
    ) {
        let at = y * STRIDE + x;
        if self.hair.through[at] <= UNSEEN {
            return;
        }
        let (ids, depths) = (self.samples.triangles(at), self.samples.depths(at));
        if ids == [ids[0]; 4] {
            if ids[0] != NOTHING {
                out.cover[at] = 1.0;
                shade(Shown { triangle: ids[0], x, y, weight: 1.0, depth: depths[0] }, out);
            }
            return;
        }
        let mut left = ids.map(|id| id != NOTHING);
        out.cover[at] = 0.25 * left.iter().filter(|left| **left).count() as f32;
        for s in 0..4 {
            if !left[s] {
                continue;
            }
            let mut weight = 0.0;
            for other in s..4 {
                let same = ids[other] == ids[s]
                    || ((depths[other] - depths[s]).abs() <= SAME_SURFACE * depths[s]
                        && have_one_material(self.surface, ids[other], ids[s]));
                if left[other] && same {
                    left[other] = false;
                    weight += 0.25;
                }
            }
            let depth = if weight == 1.0 { depths[s] } else { 0.0 };
            shade(Shown { triangle: ids[s], x, y, weight, depth }, out);
        }
    }
}

/// Whether two triangles have one material, as all of a body without materials.
fn have_one_material((placed, (body, _)): Surface, a: u32, b: u32) -> bool {
    let of = |materials: &PlacedMaterials| materials.of_triangle(body, a) == materials.of_triangle(body, b);
    placed.materials.as_ref().is_none_or(of)
}

/// The barycentric coordinates at a place of the tile. It may lie beside a triangle that covers some samples of its pixel. Colours are
/// not extrapolated there: across a narrow triangle between two materials they change too fast.
fn shares_at(edges: &Edges, [x, y]: [f32; 2]) -> [f32; 3] {
    let shares = edges.shares(x, y).map(|share| share.max(0.0));
    let sum = shares[0] + shares[1] + shares[2];
    shares.map(|share| share / sum.max(1e-6))
}

fn mixed((placed, (body, _)): Surface, triangle: u32, shares: [f32; 3]) -> Attributes {
    let [a, b, c] = body.mesh.triangles[triangle as usize].map(|i| &placed.attributes[i as usize]);
    std::array::from_fn(|i| a[i] * shares[0] + b[i] * shares[1] + c[i] * shares[2])
}
