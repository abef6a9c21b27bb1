//! `lovelock presets`: the hairstyles that are shipped and the user's own, as a list, as a contact sheet and as thumbnails.

mod portrait;
mod sheet;
pub mod thumbnail;

use std::path::{Path, PathBuf};

use lovelock_project::error::ProjectError;
use lovelock_project::styles::{OwnStyles, STYLE_EXTENSION, Style, own_id, shipped, unknown_style};
use serde::Serialize;

pub use portrait::{Portraits, Shot};
pub use sheet::{SheetRequest, SheetRows, sheet};

/// A hairstyle by its name on the command line.
#[derive(Clone, Debug)]
pub struct Listed {
    /// Its name: that of a shipped one, or `own/NAME`.
    pub id: String,
    /// The style.
    pub style: Style,
    /// The file of a style that is not shipped.
    pub file: Option<PathBuf>,
}

/// The folder of the user's own styles; `None` where the system has no folder for data.
pub fn own_styles() -> Option<OwnStyles> {
    Some(OwnStyles::new(dirs::data_dir()?.join("lovelock").join("styles")))
}

/// Every hairstyle, the shipped ones first, and a sentence for each file of the user's that is none.
pub fn every_style() -> (Vec<Listed>, Vec<String>) {
    let mut listed: Vec<Listed> = shipped().iter().map(of_shipped).collect();
    let mut problems = Vec::new();
    for own in own_styles().map_or_else(Vec::new, |own| own.list()) {
        let id = own.id();
        match own.style {
            Ok(style) => listed.push(Listed { id, style, file: Some(own.path) }),
            Err(why) => problems.push(why),
        }
    }
    (listed, problems)
}

fn of_shipped(shipped: &shipped::Shipped) -> Listed {
    Listed { id: shipped.id.to_owned(), style: shipped.style.clone(), file: None }
}

/// The hairstyle that `--preset` names: by the id of a shipped one, by the name of one of the user's, or by the path of a file.
///
/// # Errors
/// A file that is no style, or a name that no style has, with the nearest.
pub fn style_named(name: &str) -> Result<Listed, ProjectError> {
    if let Some(shipped) = shipped::by_id(name) {
        return Ok(of_shipped(shipped));
    }
    let path = Path::new(name);
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(STYLE_EXTENSION)) {
        return style_in(path);
    }
    let own = own_styles().map_or_else(Vec::new, |own| own.list());
    let is_it = |id: &str, style: &Style| id == name || style.name.eq_ignore_ascii_case(name);
    let found = own.into_iter().find_map(|own| {
        let id = own.id();
        let style = own.style.ok()?;
        is_it(&id, &style).then_some(Listed { id, style, file: Some(own.path) })
    });
    found.ok_or_else(|| unknown_style(name))
}

/// The hairstyle in a file.
///
/// # Errors
/// A file that cannot be read or is no style.
pub fn style_in(path: &Path) -> Result<Listed, ProjectError> {
    let (mut style, _) = Style::load(path)?;
    let id = own_id(path);
    style.hair.style.clone_from(&id);
    Ok(Listed { id, style, file: Some(path.to_owned()) })
}

/// What `lovelock presets --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PresetsReport {
    /// The hairstyles.
    pub presets: Vec<PresetRow>,
    /// The contact sheet that was drawn, if any.
    pub sheet: Option<String>,
    /// A sentence for each file of the user's that is no style.
    pub notes: Vec<String>,
}

/// A hairstyle in the list.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PresetRow {
    /// Its name for `--preset`.
    pub id: String,
    /// Its name in the window.
    pub label: String,
    /// One sentence that describes it.
    pub text: String,
    /// Words by which it is found.
    pub tags: Vec<String>,
    /// The number of strands; `null` if they come from a hair file.
    pub strands: Option<u64>,
    /// The number of segments of all strands; `null` if they come from a hair file.
    pub segments: Option<u64>,
    /// The number of layers.
    pub layers: usize,
    /// The file of a style that is not shipped.
    pub file: Option<String>,
    /// A picture of it as a file, if there is one.
    pub thumbnail: Option<String>,
}

impl PresetRow {
    /// The row of a style whose picture is in the file `thumbnail`.
    pub fn new(listed: &Listed, thumbnail: Option<&Path>) -> Self {
        let style = &listed.style;
        let strands = style.strands();
        Self {
            id: listed.id.clone(),
            label: style.name.clone(),
            text: style.text.clone(),
            tags: style.tags.clone(),
            strands,
            segments: strands.map(|count| count * u64::from(style.hair.groom.segments_per_strand)),
            layers: style.hair.stack.layers.len(),
            file: listed.file.as_ref().map(|path| path.display().to_string()),
            thumbnail: thumbnail.map(|path| path.display().to_string()),
        }
    }
}

impl PresetsReport {
    /// The list for people: a line per style, and the notes.
    pub fn to_text(&self) -> String {
        let wide = |of: fn(&PresetRow) -> &str| self.presets.iter().map(|row| of(row).chars().count()).max();
        let id = wide(|row| &row.id).unwrap_or(0);
        let label = wide(|row| &row.label).unwrap_or(0);
        let line = |row: &PresetRow| {
            let strands = row.strands.map_or_else(|| "-".to_owned(), |count| count.to_string());
            format!("{:id$}  {:label$}  {strands:>7} strands  {}\n", row.id, row.label, row.tags.join(", "))
        };
        let mut text: String = self.presets.iter().map(line).collect();
        text.extend(self.notes.iter().map(|note| format!("{note}\n")));
        text
    }
}

#[cfg(test)]
mod tests;
