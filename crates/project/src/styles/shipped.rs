//! The styles that are part of the program.
//!
//! A new one is a file `styles/ID.lovelockstyle` of this crate and a line of `FILES`.

use std::path::Path;
use std::sync::LazyLock;

use lovelock_base::settings::edits;
use lovelock_groom::Preset;

use super::document::Style;
use crate::error::ProjectError;
use crate::project::HairSection;

/// A style that is part of the program.
#[derive(Clone, Debug)]
pub struct Shipped {
    /// Its name on the command line and in projects.
    pub id: &'static str,
    /// The style.
    pub style: Style,
}

/// What the presets of `groom` are, in words.
const PRESETS: [(Preset, &str, &str, &[&str]); 5] = [
    (Preset::Smooth, "Smooth bob", "Smooth brown hair to the shoulders.", &["medium", "straight", "loose"]),
    (Preset::Curly, "Red curls", "Red curls to the shoulders.", &["medium", "curly", "loose"]),
    (Preset::Long, "Golden waves", "Golden waves far past the shoulders.", &["long", "wavy", "loose"]),
    (Preset::Ponytail, "Ponytail", "Dark hair, combed back into a high tie.", &["long", "straight", "tied"]),
    (Preset::Bun, "Bun", "Dark blond hair, wound up on top of the head.", &["long", "straight", "tied"]),
];

/// A style in a file of this crate.
macro_rules! file {
    ($id:literal) => {
        ($id, include_str!(concat!("../../styles/", $id, ".lovelockstyle")))
    };
}

/// The styles in files, in the order of menus.
pub(super) const FILES: &[(&str, &str)] = &[
    file!("pixie"),
    file!("buzz"),
    file!("bob"),
    file!("lob-fringe"),
    file!("long-straight"),
    file!("long-waves"),
    file!("beach-waves"),
    file!("tight-curls"),
    file!("coils"),
    file!("afro"),
    file!("undercut"),
    file!("side-part"),
    file!("dreadlocks"),
    file!("mohawk"),
    file!("pigtails"),
    file!("two-braids"),
    file!("long-braid"),
    file!("box-braids"),
];

/// Every shipped style, in the order of menus: those of `groom`, then those in files.
pub fn shipped() -> &'static [Shipped] {
    &SHIPPED
}

static SHIPPED: LazyLock<Vec<Shipped>> = LazyLock::new(|| {
    let presets = PRESETS.iter().map(|(preset, name, text, tags)| Shipped {
        id: preset.id(),
        style: Style {
            name: (*name).to_owned(),
            text: (*text).to_owned(),
            tags: tags.iter().map(|tag| (*tag).to_owned()).collect(),
            ..Style::of_preset(*preset)
        },
    });
    let files = FILES.iter().filter_map(|(id, text)| {
        // A test opens each of them.
        let (mut style, _) = Style::parse(Path::new(id), text).ok()?;
        (*id).clone_into(&mut style.hair.style);
        Some(Shipped { id, style })
    });
    presets.chain(files).collect()
});

/// The shipped style with that id.
pub fn by_id(id: &str) -> Option<&'static Shipped> {
    shipped().iter().find(|style| style.id == id)
}

/// The error for a name that no shipped style has: names the nearest one.
pub fn unknown_style(id: &str) -> ProjectError {
    let id: String = id.chars().filter(|c| !c.is_control()).take(HairSection::LONGEST_STYLE).collect();
    let nearest = shipped().iter().map(|style| style.id).min_by_key(|known| edits(&id, known));
    ProjectError::option(format!(
        "--preset: there is no hairstyle `{id}`; the nearest is `{}`, and `lovelock presets` lists all",
        nearest.unwrap_or_default()
    ))
}
