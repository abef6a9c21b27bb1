use std::collections::BTreeMap;

use lovelock_base::settings::{Kind, Settings, Value, entries, find};
use lovelock_groom::{GroomSettings, HairTie, Preset};
use serde_json::Value as Json;

use super::{Assignment, all_settings, settings_page};
use crate::project::Project;

/// Numbers, switches and choices of a project file, by their paths.
fn leaves(path: &str, tree: &Json, out: &mut BTreeMap<String, Json>) {
    let join = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
    match tree {
        Json::Object(fields) => fields.iter().for_each(|(name, field)| leaves(&join(name), field, out)),
        Json::Array(items) if items.iter().all(Json::is_number) && !items.is_empty() => {
            out.insert(path.to_owned(), tree.clone());
        }
        Json::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| leaves(&join(&i.to_string()), item, out));
        }
        _ => {
            out.insert(path.to_owned(), tree.clone());
        }
    }
}

/// Parts of a file that are not settings: names, files, what was drawn and cut, and the look inside a groom, which is not used.
const NO_SETTINGS: [&str; 19] = [
    "version",
    "hair.groom.look.",
    "hair.cut.",
    "hair.moves",
    "hair.grows",
    "hair.style_layers",
    // A whole style.
    "hair.morph.to",
    "hair.style",
    "timeline.markers",
    "timeline.tracks",
    "motion.clip",
    "body.head_joint",
    // Painted over directions.
    "body.scalp.added",
    "body.scalp.removed",
    "surroundings.backdrop",
    ".file",
    ".name",
    ".take",
    "recording.output",
];

#[test]
fn every_number_switch_and_choice_of_a_file_is_a_setting_of_the_same_name() {
    let mut project = Project::default();
    project.hair.ties = vec![HairTie::default()];
    project.body.colliders.shapes.insert("neck".to_owned(), lovelock_motion::ColliderEdit::default());
    let mut file = BTreeMap::new();
    leaves("", &serde_json::to_value(&project).expect("plain data"), &mut file);
    file.retain(|path, _| {
        !NO_SETTINGS.iter().any(|no| path.starts_with(no) || (no.starts_with('.') && path.ends_with(no)))
    });
    let settings: BTreeMap<String, Value> =
        entries(&project).into_iter().map(|entry| (entry.path, entry.value)).collect();
    assert_eq!(file.keys().collect::<Vec<_>>(), settings.keys().collect::<Vec<_>>());
    for (path, json) in file {
        let same = match settings[&path] {
            Value::Number(v) => json.as_f64() == Some(v),
            Value::Count(v) => json.as_u64() == Some(v),
            Value::Switch(v) => json.as_bool() == Some(v),
            Value::Choice(id) => json.as_str() == Some(id),
            Value::Vector(v) => json == serde_json::json!(v),
            Value::None => json.is_null(),
        };
        assert!(same, "{path}: {json} in the file, {:?} by the table", settings[&path]);
    }
}

#[test]
fn choices_are_those_that_files_hold() {
    let project = Project::default();
    for entry in entries(&project) {
        let Kind::Choice(options) = entry.info.kind else { continue };
        for (id, label) in options.iter().filter(|(id, _)| *id != "Custom") {
            let mut tree = serde_json::to_value(&project).expect("plain data");
            let pointer = format!("/{}", entry.path.replace('.', "/"));
            *tree.pointer_mut(&pointer).expect("a leaf") = id.into();
            let read: Project =
                serde_json::from_value(tree).unwrap_or_else(|e| panic!("{} {id}: {e}", entry.path));
            assert_eq!(find(&read, &entry.path).map(|(_, value)| value), Some(Value::Choice(id)));
            assert!(!label.is_empty());
        }
    }
}

#[test]
fn defaults_lie_in_their_ranges_and_shipped_styles_too() {
    let project = Project::default();
    assert_eq!(project.clamped(), project);
    for entry in all_settings() {
        assert_eq!(entry.info.clamp(entry.value, Value::None), entry.value, "{}", entry.path);
        let read = entry.info.parse(&entry.info.format(entry.value));
        let same = match (read, entry.value) {
            (Ok(Value::Number(read)), Value::Number(value)) => read as f32 == value as f32,
            (read, value) => read == Ok(value),
        };
        assert!(same, "{}: {:?}", entry.path, entry.value);
    }
    for preset in Preset::ALL {
        assert_eq!(GroomSettings::preset(preset).clamped(), GroomSettings::preset(preset), "{preset:?}");
    }
}

#[test]
fn labels_are_short_and_no_two_of_a_panel_are_the_same() {
    let mut seen = BTreeMap::new();
    for entry in all_settings() {
        let section = entry.path.rsplit_once('.').map_or("", |(section, _)| section).to_owned();
        // The settings of wind and repulsion share a panel with the rest of the simulation.
        let panel = if section.starts_with("simulation") { "simulation".to_owned() } else { section };
        let label = entry.info.label;
        assert!((2..=19).contains(&label.chars().count()), "{}: {label}", entry.path);
        assert!(label.split(' ').count() <= 3, "{}: {label}", entry.path);
        assert!(entry.info.text.ends_with('.'), "{}: {}", entry.path, entry.info.text);
        assert_eq!(seen.insert((panel, label), entry.path.clone()), None, "{}: {label}", entry.path);
    }
    assert!(settings_page().contains("| `wind.speed` | Wind speed | 0 to 30 m/s | 0 |"));
}

#[test]
fn settings_are_set_by_path() {
    let mut project = Project::default();
    project.set("simulation.wind.speed", "3").expect("a speed");
    project.set("lights.1.enabled", "off").expect("a switch");
    project.set("shadow.method", "exact").expect("a method");
    project.set("lights.0.kind", "spot").expect("a kind");
    project.set("lights.0.position", "0.5, 2, -1").expect("a place");
    assert!(project.lights[0].stands());
    assert_eq!(project.lights[0].position.to_array(), [0.5, 2.0, -1.0]);
    let error = project.set("lights.0.kind", "candle").expect_err("no such kind").to_string();
    assert!(error.contains("directional, spot, point"), "{error}");
    assert_eq!(project.simulation.wind.speed, 3.0);
    assert!(!project.lights[1].enabled);
    assert_eq!(project.setting("shadow.method").map(|(_, value)| value), Some(Value::Choice("exact")));
    // A hairstyle brings its colours, as in the window.
    project.set("hair.preset", "curly").expect("a hairstyle");
    assert_eq!(project.look, GroomSettings::preset(Preset::Curly).look);
    let before = project.clone();
    let error = project.set("simulation.wind.spead", "3").expect_err("no such setting").to_string();
    assert!(error.contains("simulation.wind.speed"), "{error}");
    assert!(project.set("simulation.wind.speed", "fast").is_err());
    assert_eq!(project, before, "what is wrong changes nothing");
}

#[test]
fn settings_are_assigned_and_those_that_a_take_has_recorded_are_refused() {
    let set = |name: &str, value: &str| [Assignment { name: name.to_owned(), value: value.to_owned() }];
    let mut project = Project::default();
    project.assign(&set("simulation.wind.speed", "3")).expect("a setting");
    assert_eq!(project.simulation.wind.speed, 3.0);
    let unknown = project.assign(&set("simulation.wind.sped", "3")).expect_err("no setting");
    assert!(unknown.to_string().starts_with("--set simulation.wind.sped"), "{unknown}");
    project.set_take("/a/dance.take");
    project.assign(&set("picture.exposure_stops", "1")).expect("the image is drawn anew");
    let recorded = project.assign(&set("simulation.wind.speed", "4")).expect_err("the hair was recorded");
    assert!(recorded.to_string().contains("a take plays as recorded"), "{recorded}");
}

#[test]
fn weights_of_a_face_are_set_by_any_name_and_kept_in_files() {
    let mut project = Project::default();
    project.set("body.face.まばたき.weight", "0.5").expect("a weight");
    project.set("body.face.jaw.open.weight", "9").expect_err("out of range");
    assert_eq!((project.body.face.of("まばたき"), project.body.face.0.len()), (0.5, 1));
    let path = std::path::Path::new("/a/b.lovelock");
    let text = crate::project::text_of_project(path, &project).expect("text");
    let plain = crate::project::text_of_project(path, &Project::default()).expect("text");
    assert_ne!(text, plain);
    // What does not change is not kept.
    project.body.face.set("まばたき", 0.0);
    assert_eq!(project.body, Project::default().body);
}
