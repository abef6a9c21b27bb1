//! Tracks below the ruler: their curves, keys and buttons.

use egui::{Id, PointerButton, Pos2, Rect, Response, RichText, ScrollArea, Sense, Stroke, Ui, pos2, vec2};
use egui_material_icons::icons;
use lovelock_base::words::counted;
use lovelock_project::tracks::Track;

use super::scale::Scale;
use super::{Edited, View};
use crate::window::control::{HoverTooltip, spoken_value};
use crate::window::theme;

/// Height of a track, points.
const TRACK: f32 = 30.0;
/// The greatest height of all tracks unless the user sets one; more tracks scroll.
const MAX: f32 = 124.0;
/// Distance from a key within which the pointer grabs it, points.
const REACH: f32 = 6.0;

/// Height of the part that shows that number of tracks, points: as `wanted`, at most `most`, and neither less than one track nor
/// more than all.
pub(super) fn room(tracks: usize, wanted: Option<f32>, most: f32) -> f32 {
    let all = tracks as f32 * TRACK;
    let wanted = wanted.filter(|height| height.is_finite()).unwrap_or(MAX);
    wanted.min(most).max(TRACK).min(all)
}

/// A key that is being dragged: its index, which of its numbers, and the range of the lane at the start of the drag.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Dragged {
    key: usize,
    number: usize,
    range: [f64; 2],
}

/// An action on a whole track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Whole {
    Mute,
    Smooth,
    Delete,
}

/// Shows all tracks; dragged keys snap to the times of `beats`. Returns a time to seek to.
pub(super) fn ui(
    ui: &mut Ui,
    (names, beats): (f32, &[f64]),
    scale: Scale,
    view: &View,
    edited: &mut Edited<'_>,
) -> Option<f64> {
    let (tracks, stack) = (&mut *edited.tracks, edited.stack);
    if tracks.is_empty() {
        return None;
    }
    let mut sought = None;
    let mut asked = None;
    // egui's own least height would push the buttons above out of the panel.
    let room = ui.available_height().max(0.0);
    let scrolled = ScrollArea::vertical().id_salt("tracks").max_height(room).min_scrolled_height(0.0);
    scrolled.auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for (i, track) in tracks.iter_mut().enumerate() {
            let width = names + scale.x_range().span();
            let (whole, _) = ui.allocate_exact_size(vec2(width, TRACK), Sense::hover());
            let head = Rect::from_min_max(whole.min, pos2(scale.x_range().min - 4.0, whole.bottom()));
            let lane = Rect::from_x_y_ranges(scale.x_range(), whole.y_range().shrink(1.0));
            let writes = view.writing.targets.contains(&track.target);
            let label = track.label_in(stack);
            asked = head_ui(ui, head, i, (track, &label), writes).map(|what| (i, what)).or(asked);
            sought = lane_ui(ui, lane, (scale, beats, view.time_secs), i, (track, &label), writes).or(sought);
            if let Some(x) = scale.x_of(view.time_secs) {
                let line = [pos2(x, lane.top() - 1.0), pos2(x, lane.bottom() + 1.0)];
                ui.painter_at(lane.expand(1.0)).line_segment(line, Stroke::new(1.5, theme::accent()));
            }
        }
    });
    match asked {
        Some((i, Whole::Mute)) => tracks[i].muted = !tracks[i].muted,
        Some((i, Whole::Smooth)) => tracks[i].smooth(),
        Some((i, Whole::Delete)) => {
            tracks.remove(i);
        }
        None => {}
    }
    sought
}

/// The name of a track, and its buttons.
fn head_ui(
    ui: &mut Ui,
    head: Rect,
    index: usize,
    (track, label): (&Track, &str),
    writes: bool,
) -> Option<Whole> {
    let mut asked = None;
    let layout = egui::Layout::right_to_left(egui::Align::Center);
    let id = ("track head", index);
    ui.scope_builder(egui::UiBuilder::new().id_salt(id).max_rect(head).layout(layout), |ui| {
        ui.spacing_mut().item_spacing.x = 1.0;
        let mute = if track.muted { icons::ICON_VISIBILITY_OFF } else { icons::ICON_VISIBILITY };
        let many = track.keys.len() > 2;
        for (icon, name, tip, enabled, what) in [
            (
                icons::ICON_DELETE,
                "Delete track",
                "Removes the track. The project's own value is used again.",
                true,
                Whole::Delete,
            ),
            (icons::ICON_WAVES, "Smooth track", "Smooths jitter out of the track.", many, Whole::Smooth),
            (
                mute,
                "Mute track",
                "Mutes the track: the project's own value is used in its place.",
                true,
                Whole::Mute,
            ),
        ] {
            let button = egui::Button::new(RichText::from(icon).size(13.0)).frame(false);
            let response = ui.add_enabled(enabled, button).hover_tooltip(tip);
            let name = format!("{name} {label}");
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, enabled, &name));
            if response.clicked() {
                asked = Some(what);
            }
        }
        let color = if writes {
            theme::recording()
        } else if track.muted {
            theme::quiet()
        } else {
            theme::bright()
        };
        let text = egui::Label::new(RichText::new(label).size(10.5).color(color)).truncate();
        let room = vec2(ui.available_width(), head.height());
        ui.allocate_ui_with_layout(room, egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.add(text).hover_tooltip(format!("{label}: {}", counted(track.keys.len(), "key", "keys")));
        });
    });
    asked
}

/// Shows the curve of a track and its keys. Returns a time to seek to.
fn lane_ui(
    ui: &Ui,
    lane: Rect,
    (scale, beats, now): (Scale, &[f64], f64),
    index: usize,
    (track, label): (&mut Track, &str),
    writes: bool,
) -> Option<f64> {
    let id = Id::unique(("track", index));
    let response = ui.interact(lane, id, Sense::click_and_drag());
    let label = format!("Track {label}");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, &label));
    let own = range_of(track);
    if let Some(value) = track.value_at(now).and_then(|value| value.first().copied()) {
        spoken_value(&response, value, own, || format!("{value:.3}"));
    }
    let dragged = ui.data(|data| data.get_temp::<Dragged>(id));
    let range = dragged.map_or(own, |dragged| dragged.range);
    let y = |value: f64| {
        let part = (value - range[0]) / (range[1] - range[0]);
        lane.bottom() - 4.0 - (lane.height() - 8.0) * part.clamp(-0.1, 1.1) as f32
    };
    let near_to = |at: Option<Pos2>| {
        let at = at?;
        let distance =
            |key: &lovelock_project::tracks::Key, value: f64| pos2(scale.x(key.secs), y(value)).distance(at);
        let keys = track.keys.iter().enumerate();
        keys.flat_map(|(i, key)| key.value.iter().enumerate().map(move |(n, &v)| (i, n, distance(key, v))))
            .filter(|(.., distance)| *distance <= REACH)
            .min_by(|a, b| a.2.total_cmp(&b.2))
            .map(|(i, n, _)| (i, n))
    };
    let near = near_to(response.hover_pos().or(response.interact_pointer_pos()));
    // A drag is recognised some points after the button was pressed, but starts where it was pressed.
    let taken = near_to(ui.input(|input| input.pointer.press_origin()));
    let moved = drag(ui, id, &response, taken, dragged, own, (lane, scale, range, beats), track);
    paint(ui, lane, scale, track, writes, near.or(moved), y);
    if response.secondary_clicked()
        && let Some((key, _)) = near
        && track.keys.len() > 1
    {
        track.keys.remove(key);
    }
    if response.double_clicked()
        && near.is_none()
        && let Some(at) = response.interact_pointer_pos()
        && let Some(value) = track.value_at(scale.secs(at.x))
    {
        track.put(scale.secs(at.x), value);
    }
    let tip = "Drag a key to move it, right-click it to remove it, double-click to add one. A click elsewhere seeks.";
    let at = response.interact_pointer_pos().filter(|_| response.clicked() && near.is_none());
    response.hover_tooltip(tip);
    at.map(|at| scale.secs(at.x))
}

/// Moves the dragged key between its neighbours. Returns its index.
#[expect(clippy::too_many_arguments, reason = "called once; the parts of a lane")]
fn drag(
    ui: &Ui,
    id: Id,
    response: &Response,
    taken: Option<(usize, usize)>,
    dragged: Option<Dragged>,
    own: [f64; 2],
    (lane, scale, range, beats): (Rect, Scale, [f64; 2], &[f64]),
    track: &mut Track,
) -> Option<(usize, usize)> {
    if response.drag_started_by(PointerButton::Primary)
        && let Some((key, number)) = taken
    {
        ui.data_mut(|data| data.insert_temp(id, Dragged { key, number, range: own }));
    }
    if !response.dragged_by(PointerButton::Primary) {
        ui.data_mut(|data| data.remove::<Dragged>(id));
        return None;
    }
    let Dragged { key, number, .. } = dragged?;
    let at = response.interact_pointer_pos()?;
    let gap = 1.5 * Track::NEAREST_SECS;
    let after = key.checked_sub(1).and_then(|i| track.keys.get(i)).map_or(0.0, |before| before.secs + gap);
    let before = track.keys.get(key + 1).map_or(f64::INFINITY, |next| next.secs - gap);
    let moved = track.keys.get_mut(key)?;
    if after <= before {
        moved.secs = super::sound::snapped(ui, scale, beats, scale.secs(at.x)).clamp(after, before);
    }
    let part = f64::from((lane.bottom() - 4.0 - at.y) / (lane.height() - 8.0)).clamp(-0.1, 1.1);
    *moved.value.get_mut(number)? = range[0] + part * (range[1] - range[0]);
    Some((key, number))
}

/// The smallest and the largest value of a track, never equal.
fn range_of(track: &Track) -> [f64; 2] {
    let ranges = track.range();
    let low = ranges.iter().map(|range| range[0]).fold(f64::INFINITY, f64::min);
    let high = ranges.iter().map(|range| range[1]).fold(f64::NEG_INFINITY, f64::max);
    let half = (0.5 * (high - low)).max(1e-3 * high.abs().max(low.abs())).max(1e-6);
    let middle = 0.5 * (high + low);
    [middle - half, middle + half]
}

fn paint(
    ui: &Ui,
    lane: Rect,
    scale: Scale,
    track: &Track,
    writes: bool,
    hot: Option<(usize, usize)>,
    y: impl Fn(f64) -> f32,
) {
    let painter = ui.painter_at(lane.expand(1.0));
    let ground = if writes { theme::recording().gamma_multiply(0.18) } else { theme::page() };
    painter.rect_filled(lane, 2.0, ground);
    let dim = if track.muted { 0.35 } else { 1.0 };
    let numbers = track.keys.first().map_or(0, |key| key.value.len());
    let steps = (lane.width() / 3.0).ceil().clamp(1.0, 2000.0) as usize;
    let at = |i: usize| lane.left() + lane.width() * (i as f32 / steps as f32);
    let values: Vec<_> = (0..=steps).map(|i| (at(i), track.value_at(scale.secs(at(i))))).collect();
    for number in 0..numbers {
        let color = if numbers == 1 { theme::accent() } else { theme::AXES[number % theme::AXES.len()] };
        let color = color.gamma_multiply(dim);
        let point = |(x, value): &(f32, Option<Vec<f64>>)| {
            value.as_ref().and_then(|value| Some(pos2(*x, y(*value.get(number)?))))
        };
        painter.line(values.iter().filter_map(point).collect(), Stroke::new(1.3, color));
        // Dots that would touch are left out.
        let shown = track.keys.iter().filter(|key| scale.x_of(key.secs).is_some()).count();
        if shown as f32 * 5.0 > lane.width() {
            continue;
        }
        for (i, key) in track.keys.iter().enumerate() {
            let Some(x) = scale.x_of(key.secs) else { continue };
            let Some(&value) = key.value.get(number) else { continue };
            let is_hot = hot == Some((i, number));
            let (radius, color) = if is_hot { (4.0, theme::bright()) } else { (2.5, color) };
            painter.circle_filled(pos2(x, y(value)), radius, color);
        }
    }
}
