//! The CPU renderer.

mod inspect;

use lovelock_base::clock::Stopwatch;
use lovelock_base::memory::list_bytes;
use lovelock_base::simd::Width;
use lovelock_gpu::PassTime;
use lovelock_groom::{HairShading, Strands};
use lovelock_picture::check_size;
use rayon::prelude::*;

use super::backdrop::{Ground, ground_simd};
use super::body_depth::{self, DepthMap};
use super::drawn::DrawnStrands;
use super::false_colors::paint_values;
use super::finish::{PixelsIn, TILE_BYTES, finish_pixels_simd};
use super::kept::{KeptInputs, Unchanged};
use super::layers::{LayerTiles, finish_light};
use super::placed::{PlacedScene, TileScratch, copy_rows, posed_body, surface_of};
use super::pool::Pool;
use super::surface::light::SurfaceLight;
use super::tile::{Grid, SurfacePlanes, TILE};
use super::view::{FibreView, ShadingView, View};
use crate::clusters::{of_casters, without_strands};
use crate::cpu::shadow::ShadowStage;
use crate::fibre;
use crate::frame::INTERPOLATE;
use crate::light_view::{bounding_sphere, light_views};
use crate::scene_light::SceneLight;
use crate::uniform::{FrameUniform, LightMaps, PlainBackground};
use crate::{
    ClusterStats, ColorScale, FrameInput, FrameStats, HairPose, Layers, Light, Picture, RenderError,
};

/// Texels along each edge of the body's depth maps.
const DEPTH_TEXELS: u32 = body_depth::SIZE as u32;

/// Renders pictures on the CPU. Keeps buffers from picture to picture.
#[derive(Debug)]
pub struct CpuRenderer {
    /// Interpolated strands, kept while nothing moves them.
    strands: Strands,
    drawn: DrawnStrands,
    light: Option<Box<SceneLight>>,
    kept: KeptInputs,
    keeps: bool,
    maps: Vec<LightMaps>,
    shadow: ShadowStage,
    placed: PlacedScene,
    /// The views of the body of each light: one, or one per side of a cube.
    depth: Vec<Vec<DepthMap>>,
    /// How long the depth maps took when they were last drawn, milliseconds.
    depth_ms: f64,
    /// How long it took to interpolate the stored strands, and to follow them with those that are drawn, when that was last done,
    /// milliseconds.
    interpolated_ms: [f64; 2],
    tiles: Vec<u8>,
    plain: PlainTiles,
    layers: LayerTiles,
    scratch: Pool<Scratch>,
}

/// The hair of one picture.
struct Hair<'a> {
    /// The strands that the hairstyle stores, which cast shadows.
    stored: &'a Strands,
    drawn: &'a DrawnStrands,
    /// Whether the points that are drawn are those of the last picture.
    same_points: bool,
    /// The part of the optical depth that strands have; the rest is that of clusters.
    share: f32,
}

/// The output.
enum Target<'a> {
    Picture(&'a mut Picture),
    /// A picture whose hair is coloured by one value per stored strand.
    FalseColors(&'a mut Picture, &'a [f32], &'a ColorScale),
    /// Layers, with or without the background.
    Layers(&'a mut Layers, bool),
}

/// Scratch memory of a thread for one tile.
#[derive(Debug, Default)]
struct Scratch {
    tile: TileScratch,
    surface: SurfacePlanes,
    light: SurfaceLight,
}

impl Scratch {
    /// The input of a finished tile.
    fn seen<'a>(&'a self, origin: [f32; 2], ground: Option<&'a Ground>) -> PixelsIn<'a> {
        PixelsIn { origin, hair: &self.tile.hair, surface: &self.surface, ground }
    }
}

impl Default for CpuRenderer {
    fn default() -> Self {
        Self {
            strands: Strands::default(),
            drawn: DrawnStrands::default(),
            light: None,
            kept: KeptInputs::default(),
            keeps: true,
            maps: Vec::new(),
            shadow: ShadowStage::default(),
            placed: PlacedScene::new(Width::widest()),
            depth: Vec::new(),
            depth_ms: 0.0,
            interpolated_ms: [0.0; 2],
            tiles: Vec::new(),
            plain: PlainTiles::default(),
            layers: LayerTiles::default(),
            scratch: Pool::default(),
        }
    }
}

impl CpuRenderer {
    /// A renderer whose loops are compiled for `width`, which the CPU must support: for tests of equality.
    ///
    /// # Panics
    /// If the CPU does not support such vectors.
    pub fn with_width(width: Width) -> Self {
        assert!(width.is_available(), "{width:?} on a processor without");
        Self { placed: PlacedScene::new(width), ..Self::default() }
    }

    /// A renderer that computes everything anew for each picture, also what has not changed since the one before.
    #[must_use]
    pub fn keeping_nothing(self) -> Self {
        Self { keeps: false, ..self }
    }

    /// Whether results are kept for the next picture while nothing moves, which is so at first. Times of repeated pictures only mean
    /// something without.
    pub fn set_keeping(&mut self, keeps: bool) {
        self.keeps = keeps;
    }

    /// The memory that it keeps from picture to picture, bytes: what it has drawn, and the scratch memory of threads.
    pub fn bytes(&self) -> u64 {
        let scratch = |scratch: &Scratch| size_of_val(scratch) as u64 + scratch.tile.bytes();
        self.strands.bytes()
            + self.drawn.bytes()
            + self.light.as_ref().map_or(0, |light| light.grid.bytes())
            + self.kept.bytes()
            + self.shadow.kept_bytes()
            + self.placed.bytes()
            + self.depth.iter().flatten().map(DepthMap::bytes).sum::<u64>()
            + list_bytes(&self.tiles)
            + list_bytes(&self.plain.bytes)
            + self.layers.bytes()
            + self.scratch.bytes(scratch)
    }

    /// The name of the device: the vector width in use.
    pub fn adapter() -> String {
        let threads = rayon::current_num_threads();
        format!("processor ({:?}, {threads} threads)", Width::widest())
    }

    /// Renders `input` at `width` by `height` pixels.
    ///
    /// # Errors
    /// The size is out of range, or the shadow needs too much memory.
    pub fn picture(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        picture: &mut Picture,
    ) -> Result<FrameStats, RenderError> {
        self.draw_to(input, width, height, Target::Picture(picture))
    }

    /// Renders the layers of `input` at `width` by `height` pixels, with or without the background.
    ///
    /// # Errors
    /// As [`CpuRenderer::picture`].
    pub fn layers(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        over_background: bool,
        layers: &mut Layers,
    ) -> Result<FrameStats, RenderError> {
        self.draw_to(input, width, height, Target::Layers(layers, over_background))
    }

    /// As [`CpuRenderer::picture`], with hair in the colours of `scale` by one value per stored strand; fine strands have what lies between
    /// their parents. A value that is not finite is missing: it hides what is behind it but has no colour.
    ///
    /// # Errors
    /// As [`CpuRenderer::picture`].
    pub fn strand_colors(
        &mut self,
        input: &FrameInput,
        [width, height]: [u32; 2],
        (of_strands, scale): (&[f32], &ColorScale),
        picture: &mut Picture,
    ) -> Result<FrameStats, RenderError> {
        self.draw_to(input, width, height, Target::FalseColors(picture, of_strands, scale))
    }

    fn draw_to(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        target: Target,
    ) -> Result<FrameStats, RenderError> {
        check_size(width, height)?;
        let watch = Stopwatch::start();
        let share = self.placed.clusters.follow(input, height);
        let clusters = self.placed.clusters.hair();
        let picture = without_strands(input.picture);
        let casters =
            clusters.as_ref().filter(|_| share >= 1.0).map(|hair| of_casters(input, hair, &picture));
        let input = casters.as_ref().unwrap_or(input);
        let unchanged = if self.keeps {
            self.kept.follow(input)
        } else {
            self.kept.forget();
            Unchanged { body: false, hair: false }
        };
        let mut made = std::mem::take(&mut self.strands);
        let strands = match input.hair {
            HairPose::Guides(_) if unchanged.hair => &made,
            _ => input.hair.strands(input.style, &mut made),
        };
        let stored_ms = watch.ms();
        let mut drawn = std::mem::take(&mut self.drawn);
        let same_points = drawn.follow(self.placed.width, input, height, (strands, unchanged.hair));
        let interpolate_ms = watch.ms();
        let now = [stored_ms, interpolate_ms - stored_ms];
        let mut kept_ms = 0.0;
        for ((made, now), is_kept) in
            self.interpolated_ms.iter_mut().zip(now).zip([unchanged.hair, same_points])
        {
            if is_kept {
                kept_ms += *made;
            } else {
                *made = now;
            }
        }
        let mut light = self.light.take().unwrap_or_default();
        let watch = Stopwatch::start();
        light.follow(input);
        let ambient_ms = watch.ms();
        let hair = Hair { stored: strands, drawn: &drawn, same_points, share: 1.0 - share };
        let mut stats = self.draw(input, (&hair, &light), unchanged, width, height, target);
        (self.strands, self.drawn, self.light) = (made, drawn, Some(light));
        if let Ok(stats) = &mut stats {
            stats.draw_ms += ambient_ms;
            stats.passes.push(PassTime { name: "draw/ambient".to_owned(), ms: ambient_ms });
            if unchanged.hair {
                stats.kept.push(PassTime { name: INTERPOLATE.to_owned(), ms: kept_ms });
            }
        }
        if stats.is_err() {
            self.kept.forget();
        }
        stats.map(|stats| FrameStats { interpolate_ms, ..stats })
    }

    fn draw(
        &mut self,
        input: &FrameInput,
        (hair, light): (&Hair, &SceneLight),
        unchanged: Unchanged,
        width: u32,
        height: u32,
        target: Target,
    ) -> Result<FrameStats, RenderError> {
        let watch = Stopwatch::start();
        let strands = hair.drawn.strands(hair.stored);
        let asked = (strands, hair.drawn.portion().map(|(_, points)| points));
        if !unchanged.hair {
            self.shadow.run(input, hair.stored, asked)?;
        } else if hair.same_points {
            self.shadow.passes.clear();
        } else {
            self.shadow.look_up_again(input, asked)?;
        }
        let shadow_ms = watch.ms();

        let watch = Stopwatch::start();
        let mut passes = self.shadow.passes.clone();
        let mut kept = Vec::new();
        if unchanged.hair {
            let is_new = |pass: &PassTime| passes.iter().any(|new| new.name == pass.name);
            kept.extend(self.shadow.made.iter().filter(|pass| !is_new(pass)).cloned());
        }
        let mut passed = |name: &str, part: &Stopwatch| {
            passes.push(PassTime { name: name.to_owned(), ms: part.ms() });
        };
        let part = Stopwatch::start();
        if !unchanged.body {
            self.maps = self.draw_depth(input);
        }
        for (maps, light) in self.maps.iter_mut().zip(Light::enabled(input.lights)) {
            if light.stands() {
                maps.standing.shape_cone(&light);
            }
        }
        let drawn = hair.drawn.portion();
        let uniform = FrameUniform::new(input, drawn, light, (width, height), &self.maps, DEPTH_TEXELS);
        let tables = &light.tables;
        let shading = || match input.look.shading {
            HairShading::Fibre => {
                ShadingView::Fibre(FibreView { tables, lights: fibre::lights(tables, input.lights) })
            }
            HairShading::TwoHighlights => ShadingView::TwoHighlights,
            HairShading::KajiyaKayPublished => ShadingView::KajiyaKay,
        };
        let view =
            View::new(&uniform, (&light.grid, shading()), &self.depth, &self.shadow.columns, DEPTH_TEXELS);
        if unchanged.body {
            kept.push(PassTime { name: "draw/body-depth".to_owned(), ms: self.depth_ms });
        } else {
            self.depth_ms = part.ms();
            passed("draw/body-depth", &part);
        }

        let part = Stopwatch::start();
        let details = &hair.drawn.details;
        if hair.share > 0.0 {
            self.placed.shade(&view, (strands, details), &self.shadow.at_points, input.is_draft);
        } else {
            self.placed.clear_strands();
        }
        passed("draw/points", &part);

        let grid = Grid::new(width, height);
        if let Some(ribs) = self.placed.clusters.ribs().cloned() {
            let part = Stopwatch::start();
            let of_ribs = FrameInput { style: &ribs, ..*input };
            let uniform = FrameUniform::new(&of_ribs, None, light, (width, height), &self.maps, DEPTH_TEXELS);
            let lit = (&light.grid, shading());
            let view = View::new(&uniform, lit, &self.depth, &self.shadow.columns, DEPTH_TEXELS);
            self.placed.clusters.place(self.placed.width, input, &view, &self.shadow, &grid);
            passed("draw/clusters", &part);
        }
        let part = Stopwatch::start();
        self.placed.sort(&view, &grid, input, strands, &self.shadow.at_vertices);
        passed("draw/sort", &part);

        let (picture, colors) = match target {
            Target::Picture(picture) => (picture, None),
            Target::FalseColors(picture, of_strands, scale) => (picture, Some((of_strands, scale))),
            Target::Layers(layers, over_background) => {
                let part = Stopwatch::start();
                let mut held = std::mem::take(&mut self.layers);
                held.fit(&grid);
                self.draw_light(&view, &grid, input, over_background, &mut held.light);
                if hair.share <= 0.0 {
                    // Depth and transmittance of clusters are those of the strands that cast their shadow.
                    let points = (strands, details);
                    self.placed.shade(&view, points, &self.shadow.at_points, input.is_draft);
                    self.placed.sort(&view, &grid, input, strands, &self.shadow.at_vertices);
                }
                self.placed.clusters.hide();
                held.draw_values(&view, &grid, input, &mut self.placed, &self.shadow.at_points);
                held.write(&grid, layers);
                self.layers = held;
                passed("draw/layers", &part);
                return Ok(self.stats(shadow_ms, &watch, (passes, kept)));
            }
        };
        let part = Stopwatch::start();
        let mut tiles = std::mem::take(&mut self.tiles);
        tiles.resize(grid.columns * grid.rows * TILE_BYTES, 0);
        self.plain.follow(&uniform, &grid);
        let mut plain = std::mem::take(&mut self.plain);
        self.draw_tiles(&view, &grid, input, &mut tiles, &mut plain);
        self.plain = plain;
        if let Some((of_strands, scale)) = colors {
            let values = hair.drawn.at_points(input.style, of_strands);
            paint_values(&view, &grid, input, &mut self.placed, (&values, scale), &mut tiles);
        }
        (picture.width, picture.height) = (width, height);
        copy_rows(&tiles, 4, &grid, &mut picture.rgba);
        self.tiles = tiles;
        passed("draw/tiles", &part);
        Ok(self.stats(shadow_ms, &watch, (passes, kept)))
    }

    /// The light of all tiles, linear, for layers.
    fn draw_light(
        &self,
        view: &View,
        grid: &Grid,
        input: &FrameInput,
        over_background: bool,
        light: &mut [[f32; 4]],
    ) {
        light.par_chunks_mut(TILE * TILE).enumerate().for_each_init(
            || self.scratch.take(),
            |lease, (tile, out)| {
                let ground = ground_simd(self.placed.width, view, grid.origin(tile));
                let scratch = lease.get();
                self.draw_seen(view, grid, input, tile, scratch);
                finish_light(view, &scratch.seen(grid.origin(tile), ground.as_ref()), over_background, out);
            },
        );
    }

    /// Draws all tiles. Those that show only the background are copied from `plain` if it has them, and to it otherwise.
    fn draw_tiles(
        &self,
        view: &View,
        grid: &Grid,
        input: &FrameInput,
        tiles: &mut [u8],
        plain: &mut PlainTiles,
    ) {
        tiles
            .par_chunks_mut(TILE_BYTES)
            .zip(plain.bytes.par_chunks_mut(TILE_BYTES))
            .zip(&mut plain.known)
            .enumerate()
            .for_each_init(
                || self.scratch.take(),
                |lease, (tile, ((out, plain), known))| {
                    let ground = ground_simd(self.placed.width, view, grid.origin(tile));
                    let is_plain = ground.is_none() && self.placed.is_empty(tile);
                    if is_plain && *known {
                        out.copy_from_slice(plain);
                        return;
                    }
                    self.draw_tile(view, grid, input, (tile, ground.as_ref()), lease.get(), out);
                    if is_plain {
                        plain.copy_from_slice(out);
                        *known = true;
                    }
                },
            );
    }

    fn stats(
        &self,
        shadow_ms: f64,
        drawing: &Stopwatch,
        (passes, kept): (Vec<PassTime>, Vec<PassTime>),
    ) -> FrameStats {
        FrameStats {
            interpolate_ms: 0.0,
            shadow_ms,
            draw_ms: drawing.ms(),
            passes,
            kept,
            segments: self.placed.segments().len() as u64,
            shadow_bytes: self.shadow.bytes,
            draw_bytes: (self.tiles.capacity() + self.plain.bytes.capacity()) as u64 + self.layers.bytes(),
            mean_transmittance: self.shadow.mean,
            clusters: self.placed.clusters.hair().map(|hair| ClusterStats::of(&hair)),
            ..FrameStats::default()
        }
    }

    /// Draws the depth maps of the body for all lights.
    fn draw_depth(&mut self, input: &FrameInput) -> Vec<LightMaps> {
        let (positions, triangles) = surface_of(input);
        let sphere = bounding_sphere(positions);
        let lights: Vec<_> = Light::enabled(input.lights).collect();
        self.depth.resize_with(lights.len(), Vec::new);
        let (width, closed) = (self.placed.width, self.placed.is_closed(input));
        let shadow = &self.shadow;
        lights
            .par_iter()
            .zip(&mut self.depth)
            .enumerate()
            .map(|(k, (light, depth))| {
                let views = light_views(light, &shadow.frame(k), sphere, DEPTH_TEXELS);
                depth.resize_with(views.body_views().len(), DepthMap::default);
                depth.par_iter_mut().zip(views.body_views()).for_each(|(depth, from_world)| {
                    if views.standing.is_standing() {
                        // From within a closed body, triangles that face away are nearest.
                        depth.draw_perspective(width, *from_world, (positions, triangles, false));
                    } else {
                        depth.draw(width, *from_world, (positions, triangles, closed));
                    }
                });
                views
            })
            .collect()
    }

    fn draw_tile(
        &self,
        view: &View,
        grid: &Grid,
        input: &FrameInput,
        (tile, ground): (usize, Option<&Ground>),
        scratch: &mut Scratch,
        out: &mut [u8],
    ) {
        self.draw_seen(view, grid, input, tile, scratch);
        finish_pixels_simd(self.placed.width, view, &scratch.seen(grid.origin(tile), ground), out);
    }

    /// Draws the body and the hair of a tile.
    fn draw_seen(&self, view: &View, grid: &Grid, input: &FrameInput, tile: usize, scratch: &mut Scratch) {
        let (placed, origin) = (&self.placed, grid.origin(tile));
        placed.draw_tile(view, grid, input, tile, &mut scratch.tile);
        scratch.surface.clear();
        if let Some((body, _)) = posed_body(input)
            && !placed.surface.bins.of(tile).is_empty()
        {
            scratch.light.shade_tile(
                placed.width,
                view,
                origin,
                (&placed.surface, body),
                (&scratch.tile.samples, &scratch.tile.hair),
                &mut scratch.surface,
            );
        }
    }
}

/// Tiles that show only the background: the same in every frame until the background or the size changes.
#[derive(Debug, Default)]
struct PlainTiles {
    /// What the tiles depend on.
    of: Option<(PlainBackground, Grid)>,
    bytes: Vec<u8>,
    /// Whether each tile has been drawn.
    known: Vec<bool>,
}

impl PlainTiles {
    /// Clears the tiles if the background or the size has changed.
    fn follow(&mut self, uniform: &FrameUniform, grid: &Grid) {
        let of = Some((PlainBackground::of(uniform), *grid));
        if self.of != of {
            self.of = of;
            self.known.clear();
            self.known.resize(grid.columns * grid.rows, false);
            self.bytes.resize(grid.columns * grid.rows * TILE_BYTES, 0);
        }
    }
}
