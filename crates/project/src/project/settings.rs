//! Settings by their path in the project file, and the list of all of them.

use std::fmt::Write as _;

use lovelock_base::settings::{Entry, Info, Kind, SettingError, Settings as _, Value, entries, find, set};
use lovelock_groom::HairTie;
use serde_json::json;

use super::super::Project;
use crate::error::ProjectError;

/// A setting with a new value, as `--set` names it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assignment {
    /// The path of the setting.
    pub name: String,
    /// The new value as text.
    pub value: String,
}

/// The sections that a take has recorded.
const RECORDED: [&str; 4] = ["body", "motion", "hair", "simulation"];

impl Project {
    /// Changes settings.
    ///
    /// # Errors
    /// A name without a setting, a value that it does not take, or a setting of something that a take has recorded.
    pub fn assign(&mut self, set: &[Assignment]) -> Result<(), ProjectError> {
        for Assignment { name, value } in set {
            let section = name.split('.').next().unwrap_or_default();
            let free = self.plays_curves()
                && (["body", "motion"].contains(&section) || name.starts_with("hair.import."));
            if self.take.file.is_some() && RECORDED.contains(&section) && !free {
                let message = format!(
                    "--set {name}: a take plays as recorded; must be a setting outside the section {section}"
                );
                return Err(ProjectError::option(message));
            }
            self.set(name, value).map_err(|error| ProjectError::option(format!("--set {error}")))?;
        }
        if !set.is_empty() {
            *self = self.clamped();
        }
        Ok(())
    }

    /// What the setting at `path` is, and its value. Paths are those of the project file with dots, such as `simulation.wind.speed`
    /// or `lights.0.intensity`.
    pub fn setting(&self, path: &str) -> Option<(&'static Info, Value)> {
        find(self, path)
    }

    /// Sets the setting at `path` to what `text` says. A hairstyle brings its colours and ties, as in the window.
    ///
    /// # Errors
    /// A path without a setting, with the nearest that has one, or a value that the setting does not take.
    pub fn set(&mut self, path: &str, text: &str) -> Result<(), SettingError> {
        let mut changed = self.clone();
        // The weight of a name that is not set is 0.
        if let Some(name) = path.strip_prefix("body.face.").and_then(|rest| rest.strip_suffix(".weight")) {
            changed.body.face.0.entry(name.to_owned()).or_default();
        }
        set(&mut changed, path, text)?;
        match path {
            "hair.preset" => self.set_preset(changed.hair.preset),
            "hair.source" => self.set_hair_source(changed.hair.source),
            _ => *self = changed,
        }
        Ok(())
    }
}

/// Every setting, with its value in the default project. Lists such as lights stand there with their first entry alone.
pub fn all_settings() -> Vec<Entry> {
    let mut project = Project::default();
    project.lights.truncate(1);
    project.compare.panes.truncate(1);
    project.hair.ties = vec![HairTie::default()];
    project.body.colliders.shapes.insert("NAME".to_owned(), lovelock_motion::ColliderEdit::default());
    project.body.face.0.insert("NAME".to_owned(), lovelock_motion::FaceWeight::default());
    let listed = |entry: &Entry| !entry.path.starts_with("compare.panes.0.shadow.");
    entries(&project).into_iter().filter(listed).collect()
}

/// The settings whose paths begin with `section`, or all of them where it is empty.
pub fn settings_of(section: &str) -> Vec<Entry> {
    let inside = |path: &str| {
        section.is_empty() || path.strip_prefix(section).is_some_and(|rest| rest.starts_with('.'))
    };
    all_settings().into_iter().filter(|entry| inside(&entry.path)).collect()
}

/// The settings that differ from the default project, as `--set` takes them. Lists are compared entry by entry.
pub fn changed_settings(project: &Project) -> Vec<String> {
    let default: std::collections::HashMap<_, _> =
        entries(&Project::default()).into_iter().map(|entry| (entry.path, entry.value)).collect();
    let changed = entries(project).into_iter().filter(|entry| default.get(&entry.path) != Some(&entry.value));
    changed.map(|entry| format!("{}={}", entry.path, entry.info.format(entry.value))).collect()
}

/// The list for other programs: an object with `settings`.
pub fn settings_json(settings: &[Entry]) -> serde_json::Value {
    let rows: Vec<_> = settings
        .iter()
        .map(|Entry { path, info, value }| {
            json!({
                "name": path,
                "label": info.label,
                "unit": info.unit.base,
                "range": range_json(info),
                "default": value_json(*value),
                "symbol": info.symbol,
                "text": info.text,
            })
        })
        .collect();
    json!({ "settings": rows })
}

fn range_json(info: &Info) -> serde_json::Value {
    match info.kind {
        Kind::Number(range) | Kind::Vector { range, .. } => json!(range.hard),
        Kind::Count(counts) if !counts.choices.is_empty() => json!(counts.choices),
        Kind::Count(counts) if counts.zero => json!([0, counts.hard[1]]),
        Kind::Count(counts) => json!(counts.hard),
        Kind::Switch => json!([false, true]),
        Kind::Choice(options) => json!(options.iter().map(|(id, _)| id).collect::<Vec<_>>()),
        Kind::Color => json!([0.0, Kind::BRIGHTEST]),
        Kind::Direction { .. } => serde_json::Value::Null,
    }
}

/// A number of single precision is written with its own digits: 0.15 and not 0.15000000596046448.
fn value_json(value: Value) -> serde_json::Value {
    let short = |v: f64| (v as f32).to_string().parse::<f64>().unwrap_or(v);
    match value {
        Value::Number(v) if f64::from(v as f32) == v => json!(short(v)),
        Value::Number(v) => json!(v),
        Value::Count(v) => json!(v),
        Value::Switch(v) => json!(v),
        Value::Choice(id) => json!(id),
        Value::Vector(v) => json!(v.map(|v| short(f64::from(v)))),
        Value::None => serde_json::Value::Null,
    }
}

/// The list for people: path, range, default and text, a paragraph per section.
pub fn settings_text(settings: &[Entry]) -> String {
    let mut text = String::new();
    let mut section = "";
    for Entry { path, info, value } in settings {
        let of = path.rsplit_once('.').map_or("", |(section, _)| section);
        if of != section {
            let _ = writeln!(text, "{}[{of}]", if section.is_empty() { "" } else { "\n" });
            section = of;
        }
        let _ = writeln!(text, "{path} = {}  ({})", info.format(*value), info.values());
        let _ = writeln!(text, "    {}: {}", info.label, tooltip(info));
    }
    text
}

/// What it changes, its symbol, and what is used where it is left out.
fn tooltip(info: &Info) -> String {
    info.none.map_or_else(|| info.tooltip(), |none| format!("{} None: {none}.", info.tooltip()))
}

/// The list as a table of Markdown, names without the first part `section` of their paths.
pub fn settings_table(section: &str) -> String {
    let settings = settings_of(section);
    let mut text =
        String::from("| setting | label | range | default | what it changes |\n|---|---|---|---|---|\n");
    for Entry { path, info, value } in &settings {
        let name = path.strip_prefix(section).map_or(path.as_str(), |rest| rest.trim_start_matches('.'));
        let _ = writeln!(
            text,
            "| `{name}` | {} | {} | {} | {} |",
            info.label,
            info.values(),
            info.format(*value),
            tooltip(info)
        );
    }
    text
}

/// The page of all settings, as Markdown.
pub fn settings_page() -> String {
    let mut text = String::from(
        "# Settings\n\nEvery setting of a project, by its name in the project file. `--set NAME=VALUE` changes one on the \
         command line, and\n`lovelock settings --json` prints the same list for other programs. The program writes this \
         page: `cargo xtask docs`.\n\nValues outside the range are clamped to it when a project is opened. Where a list has \
         several entries, such as lights,\nits first entry stands for all: `lights.1.intensity` is that of the second \
         light. `NAME` is the name of a joint, an\nexpression or a morph target.\n",
    );
    for (section, title) in SECTIONS {
        let _ = write!(text, "\n## {title}: `{section}`\n\n{}", settings_table(section));
    }
    text
}

/// The sections of the page, with their titles.
const SECTIONS: [(&str, &str); 14] = [
    ("body", "Body"),
    ("motion", "Motion"),
    ("hair", "Hairstyle"),
    ("look", "Look"),
    ("simulation", "Simulation"),
    ("shadow", "Shadow"),
    ("lights", "Lights"),
    ("reference", "Reference picture"),
    ("sound", "Sound"),
    ("camera", "Camera"),
    ("picture", "Picture"),
    ("recording", "Recording"),
    ("compare", "Comparison"),
    ("timeline", "Timeline"),
];

#[cfg(test)]
mod tests;
