//! Rows that are made from a table of settings.

use egui::{Response, Ui};
use lovelock_base::settings::{AnySettings, Counts, Info, Kind, Setting, Settings, Value};

use super::number::{Number, count};
use super::rows::note_row;
use super::stops::stops;
use super::{choice, color, of_setting, reveal, toggle};

/// The rows of several settings of one struct, in this order.
pub(crate) fn settings<S: Settings>(ui: &mut Ui, names: &[&str], settings: &mut S, default: &S) {
    for name in names {
        setting(ui, name, settings, default);
    }
}

/// The row of the setting called `name`; three rows of a vector. Double-click restores its value in `default`.
///
/// # Panics
/// A name that is not in the table.
pub(crate) fn setting<S: Settings>(ui: &mut Ui, name: &str, settings: &mut S, default: &S) -> Response {
    let setting = entry::<S>(name);
    let mut value = setting.get(settings);
    let before = value;
    let (info, default) = (&setting.info, setting.get(default));
    let response = of_setting(ui, &*settings, info, before, |ui| show(ui, info, &mut value, default));
    if value != before {
        // A slider may offer values between those that are allowed.
        setting.set(settings, setting.info.clamp(value, before));
        // More can be typed than dragged, and numbers may limit each other.
        if !ui.input(|input| input.pointer.any_down()) {
            reconcile(ui, settings);
        }
    }
    response
}

/// Brings settings that limit each other into agreement, and says which of them has changed.
fn reconcile<S: Settings>(ui: &Ui, settings: &mut S) {
    let before = settings.clone();
    settings.reconcile();
    for Setting { info, .. } in S::TABLE {
        let of = |settings: &S| entry::<S>(info.name).get(settings);
        let (found, taken) = (of(&before), of(settings));
        if found != taken {
            let (found, taken) = (info.format(found), info.format(taken));
            let sentence = format!("{}: found {found}; other settings limit it to {taken}.", info.label);
            super::say(ui.ctx(), sentence);
        }
    }
}

/// The rows of every setting in the struct's own table.
pub(crate) fn all_settings(ui: &mut Ui, settings: &mut dyn AnySettings, default: &dyn AnySettings) {
    for info in settings.infos() {
        any_setting(ui, info, settings, default);
    }
}

/// The row of one setting of the struct's own table.
pub(crate) fn any_setting(
    ui: &mut Ui,
    info: &'static Info,
    settings: &mut dyn AnySettings,
    default: &dyn AnySettings,
) {
    let (Some((_, before)), Some((_, default))) = (settings.value(info.name), default.value(info.name))
    else {
        return;
    };
    let mut value = before;
    of_setting(ui, &*settings, info, before, |ui| show(ui, info, &mut value, default));
    if value != before {
        settings.assign(info.name, info.clamp(value, before));
    }
}

/// The table's entry of that name.
///
/// # Panics
/// A name that is not in the table.
pub(crate) fn entry<S: Settings>(name: &str) -> &'static Setting<S> {
    S::setting(name).unwrap_or_else(|| panic!("no setting is called {name}"))
}

fn show(ui: &mut Ui, info: &'static Info, value: &mut Value, default: Value) -> Response {
    let response = control_of(ui, info, value, default);
    reveal::shown(ui, info, &response);
    note_row(ui, info, response.rect);
    response
}

fn control_of(ui: &mut Ui, info: &'static Info, value: &mut Value, default: Value) -> Response {
    match (&info.kind, value, default) {
        (Kind::Number(range), Value::Number(value), Value::Number(default)) => {
            Number::of(info, range, info.label).show_wide(ui, value, default)
        }
        (Kind::Count(counts), Value::Count(value), Value::Count(default)) if counts.slides => {
            stops(ui, info, counts, value, default)
        }
        (Kind::Count(counts), Value::Count(value), Value::Count(default)) if counts.offered.is_empty() => {
            count(ui, info, counts, value, default)
        }
        (Kind::Count(counts), Value::Count(value), Value::Count(default)) => {
            offered(ui, info, counts, value, default)
        }
        (Kind::Switch, Value::Switch(value), Value::Switch(default)) => {
            toggle(ui, info.label, &info.tooltip(), value, default)
        }
        (Kind::Choice(options), value @ Value::Choice(_), default) => {
            let options: Vec<_> = options.iter().map(|(id, label)| (Value::Choice(id), label)).collect();
            choice(ui, info.label, &info.tooltip(), value, default, &options)
        }
        (Kind::Color, Value::Vector(value), Value::Vector(default)) => {
            color(ui, info.label, &info.tooltip(), value, default)
        }
        (Kind::Vector { range, axes }, Value::Vector(value), Value::Vector(default)) => {
            let [x, y, z] = [0, 1, 2]
                .map(|axis| Number::of(info, range, axes[axis]).show(ui, &mut value[axis], default[axis]));
            x | y | z
        }
        // Directions and what may be left out have controls of their own.
        _ => ui.label(info.label),
    }
}

/// A whole number out of those that are offered; another value is shown too.
fn offered(ui: &mut Ui, info: &Info, counts: &Counts, value: &mut u64, default: u64) -> Response {
    let mut offered = counts.offered.to_vec();
    if !offered.contains(value) {
        offered.push(*value);
        offered.sort_unstable();
    }
    let name = |number: u64| {
        let named =
            counts.offered.iter().position(|known| *known == number).and_then(|at| counts.names.get(at));
        named.map_or_else(|| format!("{number}{}", info.unit.suffix), |name| (*name).to_owned())
    };
    let names: Vec<String> = offered.iter().map(|number| name(*number)).collect();
    let options: Vec<_> = offered.iter().zip(&names).map(|(number, name)| (*number, name.as_str())).collect();
    choice(ui, info.label, &info.tooltip(), value, default, &options)
}
