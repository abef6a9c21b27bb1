//! Sweeps of settings.

use std::str::FromStr;

use lovelock_base::settings::{Info, Value};
use lovelock_project::error::ProjectError;
use lovelock_render::{ShadowMethod, ShadowSettings};

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
            || format!("found `{text}`; must be SETTING=VALUE,VALUE,… such as resolution=64,128,256");
        let (setting, values) = text.split_once('=').ok_or_else(wanted)?;
        let values: Vec<_> = values.split(',').map(|value| value.trim().to_owned()).collect();
        let setting = setting.trim().to_owned();
        if setting.is_empty() || values.iter().any(String::is_empty) {
            return Err(wanted());
        }
        Ok(Self { setting, values })
    }
}

/// Name and value of every setting of `method` alone.
pub(super) fn values(settings: &ShadowSettings, method: ShadowMethod) -> Vec<(String, String)> {
    let Some(of_method) = settings.of_method(method) else { return Vec::new() };
    let known = of_method.infos().into_iter().filter_map(|info| of_method.value(info.name));
    known.map(|(info, value)| (info.name.to_owned(), text(info, value))).collect()
}

/// Whether `method` has a setting of that name.
pub(super) fn has_setting(method: ShadowMethod, name: &str) -> bool {
    ShadowSettings::default().of_method(method).is_some_and(|settings| settings.value(name).is_some())
}

/// The value as reports hold it: numbers as JSON writes them.
fn text(info: &Info, value: Value) -> String {
    match value {
        Value::Number(number) => serde_json::Value::from(number).to_string(),
        other => info.format(other),
    }
}

/// `settings` with one setting of their method changed; `None` if the method has no such setting.
///
/// # Errors
/// A value that the setting does not take, with those that it does.
pub(super) fn with_value(
    settings: &ShadowSettings,
    setting: &str,
    text: &str,
) -> Result<Option<ShadowSettings>, ProjectError> {
    let method = settings.method;
    let Some((info, _)) = settings.of_method(method).and_then(|settings| settings.value(setting)) else {
        return Ok(None);
    };
    let value = info.parse(text).map_err(|valid| {
        ProjectError::option(format!("--sweep {setting}: found {text} for {method}; must be {valid}"))
    })?;
    let mut changed = *settings;
    if let Some(settings) = changed.of_method_mut(method) {
        settings.assign(setting, value);
    }
    Ok(Some(changed))
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
            assert_eq!(all.len(), settings.of_method(method).map_or(0, |own| own.infos().len()), "{method}");
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
            let settings = of(method);
            let (info, _) = settings.of_method(method).and_then(|own| own.value(name)).expect("a setting");
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().contains(&info.values()), "{error}");
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
