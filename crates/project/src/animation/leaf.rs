//! Numbers of a project, addressed by path.

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Number, Value};

use crate::project::Project;
use crate::tracks::Track;

/// Sections whose numbers tracks may change: those that take effect without loading the scene again.
pub(super) const SECTIONS: [&str; 6] = ["look", "simulation", "shadow", "lights", "camera", "picture"];

/// The section of a target, and the path below it.
pub(super) fn section_of(target: &str) -> Option<(&'static str, &str)> {
    let (section, rest) = target.split_once('/')?;
    SECTIONS.into_iter().find(|name| *name == section).map(|name| (name, rest))
}

/// A section as a JSON tree.
pub(super) fn section(project: &Project, name: &str) -> Option<Value> {
    match name {
        "look" => tree(&project.look),
        "simulation" => tree(&project.simulation),
        "shadow" => tree(&project.shadow),
        "lights" => tree(&project.lights),
        "camera" => tree(&project.camera),
        "picture" => tree(&project.picture),
        _ => None,
    }
}

/// Writes a tree back to its section. A tree that cannot be read as the section changes nothing.
pub(super) fn set_section(project: &mut Project, name: &str, value: Value) {
    match name {
        "look" => put(&mut project.look, value),
        "simulation" => put(&mut project.simulation, value),
        "shadow" => put(&mut project.shadow, value),
        "lights" => put(&mut project.lights, value),
        "camera" => put(&mut project.camera, value),
        "picture" => put(&mut project.picture, value),
        _ => {}
    }
}

/// Whether a section differs between two projects.
pub(super) fn differs(a: &Project, b: &Project, name: &str) -> bool {
    match name {
        "look" => a.look != b.look,
        "simulation" => a.simulation != b.simulation,
        "shadow" => a.shadow != b.shadow,
        "lights" => a.lights != b.lights,
        "camera" => a.camera != b.camera,
        "picture" => a.picture != b.picture,
        _ => false,
    }
}

fn tree<T: Serialize>(part: &T) -> Option<Value> {
    serde_json::to_value(part).ok()
}

fn put<T: DeserializeOwned>(part: &mut T, value: Value) {
    if let Ok(value) = serde_json::from_value(value) {
        *part = value;
    }
}

/// The numbers at a target of a section's tree.
pub(super) fn numbers(section: &Value, names: &str) -> Option<Vec<f64>> {
    numbers_of(find(section, names)?)
}

/// Sets the numbers at a target; integers stay integers. Returns whether the target exists.
pub(super) fn set_numbers(section: &mut Value, names: &str, numbers: &[f64]) -> bool {
    let Some(leaf) = find_mut(section, names) else { return false };
    let Some(now) = numbers_of(leaf) else { return false };
    if now.len() != numbers.len() || numbers.iter().any(|v| !v.is_finite()) {
        return false;
    }
    let set = |old: &Value, new: f64| {
        if old.is_u64() {
            Value::from(new.round().max(0.0) as u64)
        } else if old.is_i64() {
            Value::from(new.round() as i64)
        } else {
            Number::from_f64(new).map_or(Value::Null, Value::Number)
        }
    };
    match leaf {
        Value::Array(items) => {
            for (item, &number) in items.iter_mut().zip(numbers) {
                *item = set(item, number);
            }
        }
        leaf => *leaf = set(leaf, numbers[0]),
    }
    true
}

fn find<'a>(tree: &'a Value, names: &str) -> Option<&'a Value> {
    names.split('/').try_fold(tree, |tree, name| match tree {
        Value::Object(map) => map.get(name),
        Value::Array(items) => items.get(name.parse::<usize>().ok()?),
        _ => None,
    })
}

fn find_mut<'a>(tree: &'a mut Value, names: &str) -> Option<&'a mut Value> {
    names.split('/').try_fold(tree, |tree, name| match tree {
        Value::Object(map) => map.get_mut(name),
        Value::Array(items) => items.get_mut(name.parse::<usize>().ok()?),
        _ => None,
    })
}

/// One number, or an array of a few.
fn numbers_of(leaf: &Value) -> Option<Vec<f64>> {
    match leaf {
        Value::Number(number) => Some(vec![number.as_f64()?]),
        Value::Array(items) if (2..=Track::MOST_NUMBERS).contains(&items.len()) => {
            items.iter().map(Value::as_f64).collect()
        }
        _ => None,
    }
}

/// Every target whose numbers differ, with the numbers of `after`.
pub(super) fn changed(before: &Project, after: &Project) -> Vec<(String, Vec<f64>)> {
    let mut out = Vec::new();
    for name in SECTIONS {
        if !differs(before, after, name) {
            continue;
        }
        if let (Some(a), Some(b)) = (section(before, name), section(after, name)) {
            collect(name, &a, &b, &mut out);
        }
    }
    out
}

fn collect(path: &str, before: &Value, after: &Value, out: &mut Vec<(String, Vec<f64>)>) {
    if let (Some(a), Some(b)) = (numbers_of(before), numbers_of(after)) {
        if a != b && a.len() == b.len() {
            out.push((path.to_owned(), b));
        }
        return;
    }
    match (before, after) {
        (Value::Object(a), Value::Object(b)) => {
            for (name, a) in a {
                if let Some(b) = b.get(name) {
                    collect(&format!("{path}/{name}"), a, b, out);
                }
            }
        }
        // Lists of different lengths have different items, so no number counts as changed.
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                collect(&format!("{path}/{i}"), a, b, out);
            }
        }
        _ => {}
    }
}

/// The numbers of the project at a target.
pub(super) fn numbers_at(project: &Project, target: &str) -> Option<Vec<f64>> {
    let (name, names) = section_of(target)?;
    numbers(&section(project, name)?, names)
}

/// Sets the numbers of several targets at once; unknown targets are ignored.
pub(super) fn set_all<'a>(project: &mut Project, values: impl IntoIterator<Item = (&'a str, Vec<f64>)>) {
    let mut trees: Vec<(&'static str, Value)> = Vec::new();
    for (target, numbers) in values {
        let Some((name, names)) = section_of(target) else { continue };
        if !trees.iter().any(|(known, _)| *known == name)
            && let Some(tree) = section(project, name)
        {
            trees.push((name, tree));
        }
        if let Some((_, tree)) = trees.iter_mut().find(|(known, _)| *known == name) {
            set_numbers(tree, names, &numbers);
        }
    }
    for (name, tree) in trees {
        set_section(project, name, tree);
    }
}
