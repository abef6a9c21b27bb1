//! Colours and spacing of the interface. Only this module names colours.

#![expect(clippy::disallowed_methods, reason = "colours come from here")]

use lovelock_metrics::ColorMap;
use lovelock_panes::sheet::Sheet;
use lovelock_render::ColorScale;

use egui::epaint::text::{FontInsert, FontPriority, InsertFontFamily};
use egui::{
    Color32, CornerRadius, FontData, FontFamily, FontId, Margin, Stroke, TextStyle, Theme, Vec2, Visuals,
};

/// A font, made for this program, with the one sign that egui's controls show and its other fonts lack: two sheets, on the button that
/// copies a colour.
const COPY_FONT: &[u8] = include_bytes!("../../../assets/fonts/copy.ttf");

/// Values that differ from their default, selected items, running work.
pub(crate) const ACCENT: Color32 = Color32::from_rgb(232, 164, 92);
/// Secondary text.
pub(crate) const QUIET: Color32 = Color32::from_rgb(142, 146, 154);
/// Errors.
pub(crate) const WRONG: Color32 = Color32::from_rgb(236, 106, 94);
/// Good values.
pub(crate) const GOOD: Color32 = Color32::from_rgb(112, 178, 130);
/// Warnings.
pub(crate) const WATCH: Color32 = Color32::from_rgb(232, 204, 96);
/// Recording.
pub(crate) const RECORDING: Color32 = Color32::from_rgb(226, 72, 62);
/// Background of the window.
pub(crate) const PAGE: Color32 = Color32::from_rgb(19, 20, 23);
pub(crate) const PANEL: Color32 = Color32::from_rgb(28, 30, 34);
const RAISED: Color32 = Color32::from_rgb(44, 47, 53);
const HOVERED: Color32 = Color32::from_rgb(58, 62, 70);
const TEXT: Color32 = Color32::from_rgb(214, 216, 221);
/// Text over images.
pub(crate) const BRIGHT: Color32 = Color32::from_rgb(236, 238, 242);
pub(crate) const LINE: Color32 = Color32::from_rgb(46, 49, 55);

/// Colours of the lines in plots, distinguishable with red-green colour blindness (after Okabe and Ito).
pub(crate) const PLOT: [Color32; Sheet::COLORS.len()] = {
    let mut colors = [Color32::BLACK; Sheet::COLORS.len()];
    let mut i = 0;
    while i < colors.len() {
        let [r, g, b] = Sheet::COLORS[i];
        colors[i] = Color32::from_rgb(r, g, b);
        i += 1;
    }
    colors
};

/// Colours of the components of a vector: x, y, z and one more.
pub(crate) const AXES: [Color32; 4] = [
    Color32::from_rgb(226, 112, 96),
    Color32::from_rgb(118, 190, 112),
    Color32::from_rgb(104, 152, 232),
    QUIET,
];

/// The colours of a mask on hair and scalp: dark violet for 0, yellow for 1, in steps that look equal.
pub(crate) fn mask_colors() -> ColorScale {
    let colors = std::array::from_fn(|k| ColorMap::Viridis.at(k as f32 / 255.0));
    ColorScale { range: [0.0, 1.0], colors, behind: 1.0, saturation: 1.0, relief: 0.35 }
}

/// A colour of the screen as linear numbers.
pub(crate) fn to_linear(color: Color32) -> [f32; 3] {
    [color.r(), color.g(), color.b()].map(|v| (f32::from(v) / 255.0).powf(2.2))
}

/// A linear colour on the screen.
pub(crate) fn from_linear(linear: [f32; 3]) -> Color32 {
    let [r, g, b] = linear.map(|v| (v.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0) as u8);
    Color32::from_rgb(r, g, b)
}

/// A colour in sRGB.
pub(crate) fn from_srgb([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// Applies the theme to `ctx`.
pub(crate) fn apply(ctx: &egui::Context) {
    ctx.set_theme(Theme::Dark);
    let families = [FontFamily::Proportional, FontFamily::Monospace]
        .map(|family| InsertFontFamily { family, priority: FontPriority::Lowest });
    ctx.add_font(FontInsert::new("copy", FontData::from_static(COPY_FONT), families.to_vec()));
    let mut visuals = Visuals::dark();
    // The window is already cleared to the panels' colour.
    visuals.panel_fill = Color32::TRANSPARENT;
    visuals.window_fill = PANEL;
    visuals.extreme_bg_color = PAGE;
    visuals.faint_bg_color = RAISED;
    visuals.override_text_color = Some(TEXT);
    visuals.selection.bg_fill = ACCENT.gamma_multiply(0.45);
    visuals.selection.stroke = Stroke::new(1.0, ACCENT);
    visuals.hyperlink_color = ACCENT;
    visuals.slider_trailing_fill = true;
    visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, LINE);
    visuals.widgets.inactive.bg_fill = RAISED;
    visuals.widgets.inactive.weak_bg_fill = RAISED;
    visuals.widgets.hovered.bg_fill = HOVERED;
    visuals.widgets.hovered.weak_bg_fill = HOVERED;
    let round = CornerRadius::same(4);
    for widget in [
        &mut visuals.widgets.noninteractive,
        &mut visuals.widgets.inactive,
        &mut visuals.widgets.hovered,
        &mut visuals.widgets.active,
        &mut visuals.widgets.open,
    ] {
        widget.corner_radius = round;
        widget.expansion = 0.0;
    }
    ctx.set_visuals_of(Theme::Dark, visuals);
    ctx.all_styles_mut(|style| {
        style.spacing.item_spacing = Vec2::new(6.0, 5.0);
        style.spacing.slider_width = 96.0;
        style.spacing.button_padding = Vec2::new(8.0, 3.0);
        style.spacing.window_margin = Margin::same(10);
        style.spacing.interact_size.y = 20.0;
        style.spacing.tooltip_width = 320.0;
        style.interaction.tooltip_delay = 0.9;
        style.text_styles.insert(TextStyle::Body, FontId::proportional(12.5));
        style.text_styles.insert(TextStyle::Button, FontId::proportional(12.5));
        style.text_styles.insert(TextStyle::Small, FontId::proportional(10.5));
        style.text_styles.insert(TextStyle::Heading, FontId::proportional(14.0));
    });
}
