//! Scissors: a line that is drawn across the hair in the image and cuts it.

use egui::{CursorIcon, PointerButton, Pos2, Response, Stroke, Ui};
use glam::Vec3;
use lovelock_groom::{Blade, Haircut};
use lovelock_session::snapshot::FrameSnapshot;

use super::View;
use crate::window::theme;

/// The shortest line that cuts, points: less is a click of a hand that is not quite still.
const SHORTEST: f32 = 12.0;

/// The line that is being drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Scissors {
    from: Option<Pos2>,
}

impl Scissors {
    /// Shows the line while the pointer is dragged over the image; returns its ends when the pointer is released.
    pub(crate) fn drag(&mut self, ui: &Ui, view: View, response: &Response) -> Option<[Pos2; 2]> {
        if response.hovered() {
            ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
        }
        if response.drag_started_by(PointerButton::Primary) {
            self.from = ui.input(|input| input.pointer.press_origin());
        }
        let (from, to) = (self.from?, ui.input(|input| input.pointer.latest_pos())?);
        let painter = ui.painter_at(view.place);
        painter.line_segment([from, to], Stroke::new(4.0, theme::page().gamma_multiply(0.6)));
        painter.line_segment([from, to], Stroke::new(1.5, theme::wrong()));
        if response.drag_stopped() {
            self.from = None;
            return Some([from, to]);
        }
        None
    }
}

/// Whether a line is too short to be intended.
pub(crate) fn is_too_short([from, to]: [Pos2; 2]) -> bool {
    (to - from).length() < SHORTEST
}

/// The cut that a line on the screen makes in the hair of `snapshot`: hair is cut where it first crosses the plane through the eye
/// and the line away from the head, if it does so between the ends of the line. `None` if it crosses no hair.
pub(crate) fn cut(view: View, snapshot: &FrameSnapshot, [from, to]: [Pos2; 2]) -> Option<Haircut> {
    let normal = view.ray(from).cross(view.ray(to)).try_normalize()?;
    // The side with the middle of the head keeps its hair.
    let head = snapshot.guides.world_from_head.transform_point3(Vec3::Y * 0.1);
    let normal = if (head - view.eye).dot(normal) > 0.0 { -normal } else { normal };
    let blade = Blade::Plane { point: view.eye, normal };
    let mut cut = Haircut::of(&snapshot.scene.style, &snapshot.guides, &blade)?;
    let guides = &snapshot.guides.guides;
    let links = guides.points_per_guide.checked_sub(1)?;
    for (guide, kept) in cut.kept.iter_mut().enumerate().filter(|(_, kept)| **kept < 1.0) {
        let along = *kept * links as f32;
        let i = (along as usize).min(links.saturating_sub(1));
        let met = guides.point(guide, i).lerp(guides.point(guide, i + 1), along - i as f32);
        if !view.to_screen(met).is_some_and(|at| is_beside(at, from, to)) {
            *kept = 1.0;
        }
    }
    cut.kept.iter().any(|kept| *kept < 1.0).then_some(cut)
}

/// Whether a point is beside a line and not beyond its ends.
fn is_beside(at: Pos2, from: Pos2, to: Pos2) -> bool {
    let along = to - from;
    let t = (at - from).dot(along) / along.length_sq().max(1e-6);
    (0.0..=1.0).contains(&t)
}
