//! Images of which only those tiles are drawn in which strands have moved.
//!
//! The rest of such an image is the one before, and so are shadows and the light from all directions, until the next whole image. What has
//! moved then costs its tiles, and neither the maps of all hair nor the tiles of the rest.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use lovelock_appearance::environment::Panorama;
use lovelock_base::memory::list_bytes;
use lovelock_groom::{HairLook, Hairstyle};
use rayon::prelude::*;

use super::{CpuRenderer, DEPTH_TEXELS, Hair, Target};
use crate::cpu::hair::fragments::{bounds, is_drawn};
use crate::cpu::strand_points::ShadedPoint;
use crate::cpu::tile::Grid;
use crate::scene_light::NO_LIGHT;
use crate::shadow_look::ShadowLook;
use crate::uniform::FrameUniform;
use crate::{FrameInput, Light, PictureSettings};

/// The light of a point depends on no point that is further away on its strand: three where it lies between that of others, and one more for
/// their directions.
const REACH: usize = 4;

/// Points or segments per task at least.
const PIECE: usize = 8192;

/// What an image shows beside the places of strands and of the body.
#[derive(Debug)]
pub(super) struct Shown {
    /// What all tiles have in common, without lights.
    constants: Box<FrameUniform>,
    grid: Grid,
    lights: Vec<Light>,
    look: HairLook,
    shadows: ShadowLook,
    settings: PictureSettings,
    is_draft: bool,
    surroundings: Option<Arc<Panorama>>,
    /// The number of the picture behind the figure.
    behind: u64,
    /// See [`StrandDetails::version`](crate::strand_details::StrandDetails::version).
    details: u64,
    /// Taper and colours of carried hair, and its look.
    carried: Option<(Arc<Hairstyle>, HairLook)>,
}

impl Shown {
    /// Whether both differ in the places of strands at most.
    pub fn is_same(&self, other: &Self) -> bool {
        let numbers = |of: &Self| (of.grid, of.is_draft, of.behind, of.details);
        let objects = |of: &Self| {
            let carried = of.carried.as_ref().map(|(style, look)| (Arc::as_ptr(style), *look));
            (of.surroundings.as_ref().map(Arc::as_ptr), carried)
        };
        numbers(self) == numbers(other)
            && objects(self) == objects(other)
            && self.constants == other.constants
            && (&self.look, &self.shadows, &self.settings) == (&other.look, &other.shadows, &other.settings)
            && self.lights == other.lights
    }
}

/// Which points have moved since the last image, and the tiles that their strands touch. Kept from draft to draft for its memory.
#[derive(Debug, Default)]
pub(super) struct Moved {
    /// The points of the last image.
    pub before: Vec<ShadedPoint>,
    points: Vec<bool>,
    tiles: Vec<AtomicBool>,
}

impl Moved {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.before) + list_bytes(&self.points) + list_bytes(&self.tiles)
    }

    /// Finds the tiles that strands touch which have moved, where they are `now` or where they were. Segments are given by their first points.
    /// Returns false if the points before were those of other strands.
    pub fn find(&mut self, now: &[ShadedPoint], segments: &[u32], grid: &Grid) -> bool {
        let Self { before, points, tiles } = self;
        if before.len() != now.len() {
            return false;
        }
        points.resize(now.len(), false);
        let pairs = before.par_chunks(PIECE).zip(now.par_chunks(PIECE));
        points.par_chunks_mut(PIECE).zip(pairs).for_each(|(points, (before, now))| {
            for (moved, (before, now)) in points.iter_mut().zip(before.iter().zip(now)) {
                *moved = place(before) != place(now);
            }
        });
        tiles.clear();
        tiles.resize_with(grid.columns * grid.rows, AtomicBool::default);
        let (before, points, tiles) = (&before[..], &points[..], &tiles[..]);
        segments.par_iter().with_min_len(PIECE).for_each(|&first| {
            let first = first as usize;
            if !points[first.saturating_sub(REACH)..(first + 2 + REACH).min(points.len())].contains(&true) {
                return;
            }
            for of in [before, now] {
                let (a, b) = (&of[first], &of[first + 1]);
                let Some(range) = grid.range(bounds(a, b)).filter(|_| is_drawn(a, b)) else { continue };
                for y in usize::from(range.y0)..=usize::from(range.y1) {
                    for x in usize::from(range.x0)..=usize::from(range.x1) {
                        tiles[y * grid.columns + x].store(true, Ordering::Relaxed);
                    }
                }
            }
        });
        true
    }

    /// Whether strands that have moved touch each tile.
    pub fn tiles(&self) -> &[AtomicBool] {
        &self.tiles
    }

    /// The number of those tiles.
    pub fn count(&self) -> usize {
        self.tiles.iter().filter(|tile| tile.load(Ordering::Relaxed)).count()
    }
}

/// What places a point in an image. Its light follows from the places of points and from what all images have in common.
fn place(point: &ShadedPoint) -> [f32; 7] {
    let ShadedPoint { x, y, depth, half_width, run_x, run_y, hash, .. } = *point;
    [x, y, depth, half_width, run_x, run_y, hash]
}

impl CpuRenderer {
    /// What an image of `input` will show; `None` if another one cannot be drawn over it.
    pub(super) fn will_show(
        &self,
        input: &FrameInput,
        hair: &Hair,
        [width, height]: [u32; 2],
        target: &Target,
    ) -> Option<Shown> {
        let has_strands_alone = hair.share >= 1.0 && input.known.is_none();
        if !self.keeps || !has_strands_alone || !matches!(target, Target::Picture(_)) {
            return None;
        }
        let drawn = hair.drawn.portion();
        let constants = FrameUniform::new(input, drawn, &NO_LIGHT, (width, height), &[], DEPTH_TEXELS);
        Some(Shown {
            constants: Box::new(constants),
            grid: Grid::new(width, height),
            lights: Light::enabled(input.lights).collect(),
            look: input.look,
            shadows: ShadowLook::of(input),
            settings: *input.picture,
            is_draft: input.is_draft,
            surroundings: input.surroundings.cloned(),
            behind: self.behind.as_ref().map_or(0, |behind| behind.number),
            details: hair.drawn.details.version,
            carried: input.carried.map(|carried| (Arc::clone(carried.style), carried.look)),
        })
    }

    /// Whether tiles of the last image, which has the same `grid`, had anything in them, by their number.
    pub(super) fn filled_tiles(&self, grid: &Grid) -> usize {
        (0..grid.columns * grid.rows).filter(|&tile| !self.placed.is_empty(tile)).count()
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Vec2, Vec3};
    use lovelock_groom::{StrandSet, Strands};

    use super::*;
    use crate::{Camera, HairPose, Picture, ShadowMethod, ShadowSettings, StrandCount};

    /// Strands of 20 points from the top down, one beside the other, in an image of eight by two tiles.
    fn points(columns: usize) -> Vec<ShadedPoint> {
        let of = |i: usize| ShadedPoint {
            x: 16.0 + 32.0 * (i / 20) as f32,
            y: 3.0 * (i % 20) as f32,
            depth: 0.1,
            half_width: 0.5,
            run_y: 1.0,
            ..ShadedPoint::default()
        };
        (0..20 * columns).map(of).collect()
    }

    #[test]
    fn tiles_are_those_of_segments_whose_light_or_place_changes() {
        let grid = Grid::new(256, 64);
        let segments: Vec<u32> = (0..160).filter(|i| i % 20 != 19).collect();
        let mut moved = Moved { before: points(8), ..Moved::default() };
        let mut found = |now: &[ShadedPoint]| {
            assert!(moved.find(now, &segments, &grid));
            let tiles: Vec<usize> =
                (0..16).filter(|&tile| moved.tiles()[tile].load(Ordering::Relaxed)).collect();
            assert_eq!(moved.count(), tiles.len());
            tiles
        };
        let still = points(8);
        assert!(found(&still).is_empty());
        // A root, whose tile is that of the points that it reaches.
        let mut now = still.clone();
        now[0].x += 1.0;
        assert_eq!(found(&now), [0]);
        // A point that lies in the upper tile and reaches points in the lower one.
        let mut now = still.clone();
        now[20 + 8].depth += 0.01;
        assert_eq!(found(&now), [1, 9]);
        // A tip moves to the left: where it was, where it is, and what its segment crosses.
        let mut now = still.clone();
        now[159].x -= 96.0;
        assert_eq!(found(&now), [12, 13, 14, 15]);
        // A strand that is not drawn any more, and the nearest points of the strands before and after it.
        let mut now = still.clone();
        now[60..80].iter_mut().for_each(|point| point.half_width = -1.0);
        assert_eq!(found(&now), [3, 4, 10, 11]);
        // Colours follow from the rest.
        let mut now = still.clone();
        now[5].color = [1.0; 3];
        assert!(found(&now).is_empty());
        assert!(!moved.find(&still[1..], &segments, &grid), "other strands");
    }

    #[test]
    fn an_image_that_is_no_draft_frees_what_drafts_are_compared_with() {
        let set = StrandSet { first_point: vec![0], ..StrandSet::default() };
        let style = Arc::new(Hairstyle { strands: set, ..Hairstyle::default() });
        let strands = Strands { first_point: Arc::from([0_u32]), ..Strands::default() };
        let shadow = ShadowSettings { method: ShadowMethod::None, ..ShadowSettings::default() };
        let camera = Camera { eye: Vec3::Z, target: Vec3::ZERO, fov_y: 0.5, shear: Vec2::ZERO };
        let picture = PictureSettings { strands: StrandCount::Stored, ..PictureSettings::default() };
        let moved = Moved { before: points(1), ..Moved::default() };
        let mut renderer = CpuRenderer { moved, ..CpuRenderer::default() };
        for is_draft in [true, false] {
            let input = FrameInput {
                style: &style,
                hair: HairPose::Strands(&strands),
                guides: None,
                look: HairLook::default(),
                body: None,
                world_from_head: Affine3A::IDENTITY,
                lights: &[],
                shadow: &shadow,
                camera: &camera,
                picture: &picture,
                is_draft,
                surroundings: None,
                backdrop: None,
                known: None,
                carried: None,
            };
            renderer.picture(&input, 32, 32, &mut Picture::default()).expect("an image");
            assert_eq!(renderer.moved.bytes() > 0, is_draft);
        }
    }
}
