//! The colour scale of the errors that panes show.

use egui::{Align2, FontId, Rect, Sense, Stroke, Ui, pos2, vec2};
use lovelock_metrics::ticks;
use lovelock_panes::view::LiveShows;

use crate::window::theme;

/// Height of the strip, points.
const HEIGHT: f32 = 30.0;

/// The values that the last colour can have.
pub(super) const LARGEST: [f32; 6] = [0.02, 0.05, 0.1, 0.25, 0.5, 1.0];

/// The strip with the scale; nothing if panes show images.
pub(super) fn ui(ui: &mut Ui, shows: LiveShows, largest: f32) {
    let Some(colors) = shows.colors() else { return };
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Image, true, format!("Scale of {}", shows.quantity()))
    });
    let painter = ui.painter_at(rect);
    let font = FontId::proportional(11.0);
    let title = painter.layout_no_wrap(shows.quantity().replace('-', "−"), font.clone(), theme::quiet());
    let width = (rect.width() - title.size().x - 60.0).clamp(80.0, 420.0);
    let left = rect.center().x - 0.5 * (width - title.size().x - 12.0);
    let bar = Rect::from_min_size(pos2(left, rect.top() + 4.0), vec2(width, 9.0));
    painter.galley(pos2(bar.left() - title.size().x - 12.0, rect.top() + 1.0), title, theme::quiet());
    let steps = 96_u16;
    for i in 0..steps {
        let x = |i: u16| bar.left() + bar.width() * f32::from(i) / f32::from(steps);
        let piece = Rect::from_min_max(pos2(x(i), bar.top()), pos2(x(i + 1) + 0.5, bar.bottom()));
        let t = (f32::from(i) + 0.5) / f32::from(steps);
        painter.rect_filled(piece, 0.0, theme::from_srgb(colors.at(t)));
    }
    let range = colors.range_to(largest);
    let (low, high) = (f64::from(*range.start()), f64::from(*range.end()));
    let marks = ticks(low, high, 5);
    for &value in &marks.values {
        let x = bar.left() + bar.width() * ((value - low) / (high - low)) as f32;
        let top = pos2(x, bar.bottom());
        painter.line_segment([top, top + vec2(0.0, 3.0)], Stroke::new(1.0, theme::quiet()));
        painter.text(
            top + vec2(0.0, 3.0),
            Align2::CENTER_TOP,
            marks.label(value),
            FontId::proportional(10.0),
            theme::quiet(),
        );
    }
}
