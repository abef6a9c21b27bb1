//! The light from all directions: a picture of the surroundings, and how it is turned.

use std::f32::consts::{PI, TAU};

use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{CursorIcon, Label, Pos2, Rect, Response, RichText, Sense, Stroke, Ui, vec2};
use glam::Vec3;
use lovelock_appearance::environment::{Panorama, Strongest};
use lovelock_project::Project;
use lovelock_render::PictureSettings;

use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{row, setting, spoken_value};
use crate::window::purpose::Purpose;
use crate::window::readings::LoadedSurroundings;
use crate::window::theme;

/// The controls of the project's surroundings.
pub(super) fn ui(ui: &mut Ui, project: &mut Project, loaded: &LoadedSurroundings) -> Option<Command> {
    let mut request = None;
    let file = &mut project.surroundings.file;
    let tip = "The source of the light from all directions. Ambient light in the Picture panel sets its brightness.";
    row(ui, "Surroundings", tip, file.is_some(), file, None, |ui, file| {
        let name = file.as_ref().and_then(|file| file.path.file_name());
        let name = name.map_or_else(|| "Sky and ground".into(), |name| name.to_string_lossy());
        ui.add(Label::new(name).truncate().sense(Sense::CLICK))
    });
    ui.horizontal_wrapped(|ui| {
        let tip = "Lights the scene with a picture of the surroundings: Radiance (.hdr) or OpenEXR (.exr).";
        if ui.button("Picture file…").hover_tooltip(tip).clicked() {
            request = Some(Command::PickFile(Purpose::Surroundings));
        }
        if file.is_some() {
            let tip = "Returns to light from sky and ground.";
            if ui.button("Remove picture").hover_tooltip(tip).clicked() {
                *file = None;
            }
        }
    });
    let (Some(_), Some(picture)) = (&project.surroundings.file, &loaded.picture) else { return request };
    thumbnail(ui, picture, &mut project.picture.surroundings_turn);
    setting(ui, "surroundings_turn", &mut project.picture, &PictureSettings::default());
    key_light(ui, project, picture.strongest());
    for text in &loaded.notes {
        ui.label(RichText::new(text).small().color(theme::watch()));
    }
    request
}

/// The button that makes the first light the one that stands out in the surroundings.
fn key_light(ui: &mut Ui, project: &mut Project, strongest: Option<Strongest>) {
    let key = project.lights.first_mut();
    let why_not = match (&key, strongest) {
        (None, _) => Some("There is no light: add one first."),
        (_, None) => Some("No direction of this picture is much brighter than the rest."),
        _ => None,
    };
    let tip = "Sets the first light to the direction and colour of the strongest light in the picture.";
    let button = egui::Button::new("Key light from the surroundings");
    let response = ui.add_enabled(why_not.is_none(), button).hover_tooltip(tip);
    let response = response.disabled_hover_tooltip(format!("{tip}\n\n{}", why_not.unwrap_or_default()));
    if let (true, Some(key), Some(strongest)) = (response.clicked(), key, strongest) {
        let strongest = strongest.turned(project.picture.surroundings_turn);
        key.direction = -strongest.direction;
        key.color = strongest.colour();
    }
}

/// The widest thumbnail, points.
const WIDEST: f32 = 272.0;

/// The picture as it is turned, with a ring around its strongest light. A drag across it turns it around once.
fn thumbnail(ui: &mut Ui, picture: &Panorama, turn: &mut f32) -> Response {
    let width = ui.available_width().min(WIDEST);
    let (rect, mut response) = ui.allocate_exact_size(vec2(width, 0.5 * width), Sense::click_and_drag());
    if response.double_clicked() {
        *turn = 0.0;
        response.mark_changed();
    } else if response.dragged() && response.drag_delta().x != 0.0 {
        *turn = wrapped(*turn - TAU * response.drag_delta().x / width.max(1.0));
        response.mark_changed();
    }
    if ui.is_rect_visible(rect) {
        let painter = ui.painter_at(rect);
        painter.add(mesh(picture, rect, *turn));
        if let Some(strongest) = picture.strongest() {
            let at = place(strongest.turned(*turn).direction, rect);
            painter.circle_stroke(at, 6.0, Stroke::new(3.0, theme::page()));
            painter.circle_stroke(at, 6.0, Stroke::new(1.5, theme::accent()));
        }
    }
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, "Picture of the surroundings"));
    let degrees = f64::from(turn.to_degrees());
    spoken_value(&response, degrees, [-180.0, 180.0], || format!("{degrees:.0}°"));
    response.on_hover_cursor(CursorIcon::ResizeHorizontal).hover_tooltip(
        "Drag to turn the surroundings; the width of the picture is a full turn. Double-click to reset. The middle is in \
         front of the figure, and the ring marks the strongest light.",
    )
}

/// The same direction between -π and π.
fn wrapped(turn: f32) -> f32 {
    let turn = (turn + PI).rem_euclid(TAU) - PI;
    if turn.is_finite() { turn.clamp(-PI, PI) } else { 0.0 }
}

/// The place of a direction in a picture of all directions.
fn place(direction: Vec3, rect: Rect) -> Pos2 {
    let azimuth = direction.x.atan2(direction.z);
    let height = direction.y.clamp(-1.0, 1.0).acos() / PI;
    rect.min + rect.size() * vec2((PI - azimuth) / TAU, height)
}

/// The thumbnail as a mesh, whose columns start anew where the picture's end. A texture would be lost with its device.
fn mesh(picture: &Panorama, rect: Rect, turn: f32) -> Mesh {
    let small = picture.thumbnail();
    let (columns, rows) = (small.width, small.height);
    let mut mesh = Mesh::default();
    if columns == 0 || rows == 0 {
        return mesh;
    }
    // Mean radiance is shown as a middle grey, whatever the unit of the file.
    let mean = picture.surround().mean().dot(Vec3::new(0.2126, 0.7152, 0.0722));
    let bytes = small.rgba8(if mean > 0.0 { 0.25 / mean } else { 1.0 });
    // A positive turn moves the picture to the left.
    let shift = columns as f32 * (turn / TAU).rem_euclid(1.0);
    let first = (shift - 0.5).floor();
    for row in 0..rows + 2 {
        // The middles of the first and the last row are continued to the edges.
        let y = ((row as f32 - 0.5) / rows as f32).clamp(0.0, 1.0);
        let from = row.saturating_sub(1).min(rows - 1);
        for column in 0..columns + 2 {
            let at = first + column as f32;
            let x = (at + 0.5 - shift) / columns as f32;
            let texel = 4 * (from * columns + (at as i64).rem_euclid(columns as i64) as usize);
            let color = theme::from_srgb([bytes[texel], bytes[texel + 1], bytes[texel + 2]]);
            mesh.vertices.push(Vertex { pos: rect.min + rect.size() * vec2(x, y), uv: WHITE_UV, color });
        }
    }
    grid(&mut mesh, columns + 2, rows + 2);
    mesh
}

/// Adds the triangles of a grid of vertices.
pub(super) fn grid(mesh: &mut Mesh, columns: usize, rows: usize) {
    let first = mesh.vertices.len() - columns * rows;
    for row in 1..rows {
        for column in 1..columns {
            let corner = (first + row * columns + column) as u32;
            let (left, above) = (corner - 1, corner - columns as u32);
            mesh.add_triangle(above - 1, above, left);
            mesh.add_triangle(left, above, corner);
        }
    }
}

#[cfg(test)]
mod tests {
    use egui::{Vec2, pos2};

    use super::*;

    fn panorama() -> Panorama {
        // Each column has a colour of its own; the sky to the left, +X, has a lamp.
        let pixels: Vec<Vec3> =
            (0..16 * 8)
                .map(|at| {
                    if at % 16 == 4 && at / 16 == 3 {
                        Vec3::splat(90.0)
                    } else {
                        Vec3::splat((at % 16) as f32)
                    }
                })
                .collect();
        Panorama::from_pixels(16, 8, &pixels).expect("a picture")
    }

    #[test]
    fn turns_stay_in_range() {
        for turn in [0.0, 3.0, -3.1, 100.0, -1e9, f32::NAN] {
            assert!(wrapped(turn).abs() <= PI, "{turn}");
        }
        assert!((wrapped(PI + 0.1) - (0.1 - PI)).abs() < 1e-5);
    }

    #[test]
    fn the_lamp_is_where_the_mesh_is_brightest() {
        let picture = panorama();
        let rect = Rect::from_min_size(pos2(10.0, 20.0), Vec2::new(160.0, 80.0));
        for turn in [0.0, 0.5, -2.0, 3.0] {
            let mesh = mesh(&picture, rect, turn);
            let shown = mesh.vertices.iter().filter(|vertex| rect.contains(vertex.pos));
            let brightest = shown.max_by_key(|vertex| u32::from(vertex.color.r())).expect("a vertex").pos;
            let lamp = place(picture.strongest().expect("a lamp").turned(turn).direction, rect);
            assert!((brightest - lamp).length() < 11.0, "turn {turn}: {brightest:?} {lamp:?}");
            assert!(mesh.is_valid() && mesh.vertices[0].pos.x <= rect.left(), "it covers the left edge");
            assert!(mesh.vertices.iter().any(|vertex| vertex.pos.x >= rect.right()), "and the right one");
        }
    }
}
