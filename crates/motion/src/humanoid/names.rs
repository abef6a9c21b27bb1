//! Parsing of joint names: side, numbers, and body part.

mod japanese;
mod prefix;

/// Left or right from the figure's own view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Side {
    /// Toward +X in a rest pose that faces +Z.
    Left,
    /// Toward -X.
    Right,
}

impl Side {
    pub(crate) const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// +1 for the left, toward +X.
    pub(crate) fn sign(self) -> f32 {
        if self == Self::Left { 1.0 } else { -1.0 }
    }
}

/// A body part as named; some words stand for one of two parts, depending on the other joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Part {
    Hips,
    Neck,
    Head,
    Clavicle,
    /// The collar bone (Mixamo, Rokoko) or the upper arm (CMU).
    Shoulder,
    UpperArm,
    Forearm,
    /// What is below the wrist, or the wrist.
    Hand,
    Wrist,
    Thigh,
    /// The shin if the thigh has a name of its own, otherwise the thigh.
    Leg,
    Shin,
    /// What is below the ankle, or the ankle.
    Foot,
    Ankle,
    /// The ankle if it carries the foot or the toes, otherwise a helper.
    Heel,
    Toe,
    /// A joint of the trunk; rigs that number it from the hips to the head name no head.
    Spine,
}

/// A parsed name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Label {
    pub(crate) part: Part,
    pub(crate) side: Option<Side>,
    /// Numbers in the name: `upperleg02` comes after `upperleg01`.
    pub(crate) numbers: Vec<u32>,
    /// Whether it is a helper that rigs put beside the real joint, such as `__UpLeg_L`.
    pub(crate) helper: bool,
}

/// Words without meaning for the part.
const NOISE: [&str; 24] = [
    "mixamorig",
    "bip",
    "biped",
    "valve",
    "valvebiped",
    "def",
    "org",
    "cc",
    "base",
    "joint",
    "jnt",
    "bone",
    "j",
    "b",
    "c",
    "sk",
    "skel",
    "skeleton",
    "rig",
    "bn",
    "human",
    "character",
    // The middle (Advanced Skeleton) and the upper of two joints of a limb (Daz).
    "m",
    "bend",
];

/// Words of joints that carry no limb.
const OTHERS: [&str; 42] = [
    "end",
    "nub",
    "tip",
    "ik",
    "pole",
    "target",
    "twist",
    "roll",
    "helper",
    "dummy",
    "socket",
    "breast",
    "finger",
    "thumb",
    "index",
    "middle",
    "ring",
    "pinky",
    "little",
    "metacarpal",
    "metatarsal",
    "eye",
    "jaw",
    "tongue",
    "hair",
    "ear",
    "tail",
    "skirt",
    "effector",
    "site",
    "prop",
    "top",
    "in",
    "fingers",
    // Controls of Rigify.
    "fk",
    "tweak",
    "parent",
    "mch",
    "vis",
    "ctrl",
    "control",
    "pivot",
];

/// Parses a name; `None` if it names no limb, hips, neck or head.
pub(crate) fn label(name: &str) -> Option<Label> {
    let local = local(name);
    label_of(local, tokens(local))
}

/// Parses the names of a skeleton. Words that most of them begin with are left out.
pub(crate) fn labels_of(names: &[&str]) -> Vec<Option<Label>> {
    let words: Vec<Vec<String>> = names.iter().map(|name| tokens(local(name))).collect();
    let has_meaning = |word: &str| {
        side_word(word).is_some()
            || OTHERS.contains(&word)
            || part(word, true).or_else(|| part(word, false)).is_some()
            || ["upper", "lower", "up", "lo", "low", "fore"].contains(&word)
    };
    let prefix = prefix::common(&words, has_meaning);
    let labels = names.iter().zip(words).map(|(name, words)| {
        let rest = words.strip_prefix(prefix.as_slice()).filter(|rest| !rest.is_empty());
        label_of(local(name), rest.map_or_else(|| words.clone(), <[String]>::to_vec))
    });
    labels.collect()
}

/// The side that a name states, whatever else it means.
pub(crate) fn side_of(name: &str) -> Option<Side> {
    let local = local(name);
    tokens(local).iter().find_map(|word| side_word(word)).or_else(|| japanese::side(local))
}

/// A name without namespaces.
fn local(name: &str) -> &str {
    name.rsplit([':', '|']).next().unwrap_or(name)
}

fn side_word(word: &str) -> Option<Side> {
    match word {
        "l" | "left" | "lft" | "lt" => Some(Side::Left),
        "r" | "right" | "rgt" | "rt" => Some(Side::Right),
        _ => None,
    }
}

fn label_of(local: &str, tokens: Vec<String>) -> Option<Label> {
    if let Some(label) = japanese::label(local) {
        return Some(label);
    }
    let (mut side, mut numbers, mut words) = (None, Vec::new(), Vec::new());
    for token in tokens {
        if let Ok(number) = token.parse::<u32>() {
            numbers.push(number);
            continue;
        }
        if let Some(found) = side_word(&token) {
            side = Some(found);
            continue;
        }
        match token.as_str() {
            noise if NOISE.contains(&noise) => {}
            other if OTHERS.contains(&other) => return None,
            _ => words.push(token),
        }
    }
    let mut word = words.concat();
    if part(&word, side.is_some()).is_none() && side.is_none() {
        // `leftarm`, `lhand`: a side joined to the word.
        for (prefix, s) in
            [("left", Side::Left), ("right", Side::Right), ("l", Side::Left), ("r", Side::Right)]
        {
            if let Some(rest) = word.strip_prefix(prefix).filter(|rest| part(rest, true).is_some()) {
                side = Some(s);
                word = rest.to_owned();
                break;
            }
        }
    }
    let part = part(&word, side.is_some())?;
    let helper = local.starts_with("__") || local.starts_with("ORG");
    Some(Label { part, side, numbers, helper })
}

/// Whether the joint distributes a limb's roll, such as `forearm_twist_l` or `lThighTwist`.
pub(crate) fn is_twist(name: &str) -> bool {
    tokens(name).iter().any(|t| t == "twist" || t == "roll")
}

fn part(word: &str, sided: bool) -> Option<Part> {
    Some(match (word, sided) {
        ("hips" | "hip" | "pelvis" | "cog" | "hipscenter", false) => Part::Hips,
        ("spine", false) => Part::Spine,
        ("neck" | "lowerneck" | "upperneck" | "necklower" | "neckupper", false) => Part::Neck,
        ("head" | "skull", false) => Part::Head,
        ("clavicle" | "clav" | "collar" | "collarbone" | "scapula", true) => Part::Clavicle,
        ("shoulder" | "shldr", true) => Part::Shoulder,
        ("upperarm" | "uparm" | "arm" | "armupper" | "bicep" | "uarm" | "humerus", true) => Part::UpperArm,
        ("forearm" | "lowerarm" | "loarm" | "lowarm" | "armlower" | "elbow" | "farm" | "radius", true) => {
            Part::Forearm
        }
        ("hand", true) => Part::Hand,
        ("wrist", true) => Part::Wrist,
        ("thigh" | "upleg" | "upperleg" | "legupper" | "femur" | "hip", true) => Part::Thigh,
        ("leg", true) => Part::Leg,
        ("shin" | "calf" | "knee" | "lowerleg" | "loleg" | "lowleg" | "leglower" | "tibia", true) => {
            Part::Shin
        }
        ("foot", true) => Part::Foot,
        ("ankle", true) => Part::Ankle,
        ("heel", true) => Part::Heel,
        ("toe" | "toes" | "toebase" | "ball", true) => Part::Toe,
        _ => return None,
    })
}

/// Lower-case words and numbers of a name, split at punctuation, at digits and at changes of case
/// (`LHipJoint` becomes `l hip joint`).
fn tokens(name: &str) -> Vec<String> {
    let chars: Vec<char> = name.chars().take(200).collect();
    let mut tokens = vec![String::new()];
    for (i, &c) in chars.iter().enumerate() {
        let before = i.checked_sub(1).map(|k| chars[k]);
        let after = chars.get(i + 1).copied();
        let starts = before.is_some_and(|b| {
            b.is_ascii_digit() != c.is_ascii_digit()
                || c.is_uppercase() && (b.is_lowercase() || after.is_some_and(char::is_lowercase))
        });
        if starts || !c.is_alphanumeric() {
            tokens.push(String::new());
        }
        if c.is_alphanumeric()
            && let Some(token) = tokens.last_mut()
        {
            token.extend(c.to_lowercase());
        }
    }
    tokens.retain(|t| !t.is_empty());
    tokens
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_many_rigs() {
        use Part::*;
        let (l, r) = (Some(Side::Left), Some(Side::Right));
        for (name, part, side) in [
            ("hips", Hips, None),
            ("mixamorig:Hips", Hips, None),
            ("mixamorig:LeftUpLeg", Thigh, l),
            ("mixamorig1:RightForeArm", Forearm, r),
            ("Bip001 L Thigh", Thigh, l),
            ("Bip01_R_Calf", Shin, r),
            ("J_Bip_L_UpperArm", UpperArm, l),
            ("upper_arm_l", UpperArm, l),
            ("DEF-shin.R", Shin, r),
            ("LHipJoint", Thigh, l),
            ("lhand", Hand, l),
            ("LeftShoulder", Shoulder, l),
            ("UpArm_L", UpperArm, l),
            ("LoLeg_R", Shin, r),
            ("lowerarm01.L", Forearm, l),
            ("wrist.R", Wrist, r),
            ("LeftToeBase", Toe, l),
            ("MIXAMORIG:LEFTTOEBASE", Toe, l),
            ("mixamorig:rightforearm", Forearm, r),
            ("L_Heel", Heel, l),
            ("b_Head_05", Head, None),
            ("Head", Head, None),
            ("lowerneck", Neck, None),
            ("foot_r", Foot, r),
            ("CC_Base_L_Foot", Foot, l),
            ("lThighBend", Thigh, l),
            ("Scapula_R", Clavicle, r),
            ("DEF-spine.006", Spine, None),
            ("左ひざ", Shin, l),
            ("足首.R", Foot, r),
        ] {
            let found = label(name).unwrap_or_else(|| panic!("{name}"));
            assert_eq!((found.part, found.side), (part, side), "{name}");
        }
        for name in [
            "HeadTop_End",
            "LeftHandThumb1",
            "lowerback",
            "pelvis.L",
            "root",
            "finger1-1.L",
            "node 3",
            "",
            "eye.L",
            "thigh_ik.L",
            "upper_arm_fk.R",
            "左足ＩＫ",
            "左腕捩",
        ] {
            assert_eq!(label(name), None, "{name}");
        }
    }
}
