//! The user's own styles: files in a folder.

use std::path::{Path, PathBuf};

use super::document::{STYLE_EXTENSION, Style};
use crate::error::ProjectError;

/// The folder of the user's own styles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OwnStyles {
    folder: PathBuf,
}

/// A style in the folder, or why it cannot be read.
#[derive(Clone, Debug)]
pub struct OwnStyle {
    /// Its file.
    pub path: PathBuf,
    /// The style, named as it was saved.
    pub style: Result<Style, String>,
}

impl OwnStyle {
    /// The name of the file, by which the style is known: that of the style with what a file name cannot hold replaced.
    pub fn name(&self) -> String {
        self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Its name in projects, so that it cannot be taken for a shipped one.
    pub fn id(&self) -> String {
        own_id(&self.path)
    }
}

/// The name in projects of a style that is none of the shipped ones.
pub fn own_id(path: &Path) -> String {
    format!("own/{}", path.file_stem().unwrap_or_default().to_string_lossy())
}

impl OwnStyles {
    /// The most files that are listed.
    pub const MAX: usize = 1000;

    /// The styles in `folder`, which need not be there yet.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into() }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Every style in the folder, by name. A file that is no style is listed with the reason.
    pub fn list(&self) -> Vec<OwnStyle> {
        let Ok(entries) = std::fs::read_dir(&self.folder) else { return Vec::new() };
        let is_style = |path: &PathBuf| {
            path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(STYLE_EXTENSION))
        };
        let mut paths: Vec<PathBuf> =
            entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_style).collect();
        // By the name without the extension: a space comes before the dot.
        paths.sort_by_key(|path| path.with_extension("").to_string_lossy().to_lowercase());
        paths.truncate(Self::MAX);
        paths.into_iter().map(|path| OwnStyle { style: read(&path), path }).collect()
    }

    /// The file of the style of that name, if there is one.
    pub fn named(&self, name: &str) -> Option<PathBuf> {
        let path = self.path(&file_name(name).ok()?);
        path.exists().then_some(path)
    }

    /// Saves a style under its name; returns the file.
    ///
    /// # Errors
    /// A name that no file can have or that is in use, or a folder that cannot be written.
    pub fn save(&self, style: &Style) -> Result<PathBuf, ProjectError> {
        let path = self.path(&file_name(&style.name)?);
        if path.exists() {
            return Err(ProjectError::input(
                &path,
                format!(
                    "{}: found another style of this name; must be a name that is not in use",
                    style.name.trim()
                ),
            ));
        }
        self.write(style, &path)?;
        Ok(path)
    }

    /// Replaces the style in the file at `path` by another one.
    ///
    /// # Errors
    /// A file that is not in the folder, or a folder that cannot be written.
    pub fn replace(&self, path: &Path, style: &Style) -> Result<(), ProjectError> {
        self.check(path)?;
        self.write(style, path)
    }

    fn write(&self, style: &Style, path: &Path) -> Result<(), ProjectError> {
        std::fs::create_dir_all(&self.folder).map_err(|error| {
            let folder = self.folder.display();
            ProjectError::output(&self.folder, format!("{folder}: could not be made: {error}"))
        })?;
        style.save(path)
    }

    /// Copies a style file into the folder; returns the copy. Where its name is in use, the copy gets a number after it, in its caption
    /// too. A file that lies in the folder already stays as it is.
    ///
    /// # Errors
    /// A file that is no style, or a folder that cannot be written.
    pub fn import(&self, path: &Path) -> Result<PathBuf, ProjectError> {
        let (mut style, _) = Style::load(path)?;
        let lies_here = |folder: &Path| folder.canonicalize().ok() == self.folder.canonicalize().ok();
        if self.folder.is_dir() && path.parent().is_some_and(lies_here) {
            return Ok(path.to_owned());
        }
        let (number, copy) = self.free(&style.name)?;
        if number > 1 {
            style.name = format!("{} {number}", style.name);
        }
        self.write(&style, &copy)?;
        Ok(copy)
    }

    /// Gives a style another name, and its file too; returns the new file.
    ///
    /// # Errors
    /// As [`OwnStyles::save`], and a file that is no style or cannot be removed.
    pub fn rename(&self, path: &Path, name: &str) -> Result<PathBuf, ProjectError> {
        let (mut style, _) = Style::load(path)?;
        name.clone_into(&mut style.name);
        if file_name(name)? == path.file_stem().unwrap_or_default().to_string_lossy() {
            style.save(path)?;
            return Ok(path.to_owned());
        }
        let new = self.save(&style)?;
        self.delete(path)?;
        Ok(new)
    }

    /// Deletes a style's file.
    ///
    /// # Errors
    /// A file that is not in the folder or cannot be removed.
    pub fn delete(&self, path: &Path) -> Result<(), ProjectError> {
        self.check(path)?;
        std::fs::remove_file(path).map_err(|error| {
            ProjectError::output(path, format!("{}: could not be deleted: {error}", path.display()))
        })
    }

    /// Checks that a file is one of the user's styles.
    fn check(&self, path: &Path) -> Result<(), ProjectError> {
        if path.parent() == Some(&self.folder) {
            return Ok(());
        }
        let (name, folder) = (path.display(), self.folder.display());
        Err(ProjectError::output(path, format!("{name}: is not one of your styles, which are in {folder}")))
    }

    /// The file of the style with that file name.
    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{name}.{STYLE_EXTENSION}"))
    }

    /// A file for a style of that name that is not there yet, and its number among those of the name.
    fn free(&self, name: &str) -> Result<(u32, PathBuf), ProjectError> {
        let name = file_name(name)?;
        let path = |number: u32| {
            let path = if number < 2 { self.path(&name) } else { self.path(&format!("{name} {number}")) };
            (number, path)
        };
        (1..100_000).map(path).find(|(_, path)| !path.exists()).ok_or_else(|| {
            ProjectError::option(format!("{}: has 100,000 styles of this name", self.folder.display()))
        })
    }
}

fn read(path: &Path) -> Result<Style, String> {
    let (mut style, _) = Style::load(path).map_err(|error| error.to_string())?;
    style.hair.style = own_id(path);
    Ok(style)
}

/// A style's name as that of a file, without its ending: characters that some system forbids become `-`.
fn file_name(name: &str) -> Result<String, ProjectError> {
    let allowed = |c: char| if c.is_control() || r#"<>:"/\|?*"#.contains(c) { '-' } else { c };
    let name: String = name.trim().chars().map(allowed).take(Style::LONGEST_NAME).collect();
    let name = name.trim_matches(['.', ' ']).to_owned();
    if name.is_empty() {
        return Err(ProjectError::option("a style needs a name with a letter or a digit"));
    }
    Ok(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str) -> Style {
        Style { name: name.to_owned(), ..Style::default() }
    }

    #[test]
    fn styles_are_saved_renamed_imported_and_deleted() {
        let dir = tempfile::tempdir().expect("a folder");
        let own = OwnStyles::new(dir.path().join("not yet/styles"));
        assert!(own.list().is_empty());
        let first = own.save(&named("Mine: 1/2")).expect("saved");
        assert_eq!(first.file_name().expect("a name"), "Mine- 1-2.lovelockstyle");
        let error = own.save(&named("Mine: 1/2")).expect_err("in use");
        assert!(error.to_string().contains("Mine: 1/2: found another style"), "{error}");
        assert_eq!(own.named("Mine: 1/2"), Some(first.clone()));
        own.replace(&first, &Style { text: "new".to_owned(), ..named("Mine: 1/2") }).expect("replaced");
        let again = dir.path().join("Mine- 1-2.lovelockstyle");
        named("Mine: 1/2").save(&again).expect("saved");
        own.import(&again).expect("imported");
        let listed = own.list();
        let style = listed[0].style.as_ref().expect("a style");
        assert_eq!((listed.len(), style.name.as_str(), style.text.as_str()), (2, "Mine: 1/2", "new"));
        assert_eq!(listed[1].style.as_ref().expect("a style").name, "Mine: 1/2 2", "its caption differs");
        assert!(own.rename(&listed[1].path, "Mine: 1/2").is_err() && listed[1].path.exists());
        assert_eq!(style.hair.style, "own/Mine- 1-2");
        let renamed = own.rename(&first, "Ü").expect("renamed");
        assert!(renamed.exists() && !first.exists());
        assert_eq!(own.rename(&renamed, "Ü").expect("the same"), renamed);
        assert_eq!(own.import(&renamed).expect("there"), renamed);
        let outside = dir.path().join("friend.lovelockstyle");
        named("").save(&outside).expect("saved");
        let copy = own.import(&outside).expect("imported");
        assert!(copy.ends_with("styles/friend.lovelockstyle") && outside.exists());
        assert!(own.delete(&outside).is_err() && outside.exists(), "only its own");
        assert!(own.replace(&outside, &named("x")).is_err());
        own.delete(&copy).expect("deleted");
        assert_eq!(own.list().len(), 2);
    }

    #[test]
    fn bad_files_and_names_are_said() {
        let dir = tempfile::tempdir().expect("a folder");
        let own = OwnStyles::new(dir.path());
        let path = dir.path().join("cut.lovelockstyle");
        std::fs::write(&path, "(version: 3, hair: (").expect("a file");
        std::fs::create_dir(dir.path().join("folder.lovelockstyle")).expect("a folder");
        std::fs::write(dir.path().join("note.txt"), "no style").expect("a file");
        let listed = own.list();
        assert_eq!(listed.len(), 2);
        assert!(listed.iter().all(|own| own.style.is_err()), "{listed:?}");
        for name in ["", " . ", "\u{7}"] {
            let saved = own.save(&named(name));
            assert_eq!(saved.is_ok(), name == "\u{7}", "{name:?}");
        }
        assert!(own.import(&path).is_err() && own.rename(&path, "a").is_err() && path.exists());
    }
}
