//! The hair under the pointer.

use std::sync::Arc;

use egui::{Pos2, Vec2};
use glam::Vec3;
use lovelock_base::triangle::ray_meets;
use lovelock_groom::{Hairstyle, Strands, interpolate};
use lovelock_session::snapshot::FrameSnapshot;

use crate::window::overlay::View;
use crate::window::overlay::head::Head;

/// Hair within this distance of the pointer is under it, points.
const NEAR: f32 = 5.0;
/// Side of a cell of the depths, points.
const CELL: f32 = 2.5;
/// The most cells to a side.
const MOST_CELLS: f32 = 512.0;
/// The most strands whose depth is found.
const MOST_STRANDS: usize = 3000;
/// A hit this far before another one hides it, metres.
const BEFORE: f32 = 0.01;

/// The depth of the hair that an image shows, over the image.
///
/// It is found again for each image, from every few strands, so that it has the same instant on every device.
#[derive(Default)]
pub(super) struct SeenHair {
    /// The style of the strands, by its address, and what is left of it.
    thinned: Option<(Arc<Hairstyle>, Hairstyle)>,
    strands: Strands,
    /// The image: its snapshot by its address and its step, and the view.
    of: Option<(usize, u64, View)>,
    depths: Depths,
}

/// The nearest depth in each cell of the screen, metres along the view; infinite beside the hair.
#[derive(Default)]
struct Depths {
    origin: Pos2,
    cell: f32,
    size: [usize; 2],
    nearest: Vec<f32>,
}

impl SeenHair {
    /// The place of the nearest hair under a point of the screen, at the instant of the image, or on the body where that is nearer. On the
    /// head also without hair. World space; `None` beside the hair.
    pub(super) fn at(
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
        let on_hair = self.depths.at(at).map(|depth| view.at_depth(at, depth));
        let on_head = || head.hit(view, at).map(|(place, _)| head.world_from_head.transform_point3(place));
        let Some(hair) = on_hair else { return on_head() };
        let (ray, depth) = (view.ray(at), hair.distance(view.eye));
        let body = on_body(snapshot, view.eye, ray).filter(|body| *body < depth - BEFORE);
        Some(body.map_or(hair, |body| view.eye + ray * body))
    }

    /// Finds the depths of an image, unless they are known.
    fn look(&mut self, view: View, snapshot: &FrameSnapshot) {
        let of = (std::ptr::from_ref(snapshot) as usize, snapshot.step, view);
        if self.of == Some(of) {
            return;
        }
        self.of = Some(of);
        if let Some(given) = &snapshot.strands {
            self.depths.draw(view, given);
            return;
        }
        let style = &snapshot.scene.style;
        if self.thinned.as_ref().is_none_or(|(of, _)| !Arc::ptr_eq(of, style)) {
            self.thinned = Some((Arc::clone(style), style.thinned(MOST_STRANDS)));
        }
        if let Some((_, thinned)) = &self.thinned {
            interpolate(thinned, &snapshot.guides, &mut self.strands);
            self.depths.draw(view, &self.strands);
        }
    }
}

impl Depths {
    fn draw(&mut self, view: View, strands: &Strands) {
        let size = view.place.size();
        self.cell = CELL.max(size.max_elem() / MOST_CELLS);
        self.origin = view.place.min;
        self.size = [size.x, size.y].map(|side| (side / self.cell).ceil().max(1.0) as usize);
        self.nearest.clear();
        self.nearest.resize(self.size[0] * self.size[1], f32::INFINITY);
        for ends in strands.first_point.windows(2) {
            let mut before: Option<(Pos2, f32)> = None;
            for i in ends[0] as usize..ends[1] as usize {
                let here = view.to_screen_and_depth(strands.point(i));
                if let Some((to, far)) = here {
                    let (from, near) = before.unwrap_or((to, far));
                    // Long segments are those of hair that almost touches the camera.
                    let steps = ((to - from).length() / self.cell).ceil().clamp(1.0, MOST_CELLS);
                    for step in 0..=steps as u16 {
                        let t = f32::from(step) / steps;
                        self.put(from + (to - from) * t, near + (far - near) * t);
                    }
                }
                before = here;
            }
        }
    }

    fn put(&mut self, at: Pos2, depth: f32) {
        let Vec2 { x, y } = (at - self.origin) / self.cell;
        if x >= 0.0 && y >= 0.0 && (x as usize) < self.size[0] && (y as usize) < self.size[1] {
            let nearest = &mut self.nearest[y as usize * self.size[0] + x as usize];
            *nearest = nearest.min(depth);
        }
    }

    /// The depth of the front of the hair around a point of the screen: behind a single strand that flies before it.
    fn at(&self, at: Pos2) -> Option<f32> {
        let Vec2 { x, y } = (at - self.origin) / self.cell;
        let reach = NEAR / self.cell;
        let range = |middle: f32, size: usize| {
            (middle - reach).max(0.0) as usize..((middle + reach).max(0.0) as usize + 1).min(size)
        };
        let mut found = Vec::new();
        for row in range(y, self.size[1]) {
            for column in range(x, self.size[0]) {
                let off = Vec2::new(column as f32 + 0.5 - x, row as f32 + 0.5 - y);
                let depth = self.nearest[row * self.size[0] + column];
                if off.length() <= reach && depth.is_finite() {
                    found.push(depth);
                }
            }
        }
        found.sort_unstable_by(f32::total_cmp);
        found.get(found.len() / 4).copied()
    }
}

/// The distance along a ray to the body of an image, metres.
fn on_body(snapshot: &FrameSnapshot, eye: Vec3, along: Vec3) -> Option<f32> {
    let places = &snapshot.skin.positions;
    let corners = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| places.get(vertex as usize).copied());
        Some([a?, b?, c?])
    };
    let hits = snapshot.scene.body.mesh.triangles.iter().filter_map(corners);
    hits.filter_map(|corners| ray_meets(corners, eye, along)).map(|[_, _, t]| t).min_by(f32::total_cmp)
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
        project.hair.groom.strands_per_wisp = 50;
        project.camera.distance = 0.9;
        let scene = SceneLoader::new().load_now(&project, &Access::new()).expect("a scene").0;
        let mut engine = Engine::new(scene, project.simulation);
        let snapshot = engine.snapshot();
        let camera = snapshot.camera(&project.camera);
        let (width, height) = (480_u16, 480_u16);
        let place = Rect::from_min_size(pos2(30.0, 20.0), vec2(width.into(), height.into()));
        let view = View::of_camera(&camera, place).expect("a view");
        let head =
            Head { world_from_head: &snapshot.guides.world_from_head, scalp: &snapshot.scene.style.scalp };
        let input = snapshot.frame_input(&project, &camera);
        let (mut seen, mut drawn) = (SeenHair::default(), ValueRenderer::default());
        let (mut off, mut missed) = (Vec::new(), 0);
        for row in 0..9_u8 {
            for column in 0..9_u8 {
                let pixel = [column, row].map(|i| 30.5 + 52.0 * f32::from(i));
                let at = place.min + vec2(pixel[0], pixel[1]);
                let Some(hit) = drawn.pick(&input, width.into(), height.into(), pixel) else { continue };
                match seen.at(view, head, &snapshot, at) {
                    Some(found) => {
                        off.push((found.distance(view.eye) - hit.position.distance(view.eye)).abs());
                    }
                    None => missed += 1,
                }
            }
        }
        off.sort_by(f32::total_cmp);
        let worst = off[off.len() * 9 / 10];
        let median = off[off.len() / 2];
        let [median, worst] = [median, worst].map(|metres| 1e3 * metres);
        println!(
            "{} places, {missed} missed, half within {median:.1} mm, nine of ten within {worst:.1} mm",
            off.len()
        );
        // The image may show another strand than the front one.
        assert!(off.len() > 12 && missed == 0 && median < 5.0 && worst < 30.0);
        // Controls: beside the hair there is none, and the depth is that of the place.
        assert_eq!(seen.at(view, head, &snapshot, place.min + vec2(4.0, 4.0)), None);
        assert_eq!(seen.at(view, head, &snapshot, place.min - vec2(4.0, 4.0)), None);
    }
}
