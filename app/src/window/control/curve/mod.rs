//! The editor of curves along the hair: points that are dragged, with exact numbers and presets.

mod model;

use egui::{
    Align, Align2, CursorIcon, Event, EventFilter, FontId, Id, Key, Layout, Pos2, Rect, Response, RichText,
    Sense, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2,
};
use egui_material_icons::icons::{ICON_CLOSE, ICON_SHOW_CHART};
use lovelock_style::Ramp;

pub(crate) use model::CurveModel;

use super::number::Limits;
use crate::window::control::HoverTooltip;
use crate::window::{key_press, theme};

/// Height of the curve, points, and the margin around it for the handles.
const HEIGHT: f32 = 74.0;
const AIR: f32 = 9.0;
/// The widest curve, points.
const WIDEST: f32 = 420.0;
/// Segments with which the curve is drawn.
const SEGMENTS: u8 = 96;
/// How far above or below the curve a point is dropped to remove it, points.
const AWAY: f32 = 26.0;

/// How values are placed on the vertical axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Axis {
    /// In proportion.
    Even,
    /// Small values have more room than large ones, because differences between them are more visible.
    Root,
}

/// The editor of a curve.
pub(crate) struct Curve<'a> {
    /// The name of the value.
    pub(crate) label: &'a str,
    /// Its description, a sentence.
    pub(crate) tip: &'a str,
    /// Its unit, and the factor with which it is shown.
    pub(crate) unit: (&'a str, f32),
    /// Its range.
    pub(crate) range: [f32; 2],
    pub(crate) axis: Axis,
}

/// The editor of a ramp, whose default is `default`.
pub(crate) fn curve(ui: &mut Ui, label: &str, tip: &str, ramp: &mut Ramp, default: &Ramp) {
    let curve = Curve { label, tip, unit: (" %", 100.0), range: Ramp::RANGE, axis: Axis::Even };
    curve.show(ui, ramp, default);
}

impl Curve<'_> {
    /// Shows the curve. A click on the curve adds a point and a drag moves one; the arrow keys move the point that has the focus, ten times
    /// as far with Shift, and Delete removes it, as does dropping it above or below the curve. A double-click restores the default.
    pub(crate) fn show<M: CurveModel>(&self, ui: &mut Ui, value: &mut M, default: &M) -> Response {
        let before = value.clone();
        let id = ui.make_persistent_id((self.label, "curve"));
        let mut response = ui
            .push_id(id, |ui| {
                ui.set_max_width(ui.available_width().min(WIDEST));
                self.heading(ui, value, default);
                let response = self.canvas(ui, id, value, default);
                self.numbers(ui, id, value, default);
                response
            })
            .inner;
        if *value != before {
            response.mark_changed();
        }
        response
    }

    /// The name, marked if the curve differs from its default, and the menu.
    fn heading<M: CurveModel>(&self, ui: &mut Ui, value: &mut M, default: &M) {
        let differs = value != default;
        ui.horizontal(|ui| {
            let text = RichText::new(self.label);
            let text = if differs { text.color(theme::accent()) } else { text };
            let name = ui.add(egui::Label::new(text).sense(Sense::CLICK));
            if differs && name.double_clicked() {
                value.clone_from(default);
            }
            name.hover_tooltip(self.described(differs));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let name = format!("Presets of {}", self.label);
                let menu = ui.menu_button(ICON_SHOW_CHART, |ui| Self::menu(ui, value, default));
                menu.response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &name));
                menu.response.hover_tooltip("Common curves.");
            });
        });
    }

    fn described(&self, differs: bool) -> String {
        let changed = if differs { "\n\nChanged: double-click restores the default." } else { "" };
        format!("{}{changed}", self.tip)
    }

    fn menu<M: CurveModel>(ui: &mut Ui, value: &mut M, default: &M) {
        for (name, preset) in value.presets() {
            if ui.button(name).clicked() {
                *value = preset;
                ui.close();
            }
        }
        if value.is_free() {
            ui.separator();
            value.more(ui);
        }
        ui.separator();
        if ui.add_enabled(value != default, egui::Button::new("Restore the default")).clicked() {
            value.clone_from(default);
            ui.close();
        }
    }

    fn canvas<M: CurveModel>(&self, ui: &mut Ui, id: Id, value: &mut M, default: &M) -> Response {
        let size = vec2(ui.available_width(), HEIGHT + 2.0 * AIR);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        let area = rect.shrink(AIR);
        let held_id = id.with("held");
        if response.double_clicked() {
            value.clone_from(default);
        } else if value.is_free() {
            let pressed = ui.input(|input| input.pointer.press_origin());
            let pointer = response.interact_pointer_pos();
            // A drag that begins beside the points drags a new one.
            let at = if response.drag_started() { pressed } else { pointer.filter(|_| response.clicked()) };
            if let Some(at) = at {
                let added = value.add(self.value_at(area, at));
                ui.data_mut(|data| data.insert_temp(held_id, added));
                if let Some(added) = added {
                    select(ui, id, added);
                }
            }
            let held: Option<usize> = ui.data(|data| data.get_temp(held_id)).flatten();
            if let Some((held, pointer)) = held.zip(pointer.filter(|_| response.dragged())) {
                value.set(held, self.value_at(area, pointer));
            }
        }
        response.context_menu(|ui| Self::menu(ui, value, default));
        let points = value.points();
        let mut handles = Vec::with_capacity(points.len());
        let mut removed = None;
        for (i, point) in points.into_iter().enumerate() {
            let (handle, removes) = self.handle(ui, (id, rect, area), i, value, default);
            handles.push((self.place(area, point), handle, removes.is_some_and(|now| !now)));
            if removes == Some(true) {
                removed = Some(i);
            }
        }
        if let Some(i) = removed
            && value.remove(i)
        {
            select(ui, id, i.saturating_sub(1));
        }
        self.paint(ui, (rect, area), value, &handles);
        let (label, (unit, factor)) = (self.label, self.unit);
        let [root, tip] = [0.0, 1.0].map(|place| value.at(place) * factor);
        let described = format!("{label}: {root:.0}{unit} at the root, {tip:.0}{unit} at the tip");
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Canvas, true, &described));
        let free = if value.is_free() {
            "Click to add a point; drag it away or press Delete to remove it. "
        } else {
            ""
        };
        let tip = format!(
            "{}\n\nThe root is at the left, the tip at the right. Drag points, or use the arrow keys. {free}Right-click for \
             presets.",
            self.described(value != default)
        );
        let cursor = if value.is_free() { CursorIcon::Crosshair } else { CursorIcon::Default };
        response.hover_tooltip(tip).on_hover_cursor(cursor)
    }

    /// Shows one point and moves it. The second result is whether it is to be removed: `Some(false)` while it is held away from the curve.
    fn handle<M: CurveModel>(
        &self,
        ui: &Ui,
        (id, rect, area): (Id, Rect, Rect),
        point: usize,
        value: &mut M,
        default: &M,
    ) -> (Response, Option<bool>) {
        let points = value.points();
        let Some(&at) = points.get(point) else { return (ui.response(), None) };
        let around = Rect::from_center_size(self.place(area, at), Vec2::splat(18.0));
        let own = id.with(point);
        let response = ui.interact(around, own, Sense::click_and_drag());
        let mut removes = None;
        if response.clicked() || response.drag_started() {
            response.request_focus();
            select(ui, id, point);
        }
        let pointer = ui.input(|input| input.pointer.interact_pos());
        let is_away = pointer.is_some_and(|p| p.y < rect.top() - AWAY || p.y > rect.bottom() + AWAY);
        let can_go = value.is_free() && points.len() > 1;
        if response.double_clicked() {
            value.restore(point, default);
        } else if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            value.set(point, self.value_at(area, pointer));
            removes = (can_go && is_away).then_some(false);
        } else if response.drag_stopped() && can_go && is_away {
            removes = Some(true);
        }
        if response.has_focus() {
            select(ui, id, point);
            let filter =
                EventFilter { vertical_arrows: true, horizontal_arrows: true, ..EventFilter::default() };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(own, filter));
            let steps = arrow_keys(ui);
            if steps != [0.0; 2] {
                value.nudge(point, steps);
            }
            let none = egui::Modifiers::NONE;
            let removing = [Key::Delete, Key::Backspace];
            if can_go && removing.into_iter().any(|key| key_press::consume(ui.ctx(), none, key)) {
                removes = Some(true);
            }
        }
        response.context_menu(|ui| {
            if ui.add_enabled(can_go, egui::Button::new("Remove the point")).clicked() {
                removes = Some(true);
                ui.close();
            }
            Self::menu(ui, value, default);
        });
        let now = value.points().get(point).map_or(at[1], |point| point[1]);
        let name = format!("{}, {}", self.label, value.name(point));
        response.widget_info(|| WidgetInfo::slider(true, f64::from(now * self.unit.1), name.as_str()));
        (response.hover_tooltip(format!("{} Drag it, or use the arrow keys.", self.tip)), removes)
    }

    /// The exact numbers of the selected point.
    fn numbers<M: CurveModel>(&self, ui: &mut Ui, id: Id, value: &mut M, default: &M) {
        let points = value.points();
        let point = selected(ui, id).min(points.len().saturating_sub(1));
        let Some(&[place, height]) = points.get(point) else { return };
        let free = value.is_free();
        let (unit, factor) = self.unit;
        let [low, high] = self.range;
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let name = value.name(point);
            let label = ui.label(RichText::new(format!("At ({name})")).small().color(theme::quiet()));
            let mut to = place * 100.0;
            let tip = "Position of the selected point: 0 % is the root, 100 % the tip.";
            let shown = ui.add_enabled_ui(free, |ui| number(ui, "At", &mut to, 0.0..=100.0, " %")).inner;
            let fixed = "\n\nThis point cannot be moved along the hair.";
            let tip = if free { tip.to_owned() } else { format!("{tip}{fixed}") };
            if shown.labelled_by(label.id).hover_tooltip(&tip).disabled_hover_tooltip(&tip).changed() {
                value.set(point, [to / 100.0, height]);
            }
            let label = ui.label(RichText::new("Value").small().color(theme::quiet()));
            let mut to = height * factor;
            let shown =
                number(ui, "Value", &mut to, low * factor..=high * factor, unit).labelled_by(label.id);
            let shown = shown.hover_tooltip("Value at the selected point.");
            if shown.double_clicked() {
                value.restore(point, default);
            } else if shown.changed() {
                value.set(point, [place, to / factor]);
            }
            if free {
                let remove = egui::Button::new(ICON_CLOSE).frame(false);
                let response = ui.add_enabled(points.len() > 1, remove);
                response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, "Remove the point"));
                let tip = "Removes the selected point. One point always remains.";
                if response.hover_tooltip(tip).disabled_hover_tooltip(tip).clicked() && value.remove(point) {
                    select(ui, id, point.saturating_sub(1));
                }
            }
        });
    }

    /// The height of a value as a fraction of the curve's.
    fn share(&self, value: f32) -> f32 {
        let [low, high] = self.range;
        let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
        if self.axis == Axis::Root { share.sqrt() } else { share }
    }

    fn place(&self, area: Rect, [place, value]: [f32; 2]) -> Pos2 {
        pos2(area.left() + place * area.width(), area.bottom() - self.share(value) * area.height())
    }

    /// Place and value at a position on the screen.
    fn value_at(&self, area: Rect, at: Pos2) -> [f32; 2] {
        let share = ((area.bottom() - at.y) / area.height()).clamp(0.0, 1.0);
        let share = if self.axis == Axis::Root { share * share } else { share };
        let [low, high] = self.range;
        [((at.x - area.left()) / area.width()).clamp(0.0, 1.0), low + share * (high - low)]
    }

    fn paint<M: CurveModel>(
        &self,
        ui: &Ui,
        (rect, area): (Rect, Rect),
        value: &M,
        handles: &[(Pos2, Response, bool)],
    ) {
        let painter = ui.painter_at(rect);
        painter.rect_filled(area, 3.0, theme::page());
        let font = FontId::proportional(9.5);
        let ([low, high], (unit, factor)) = (self.range, self.unit);
        for share in [0.25, 0.5, 0.75, 1.0] {
            let y = area.bottom() - share * area.height();
            if share < 1.0 {
                painter.hline(area.x_range(), y, Stroke::new(1.0, theme::line()));
            }
            // The names of the ends are below.
            if share >= 0.5 {
                let part = if self.axis == Axis::Root { share * share } else { share };
                let text = format!("{:.0}{unit}", (low + part * (high - low)) * factor);
                let under = pos2(area.right() - 10.0, y + 1.0);
                let color = theme::quiet().gamma_multiply(0.6);
                painter.text(under, Align2::RIGHT_TOP, text, font.clone(), color);
            }
        }
        let along = (0..=SEGMENTS).map(|i| f32::from(i) / f32::from(SEGMENTS));
        let line: Vec<Pos2> = along.map(|place| self.place(area, [place, value.at(place)])).collect();
        painter.line(line, Stroke::new(2.0, theme::PLOT[1]));
        for (at, response, goes) in handles {
            let held = response.has_focus() || response.hovered() || response.dragged();
            let radius = if held { 6.0 } else { 4.5 };
            let color = match (goes, held) {
                (true, _) => theme::wrong(),
                (_, true) => theme::accent(),
                _ => theme::bright(),
            };
            painter.circle(*at, radius, color, Stroke::new(1.0, theme::page()));
        }
        let bottom = area.bottom() - 2.0;
        let roots = (area.left() + 10.0, Align2::LEFT_BOTTOM, "roots");
        let tips = (area.right() - 10.0, Align2::RIGHT_BOTTOM, "tips");
        for (x, align, name) in [roots, tips] {
            painter.text(pos2(x, bottom), align, name, font.clone(), theme::quiet());
        }
    }
}

/// A number that is typed or dragged.
fn number(
    ui: &mut Ui,
    label: &str,
    value: &mut f32,
    range: std::ops::RangeInclusive<f32>,
    suffix: &str,
) -> Response {
    let limits = Limits::of(ui, label, [range.start(), range.end()].map(|v| f64::from(*v)), (suffix, 1));
    let drag = egui::DragValue::new(value)
        .range(range)
        .clamp_existing_to_range(false)
        .max_decimals(1)
        .speed(0.5)
        .update_while_editing(false)
        .suffix(suffix)
        .custom_parser(limits.parser());
    ui.add_sized(vec2(58.0, ui.spacing().interact_size.y), drag)
}

/// The index of the selected point.
fn selected(ui: &Ui, id: Id) -> usize {
    ui.data(|data| data.get_temp(id.with("selected"))).unwrap_or(0)
}

fn select(ui: &Ui, id: Id, point: usize) {
    ui.data_mut(|data| data.insert_temp(id.with("selected"), point));
}

/// The arrow keys pressed in this pass, right and up positive, times ten with Shift.
fn arrow_keys(ui: &Ui) -> [f32; 2] {
    let mut steps = [0.0; 2];
    ui.input(|input| {
        for event in &input.events {
            let Event::Key { key, pressed: true, modifiers, .. } = event else { continue };
            let far = if modifiers.shift { 10.0 } else { 1.0 };
            match key {
                Key::ArrowRight => steps[0] += far,
                Key::ArrowLeft => steps[0] -= far,
                Key::ArrowUp => steps[1] += far,
                Key::ArrowDown => steps[1] -= far,
                _ => {}
            }
        }
    });
    steps
}
