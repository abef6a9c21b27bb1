//! Copies the files of a project into the job's folder.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use lovelock_motion::gltf_reference;
use lovelock_project::Project;
use lovelock_project::error::{Place, ProjectError};
use lovelock_project::files::FileRef;
use lovelock_session::progress::{Progress, report_progress};

/// Maximum size of a text glTF that is searched for referenced files.
const LONGEST_GLTF: u64 = 256 << 20;

/// Copies every file that the project uses into subfolders of `folder`, and makes the project refer to the copies. Returns their
/// names and sizes.
pub(super) fn copy(
    project: &mut Project,
    folder: &Path,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Vec<(String, u64)>, ProjectError> {
    let files: Vec<(Place, PathBuf)> =
        project.files().into_iter().map(|(place, file)| (place, file.path.clone())).collect();
    let mut copied = Vec::new();
    for (place, path) in files {
        report_progress(progress, Progress::Loading { what: format!("copying {}", path.display()) })?;
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
            Place::Sound => project.sound.file = file,
            Place::Surroundings => project.surroundings.file = file,
            Place::Backdrop => project.surroundings.backdrop = file,
            _ => project.hair.file = file,
        }
    }
    // Remove unused references, which other machines could not resolve.
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

fn copy_one(from: &Path, to: &Path, folder: &Path) -> Result<(String, u64), ProjectError> {
    let made = to.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::copy(from, to));
    let bytes = made.map_err(|error| {
        ProjectError::output(from, format!("{}: could not be copied: {error}", from.display()))
    })?;
    let name = to.strip_prefix(folder).unwrap_or(to);
    Ok((name.to_string_lossy().replace(std::path::MAIN_SEPARATOR, "/"), bytes))
}

/// Buffer files referenced by a text glTF, if they lie in its folder or below.
fn files_of_gltf(path: &Path) -> Vec<PathBuf> {
    let is_text = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gltf"));
    if !is_text || fs::metadata(path).map_or(true, |data| data.len() > LONGEST_GLTF) {
        return Vec::new();
    }
    let text = fs::read(path).unwrap_or_default();
    let json: serde_json::Value = serde_json::from_slice(&text).unwrap_or_default();
    let buffers = json["buffers"].as_array().map_or(&[][..], Vec::as_slice);
    let named = buffers.iter().filter_map(|buffer| buffer["uri"].as_str());
    named.filter_map(gltf_reference).filter(|path| !path.as_os_str().is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_a_gltf_names_are_found_by_encoded_names_and_go_along() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let names = ["香 1.bin", "a#b%.bin", "plain.bin", "deep/one.bin"];
        fs::create_dir(at("deep")).expect("a folder");
        for name in names {
            fs::write(at(name), name).expect("a file");
        }
        let uris =
            ["%E9%A6%99%201.bin", "a%23b%25.bin", "./plain.bin", "deep/one.bin", "data:,x", "../outside.bin"];
        let buffers: Vec<_> =
            uris.iter().map(|uri| serde_json::json!({ "uri": uri, "byteLength": 1 })).collect();
        let text = serde_json::json!({ "asset": { "version": "2.0" }, "buffers": buffers });
        fs::write(at("body.gltf"), text.to_string()).expect("a file");
        assert_eq!(files_of_gltf(&at("body.gltf")), names.map(PathBuf::from));

        let mut project = Project::default();
        project.set_body_file(at("body.gltf"));
        let to = at("job");
        let copied = copy(&mut project, &to, &mut |_| ControlFlow::Continue(())).expect("copies");
        assert_eq!(copied.len(), 5, "{copied:?}");
        for name in names {
            assert_eq!(fs::read_to_string(to.join("assets/body").join(name)).expect(name), name);
        }
    }
}
