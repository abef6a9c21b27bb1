//! A tile of the grid: the picture of a style with its name.

use egui::{
    Align2, Color32, CornerRadius, Rect, Response, Sense, Stroke, StrokeKind, TextureHandle, Ui, pos2, vec2,
};
use egui_material_icons::icons::ICON_STAR;
use lovelock_jobs::presets::thumbnail;

use crate::window::control::HoverTooltip;
use crate::window::theme;

/// Points between tiles.
pub(super) const GAP: f32 = 6.0;
/// Height of the name below the picture, points.
const NAME: f32 = 18.0;
/// Side of the star, points.
const STAR: f32 = 20.0;

/// The height of a tile of that width, points.
pub(super) fn height(width: f32) -> f32 {
    let [wide, tall] = thumbnail::SIZE.map(|side| side as f32);
    (width * tall / wide).round() + NAME
}

/// What a tile shows.
pub(super) struct Tile<'a> {
    pub(super) name: &'a str,
    /// Its tooltip.
    pub(super) text: String,
    pub(super) picture: Option<TextureHandle>,
    /// Whether the project has this style.
    pub(super) current: bool,
    pub(super) favourite: bool,
}

/// A tile, and whether its star was clicked.
pub(super) fn tile(ui: &mut Ui, width: f32, tile: &Tile<'_>) -> (Response, bool) {
    let (rect, response) = ui.allocate_exact_size(vec2(width, height(width)), Sense::click());
    let (name, current) = (tile.name.to_owned(), tile.current);
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::RadioButton, true, current, &name));
    let mut starred = false;
    if ui.is_rect_visible(rect) {
        let picture = Rect::from_min_max(rect.min, pos2(rect.right(), rect.bottom() - NAME));
        let painter = ui.painter();
        match &tile.picture {
            Some(texture) => {
                let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                painter.image(texture.id(), picture, whole, Color32::WHITE);
            }
            None => {
                painter.rect_filled(picture, CornerRadius::same(3), theme::page());
            }
        }
        let edge = if current {
            Some(Stroke::new(2.0, theme::accent()))
        } else if response.hovered() || response.has_focus() {
            Some(Stroke::new(1.0, theme::bright()))
        } else {
            None
        };
        if let Some(edge) = edge {
            painter.rect_stroke(picture, CornerRadius::same(3), edge, StrokeKind::Inside);
        }
        let color = if current { theme::accent() } else { ui.visuals().text_color() };
        let text = egui::RichText::new(tile.name).small().color(color);
        let galley = egui::WidgetText::from(text).into_galley(
            ui,
            Some(egui::TextWrapMode::Truncate),
            width,
            egui::TextStyle::Small,
        );
        let place = Align2::CENTER_CENTER
            .anchor_size(pos2(rect.center().x, rect.bottom() - 0.5 * NAME), galley.size());
        ui.painter().galley(place.min, galley, color);
        starred = star(ui, &response, picture, tile);
    }
    (response, starred)
}

/// The star in the corner of the picture: of favourites, and of the tile under the pointer. Whether it was clicked.
fn star(ui: &Ui, tile_response: &Response, picture: Rect, tile: &Tile<'_>) -> bool {
    if !tile.favourite && !tile_response.contains_pointer() {
        return false;
    }
    let corner = picture.right_top() + vec2(-STAR, 0.0);
    let rect = Rect::from_min_size(corner, vec2(STAR, STAR));
    let response = ui.interact(rect, tile_response.id.with("star"), Sense::click());
    let favourite = tile.favourite;
    let name = format!("Favourite {}", tile.name);
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, favourite, &name));
    let color = if favourite {
        theme::accent()
    } else if response.hovered() {
        theme::bright()
    } else {
        theme::quiet()
    };
    let icon: &str = ICON_STAR.into();
    let text = egui::RichText::new(icon).color(color);
    let galley = egui::WidgetText::from(text).into_galley(
        ui,
        Some(egui::TextWrapMode::Extend),
        STAR,
        egui::TextStyle::Button,
    );
    ui.painter().galley(Align2::CENTER_CENTER.anchor_size(rect.center(), galley.size()).min, galley, color);
    response.hover_tooltip("Marks the style as a favourite. The list can show favourites only.").clicked()
}
