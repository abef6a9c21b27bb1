//! The hair under the pointer.

use std::sync::Arc;

use egui::{Pos2, Vec2};
use glam::Vec3;
use lovelock_groom::{Hairstyle, Strands, interpolate};
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_style::strand_roots;

use super::View;
use super::head::Head;

/// Hair within this distance of the pointer is under it, points.
const NEAR: f32 = 5.0;
/// The same in cells, at least: a cell and those around it.
const NEAR_CELLS: f32 = 1.5;
/// Side of a cell of the depths, points.
const CELL: f32 = 2.5;
/// The most cells to a side.
const MAX_CELLS: f32 = 512.0;
/// The most strands whose depth is found.
const MAX_STRANDS: usize = 3000;
/// A body of more triangles hides no hair here: to find its depth would take longer than an image.
const MAX_TRIANGLES: usize = 400_000;
/// A hit this far before another one hides it, metres.
const BEFORE: f32 = 0.01;

/// The depth of hair and body in an image.
///
/// It is found again for each image, from every few strands, so that it has the same instant on every device.
#[derive(Default)]
pub(crate) struct SeenHair {
    /// The style of the strands and what is left of it.
    thinned: Option<(Arc<Hairstyle>, Hairstyle)>,
    strands: Strands,
    /// The image: its step, its guides as a number, and the view.
    of: Option<(u64, u64, View)>,
    grid: Grid,
    hair: Depths,
    body: Depths,
}

/// Cells over the image.
#[derive(Clone, Copy, Default)]
struct Grid {
    origin: Pos2,
    /// Side of a cell, points.
    cell: f32,
    size: [usize; 2],
}

/// The nearest depth in each cell, metres along the view; infinite where there is nothing.
#[derive(Default)]
struct Depths(Vec<f32>);

impl SeenHair {
    /// The place of the nearest hair under a point of the screen, at the instant of the image, or on the body where that is nearer. On the
    /// head also without hair. World space; `None` beside the hair.
    pub(crate) fn at(
        &mut self,
        view: View,
        head: Head<'_>,
        snapshot: &FrameSnapshot,
        at: Pos2,
    ) -> Option<Vec3> {
        if !view.place.contains(at) {
            return None;
        }
        self.look(view, snapshot);
        let Some(hair) = self.hair.front(self.grid, at) else {
            return head.hit(view, at).map(|(place, _)| head.world_from_head.transform_point3(place));
        };
        let body = self.body.in_cell(self.grid, at);
        Some(view.at_depth(at, if body < hair - BEFORE { body } else { hair }))
    }

    /// Distance of what is in front at a point of the screen, hair or body, along the view: metres, infinite beside both.
    pub(crate) fn depth_at(&mut self, view: View, snapshot: &FrameSnapshot, at: Pos2) -> f32 {
        self.look(view, snapshot);
        self.hair.in_cell(self.grid, at).min(self.body.in_cell(self.grid, at))
    }

    /// Passes on the parts of strands that are in front in an image, on the screen, each with the root of its strand, head space. Only those
    /// whose root is `wanted`, and none of hair that comes as strands.
    pub(crate) fn strands_in_front(
        &mut self,
        view: View,
        snapshot: &FrameSnapshot,
        wanted: impl Fn(Vec3) -> bool,
        part: &mut dyn FnMut(Vec3, Vec<Pos2>),
    ) {
        self.look(view, snapshot);
        let Some((_, thinned)) = self.thinned.as_ref().filter(|_| snapshot.strands.is_none()) else { return };
        let first = &self.strands.first_point;
        for (root, ends) in strand_roots(thinned).into_iter().zip(first.windows(2)) {
            if !wanted(root) {
                continue;
            }
            let mut line = Vec::new();
            for i in ends[0] as usize..ends[1] as usize {
                let here = view.to_screen_and_depth(self.strands.point(i)).filter(|(at, depth)| {
                    let front = self.hair.in_cell(self.grid, *at).min(self.body.in_cell(self.grid, *at));
                    *depth < front + BEFORE
                });
                match here {
                    Some((at, _)) => line.push(at),
                    None if line.len() > 1 => part(root, std::mem::take(&mut line)),
                    None => line.clear(),
                }
            }
            if line.len() > 1 {
                part(root, line);
            }
        }
    }

    /// Finds the depths of an image, unless they are known.
    fn look(&mut self, view: View, snapshot: &FrameSnapshot) {
        let of = (snapshot.step, number_of(&snapshot.guides.guides.x), view);
        if self.of == Some(of) {
            return;
        }
        self.of = Some(of);
        self.grid = Grid::over(view);
        self.body.clear(self.grid);
        let triangles = &snapshot.scene.body.mesh.triangles;
        if triangles.len() <= MAX_TRIANGLES {
            self.body.draw_body(self.grid, view, &snapshot.skin.positions, triangles);
        }
        self.hair.clear(self.grid);
        if let Some(given) = &snapshot.strands {
            self.hair.draw_strands(self.grid, view, given);
            return;
        }
        let style = &snapshot.scene.style;
        if self.thinned.as_ref().is_none_or(|(of, _)| !Arc::ptr_eq(of, style)) {
            self.thinned = Some((Arc::clone(style), style.thinned(MAX_STRANDS)));
        }
        if let Some((_, thinned)) = &self.thinned {
            interpolate(thinned, &snapshot.guides, &mut self.strands);
            self.hair.draw_strands(self.grid, view, &self.strands);
        }
    }
}

/// A number that other values have another of, but for rare chances (FNV-1a of words).
fn number_of(values: &[f32]) -> u64 {
    let mix = |number: u64, value: &f32| (number ^ u64::from(value.to_bits())).wrapping_mul(0x0100_0000_01b3);
    values.iter().fold(0xcbf2_9ce4_8422_2325, mix)
}

impl Grid {
    fn over(view: View) -> Self {
        let size = view.place.size();
        let cell = CELL.max(size.max_elem() / MAX_CELLS);
        let size = [size.x, size.y].map(|side| (side / cell).ceil().max(1.0) as usize);
        Self { origin: view.place.min, cell, size }
    }

    /// A point of the screen in cells.
    fn place(self, at: Pos2) -> Vec2 {
        (at - self.origin) / self.cell
    }

    /// The index of the cell that holds a place in cells.
    fn index(self, Vec2 { x, y }: Vec2) -> Option<usize> {
        let inside = x >= 0.0 && y >= 0.0 && (x as usize) < self.size[0] && (y as usize) < self.size[1];
        inside.then(|| y as usize * self.size[0] + x as usize)
    }

    /// The cells of a row or a column from `from` to `to`, in cells; `side` is 0 along rows.
    fn range(self, side: usize, [from, to]: [f32; 2]) -> std::ops::Range<usize> {
        from.max(0.0) as usize..((to.max(-1.0) + 1.0) as usize).min(self.size[side])
    }
}

impl Depths {
    fn clear(&mut self, grid: Grid) {
        self.0.clear();
        self.0.resize(grid.size[0] * grid.size[1], f32::INFINITY);
    }

    fn put(&mut self, index: Option<usize>, depth: f32) {
        if let Some(nearest) = index.and_then(|index| self.0.get_mut(index)) {
            *nearest = nearest.min(depth);
        }
    }

    fn draw_strands(&mut self, grid: Grid, view: View, strands: &Strands) {
        for ends in strands.first_point.windows(2) {
            let mut before: Option<(Pos2, f32)> = None;
            for i in ends[0] as usize..ends[1] as usize {
                let here = view.to_screen_and_depth(strands.point(i));
                if let Some((to, far)) = here {
                    let (from, near) = before.unwrap_or((to, far));
                    // Long segments are those of hair that almost touches the camera.
                    let steps = ((to - from).length() / grid.cell).ceil().clamp(1.0, MAX_CELLS);
                    for step in 0..=steps as u16 {
                        let t = f32::from(step) / steps;
                        self.put(grid.index(grid.place(from + (to - from) * t)), near + (far - near) * t);
                    }
                }
                before = here;
            }
        }
    }

    /// Draws the cells whose middles lie in triangles.
    fn draw_body(&mut self, grid: Grid, view: View, places: &[Vec3], triangles: &[[u32; 3]]) {
        let seen = |place: &Vec3| view.to_screen_and_depth(*place).map(|(at, depth)| (grid.place(at), depth));
        let seen: Vec<Option<(Vec2, f32)>> = places.iter().map(seen).collect();
        for triangle in triangles {
            let [Some(a), Some(b), Some(c)] =
                triangle.map(|vertex| seen.get(vertex as usize).copied().flatten())
            else {
                continue;
            };
            let (ab, ac) = (b.0 - a.0, c.0 - a.0);
            let area = ab.x * ac.y - ab.y * ac.x;
            if area.abs() < 1e-6 {
                continue;
            }
            let low = a.0.min(b.0).min(c.0);
            let high = a.0.max(b.0).max(c.0);
            for row in grid.range(1, [low.y, high.y]) {
                for column in grid.range(0, [low.x, high.x]) {
                    let at = Vec2::new(column as f32 + 0.5, row as f32 + 0.5) - a.0;
                    let (u, v) = ((at.x * ac.y - at.y * ac.x) / area, (ab.x * at.y - ab.y * at.x) / area);
                    if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
                        let depth = a.1 + (b.1 - a.1) * u + (c.1 - a.1) * v;
                        self.put(Some(row * grid.size[0] + column), depth);
                    }
                }
            }
        }
    }

    /// The depth in the cell of a point of the screen.
    fn in_cell(&self, grid: Grid, at: Pos2) -> f32 {
        grid.index(grid.place(at)).and_then(|index| self.0.get(index)).copied().unwrap_or(f32::INFINITY)
    }

    /// The depth of the front around a point of the screen: behind a single strand that flies before it.
    fn front(&self, grid: Grid, at: Pos2) -> Option<f32> {
        let middle = grid.place(at);
        let reach = (NEAR / grid.cell).max(NEAR_CELLS);
        let mut found = Vec::new();
        for row in grid.range(1, [middle.y - reach, middle.y + reach]) {
            for column in grid.range(0, [middle.x - reach, middle.x + reach]) {
                let off = Vec2::new(column as f32 + 0.5, row as f32 + 0.5) - middle;
                let depth = self.0[row * grid.size[0] + column];
                if off.length() <= reach && depth.is_finite() {
                    found.push(depth);
                }
            }
        }
        found.sort_unstable_by(f32::total_cmp);
        found.get(found.len() / 4).copied()
    }
}

#[cfg(test)]
mod tests {
    use egui::{Rect, pos2, vec2};
    use lovelock_project::Project;
    use lovelock_project::files::Access;
    use lovelock_render::ValueRenderer;
    use lovelock_session::engine::Engine;
    use lovelock_session::scene::SceneLoader;

    use super::*;

    #[test]
    fn the_brush_lies_on_the_hair_of_the_image() {
        let mut project = Project::default();
        project.hair.groom.wisps = 120;
        project.hair.groom.strands_per_wisp = 20;
        project.camera.distance = 0.9;
        let scene = SceneLoader::new().load_now(&project, &Access::new()).expect("a scene").0;
        let mut engine = Engine::at_rest(scene, project.simulation, 1.0 / 60.0);
        let snapshot = engine.snapshot();
        let camera = snapshot.camera(&project.camera);
        let (width, height) = (480_u16, 480_u16);
        let place = Rect::from_min_size(pos2(30.0, 20.0), vec2(width.into(), height.into()));
        let view = View::of_camera(&camera, place).expect("a view");
        let head =
            Head { world_from_head: &snapshot.guides.world_from_head, scalp: &snapshot.scene.style.scalp };
        let input = snapshot.frame_input(&project, &camera);
        let (mut seen, mut drawn) = (SeenHair::default(), ValueRenderer::default());
        // How far the place of the brush is from the strand that the image shows, along the view; and that of the head below the hair.
        let (mut off, mut below, mut missed, mut over) = (Vec::new(), Vec::new(), 0, None);
        for row in 0..9_u8 {
            for column in 0..9_u8 {
                let pixel = [column, row].map(|i| 30.5 + 52.0 * f32::from(i));
                let at = place.min + vec2(pixel[0], pixel[1]);
                let Some(hit) = drawn.pick(&input, width.into(), height.into(), pixel) else { continue };
                let depth = |place: Vec3| (place.distance(view.eye) - hit.position.distance(view.eye)).abs();
                match seen.at(view, head, &snapshot, at) {
                    Some(found) => {
                        off.push(depth(found));
                        over = Some(at);
                    }
                    None => missed += 1,
                }
                let skin = head.hit(view, at).map(|(skin, _)| head.world_from_head.transform_point3(skin));
                below.extend(skin.map(depth));
            }
        }
        off.sort_by(f32::total_cmp);
        below.sort_by(f32::total_cmp);
        let [median, worst, other] =
            [off[off.len() / 2], off[off.len() * 9 / 10], below[below.len() / 2]].map(|metres| 1e3 * metres);
        println!(
            "{} places, {missed} missed, half within {median:.1} mm, nine of ten within {worst:.1} mm; the head {other:.1} mm",
            off.len()
        );
        // The image may show another strand than the front one.
        assert!(off.len() > 12 && missed == 0 && median < 7.0 && worst < 30.0);
        assert!(below.len() > 3 && other > 1.5 * median, "control: the head is not the hair");
        // Beside the hair and beside the image there is none.
        assert_eq!(seen.at(view, head, &snapshot, place.min + vec2(4.0, 4.0)), None);
        assert_eq!(seen.at(view, head, &snapshot, place.min - vec2(4.0, 4.0)), None);
        // The same step with other guides is another image.
        let over = over.expect("hair");
        let at = |seen: &mut SeenHair, snapshot: &FrameSnapshot| seen.at(view, head, snapshot, over);
        let here = at(&mut seen, &snapshot).expect("hair");
        let mut moved = FrameSnapshot::clone(&snapshot);
        let nearer = (view.eye - here).normalize_or(Vec3::Z) * 0.1;
        for (x, z) in moved.guides.guides.x.iter_mut().zip(&mut moved.guides.guides.z) {
            (*x, *z) = (*x + nearer.x, *z + nearer.z);
        }
        let there = at(&mut seen, &moved).expect("hair");
        assert!(there.distance(view.eye) < here.distance(view.eye) - 0.05, "{there} {here}");
    }

    #[test]
    fn a_body_before_the_hair_hides_it() {
        let camera = lovelock_render::Camera {
            eye: Vec3::Z * 2.0,
            target: Vec3::ZERO,
            fov_y: 0.5,
            shear: glam::Vec2::ZERO,
        };
        let place = Rect::from_min_size(pos2(0.0, 0.0), vec2(300.0, 300.0));
        let view = View::of_camera(&camera, place).expect("a view");
        let grid = Grid::over(view);
        let mut body = Depths::default();
        body.clear(grid);
        let wall = [Vec3::new(-9.0, -9.0, 0.5), Vec3::new(0.0, -9.0, 0.5), Vec3::new(0.0, 9.0, 0.5)];
        body.draw_body(
            grid,
            view,
            &[wall[0], wall[1], wall[2], Vec3::NAN],
            &[[0, 1, 2], [0, 1, 3], [0, 1, 7]],
        );
        let [hidden, free] = [140.0, 160.0].map(|x| body.in_cell(grid, pos2(x, 150.0)));
        assert!((hidden - 1.5).abs() < 1e-4 && free.is_infinite(), "{hidden} {free}");
        let mut hair = Depths::default();
        hair.clear(grid);
        let points = [Vec3::new(-0.1, 0.0, 0.0), Vec3::new(0.1, 0.0, 0.1)];
        let strands = Strands {
            first_point: Arc::from([0, 2]),
            x: points.map(|p| p.x).to_vec(),
            y: points.map(|p| p.y).to_vec(),
            z: points.map(|p| p.z).to_vec(),
        };
        hair.draw_strands(grid, view, &strands);
        let middle = hair.front(grid, pos2(150.0, 152.0)).expect("a strand");
        assert!((middle - 1.95).abs() < 0.01, "{middle}");
        assert_eq!(hair.front(grid, pos2(150.0, 180.0)), None);
        // A large image has larger cells, and still finds the hair in the cell of the pointer.
        let large = View::of_camera(&camera, Rect::from_min_size(pos2(0.0, 0.0), vec2(7680.0, 7680.0)));
        let large = large.expect("a view");
        let grid = Grid::over(large);
        hair.clear(grid);
        hair.draw_strands(grid, large, &strands);
        assert!(hair.front(grid, pos2(3840.0, 3845.0)).is_some());
    }
}
