//! Images in the folder of a file.

use std::collections::HashMap;
use std::io::Read as _;
use std::path::{Component, Path, PathBuf};

/// Largest file of an image, bytes.
const LIMIT: u64 = 256 << 20;
/// Most bytes of the files of all images of a figure.
const TOTAL: u64 = 1 << 30;

/// The images in the folder of a file. Each is read once, whatever the names by which the file refers to it.
pub(crate) struct Folder<'a> {
    at: Option<&'a Path>,
    /// How many more bytes may be read.
    left: u64,
    /// The number of the image of each path.
    known: HashMap<PathBuf, usize>,
}

impl<'a> Folder<'a> {
    pub(crate) fn new(folder: Option<&'a Path>) -> Self {
        Self { at: folder, left: TOTAL, known: HashMap::new() }
    }

    /// The number of the image that a file refers to by some names; see [`beside`]. `add` gives one to the bytes of an image that is
    /// met for the first time, or to the reason why there are none.
    pub(crate) fn image(
        &mut self,
        names: &[&str],
        add: impl FnOnce(Result<Vec<u8>, String>) -> usize,
    ) -> usize {
        let place = match beside(self.at, names) {
            Ok(place) => place,
            Err(problem) => return add(Err(problem)),
        };
        if let Some(&known) = self.known.get(&place) {
            return known;
        }
        let bytes = read(&place, self.left);
        self.left = self.left.saturating_sub(bytes.as_ref().map_or(0, |bytes| bytes.len() as u64));
        let number = add(bytes);
        self.known.insert(place, number);
        number
    }
}

/// The bytes of a file, if these are at most `left`.
fn read(place: &Path, left: u64) -> Result<Vec<u8>, String> {
    let limit = LIMIT.min(left);
    let mut bytes = Vec::new();
    let file = std::fs::File::open(place).map_err(|error| format!("cannot be read: {error}"))?;
    file.take(limit + 1).read_to_end(&mut bytes).map_err(|error| format!("cannot be read: {error}"))?;
    if bytes.len() as u64 <= limit {
        return Ok(bytes);
    }
    Err(if limit < LIMIT {
        format!("and the images before it have more than {TOTAL} bytes")
    } else {
        format!("has more than {LIMIT} bytes")
    })
}

/// The real path of the image that a file refers to by some names, which may be those of another computer: its place within the folder,
/// otherwise a file with its name in the folder or in a folder of textures there. Nothing outside of the folder is read, also not through
/// links.
///
/// # Errors
/// Why there is none, as the end of a sentence.
fn beside(folder: Option<&Path>, names: &[&str]) -> Result<PathBuf, String> {
    const FOLDERS: [&str; 7] = ["", "textures", "Textures", "texture", "tex", "images", "maps"];
    let folder = folder.ok_or("is outside of the file")?;
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let root = folder.canonicalize().map_err(|error| format!("cannot be read: {error}"))?;
    let mut places: Vec<PathBuf> = Vec::new();
    for name in names.iter().filter(|name| !name.is_empty()) {
        let name = name.replace('\\', "/");
        places.extend(within(&name));
        let plain = name.rsplit('/').next().and_then(within);
        places.extend(plain.iter().flat_map(|plain| FOLDERS.map(|folder| Path::new(folder).join(plain))));
    }
    for place in places {
        let Ok(real) = root.join(&place).canonicalize() else { continue };
        if !real.starts_with(&root) || !real.is_file() {
            continue;
        }
        return Ok(real);
    }
    Err("is not in the folder of the file".to_owned())
}

/// A relative path that does not lead upward.
fn within(name: &str) -> Option<PathBuf> {
    if name.is_empty() || name.contains([':', '\0']) {
        return None;
    }
    let path = Path::new(name);
    path.components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
        .then(|| path.to_owned())
}

#[cfg(test)]
mod tests {
    use super::{Folder, beside, read as bytes_of};

    #[test]
    fn images_are_found_in_the_folder_and_nowhere_else() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("inner");
        std::fs::create_dir_all(inner.join("textures")).unwrap();
        std::fs::write(folder.path().join("outside.png"), b"secret").unwrap();
        std::fs::write(inner.join("textures/skin.png"), b"skin").unwrap();
        let read = |name: &str| beside(Some(&inner), &[name]).and_then(|place| bytes_of(&place, 4));
        assert_eq!(read("textures/skin.png").unwrap(), b"skin");
        assert_eq!(read("C:\\work\\maps\\skin.png").unwrap(), b"skin");
        assert_eq!(read("/home/x/skin.png").unwrap(), b"skin");
        for outside in ["../outside.png", "outside.png", "/etc/passwd", "", ".."] {
            assert!(read(outside).is_err(), "{outside}");
        }
        assert!(beside(None, &["textures/skin.png"]).is_err());
        // One image has one number; beyond the limit of all images none is read.
        let mut images = Folder::new(Some(&inner));
        images.left = 6;
        std::fs::write(inner.join("face.png"), b"face").unwrap();
        let first = images.image(&["textures/skin.png"], |bytes| bytes.unwrap().len());
        assert_eq!((first, images.image(&["C:\\skin.png"], |_| 9), images.left), (4, 4, 2));
        let second = images.image(&["face.png"], |bytes| {
            assert!(bytes.unwrap_err().contains("before it"));
            7
        });
        assert_eq!((second, images.left), (7, 2));
    }
}
