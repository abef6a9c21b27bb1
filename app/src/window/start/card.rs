//! A picture with a title and a sentence, which acts as a button.

use egui::{
    Color32, Context, CornerRadius, Image, Rect, Response, RichText, Sense, Stroke, StrokeKind, TextStyle,
    TextWrapMode, TextureHandle, TextureOptions, Ui, Vec2, WidgetInfo, WidgetText, pos2, vec2,
};

use crate::window::theme;

/// Space inside a card, points.
const MARGIN: f32 = 6.0;

/// The texture of an image file; `None` if it cannot be read.
pub(super) fn texture(ctx: &Context, name: &str, file: &[u8]) -> Option<TextureHandle> {
    let pixels = image::load_from_memory(file).ok()?.to_rgba8();
    let size = [pixels.width() as usize, pixels.height() as usize];
    let image = egui::ColorImage::from_rgba_unmultiplied(size, pixels.as_raw());
    Some(ctx.load_texture(name, image, TextureOptions::LINEAR))
}

/// Paints a texture so that it fills a rectangle, cut at its longer sides.
pub(super) fn fill(ui: &Ui, rect: Rect, texture: Option<&TextureHandle>) {
    ui.painter().rect_filled(rect, 3.0, theme::page());
    let Some(texture) = texture else { return };
    let size = texture.size_vec2();
    let shown = rect.size() / (rect.width() / size.x).max(rect.height() / size.y);
    let part = shown / size;
    // Heads are in the upper half of most pictures.
    let top = (1.0 - part.y) * 0.3;
    let uv = Rect::from_min_size(pos2((1.0 - part.x) * 0.5, top), part);
    Image::new(texture).uv(uv).corner_radius(3).paint_at(ui, rect);
}

/// The background and the edge of a card, by what is done with it.
pub(super) fn frame(ui: &Ui, rect: Rect, response: &Response) {
    let round = CornerRadius::same(5);
    let visuals = ui.style().interact(response);
    let fill =
        if response.hovered() || response.has_focus() { visuals.weak_bg_fill } else { Color32::TRANSPARENT };
    let edge = if response.has_focus() {
        Stroke::new(1.5, theme::accent())
    } else {
        Stroke::new(1.0, theme::line())
    };
    ui.painter().rect(rect, round, fill, edge, StrokeKind::Inside);
}

/// A card with a picture of `size` points above a title and a sentence.
pub(super) fn show(
    ui: &mut Ui,
    size: Vec2,
    picture: Option<&TextureHandle>,
    title: &str,
    text: &str,
) -> Response {
    let wrap = size.x - 2.0 * MARGIN;
    let galley = |ui: &Ui, text: RichText, style: TextStyle| {
        WidgetText::from(text).into_galley(ui, Some(TextWrapMode::Wrap), wrap, style)
    };
    let title_text = galley(ui, RichText::new(title).strong(), TextStyle::Body);
    let below = galley(ui, RichText::new(text).color(theme::quiet()), TextStyle::Small);
    let height = MARGIN + size.y + 4.0 + title_text.size().y + 2.0 + below.size().y + MARGIN;
    let (rect, response) = ui.allocate_exact_size(vec2(size.x, height), Sense::click());
    let name = format!("Example: {title}. {text}");
    let enabled = ui.is_enabled();
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, enabled, &name));
    frame(ui, rect, &response);
    let image = Rect::from_min_size(rect.min + Vec2::splat(MARGIN), vec2(wrap, size.y));
    fill(ui, image, picture);
    let at = image.left_bottom() + vec2(0.0, 4.0);
    let after = at + vec2(0.0, title_text.size().y + 2.0);
    ui.painter().galley(at, title_text, theme::bright());
    ui.painter().galley(after, below, theme::quiet());
    response.on_hover_cursor(egui::CursorIcon::PointingHand)
}
