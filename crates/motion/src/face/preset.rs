//! The presets of VRM 1.0 by the names that other formats and programs use.

/// Names for each preset, in small letters without signs.
const PRESETS: [(&str, &[&str]); 18] = [
    ("happy", &["happy", "joy", "smile", "笑い", "喜び", "にこり"]),
    ("angry", &["angry", "怒り"]),
    ("sad", &["sad", "sorrow", "悲しい", "困る"]),
    ("relaxed", &["relaxed", "fun", "なごみ"]),
    ("surprised", &["surprised", "びっくり"]),
    ("aa", &["aa", "a", "visemeaa", "vrcvaa", "mtha", "jawopen", "mouthopen", "あ"]),
    ("ih", &["ih", "i", "visemei", "visemeih", "vrcvih", "mthi", "い"]),
    ("ou", &["ou", "u", "visemeu", "visemeou", "vrcvou", "mthu", "う"]),
    ("ee", &["ee", "e", "visemee", "vrcve", "mthe", "え"]),
    ("oh", &["oh", "o", "visemeo", "visemeoh", "vrcvoh", "mtho", "お"]),
    ("blink", &["blink", "eyeclose", "eyesclosed", "vrcblink", "まばたき"]),
    ("blinkLeft", &["blinkleft", "blinkl", "eyeblinkleft", "winkleft", "ウィンク", "ウィンク2"]),
    (
        "blinkRight",
        &["blinkright", "blinkr", "eyeblinkright", "winkright", "ウィンク右", "ウィンク2右", "ｳｨﾝｸ2右"],
    ),
    ("lookUp", &["lookup"]),
    ("lookDown", &["lookdown"]),
    ("lookLeft", &["lookleft"]),
    ("lookRight", &["lookright"]),
    ("neutral", &["neutral", "真面目"]),
];

/// The preset that a name of VRM, `MikuMikuDance` or another program says.
pub(crate) fn preset_of(name: &str) -> Option<&'static str> {
    // `fcl_` stands before all names of a widespread program.
    let name = name.strip_prefix("Fcl_").or(name.strip_prefix("fcl_")).unwrap_or(name);
    let plain: String = name
        .chars()
        .filter(|c| c.is_alphanumeric())
        .flat_map(char::to_lowercase)
        .map(|c| if c == '２' { '2' } else { c })
        .collect();
    PRESETS.iter().find(|(_, names)| names.contains(&plain.as_str())).map(|(preset, _)| *preset)
}

#[cfg(test)]
mod tests {
    use super::{PRESETS, preset_of};

    #[test]
    fn presets_are_known_by_the_names_of_several_programs() {
        for (name, preset) in [
            ("まばたき", Some("blink")),
            ("あ", Some("aa")),
            ("ウィンク２", Some("blinkLeft")),
            ("blink_l", Some("blinkLeft")),
            ("Fcl_MTH_A", Some("aa")),
            ("eyeBlinkRight", Some("blinkRight")),
            ("Joy", Some("happy")),
            ("unknown", None),
            ("", None),
        ] {
            assert_eq!(preset_of(name), preset, "{name}");
        }
        for (preset, names) in PRESETS {
            assert_eq!(preset_of(preset), Some(preset));
            assert!(names.iter().all(|name| preset_of(name) == Some(preset)), "{preset}");
        }
    }
}
