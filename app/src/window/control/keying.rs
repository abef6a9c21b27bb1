//! Keys of the timeline at the controls: a diamond beside each row whose setting may follow the timeline, and a menu on its right button.
//!
//! A row receives the struct that it edits and not the path of the struct in the project. [`Keying`] therefore keeps where each struct
//! of the shown project lies in memory, for the pass in which the project is edited.

use std::sync::Arc;

use egui::{
    Context, Id, Popup, Pos2, Rect, Response, Sense, SetOpenCommand, Shape, Stroke, Ui, Vec2, WidgetInfo,
    pos2, vec2,
};
use lovelock_base::settings::{AnySettings, Info, Value};
use lovelock_project::Project;
use lovelock_project::animation::{is_keyable, key_numbers};

use super::HoverTooltip;
use crate::window::command::Command;
use crate::window::theme;

/// A struct of settings in the project that is edited.
struct Part {
    address: usize,
    path: String,
    infos: Vec<&'static Info>,
}

/// The track of a target, at the current time.
struct Tracked {
    target: String,
    has_key: bool,
    writes: bool,
}

/// The project that the rows of a pass edit.
pub(crate) struct Keying {
    parts: Vec<Part>,
    tracks: Vec<Tracked>,
}

impl Keying {
    /// Of a project that stays where it is in memory during the pass, at a time of its timeline in seconds. `writes` are the targets
    /// that are being recorded.
    pub(crate) fn of<'a>(
        project: &Project,
        secs: f64,
        writes: &(impl Iterator<Item = &'a str> + Clone),
    ) -> Self {
        let mut parts = Vec::new();
        collect(project, String::new(), &mut parts);
        let tracks = project.timeline.tracks.iter().map(|track| Tracked {
            target: track.target.clone(),
            has_key: track.key_at(secs).is_some(),
            writes: writes.clone().any(|target| target == track.target),
        });
        Self { parts, tracks: tracks.collect() }
    }

    /// The path of a setting of `part` in the project, such as `lights.0.intensity`; `None` if the part is not in the project.
    fn path(&self, part: &dyn AnySettings, info: &Info) -> Option<String> {
        let address = address(part);
        // The first part of a struct has the address of the struct.
        let is_it = |known: &&Info| known.name == info.name && known.text == info.text;
        let mut there = self.parts.iter().filter(|known| known.address == address);
        let part = there.find(|known| known.infos.iter().any(&is_it))?;
        Some(format!("{}{}", part.path, info.name))
    }
}

fn address(part: &dyn AnySettings) -> usize {
    std::ptr::from_ref(part).cast::<()>().addr()
}

fn collect(part: &dyn AnySettings, path: String, parts: &mut Vec<Part>) {
    for (name, child) in part.children() {
        collect(child, format!("{path}{name}."), parts);
    }
    parts.push(Part { address: address(part), path, infos: part.infos() });
}

fn keying() -> Id {
    Id::unique("keys of the timeline")
}

/// Starts a pass whose rows edit `keying`'s project.
pub(crate) fn begin(ctx: &Context, keying_of: Keying) {
    ctx.data_mut(|data| data.insert_temp(keying(), Arc::new(keying_of)));
}

/// Ends the pass; returns the commands of the rows.
pub(crate) fn end(ctx: &Context) -> Vec<Command> {
    ctx.data_mut(|data| {
        data.remove::<Arc<Keying>>(keying());
        data.remove::<EditedPane>(keying());
        data.remove_temp::<Vec<Command>>(keying()).unwrap_or_default()
    })
}

/// The pane of a comparison whose settings are in place of the project's.
#[derive(Clone, Copy)]
struct EditedPane(usize);

/// From now on the settings of a pane are in place of the project's: their rows set no keys, which would be the project's.
pub(crate) fn enter_pane(ctx: &Context, pane: usize) {
    ctx.data_mut(|data| data.insert_temp(keying(), EditedPane(pane)));
}

/// Ends what [`enter_pane`] began.
pub(crate) fn leave_pane(ctx: &Context) {
    ctx.data_mut(|data| data.remove::<EditedPane>(keying()));
}

/// The path of a setting while those of a pane are in place of the project's.
fn path_in_pane(path: String, EditedPane(pane): EditedPane) -> String {
    match path.strip_prefix("picture.").unwrap_or(&path) {
        "look.shading" => "compare.shading".to_owned(),
        name @ ("draw" | "transparency" | "backend") => format!("compare.panes.{pane}.{name}"),
        name if name.starts_with("shadow.") => format!("compare.panes.{pane}.{name}"),
        _ => path,
    }
}

/// The setting that the next rows change.
#[derive(Clone)]
struct RowSetting {
    path: String,
    info: &'static Info,
    value: Value,
}

/// Shows rows that change the setting `info` of `part`, whose value is `value`, with their keys.
pub(crate) fn of_setting<R>(
    ui: &mut Ui,
    part: &dyn AnySettings,
    info: &'static Info,
    value: Value,
    add: impl FnOnce(&mut Ui) -> R,
) -> R {
    let known: Option<Arc<Keying>> = ui.data(|data| data.get_temp(keying()));
    let path = known.and_then(|known| known.path(part, info));
    let pane: Option<EditedPane> = ui.data(|data| data.get_temp(keying()));
    let path = path.map(|path| match pane {
        Some(pane) => path_in_pane(path, pane),
        None => path,
    });
    if let Some(path) = path {
        ui.data_mut(|data| data.insert_temp(keying(), RowSetting { path, info, value }));
    }
    let shown = add(ui);
    ui.data_mut(|data| data.remove::<RowSetting>(keying()));
    shown
}

/// Adds the diamond and the menu of the right button to the row at `whole`, whose label is `name`; a row with a name of a file's own has
/// no keys. Returns whether the default shall
/// be restored.
pub(super) fn row(
    ui: &mut Ui,
    whole: Rect,
    name: &Response,
    label: Option<&'static str>,
    differs: bool,
) -> bool {
    let setting: Option<RowSetting> = ui.data(|data| data.get_temp(keying()));
    let row = setting.zip(label).and_then(|(setting, label)| KeyedRow::of(ui, setting, label));
    if let Some(row) = row.as_ref().filter(|row| row.numbers().is_some()) {
        row.diamond(ui, whole);
    }
    menu(ui, whole, name, row.as_ref(), differs)
}

struct KeyedRow {
    setting: RowSetting,
    target: String,
    label: &'static str,
    /// Whether the setting has a track, a key at the current time, and is being recorded.
    has_track: bool,
    has_key: bool,
    writes: bool,
}

impl KeyedRow {
    fn of(ui: &Ui, setting: RowSetting, label: &'static str) -> Option<Self> {
        let known: Arc<Keying> = ui.data(|data| data.get_temp(keying()))?;
        let target = setting.path.replace('.', "/");
        let track = known.tracks.iter().find(|track| track.target == target);
        let [has_key, writes] = track.map_or([false; 2], |track| [track.has_key, track.writes]);
        Some(Self { setting, target, label, has_track: track.is_some(), has_key, writes })
    }

    /// What a key would hold, if the setting may follow the timeline.
    fn numbers(&self) -> Option<Vec<f64>> {
        let RowSetting { path, info, value } = &self.setting;
        let numbers = is_keyable(path).then(|| key_numbers(info, *value))?;
        Some(numbers).filter(|numbers| !numbers.is_empty())
    }

    /// Why the setting has no keys; `None` if it may have them.
    fn why_not(&self) -> Option<&'static str> {
        if self.numbers().is_some() {
            return None;
        }
        Some(match self.setting.path.split('.').next().unwrap_or_default() {
            "compare" => "Panes do not follow the timeline. Close the comparison to set keys of the project.",
            "hair" | "body" => {
                "This setting cannot follow the timeline: a change reloads or regrows the hair."
            }
            _ => "This setting cannot follow the timeline: it applies to the whole timeline.",
        })
    }

    fn ask(ui: &Ui, request: Command) {
        ui.data_mut(|data| data.get_temp_mut_or_default::<Vec<Command>>(keying()).push(request));
    }

    fn add(&self, ui: &Ui) {
        if let Some(value) = self.numbers() {
            Self::ask(ui, Command::SetKey { target: self.target.clone(), value });
        }
    }

    fn remove(&self, ui: &Ui) {
        Self::ask(ui, Command::RemoveKey(self.target.clone()));
    }

    /// The diamond to the left of the label: filled at a key, outlined where there are keys at other times, and faint under the
    /// pointer where there are none.
    fn diamond(&self, ui: &Ui, whole: Rect) {
        const HALF: f32 = 4.5;
        let middle = pos2(whole.left() - 9.0, whole.center().y);
        let place = Rect::from_center_size(middle, Vec2::splat(16.0));
        let under_pointer = ui.rect_contains_pointer(place.union(whole));
        if !(self.has_track || under_pointer) || !ui.is_enabled() {
            return;
        }
        // Keyboard users reach keys by the timeline; another stop beside each control would double the way.
        let response = ui.interact(place, name_id(&self.target, self.label), Sense::CLICK);
        let what = if self.has_key { "Remove key of" } else { "Add key of" };
        response
            .widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, format!("{what} {}", self.label)));
        let hot = response.hovered();
        let color = match (self.writes, self.has_track) {
            (true, _) => theme::recording(),
            (_, true) => theme::accent(),
            _ if hot => theme::bright(),
            _ => theme::quiet().gamma_multiply(0.6),
        };
        let half = if hot { HALF + 0.5 } else { HALF };
        let corners: [Pos2; 4] =
            [(0.0, -half), (half, 0.0), (0.0, half), (-half, 0.0)].map(|(x, y)| middle + vec2(x, y));
        let fill = if self.has_key { color } else { theme::panel() };
        ui.painter().add(Shape::convex_polygon(corners.to_vec(), fill, Stroke::new(1.2, color)));
        let response = response.hover_tooltip(match (self.has_key, self.has_track) {
            (true, _) => "Removes the key at this time.",
            (false, true) => "Sets a key at this time. The track has keys at other times.",
            (false, false) => "Sets a key at this time, and adds a track to the timeline.",
        });
        if response.clicked() {
            if self.has_key { self.remove(ui) } else { self.add(ui) }
        }
    }
}

fn name_id(target: &str, label: &str) -> Id {
    Id::unique(("key diamond", target, label))
}

/// The menu of a row on the right button. Returns whether the default shall be restored.
fn menu(ui: &Ui, whole: Rect, name: &Response, row: Option<&KeyedRow>, differs: bool) -> bool {
    // A slider's rail senses drags but no clicks, so the right button is read from the input.
    let asked = ui.is_enabled()
        && ui.rect_contains_pointer(whole)
        && ui.input(|input| input.pointer.secondary_clicked());
    let mut reset = false;
    let entry = |ui: &mut Ui, text: &str, why_not: Option<&str>| {
        let response = ui.add_enabled(why_not.is_none(), egui::Button::new(text));
        let response = match why_not {
            Some(why_not) => response.disabled_hover_tooltip(why_not),
            None => response,
        };
        response.clicked()
    };
    Popup::menu(name)
        .id(name.id.with("menu of the row"))
        .open_memory(asked.then_some(SetOpenCommand::Bool(true)))
        .at_pointer_fixed()
        .show(|ui| {
            if let Some(row) = row {
                let why_not = row.why_not();
                if entry(ui, "Add key", why_not) {
                    row.add(ui);
                }
                if entry(ui, "Remove key", (!row.has_key).then_some("There is no key at this time.")) {
                    row.remove(ui);
                }
                if entry(ui, "Record this", why_not) {
                    let (target, label) = (row.target.clone(), row.label);
                    KeyedRow::ask(ui, Command::RecordControl { target, label });
                }
                ui.separator();
            }
            reset = entry(ui, "Reset", (!differs).then_some("The value is already the default."));
            if let Some(KeyedRow { setting: RowSetting { path, info, value }, .. }) = row {
                if entry(ui, "Copy value", None) {
                    ui.copy_text(info.format(*value));
                }
                if entry(ui, "Copy setting's name", None) {
                    ui.copy_text(path.clone());
                }
            }
        });
    reset
}

#[cfg(test)]
mod tests {
    use lovelock_base::settings::find;

    use super::*;

    #[test]
    fn settings_of_a_pane_are_not_those_of_the_project() {
        let project = Project::default();
        let path = |path: &str| path_in_pane(path.to_owned(), EditedPane(1));
        for (own, of_pane) in [
            ("shadow.method", "compare.panes.1.shadow.method"),
            ("picture.draw", "compare.panes.1.draw"),
            ("picture.transparency", "compare.panes.1.transparency"),
            ("picture.backend", "compare.panes.1.backend"),
            ("look.shading", "compare.shading"),
        ] {
            assert_eq!(path(own), of_pane);
            assert!(find(&project, own).is_some() && find(&project, of_pane).is_some(), "{of_pane}");
            assert!(is_keyable(own) && !is_keyable(of_pane), "{of_pane}");
        }
        for shared in ["lights.0.intensity", "look.extinction_scale", "picture.exposure_stops"] {
            assert_eq!(path(shared), shared);
            assert!(find(&project, shared).is_some(), "{shared}");
        }
    }
}
