//! A track as the project stores it.

use lovelock_style::StyleStack;
use serde::{Deserialize, Serialize};

use super::curve;

/// What targets of tracks begin with that are numbers of layers of the hairstyle.
pub const STACK_TARGET: &str = "hair/stack/";
/// The target of the amount of the morph.
pub const MORPH_TARGET: &str = "hair/morph/amount";

/// The value of a track at a time. A track is linear between keys, unless it is held, and constant before the first and after the last.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Key {
    /// Seconds from the start of the timeline.
    pub secs: f64,
    /// The numbers, as many as the target has, 1 to [`Track::MAX_NUMBERS`].
    pub value: Vec<f64>,
}

/// A number of the project that follows the timeline.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Track {
    /// The path of the number from the project down, such as `lights/0/direction`. An unknown target has no effect.
    pub target: String,
    /// Whether the project's own value is used instead of the track's.
    pub muted: bool,
    /// Whether each key's value stays until the next key, as that of a switch or a choice does.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub held: bool,
    /// The keys, in ascending order of time.
    pub keys: Vec<Key>,
}

impl Track {
    /// The most tracks of a project.
    pub const MAX: usize = 64;
    /// The most keys of a track.
    pub const MAX_KEYS: usize = 20_000;
    /// The most numbers of a key.
    pub const MAX_NUMBERS: usize = 4;
    /// The longest name of a target, characters.
    pub const LONGEST_TARGET: usize = 120;
    /// Keys closer together than this are merged, seconds.
    pub const NEAREST_SECS: f64 = 1.0 / 240.0;
    /// A key no farther from a time than this is the key at that time, seconds: half a step of the simulation.
    pub const AT_SECS: f64 = 1.0 / 120.0;

    /// A track without keys.
    pub fn new(target: impl Into<String>) -> Self {
        Self { target: target.into(), ..Self::default() }
    }

    /// The label in the interface: `Light 1 direction` for `lights/0/direction`.
    pub fn label(&self) -> String {
        let mut words = Vec::new();
        for part in self.target.split('/') {
            match part.parse::<usize>() {
                Ok(i) => words.push((i + 1).to_string()),
                Err(_) if part == "lights" => words.push("light".to_owned()),
                // "Simulation gravity" and "look root color" say no more than their last word.
                Err(_) if ["look", "simulation", "picture", "shadow"].contains(&part) => {}
                Err(_) => words.push(part.replace('_', " ")),
            }
        }
        let text = words.join(" ");
        let mut letters = text.chars();
        letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
    }

    /// The label in the interface, with the name of the layer where it is a number of one: `Curl radius` for `hair/stack/3/curl/radius`.
    pub fn label_in(&self, stack: &StyleStack) -> String {
        if self.target == MORPH_TARGET {
            return "Morph".to_owned();
        }
        let Some(below) = self.target.strip_prefix(STACK_TARGET) else { return self.label() };
        let mut parts: Vec<&str> = below.split('/').collect();
        let of = parts.remove(0);
        let layer = of.parse().ok().and_then(|id| stack.layer(id));
        let group = of.strip_prefix("group").and_then(|id| stack.group(id.parse().ok()?));
        let name = match (layer, group) {
            (Some(layer), _) => {
                // The name of the operation says no more than that of the layer.
                if parts.first() == Some(&layer.operation.id()) {
                    parts.remove(0);
                }
                layer.label().to_owned()
            }
            (None, Some(group)) => group.name.clone(),
            (None, None) => format!("Layer {of}"),
        };
        parts.iter().fold(name, |text, part| format!("{text} {}", part.replace('_', " ")))
    }

    /// Whether the track has an effect.
    pub fn is_active(&self) -> bool {
        !self.muted && !self.keys.is_empty()
    }

    /// The value at a time; `None` for a track without keys.
    pub fn value_at(&self, secs: f64) -> Option<Vec<f64>> {
        curve::value_at(&self.keys, secs, self.held)
    }

    /// The key at a time, within half a step of the simulation.
    pub fn key_at(&self, secs: f64) -> Option<&Key> {
        let off = |key: &&Key| (key.secs - secs).abs();
        // Asked for every track at each pass of the window.
        let from = self.keys.partition_point(|key| key.secs < secs - Self::AT_SECS);
        let near = self.keys.iter().skip(from).take_while(|key| key.secs <= secs + Self::AT_SECS);
        near.filter(|key| off(key) <= Self::AT_SECS).min_by(|a, b| off(a).total_cmp(&off(b)))
    }

    /// Adds a key and replaces keys closer than [`Track::NEAREST_SECS`].
    pub fn put(&mut self, secs: f64, value: Vec<f64>) {
        self.keys.retain(|key| (key.secs - secs).abs() >= Self::NEAREST_SECS);
        if self.keys.len() < Self::MAX_KEYS {
            let at = self.keys.partition_point(|key| key.secs < secs);
            self.keys.insert(at, Key { secs, value });
        }
    }

    /// Removes jitter faster than about a fifth of a second. The first and last keys stay.
    pub fn smooth(&mut self) {
        if !self.held {
            self.keys = curve::smoothed(&self.keys);
        }
    }

    /// The minimum and maximum of each number.
    pub fn range(&self) -> Vec<[f64; 2]> {
        let width = self.keys.first().map_or(0, |key| key.value.len());
        let numbers = |i: usize| self.keys.iter().filter_map(move |key| key.value.get(i).copied());
        (0..width)
            .map(|i| [numbers(i).fold(f64::INFINITY, f64::min), numbers(i).fold(f64::NEG_INFINITY, f64::max)])
            .collect()
    }

    /// The track without invalid keys; `None` if nothing is left.
    pub(crate) fn in_range(&self) -> Option<Self> {
        let width =
            self.keys.iter().map(|key| key.value.len()).find(|n| (1..=Self::MAX_NUMBERS).contains(n))?;
        let good = |key: &&Key| {
            key.secs.is_finite()
                && key.secs >= 0.0
                && key.value.len() == width
                && key.value.iter().all(|v| v.is_finite())
        };
        let mut keys: Vec<Key> = self.keys.iter().filter(good).take(Self::MAX_KEYS).cloned().collect();
        keys.sort_by(|a, b| a.secs.total_cmp(&b.secs));
        keys.dedup_by(|b, a| b.secs - a.secs < 0.5 * Self::NEAREST_SECS);
        let named = !self.target.is_empty() && self.target.chars().count() <= Self::LONGEST_TARGET;
        (named && !keys.is_empty()).then(|| Self { keys, ..self.clone() })
    }
}
