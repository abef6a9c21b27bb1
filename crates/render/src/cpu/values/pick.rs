//! Which hair a pixel shows.

use lovelock_groom::Strands;
use rayon::prelude::*;

use super::{HairHit, ValueRenderer};
use crate::FrameInput;
use crate::cpu::hair::segment::is_drawn;
use crate::cpu::placed::{TileScratch, posed_body};
use crate::cpu::points::ShadedPoint;
use crate::cpu::tile::{Grid, STRIDE, TILE};
use crate::cpu::view::View;
use crate::picture::check_size;
use crate::uniform::FrameUniform;

/// How far beside a pixel its hair may lie, pixels.
const REACH: f32 = 4.0;

/// A segment near a pixel, at the place that is nearest to it.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    first: u32,
    /// Pixels from the edge of the strand to the pixel; 0 on it.
    gap: f32,
    /// 1 at the near plane, falling to 0 at infinity.
    depth: f32,
    /// Where it is, pixels from the left and from the top.
    place: [f32; 2],
    /// Whether the segment's second end is the nearer one.
    is_second: bool,
}

impl ValueRenderer {
    /// The strand point that the picture of `input` at `width` by `height` pixels shows at `pixel` (from the left and from the
    /// top; the first pixel's centre is at a half): of the foremost strand there, or of the one that comes nearest within four
    /// pixels. `None` where no hair is seen, and for a size that cannot be drawn.
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
        let uniform = FrameUniform::new(input, width, height, &[], 1);
        let view = View::new(&uniform, &[], &[], 1);
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

/// The segment from `a` to `b` where it comes nearest to a pixel, if it comes near.
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
    // As wide as it is drawn: no narrower than a pixel. Beyond its ends other segments go on.
    let half = mix(a.half_width, b.half_width).max(0.5);
    let gap = (along - held).hypot((across.abs() - half).max(0.0));
    let near = gap <= REACH;
    let place = [mix(a.x, b.x), mix(a.y, b.y)];
    near.then(|| Candidate { first, gap, depth: mix(a.depth, b.depth), place, is_second: part >= 0.5 })
}

/// The body before the strands, tile by tile as it is asked for.
struct BodyBefore<'a> {
    renderer: &'a ValueRenderer,
    grid: &'a Grid,
    input: &'a FrameInput<'a>,
    tiles: Vec<(usize, Box<TileScratch>)>,
}

impl BodyBefore<'_> {
    /// Whether the body hides a place in all samples of its pixel.
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
