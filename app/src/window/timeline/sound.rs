//! The sound under the ruler: its outline, its beats, and a drag that shifts it.

use egui::{Id, PointerButton, Rect, Sense, Stroke, Ui, pos2};
use lovelock_project::project::SoundSection;

use super::SoundLane;
use super::scale::Scale;
use crate::window::control::{HoverTooltip, spoken_value};
use crate::window::theme;

/// Height of the lane, points.
pub(super) const HEIGHT: f32 = 30.0;
/// Distance from a beat within which a dragged key or marker snaps to it, points.
const REACH: f32 = 5.0;

/// Shows the sound and shifts it by a drag.
pub(super) fn lane(ui: &Ui, lane: Rect, scale: Scale, sound: &SoundLane, section: &mut SoundSection) {
    let response = ui.interact(lane, Id::unique("timeline sound"), Sense::drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, "Sound on the timeline"));
    let (offset, most) = (section.offset_secs, SoundSection::MAX_OFFSET_SECS);
    spoken_value(&response, offset, [-most, most], || format!("{offset:.2} s"));
    if response.dragged_by(PointerButton::Primary) {
        let secs = scale.secs_of(response.drag_delta().x);
        section.offset_secs = (section.offset_secs + secs).clamp(-most, most);
    }
    let hot = response.hovered() || response.dragged();
    response.hover_tooltip(format!(
        "{}, from {:.2} s on. Drag to shift it against the dance. Keys and markers snap to its beats; hold Alt to move them \
         freely.",
        sound.name, section.offset_secs
    ));
    let painter = ui.painter_at(lane);
    painter.rect_filled(lane, 2.0, theme::page());
    let dim = if section.muted { 0.35 } else { 1.0 };
    let columns = lane.width().ceil().clamp(1.0, 8000.0) as usize;
    let shown = [scale.from - section.offset_secs, scale.to - section.offset_secs];
    let outline = sound.loaded.waveform.columns(shown, columns);
    let color = if hot { theme::bright() } else { theme::PLOT[0] }.gamma_multiply(0.7 * dim);
    let half = 0.5 * lane.height() - 2.0;
    let width = lane.width() / columns as f32;
    for (i, part) in outline.into_iter().enumerate() {
        let Some([low, high]) = part else { continue };
        let x = lane.left() + (i as f32 + 0.5) * width;
        let y = |value: f32| lane.center().y - half * (value * section.gain.min(1.0)).clamp(-1.0, 1.0);
        // Silence is a thin line.
        let line = [pos2(x, y(high) - 0.5), pos2(x, y(low) + 0.5)];
        painter.line_segment(line, Stroke::new(width, color));
    }
    for secs in &sound.loaded.beats.secs {
        if let Some(x) = scale.x_of(secs + section.offset_secs) {
            let stroke = Stroke::new(1.0, theme::accent().gamma_multiply(dim));
            painter.line_segment([pos2(x, lane.top()), pos2(x, lane.top() + 6.0)], stroke);
        }
    }
}

/// The time of the beat near `secs`, or `secs` if there is none or Alt is held.
pub(super) fn snapped(ui: &Ui, scale: Scale, beats: &[f64], secs: f64) -> f64 {
    if ui.input(|input| input.modifiers.alt) {
        return secs;
    }
    let off = |beat: f64| (scale.x(beat) - scale.x(secs)).abs();
    let near = beats.iter().copied().min_by(|a, b| off(*a).total_cmp(&off(*b)));
    near.filter(|beat| off(*beat) <= REACH).unwrap_or(secs)
}
