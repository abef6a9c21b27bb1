//! A small editable curve from root to tip, with a handle at each end and one in the middle that bends it.

use std::ops::RangeInclusive;

use egui::{
    Align2, Event, EventFilter, FontId, Key, Pos2, Rect, Response, Sense, Stroke, Ui, Vec2, WidgetInfo, pos2,
    vec2,
};

use super::theme;

/// Height of the curve, points.
const HEIGHT: f32 = 74.0;

/// Margin around the curve for the handles, points.
const AIR: f32 = 9.0;

/// The step of an arrow key, as a fraction of the handle's range.
const KEY_STEP: f32 = 0.01;

/// A value that changes from the root of a wisp to its tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RampValue {
    /// At the root.
    pub(crate) root: f32,
    /// At the tip.
    pub(crate) tip: f32,
    /// Which part of the change is reached at the middle.
    pub(crate) bias: f32,
}

/// An editable curve.
pub(crate) struct Ramp<'a> {
    /// The name of the value.
    pub(crate) label: &'static str,
    /// Its description, a sentence.
    pub(crate) hint: &'static str,
    /// Its unit.
    pub(crate) unit: &'static str,
    /// The range of the ends.
    pub(crate) range: RangeInclusive<f32>,
    /// The range of the bias.
    pub(crate) bias: RangeInclusive<f32>,
    /// The value at a fraction of the way from root to tip; monotonic in the bias.
    pub(crate) at: &'a dyn Fn(&RampValue, f32) -> f32,
}

/// One of the three handles.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Handle {
    Root,
    Middle,
    Tip,
}

impl Handle {
    const ALL: [Self; 3] = [Self::Root, Self::Middle, Self::Tip];

    fn name(self) -> &'static str {
        match self {
            Self::Root => "roots",
            Self::Middle => "middle",
            Self::Tip => "tips",
        }
    }

    /// Its position along the wisp, 0 to 1.
    fn along(self) -> f32 {
        match self {
            Self::Root => 0.0,
            Self::Middle => 0.5,
            Self::Tip => 1.0,
        }
    }

    fn of(self, value: &RampValue) -> f32 {
        match self {
            Self::Root => value.root,
            Self::Middle => value.bias,
            Self::Tip => value.tip,
        }
    }

    fn set(self, value: &mut RampValue, to: f32) {
        match self {
            Self::Root => value.root = to,
            Self::Middle => value.bias = to,
            Self::Tip => value.tip = to,
        }
    }
}

impl Ramp<'_> {
    /// Shows the curve over the available width. The up and down keys move the handle that has the focus, ten times as far with
    /// Shift; a double-click on a handle restores its default.
    pub(crate) fn show(&self, ui: &mut Ui, value: &mut RampValue, default: RampValue) -> Response {
        let width = ui.available_width().min(420.0);
        let (rect, mut response) = ui.allocate_exact_size(vec2(width, HEIGHT + 2.0 * AIR), Sense::hover());
        let area = rect.shrink(AIR);
        let before = *value;
        let handles = Handle::ALL.map(|handle| (handle, self.handle(ui, area, handle, value, default)));
        self.paint(ui, area, value, &handles);
        if *value != before {
            response.mark_changed();
        }
        response
    }

    /// Shows one handle and moves it.
    fn handle(
        &self,
        ui: &Ui,
        area: Rect,
        handle: Handle,
        value: &mut RampValue,
        default: RampValue,
    ) -> Response {
        let around = Rect::from_center_size(self.place(area, value, handle), Vec2::splat(18.0));
        let id = ui.make_persistent_id((self.label, handle.name()));
        let mut response = ui.interact(around, id, Sense::click_and_drag());
        let before = handle.of(value);
        let range = if handle == Handle::Middle { &self.bias } else { &self.range };
        let (low, high) = (*range.start(), *range.end());
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }
        if response.double_clicked() {
            handle.set(value, handle.of(&default));
        } else if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            let share = ((area.bottom() - pointer.y) / area.height()).clamp(0.0, 1.0);
            let wanted = self.range.start() + share * share * (self.range.end() - self.range.start());
            if handle == Handle::Middle {
                self.bend(value, wanted);
            } else {
                handle.set(value, wanted);
            }
        }
        if response.has_focus() {
            let filter = EventFilter { vertical_arrows: true, ..EventFilter::default() };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
            let steps = arrow_keys(ui);
            if steps != 0.0 {
                // The up key moves the handle up, whichever way the bias bends the curve.
                let by = steps * KEY_STEP * (high - low) * self.upward(value, handle);
                handle.set(value, (handle.of(value) + by).clamp(low, high));
            }
        }
        let now = handle.of(value);
        if now != before {
            response.mark_changed();
        }
        let name = format!("{}, {}", self.label, handle.name());
        response.widget_info(|| WidgetInfo::slider(true, f64::from(now), name.as_str()));
        response.on_hover_text(format!("{} Drag it, or use the up and down keys.", self.hint))
    }

    /// 1 if a larger number raises the handle, -1 if it lowers it.
    fn upward(&self, value: &RampValue, handle: Handle) -> f32 {
        if handle != Handle::Middle {
            return 1.0;
        }
        let middle_at = |bias| (self.at)(&RampValue { bias, ..*value }, 0.5);
        if middle_at(*self.bias.start()) > middle_at(*self.bias.end()) { -1.0 } else { 1.0 }
    }

    /// Finds the bias that brings the middle closest to `wanted`; a flat curve cannot be bent.
    fn bend(&self, value: &mut RampValue, wanted: f32) {
        let middle_at = |bias| (self.at)(&RampValue { bias, ..*value }, 0.5);
        let (mut low, mut high) = (*self.bias.start(), *self.bias.end());
        if (middle_at(low) - middle_at(high)).abs() < 1e-4 * (self.range.end() - self.range.start()) {
            return;
        }
        let falls = middle_at(low) > middle_at(high);
        for _ in 0..24 {
            let middle = 0.5 * (low + high);
            if (middle_at(middle) < wanted) == falls {
                high = middle;
            } else {
                low = middle;
            }
        }
        value.bias = 0.5 * (low + high);
    }

    /// The position of a handle on the screen.
    fn at(&self, area: Rect, value: &RampValue, along: f32) -> Pos2 {
        let (low, high) = (*self.range.start(), *self.range.end());
        // Small numbers have more room than large ones, because differences between them are more visible.
        let share = (((self.at)(value, along) - low) / (high - low)).clamp(0.0, 1.0).sqrt();
        pos2(area.left() + along * area.width(), area.bottom() - share * area.height())
    }

    fn place(&self, area: Rect, value: &RampValue, handle: Handle) -> Pos2 {
        self.at(area, value, handle.along())
    }

    fn paint(&self, ui: &Ui, area: Rect, value: &RampValue, handles: &[(Handle, Response); 3]) {
        let painter = ui.painter();
        painter.rect_filled(area, 3.0, theme::PAGE);
        let font = FontId::proportional(9.5);
        let (low, high) = (*self.range.start(), *self.range.end());
        for share in [0.25, 0.5, 0.75, 1.0] {
            let y = area.bottom() - share * area.height();
            if share < 1.0 {
                painter.hline(area.x_range(), y, Stroke::new(1.0, theme::LINE));
            }
            if share < 0.5 {
                // The names of the ends are there.
                continue;
            }
            let value = format!("{:.0}{}", low + share * share * (high - low), self.unit);
            let under = pos2(area.right() - 10.0, y + 1.0);
            painter.text(under, Align2::RIGHT_TOP, value, font.clone(), theme::QUIET.gamma_multiply(0.6));
        }
        let corner = area.left_top() + vec2(10.0, 1.0);
        painter.text(corner, Align2::LEFT_TOP, self.label, font.clone(), theme::QUIET);
        let curve: Vec<Pos2> = (0..=48_u8).map(|i| self.at(area, value, f32::from(i) / 48.0)).collect();
        painter.line(curve, Stroke::new(2.0, theme::PLOT[1]));
        for (handle, response) in handles {
            let at = self.place(area, value, *handle);
            let held = response.has_focus() || response.hovered() || response.dragged();
            let radius = if held { 6.0 } else { 4.5 };
            painter.circle_filled(at, radius, if held { theme::ACCENT } else { theme::BRIGHT });
            painter.circle_stroke(at, radius, Stroke::new(1.0, theme::PAGE));
        }
        let ends = [
            (area.left_bottom(), Align2::LEFT_BOTTOM, "roots"),
            (area.right_bottom(), Align2::RIGHT_BOTTOM, "tips"),
        ];
        for (corner, align, name) in ends {
            let inward = if align == Align2::LEFT_BOTTOM { 10.0 } else { -10.0 };
            painter.text(corner + vec2(inward, -2.0), align, name, font.clone(), theme::QUIET);
        }
    }
}

/// The number of up and down keys pressed in this pass, up positive, times ten with Shift.
fn arrow_keys(ui: &Ui) -> f32 {
    ui.input(|input| {
        let pressed = input.events.iter().map(|event| match event {
            Event::Key { key, pressed: true, modifiers, .. } => {
                let far = if modifiers.shift { 10.0 } else { 1.0 };
                match key {
                    Key::ArrowUp => far,
                    Key::ArrowDown => -far,
                    _ => 0.0,
                }
            }
            _ => 0.0,
        });
        pressed.sum()
    })
}
