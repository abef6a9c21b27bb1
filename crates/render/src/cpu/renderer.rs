//! The CPU renderer.

mod depth;
mod inspect;
mod moved;
mod options;
mod outputs;
mod plain;
mod tiles;

use std::sync::Arc;

use lovelock_base::clock::Stopwatch;
use lovelock_base::memory::list_bytes;
use lovelock_base::simd::Width;
use lovelock_gpu::PassTime;
use lovelock_groom::{FollowingStrands, HairShading, Strands};
use lovelock_picture::check_size;

use super::backdrop::Ground;
use super::body_depth::{self, DepthMap};
use super::carried::CarriedStage;
use super::drawn::DrawnStrands;
use super::false_colors::paint_values;
use super::finish::{PixelsIn, TILE_BYTES};
use super::interrupt::{Interrupt, check};
use super::kept::{KeptInputs, Unchanged};
use super::layers::LayerTiles;
use super::placed::{PlacedScene, TileScratch, copy_rows};
use super::pool::Pool;
use super::shadow::{ShadowStage, caster_step, casters_of};
use super::surface::light::SurfaceLight;
use super::tile::{Grid, SurfacePlanes};
use super::tone_map::encode;
use super::view::{FibreView, ShadingView, View};
use crate::backdrop::{Backdrop, LaidBackdrop};
use crate::clusters::{of_casters, without_strands};
use crate::fibre;
use crate::frame::INTERPOLATE;
use crate::scene_light::SceneLight;
use crate::uniform::{FrameUniform, LightMaps};
use crate::{
    ClusterStats, ColorScale, FrameInput, FrameStats, HairPose, Layers, Light, Picture, RenderError,
};
use moved::{Moved, Shown};
use plain::PlainTiles;

/// Texels along each edge of the body's depth maps.
const DEPTH_TEXELS: u32 = body_depth::SIZE as u32;

/// Renders pictures on the CPU. Keeps buffers from picture to picture.
#[derive(Debug)]
pub struct CpuRenderer {
    /// Interpolated strands; those that nothing moves are kept.
    strands: FollowingStrands,
    /// Which of them a draft needs.
    needed: Vec<bool>,
    drawn: DrawnStrands,
    light: Option<Box<SceneLight>>,
    kept: KeptInputs,
    keeps: bool,
    /// Whether images may show only what has moved.
    hurries: bool,
    /// What the finished tiles show, whose strands have the points of the placed hair; `None` if nothing can be drawn over them.
    shown: Option<Shown>,
    moved: Moved,
    interrupt: Option<Interrupt>,
    maps: Vec<LightMaps>,
    shadow: ShadowStage,
    placed: PlacedScene,
    carried: CarriedStage,
    /// The views of the body of each light: one, or one per side of a cube.
    depth: Vec<Vec<DepthMap>>,
    /// How long the depth maps took when they were last drawn, milliseconds.
    depth_ms: f64,
    /// How long it took to interpolate the stored strands, and to follow them with those that are drawn, when that was last done,
    /// milliseconds.
    interpolated_ms: [f64; 2],
    tiles: Vec<u8>,
    plain: PlainTiles,
    backdrop: Backdrop,
    /// The picture behind the figure in the image that is drawn.
    behind: Option<Arc<LaidBackdrop>>,
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
    /// Layers, with or without the background, and with or without values.
    Layers(&'a mut Layers, bool, bool),
}

/// Which stored strands a draft needs: those that the `drawn` ones are made from, and those that cast shadows. `None` if all are.
fn needed_strands<'a>(
    input: &FrameInput,
    drawn: &DrawnStrands,
    marks: &'a mut Vec<bool>,
) -> Option<&'a [bool]> {
    let (count, points) = (input.style.strands.count(), input.style.strands.points());
    let step = caster_step(input, points);
    // Given transmittance has a number for each point.
    if step <= 1 || drawn.portion().is_none() || input.known.is_some() {
        return None;
    }
    marks.clear();
    marks.resize(count, false);
    casters_of(count, step).for_each(|strand| marks[strand] = true);
    drawn.mark_parents(marks);
    Some(marks)
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
    fn seen<'a>(
        &'a self,
        origin: [f32; 2],
        ground: Option<&'a Ground>,
        picture: Option<&'a LaidBackdrop>,
    ) -> PixelsIn<'a> {
        PixelsIn { origin, hair: &self.tile.hair, surface: &self.surface, ground, picture }
    }
}

impl Default for CpuRenderer {
    fn default() -> Self {
        Self {
            strands: FollowingStrands::default(),
            needed: Vec::new(),
            drawn: DrawnStrands::default(),
            light: None,
            kept: KeptInputs::default(),
            keeps: true,
            hurries: false,
            shown: None,
            moved: Moved::default(),
            interrupt: None,
            maps: Vec::new(),
            shadow: ShadowStage::default(),
            placed: PlacedScene::new(Width::widest()),
            carried: CarriedStage::default(),
            depth: Vec::new(),
            depth_ms: 0.0,
            interpolated_ms: [0.0; 2],
            tiles: Vec::new(),
            plain: PlainTiles::default(),
            backdrop: Backdrop::default(),
            behind: None,
            layers: LayerTiles::default(),
            scratch: Pool::default(),
        }
    }
}

impl CpuRenderer {
    /// The memory that it keeps from picture to picture, bytes: what it has drawn, and the scratch memory of threads.
    pub fn bytes(&self) -> u64 {
        let scratch =
            |scratch: &Scratch| size_of_val(scratch) as u64 + scratch.tile.bytes() + scratch.light.bytes();
        self.strands.bytes()
            + self.drawn.bytes()
            + self.light.as_ref().map_or(0, |light| light.grid.bytes())
            + self.kept.bytes()
            + self.shadow.kept_bytes()
            + self.placed.bytes()
            + self.carried.bytes()
            + self.depth.iter().flatten().map(DepthMap::bytes).sum::<u64>()
            + list_bytes(&self.tiles)
            + list_bytes(&self.plain.bytes)
            + self.backdrop.bytes()
            + self.layers.bytes()
            + self.moved.bytes()
            + self.scratch.bytes(scratch)
    }

    /// The name of the device: the vector width in use.
    pub fn adapter() -> String {
        let threads = rayon::current_num_threads();
        format!("processor ({:?}, {threads} threads)", Width::widest())
    }

    fn draw_to(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        mut target: Target,
    ) -> Result<FrameStats, RenderError> {
        check_size(width, height)?;
        check(self.interrupt.as_ref())?;
        let watch = Stopwatch::start();
        self.behind = self.backdrop.follow(input, [width, height], encode);
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
            Unchanged::default()
        };
        let mut drawn = std::mem::take(&mut self.drawn);
        let same_points = drawn.choose(input, height) && unchanged.strands;
        let mut made = std::mem::take(&mut self.strands);
        let mut is_kept = unchanged.strands;
        let strands = match input.hair {
            HairPose::Strands(strands) => strands,
            HairPose::Guides(guides) | HairPose::Resident(guides, _) => {
                let needed = needed_strands(input, &drawn, &mut self.needed);
                made.follow(input.style, guides, needed);
                // After a draft, a whole image computes strands although nothing has moved.
                is_kept &= !made.has_computed();
                made.strands()
            }
        };
        let stored_ms = watch.ms();
        drawn.grow(self.placed.width, strands, same_points);
        let interpolate_ms = watch.ms();
        let now = [stored_ms, interpolate_ms - stored_ms];
        let mut kept_ms = 0.0;
        for ((made, now), is_kept) in self.interpolated_ms.iter_mut().zip(now).zip([is_kept, same_points]) {
            if is_kept {
                kept_ms += *made;
            } else {
                *made = now;
            }
        }
        let mut light = self.light.take().unwrap_or_default();
        let hair = Hair { stored: strands, drawn: &drawn, same_points, share: 1.0 - share };
        let size = [width, height];
        let shows = self.will_show(input, &hair, size, &target);
        let shown = self.shown.take().filter(|_| unchanged.depth());
        let is_over = shown.zip(shows.as_ref()).is_some_and(|(shown, shows)| shown.is_same(shows));
        // An attempt shades all points unless their light waits, and that costs more than it saves if it comes to nothing.
        let mut is_hurried = is_over && self.hurries && !unchanged.strands && self.placed.is_late(input);
        let (mut ambient_ms, mut lost_ms) = (None, None);
        let mut stats = loop {
            let watch = Stopwatch::start();
            if !is_hurried {
                light.follow(input);
                ambient_ms = Some(watch.ms());
            }
            let done =
                self.draw(input, (&hair, &light), unchanged, size, &mut target, is_hurried).transpose();
            if let Some(stats) = done {
                break stats;
            }
            // Only an image in a hurry comes to nothing.
            (is_hurried, lost_ms) = (false, Some(watch.ms()));
        };
        self.shown = match &stats {
            Ok(_) => shows,
            // Some tiles are those of the same hair in other light.
            Err(RenderError::Interrupted) if is_over && same_points => shows,
            Err(_) => None,
        };
        (self.strands, self.drawn, self.light) = (made, drawn, Some(light));
        if !input.is_draft {
            // Only drafts are compared with the image before.
            self.moved = Moved::default();
        }
        if let Ok(stats) = &mut stats {
            for (name, ms) in [("draw/ambient", ambient_ms), ("draw/moved", lost_ms)] {
                if let Some(ms) = ms {
                    stats.draw_ms += ms;
                    stats.passes.push(PassTime { name: name.to_owned(), ms });
                }
            }
            if unchanged.strands {
                stats.kept.push(PassTime { name: INTERPOLATE.to_owned(), ms: kept_ms });
            }
        }
        // What is kept is whole before an image is given up: see `draw`.
        if stats.as_ref().is_err_and(|error| !matches!(error, RenderError::Interrupted)) {
            self.kept.forget();
        }
        stats.map(|stats| FrameStats { interpolate_ms, ..stats })
    }

    /// Draws the image, or in a hurry the tiles in which strands have moved. Returns `None` if those are too many to be worth it.
    fn draw(
        &mut self,
        input: &FrameInput,
        (hair, light): (&Hair, &SceneLight),
        unchanged: Unchanged,
        [width, height]: [u32; 2],
        target: &mut Target,
        is_hurried: bool,
    ) -> Result<Option<FrameStats>, RenderError> {
        // A few tiles are finished sooner than others could be begun.
        let interrupt = self.interrupt.clone().filter(|_| !is_hurried);
        // Asked after the shadow maps and the body's depth alone, so that an image that is given up leaves them to the next one.
        let go_on = || check(interrupt.as_ref());
        let watch = Stopwatch::start();
        let strands = hair.drawn.strands(hair.stored);
        let asked = (strands, hair.drawn.portion().map(|(_, points)| points));
        let (mut passes, mut kept) = (Vec::new(), Vec::new());
        let mut shadow_ms = 0.0;
        if is_hurried {
            self.shadow.fall_behind();
            std::mem::swap(&mut self.placed.points, &mut self.moved.before);
        } else {
            self.shadow.run(input, hair.stored, asked, (unchanged, hair.same_points))?;
            (passes, kept) = (self.shadow.passes.clone(), self.shadow.kept.clone());
            shadow_ms = watch.ms();
        }

        let watch = Stopwatch::start();
        let mut passed = |name: &str, part: &Stopwatch| {
            passes.push(PassTime { name: name.to_owned(), ms: part.ms() });
        };
        let part = Stopwatch::start();
        if !unchanged.depth() {
            self.maps = self.draw_depth(input, unchanged);
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
        if unchanged.depth() {
            kept.push(PassTime { name: "draw/body-depth".to_owned(), ms: self.depth_ms });
        } else {
            self.depth_ms = part.ms();
            passed("draw/body-depth", &part);
        }
        go_on()?;

        let part = Stopwatch::start();
        let details = &hair.drawn.details;
        let stored = without_strands(input.picture);
        let of_carried = input.of_carried(&stored).filter(|_| hair.share > 0.0);
        let (points, at_points) = ((strands, details), &self.shadow.at_points);
        let mut late = None;
        if hair.share <= 0.0 {
            self.placed.clear_strands();
        } else if self.placed.is_late(input) {
            late = Some(self.placed.place(&view, points, at_points, input.is_draft));
        } else {
            self.placed.shade(&view, points, at_points, input.is_draft);
        }
        let lit = (&view, late.as_ref());
        if let Some(of_carried) = &of_carried {
            let uniform =
                FrameUniform::new(of_carried, None, light, (width, height), &self.maps, DEPTH_TEXELS);
            let lit = (&light.grid, shading());
            let view = View::new(&uniform, lit, &self.depth, &self.shadow.columns, DEPTH_TEXELS);
            self.carried.draw(&view, of_carried, &self.shadow, &mut self.placed);
        } else {
            self.carried = CarriedStage::default();
        }
        passed("draw/points", &part);
        go_on()?;

        let grid = Grid::new(width, height);
        let mut redrawn = None;
        if is_hurried {
            let part = Stopwatch::start();
            let is_found = self.moved.find(&self.placed.points, self.placed.segments(), &grid);
            let (tiles, filled) = (self.moved.count(), self.filled_tiles(&grid));
            if !is_found || 2 * tiles > filled {
                return Ok(None);
            }
            redrawn = Some(tiles as f32 / (grid.columns * grid.rows) as f32);
            passed("draw/moved", &part);
        }
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
        go_on()?;

        let (picture, colors) = match target {
            Target::Picture(picture) => (&mut **picture, None),
            Target::FalseColors(picture, of_strands, scale) => (&mut **picture, Some((*of_strands, *scale))),
            Target::Layers(layers, over_background, with_values) => {
                let (over_background, with_values) = (*over_background, *with_values);
                let part = Stopwatch::start();
                let mut held = std::mem::take(&mut self.layers);
                held.fit(&grid);
                self.draw_light(lit, &grid, input, over_background, &mut held.light);
                if !with_values {
                    held.write_light(&grid, layers);
                    layers.behind = self.behind.clone().filter(|_| over_background);
                    self.layers = held;
                    passed("draw/layers", &part);
                    return Ok(Some(self.stats(shadow_ms, &watch, (passes, kept))));
                }
                if hair.share <= 0.0 {
                    // Depth and transmittance of clusters are those of the strands that cast their shadow.
                    let points = (strands, details);
                    self.placed.shade(&view, points, &self.shadow.at_points, input.is_draft);
                    self.placed.sort(&view, &grid, input, strands, &self.shadow.at_vertices);
                }
                self.placed.clusters.hide();
                let at_points = (&self.shadow.at_points[..], &self.carried.packed[..]);
                held.draw_values(&view, &grid, input, &mut self.placed, at_points);
                held.write(&grid, layers);
                layers.behind = self.behind.clone().filter(|_| over_background);
                self.layers = held;
                passed("draw/layers", &part);
                return Ok(Some(self.stats(shadow_ms, &watch, (passes, kept))));
            }
        };
        let part = Stopwatch::start();
        let mut tiles = std::mem::take(&mut self.tiles);
        tiles.resize(grid.columns * grid.rows * TILE_BYTES, 0);
        self.plain.follow(&uniform, &grid, self.behind.as_ref().map_or(0, |behind| behind.number));
        let mut plain = std::mem::take(&mut self.plain);
        let only = is_hurried.then(|| self.moved.tiles());
        let drawn = self.draw_tiles(lit, &grid, input, &mut tiles, &mut plain, only);
        self.plain = plain;
        if drawn.is_err() {
            self.tiles = tiles;
            return Err(RenderError::Interrupted);
        }
        if let Some((of_strands, scale)) = colors {
            let values = hair.drawn.at_points(input.style, of_strands);
            paint_values(&view, &grid, input, &mut self.placed, (&values, scale), &mut tiles);
        }
        (picture.width, picture.height) = (width, height);
        copy_rows(&tiles, 4, &grid, &mut picture.rgba);
        self.tiles = tiles;
        passed("draw/tiles", &part);
        Ok(Some(FrameStats { redrawn, ..self.stats(shadow_ms, &watch, (passes, kept)) }))
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
            segments: self.placed.hair_segments() as u64,
            shadow_bytes: self.shadow.bytes,
            shadow_fallbacks: self.shadow.fallbacks,
            draw_bytes: (self.tiles.capacity() + self.plain.bytes.capacity()) as u64 + self.layers.bytes(),
            mean_transmittance: self.shadow.mean,
            clusters: self.placed.clusters.hair().map(|hair| ClusterStats::of(&hair)),
            ..FrameStats::default()
        }
    }
}
