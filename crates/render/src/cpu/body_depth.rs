//! The depth map of the body for a light.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use glam::{Mat4, Vec3, Vec4};
use lovelock_base::memory::list_bytes;
use lovelock_base::simd::Width;
use lovelock_base::simd_versions;
use rayon::prelude::*;

use super::math::{floor, index_of, least, max, min, most, three};

/// Texels along each edge of a map. A texel is about two millimetres for a standing figure.
pub(super) const SIZE: usize = 1024;
/// Texels of a row that are drawn together.
const LANES: usize = 8;
/// The inverse of a difference of depth that is not zero.
const STEEP: f32 = 1e30;

/// Rows per task.
const BAND_ROWS: usize = 64;
/// Texels along each edge of a block, for which the nearest and farthest depth are stored.
const BLOCK: usize = 32;
/// Blocks along each edge of a map.
const BLOCKS_IN_ROW: usize = SIZE / BLOCK;

/// Depth along a light, 0 to 1 over its view; 1 where there is no body.
#[derive(Clone, Debug)]
pub(super) struct DepthMap {
    depth: Box<[f32; SIZE * SIZE]>,
    /// Nearest and farthest depth of each block of texels, row after row.
    blocks: Vec<[f32; 2]>,
    placed: Vec<Vec3>,
    /// Triangles per band: the start of each band, and indices.
    starts: Vec<u32>,
    sorted: Vec<u32>,
}

impl Default for DepthMap {
    fn default() -> Self {
        let Ok(depth) = vec![1.0; SIZE * SIZE].into_boxed_slice().try_into() else {
            unreachable!("as long as it was made")
        };
        Self {
            depth,
            blocks: vec![[1.0; 2]; (SIZE / BLOCK) * (SIZE / BLOCK)],
            placed: Vec::new(),
            starts: Vec::new(),
            sorted: Vec::new(),
        }
    }
}

/// Holes of surfaces that are not opaque, through which light passes.
pub(super) trait Holes: Sync {
    /// Whether a triangle may have holes.
    fn has_holes(&self, triangle: u32) -> bool;

    /// Whether a triangle blocks light at the barycentric coordinates `shares`, in a map in which these change by `steps` from column
    /// to column and from row to row.
    fn blocks(&self, triangle: u32, shares: [f32; 3], steps: [[f32; 3]; 2]) -> bool;
}

/// What casts a shadow.
#[derive(Clone, Copy)]
pub(super) struct Casters<'a> {
    pub vertices: &'a [Vec3],
    pub triangles: &'a [[u32; 3]],
    /// Whether triangles facing away from the light are behind others.
    pub closed: bool,
    pub holes: Option<&'a dyn Holes>,
}

/// The input of a band of rows.
pub(super) struct Band<'a> {
    pub first_row: usize,
    /// Texels from the left and top, and depth.
    pub placed: &'a [Vec3],
    pub triangles: &'a [[u32; 3]],
    pub list: &'a [u32],
    pub holes: Option<&'a dyn Holes>,
    /// Whose holes each triangle has, if these are not its own.
    pub ids: Option<&'a [u32]>,
}

impl DepthMap {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        size_of_val(&*self.depth) as u64
            + list_bytes(&self.blocks)
            + list_bytes(&self.placed)
            + list_bytes(&self.starts)
            + list_bytes(&self.sorted)
    }

    /// Rasterises what casts a shadow.
    pub fn draw(&mut self, width: Width, shadow_from_world: Mat4, casters: &Casters) {
        let half = 0.5 * SIZE as f32;
        casters
            .vertices
            .par_iter()
            .with_min_len(4096)
            .map(|&p| {
                let at = shadow_from_world * p.extend(1.0);
                Vec3::new((at.x + 1.0) * half, (1.0 - at.y) * half, at.z)
            })
            .collect_into_vec(&mut self.placed);
        self.rasterise(width, casters, None);
    }

    /// As [`DepthMap::draw`], for a view whose fourth coordinate is the distance along its axis. Triangles before its near end are cut
    /// off there.
    pub fn draw_perspective(&mut self, width: Width, from_world: Mat4, casters: &Casters) {
        let triangles = casters.triangles;
        let clip: Vec<Vec4> = casters.vertices.par_iter().map(|&p| from_world * p.extend(1.0)).collect();
        clip.par_iter().map(|&at| on_map(at)).collect_into_vec(&mut self.placed);
        let mut seen = Vec::with_capacity(triangles.len());
        // Triangles that are cut off have no holes.
        let mut ids = Vec::new();
        for (id, corners) in triangles.iter().enumerate() {
            let found = corners.map(|i| clip.get(i as usize).copied().unwrap_or(Vec4::NAN));
            if found.iter().all(|at| at.z >= 0.0) {
                seen.push(*corners);
                if casters.holes.is_some() {
                    ids.push(id as u32);
                }
                continue;
            }
            let first = self.placed.len() as u32;
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let (a, b) = (found[a], found[b]);
                if a.z >= 0.0 {
                    self.placed.push(on_map(a));
                }
                // Not for NaN.
                if (a.z >= 0.0 && b.z < 0.0) || (a.z < 0.0 && b.z >= 0.0) {
                    self.placed.push(on_map(a.lerp(b, a.z / (a.z - b.z))));
                }
            }
            for last in first + 2..self.placed.len() as u32 {
                seen.push([first, last - 1, last]);
                if casters.holes.is_some() {
                    ids.push(u32::MAX);
                }
            }
        }
        self.rasterise(width, &Casters { triangles: &seen, ..*casters }, Some(&ids));
    }

    /// Draws triangles of placed vertices.
    fn rasterise(&mut self, width: Width, casters: &Casters, ids: Option<&[u32]>) {
        let Casters { triangles, closed, holes, .. } = *casters;
        self.sort_by_band(triangles, closed);
        let (placed, starts, sorted) = (&self.placed, &self.starts, &self.sorted);
        self.depth
            .par_chunks_mut(BAND_ROWS * SIZE)
            .zip(self.blocks.par_chunks_mut(BAND_ROWS / BLOCK * (SIZE / BLOCK)))
            .enumerate()
            .for_each(|(band, (rows, blocks))| {
                let list = &sorted[starts[band] as usize..starts[band + 1] as usize];
                let input = Band { first_row: band * BAND_ROWS, placed, triangles, list, holes, ids };
                draw_band_simd(width.for_eight(), &input, rows, blocks);
            });
    }

    /// Lists the triangles that touch each band of rows.
    fn sort_by_band(&mut self, triangles: &[[u32; 3]], closed: bool) {
        let bands = SIZE / BAND_ROWS;
        let placed = &self.placed;
        let last = (SIZE - 1) as f32;
        let range = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|i| placed.get(i as usize).copied().unwrap_or(Vec3::NAN));
            // Rows count downward, which reverses the counter-clockwise orientation of front faces.
            if closed && (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0.0 {
                return None;
            }
            let (low, high) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
            // False for NaN.
            let seen = low <= last && high >= 0.0 && (a.y + b.y + c.y).is_finite();
            let band = |y: f32| y.clamp(0.0, last) as usize / BAND_ROWS;
            seen.then(|| (band(low), band(high)))
        };
        self.starts.clear();
        self.starts.resize(bands + 1, 0);
        for (low, high) in triangles.iter().filter_map(range) {
            for band in low..=high {
                self.starts[band + 1] += 1;
            }
        }
        for band in 0..bands {
            self.starts[band + 1] += self.starts[band];
        }
        self.sorted.resize(self.starts[bands] as usize, 0);
        let mut next = self.starts.clone();
        for (i, triangle) in triangles.iter().enumerate() {
            if let Some((low, high)) = range(triangle) {
                for slot in &mut next[low..=high] {
                    self.sorted[*slot as usize] = i as u32;
                    *slot += 1;
                }
            }
        }
    }

    /// Adds, for positions at `u`, `v` and depth `z`, the bilinear fraction of the four texels around them that are not nearer to
    /// the light.
    #[inline(always)]
    pub fn add_compared<const N: usize>(&self, u: &[f32; N], v: &[f32; N], z: &[f32; N], sum: &mut [f32; N]) {
        // One texel remains to the right and below for the neighbours.
        const LAST: f32 = (SIZE - 1) as f32 - 1e-3;
        let size = SIZE as f32;
        let mut at = [0_u32; N];
        let (mut right, mut below, mut held) = ([0.0; N], [0.0; N], [0.0; N]);
        for lane in 0..N {
            let x = min(max(u[lane] * size - 0.5, 0.0), LAST);
            let y = min(max(v[lane] * size - 0.5, 0.0), LAST);
            let (x0, y0) = (floor(x), floor(y));
            (right[lane], below[lane]) = (x - x0, y - y0);
            // Sums that are checked for overflow do not vectorise. The size is a power of two.
            at[lane] = index_of(y0) << SIZE.ilog2() | index_of(x0);
            // Nothing behind the far end of the map blocks light.
            held[lane] = min(z[lane], 1.0);
        }
        let upper = self.lit_between(&at, 0, &held, &right);
        let lower = self.lit_between(&at, SIZE as u32, &held, &right);
        for lane in 0..N {
            sum[lane] += upper[lane] + (lower[lane] - upper[lane]) * below[lane];
        }
    }

    /// The linear fraction of two texels, `offset` after those of `at` and beside those, that are not nearer than `z`.
    #[inline(always)]
    fn lit_between<const N: usize>(
        &self,
        at: &[u32; N],
        offset: u32,
        z: &[f32; N],
        right: &[f32; N],
    ) -> [f32; N] {
        let (first, second) = (self.lit(at, offset, z), self.lit(at, offset + 1, z));
        let mut lit = [0.0; N];
        for lane in 0..N {
            lit[lane] = first[lane] + (second[lane] - first[lane]) * right[lane];
        }
        lit
    }

    /// 1 for texels `offset` after those of `at` that are not nearer than `z`, 0 for others.
    #[inline(always)]
    fn lit<const N: usize>(&self, at: &[u32; N], offset: u32, z: &[f32; N]) -> [f32; N] {
        // Loads have a loop of their own: they would prevent vectorisation of the other one.
        let mut depth = [0.0; N];
        for lane in 0..N {
            // The size is a power of two, so the compiler removes the bounds check.
            depth[lane] = self.depth[at[lane].wrapping_add(offset) as usize % (SIZE * SIZE)];
        }
        let mut lit = [0.0; N];
        for lane in 0..N {
            // A comparison, without the branch or mask per number that the compiler makes of one. No difference of depths is as small
            // as 1e-30.
            lit[lane] = min(max((depth[lane] - z[lane]) * STEEP + 1.0, 0.0), 1.0);
        }
        lit
    }

    /// What [`DepthMap::add_compared`] adds for every tap within `radius`, if the blocks around all positions determine it. The depth
    /// of a tap differs by at most `steepest` times `radius` from that of its position.
    #[inline(always)]
    pub fn all_alike<const N: usize>(
        &self,
        u: &[f32; N],
        v: &[f32; N],
        z: &[f32; N],
        radius: f32,
        steepest: f32,
    ) -> Option<f32> {
        let (size, last) = (SIZE as f32, (SIZE - 1) as f32);
        let range = |of: &[f32; N]| (least(of), most(of));
        let ((left, right), (top, bottom), (near, far)) = (range(u), range(v), range(z));
        // Half a texel for interpolation, and one for rounding.
        let reach = radius * size + 1.5;
        let block = |c: f32| index_of(floor(min(max(c, 0.0), last))) as usize / BLOCK;
        let (left, right) = (block(left * size - 0.5 - reach), block(right * size - 0.5 + reach));
        let (top, bottom) = (block(top * size - 0.5 - reach), block(bottom * size - 0.5 + reach));
        // Testing more blocks would take longer than the taps.
        if (right - left + 1) * (bottom - top + 1) > 36 {
            return None;
        }
        let (mut nearest, mut farthest) = (1.0, 0.0);
        for j in top..=bottom {
            for [near, far] in &self.blocks[j * BLOCKS_IN_ROW + left..=j * BLOCKS_IN_ROW + right] {
                nearest = min(*near, nearest);
                farthest = max(*far, farthest);
            }
        }
        let deeper = radius * steepest;
        if min(far + deeper, 1.0) <= nearest {
            Some(1.0)
        } else if min(near - deeper, 1.0) > farthest {
            Some(0.0)
        } else {
            None
        }
    }
}

/// The texels from the left and top, and the depth, of a position in clip space; not finite behind the eye.
fn on_map(at: Vec4) -> Vec3 {
    let half = 0.5 * SIZE as f32;
    let inverse = if at.w > 0.0 { 1.0 / at.w } else { f32::NAN };
    Vec3::new((at.x * inverse + 1.0) * half, (1.0 - at.y * inverse) * half, at.z * inverse)
}

simd_versions! {
    /// [`draw_band`] for the vectors of `width`.
    fn draw_band_simd(input: &Band, rows: &mut [f32], blocks: &mut [[f32; 2]]) -> () {
        draw_band(input, rows, blocks)
    }
}

/// Rasterises the triangles of a band and computes the depth range of its blocks.
#[inline(always)]
fn draw_band(input: &Band, rows: &mut [f32], blocks: &mut [[f32; 2]]) {
    rows.fill(1.0);
    for &triangle in input.list {
        let [i, j, k] = input.triangles[triangle as usize];
        let corners = [input.placed[i as usize], input.placed[j as usize], input.placed[k as usize]];
        if let Some(holes) = input.holes {
            let id = input.ids.map_or(triangle, |ids| ids[triangle as usize]);
            if id != u32::MAX && holes.has_holes(id) {
                draw_with_holes(corners, (holes, id), input.first_row, rows);
                continue;
            }
        }
        draw_triangle(corners, input.first_row, rows);
    }
    bound_blocks(rows, blocks);
}

/// Rasterises a triangle into the rows from `first_row` on: the texels whose centres it covers, in either orientation.
#[inline(always)]
fn draw_triangle([a, b, c]: [Vec3; 3], first_row: usize, rows: &mut [f32]) {
    let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    let is_some = area.abs() > 0.0 && area.abs() < f32::INFINITY;
    if !is_some {
        return;
    }
    let (low_x, high_x) = (min(a.x, min(b.x, c.x)), max(a.x, max(b.x, c.x)));
    let (low_y, high_y) = (min(a.y, min(b.y, c.y)), max(a.y, max(b.y, c.y)));
    let rows_here = rows.len() / SIZE;
    // The first centre at or after a coordinate.
    let centre = |v: f32, most: f32| min(max(v + 0.5, 0.0), most) as usize;
    let (x0, x1) = (centre(low_x, SIZE as f32), centre(high_x, SIZE as f32));
    let from_row = |v: f32| centre(v - first_row as f32, rows_here as f32);
    let (y0, y1) = (from_row(low_y), from_row(high_y));
    if x0 >= x1 {
        return;
    }
    let inverse = 1.0 / area;
    // Depth and the barycentric coordinates of b and c are linear over the texels.
    let (bx, by) = ((c.y - a.y) * inverse, (a.x - c.x) * inverse);
    let (cx, cy) = ((a.y - b.y) * inverse, (b.x - a.x) * inverse);
    let (zx, zy) = (bx * (b.z - a.z) + cx * (c.z - a.z), by * (b.z - a.z) + cy * (c.z - a.z));
    let mut steps = [[0.0; LANES]; 3];
    for (steps, by) in steps.iter_mut().zip([bx, cx, zx]) {
        for (lane, step) in steps.iter_mut().enumerate() {
            *step = by * lane as f32;
        }
    }
    for y in y0..y1 {
        let dy = (first_row + y) as f32 + 0.5 - a.y;
        for x in (x0..x1).step_by(LANES) {
            // The last run of a row starts earlier, so that it does not exceed the row.
            let x = x.min(SIZE - LANES);
            let dx = x as f32 + 0.5 - a.x;
            let start = [bx * dx + by * dy, cx * dx + cy * dy, a.z + zx * dx + zy * dy];
            let Some((depth, _)) = rows[y * SIZE + x..].split_first_chunk_mut::<LANES>() else { return };
            for lane in 0..LANES {
                let [b, c, z] = three(|k| start[k] + steps[k][lane]);
                // The least of the three coordinates decides: one comparison vectorises, several do not.
                let inside = min(min(b, c), 1.0 - (b + c));
                let nearer = if inside >= 0.0 { z } else { f32::INFINITY };
                depth[lane] = min(nearer, depth[lane]);
            }
        }
    }
}

/// As [`draw_triangle`], texel by texel, for a triangle through which light may pass.
fn draw_with_holes([a, b, c]: [Vec3; 3], (holes, id): (&dyn Holes, u32), first_row: usize, rows: &mut [f32]) {
    let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    let is_some = area.abs() > 0.0 && area.abs() < f32::INFINITY;
    if !is_some {
        return;
    }
    let centre = |v: f32, most: f32| min(max(v + 0.5, 0.0), most) as usize;
    let from_row = |v: f32| centre(v - first_row as f32, (rows.len() / SIZE) as f32);
    let (x0, x1) = (centre(a.x.min(b.x).min(c.x), SIZE as f32), centre(a.x.max(b.x).max(c.x), SIZE as f32));
    let (y0, y1) = (from_row(a.y.min(b.y).min(c.y)), from_row(a.y.max(b.y).max(c.y)));
    let inverse = 1.0 / area;
    let steps = [
        [(b.y - c.y) * inverse, (c.y - a.y) * inverse, (a.y - b.y) * inverse],
        [(c.x - b.x) * inverse, (a.x - c.x) * inverse, (b.x - a.x) * inverse],
    ];
    for y in y0..y1 {
        let dy = (first_row + y) as f32 + 0.5 - a.y;
        for x in x0..x1 {
            let dx = x as f32 + 0.5 - a.x;
            let share = |corner: usize| steps[0][corner] * dx + steps[1][corner] * dy;
            let shares = [1.0 + share(0), share(1), share(2)];
            let z = a.z * shares[0] + b.z * shares[1] + c.z * shares[2];
            let depth = &mut rows[y * SIZE + x];
            let is_inside = shares.iter().all(|share| *share >= 0.0);
            if is_inside && z < *depth && holes.blocks(id, shares, steps) {
                *depth = z;
            }
        }
    }
}

/// Computes the nearest and farthest depth of each block of some rows.
#[inline(always)]
fn bound_blocks(rows: &[f32], blocks: &mut [[f32; 2]]) {
    for (rows, blocks) in rows.chunks_exact(BLOCK * SIZE).zip(blocks.chunks_exact_mut(SIZE / BLOCK)) {
        // Whole rows, which vectorise; then the columns of each block.
        let (mut near, mut far) = ([1.0; SIZE], [0.0; SIZE]);
        for row in rows.as_chunks::<SIZE>().0 {
            for x in 0..SIZE {
                near[x] = min(row[x], near[x]);
                far[x] = max(row[x], far[x]);
            }
        }
        let columns = near.as_chunks::<BLOCK>().0.iter().zip(far.as_chunks::<BLOCK>().0);
        for (block, (near, far)) in blocks.iter_mut().zip(columns) {
            *block = [1.0, 0.0];
            for (&near, &far) in near.iter().zip(far) {
                *block = [min(near, block[0]), max(far, block[1])];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    fn drawn(vertices: &[Vec3], triangles: &[[u32; 3]]) -> DepthMap {
        let mut map = DepthMap::default();
        let casters = Casters { vertices, triangles, closed: false, holes: None };
        map.draw(Width::widest(), Mat4::IDENTITY, &casters);
        map
    }

    /// A square in the middle of the view at depth 0.5, of a quarter of the map's edge.
    fn map() -> DepthMap {
        let corners = [(-0.25, -0.25), (0.25, -0.25), (0.25, 0.25), (-0.25, 0.25)];
        let vertices: Vec<_> = corners.iter().map(|&(x, y)| Vec3::new(x, y, 0.5)).collect();
        drawn(&vertices, &[[0, 1, 2], [0, 3, 2]])
    }

    fn compare(map: &DepthMap, uv: Vec2, z: f32) -> f32 {
        let mut sum = [0.0];
        map.add_compared(&[uv.x], &[uv.y], &[z], &mut sum);
        sum[0]
    }

    #[test]
    fn a_square_covers_its_texels_and_no_others() {
        let map = map();
        let covered = map.depth.iter().filter(|z| **z == 0.5).count();
        assert_eq!(covered, 256 * 256, "both windings, shared edge once or twice");
        assert_eq!(map.depth.iter().filter(|z| **z == 1.0).count(), SIZE * SIZE - 256 * 256);
        assert_eq!(map.depth[512 * SIZE + 512], 0.5);
    }

    #[test]
    fn triangles_at_the_borders_are_drawn_whole() {
        let vertices = [(-3.0, -1.0), (3.0, -1.0), (0.0, 5.0)].map(|(x, y)| Vec3::new(x, y, 0.25));
        let map = drawn(&vertices, &[[0, 1, 2]]);
        assert!(map.depth.iter().all(|z| *z == 0.25), "the view lies within the triangle");
    }

    #[test]
    fn a_floor_under_the_light_is_cut_off_at_its_near_end() {
        // Seen along −z with a right angle; near at 0.1, far at 10. The floor is one metre below and reaches behind the eye.
        let rows = [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, -10.0 / 9.9, -1.0 / 9.9],
            [0.0, 0.0, -1.0, 0.0],
        ];
        let view = Mat4::from_cols_array_2d(&rows).transpose();
        let floor = [(-50.0, -9.0), (50.0, -9.0), (0.0, 50.0)].map(|(x, z)| Vec3::new(x, -1.0, z));
        let mut map = DepthMap::default();
        let casters = Casters { vertices: &floor, triangles: &[[0, 1, 2]], closed: false, holes: None };
        map.draw_perspective(Width::widest(), view, &casters);
        let at = |map: &DepthMap, row: usize| map.depth[row * SIZE + SIZE / 2];
        assert_eq!(at(&map, SIZE / 4), 1.0, "the sky");
        // Rows between the horizon and the lower edge show the floor at the distance at which their ray meets it.
        for row in [600, 700, 900, 1020] {
            let distance = 512.0 / (row as f32 + 0.5 - 512.0);
            let wanted = (10.0 / 9.9) * (1.0 - 0.1 / distance);
            let found = at(&map, row);
            assert!((found - wanted).abs() < 1e-4, "{row}: {found} for {wanted}");
        }
        map.draw(Width::widest(), view, &casters);
        assert_eq!(at(&map, 900), 1.0, "control: without the division the floor is a line");
    }

    #[test]
    fn behind_is_dark_before_and_beside_are_lit() {
        let map = map();
        let (middle, beside, edge) = (Vec2::splat(0.5), Vec2::splat(0.2), Vec2::new(0.375, 0.5));
        assert_eq!(compare(&map, middle, 0.6), 0.0);
        assert_eq!(compare(&map, middle, 0.4), 1.0);
        assert_eq!(compare(&map, beside, 0.6), 1.0);
        assert!((compare(&map, edge, 0.6) - 0.5).abs() < 1e-3, "half of the texels at the edge");
    }

    #[test]
    fn blocks_agree_with_texels() {
        let map = map();
        let mut told = 0;
        for i in 0..64 {
            for (j, z) in [(10, 0.2), (31, 0.55), (32, 0.497), (32, 0.503), (33, 0.9), (60, 0.5), (62, 0.51)]
            {
                let (u, v) = ([i as f32 / 64.0; 2], [j as f32 / 64.0, j as f32 / 64.0 + 0.01]);
                if let Some(all) = map.all_alike(&u, &v, &[z; 2], 0.01, 0.5) {
                    told += 1;
                    for (x, y, deeper) in
                        [(0.0, 0.0, 0.0), (1.0, 0.0, 0.5), (0.0, -1.0, -0.5), (-0.7, -0.7, 0.4)]
                    {
                        let mut sum = [0.0; 2];
                        let (u, v) = (u.map(|u| u + 0.01 * x), v.map(|v| v + 0.01 * y));
                        map.add_compared(&u, &v, &[z + 0.01 * deeper; 2], &mut sum);
                        assert_eq!(sum, [all; 2], "{u:?} {z}");
                    }
                }
            }
        }
        assert!(told > 100, "the blocks must tell something: {told}");
    }

    #[test]
    fn nonsense_is_left_out() {
        let vertices = [Vec3::NAN, Vec3::INFINITY, Vec3::ZERO, Vec3::X];
        let map = drawn(&vertices, &[[0, 1, 2], [2, 2, 3], [2, 3, 1]]);
        assert!(map.depth.iter().all(|z| *z == 1.0));
    }
}
