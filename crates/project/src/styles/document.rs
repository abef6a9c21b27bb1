//! A style and its text, which has the shape of a project file with fewer sections.

use std::path::Path;

use lovelock_groom::{GroomSettings, HairLook, Preset};
use lovelock_simulation::SimulationSettings;
use serde::{Deserialize, Serialize};

use super::motion;
use crate::Project;
use crate::error::{Problem, ProjectError};
use crate::files::{folder_of, write_whole};
use crate::project::{HairSection, LARGEST_BYTES, PROJECT_VERSION, parse_text, read_text, text_options};

/// The extension of files that hold a style, without the dot.
pub const STYLE_EXTENSION: &str = "lovelockstyle";

/// A hairstyle as a document of its own.
///
/// Its text is that of a project file with the sections `hair`, `look` and `simulation` alone. What is left out has its default, and a
/// project file can be read as a style too.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Style {
    /// Version of the file, [`PROJECT_VERSION`].
    pub version: u32,
    /// What it is called.
    pub name: String,
    /// One sentence that describes it.
    pub text: String,
    /// Words by which it is found, such as `short` or `curly`.
    pub tags: Vec<String>,
    /// How the hair grows, is cut and tied, and its layers.
    pub hair: HairSection,
    /// Its colours.
    pub look: HairLook,
    /// How it moves. Gravity, wind and the method of the simulation are not a style's own and are not applied.
    pub simulation: SimulationSettings,
}

/// The fields that a project does not have.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Words {
    name: String,
    text: String,
    tags: Vec<String>,
}

impl Default for Style {
    fn default() -> Self {
        Self {
            version: PROJECT_VERSION,
            name: String::new(),
            text: String::new(),
            tags: Vec::new(),
            hair: HairSection::default(),
            look: GroomSettings::preset(Preset::Smooth).look,
            simulation: SimulationSettings::default(),
        }
    }
}

impl Style {
    /// The longest name, characters.
    pub const LONGEST_NAME: usize = 80;
    /// The longest description, characters.
    pub const LONGEST_TEXT: usize = 400;
    /// The most tags.
    pub const MAX_TAGS: usize = 16;
    /// The longest tag, characters.
    pub const LONGEST_TAG: usize = 30;

    /// The style of a project, without a name.
    pub fn of_project(project: &Project) -> Self {
        let mut hair = HairSection {
            style: String::new(),
            moves: None,
            grows: None,
            style_layers: Vec::new(),
            ..project.hair.clone()
        };
        // Where the controls of colours return to.
        hair.groom.look = project.look;
        Self { hair, look: project.look, simulation: motion::own(&project.simulation), ..Self::default() }
    }

    /// Reads the text of a style, or of a project. `path` is used for messages only. Values out of range and unknown fields are
    /// problems, as in projects.
    ///
    /// # Errors
    /// Text that is not a style, with line and column, or a style of a newer version.
    pub fn parse(path: &Path, text: &str) -> Result<(Self, Vec<Problem>), ProjectError> {
        let (project, problems) = parse_text(path, text, "style", &["name", "text", "tags"])?;
        let words: Words = text_options().from_str(text).map_err(|error| {
            let name = path.display();
            ProjectError::input(
                path,
                format!("{name}: line {}: {}; must be a style", error.span.start, error.code),
            )
        })?;
        let style =
            Self { name: words.name, text: words.text, tags: words.tags, ..Self::of_project(&project) };
        Ok((style.tidied(), problems))
    }

    /// Opens the style at `path`. Paths in it are resolved against its folder. A style without a name gets that of the file.
    ///
    /// # Errors
    /// As [`Style::parse`], and if the file cannot be read or is larger than a project can be.
    pub fn load(path: &Path) -> Result<(Self, Vec<Problem>), ProjectError> {
        let (mut style, problems) = Self::parse(path, &read_text(path, "style", LARGEST_BYTES)?)?;
        let folder = folder_of(path);
        style.hair.files_mut().for_each(|file| *file = file.clone().in_memory(&folder));
        if style.name.is_empty() {
            style.name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            style = style.tidied();
        }
        Ok((style, problems))
    }

    /// The text of the style in a file at `path`.
    ///
    /// # Errors
    /// If a path is not Unicode.
    pub fn text_of(&self, path: &Path) -> Result<String, ron::Error> {
        let mut style = self.clone();
        style.version = PROJECT_VERSION;
        style.hair.files_mut().for_each(|file| *file = file.for_disk(&folder_of(path)));
        ron::ser::to_string_pretty(&style, ron::ser::PrettyConfig::new().struct_names(false).depth_limit(4))
    }

    /// Saves the style: writes beside `path`, flushes to disk, then renames.
    ///
    /// # Errors
    /// If the folder cannot be written, the disk is full, or a path is not Unicode.
    pub fn save(&self, path: &Path) -> Result<(), ProjectError> {
        let text = self.text_of(path).map_err(|error| {
            ProjectError::output(path, format!("{}: could not be written as text: {error}", path.display()))
        })?;
        write_whole(path, format!("{text}\n").as_bytes())
    }

    /// The number of strands that the style grows; `None` for one that imports a hair file.
    pub fn strands(&self) -> Option<u64> {
        let groom = &self.hair.groom;
        let grown = self.hair.source == crate::project::HairSource::Grown;
        grown.then(|| u64::from(groom.wisps) * u64::from(groom.strands_per_wisp))
    }

    /// The style with words that can be shown in one line, within their lengths.
    fn tidied(mut self) -> Self {
        let short = |text: &str, most: usize| -> String {
            text.trim().chars().filter(|c| !c.is_control()).take(most).collect()
        };
        self.name = short(&self.name, Self::LONGEST_NAME);
        self.text = short(&self.text, Self::LONGEST_TEXT);
        self.tags.truncate(Self::MAX_TAGS);
        self.tags = self.tags.iter().map(|tag| short(tag, Self::LONGEST_TAG).to_lowercase()).collect();
        self.tags.retain(|tag| !tag.is_empty());
        self
    }
}
