//! Hair and body sorted into the tiles of a picture, and what is visible of them in each.

mod hair;

use std::sync::Arc;

use glam::Vec3;
use lovelock_base::memory::list_bytes;
use lovelock_base::simd::Width;
use lovelock_groom::Strands;
use lovelock_motion::{Body, Skin};
use rayon::prelude::*;

use super::bins::Bins;
use super::clusters::PlacedClusters;
use super::hair::fragments::{bounds, is_drawn};
use super::hair::list::Fragments;
use super::hair::opaque_depths::OpaqueDepths;
use super::hair::order::{NearFirst, Pieces, SegmentKeys};
use super::hair::state::BlendState;
use super::hair::weigh::Weighed;
use super::strand_points::{PointsIn, ShadedPoint, ShadedPoints, shade_all};
use super::surface::PlacedSurface;
use super::surface::materials::Cutouts;
use super::surface::raster::{Occlusion, SurfaceSamples, TriangleTile, raster_triangles_simd};
use super::tile::{Grid, HairPlanes, TILE};
use super::view::View;
use super::visible::{LateInput, LateLight, Wanted};
use crate::closed::{Closedness, encloses};
use crate::strand_details::StrandDetails;
use crate::{FrameInput, Transparency};

/// The projected content of a picture, sorted into tiles; kept from frame to frame.
#[derive(Debug)]
pub(super) struct PlacedScene {
    pub width: Width,
    /// Whether light is computed at every strand point and the body's shadow at every pixel, also where they vary evenly.
    pub is_exact: bool,
    /// Whether light is computed at every strand point, also at those that show in no pixel.
    pub lights_hidden: bool,
    pub points: Vec<ShadedPoint>,
    /// The light of points, where it is computed after it is known which of them show.
    late: LateLight,
    /// First points of segments, in the order of points; see [`PlacedScene::segments`].
    all_segments: Arc<Vec<u32>>,
    whole: usize,
    /// The first point of carried hair, if there is any behind the points of the hairstyle, and the number of its segments.
    carried: Option<(usize, usize)>,
    pub surface: PlacedSurface,
    pub segment_bins: Bins,
    keys: SegmentKeys,
    closed: Closedness,
    /// Hair that is drawn as clusters, beside strands or in their place.
    pub clusters: PlacedClusters,
}

/// Scratch memory of a thread for one tile.
#[derive(Debug, Default)]
pub(super) struct TileScratch {
    pub samples: SurfaceSamples,
    pub hair: HairPlanes,
    hidden: Occlusion,
    blend: BlendState,
    order: Vec<u64>,
    pieces: Pieces,
    weighed: Weighed,
    wanted: Wanted,
    near_first: NearFirst,
    opaque: OpaqueDepths,
    fragments: Fragments,
}

impl TileScratch {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        size_of_val(self) as u64
            + list_bytes(&self.order)
            + self.pieces.bytes()
            + self.weighed.bytes()
            + self.wanted.bytes()
            + self.near_first.bytes()
            + self.fragments.bytes()
    }
}

/// The body of a picture.
pub(super) type PosedBody<'a> = Option<(&'a Body, &'a Skin)>;

impl PlacedScene {
    pub fn new(width: Width) -> Self {
        Self {
            width,
            is_exact: false,
            lights_hidden: false,
            points: Vec::new(),
            late: LateLight::default(),
            all_segments: Arc::default(),
            whole: 0,
            carried: None,
            surface: PlacedSurface::default(),
            segment_bins: Bins::default(),
            keys: SegmentKeys::default(),
            closed: Closedness::default(),
            clusters: PlacedClusters::default(),
        }
    }

    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.points)
            + self.late.bytes()
            + self.surface.bytes()
            + self.segment_bins.bytes()
            + self.keys.bytes()
            + self.clusters.bytes()
    }

    /// Whether the surface of the body is closed.
    pub fn is_closed(&mut self, input: &FrameInput) -> bool {
        input.body.is_some_and(|(body, _)| self.closed.of(body))
    }

    /// Projects and shades the strand points, which have four packed `transmittance`s each.
    pub fn shade(
        &mut self,
        view: &View,
        (strands, details): (&Strands, &StrandDetails),
        transmittance: &[u32],
        is_draft: bool,
    ) {
        let from = PointsIn { strands, details: &details.words, transmittance, colours: details.colours() };
        shade_all(self.width, view, &from, self.shaded_points(is_draft), &mut self.points);
        self.late.leave();
        self.follow_segments(details);
    }

    /// Whether the light of strand points can wait until tiles show which of them are seen: where segments are blended from near to far. Other
    /// modes list the colours of all fragments first.
    pub fn is_late(&self, input: &FrameInput) -> bool {
        let is_whole = self.lights_hidden || self.is_exact;
        input.picture.transparency == Transparency::Sorted && !is_whole && self.clusters.ribs().is_none()
    }

    /// As [`PlacedScene::shade`], but light is computed while tiles are drawn with what is returned, at the points that show.
    pub fn place<'a>(
        &mut self,
        view: &'a View<'a>,
        (strands, details): (&'a Strands, &'a StrandDetails),
        transmittance: &'a [u32],
        is_draft: bool,
    ) -> LateInput<'a> {
        let from = PointsIn { strands, details: &details.words, transmittance, colours: details.colours() };
        let input = LateInput::new(view, from, self.shaded_points(is_draft));
        self.late.place(self.width, &input, &mut self.points);
        self.follow_segments(details);
        input
    }

    fn shaded_points(&self, is_draft: bool) -> ShadedPoints {
        if is_draft {
            ShadedPoints::Second
        } else if self.is_exact {
            ShadedPoints::All
        } else {
            ShadedPoints::Needed
        }
    }

    fn follow_segments(&mut self, details: &StrandDetails) {
        self.all_segments = Arc::clone(&details.segments);
        self.whole = details.segments.partition_point(|&first| (first as usize + 1) < self.points.len());
        self.carried = None;
    }

    /// The number of points whose light was computed, and of all.
    pub fn lit_points(&self) -> [usize; 2] {
        [self.points.len() - self.late.unlit(), self.points.len()]
    }

    /// Adds shaded points of carried hair. `segments` are those of the hairstyle and then those of the new points.
    pub fn append(&mut self, points: &[ShadedPoint], segments: &Arc<Vec<u32>>) {
        self.carried = Some((self.points.len(), segments.len() - self.whole));
        self.points.extend_from_slice(points);
        (self.all_segments, self.whole) = (Arc::clone(segments), segments.len());
    }

    /// The points of carried hair.
    pub fn carried_points(&mut self) -> &mut [ShadedPoint] {
        let first = self.carried.map_or(self.points.len(), |(first, _)| first);
        &mut self.points[first..]
    }

    /// The segments of all stored or fine strands, and how many of them are drawn.
    pub fn all_segments(&self) -> (&Arc<Vec<u32>>, usize) {
        (&self.all_segments, self.whole)
    }

    /// The number of segments of the hairstyle that are drawn.
    pub fn hair_segments(&self) -> usize {
        self.whole - self.carried.map_or(0, |(_, segments)| segments)
    }

    /// Draws no strand.
    pub fn clear_strands(&mut self) {
        self.points.clear();
        self.late.leave();
        (self.whole, self.carried) = (0, None);
    }

    /// First points of the segments whose points both exist, in the order of points.
    pub fn segments(&self) -> &[u32] {
        &self.all_segments[..self.whole]
    }

    /// Sorts segments and triangles into tiles, after points are shaded. `hair_on_body` holds one word of packed transmittances per
    /// vertex.
    pub fn sort(
        &mut self,
        view: &View,
        grid: &Grid,
        input: &FrameInput,
        strands: &Strands,
        hair_on_body: &[u32],
    ) {
        let body = posed_body(input);
        // From within, the faces that look away from the eye are those behind the wall.
        let seen_from_without = self.is_closed(input)
            && body.is_some_and(|(body, skin)| {
                !encloses(input.camera.eye, &skin.positions, &body.mesh.triangles)
            });
        let points = &self.points;
        let (segments, carried) = (&self.all_segments[..self.whole], self.carried);
        let (surface, bins, keys) = (&mut self.surface, &mut self.segment_bins, &mut self.keys);
        rayon::join(
            || {
                let (from_world, hair) = (view.uniform.clip_from_world, (hair_on_body, seen_from_without));
                surface.place(from_world, grid, input.body, hair, &input.picture.body_look);
            },
            || {
                bins.fill(segments.len(), grid.columns, grid.rows, |i| {
                    let first = segments[i] as usize;
                    let (a, b) = (points.get(first)?, points.get(first + 1)?);
                    if is_drawn(a, b) { grid.range(bounds(a, b)) } else { None }
                });
                if input.picture.transparency == Transparency::Sorted {
                    let forward = (input.camera.target - input.camera.eye).normalize_or_zero();
                    let more = carried.zip(input.carried).map(|((first, _), hair)| (first, hair.strands));
                    keys.measure(strands, more, segments, forward);
                }
            },
        );
    }

    /// Whether a tile is empty.
    pub fn is_empty(&self, tile: usize) -> bool {
        self.surface.bins.of(tile).is_empty()
            && self.segment_bins.of(tile).is_empty()
            && self.clusters.is_empty(tile)
    }

    /// Rasterises the body in a tile, and the hair in front of it. Points have their colours, or their light is computed from `late`.
    pub fn draw_tile(
        &self,
        (view, late): (&View, Option<&LateInput>),
        grid: &Grid,
        input: &FrameInput,
        tile: usize,
        scratch: &mut TileScratch,
    ) {
        self.draw_body(grid, posed_body(input), tile, scratch);
        scratch.hair.clear();
        let segments = self.segment_bins.of(tile);
        let transparency = input.picture.transparency;
        if !self.clusters.is_empty(tile) {
            self.draw_mixed(view, transparency, grid.origin(tile), (tile, segments), scratch);
        } else if !segments.is_empty() {
            self.draw_hair((view, late), transparency, grid.origin(tile), segments, scratch);
        }
    }

    /// Rasterises the body in a tile.
    pub fn draw_body(&self, grid: &Grid, body: PosedBody, tile: usize, scratch: &mut TileScratch) {
        scratch.samples.clear();
        scratch.hidden.clear();
        let list = self.surface.bins.of(tile);
        if let Some((body, _)) = body
            && !list.is_empty()
        {
            let (vertices, triangles) = (&self.surface.vertices[..], &body.mesh.triangles[..]);
            let cutouts = self.surface.materials.as_ref().map(|materials| Cutouts { materials, body });
            let input = TriangleTile { origin: grid.origin(tile), vertices, triangles, list, cutouts };
            raster_triangles_simd(self.width, &input, &mut scratch.samples, &mut scratch.hidden);
        }
    }
}

/// The body of a picture, as its parts.
pub(super) fn posed_body<'a>(input: &FrameInput<'a>) -> PosedBody<'a> {
    input.body.map(|(body, skin)| (&**body, skin))
}

/// Positions and triangles of the body of a picture.
pub(super) fn surface_of<'a>(input: &FrameInput<'a>) -> (&'a [Vec3], &'a [[u32; 3]]) {
    posed_body(input).map_or((&[], &[]), |(body, skin)| (&skin.positions, &body.mesh.triangles))
}

/// Copies items of finished tiles, `per_pixel` per pixel, into the rows of a picture.
pub(super) fn copy_rows<T: Copy + Default + Send + Sync>(
    tiles: &[T],
    per_pixel: usize,
    grid: &Grid,
    out: &mut Vec<T>,
) {
    let row_items = grid.width as usize * per_pixel;
    let (line, tile_items) = (TILE * per_pixel, TILE * TILE * per_pixel);
    out.resize(row_items * grid.height as usize, T::default());
    out.par_chunks_mut(row_items).with_min_len(TILE).enumerate().for_each(|(y, row)| {
        let first = y / TILE * grid.columns;
        for (column, out) in row.chunks_mut(line).enumerate() {
            let start = (first + column) * tile_items + y % TILE * line;
            out.copy_from_slice(&tiles[start..start + out.len()]);
        }
    });
}
