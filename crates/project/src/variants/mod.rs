//! Variants of a hairstyle: its numbers changed by chance, and two styles mixed.
//!
//! A variant differs from its project only in the hairstyle and its colours. Chance is drawn per path, so a lock on one number does not
//! change what happens to the others.

use std::collections::BTreeSet;

use lovelock_base::random::SplitMix64;
use lovelock_base::settings::{AnySettings, Entry, Info, Kind, Range, Value, entries, set_value};
use lovelock_style::Subject;
use serde::{Deserialize, Serialize};

use crate::project::{HairSource, Project};

/// How likely a number is to change.
const CHANGED: f32 = 0.6;
/// Standard deviation of a change at full amount, as a part of the range of the slider.
const SPREAD: f64 = 0.22;
/// The same for numbers whose factors count, in powers of e.
const FACTOR: f64 = 0.4;

/// Numbers that vary and are locked together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Family {
    /// Lengths, layers and fringe.
    Cut,
    /// Parting, direction, volume and ends.
    Line,
    /// Locks, curls, waves and frizz.
    Texture,
    /// Layers of shape and of strands.
    Layers,
    /// Colours, and layers of colour.
    Colour,
}

impl Family {
    /// Every family, in the order of the interface.
    pub const ALL: [Self; 5] = [Self::Cut, Self::Line, Self::Texture, Self::Layers, Self::Colour];

    /// Its name in the interface.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Cut => "Cut",
            Self::Line => "Line",
            Self::Texture => "Texture",
            Self::Layers => "Layers",
            Self::Colour => "Colour",
        }
    }

    /// What belongs to it.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Cut => "Length, layers and fringe.",
            Self::Line => "Parting, direction of combing, volume and ends.",
            Self::Texture => "Locks, curls, waves and frizz.",
            Self::Layers => "Weights and values of the layers of shape and strands.",
            Self::Colour => "Pigments, dye, grey and highlights, and layers of colour.",
        }
    }
}

/// What stays as it is in every variant.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Locks {
    /// Whole families.
    pub families: BTreeSet<Family>,
    /// Single settings, by their paths.
    pub paths: BTreeSet<String>,
}

/// The most locked paths that are kept.
const MAX_LOCKS: usize = 512;

impl Locks {
    /// Whether a number stays.
    pub fn holds(&self, family: Family, path: &str) -> bool {
        self.families.contains(&family) || self.paths.contains(path)
    }

    /// Without more paths than [`Locks`] keep.
    #[must_use]
    pub fn clamped(mut self) -> Self {
        while self.paths.len() > MAX_LOCKS {
            self.paths.pop_last();
        }
        self
    }
}

/// Every number of a project that variants change, with its family, in the order of panels.
pub fn varied(project: &Project) -> Vec<(Family, Entry)> {
    let of = |entry: Entry| Some((family_of(project, &entry)?, entry));
    let hair = entries(&project.hair)
        .into_iter()
        .map(|entry| Entry { path: format!("hair.{}", entry.path), ..entry });
    let look = entries(&project.look)
        .into_iter()
        .map(|entry| Entry { path: format!("look.{}", entry.path), ..entry });
    hair.chain(look).filter_map(of).collect()
}

/// A variant of `project`. `amount` is 0 for the same style and 1 for a far one; each `seed` gives another.
#[must_use]
pub fn vary(project: &Project, seed: u32, amount: f32, locks: &Locks) -> Project {
    let amount = if amount.is_finite() { amount.clamp(0.0, 1.0) } else { 0.0 };
    let mut out = project.clone();
    for (family, entry) in varied(project) {
        let mut random = SplitMix64::of_stream(seed, hash(&entry.path));
        if locks.holds(family, &entry.path) || random.unit() >= CHANGED {
            continue;
        }
        let mut next = || f64::from(random.bell() * amount);
        let value = match (entry.info.kind, entry.value) {
            (Kind::Number(range), Value::Number(v)) => Value::Number(changed(&range, v, next())),
            (Kind::Color, Value::Vector(v)) => {
                Value::Vector(v.map(|channel| (f64::from(channel) * (FACTOR * next()).exp()).min(4.0) as f32))
            }
            _ => continue,
        };
        set_value(&mut out, &entry.path, value);
    }
    out.hair.clamp();
    out.look.clamp();
    out
}

/// A child of two variants: each number is that of one of them or between both. What only one of them has stays with the first.
#[must_use]
pub fn breed(a: &Project, b: &Project, seed: u32) -> Project {
    let mut out = a.clone();
    let others: std::collections::HashMap<String, Value> =
        varied(b).into_iter().map(|(_, entry)| (entry.path, entry.value)).collect();
    for (_, entry) in varied(a) {
        let Some(other) = others.get(&entry.path) else { continue };
        let mut random = SplitMix64::of_stream(seed, hash(&entry.path));
        let part = match random.unit() {
            u if u < 0.35 => 0.0,
            u if u < 0.7 => 1.0,
            _ => f64::from(random.unit()),
        };
        set_value(&mut out, &entry.path, entry.value.between(other, part));
    }
    out.hair.clamp();
    out.look.clamp();
    out
}

/// Gives a project the hairstyle and the colours of a variant.
pub fn adopt(project: &mut Project, variant: &Project) {
    project.hair = variant.hair.clone();
    project.look = variant.look;
}

/// A number changed by `by` standard deviations.
fn changed(range: &Range, value: f64, by: f64) -> f64 {
    let [low, high] = range.soft;
    if range.logarithmic || (low > 0.0 && value > 0.0) {
        // Lengths and sizes: a factor.
        return (value * (FACTOR * by).exp()).clamp(low.min(value), high.max(value));
    }
    (value + SPREAD * by * (high - low)).clamp(low.min(value), high.max(value))
}

/// The family of a setting; none if variants leave it.
fn family_of(project: &Project, entry: &Entry) -> Option<Family> {
    let is_number =
        matches!((entry.info.kind, entry.value), (Kind::Number(_), Value::Number(_)) | (Kind::Color, _));
    if !is_number {
        return None;
    }
    if let Some(name) = entry.path.strip_prefix("hair.groom.") {
        // A file's own hair has none of these.
        return (project.hair.source == HairSource::Grown).then(|| family_of_groom(name)).flatten();
    }
    if let Some(name) = entry.path.strip_prefix("look.") {
        let colours = [
            "eumelanin",
            "pheomelanin",
            "grey",
            "dye",
            "dye_amount",
            "highlights",
            "highlight_lightening",
            "variation",
            "tip_lightening",
        ];
        return colours.contains(&name).then_some(Family::Colour);
    }
    let (id, rest) = entry.path.strip_prefix("hair.stack.")?.split_once('.')?;
    let layer = project.hair.stack.layer(id.parse().ok()?)?;
    let kind = layer.operation.known()?.kind();
    let is_own = rest == "weight" || rest.split_once('.').is_some_and(|(part, _)| part == kind.id);
    match kind.subject {
        _ if !is_own => None,
        Subject::Shape | Subject::Strands => Some(Family::Layers),
        Subject::Colour => Some(Family::Colour),
        Subject::Motion => None,
    }
}

fn family_of_groom(name: &str) -> Option<Family> {
    match name {
        "length" | "layering" | "length_variation" | "face_framing" | "fringe" | "fringe_length" => {
            Some(Family::Cut)
        }
        "part_position" | "part_strength" | "sweep" | "volume" | "crown_volume" | "root_lift" | "hold"
        | "ends" => Some(Family::Line),
        "clump" | "locks" | "frizz" | "frizz_scale" | "strays" | "stray_reach" | "curl_radius"
        | "curl_pitch" | "curl_onset" | "curl_wander" | "wave" | "wave_length" | "taper" => {
            Some(Family::Texture)
        }
        _ => None,
    }
}

/// The label of a number for lists: with the name of its layer.
pub fn label_of(project: &Project, entry: &Entry) -> String {
    let Info { label, .. } = entry.info;
    let layer = entry.path.strip_prefix("hair.stack.").and_then(|rest| rest.split_once('.'));
    let layer = layer.and_then(|(id, _)| project.hair.stack.layer(id.parse().ok()?));
    layer.map_or_else(|| (*label).to_owned(), |layer| format!("{}: {label}", layer.label()))
}

/// FNV-1a (Fowler, Noll, Vo), 64 bits: the same for a path on every machine.
fn hash(text: &str) -> u64 {
    text.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

#[cfg(test)]
mod tests;
