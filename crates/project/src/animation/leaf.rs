//! The numbers of a project by the names of their tracks.

use std::borrow::Cow;
use std::collections::HashMap;

use lovelock_base::settings::{AnySettings, Info, Kind, Value, entries, find, set_value};

use crate::project::Project;

/// Parts of the project whose numbers may follow the timeline: what is rendered or simulated without loading anything. Of the section
/// `hair` these are only the layers and the morph, see [`is_keyable`].
const SECTIONS: [&str; 7] = ["hair", "look", "simulation", "shadow", "lights", "camera", "picture"];

/// Whether the setting at a path, such as `lights.0.intensity`, may follow the timeline. Growing, importing, cutting and tying load
/// the hair again.
pub fn is_keyable(path: &str) -> bool {
    let section = path.split('.').next().unwrap_or_default();
    SECTIONS.contains(&section)
        && (section != "hair" || path.starts_with("hair.stack.") || path == "hair.morph.amount")
}

/// The path of a track's target among the project's settings: tracks divide names by slashes.
fn path_of(target: &str) -> Option<String> {
    let path = target.replace('/', ".");
    is_keyable(&path).then_some(path)
}

/// The path of a vector and the index of one of its numbers, of a target such as `lights/0/direction/1`.
fn component(path: &str) -> Option<(&str, usize)> {
    let (vector, index) = path.rsplit_once('.')?;
    Some((vector, index.parse().ok()?))
}

/// The numbers that a key holds of a value: those of the value, 0 or 1 for a switch, the place in the list for a choice. None of what
/// is left out.
pub fn key_numbers(info: &Info, value: Value) -> Vec<f64> {
    match (info.kind, value) {
        (_, Value::Switch(on)) => vec![f64::from(u8::from(on))],
        (Kind::Choice(options), Value::Choice(id)) => {
            let place = options.iter().position(|(known, _)| known == id);
            place.map(|place| place as f64).into_iter().collect()
        }
        _ => value.numbers(),
    }
}

/// The value of the same type as `value` that a key with these numbers holds.
fn value_of(info: &Info, value: Value, numbers: &[f64]) -> Option<Value> {
    match (info.kind, value, numbers) {
        (_, Value::Switch(_), [number]) => number.is_finite().then_some(Value::Switch(*number >= 0.5)),
        (Kind::Choice(options), Value::Choice(_), [number]) if number.is_finite() => {
            let (id, _) = options.iter().nth(number.round().max(0.0) as usize)?;
            Some(Value::Choice(id))
        }
        _ => value.with_numbers(numbers),
    }
}

/// Whether values of a target go from one to the next without any between them.
pub(super) fn is_held(project: &Project, target: &str) -> bool {
    let found = path_of(target).and_then(|path| Some(find(project, &path)?.1));
    matches!(found, Some(Value::Switch(_) | Value::Choice(_)))
}

/// The numbers of the project at a target.
pub(super) fn numbers_at(project: &Project, target: &str) -> Option<Vec<f64>> {
    let path = path_of(target)?;
    if let Some((info, value)) = find(project, &path) {
        return Some(key_numbers(info, value)).filter(|numbers| !numbers.is_empty());
    }
    let (vector, index) = component(&path)?;
    let number = find(project, vector)?.1.numbers().get(index).copied();
    number.map(|number| vec![number])
}

/// Sets the numbers at a path; a path that `root` lacks, and a number of values that it does not have, change nothing.
pub(super) fn set_numbers(root: &mut dyn AnySettings, path: &str, numbers: &[f64]) {
    let (mut path, mut numbers) = (path, Cow::Borrowed(numbers));
    if find(root, path).is_none()
        && let Some((vector, index)) = component(path)
        && let Some((_, value)) = find(root, vector)
        && let ([number], mut all) = (&*numbers, value.numbers())
        && let Some(slot) = all.get_mut(index)
    {
        *slot = *number;
        (path, numbers) = (vector, Cow::Owned(all));
    }
    if let Some(value) = find(root, path).and_then(|(info, value)| value_of(info, value, &numbers)) {
        set_value(root, path, value);
    }
}

/// Sets the numbers of several targets at once; those that the project lacks are left out.
pub(super) fn set_all<'a>(project: &mut Project, values: impl IntoIterator<Item = (&'a str, Vec<f64>)>) {
    for (target, numbers) in values {
        if let Some(path) = path_of(target) {
            set_numbers(project, &path, &numbers);
        }
    }
}

/// Every target whose numbers differ, with those of `after`, in the order of [`SECTIONS`] and then of names.
pub(super) fn changed(before: &Project, after: &Project) -> Vec<(String, Vec<f64>)> {
    // Asked at each pass of the interface, in most of which nothing moves.
    if !sections_differ(before, after) {
        return Vec::new();
    }
    let old: HashMap<String, Vec<f64>> =
        entries(before).into_iter().map(|entry| (entry.path, key_numbers(entry.info, entry.value))).collect();
    // A list of another length has other parts, and no number of it has moved.
    let same_lights = before.lights.len() == after.lights.len();
    let masks = |project: &Project, id: &str| {
        let layer = id.parse().ok().and_then(|id| project.hair.stack.layer(id));
        layer.map(|layer| layer.mask.parts.len())
    };
    let same_mask = |path: &str| {
        let mut names = path.split('.').skip(2);
        let (id, part) = (names.next().unwrap_or_default(), names.next().unwrap_or_default());
        !part.starts_with("mask") || masks(before, id) == masks(after, id)
    };
    let moved = entries(after).into_iter().filter_map(|entry| {
        let section = entry.path.split('.').next()?;
        let at = SECTIONS.iter().position(|name| *name == section).filter(|_| is_keyable(&entry.path))?;
        let (old, new) = (old.get(&entry.path)?, key_numbers(entry.info, entry.value));
        let finite = old.iter().chain(&new).all(|number| number.is_finite());
        let same_list = match section {
            "lights" => same_lights,
            "hair" => same_mask(&entry.path),
            _ => true,
        };
        let moved = *old != new && finite && same_list;
        moved.then(|| (at, entry.path.replace('.', "/"), new))
    });
    let mut moved: Vec<_> = moved.collect();
    moved.sort_by(|(a, name, _), (b, other, _)| a.cmp(b).then_with(|| name.split('/').cmp(other.split('/'))));
    moved.into_iter().map(|(_, target, numbers)| (target, numbers)).collect()
}

/// Whether any of [`SECTIONS`] differs.
fn sections_differ(a: &Project, b: &Project) -> bool {
    a.hair.stack != b.hair.stack
        || a.hair.morph.amount.to_bits() != b.hair.morph.amount.to_bits()
        || a.look != b.look
        || a.simulation != b.simulation
        || a.shadow != b.shadow
        || a.lights != b.lights
        || a.camera != b.camera
        || a.picture != b.picture
}
