//! The standard names of joints of `MikuMikuDance`.

use super::{Label, Part, Side};

/// Parses a standard name such as `左ひざ`, or `ひざ.L` as Blender writes it.
pub(super) fn label(name: &str) -> Option<Label> {
    let (side, rest) = side_of(name);
    // Legs are moved by joints with inverse kinematics, and newer models have copies with this letter, which carry the surface.
    let (rest, is_copy) = rest.strip_suffix(['D', 'Ｄ']).map_or((rest, false), |rest| (rest, true));
    let part = match (rest, side.is_some()) {
        ("頭", false) => Part::Head,
        ("首", false) => Part::Neck,
        ("上半身" | "上半身2" | "上半身２" | "上半身3", false) => Part::Spine,
        ("下半身", false) => Part::Hips,
        ("肩", true) => Part::Shoulder,
        ("腕", true) => Part::UpperArm,
        ("ひじ" | "肘", true) => Part::Forearm,
        ("手首", true) => Part::Hand,
        ("足", true) => Part::Thigh,
        ("ひざ" | "膝", true) => Part::Shin,
        ("足首", true) => Part::Foot,
        ("つま先" | "足先EX", true) => Part::Toe,
        _ => return None,
    };
    let is_copy = is_copy || rest == "足先EX";
    Some(Label { part, side, numbers: vec![u32::from(!is_copy)], helper: false })
}

/// The side that a name states.
pub(super) fn side(name: &str) -> Option<Side> {
    side_of(name).0
}

/// The side, and the name without it.
fn side_of(name: &str) -> (Option<Side>, &str) {
    let ends = |ends: [&str; 3]| ends.into_iter().find_map(|end| name.strip_suffix(end));
    let of = |side: Side, begin: &str, end: [&str; 3]| {
        name.strip_prefix(begin).or_else(|| ends(end)).map(|rest| (Some(side), rest))
    };
    of(Side::Left, "左", [".L", "_L", ".l"])
        .or_else(|| of(Side::Right, "右", [".R", "_R", ".r"]))
        .unwrap_or((None, name))
}
