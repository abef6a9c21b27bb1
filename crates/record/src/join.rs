//! Joins the parts of a sequence.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::manifest::{MANIFEST_NAME, Manifest, ManifestFrame, read_manifest};
use crate::partial::{PartialFile, open_file};
use crate::sequence::remove_own;
use crate::{RecordError, SequenceReport};

/// Joins the sequences in the subfolders of `parts` into one sequence in `out`. The result is the same, byte for byte, as if
/// one run had rendered all of `frames`.
///
/// Every file is checked against its part's manifest. The manifest of `out` is written last; the parts are not changed.
///
/// # Errors
/// [`RecordError::Request`] for parts that differ in size, rate or settings or are not complete, and for a frame that
/// is in no part; [`RecordError::Malformed`] for a file that differs from its manifest; [`RecordError::Io`] for disk errors.
pub fn join_sequences(parts: &Path, frames: Range<u64>, out: &Path) -> Result<SequenceReport, RecordError> {
    if frames.is_empty() {
        return Err(RecordError::request(format!("frames {}..{}: an empty range", frames.start, frames.end)));
    }
    let (head, mut found) = read_parts(parts)?;
    found.retain(|number, _| frames.contains(number));
    if found.len() as u64 != frames.end - frames.start {
        let missing = frames.clone().find(|number| !found.contains_key(number)).unwrap_or(frames.start);
        return Err(RecordError::request(format!(
            "{}: no part has frame {missing} of {}..{}; render it before you join the parts",
            parts.display(),
            frames.start,
            frames.end
        )));
    }
    fs::create_dir_all(out).map_err(|error| RecordError::io(out, "create the folder", error))?;
    let manifest_path = out.join(MANIFEST_NAME);
    let (old, old_sound) =
        read_manifest(out).map_or_else(|_| (Vec::new(), None), |old| (old.frames, old.sound));
    if manifest_path.exists() {
        fs::remove_file(&manifest_path)
            .map_err(|error| RecordError::io(&manifest_path, "remove the old manifest", error))?;
    }
    let write = |manifest: &Manifest| {
        let write = || {
            let mut file = PartialFile::create(&manifest_path, &open_file)?;
            serde_json::to_writer_pretty(&mut file, manifest)?;
            file.write_all(b"\n")?;
            file.commit(true)
        };
        write().map_err(|error| RecordError::io(&manifest_path, "write the manifest", error))
    };
    let copied = found.values().try_for_each(|(folder, frame)| copy(folder, frame, out));
    if let Err(error) = copied {
        if old_sound.is_some() {
            // A later recording must know that the sound is not the user's. The first error is returned.
            let first_frame = frames.start;
            let listed =
                Manifest { complete: false, first_frame, frames: Vec::new(), sound: old_sound, ..head };
            let _ = write(&listed);
        }
        return Err(error);
    }
    let manifest = Manifest {
        complete: true,
        first_frame: frames.start,
        frames: found.into_values().map(|(_, frame)| frame).collect(),
        // Parts have sounds of their own, if any, and those are not joined.
        sound: None,
        ..head
    };
    write(&manifest)?;
    for frame in old.iter().filter(|old| is_plain(&old.file) && !frames.contains(&old.number)) {
        // Frames of the sequence that was here before. Errors do no harm, because the new manifest does not list them.
        let _ = fs::remove_file(out.join(&frame.file));
    }
    if let Some(old) = &old_sound {
        remove_own(out, old);
    }
    let bytes = manifest.frames.iter().map(|frame| frame.bytes).sum();
    Ok(SequenceReport { folder: out.to_owned(), frames: manifest.frames.len() as u64, kept: 0, bytes })
}

/// The manifest that all parts share, and each frame with its folder.
type Parts = (Manifest, BTreeMap<u64, (PathBuf, ManifestFrame)>);

fn read_parts(parts: &Path) -> Result<Parts, RecordError> {
    let listed = |error| RecordError::io(parts, "list the parts", error);
    let mut folders = Vec::new();
    for entry in fs::read_dir(parts).map_err(listed)? {
        let path = entry.map_err(listed)?.path();
        if path.join(MANIFEST_NAME).is_file() {
            folders.push(path);
        }
    }
    folders.sort();
    let mut head: Option<Manifest> = None;
    let mut found = BTreeMap::new();
    for folder in folders {
        let mut manifest = read_manifest(&folder)?;
        if !manifest.complete {
            return Err(RecordError::request(format!(
                "{}: the part is incomplete; render it again",
                folder.display()
            )));
        }
        for frame in std::mem::take(&mut manifest.frames) {
            if !is_plain(&frame.file) {
                return Err(RecordError::request(format!(
                    "{}: its manifest names `{}`, which is not a file in its folder",
                    folder.display(),
                    frame.file
                )));
            }
            found.entry(frame.number).or_insert_with(|| (folder.clone(), frame));
        }
        manifest.first_frame = 0;
        match &head {
            None => head = Some(manifest),
            Some(head) if *head == manifest => {}
            Some(_) => {
                return Err(RecordError::request(format!(
                    "{}: size, rate or settings differ from those of the other parts",
                    folder.display()
                )));
            }
        }
    }
    let head = head.ok_or_else(|| {
        RecordError::request(format!(
            "{}: contains no parts; must contain folders of frames",
            parts.display()
        ))
    })?;
    Ok((head, found))
}

/// Whether `name` is a plain file name without any folder.
fn is_plain(name: &str) -> bool {
    Path::new(name).file_name().is_some_and(|file| file == name)
}

fn copy(folder: &Path, frame: &ManifestFrame, out: &Path) -> Result<(), RecordError> {
    let (from, to) = (folder.join(&frame.file), out.join(&frame.file));
    let bytes = fs::read(&from).map_err(|error| RecordError::io(&from, "read the frame", error))?;
    let crc32 = format!("{:08x}", crc32fast::hash(&bytes));
    if crc32 != frame.crc32 || bytes.len() as u64 != frame.bytes {
        return Err(RecordError::Malformed {
            path: from,
            offset: 0,
            found: format!("{} bytes of CRC-32 {crc32}", bytes.len()),
            wanted: format!("{} bytes of CRC-32 {}, as its manifest says", frame.bytes, frame.crc32),
        });
    }
    let write = || {
        let mut file = PartialFile::create(&to, &open_file)?;
        file.write_all(&bytes)?;
        file.commit(false)
    };
    write().map_err(|error| RecordError::io(&to, format!("write frame {}", frame.number), error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SequenceFormat, SequenceSettings, SequenceWriter, frame_name};

    fn draw(folder: &Path, frames: Range<u64>, width: u32) {
        let settings = SequenceSettings {
            width,
            height: 4,
            fps: 30.0,
            first_frame: frames.start,
            alpha: false,
            format: SequenceFormat::Png,
            resume: false,
            settings: serde_json::json!({ "shadow": "none" }),
        };
        let mut writer = SequenceWriter::create(folder, settings).expect("a sequence");
        for frame in frames {
            let pixel = [frame as u8, 7, 200, 255];
            writer.push(&pixel.repeat((width * 4) as usize)).expect("a frame");
        }
        writer.finish().expect("a sequence");
    }

    /// Every file of a folder with its bytes.
    fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
        let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("a file").path());
        entries
            .map(|path| (path.file_name().expect("a name").into(), fs::read(path).expect("a file")))
            .collect()
    }

    #[test]
    fn parts_become_what_one_run_draws() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        draw(&at("whole"), 3..13, 8);
        for (name, frames) in [("parts/a", 3..7), ("parts/c", 7..9), ("parts/b", 9..13)] {
            draw(&at(name), frames, 8);
        }
        draw(&at("out"), 1..20, 8);
        let report = join_sequences(&at("parts"), 3..13, &at("out")).expect("a sequence");
        assert_eq!(report.frames, 10);
        assert_eq!(files(&at("out")), files(&at("whole")));
        // Negative control: an altered frame is found by its checksum.
        draw(&at("parts/c"), 8..9, 8);
        draw(&at("parts/d"), 7..8, 8);
        let frame = at("parts/d").join(frame_name(7, SequenceFormat::Png));
        let mut bytes = fs::read(&frame).expect("a file");
        let last = bytes.len() - 1;
        bytes[last] ^= 1;
        fs::write(&frame, &bytes).expect("a file");
        let error = join_sequences(&at("parts"), 3..13, &at("out")).expect_err("an altered frame");
        assert!(error.to_string().contains("CRC-32") && error.is_request(), "{error}");
        assert!(!at("out").join(MANIFEST_NAME).exists(), "an incomplete sequence has no manifest");
    }

    #[test]
    fn parts_that_do_not_fit_are_refused() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        fs::create_dir(at("parts")).expect("a folder");
        let refused = |frames: Range<u64>, wanted: &str| {
            let error = join_sequences(&at("parts"), frames, &at("out")).expect_err(wanted).to_string();
            assert!(error.contains(wanted), "{error}");
            assert!(!at("out").exists(), "nothing was written");
        };
        refused(0..2, "contains no parts");
        draw(&at("parts/a"), 0..2, 8);
        refused(0..0, "empty range");
        refused(0..3, "no part has frame 2 of 0..3");
        draw(&at("parts/b"), 2..3, 9);
        refused(0..3, "size, rate or settings differ");
        let manifest = at("parts/b").join(MANIFEST_NAME);
        let text = fs::read_to_string(&manifest).expect("a manifest");
        fs::write(&manifest, text.replace("\"complete\": true", "\"complete\": false")).expect("a file");
        refused(0..3, "the part is incomplete");
        fs::write(&manifest, text.replace("frame_000002.png", "../a/frame_000000.png")).expect("a file");
        refused(0..3, "not a file in its folder");
    }
}
