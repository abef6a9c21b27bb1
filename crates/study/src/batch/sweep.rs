//! Sweeps of settings.

use std::str::FromStr;

use lovelock_project::error::ProjectError;
use lovelock_render::{ShadowMethod, ShadowSettings};
use serde_json::Value;

/// A setting of shadow methods, and its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sweep {
    /// The setting's name in projects.
    pub setting: String,
    /// Its values, as text.
    pub values: Vec<String>,
}

impl FromStr for Sweep {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wanted =
            || format!("`{text}` is no sweep: expected SETTING=VALUE,VALUE,… such as resolution=64,128,256");
        let (setting, values) = text.split_once('=').ok_or_else(wanted)?;
        let values: Vec<_> = values.split(',').map(|value| value.trim().to_owned()).collect();
        let setting = setting.trim().to_owned();
        if setting.is_empty() || values.iter().any(String::is_empty) {
            return Err(wanted());
        }
        Ok(Self { setting, values })
    }
}

/// The name of a method's settings in projects.
fn section(method: ShadowMethod) -> String {
    method.id().replace('-', "_")
}

/// Names and values of all settings of `method`.
pub(super) fn values(settings: &ShadowSettings, method: ShadowMethod) -> Vec<(String, String)> {
    let all = serde_json::to_value(settings).unwrap_or_default();
    let of_method = all.get(section(method));
    let known = method.settings().into_iter();
    known
        .filter_map(|info| {
            let value = of_method?.get(info.name)?;
            let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
            Some((info.name.to_owned(), text))
        })
        .collect()
}

/// `settings` with one setting of their method changed; `None` if the method has no such setting.
///
/// # Errors
/// If the value is invalid, with the valid ones.
pub(super) fn with_value(
    settings: &ShadowSettings,
    setting: &str,
    text: &str,
) -> Result<Option<ShadowSettings>, ProjectError> {
    let known = settings.method.settings();
    let Some(info) = known.iter().find(|info| info.name == setting) else { return Ok(None) };
    let wrong = || {
        ProjectError::option(format!(
            "--sweep {setting}={text}: {} takes {} (usually {})",
            settings.method, info.values, info.usual
        ))
    };
    let value: Value = serde_json::from_str(text).unwrap_or_else(|_| text.into());
    if !may_be(&info.values, &value) {
        return Err(wrong());
    }
    if let Some((below, above)) = off_step(&info.values, &value) {
        return Err(ProjectError::option(format!(
            "--sweep {setting}={text}: {} takes {}; the nearest are {below} and {above}",
            settings.method, info.values
        )));
    }
    let mut all = serde_json::to_value(settings).map_err(ProjectError::work)?;
    let place = all.get_mut(section(settings.method)).and_then(|of_method| of_method.get_mut(setting));
    *place.ok_or_else(wrong)? = value;
    serde_json::from_value(all).map(Some).map_err(|_| wrong())
}

/// Whether a number is allowed by the text `values`, such as `64 to 2048 texels` or `128, 256, 512`. Other texts are not checked
/// here but by the type of the setting.
fn may_be(values: &str, value: &Value) -> bool {
    let Some(number) = value.as_f64() else { return true };
    let choices: Result<Vec<f64>, _> = values.split(", ").map(str::parse).collect();
    if let Ok(choices) = choices {
        return choices.contains(&number);
    }
    let Some((low, rest)) = values.split_once(" to ") else { return true };
    let high = rest.split([' ', ',']).next().unwrap_or_default();
    match (low.parse::<f64>(), high.parse::<f64>()) {
        (Ok(low), Ok(high)) => (low..=high).contains(&number),
        _ => true,
    }
}

/// The multiples on both sides of a number that is not a multiple of the step in `values`, such as `64 to 2048 texels, in steps of
/// 16`. `None` if it is a multiple.
fn off_step(values: &str, value: &Value) -> Option<(u64, u64)> {
    let (_, step) = values.split_once(", in steps of ")?;
    let (number, step) = (value.as_u64()?, step.parse::<u64>().ok().filter(|step| *step > 0)?);
    let below = number - number % step;
    (below < number).then(|| (below, below.saturating_add(step)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sweeps_are_a_name_and_values() {
        let sweep: Sweep = "resolution=64, 128,256".parse().expect("a sweep");
        assert_eq!(sweep.setting, "resolution");
        assert_eq!(sweep.values, ["64", "128", "256"]);
        for wrong in ["", "resolution", "=5", "resolution=", "resolution=1,,2"] {
            assert!(wrong.parse::<Sweep>().is_err_and(|e| e.contains(wrong)), "{wrong}");
        }
    }

    #[test]
    fn every_setting_of_every_method_can_be_set_to_its_default() {
        for &method in ShadowMethod::ALL {
            let settings = ShadowSettings { method, ..ShadowSettings::default() };
            let all = values(&settings, method);
            assert_eq!(all.len(), method.settings().len(), "{method}");
            for (name, value) in all {
                let same = with_value(&settings, &name, &value).expect("its own value");
                assert_eq!(same, Some(settings), "{method} {name}={value}");
            }
        }
    }

    #[test]
    fn invalid_values_are_refused_with_the_valid_ones() {
        let of = |method| ShadowSettings { method, ..ShadowSettings::default() };
        for (method, name, value) in [
            (ShadowMethod::OccupancyMaps, "resolution", "63"),
            (ShadowMethod::OccupancyMaps, "resolution", "1e9"),
            (ShadowMethod::OccupancyMaps, "resolution", "many"),
            (ShadowMethod::OccupancyMaps, "slabs", "5"),
            (ShadowMethod::OccupancyMaps, "filter", "cubic"),
            (ShadowMethod::DeepOpacityMaps, "layers", "2.5"),
            (ShadowMethod::VoxelMap, "resolution", "-128"),
        ] {
            let error = with_value(&of(method), name, value).expect_err(value);
            let info = method.settings().into_iter().find(|info| info.name == name).expect("a setting");
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().contains(&info.values), "{error}");
        }
        for (method, value, nearest) in [
            (ShadowMethod::OccupancyMaps, "65", "64 and 80"),
            (ShadowMethod::Exact, "2047", "2032 and 2048"),
            (ShadowMethod::VoxelMap, "129", "128 and 136"),
        ] {
            let error = with_value(&of(method), "resolution", value).expect_err(value);
            assert!(error.exit_code() == 2 && error.to_string().contains(nearest), "{error}");
        }
        // Negative control: multiples of the step.
        for value in ["64", "80", "2032", "2048"] {
            assert!(
                matches!(with_value(&of(ShadowMethod::Exact), "resolution", value), Ok(Some(_))),
                "{value}"
            );
        }
        let changed = with_value(&of(ShadowMethod::OccupancyMaps), "slabs", "16").expect("a value");
        assert_eq!(changed.map(|settings| settings.occupancy_maps.slabs), Some(16));
        assert_eq!(with_value(&of(ShadowMethod::None), "slabs", "16").expect("no setting"), None);
    }
}
