//! The hair that a character was made with.

use crate::words::words_of;
use crate::{BodySettings, OwnHair};

/// Decides which parts of a character are its own hair, by the names of nodes, meshes and materials: other hair grows in its place.
pub(crate) struct WornHair {
    setting: OwnHair,
    /// Of each part the first of its names that says hair.
    parts: Vec<Option<String>>,
}

impl WornHair {
    pub(crate) fn new(settings: BodySettings) -> Self {
        Self { setting: settings.own_hair, parts: Vec::new() }
    }

    /// Adds a part by its names.
    pub(crate) fn offer(&mut self, names: &[&str]) {
        self.parts.push(names.iter().find(|name| names_hair(name)).map(|&name| name.to_owned()));
    }

    /// Adds a part that is known to be hair for another reason than its name.
    pub(crate) fn offer_hair(&mut self, name: &str) {
        self.parts.push(Some(name.to_owned()));
    }

    /// For each part whether it is left out. Nothing is if that would leave no part, or if the hair shall be shown.
    pub(crate) fn decide(self, notes: &mut Vec<String>) -> Vec<bool> {
        let hair: Vec<bool> = self.parts.iter().map(Option::is_some).collect();
        if !hair.contains(&true) || !hair.contains(&false) || self.setting == OwnHair::Shown {
            return vec![false; hair.len()];
        }
        let mut names: Vec<String> = Vec::new();
        for name in self.parts.into_iter().flatten() {
            let name = format!("`{name}`");
            if !names.contains(&name) {
                names.push(name);
            }
        }
        notes.push(format!("left out, because it is hair: {}", names.join(", ")));
        hair
    }
}

/// Whether a name says hair, in English by one of its words. Brows and lashes are
/// no hair of the head.
pub(crate) fn names_hair(name: &str) -> bool {
    const HAIR: [&str; 8] = ["hair", "hairs", "hairback", "wig", "ponytail", "hairstyle", "haircut", "bangs"];
    const OTHER: [&str; 8] =
        ["brow", "brows", "eyebrow", "eyebrows", "lash", "lashes", "eyelash", "eyelashes"];
    const JAPANESE: [char; 2] = ['\u{9aea}', '\u{9aee}'];
    if name.contains(JAPANESE) {
        return true;
    }
    let words = words_of(name);
    let holds = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
    holds(&HAIR) && !holds(&OTHER)
}

#[cfg(test)]
mod tests {
    use super::names_hair;

    #[test]
    fn hair_is_known_by_its_name() {
        for name in [
            "Hair",
            "hair_01",
            "Mesh.Hair",
            "LongHair",
            "FemaleWig2",
            "head-hair",
            "N00_000_Hair_00_HAIR",
            "前髪",
        ] {
            assert!(names_hair(name), "{name}");
        }
        for name in ["Chair", "Body", "Hairy", "wiggle", "Hair_Eyebrow", "N00_000_00_FaceBrow_00_FACE", ""] {
            assert!(!names_hair(name), "{name}");
        }
    }
}
