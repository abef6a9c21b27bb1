//! Hashes of everything that the pixels of a sequence depend on, stored in its manifest, so that a sequence is only resumed with
//! the same inputs.

use std::path::PathBuf;

use lovelock_project::Project;
use lovelock_project::error::{Place, ProjectError};
use lovelock_project::files::Access;
use lovelock_record::TakeAsset;
use serde_json::{Map, Value};

/// Parts of a project that do not affect images, or have their own entries in the manifest.
const BESIDE: [&str; 6] = ["version", "recording", "compare", "reference", "sound", "take"];

/// A hash of each part of the project, by name. `with_panes` includes the panes.
///
/// # Errors
/// If the project cannot be serialised.
pub(super) fn of_project(project: &Project, with_panes: bool) -> Result<Value, ProjectError> {
    let mut project = project.clone();
    // Ignore paths, because a moved folder contains the same project; the contents of files have their own hashes.
    project.file_refs_mut().for_each(|file| file.path = PathBuf::new());
    // Of the timeline, only tracks affect images.
    project.timeline.markers.clear();
    let all = serde_json::to_value(&project).map_err(ProjectError::work)?;
    let Value::Object(sections) = all else { return Ok(Value::Null) };
    let told = sections
        .into_iter()
        .filter(|(name, _)| !BESIDE.contains(&name.as_str()) || (with_panes && name == "compare"));
    let marked = told.map(|(name, section)| (name, Value::from(mark(section.to_string().as_bytes()))));
    Ok(Value::Object(marked.collect()))
}

/// A hash of each file of the project and of its take, by role, and of the takes of its panes if they are rendered.
pub(super) fn of_files(project: &Project, access: &Access, assets: &[TakeAsset], with_panes: bool) -> Value {
    let files = project.files().into_iter().filter(|(place, _)| *place != Place::Sound);
    let own = files.filter_map(|(place, file)| {
        let path = access.read(place, file).ok()?;
        Some((place.label().to_owned(), path))
    });
    let of_take = assets.iter().map(|asset| (format!("take's {}", asset.role), asset.path.clone()));
    let panes = project.compare.panes.iter().enumerate().filter(|_| with_panes);
    let of_panes = panes.filter_map(|(pane, contender)| {
        let path = access.read(Place::Take, contender.take.as_ref()?).ok()?;
        Some((format!("pane {}'s take", pane + 1), path))
    });
    let marked = own.chain(of_take).chain(of_panes).map(|(role, path)| {
        let is_file = std::fs::metadata(&path).is_ok_and(|data| data.is_file());
        let found = if is_file { TakeAsset::of_file(&*role, &path).ok() } else { None };
        let found = found.map_or_else(|| "missing".to_owned(), |file| format!("{:016x}", file.checksum));
        (format!("{role} file"), Value::from(found))
    });
    Value::Object(marked.collect::<Map<_, _>>())
}

/// FNV-1a, 64 bits.
fn mark(bytes: &[u8]) -> String {
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{hash:016x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_parts_that_affect_images_count() {
        let project = Project::default();
        let before = of_project(&project, false).expect("JSON");
        assert!(before.get("lights").is_some() && before.get("recording").is_none(), "{before}");
        let mut other = project.clone();
        other.recording.first_frame = 3;
        other.timeline.markers.push(lovelock_project::project::Marker::default());
        other.hair.file = Some(lovelock_project::files::FileRef::new("a.hair"));
        let moved = of_project(&other, false).expect("JSON");
        other.hair.file = Some(lovelock_project::files::FileRef::new("elsewhere/a.hair"));
        assert_eq!(moved, of_project(&other, false).expect("JSON"), "a file is identified by its contents");
        other.hair.file = None;
        assert_eq!(before, of_project(&other, false).expect("JSON"));
        other.lights[0].intensity += 0.1;
        let after = of_project(&other, false).expect("JSON");
        let differs = |key: &str| before[key] != after[key];
        assert!(differs("lights") && !differs("look") && !differs("hair"));
        other.compare.panes.pop();
        assert_eq!(after, of_project(&other, false).expect("JSON"));
        let panes = of_project(&other, true).expect("JSON");
        assert_ne!(panes["compare"], of_project(&project, true).expect("JSON")["compare"]);
    }

    #[test]
    fn files_are_identified_by_their_contents() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.take");
        let asset = TakeAsset { role: "hair".to_owned(), path: path.clone(), ..TakeAsset::default() };
        let told = || of_files(&Project::default(), &Access::new(), std::slice::from_ref(&asset), false);
        assert_eq!(told()["take's hair file"], "missing");
        std::fs::write(&path, b"one").expect("a file");
        let one = told();
        std::fs::write(&path, b"two").expect("a file");
        assert_ne!(one, told());
    }
}
