//! Thumbnails of hairstyles: small JPEG images, those of shipped styles in the program, those of the user's own in a cache.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use lovelock_project::error::ProjectError;
use lovelock_project::files::write_whole;
use lovelock_project::styles::Style;
use lovelock_record::jpeg_within;
use lovelock_session::progress::Progress;

use super::portrait::{Portraits, Shot};

/// Width and height, pixels.
pub const SIZE: [u32; 2] = [160, 200];
/// The most bytes of a file.
pub const MAX_BYTES: usize = 12 * 1024;

/// The thumbnails in `assets/styles`, by the ids of their styles.
static SHIPPED: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/thumbnails.rs"));

/// The thumbnail of a shipped style; `None` if none has been drawn yet.
pub fn of_shipped(id: &str) -> Option<&'static [u8]> {
    SHIPPED.iter().find(|(known, _)| *known == id).map(|(_, file)| *file)
}

/// Draws a thumbnail of a style.
///
/// # Errors
/// As [`Portraits::draw`].
pub fn draw(
    portraits: &mut Portraits,
    style: &Style,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Vec<u8>, ProjectError> {
    let pictures = portraits.draw(&Portraits::project_of(style), &[Shot::Framed], progress)?;
    let picture = pictures.first();
    picture
        .and_then(|picture| jpeg_within(MAX_BYTES, picture.width, picture.height, &picture.rgba))
        .ok_or_else(|| ProjectError::work(format!("{}: its thumbnail could not be drawn", style.name)))
}

/// The folder of the thumbnails of the user's own styles; `None` where the system has no folder for caches.
pub fn cache_folder() -> Option<PathBuf> {
    Some(dirs::cache_dir()?.join("lovelock").join("styles"))
}

/// The file of a style's thumbnail in `folder`: named by the contents of the style and the version of the program, so that a changed
/// style gets a new one.
pub fn path_in(folder: &Path, style: &Style) -> PathBuf {
    let mut hasher = DefaultHasher::new();
    env!("CARGO_PKG_VERSION").hash(&mut hasher);
    // The name and the words do not change the picture.
    let bare = Style { name: String::new(), text: String::new(), tags: Vec::new(), ..style.clone() };
    bare.text_of(folder).unwrap_or_default().hash(&mut hasher);
    folder.join(format!("{:016x}.jpg", hasher.finish()))
}

/// Keeps a thumbnail at `path`, whose folder is made if need be.
///
/// # Errors
/// If the folder cannot be written or the disk is full.
pub fn keep(path: &Path, file: &[u8]) -> Result<(), ProjectError> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|error| {
            ProjectError::output(folder, format!("{}: could not be made: {error}", folder.display()))
        })?;
    }
    write_whole(path, file)
}
