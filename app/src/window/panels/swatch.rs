//! Swatches of hair colours.

use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{Rect, Response, Sense, Stroke, StrokeKind, Ui, Vec2, vec2};
use glam::Vec3;
use lovelock_groom::HairLook;

use super::surroundings::grid;
use crate::window::control::HoverTooltip;
use crate::window::theme;

/// Size of a swatch, points.
const SIZE: Vec2 = vec2(28.0, 46.0);
/// Strands of a swatch, and points of a strand.
const STRANDS: usize = 9;
const POINTS: usize = 15;

/// A button that shows strands of `look` from root to tip, marked if it is the one in use.
pub(super) fn swatch(ui: &mut Ui, name: &str, look: &HairLook, selected: bool) -> Response {
    let (rect, response) = ui.allocate_exact_size(SIZE, Sense::click());
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, selected, name));
    if ui.is_rect_visible(rect) {
        let painter = ui.painter();
        painter.rect_filled(rect, 3.0, theme::page());
        painter.add(strands(look, rect.shrink(2.0)));
        let edge = if selected {
            Stroke::new(2.0, theme::accent())
        } else if response.hovered() || response.has_focus() {
            Stroke::new(1.0, theme::bright())
        } else {
            Stroke::new(1.0, theme::line())
        };
        painter.rect_stroke(rect, 3.0, edge, StrokeKind::Inside);
    }
    response.hover_tooltip(name)
}

/// A lock of strands that hangs down.
fn strands(look: &HairLook, rect: Rect) -> Mesh {
    let mut mesh = Mesh::default();
    let step = rect.width() / STRANDS as f32;
    // The strands in the back first.
    for layer in 0..STRANDS {
        let strand = (layer * 4) % STRANDS;
        // Numbers that look random and are equal in every pass.
        let own = [7, 5].map(|factor| ((strand * factor + 2) % STRANDS) as f32 / STRANDS as f32);
        let middle = rect.left() + step * (strand as f32 + 0.5);
        for point in 0..POINTS {
            let t = point as f32 / (POINTS - 1) as f32;
            let color = theme::from_linear(color(look, own, t).to_array());
            let sway = 0.4 * step * (3.0 * t + strand as f32).sin();
            let half = 0.72 * step * (1.0 - 0.5 * t * t);
            for side in [-half, half] {
                let x = (middle + sway + side).clamp(rect.left(), rect.right());
                let pos = egui::pos2(x, rect.top() + t * rect.height());
                mesh.vertices.push(Vertex { pos, uv: WHITE_UV, color });
            }
        }
        grid(&mut mesh, 2, POINTS);
    }
    mesh
}

/// The colour of a strand at `t`, 0 at the root and 1 at the tip: pigment, shade at the root and a band of highlight.
fn color(look: &HairLook, own: [f32; 2], t: f32) -> Vec3 {
    let pigment = (1.0 - look.tip_lightening * t) * (1.0 + look.variation * (own[0] - 0.5));
    let grey = own[1] < look.grey;
    let body = HairLook::body_color(if grey { Vec3::ZERO } else { pigment.max(0.0) * look.absorption() });
    let band = |at: f32, width: f32| (-((t - at - 0.06 * own[1]) / width).powi(2)).exp();
    let shade = (0.6 + 0.4 * (t / 0.25).min(1.0)) * (0.75 + 0.25 * own[0]);
    0.62 * shade * body + 0.07 * band(0.3, 0.09) + 0.35 * band(0.4, 0.14) * body
}

#[cfg(test)]
mod tests {
    use egui::pos2;
    use lovelock_groom::HAIR_COLOURS;

    use super::*;

    #[test]
    fn every_colour_has_another_swatch_inside_its_frame() {
        let rect = Rect::from_min_size(pos2(5.0, 7.0), SIZE);
        let mut seen: Vec<Vec<egui::Color32>> = Vec::new();
        for colour in &HAIR_COLOURS {
            let mut look = HairLook::default();
            colour.apply(&mut look);
            let mesh = strands(&look, rect);
            assert!(mesh.is_valid());
            assert!(
                mesh.vertices.iter().all(|vertex| rect.expand(0.01).contains(vertex.pos)),
                "{}",
                colour.name
            );
            let colors = mesh.vertices.iter().map(|vertex| vertex.color).collect();
            assert!(!seen.contains(&colors), "{}", colour.name);
            seen.push(colors);
        }
    }
}
