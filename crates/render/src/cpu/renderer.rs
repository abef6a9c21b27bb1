//! One picture from top to bottom, on the processor.

mod inspect;

use std::sync::{Mutex, PoisonError};

use glam::{Vec3, Vec4};
use lovelock_gpu::{PassTime, Stopwatch};
use lovelock_groom::Strands;
use lovelock_groom::simd::Width;
use lovelock_motion::{Body, Skin};
use rayon::prelude::*;

use super::backdrop::Ground;
use super::bins::Bins;
use super::body_depth::{self, DepthMap};
use super::dispatch;
use super::hair::blend::{BlendState, BlendTile};
use super::hair::list::{Fragments, ListTile};
use super::hair::order::SegmentKeys;
use super::hair::segment::{bounds, is_drawn};
use super::points::{PointsIn, ShadedPoint, shade_all};
use super::surface::PlacedSurface;
use super::surface::light::SurfaceLight;
use super::surface::raster::{Occlusion, SurfaceSamples, TriangleTile};
use super::tile::{Grid, HairPlanes, PixelsIn, SurfacePlanes, TILE, TILE_BYTES};
use super::transparency::resolve_tile;
use super::view::View;
use crate::closed::{Closedness, encloses};
use crate::light_view::{bounding_sphere, light_view};
use crate::picture::check_size;
use crate::shadow_stage::ShadowStage;
use crate::strand_details::StrandDetails;
use crate::uniform::{FrameUniform, LightMaps};
use crate::{FrameInput, FrameStats, MAX_LIGHTS, Picture, RenderError, Transparency};

/// Texels along each edge of the body's depth maps.
const DEPTH_TEXELS: u32 = body_depth::SIZE as u32;

/// Segments of a tile that are fetched and drawn together.
const SEGMENTS_AT_ONCE: usize = 128;

/// Draws pictures on the processor, and keeps what it needs for the next one.
#[derive(Debug)]
pub struct CpuRenderer {
    width: Width,
    strands: Strands,
    shadow: ShadowStage,
    details: StrandDetails,
    points: Vec<ShadedPoint>,
    keys: SegmentKeys,
    segment_bins: Bins,
    surface: PlacedSurface,
    closed: Closedness,
    depth: Vec<DepthMap>,
    tiles: Vec<u8>,
    plain: PlainTiles,
    scratch: Mutex<Vec<Box<Scratch>>>,
}

/// What a thread needs to draw a tile.
#[derive(Debug, Default)]
struct Scratch {
    samples: SurfaceSamples,
    hidden: Occlusion,
    blend: BlendState,
    hair: HairPlanes,
    surface: SurfacePlanes,
    light: SurfaceLight,
    order: Vec<u64>,
    segments: Vec<[ShadedPoint; 2]>,
    fragments: Fragments,
}

impl Default for CpuRenderer {
    fn default() -> Self {
        Self {
            width: Width::widest(),
            strands: Strands::default(),
            shadow: ShadowStage::default(),
            details: StrandDetails::default(),
            points: Vec::new(),
            keys: SegmentKeys::default(),
            segment_bins: Bins::default(),
            surface: PlacedSurface::default(),
            closed: Closedness::default(),
            depth: Vec::new(),
            tiles: Vec::new(),
            plain: PlainTiles::default(),
            scratch: Mutex::default(),
        }
    }
}

impl CpuRenderer {
    /// A renderer whose loops are compiled for `width`, which the processor must have: for tests of equality.
    ///
    /// # Panics
    /// Where the processor has no such vectors.
    pub fn with_width(width: Width) -> Self {
        assert!(width.is_available(), "{width:?} on a processor without");
        Self { width, ..Self::default() }
    }

    /// What draws, in words: the vectors that are used.
    pub fn adapter() -> String {
        let threads = rayon::current_num_threads();
        format!("processor ({:?}, {threads} threads)", Width::widest())
    }

    /// Draws `input` at `width` by `height` pixels.
    ///
    /// # Errors
    /// A size out of range, or a shadow that needs too much memory.
    pub fn picture(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        picture: &mut Picture,
    ) -> Result<FrameStats, RenderError> {
        check_size(width, height)?;
        let mut made = std::mem::take(&mut self.strands);
        let watch = Stopwatch::start();
        let strands = input.hair.strands(input.style, &mut made);
        let interpolate_ms = watch.ms();
        let stats = self.draw(input, strands, width, height, picture);
        self.strands = made;
        stats.map(|stats| FrameStats { interpolate_ms, ..stats })
    }

    fn draw(
        &mut self,
        input: &FrameInput,
        strands: &Strands,
        width: u32,
        height: u32,
        picture: &mut Picture,
    ) -> Result<FrameStats, RenderError> {
        let watch = Stopwatch::start();
        self.shadow.run(input, strands)?;
        let shadow_ms = watch.ms();

        let watch = Stopwatch::start();
        let mut passes = self.shadow.passes.clone();
        let mut passed = |name: &str, part: &Stopwatch| {
            passes.push(PassTime { name: name.to_owned(), ms: part.ms() });
        };
        let part = Stopwatch::start();
        let body = input.body.map(|(body, skin)| (&**body, skin));
        let closed = input.body.is_some_and(|(body, _)| self.closed.of(body));
        // From within, the faces that look away from the eye are those behind the wall.
        let seen_from_without = closed
            && body.is_some_and(|(body, skin)| {
                !encloses(input.camera.eye, &skin.positions, &body.mesh.triangles)
            });
        let maps = self.draw_depth(input, body, closed);
        let uniform = FrameUniform::new(input, width, height, &maps, DEPTH_TEXELS);
        let view = View::new(&uniform, &self.depth, &self.shadow.columns, DEPTH_TEXELS);
        passed("draw/body-depth", &part);

        let part = Stopwatch::start();
        self.details.follow(input.style);
        let points_in =
            PointsIn { strands, details: &self.details.words, transmittance: &self.shadow.at_points };
        shade_all(self.width, &view, &points_in, &mut self.points);
        passed("draw/points", &part);

        let part = Stopwatch::start();
        let grid = Grid::new(width, height);
        let points = &self.points;
        // In the order of their points: those whose points are all there.
        let whole = self.details.segments.partition_point(|&first| (first as usize + 1) < points.len());
        let segments = &self.details.segments[..whole];
        let (surface, bins, keys) = (&mut self.surface, &mut self.segment_bins, &mut self.keys);
        let hair_on_body = &self.shadow.at_vertices;
        rayon::join(
            || surface.place(uniform.clip_from_world, &grid, body, hair_on_body, seen_from_without),
            || {
                bins.fill(segments.len(), grid.columns, grid.rows, |i| {
                    let first = segments[i] as usize;
                    let (a, b) = (points.get(first)?, points.get(first + 1)?);
                    if is_drawn(a, b) { grid.range(bounds(a, b)) } else { None }
                });
                if input.picture.transparency == Transparency::Sorted {
                    let forward = (input.camera.target - input.camera.eye).normalize_or_zero();
                    keys.measure(strands, segments, forward);
                }
            },
        );
        passed("draw/sort", &part);

        let part = Stopwatch::start();
        self.tiles.resize(grid.columns * grid.rows * TILE_BYTES, 0);
        let mut tiles = std::mem::take(&mut self.tiles);
        let mut plain = std::mem::take(&mut self.plain);
        plain.follow(&uniform, &grid);
        tiles
            .par_chunks_mut(TILE_BYTES)
            .zip(plain.bytes.par_chunks_mut(TILE_BYTES))
            .zip(&mut plain.known)
            .enumerate()
            .for_each_init(
                || Lease::take(&self.scratch),
                |lease, (tile, ((out, plain), known))| {
                    let ground = dispatch::ground(self.width, &view, grid.origin(tile));
                    let is_plain = ground.is_none()
                        && self.surface.bins.of(tile).is_empty()
                        && self.segment_bins.of(tile).is_empty();
                    if is_plain && *known {
                        out.copy_from_slice(plain);
                        return;
                    }
                    self.draw_tile(&view, &grid, input, body, (tile, ground.as_ref()), lease.get(), out);
                    if is_plain {
                        plain.copy_from_slice(out);
                        *known = true;
                    }
                },
            );
        self.plain = plain;
        copy_rows(&tiles, &grid, picture);
        self.tiles = tiles;
        passed("draw/tiles", &part);
        Ok(FrameStats {
            interpolate_ms: 0.0,
            shadow_ms,
            draw_ms: watch.ms(),
            passes,
            segments: self.details.segments.len() as u64,
            shadow_bytes: self.shadow.bytes,
            draw_bytes: (self.tiles.capacity() + self.plain.bytes.capacity()) as u64,
            mean_transmittance: self.shadow.mean,
        })
    }

    /// Draws the body as each light sees it.
    fn draw_depth(
        &mut self,
        input: &FrameInput,
        body: Option<(&Body, &Skin)>,
        closed: bool,
    ) -> Vec<LightMaps> {
        let positions: &[Vec3] = body.map_or(&[], |(_, skin)| &skin.positions);
        let triangles: &[[u32; 3]] = body.map_or(&[], |(body, _)| &body.mesh.triangles);
        let (center, radius) = bounding_sphere(positions);
        let lights: Vec<_> = input.lights.iter().filter(|light| light.enabled).take(MAX_LIGHTS).collect();
        self.depth.resize_with(lights.len(), DepthMap::default);
        let width = self.width;
        lights
            .into_par_iter()
            .zip(&mut self.depth)
            .map(|(light, depth)| {
                let view = light_view(light.clamped().direction, center, radius, DEPTH_TEXELS);
                depth.draw(width, view.shadow_from_world, (positions, triangles, closed));
                view
            })
            .collect()
    }

    #[expect(clippy::too_many_arguments, reason = "what a tile is drawn from, once")]
    fn draw_tile(
        &self,
        view: &View,
        grid: &Grid,
        input: &FrameInput,
        body: Option<(&Body, &Skin)>,
        (tile, ground): (usize, Option<&Ground>),
        scratch: &mut Scratch,
        out: &mut [u8],
    ) {
        let origin = grid.origin(tile);
        scratch.samples.clear();
        scratch.hidden.clear();
        scratch.hair.clear();
        scratch.surface.clear();
        let triangles = self.surface.bins.of(tile);
        if let Some((body, _)) = body
            && !triangles.is_empty()
        {
            let input = TriangleTile {
                origin,
                vertices: &self.surface.vertices,
                triangles: &body.mesh.triangles,
                list: triangles,
            };
            dispatch::triangles(self.width, &input, &mut scratch.samples, &mut scratch.hidden);
        }
        let segments = self.segment_bins.of(tile);
        if !segments.is_empty() {
            self.draw_hair(view, input.picture.transparency, origin, segments, scratch);
        }
        if let Some((body, _)) = body
            && !triangles.is_empty()
        {
            let surface = (&self.surface, body);
            scratch.light.shade_tile(
                self.width,
                view,
                origin,
                surface,
                (&scratch.samples, &scratch.hair),
                &mut scratch.surface,
            );
        }
        let pixels = PixelsIn { origin, hair: &scratch.hair, surface: &scratch.surface, ground };
        dispatch::finish(self.width, view, &pixels, out);
    }

    fn draw_hair(
        &self,
        view: &View,
        transparency: Transparency,
        origin: [f32; 2],
        segments: &[u32],
        scratch: &mut Scratch,
    ) {
        let opacity = view.uniform.width_opacity_tip_scalp.y;
        match transparency {
            Transparency::Sorted => {
                self.keys.sort(segments, &self.details.segments, &mut scratch.order);
                let order = std::mem::take(&mut scratch.order);
                scratch.blend.clear();
                // Some at a time: what comes after the tile is full is not even fetched.
                for order in order.chunks(SEGMENTS_AT_ONCE) {
                    scratch.segments.clear();
                    scratch.segments.extend(order.iter().map(|&first| {
                        let first = first as u32 as usize;
                        [self.points[first], self.points[first + 1]]
                    }));
                    let input =
                        BlendTile { origin, segments: &scratch.segments, hidden: &scratch.hidden, opacity };
                    dispatch::blend(self.width, &input, &mut scratch.blend);
                    if scratch.blend.is_full() {
                        break;
                    }
                }
                scratch.order = order;
                scratch.blend.write(&mut scratch.hair);
            }
            Transparency::Opaque
            | Transparency::WeightedAverage
            | Transparency::OccupancyOrder
            | Transparency::Exact => {
                let input = ListTile {
                    origin,
                    points: &self.points,
                    segments,
                    first_points: &self.details.segments,
                    samples: &scratch.samples,
                    opacity,
                };
                dispatch::list(self.width, &input, &mut scratch.fragments);
                resolve_tile(transparency, &mut scratch.fragments, &mut scratch.hair);
            }
        }
    }
}

/// Tiles that show the background alone: the same in every frame until it or the size changes.
#[derive(Debug, Default)]
struct PlainTiles {
    /// What they depend on.
    of: Option<([Vec4; 3], Grid)>,
    bytes: Vec<u8>,
    /// Which of them have been drawn.
    known: Vec<bool>,
}

impl PlainTiles {
    /// Forgets them where the background or the size is another one.
    fn follow(&mut self, uniform: &FrameUniform, grid: &Grid) {
        let exposure = Vec4::splat(uniform.size_scale_exposure.w);
        let of = Some(([uniform.background_top, uniform.background_bottom, exposure], *grid));
        if self.of != of {
            self.of = of;
            self.known.clear();
            self.known.resize(grid.columns * grid.rows, false);
            self.bytes.resize(grid.columns * grid.rows * TILE_BYTES, 0);
        }
    }
}

/// Scratch memory that goes back when the task is done.
struct Lease<'a> {
    pool: &'a Mutex<Vec<Box<Scratch>>>,
    scratch: Option<Box<Scratch>>,
}

impl<'a> Lease<'a> {
    fn take(pool: &'a Mutex<Vec<Box<Scratch>>>) -> Self {
        let scratch = pool.lock().unwrap_or_else(PoisonError::into_inner).pop();
        Self { pool, scratch }
    }

    fn get(&mut self) -> &mut Scratch {
        self.scratch.get_or_insert_default()
    }
}

impl Drop for Lease<'_> {
    fn drop(&mut self) {
        if let Some(scratch) = self.scratch.take() {
            self.pool.lock().unwrap_or_else(PoisonError::into_inner).push(scratch);
        }
    }
}

/// Puts finished tiles into the rows of a picture.
fn copy_rows(tiles: &[u8], grid: &Grid, picture: &mut Picture) {
    (picture.width, picture.height) = (grid.width, grid.height);
    let row_bytes = grid.width as usize * 4;
    picture.rgba.resize(row_bytes * grid.height as usize, 0);
    picture.rgba.par_chunks_mut(row_bytes).with_min_len(TILE).enumerate().for_each(|(y, row)| {
        let first = y / TILE * grid.columns;
        for (column, out) in row.chunks_mut(TILE * 4).enumerate() {
            let start = (first + column) * TILE_BYTES + y % TILE * TILE * 4;
            out.copy_from_slice(&tiles[start..start + out.len()]);
        }
    });
}
