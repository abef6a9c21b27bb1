//! The dance's time: play, step, scrub.

use egui::{Color32, Rect, Sense, Stroke, Ui, Vec2, pos2};
use egui_material_icons::icons;
use lovelock_studio::Command;

use super::theme;

/// What the timeline shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    /// Where the dance is, seconds.
    pub(crate) time_secs: f64,
    /// How long it is, seconds.
    pub(crate) duration_secs: f64,
    /// Whether it plays.
    pub(crate) playing: bool,
    /// Whether it starts again at its end.
    pub(crate) looping: bool,
}

/// What the timeline asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ask {
    /// A command.
    Run(Command),
    /// To go to a time, seconds.
    Seek(f64),
}

/// The row of buttons and the bar.
pub(crate) fn ui(ui: &mut Ui, view: View) -> Option<Ask> {
    let mut ask = None;
    ui.horizontal_centered(|ui| {
        let play = if view.playing { icons::ICON_PAUSE } else { icons::ICON_PLAY_ARROW };
        for (icon, command) in [
            (icons::ICON_SKIP_PREVIOUS, Command::JumpToStart),
            (icons::ICON_CHEVRON_LEFT, Command::StepBack),
            (play, Command::PlayPause),
            (icons::ICON_CHEVRON_RIGHT, Command::StepForward),
            (icons::ICON_SKIP_NEXT, Command::JumpToEnd),
        ] {
            let info = command.info();
            let tip = format!("{} ({})", info.tooltip, info.shortcuts.join(", "));
            let response = ui.add(egui::Button::new(icon).min_size(Vec2::splat(24.0))).on_hover_text(tip);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, info.label));
            if response.clicked() {
                ask = Some(Ask::Run(command));
            }
        }
        let info = Command::ToggleLoop.info();
        let response = ui.selectable_label(view.looping, icons::ICON_REPEAT).on_hover_text(info.tooltip);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::CheckBox, true, info.label));
        if response.clicked() {
            ask = Some(Ask::Run(Command::ToggleLoop));
        }
        let frame = (view.time_secs * 60.0).round() as i64;
        ui.monospace(format!("{:6.2} s", view.time_secs));
        ui.label(egui::RichText::new(format!("frame {frame}")).small().color(theme::QUIET));
        if let Some(time_secs) = bar(ui, view) {
            ask = Some(Ask::Seek(time_secs));
        }
    });
    ask
}

/// The bar with its ticks; a click or a drag asks for a time.
fn bar(ui: &mut Ui, view: View) -> Option<f64> {
    let size = Vec2::new((ui.available_width() - 8.0).max(60.0), 30.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, "Time"));
    let duration = view.duration_secs.max(1e-3);
    let x_of = |secs: f64| rect.left() + rect.width() * (secs / duration).clamp(0.0, 1.0) as f32;
    let painter = ui.painter_at(rect);
    let track = Rect::from_min_max(
        pos2(rect.left(), rect.center().y - 3.0),
        pos2(rect.right(), rect.center().y + 3.0),
    );
    painter.rect_filled(track, 3.0, theme::PAGE);
    let played = Rect::from_min_max(track.min, pos2(x_of(view.time_secs), track.max.y));
    painter.rect_filled(played, 3.0, theme::ACCENT.gamma_multiply(0.5));
    // A tick each second, and a number where there is room.
    let every = (40.0 / (rect.width() / duration as f32)).ceil().max(1.0) as usize;
    for second in 0..=duration.min(36_000.0) as usize {
        let x = x_of(second as f64);
        let long = second.is_multiple_of(every);
        let top = if long { rect.bottom() - 8.0 } else { rect.bottom() - 5.0 };
        painter.line_segment([pos2(x, top), pos2(x, rect.bottom() - 2.0)], Stroke::new(1.0, theme::QUIET));
        if long {
            let font = egui::FontId::proportional(9.0);
            painter.text(
                pos2(x + 2.0, rect.top()),
                egui::Align2::LEFT_TOP,
                format!("{second}"),
                font,
                theme::QUIET,
            );
        }
    }
    let x = x_of(view.time_secs);
    painter.line_segment([pos2(x, rect.top()), pos2(x, rect.bottom())], Stroke::new(2.0, theme::ACCENT));
    painter.circle_filled(pos2(x, rect.center().y), 5.0, Color32::WHITE);
    let response = response.on_hover_text("Drag to move through the dance; the hair is carried along.");
    let at = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked())?;
    Some(f64::from(((at.x - rect.left()) / rect.width()).clamp(0.0, 1.0)) * duration)
}
