//! The files of a project, copied beside it.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Component, Path, PathBuf};

use crate::headless::tell;
use crate::{FileRef, Place, Progress, Project, StudioError};

/// The longest glTF as text that is looked into for the files that it names.
const LONGEST_GLTF: u64 = 256 << 20;

/// Copies every file that the project uses into folders of `folder`, and makes the project name the copies. Returns
/// their names and bytes.
pub(super) fn copy(
    project: &mut Project,
    folder: &Path,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Vec<(String, u64)>, StudioError> {
    let files: Vec<(Place, PathBuf)> =
        project.files().into_iter().map(|(place, file)| (place, file.path.clone())).collect();
    let mut copied = Vec::new();
    for (place, path) in files {
        tell(progress, Progress::Loading { what: format!("copying {}", path.display()) })?;
        let role = place.label();
        let name = path.file_name().unwrap_or_default();
        let to = folder.join("assets").join(role).join(name);
        copied.push(copy_one(&path, &to, folder)?);
        for beside in files_of_gltf(&path) {
            let (from, to) = (path.with_file_name("").join(&beside), to.with_file_name("").join(&beside));
            if from.is_file() {
                copied.push(copy_one(&from, &to, folder)?);
            }
        }
        let file = Some(FileRef::new(to));
        match place {
            Place::Body => project.body.file = file,
            Place::Motion => project.motion.file = file,
            _ => project.hair.file = file,
        }
    }
    // Those that are named and not used would be asked for on the other machines.
    if !project.files().iter().any(|(place, _)| *place == Place::Body) {
        project.body.file = None;
    }
    if !project.files().iter().any(|(place, _)| *place == Place::Motion) {
        project.motion.file = None;
    }
    if !project.files().iter().any(|(place, _)| *place == Place::Hair) {
        project.hair.file = None;
    }
    Ok(copied)
}

fn copy_one(from: &Path, to: &Path, folder: &Path) -> Result<(String, u64), StudioError> {
    let made = to.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::copy(from, to));
    let bytes = made.map_err(|error| {
        StudioError::output(from, format!("{}: could not be copied: {error}", from.display()))
    })?;
    let name = to.strip_prefix(folder).unwrap_or(to);
    Ok((name.to_string_lossy().replace(std::path::MAIN_SEPARATOR, "/"), bytes))
}

/// Files that a glTF as text names for its buffers, as far as they lie in its folder or below.
fn files_of_gltf(path: &Path) -> Vec<PathBuf> {
    let is_text = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gltf"));
    if !is_text || fs::metadata(path).map_or(true, |data| data.len() > LONGEST_GLTF) {
        return Vec::new();
    }
    let text = fs::read(path).unwrap_or_default();
    let json: serde_json::Value = serde_json::from_slice(&text).unwrap_or_default();
    let buffers = json["buffers"].as_array().map_or(&[][..], Vec::as_slice);
    let named = buffers.iter().filter_map(|buffer| buffer["uri"].as_str());
    let plain =
        named.filter(|uri| !uri.starts_with("data:")).map(|uri| PathBuf::from(uri.replace("%20", " ")));
    plain.filter(|path| path.components().all(|part| matches!(part, Component::Normal(_)))).collect()
}
