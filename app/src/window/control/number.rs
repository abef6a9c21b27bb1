//! Numbers that a slider changes.

use std::borrow::Cow;
use std::ops::RangeInclusive;

use egui::{Id, Key, Response, Slider, SliderClamping, Ui, Widget};
use lovelock_base::settings::{Counts, Info, Range, Unit};

use super::row;
use super::spoken::spoken_slider;

/// Width that a slider leaves for its number, points.
pub(super) const NUMBER_WIDTH: f32 = 78.0;

/// A number that a slider changes.
#[derive(Clone, Debug)]
pub(crate) struct Number {
    label: Cow<'static, str>,
    tip: String,
    /// What the slider offers.
    range: RangeInclusive<f64>,
    /// What can be typed.
    typed: [f64; 2],
    unit: Unit,
    logarithmic: bool,
}

impl Number {
    /// A number in `range`; `tip` says what it changes in the image.
    pub(crate) fn new(
        label: impl Into<Cow<'static, str>>,
        range: RangeInclusive<f64>,
        unit: Unit,
        tip: &str,
    ) -> Self {
        let typed = [*range.start(), *range.end()];
        Self { label: label.into(), tip: tip.to_owned(), range, typed, unit, logarithmic: false }
    }

    /// The number of a setting, called `label`.
    pub(super) fn of(info: &Info, range: &Range, label: &'static str) -> Self {
        let [low, high] = range.soft;
        let number = Self::new(label, low..=high, info.unit, &info.tooltip());
        Self { logarithmic: range.logarithmic, typed: range.hard, ..number }
    }

    /// The row. Double-click restores `default`.
    pub(crate) fn show(self, ui: &mut Ui, value: &mut f32, default: f32) -> Response {
        let mut wide = f64::from(*value);
        let before = wide;
        let response = self.show_wide(ui, &mut wide, f64::from(default));
        if wide.to_bits() != before.to_bits() {
            *value = wide as f32;
        }
        response
    }

    /// The same for a number of double precision.
    pub(super) fn show_wide(self, ui: &mut Ui, value: &mut f64, default: f64) -> Response {
        let Unit { suffix, factor, decimals, .. } = self.unit;
        let range = self.range.start() * factor..=self.range.end() * factor;
        // Angles come and go through sines: less than a millionth of the range is no difference.
        let differs = (*value - default).abs() > 1e-6 * (self.range.end() - self.range.start());
        row(ui, self.label.clone(), &self.tip, differs, value, default, |ui, value| {
            let limits = Limits::of(ui, &self.label, self.typed.map(|v| v * factor), (suffix, decimals));
            let dragged = ui.input(|input| input.pointer.any_down());
            let opens_menu = is_secondary(ui);
            ui.spacing_mut().slider_width = (ui.available_width() - NUMBER_WIDTH).max(40.0);
            let [low, high] = limits.range;
            let response = Slider::from_get_set(range.clone(), |new| {
                // The slider rounds to what it shows; that alone is no change.
                let shown = 0.5 * 0.1_f64.powi(decimals as i32);
                let old = *value * factor;
                let is_new = |new: &f64| new.is_finite() && !opens_menu && (new - old).abs() > shown;
                if let Some(new) = new.filter(is_new) {
                    // More can be typed than dragged.
                    let new =
                        if dragged { new.clamp(range.start().min(old), range.end().max(old)) } else { new };
                    *value = new.clamp(low.min(old), high.max(old)) / factor;
                }
                *value * factor
            })
            .logarithmic(self.logarithmic)
            // A project may hold values outside the slider's range: showing them must not change them.
            .clamping(SliderClamping::Never)
            // A typed number takes effect when it is entered, and Escape restores the old one.
            .update_while_editing(false)
            .fixed_decimals(decimals)
            .suffix(suffix)
            .custom_parser(limits.parser())
            .ui(ui);
            spoken_slider(ui, &response, [low, high], || format!("{:.decimals$}{suffix}", *value * factor));
            response
        })
    }
}

/// What can be typed into a number. A number outside is brought inside, and a message says so.
#[derive(Clone)]
pub(crate) struct Limits {
    ctx: egui::Context,
    label: String,
    /// The lowest and the highest number, as shown.
    range: [f64; 2],
    suffix: String,
    decimals: usize,
    canceled: bool,
}

impl Limits {
    /// The limits of the number called `label`, as the window shows it with a suffix and some decimals.
    pub(crate) fn of(ui: &Ui, label: &str, range: [f64; 2], (suffix, decimals): (&str, usize)) -> Self {
        let (label, suffix) = (label.to_owned(), suffix.to_owned());
        Self { ctx: ui.ctx().clone(), label, range, suffix, decimals, canceled: is_escaped(ui) }
    }

    /// Reads what was typed; `None` where it is no number or Escape was pressed.
    pub(crate) fn parser(self) -> impl Fn(&str) -> Option<f64> {
        move |text| {
            let number = typed(text, &self.suffix).filter(|_| !self.canceled)?;
            let [low, high] = self.range;
            // The text of an untouched field is rounded.
            let rounding = 0.5 * 0.1_f64.powi(self.decimals as i32);
            let inside = number.clamp(low, high);
            if (number - inside).abs() > rounding {
                let say = |v: f64| short(v, self.decimals);
                let (label, suffix) = (&self.label, &self.suffix);
                super::say(
                    &self.ctx,
                    format!(
                        "{label}: found {}{suffix}; must be {} to {}{suffix}. It is set to {}{suffix}.",
                        say(number),
                        say(low),
                        say(high),
                        say(inside),
                    ),
                );
            }
            Some(inside)
        }
    }
}

/// A number with at most that many decimals and no zeros at its end.
fn short(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The row of a whole number with a slider.
pub(super) fn count(ui: &mut Ui, info: &Info, counts: &Counts, value: &mut u64, default: u64) -> Response {
    let Unit { suffix, factor, decimals, .. } = info.unit;
    row(ui, info.label, &info.tooltip(), *value != default, value, default, |ui, value| {
        let decimals = if factor == 1.0 { 0 } else { decimals };
        let least = if counts.zero { 0 } else { counts.hard[0] };
        let range = [least, counts.hard[1]].map(|bound| bound as f64 * factor);
        let limits = Limits::of(ui, info.label, range, (suffix, decimals));
        let dragged = ui.input(|input| input.pointer.any_down());
        let opens_menu = is_secondary(ui);
        ui.spacing_mut().slider_width = (ui.available_width() - NUMBER_WIDTH).max(40.0);
        let [low, high] = counts.soft.map(|bound| bound as f64 * factor);
        let slider = Slider::from_get_set(low..=high, |new| {
            if let Some(new) = new.filter(|new| new.is_finite() && !opens_menu) {
                let old = *value as f64 * factor;
                // More can be typed than dragged.
                let new = if dragged { new.clamp(low.min(old), high.max(old)) } else { new };
                *value = (new.clamp(range[0].min(old), range[1].max(old)) / factor).round() as u64;
            }
            *value as f64 * factor
        });
        // Whole numbers that are shown in a larger unit have digits after the point.
        let slider = if factor == 1.0 { slider.integer() } else { slider.fixed_decimals(decimals) };
        let response = slider
            .suffix(suffix)
            .custom_parser(limits.parser())
            .logarithmic(counts.logarithmic)
            .clamping(SliderClamping::Never)
            .update_while_editing(false)
            .ui(ui);
        spoken_slider(ui, &response, range, || format!("{:.decimals$}{suffix}", *value as f64 * factor));
        response
    })
}

/// Whether the right button, which opens the menu of a control, is or was just held. egui's sliders follow every button.
pub(super) fn is_secondary(ui: &Ui) -> bool {
    ui.input(|input| {
        input.pointer.secondary_down() || input.pointer.button_released(egui::PointerButton::Secondary)
    })
}

/// Whether Escape was pressed in this pass or the one before, so that the text of a field is discarded. The field itself sees the
/// key for one pass only, and takes its text in the next one.
pub(crate) fn is_escaped(ui: &Ui) -> bool {
    let (id, now) = (Id::unique("escape"), ui.ctx().cumulative_pass_nr());
    if ui.input(|input| input.key_pressed(Key::Escape)) {
        ui.data_mut(|data| data.insert_temp(id, now));
    }
    ui.data(|data| data.get_temp::<u64>(id)).is_some_and(|pressed| now <= pressed + 1)
}

/// The number in what was typed, with or without its unit; `None` where it is not a finite number.
pub(crate) fn typed(text: &str, unit: &str) -> Option<f64> {
    let text = text.trim();
    let text = text.strip_suffix(unit.trim()).unwrap_or(text);
    let plain: String =
        text.chars().filter(|c| !c.is_whitespace()).map(|c| if c == '−' { '-' } else { c }).collect();
    plain.parse().ok().filter(|number: &f64| number.is_finite())
}
