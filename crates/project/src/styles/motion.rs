//! Which settings of the simulation are a style's own, and how they follow the style.

use lovelock_simulation::SimulationSettings;
use serde_json::{Map, Value};

/// The settings of the world and of the method, which no style changes.
pub(super) const WORLD: [&str; 6] =
    ["gravity", "wind", "substeps", "integrator", "relaxation_sweeps", "follow_damping"];

/// The settings with those of the world and of the method at their defaults.
pub(super) fn own(settings: &SimulationSettings) -> SimulationSettings {
    replaced(&SimulationSettings::default(), |_, _| true, settings)
}

/// The settings `now` with all that is a style's own of `style`.
pub(super) fn of_style(now: &SimulationSettings, style: &SimulationSettings) -> SimulationSettings {
    replaced(now, |_, _| true, style)
}

/// The settings `now`, changed from the style `from` to the style `to` where nobody has chosen them: stiffness, damping, hold and
/// settling as [`SimulationSettings::restyled`] does, and each other setting where it has the value of `from` or the default.
pub(super) fn follow(
    now: &SimulationSettings,
    from: &SimulationSettings,
    to: &SimulationSettings,
) -> SimulationSettings {
    let restyled = now.restyled(from, to);
    let unchosen = [tree(from), tree(&SimulationSettings::default())];
    let follows = |name: &str, value: &Value| {
        !RESTYLED.contains(&name) && unchosen.iter().any(|tree| tree.get(name) == Some(value))
    };
    replaced(&restyled, follows, to)
}

/// The settings that [`SimulationSettings::restyled`] changes together.
const RESTYLED: [&str; 6] =
    ["stiffness_root", "stiffness_tip", "stiffness_bias", "bend_damping", "hold", "settle"];

/// The settings `now` with the values of `from` where `which` says so of a name and its value in `now`, but those of the world.
fn replaced(
    now: &SimulationSettings,
    which: impl Fn(&str, &Value) -> bool,
    from: &SimulationSettings,
) -> SimulationSettings {
    let mut out = tree(now);
    for (name, value) in tree(from) {
        if !WORLD.contains(&name.as_str()) && out.get(&name).is_some_and(|now| which(&name, now)) {
            out.insert(name, value);
        }
    }
    // Values that no text can hold, such as NaN, leave all as it is.
    serde_json::from_value(Value::Object(out)).unwrap_or(*now)
}

fn tree(settings: &SimulationSettings) -> Map<String, Value> {
    match serde_json::to_value(settings) {
        Ok(Value::Object(tree)) => tree,
        _ => Map::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_names_are_those_of_settings() {
        let tree = tree(&SimulationSettings::default());
        for name in WORLD.iter().chain(&RESTYLED) {
            assert!(tree.contains_key(*name), "{name}");
        }
        let from = SimulationSettings::default();
        let mut to = from;
        (to.stiffness_root, to.stiffness_tip, to.stiffness_bias) = (1.0, 1.0, 0.25);
        (to.bend_damping, to.hold, to.settle) = (0.5, 0.5, 0.5);
        assert_eq!(from.restyled(&from, &to), to, "these six and no other");
    }

    #[test]
    fn settings_follow_unless_chosen_and_the_world_stays() {
        let default = SimulationSettings::default();
        let heavy = SimulationSettings { weight: 2.0, drag: 0.3, gravity: 1.0, hold: 30.0, ..default };
        let moon = SimulationSettings { gravity: 1.6, ..default };
        let followed = follow(&moon, &default, &heavy);
        assert_eq!(followed, SimulationSettings { gravity: 1.6, ..heavy });
        assert_eq!(follow(&followed, &heavy, &default), moon, "and back");
        let chosen = SimulationSettings { weight: 1.5, ..moon };
        assert_eq!(follow(&chosen, &default, &heavy), SimulationSettings { weight: 1.5, ..followed });
        assert_eq!(of_style(&chosen, &heavy), followed);
        let broken = SimulationSettings { weight: f32::NAN, ..default };
        assert_eq!(follow(&default, &default, &broken).drag, default.drag);
    }
}
