//! The hair under a pixel.

use lovelock_groom::Strands;
use lovelock_picture::check_size;
use rayon::prelude::*;

use super::{HairHit, ValueRenderer};
use crate::FrameInput;
use crate::cpu::hair::fragments::is_drawn;
use crate::cpu::placed::{TileScratch, posed_body};
use crate::cpu::strand_points::ShadedPoint;
use crate::cpu::tile::{Grid, STRIDE, TILE};
use crate::cpu::view::{ShadingView, View};
use crate::scene_light::NO_LIGHT;
use crate::uniform::FrameUniform;

/// The largest distance of hair from the pixel, pixels.
const REACH: f32 = 4.0;

/// A segment near a pixel, at its nearest position.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    first: u32,
    /// Distance from the edge of the strand to the pixel, pixels; 0 on the strand.
    gap: f32,
    /// 1 at the near plane, falling to 0 at infinity.
    depth: f32,
    /// Its position, pixels from the left and from the top.
    place: [f32; 2],
    /// Whether the second end of the segment is nearer.
    is_second: bool,
}

impl ValueRenderer {
    /// The strand point at `pixel` (from the left and from the top; the centre of the first pixel is at 0.5) in the picture of `input`
    /// at `width` by `height` pixels: on the frontmost strand there, or on the nearest one within four pixels. `None` if there is no
    /// visible hair, or if the size is out of range.
    pub fn pick(&mut self, input: &FrameInput, width: u32, height: u32, pixel: [f32; 2]) -> Option<HairHit> {
        let inside =
            pixel[0] >= 0.0 && pixel[1] >= 0.0 && pixel[0] < width as f32 && pixel[1] < height as f32;
        if check_size(width, height).is_err() || !inside {
            return None;
        }
        let mut made = std::mem::take(&mut self.strands);
        let strands = input.hair.strands(input.style, &mut made);
        let hit = self.hit(input, strands, [width, height], pixel);
        self.strands = made;
        hit
    }

    fn hit(
        &mut self,
        input: &FrameInput,
        strands: &Strands,
        [width, height]: [u32; 2],
        pixel: [f32; 2],
    ) -> Option<HairHit> {
        let uniform = FrameUniform::new(input, None, &NO_LIGHT, (width, height), &[], 1);
        let view = View::new(&uniform, (&NO_LIGHT.grid, ShadingView::TwoHighlights), &[], &[], 1);
        let grid = self.place(&view, input, strands, width, height);
        let points = &self.placed.points;
        let near = |&first: &u32| {
            let (a, b) = (points.get(first as usize)?, points.get(first as usize + 1)?);
            candidate(first, a, b, pixel)
        };
        let mut found: Vec<_> =
            self.placed.segments().par_iter().with_min_len(8192).filter_map(near).collect();
        found.sort_by(|a, b| a.gap.total_cmp(&b.gap).then(b.depth.total_cmp(&a.depth)));
        self.placed.sort(&view, &grid, input, strands, &[]);
        let mut body = BodyBefore { renderer: self, grid: &grid, input, tiles: Vec::new() };
        let seen = found.iter().find(|candidate| !body.hides(candidate))?;
        let point = seen.first as usize + usize::from(seen.is_second);
        let strand = strands.first_point.partition_point(|&first| first as usize <= point).checked_sub(1)?;
        Some(HairHit { strand, point, position: strands.point(point) })
    }
}

/// The nearest position to a pixel on the segment from `a` to `b`, if it is near.
fn candidate(first: u32, a: &ShadedPoint, b: &ShadedPoint, pixel: [f32; 2]) -> Option<Candidate> {
    if !is_drawn(a, b) {
        return None;
    }
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let (px, py) = (pixel[0] - a.x, pixel[1] - a.y);
    let length = dx.hypot(dy);
    let [ux, uy] = if length > 1e-4 { [dx / length, dy / length] } else { [0.0, 1.0] };
    let (along, across) = (px * ux + py * uy, px * uy - py * ux);
    let held = along.clamp(0.0, length);
    let part = if length > 1e-4 { held / length } else { 0.0 };
    let mix = |a: f32, b: f32| a + (b - a) * part;
    // At the drawn width, at least a pixel. Other segments continue beyond its ends.
    let half = mix(a.half_width, b.half_width).max(0.5);
    let gap = (along - held).hypot((across.abs() - half).max(0.0));
    let near = gap <= REACH;
    let place = [mix(a.x, b.x), mix(a.y, b.y)];
    near.then(|| Candidate { first, gap, depth: mix(a.depth, b.depth), place, is_second: part >= 0.5 })
}

/// The body in front of strands, rasterised per tile on demand.
struct BodyBefore<'a> {
    renderer: &'a ValueRenderer,
    grid: &'a Grid,
    input: &'a FrameInput<'a>,
    tiles: Vec<(usize, Box<TileScratch>)>,
}

impl BodyBefore<'_> {
    /// Whether the body hides a position in all samples of its pixel.
    fn hides(&mut self, candidate: &Candidate) -> bool {
        let within = |c: f32, side: u32| (c.max(0.0) as usize).min(side as usize - 1);
        let (x, y) =
            (within(candidate.place[0], self.grid.width), within(candidate.place[1], self.grid.height));
        let tile = y / TILE * self.grid.columns + x / TILE;
        let known = self.tiles.iter().position(|(of, _)| *of == tile).unwrap_or_else(|| {
            let mut scratch = Box::<TileScratch>::default();
            self.renderer.placed.draw_body(self.grid, posed_body(self.input), tile, &mut scratch);
            self.tiles.push((tile, scratch));
            self.tiles.len() - 1
        });
        let depths = self.tiles[known].1.samples.depths(y % TILE * STRIDE + x % TILE);
        depths.iter().all(|&body| candidate.depth < body)
    }
}
