//! The rows of a panel: a label, a control with its unit, a tooltip; a mark where it differs from its default.

use std::ops::RangeInclusive;

use egui::{Id, Key, PointerButton, Response, RichText, Sense, Slider, SliderClamping, Ui, Vec2, Widget};

use super::theme;

/// Width of the column of labels, points.
const LABEL_WIDTH: f32 = 104.0;

/// A number that a slider changes.
#[derive(Clone, Debug)]
pub(crate) struct Number {
    label: &'static str,
    tip: &'static str,
    range: RangeInclusive<f32>,
    unit: &'static str,
    factor: f32,
    decimals: usize,
    logarithmic: bool,
}

impl Number {
    /// A number of no unit in `range`; `tip` says what it changes in the picture.
    pub(crate) fn new(label: &'static str, range: RangeInclusive<f32>, tip: &'static str) -> Self {
        Self { label, tip, range, unit: "", factor: 1.0, decimals: 2, logarithmic: false }
    }

    /// Shown in `unit`, of which the value holds `factor` each.
    pub(crate) fn unit(self, unit: &'static str, factor: f32) -> Self {
        Self { unit, factor, ..self }
    }

    /// Metres, shown in millimetres.
    pub(crate) fn millimetres(self) -> Self {
        self.unit(" mm", 1e3).decimals(1)
    }

    /// Metres, shown in centimetres.
    pub(crate) fn centimetres(self) -> Self {
        self.unit(" cm", 1e2).decimals(1)
    }

    /// Radians, shown in degrees.
    pub(crate) fn degrees(self) -> Self {
        self.unit("°", 1_f32.to_degrees()).decimals(0)
    }

    /// A fraction, shown in per cent.
    pub(crate) fn percent(self) -> Self {
        self.unit(" %", 1e2).decimals(0)
    }

    /// Digits after the point.
    pub(crate) fn decimals(self, decimals: usize) -> Self {
        Self { decimals, ..self }
    }

    /// Even steps of the slider are even factors.
    pub(crate) fn logarithmic(self) -> Self {
        Self { logarithmic: true, ..self }
    }

    /// The row. Double-click restores `default`.
    pub(crate) fn show(self, ui: &mut Ui, value: &mut f32, default: f32) -> Response {
        let factor = f64::from(self.factor);
        let range = f64::from(*self.range.start()) * factor..=f64::from(*self.range.end()) * factor;
        // Angles come and go through sines: what is not a millionth of the range is no difference.
        let differs = (*value - default).abs() > 1e-6 * (*self.range.end() - *self.range.start());
        row(ui, self.label, self.tip, differs, value, default, |ui, value| {
            let left = is_left(ui);
            ui.spacing_mut().slider_width = (ui.available_width() - 78.0).max(40.0);
            Slider::from_get_set(range, |new| {
                // The slider rounds to what it shows; that alone is no change.
                let shown = 0.5 * 0.1_f64.powi(self.decimals as i32);
                let old = f64::from(*value) * factor;
                if let Some(new) = new.filter(|new| new.is_finite() && (new - old).abs() > shown) {
                    *value = (new / factor) as f32;
                }
                f64::from(*value) * factor
            })
            .logarithmic(self.logarithmic)
            // A project may hold more than the slider offers: showing it must not change it.
            .clamping(SliderClamping::Edits)
            // A number counts when it is entered: half of it is no wish, and Escape leaves what was there.
            .update_while_editing(false)
            .fixed_decimals(self.decimals)
            .suffix(self.unit)
            .custom_parser(|text| typed(text, self.unit).filter(|_| !left))
            .ui(ui)
        })
    }
}

/// Whether Escape was pressed in this pass or the one before, so that what a field holds is not meant. The field
/// itself knows for one pass only, and takes its text in the next one.
pub(crate) fn is_left(ui: &Ui) -> bool {
    let (id, now) = (Id::unique("escape"), ui.ctx().cumulative_pass_nr());
    if ui.input(|input| input.key_pressed(Key::Escape)) {
        ui.data_mut(|data| data.insert_temp(id, now));
    }
    ui.data(|data| data.get_temp::<u64>(id)).is_some_and(|pressed| now <= pressed + 1)
}

/// The number in what was typed, with or without its unit; none where it is no finite number.
pub(crate) fn typed(text: &str, unit: &str) -> Option<f64> {
    let text = text.trim();
    let text = text.strip_suffix(unit.trim()).unwrap_or(text);
    let plain: String =
        text.chars().filter(|c| !c.is_whitespace()).map(|c| if c == '−' { '-' } else { c }).collect();
    plain.parse().ok().filter(|number: &f64| number.is_finite())
}

/// A whole number that a slider changes.
pub(crate) fn count(
    ui: &mut Ui,
    label: &'static str,
    range: RangeInclusive<u32>,
    tip: &'static str,
    value: &mut u32,
    default: u32,
) -> Response {
    row(ui, label, tip, *value != default, value, default, |ui, value| {
        let left = is_left(ui);
        ui.spacing_mut().slider_width = (ui.available_width() - 78.0).max(40.0);
        let wide = range.end() / range.start().max(&1) > 50;
        let bounds = f64::from(*range.start())..=f64::from(*range.end());
        Slider::from_get_set(bounds, |new| {
            if let Some(new) = new.filter(|new| new.is_finite()) {
                *value = new.round() as u32;
            }
            f64::from(*value)
        })
        .integer()
        .custom_parser(|text| typed(text, "").filter(|_| !left))
        .logarithmic(wide)
        .clamping(SliderClamping::Edits)
        .update_while_editing(false)
        .ui(ui)
    })
}

/// A choice among a few.
pub(crate) fn choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    label: &'static str,
    tip: &'static str,
    value: &mut T,
    default: T,
    options: &[(T, &str)],
) -> Response {
    row(ui, label, tip, *value != default, value, default, |ui, value| {
        let chosen = options.iter().find(|(option, _)| option == value).map_or("", |(_, name)| name);
        let width = ui.available_width() - 4.0;
        egui::ComboBox::from_id_salt(label)
            .selected_text(chosen)
            .width(width)
            // Room for a dozen options without scrolling.
            .height(320.0)
            .truncate()
            .show_ui(ui, |ui| {
                for (option, name) in options {
                    ui.selectable_value(value, *option, *name);
                }
            })
            .response
    })
}

/// Something that is on or off.
pub(crate) fn toggle(
    ui: &mut Ui,
    label: &'static str,
    tip: &'static str,
    value: &mut bool,
    default: bool,
) -> Response {
    row(ui, label, tip, *value != default, value, default, |ui, value| ui.checkbox(value, ""))
}

/// Controls that do nothing where there is a reason `why_not`: they cannot be used then, and their tooltips say why.
pub(crate) fn unless<R>(ui: &mut Ui, why_not: Option<&str>, add: impl FnOnce(&mut Ui) -> R) -> R {
    let id = Id::unique("why not");
    if let Some(why_not) = why_not {
        ui.data_mut(|data| data.insert_temp(id, why_not.to_owned()));
    }
    let shown = ui.add_enabled_ui(why_not.is_none(), add).inner;
    ui.data_mut(|data| data.remove::<String>(id));
    shown
}

/// A colour, linear sRGB.
pub(crate) fn color(
    ui: &mut Ui,
    label: &'static str,
    tip: &'static str,
    value: &mut [f32; 3],
    default: [f32; 3],
) -> Response {
    row(ui, label, tip, *value != default, value, default, |ui, value| {
        // The button turns the colour to hue and back, which rounds: only what the user picks is taken.
        let mut picked = *value;
        let response = ui.color_edit_button_rgb(&mut picked);
        if response.changed() {
            *value = picked;
        }
        response
    })
}

/// One row: the label with its mark, then what `add` draws, tied to the label for screen readers and tests.
pub(crate) fn row<T>(
    ui: &mut Ui,
    label: &'static str,
    tip: &str,
    differs: bool,
    value: &mut T,
    default: T,
    add: impl FnOnce(&mut Ui, &mut T) -> Response,
) -> Response {
    ui.horizontal(|ui| {
        let text = RichText::new(label);
        let text = if differs { text.color(theme::ACCENT) } else { text };
        let size = Vec2::new(LABEL_WIDTH, ui.spacing().interact_size.y);
        let name = ui
            .allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
                ui.set_min_width(LABEL_WIDTH);
                ui.add(egui::Label::new(text).sense(Sense::click()).truncate())
            })
            .inner;
        let tip = if differs {
            format!("{tip}\n\nChanged: double-click restores the default.")
        } else {
            tip.to_owned()
        };
        let why_not: Option<String> = ui.data(|data| data.get_temp(Id::unique("why not")));
        let tip = why_not.map_or(tip.clone(), |why_not| format!("{tip}\n\n{why_not}"));
        let mut response = add(ui, value).labelled_by(name.id);
        let mut name = name;
        // A tooltip that is open stays while the pointer rests: a dialog that comes over it must end it.
        if ui.memory(|memory| memory.is_above_modal_layer(ui.layer_id())) {
            response = response.on_hover_text(&tip).on_disabled_hover_text(&tip);
            name = name.on_hover_text(&tip).on_disabled_hover_text(&tip);
        }
        // A slider's rail takes drags and no clicks, so what it says of a double-click is not enough.
        let twice = ui.input(|input| input.pointer.button_double_clicked(PointerButton::Primary));
        if differs && twice && ui.is_enabled() && (name.contains_pointer() || response.contains_pointer()) {
            *value = default;
            response.mark_changed();
        }
        response
    })
    .inner
}

/// A titled part of a panel that folds.
///
/// Returns what `add` made of it where it is unfolded.
pub(crate) fn section<R>(ui: &mut Ui, title: &str, open: bool, add: impl FnOnce(&mut Ui) -> R) -> Option<R> {
    egui::CollapsingHeader::new(RichText::new(title).strong()).default_open(open).show(ui, add).body_returned
}

/// A line of quiet text.
pub(crate) fn note(ui: &mut Ui, text: impl Into<String>) {
    ui.label(RichText::new(text.into()).small().color(theme::QUIET));
}
