//! What a surface is made of, by the names of its material and its mesh.

use crate::Region;
use crate::words::words_of;

/// Whether the region of a material is known.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Known {
    /// The file states it.
    Stated(Region),
    /// A name tells it.
    Named(Region),
    /// Nothing does.
    No,
}

const EYE: &[&str] = &[
    "cornea", "eye", "eyeball", "eyeballs", "eyes", "iris", "irises", "pupil", "pupils", "sclera", "scleras",
];
/// Hair about the eyes, which is neither eye nor skin.
const LASH: &[&str] =
    &["brow", "brows", "eyebrow", "eyebrows", "eyelash", "eyelashes", "eyeline", "lash", "lashes"];
const CLOTH: &[&str] = &[
    "apron",
    "belt",
    "bikini",
    "blouse",
    "bodysuit",
    "boot",
    "boots",
    "bottom",
    "bottoms",
    "bra",
    "cap",
    "cape",
    "cardigan",
    "cloak",
    "cloth",
    "clothes",
    "clothing",
    "coat",
    "costume",
    "denim",
    "dress",
    "fabric",
    "garment",
    "glove",
    "gloves",
    "gown",
    "hat",
    "hoodie",
    "jacket",
    "jeans",
    "jumper",
    "kimono",
    "legging",
    "leggings",
    "leotard",
    "outfit",
    "pants",
    "robe",
    "sandals",
    "scarf",
    "shirt",
    "shoe",
    "shoes",
    "shorts",
    "skirt",
    "sleeve",
    "sleeves",
    "sneakers",
    "sock",
    "socks",
    "stocking",
    "stockings",
    "suit",
    "sweater",
    "swimsuit",
    "textile",
    "tie",
    "tights",
    "top",
    "tops",
    "trousers",
    "tshirt",
    "tutu",
    "underwear",
    "uniform",
    "vest",
];
const SKIN: &[&str] = &[
    "arm", "arms", "body", "ear", "ears", "face", "feet", "finger", "fingers", "foot", "hand", "hands",
    "head", "leg", "legs", "lip", "lips", "neck", "nose", "scalp", "skin", "torso",
];

/// The region that the first name with a word for one tells: eyes before cloth before skin.
pub(crate) fn named_region(names: &[&str]) -> Known {
    let found = names.iter().find_map(|name| {
        let words = words_of(name);
        let holds = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
        let order = [(LASH, Region::Other), (EYE, Region::Eye), (CLOTH, Region::Cloth), (SKIN, Region::Skin)];
        order.into_iter().find_map(|(list, region)| holds(list).then_some(region))
    });
    found.map_or(Known::No, Known::Named)
}

#[cfg(test)]
mod tests {
    use super::{Known, named_region};
    use crate::Region;

    #[test]
    fn regions_are_known_by_names() {
        for (name, region) in [
            ("N00_000_00_EyeIris_00_EYE (Instance)", Some(Region::Eye)),
            ("N00_000_00_FaceBrow_00_FACE", Some(Region::Other)),
            ("N00_001_01_Tops_01_CLOTH", Some(Region::Cloth)),
            ("Body_00_SKIN", Some(Region::Skin)),
            ("left eyeball", Some(Region::Eye)),
            ("Stopwatch", None),
            ("fox_material", None),
            ("", None),
        ] {
            assert!(named_region(&[name]) == region.map_or(Known::No, Known::Named), "{name}");
        }
        let first_that_tells = named_region(&["Material.001", "Dress", "Body"]);
        assert!(first_that_tells == Known::Named(Region::Cloth));
    }
}
