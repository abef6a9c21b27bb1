//! The ruler with its lanes: a click or a drag seeks, the wheel zooms, brackets and flags can be moved.

use egui::{Align2, FontId, Id, PointerButton, Pos2, Rect, Response, Sense, Stroke, Ui, Vec2, pos2, vec2};
use lovelock_project::project::Marker;

use super::scale::Scale;
use super::zoom::{FRAMES_BELOW_SECS, tick_secs};
use super::{Edited, Recorded, View, Zoom, sound, thumbnails};
use crate::window::command::Command;
use crate::window::control::{HoverTooltip, spoken_value};
use crate::window::theme;

const RULER: f32 = 22.0;
const LANE: f32 = 15.0;
/// Widths of the names of lanes without and with tracks, points.
const NAMES: f32 = 52.0;
const NAMES_OF_TRACKS: f32 = 170.0;

pub(super) fn ui(ui: &mut Ui, view: &View, zoom: &mut Zoom, edited: &mut Edited<'_>) -> Option<Command> {
    let lanes = 1.0 + if view.take.is_some() || view.recording.is_some() { 1.0 } else { 0.0 };
    let names = if edited.tracks.is_empty() { NAMES } else { NAMES_OF_TRACKS };
    let of_sound = if view.sound.is_some() { sound::HEIGHT } else { 0.0 };
    let below = RULER + of_sound;
    let size =
        vec2((ui.available_width() - 8.0).max(names + 60.0), below + lanes * LANE + thumbnails::HEIGHT);
    let (whole, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, "Time"));
    let rect = Rect::from_min_max(whole.min + vec2(names, 0.0), whole.max);
    let finite = |secs: f64| if secs.is_finite() { secs.max(0.0) } else { 0.0 };
    let (duration, now) = (finite(view.duration_secs).max(1e-3), finite(view.time_secs));
    spoken_value(&response, now, [0.0, duration], || format!("{now:.2} s"));
    magnify(ui, &response, rect, zoom, duration);
    let [from, to] = zoom.shown(duration);
    let scale = Scale::new(rect.x_range(), [from, to]);

    ruler(ui, rect, scale, super::fps(edited.recording));
    let strip =
        Rect::from_x_y_ranges(rect.x_range(), rect.top() + below..=rect.top() + below + thumbnails::HEIGHT);
    thumbnails::lane(ui, strip, scale, *zoom, duration, &view.thumbs);
    let lane = |i: f32| {
        let top = rect.top() + below + thumbnails::HEIGHT + i * LANE;
        Rect::from_min_max(pos2(rect.left(), top + 1.0), pos2(rect.right(), top + LANE - 1.0))
    };
    let beats = beats_of(view, edited.sound.offset_secs);
    if let Some(of) = &view.sound {
        let lane = Rect::from_x_y_ranges(rect.x_range(), rect.top() + RULER..=rect.top() + below);
        name(ui, whole, lane, "Sound");
        sound::lane(ui, lane.shrink2(vec2(0.0, 1.0)), scale, of, edited.sound);
    }
    let head =
        Rect::from_min_max(pos2(whole.left(), lane(0.0).top()), pos2(rect.left() - 4.0, lane(0.0).bottom()));
    let of_clip = if view.take.is_some() {
        name(ui, whole, lane(0.0), "Clip");
        None
    } else {
        super::clip::menu(ui, head, view, edited)
    };
    let clip = if view.clip.is_empty() { "rest" } else { &view.clip };
    bar(ui, lane(0.0), scale, [0.0, duration], theme::line(), clip);
    if let Some(take) = &view.take {
        name(ui, whole, lane(1.0), "Take");
        bar(ui, lane(1.0), scale, [0.0, duration], theme::accent().gamma_multiply(0.45), &take.name);
    } else if let Some(Recorded { from_secs, secs, kept_secs }) = view.recording {
        name(ui, whole, lane(1.0), "Take");
        for (secs, strength, text) in [(secs, 0.35, ""), (kept_secs, 0.6, "recording")] {
            let color = theme::recording().gamma_multiply(strength);
            // The text stands where the recording began.
            let mut text = text;
            for part in recorded_parts(from_secs, secs, duration) {
                bar(ui, lane(1.0), scale, part, color, std::mem::take(&mut text));
            }
        }
    }
    points(ui, rect, scale, edited, duration);
    let flagged = flags(ui, rect, scale, edited.markers, &beats);
    let painter = ui.painter_at(rect);
    if (from..=to).contains(&now) {
        let x = scale.x(now);
        painter
            .line_segment([pos2(x, rect.top()), pos2(x, rect.bottom())], Stroke::new(2.0, theme::accent()));
        painter.circle_filled(pos2(x, rect.top() + RULER - 5.0), 4.0, theme::bright());
    }
    let response = response.hover_tooltip(
        "Drag to scrub. The wheel zooms, right-drag pans, and a double-click shows the whole timeline.",
    );
    if response.double_clicked() {
        *zoom = Zoom::default();
    }
    let primary = response.dragged_by(PointerButton::Primary) || response.clicked();
    let at = response.interact_pointer_pos().filter(|_| primary).map(|at| scale.secs(at.x));
    let at_track = super::tracks::ui(ui, (names, &beats), scale, view, edited);
    of_clip.or(flagged.or(at).or(at_track).map(Command::Seek))
}

/// The parts of a dance of `duration` that were recorded in `secs` from `from` on: a dance that repeats goes on at its start.
fn recorded_parts(from: f64, secs: f64, duration: f64) -> Vec<[f64; 2]> {
    let [from, secs] = [from, secs].map(|secs| if secs.is_finite() { secs.max(0.0) } else { 0.0 });
    let from = from.min(duration);
    if secs >= duration {
        return vec![[0.0, duration]];
    }
    let end = from + secs;
    if end > duration { vec![[from, duration], [0.0, end - duration]] } else { vec![[from, end]] }
}

/// The times of the beats on the timeline, seconds.
fn beats_of(view: &View, offset_secs: f64) -> Vec<f64> {
    let beats = view.sound.iter().flat_map(|sound| &sound.loaded.beats.secs);
    beats.map(|secs| secs + offset_secs).filter(|secs| *secs >= 0.0).collect()
}

/// Zooms about the pointer by the wheel; pans by the right or middle button.
fn magnify(ui: &Ui, response: &Response, rect: Rect, zoom: &mut Zoom, duration: f64) {
    if let Some(at) = response.hover_pos() {
        let wheel = ui.input(|input| input.smooth_scroll_delta);
        if wheel.y != 0.0 {
            let at = f64::from((at.x - rect.left()) / rect.width().max(1.0));
            zoom.by(f64::from(-wheel.y * 0.005).exp(), at, duration);
        }
        if wheel.x != 0.0 {
            zoom.pan(f64::from(-wheel.x / rect.width().max(1.0)));
        }
    }
    if response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle) {
        zoom.pan(f64::from(-response.drag_delta().x / rect.width().max(1.0)));
    }
}

/// Ticks and numbers at round times, or at frames of the film, `fps` per second, if there is room.
fn ruler(ui: &Ui, rect: Rect, scale: Scale, fps: f64) {
    let painter = ui.painter_at(rect);
    let ground = Rect::from_min_max(rect.min, pos2(rect.right(), rect.top() + RULER));
    painter.rect_filled(ground, 2.0, theme::page());
    let every = tick_secs(f64::from(scale.width) / (scale.to - scale.from).max(1e-9), 44.0, fps);
    let first = (scale.from / every).floor() as i64;
    // The number of labels is bounded by the width.
    let count = ((scale.to - scale.from) / every).ceil().clamp(0.0, 1000.0) as i64 + 1;
    let font = FontId::proportional(9.5);
    for i in first..=first + count {
        let secs = i as f64 * every;
        let x = scale.x(secs);
        let ends = [pos2(x, ground.bottom() - 6.0), pos2(x, ground.bottom())];
        painter.line_segment(ends, Stroke::new(1.0, theme::quiet()));
        let text = match every {
            e if e < FRAMES_BELOW_SECS => format!("f{}", (secs * fps).round()),
            e if e < 0.99 => format!("{secs:.1}"),
            e if e < 60.0 => format!("{secs:.0}"),
            _ => format!("{}:{:02}", secs as i64 / 60, secs as i64 % 60),
        };
        let text = painter.layout_no_wrap(text, font.clone(), theme::quiet());
        // A number that the edge would cut is left out.
        if x + 3.0 + text.size().x <= ground.right() {
            painter.galley(pos2(x + 3.0, ground.top() + 2.0), text, theme::quiet());
        }
    }
}

fn name(ui: &Ui, whole: Rect, lane: Rect, text: &str) {
    let at = pos2(whole.left() + 2.0, lane.center().y);
    ui.painter().text(at, Align2::LEFT_CENTER, text, FontId::proportional(10.5), theme::quiet());
}

fn bar(ui: &Ui, lane: Rect, scale: Scale, [from, to]: [f64; 2], color: egui::Color32, text: &str) {
    let painter = ui.painter_at(lane);
    let rect = Rect::from_x_y_ranges(scale.x(from)..=scale.x(to), lane.y_range());
    painter.rect_filled(rect, 3.0, color);
    let at = pos2(rect.left().max(lane.left()) + 5.0, lane.center().y);
    painter.text(at, Align2::LEFT_CENTER, text, FontId::proportional(10.5), theme::bright());
}

/// In and out points: the frames of a recording, as brackets that can be dragged.
fn points(ui: &Ui, rect: Rect, scale: Scale, edited: &mut Edited<'_>, duration: f64) {
    let recording = &mut *edited.recording;
    let fps = super::fps(recording);
    let last = ((duration * fps).round() as u64).max(1);
    let mut ends = [recording.first_frame, recording.end_frame.unwrap_or(last)];
    let before = ends;
    for (i, label) in ["In point", "Out point"].into_iter().enumerate() {
        let x = scale.x(ends[i] as f64 / fps);
        let handle = Rect::from_center_size(pos2(x, rect.top() + RULER * 0.5), vec2(10.0, RULER));
        let response = ui.interact(handle, Id::unique(("timeline", label)), Sense::drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, label));
        let secs = ends[i] as f64 / fps;
        spoken_value(&response, secs, [0.0, duration.max(secs)], || format!("{secs:.2} s"));
        if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            let frame = (scale.secs(at.x) * fps).round() as u64;
            ends[i] = if i == 0 { frame.min(ends[1].saturating_sub(1)) } else { frame.max(ends[0] + 1) };
        }
        // The last frame is the one before the out point.
        let (which, frame) = if i == 0 { ("first", ends[0]) } else { ("last", ends[1].saturating_sub(1)) };
        let tip = format!("{label}: the {which} frame of recordings is {frame}, at {fps} a second.");
        let response = response.hover_tooltip(tip);
        let hot = response.hovered() || response.dragged();
        let color = if hot { theme::bright() } else { theme::accent() };
        let (x, inward) = (scale.x(ends[i] as f64 / fps), if i == 0 { 4.0 } else { -4.0 });
        let painter = ui.painter_at(rect.expand2(Vec2::new(5.0, 0.0)));
        let (top, bottom) = (rect.top() + 1.0, rect.top() + RULER - 1.0);
        let stroke = Stroke::new(if hot { 2.0 } else { 1.5 }, color);
        painter.line_segment([pos2(x, top), pos2(x, bottom)], stroke);
        painter.line_segment([pos2(x, top), pos2(x + inward, top)], stroke);
        painter.line_segment([pos2(x, bottom), pos2(x + inward, bottom)], stroke);
    }
    if ends[0] != before[0] {
        recording.first_frame = ends[0];
    }
    if ends[1] != before[1] {
        recording.end_frame = (ends[1] != last).then_some(ends[1]);
    }
    // Frames that are not recorded are dimmed.
    let painter = ui.painter_at(rect);
    for [from, to] in
        [[0.0, ends[0] as f64 / fps], [ends[1] as f64 / fps, duration.max(ends[1] as f64 / fps)]]
    {
        let dim = Rect::from_x_y_ranges(scale.x(from)..=scale.x(to), rect.top() + RULER..=rect.bottom());
        painter.rect_filled(dim, 0.0, theme::panel().gamma_multiply(0.6));
    }
}

/// Markers as flags on the ruler. A click seeks, a drag moves the flag, the right button removes it.
fn flags(ui: &Ui, rect: Rect, scale: Scale, markers: &mut Vec<Marker>, beats: &[f64]) -> Option<f64> {
    let mut sought = None;
    let mut removed = None;
    for (i, marker) in markers.iter_mut().enumerate() {
        if !(scale.from..=scale.to).contains(&marker.secs) {
            continue;
        }
        let x = scale.x(marker.secs);
        let flag = Rect::from_min_size(pos2(x, rect.top() + 2.0), vec2(9.0, 9.0));
        let response = ui.interact(flag, Id::unique(("timeline marker", i)), Sense::click_and_drag());
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Marker {}", marker.name))
        });
        if let Some(at) =
            response.interact_pointer_pos().filter(|_| response.dragged_by(PointerButton::Primary))
        {
            // The marker's line is the left edge of its flag.
            marker.secs = sound::snapped(ui, scale, beats, scale.secs(at.x - 0.5 * flag.width()));
        }
        if response.clicked() {
            sought = Some(marker.secs);
        }
        if response.secondary_clicked() {
            removed = Some(i);
        }
        let hot = response.hovered();
        response.hover_tooltip(format!(
            "{} at {:.2} s. Click to go to it, drag to move it, right-click to remove it.",
            marker.name, marker.secs
        ));
        let painter = ui.painter_at(rect);
        let color = if hot { theme::bright() } else { theme::PLOT[1] };
        painter.line_segment([pos2(x, rect.top() + 2.0), pos2(x, rect.bottom())], Stroke::new(1.0, color));
        let corners: Vec<Pos2> =
            [(0.0, 0.0), (9.0, 3.5), (0.0, 7.0)].map(|(dx, dy)| flag.min + vec2(dx, dy)).to_vec();
        painter.add(egui::Shape::convex_polygon(corners, color, Stroke::NONE));
        let font = FontId::proportional(9.5);
        painter.text(pos2(x + 11.0, rect.top() + 9.0), Align2::LEFT_TOP, &marker.name, font, color);
    }
    if let Some(i) = removed {
        markers.remove(i);
    }
    sought
}

#[cfg(test)]
mod tests {
    use super::recorded_parts;

    #[test]
    fn a_recording_is_drawn_from_where_it_began() {
        assert_eq!(recorded_parts(3.0, 2.0, 8.0), [[3.0, 5.0]]);
        assert_eq!(recorded_parts(6.0, 3.0, 8.0), [[6.0, 8.0], [0.0, 1.0]], "the dance repeats");
        assert_eq!(recorded_parts(6.0, 30.0, 8.0), [[0.0, 8.0]]);
        assert_eq!(recorded_parts(f64::NAN, -1.0, 8.0), [[0.0, 0.0]]);
    }
}
