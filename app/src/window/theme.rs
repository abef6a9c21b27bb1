//! Colours and spacing of the interface. Only this module names colours.

#![expect(clippy::disallowed_methods, reason = "colours come from here")]

use std::cell::Cell;

use lovelock_metrics::ColorMap;
use lovelock_panes::sheet::Sheet;
use lovelock_render::ColorScale;

use egui::epaint::text::{FontInsert, FontPriority, InsertFontFamily};
use egui::{
    Color32, CornerRadius, FontData, FontFamily, FontId, Margin, Stroke, TextStyle, Theme, ThemePreference,
    Vec2, Visuals,
};

/// A font, made for this program, with the one sign that egui's controls show and its other fonts lack: two sheets, on the button that
/// copies a colour.
const COPY_FONT: &[u8] = include_bytes!("../../../assets/fonts/copy.ttf");

/// Which colours the interface has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(crate) enum Choice {
    /// Light text on dark, which leaves the eye to the image.
    #[default]
    Dark,
    /// Dark text on light.
    Light,
    /// That of the system.
    System,
}

impl Choice {
    /// All of them, with their names.
    pub(crate) const ALL: [(Self, &str); 3] =
        [(Self::Dark, "Dark"), (Self::Light, "Light"), (Self::System, "As the system")];

    fn preference(self) -> ThemePreference {
        match self {
            Self::Dark => ThemePreference::Dark,
            Self::Light => ThemePreference::Light,
            Self::System => ThemePreference::System,
        }
    }
}

/// The colours of a theme.
struct Colors {
    accent: Color32,
    quiet: Color32,
    wrong: Color32,
    good: Color32,
    watch: Color32,
    recording: Color32,
    page: Color32,
    panel: Color32,
    raised: Color32,
    hovered: Color32,
    text: Color32,
    bright: Color32,
    line: Color32,
}

const DARK: Colors = Colors {
    accent: Color32::from_rgb(232, 164, 92),
    quiet: Color32::from_rgb(142, 146, 154),
    wrong: Color32::from_rgb(236, 106, 94),
    good: Color32::from_rgb(112, 178, 130),
    watch: Color32::from_rgb(232, 204, 96),
    recording: Color32::from_rgb(226, 72, 62),
    page: Color32::from_rgb(19, 20, 23),
    panel: Color32::from_rgb(28, 30, 34),
    raised: Color32::from_rgb(44, 47, 53),
    hovered: Color32::from_rgb(58, 62, 70),
    text: Color32::from_rgb(214, 216, 221),
    bright: Color32::from_rgb(236, 238, 242),
    line: Color32::from_rgb(46, 49, 55),
};

const LIGHT: Colors = Colors {
    accent: Color32::from_rgb(150, 78, 2),
    quiet: Color32::from_rgb(94, 98, 106),
    wrong: Color32::from_rgb(184, 38, 28),
    good: Color32::from_rgb(28, 112, 58),
    watch: Color32::from_rgb(122, 90, 0),
    recording: Color32::from_rgb(200, 40, 32),
    page: Color32::from_rgb(226, 228, 232),
    panel: Color32::from_rgb(244, 245, 247),
    raised: Color32::from_rgb(222, 224, 229),
    hovered: Color32::from_rgb(206, 209, 216),
    text: Color32::from_rgb(34, 36, 40),
    bright: Color32::from_rgb(10, 11, 14),
    line: Color32::from_rgb(204, 207, 213),
};

thread_local! {
    /// Whether the window of this thread is light.
    static IS_LIGHT: Cell<bool> = const { Cell::new(false) };
}

fn colors() -> &'static Colors {
    if IS_LIGHT.get() { &LIGHT } else { &DARK }
}

/// Behind text over an image.
pub(crate) fn behind_text() -> Color32 {
    // Dark text needs more light behind it on a dark image than light text needs dark.
    page().gamma_multiply(if IS_LIGHT.get() { 0.88 } else { 0.6 })
}

/// Runs what paints over an image: its colours are those of the dark theme, because most images are dark.
pub(crate) fn over_image<R>(add: impl FnOnce() -> R) -> R {
    let was_light = IS_LIGHT.replace(false);
    let result = add();
    IS_LIGHT.set(was_light);
    result
}

/// Values that differ from their default, selected items, running work.
pub(crate) fn accent() -> Color32 {
    colors().accent
}

/// Secondary text.
pub(crate) fn quiet() -> Color32 {
    colors().quiet
}

/// Errors.
pub(crate) fn wrong() -> Color32 {
    colors().wrong
}

/// Good values.
pub(crate) fn good() -> Color32 {
    colors().good
}

/// Warnings.
pub(crate) fn watch() -> Color32 {
    colors().watch
}

/// Recording.
pub(crate) fn recording() -> Color32 {
    colors().recording
}

/// Background of the window.
pub(crate) fn page() -> Color32 {
    colors().page
}

/// Background of panels.
pub(crate) fn panel() -> Color32 {
    colors().panel
}

/// Text over images.
pub(crate) fn bright() -> Color32 {
    colors().bright
}

/// Lines between things.
pub(crate) fn line() -> Color32 {
    colors().line
}

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
    Color32::from_rgb(142, 146, 154),
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

/// The colour of a pixel of a picture: red, green, blue and opacity, sRGB.
pub(crate) fn of_picture([r, g, b, a]: [u8; 4]) -> Color32 {
    Color32::from_rgba_unmultiplied(r, g, b, a)
}

/// A colour in sRGB.
pub(crate) fn from_srgb([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// Gives the window the colours of a choice. Comes first in every pass.
pub(crate) fn follow(ctx: &egui::Context, choice: Choice) {
    let wanted = choice.preference();
    if ctx.options(|options| options.theme_preference) != wanted {
        ctx.set_theme(wanted);
    }
    IS_LIGHT.set(ctx.theme() == Theme::Light);
}

/// Applies the theme to `ctx`.
pub(crate) fn apply(ctx: &egui::Context) {
    ctx.set_theme(Theme::Dark);
    IS_LIGHT.set(false);
    let families = [FontFamily::Proportional, FontFamily::Monospace]
        .map(|family| InsertFontFamily { family, priority: FontPriority::Lowest });
    ctx.add_font(FontInsert::new("copy", FontData::from_static(COPY_FONT), families.to_vec()));
    ctx.set_visuals_of(Theme::Dark, visuals(Visuals::dark(), &DARK));
    ctx.set_visuals_of(Theme::Light, visuals(Visuals::light(), &LIGHT));
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

/// The visuals of a theme.
fn visuals(mut visuals: Visuals, colors: &Colors) -> Visuals {
    // The window is already cleared to the panels' colour.
    visuals.panel_fill = Color32::TRANSPARENT;
    visuals.window_fill = colors.panel;
    visuals.extreme_bg_color = colors.page;
    visuals.faint_bg_color = colors.raised;
    visuals.override_text_color = Some(colors.text);
    visuals.selection.bg_fill = colors.accent.gamma_multiply(0.45);
    visuals.selection.stroke = Stroke::new(1.0, colors.accent);
    visuals.hyperlink_color = colors.accent;
    visuals.slider_trailing_fill = true;
    visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, colors.line);
    visuals.widgets.inactive.bg_fill = colors.raised;
    visuals.widgets.inactive.weak_bg_fill = colors.raised;
    visuals.widgets.hovered.bg_fill = colors.hovered;
    visuals.widgets.hovered.weak_bg_fill = colors.hovered;
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
    visuals
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The contrast of two colours, by WCAG 2.2.
    fn contrast(one: Color32, other: Color32) -> f32 {
        let luminance = |color: Color32| {
            let linear = [color.r(), color.g(), color.b()].map(|byte| {
                let v = f32::from(byte) / 255.0;
                if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
            });
            0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
        };
        let (a, b) = (luminance(one) + 0.05, luminance(other) + 0.05);
        a.max(b) / a.min(b)
    }

    #[test]
    fn text_is_legible_in_both_themes() {
        for colors in [&DARK, &LIGHT] {
            for text in [
                colors.text,
                colors.bright,
                colors.quiet,
                colors.accent,
                colors.wrong,
                colors.good,
                colors.watch,
            ] {
                for below in [colors.panel, colors.page] {
                    assert!(contrast(text, below) >= 4.5, "{text:?} on {below:?}: {}", contrast(text, below));
                }
            }
        }
        assert!(contrast(DARK.line, DARK.panel) < 4.5, "control");
    }

    #[test]
    fn the_colours_follow_the_choice() {
        let ctx = egui::Context::default();
        apply(&ctx);
        follow(&ctx, Choice::Light);
        assert_eq!((accent(), ctx.theme()), (LIGHT.accent, Theme::Light));
        assert_eq!(over_image(accent), DARK.accent);
        assert_eq!(accent(), LIGHT.accent);
        follow(&ctx, Choice::Dark);
        assert_eq!((accent(), ctx.theme()), (DARK.accent, Theme::Dark));
    }
}
