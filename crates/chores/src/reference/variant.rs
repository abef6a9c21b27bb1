//! Ways of shading that are compared.

use anyhow::ensure;
use std::str::FromStr;

/// A name and the settings of our images.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Variant {
    /// Names a column and a folder: letters, digits, `-` and `_`.
    pub(super) name: String,
    /// `NAME=VALUE` each.
    pub(super) settings: Vec<String>,
}

impl Variant {
    /// The variants of the command line, or the shipped settings if there are none. Fails if two have the same name.
    pub(super) fn checked(given: &[Self]) -> anyhow::Result<Vec<Self>> {
        for (i, variant) in given.iter().enumerate() {
            let twice = given[..i].iter().any(|other| other.name == variant.name);
            ensure!(!twice, "--variant: found two with the name {}; must be different", variant.name);
        }
        if given.is_empty() {
            return Ok(vec![Self { name: "shipped".to_owned(), settings: Vec::new() }]);
        }
        Ok(given.to_vec())
    }
}

impl FromStr for Variant {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, settings) = text.split_once(':').unwrap_or((text, ""));
        let name = name.trim();
        let usual = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
        if name.is_empty() || !name.chars().all(usual) {
            return Err(format!("found the name `{name}`; must have letters, digits, - and _ alone"));
        }
        let settings: Vec<String> = settings.split_whitespace().map(str::to_owned).collect();
        match settings.iter().find(|setting| !setting.contains('=')) {
            Some(wrong) => Err(format!("{name}: found `{wrong}`; must be SETTING=VALUE")),
            None => Ok(Self { name: name.to_owned(), settings }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variant_is_a_name_and_settings() {
        let variant: Variant =
            "dull: look.roughness=0.6  look.primary_strength=0".parse().expect("a variant");
        assert_eq!(variant.name, "dull");
        assert_eq!(variant.settings, ["look.roughness=0.6", "look.primary_strength=0"]);
        assert_eq!("today".parse::<Variant>().map(|variant| variant.settings), Ok(vec![]));
        for (wrong, named) in [(": a=1", "name"), ("../up", "../up"), ("dull: roughness", "roughness")] {
            let error = wrong.parse::<Variant>().unwrap_err();
            assert!(error.contains(named) && error.contains("must"), "{error}");
        }
        assert!(Variant::checked(&[variant.clone(), variant]).unwrap_err().to_string().contains("dull"));
        assert_eq!(Variant::checked(&[]).expect("one").len(), 1);
    }
}
