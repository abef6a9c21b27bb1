//! The browser of hairstyles: a grid of pictures from which a style is applied, wholly or in part, and the user's own styles.

mod dialogs;
mod morph;
mod panel;
mod shelf;
#[cfg(test)]
mod tests;
mod tile;
mod window;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::TextureHandle;
use lovelock_jobs::presets::thumbnail;
use lovelock_project::Project;
use lovelock_project::project::HairSource;
use lovelock_project::styles::{OwnStyle, OwnStyles, Style, StyleParts, shipped};
use serde::{Deserialize, Serialize};

use super::command::Command;
use super::picker::Picker;
use super::search::{best_first, fit};
use dialogs::Dialog;
pub(crate) use panel::ui;
use shelf::Shelf;

/// What of the browser is stored between runs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Kept {
    /// The ids of the favourites.
    favourites: BTreeSet<String>,
}

/// A style that can be picked.
#[derive(Clone)]
struct Entry {
    id: String,
    style: Arc<Style>,
    /// The file of one of the user's own.
    file: Option<PathBuf>,
}

/// The tile on which the pointer rests.
#[derive(Clone, Debug)]
struct Hover {
    id: String,
    since_secs: f64,
}

/// The state of the browser.
#[derive(Clone)]
pub(crate) struct Browser {
    search: Picker,
    /// The tiles of the last pass, in the order of the grid.
    tiles: Vec<egui::Id>,
    /// Only styles with all of these are shown.
    tags: BTreeSet<String>,
    only_favourites: bool,
    /// What a click applies.
    parts: StyleParts,
    /// The style that was clicked last, until the pointer leaves it: it is not previewed again.
    clicked: Option<String>,
    hover: Option<Hover>,
    /// The style that is shown although it is not applied.
    preview: Option<String>,
    own: Option<OwnStyles>,
    shelf: Option<Arc<Shelf>>,
    entries: Vec<Entry>,
    /// Why files in the user's folder are no styles.
    broken: Vec<String>,
    pictures: BTreeMap<String, TextureHandle>,
    dialog: Option<Dialog>,
    /// Why the dialog could not do what it is for.
    dialog_error: Option<String>,
    /// The style that the grid scrolls to as soon as it is listed.
    reveal: Option<String>,
    /// What it asks the window to do, the first first.
    requests: VecDeque<Command>,
    /// What of it is stored between runs.
    pub(crate) kept: Kept,
}

impl Default for Browser {
    /// The shipped styles alone.
    fn default() -> Self {
        let mut browser = Self {
            search: Picker::default(),
            tiles: Vec::new(),
            tags: BTreeSet::new(),
            only_favourites: false,
            parts: StyleParts::ALL,
            clicked: None,
            hover: None,
            preview: None,
            own: None,
            shelf: None,
            entries: Vec::new(),
            broken: Vec::new(),
            pictures: BTreeMap::new(),
            dialog: None,
            dialog_error: None,
            reveal: None,
            requests: VecDeque::new(),
            kept: Kept::default(),
        };
        browser.list(&[]);
        browser
    }
}

impl Browser {
    /// The shipped styles and those in the user's folder, whose pictures are kept in the folder `cache`.
    pub(crate) fn new(own: Option<OwnStyles>, cache: Option<PathBuf>, ctx: &egui::Context) -> Self {
        let shelf = own.clone().and_then(|own| {
            let wake = ctx.clone();
            // Without the thread there are only the shipped styles.
            Shelf::start(own, cache, move || super::images::wake(&wake)).ok().map(Arc::new)
        });
        Self { own, shelf, ..Self::default() }
    }

    /// The shipped styles followed by the user's.
    fn list(&mut self, own: &[OwnStyle]) {
        self.entries = shipped()
            .iter()
            .map(|shipped| Entry {
                id: shipped.id.to_owned(),
                style: Arc::new(shipped.style.clone()),
                file: None,
            })
            .collect();
        self.broken.clear();
        for own in own {
            match &own.style {
                Ok(style) => {
                    let (style, file) = (Arc::new(style.clone()), Some(own.path.clone()));
                    self.entries.push(Entry { id: own.id(), style, file });
                }
                Err(why) => self.broken.push(why.clone()),
            }
        }
    }

    /// Takes what the thread of the user's styles has found.
    pub(crate) fn update(&mut self, ctx: &egui::Context) {
        let Some(shelf) = &self.shelf else { return };
        for found in shelf.found() {
            match found {
                shelf::Found::Styles(own) => {
                    // A style may have changed under its name.
                    self.pictures.retain(|id, _| !id.starts_with("own/"));
                    self.list(&own);
                }
                shelf::Found::Picture { id, size, rgba } => {
                    let pixels = egui::ColorImage::from_rgba_premultiplied(size, &rgba);
                    let texture = ctx.load_texture(&id, pixels, egui::TextureOptions::LINEAR);
                    self.pictures.insert(id, texture);
                }
            }
        }
    }

    /// Reads the user's folder again.
    pub(crate) fn refresh(&self) {
        if let Some(shelf) = &self.shelf {
            shelf.look();
        }
    }

    /// Forgets the pictures, whose textures belong to a device that is lost.
    pub(crate) fn forget_images(&mut self) {
        self.pictures.clear();
        self.refresh();
    }

    /// The folder of the user's styles, if there is one.
    pub(crate) fn own(&self) -> Option<&OwnStyles> {
        self.own.as_ref()
    }

    /// The style that is shown without being applied, and what of it.
    pub(crate) fn preview(&self) -> Option<(&str, &Style, StyleParts)> {
        let id = self.preview.as_deref()?;
        let entry = self.entries.iter().find(|entry| entry.id == id)?;
        Some((id, &entry.style, self.parts))
    }

    /// The entries that are shown: the best matches of the search come first.
    fn shown(&self) -> Vec<Entry> {
        let fits = |entry: &&Entry| {
            self.tags.iter().all(|tag| tags_of(entry).any(|own| own == tag))
                && (!self.only_favourites || self.kept.favourites.contains(&entry.id))
        };
        let found = best_first(&self.search.typed, self.entries.iter().filter(fits), |typed, entry| {
            let mut others = vec![entry.style.text.as_str()];
            others.extend(tags_of(entry));
            fit(typed, &entry.style.name, &others)
        });
        found.into_iter().cloned().collect()
    }

    /// The tags of all entries: those of most shipped styles first, then those of the user's alone. The order stays when a style is saved.
    fn all_tags(&self) -> Vec<String> {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for entry in &self.entries {
            for tag in &entry.style.tags {
                *counts.entry(tag).or_default() += usize::from(entry.file.is_none());
            }
        }
        let mut tags: Vec<_> = counts.into_iter().collect();
        tags.sort_by_key(|(tag, count)| (std::cmp::Reverse(*count), *tag));
        let own = self.own.as_ref().map(|_| OWN);
        tags.into_iter().map(|(tag, _)| tag).filter(|tag| *tag != OWN).chain(own).map(str::to_owned).collect()
    }

    /// Shows a style that was just saved: selected by the project, in sight, whatever the filters were.
    fn reveal(&mut self, id: String) {
        self.search.clear();
        self.tags.clear();
        self.only_favourites = false;
        self.reveal = Some(id);
    }

    /// The picture of a style: that of a shipped one is in the program.
    fn picture(&mut self, ctx: &egui::Context, id: &str) -> Option<TextureHandle> {
        if let Some(texture) = self.pictures.get(id) {
            return Some(texture.clone());
        }
        let [_, tall] = thumbnail::SIZE;
        let (width, height, rgba) = lovelock_record::read_jpeg(thumbnail::of_shipped(id)?, tall.max(1) * 4)?;
        let pixels = egui::ColorImage::from_rgba_premultiplied([width as usize, height as usize], &rgba);
        let texture = ctx.load_texture(id, pixels, egui::TextureOptions::LINEAR);
        self.pictures.insert(id.to_owned(), texture.clone());
        Some(texture)
    }
}

/// The tag of the user's own styles.
const OWN: &str = "own";

/// The tags of a style; one of the user's own has one more.
fn tags_of(entry: &Entry) -> impl Iterator<Item = &str> {
    let own = entry.file.as_ref().map(|_| OWN);
    entry.style.tags.iter().map(String::as_str).chain(own)
}

/// The id of the style that a project has.
fn current(project: &Project) -> Option<&str> {
    let hair = &project.hair;
    if !hair.style.is_empty() {
        return Some(&hair.style);
    }
    (hair.source == HairSource::Grown).then(|| hair.preset.id())
}

/// The name of a file, for messages.
fn short(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
