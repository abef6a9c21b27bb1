//! Overlays on the image, drawn for the same instant and camera.

pub(crate) mod brush;
pub(crate) mod colliders;
pub(crate) mod head;
pub(crate) mod lights;
pub(crate) mod mark;
pub(crate) mod mask;
pub(crate) mod pick;
pub(crate) mod scalp;
pub(crate) mod scissors;
pub(crate) mod ties;

use egui::{CursorIcon, Id, Painter, Pos2, Rect, Response, Role, Sense, Ui, Vec2, WidgetInfo, pos2};
use glam::{Mat4, Vec3};
use lovelock_render::Camera;
use lovelock_session::render_thread::RenderedImage;

use super::theme;
use crate::window::control::HoverTooltip;

/// The image on the screen and the camera with which it was rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    /// The position of the image on the screen, points.
    pub(crate) place: Rect,
    clip_from_world: Mat4,
    world_from_clip: Mat4,
    /// The camera's position, world space.
    pub(crate) eye: Vec3,
}

/// Width and height of a handle, points.
const HANDLE: f32 = 22.0;

/// A handle in the image that can be clicked and dragged; screen readers announce it as `name`.
fn handle(ui: &Ui, at: Pos2, id: Id, name: &str) -> Response {
    let handle = ui.interact(Rect::from_center_size(at, Vec2::splat(HANDLE)), id, Sense::click_and_drag());
    handle.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    handle
}

/// The new position of a handle at `at` that is dragged. The pointer keeps its offset from the handle's middle.
fn dragged_to(ui: &Ui, handle: &Response, at: Pos2) -> Option<Pos2> {
    if handle.drag_started() {
        let pressed = ui.input(|input| input.pointer.press_origin())?;
        ui.data_mut(|data| data.insert_temp(handle.id, pressed - at));
    }
    let hold: egui::Vec2 = ui.data(|data| data.get_temp(handle.id)).unwrap_or_default();
    handle.interact_pointer_pos().filter(|_| handle.dragged()).map(|pointer| pointer - hold)
}

/// Paints a handle as a dot that grows under the pointer, with a tooltip.
fn dot(painter: &Painter, handle: Response, at: Pos2, words: &str) {
    let over = handle.hovered() || handle.dragged();
    painter.circle_filled(at, if over { 8.0 } else { 6.5 }, theme::page().gamma_multiply(0.7));
    painter.circle_filled(at, if over { 6.0 } else { 4.5 }, theme::accent());
    handle.on_hover_cursor(CursorIcon::Grab).hover_tooltip(words);
}

impl View {
    /// The view of an image that is shown at `place`; `None` if it has no size.
    pub(crate) fn new(painted: &RenderedImage, place: Rect) -> Option<Self> {
        Self::of_camera(&painted.camera, place)
    }

    /// The view of what a camera sees, shown at `place`.
    pub(crate) fn of_camera(camera: &Camera, place: Rect) -> Option<Self> {
        let aspect = place.width() / place.height();
        if !(aspect.is_finite() && aspect > 0.0) {
            return None;
        }
        let clip_from_world = camera.clip_from_world(aspect);
        let world_from_clip = clip_from_world.inverse();
        (world_from_clip.is_finite() && camera.eye.is_finite()).then_some(Self {
            place,
            clip_from_world,
            world_from_clip,
            eye: camera.eye,
        })
    }

    /// The position of a point of the world on the screen, also outside the image; `None` behind the camera.
    pub(crate) fn to_screen(self, world: Vec3) -> Option<Pos2> {
        self.to_screen_and_depth(world).map(|(at, _)| at)
    }

    /// As [`View::to_screen`], with the distance from the camera along the direction in which it looks.
    pub(crate) fn to_screen_and_depth(self, world: Vec3) -> Option<(Pos2, f32)> {
        let clip = self.clip_from_world * world.extend(1.0);
        // Projections of nearer points would overflow.
        if !clip.is_finite() || clip.w < 1e-2 {
            return None;
        }
        let (x, y) = (0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
        Some((self.place.min + self.place.size() * pos2(x, y).to_vec2(), clip.w))
    }

    /// The direction from the eye through a point of the screen.
    pub(crate) fn ray(self, at: Pos2) -> Vec3 {
        let share = (at - self.place.min) / self.place.size();
        let clip = glam::Vec4::new(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y, 0.5, 1.0);
        let world = self.world_from_clip * clip;
        (world.truncate() / world.w - self.eye).normalize_or(Vec3::NEG_Z)
    }

    /// The unit vector in the world that points to the right on the screen at a point of the world that appears at `at`; `None` if it
    /// is undefined.
    fn right_of(self, at: Pos2, place: Vec3) -> Option<Vec3> {
        (self.at_depth_of(at + Vec2::new(10.0, 0.0), place) - place).try_normalize()
    }

    /// The point of the world under a point of the screen at the distance of `depth_of` from the camera.
    pub(crate) fn at_depth_of(self, at: Pos2, depth_of: Vec3) -> Vec3 {
        self.at_depth(at, (depth_of - self.eye).dot(self.ray(self.place.center())))
    }

    /// The point of the world under a point of the screen at a distance from the camera along the direction in which it looks.
    pub(crate) fn at_depth(self, at: Pos2, depth: f32) -> Vec3 {
        let ray = self.ray(at);
        self.eye + ray * (depth / ray.dot(self.ray(self.place.center())).max(1e-3))
    }
}

#[cfg(test)]
mod tool_tests;

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;

    fn view() -> View {
        let camera = Camera {
            eye: Vec3::new(0.4, 1.6, 2.0),
            target: Vec3::new(0.0, 1.5, 0.0),
            fov_y: 0.5,
            shear: glam::Vec2::ZERO,
        };
        let place = Rect::from_min_size(pos2(100.0, 50.0), vec2(800.0, 450.0));
        View::of_camera(&camera, place).expect("a view")
    }

    #[test]
    fn the_target_is_in_the_middle_and_rays_go_where_points_are() {
        let view = view();
        let middle = view.to_screen(Vec3::new(0.0, 1.5, 0.0)).expect("before the camera");
        assert!((middle - view.place.center()).length() < 0.1, "{middle:?}");
        for p in [Vec3::new(0.2, 1.4, 0.1), Vec3::new(-0.3, 1.7, -0.2)] {
            let at = view.to_screen(p).expect("before the camera");
            assert!((view.ray(at) - (p - view.eye).normalize_or(Vec3::X)).length() < 1e-4);
            assert!(view.at_depth_of(at, p).distance(p) < 1e-3);
        }
        assert!(view.to_screen(Vec3::new(0.8, 1.7, 4.0)).is_none(), "behind");
    }
}
