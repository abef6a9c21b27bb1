//! Sequences that were drawn in parts, put together into one.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::manifest::{MANIFEST_NAME, Manifest, ManifestFrame, read_manifest};
use crate::partial::{PartialFile, open_file};
use crate::{RecordError, SequenceReport};

/// Puts the sequences in the folders of `parts` together into one in `out`, as if one program had drawn all of
/// `frames`: the same files, byte for byte, and the same manifest.
///
/// Every file is held against its part's manifest. The manifest of `out` comes last; parts stay as they are.
///
/// # Errors
/// [`RecordError::Request`] for parts that differ in size, rate or settings, that are not complete, and for a frame that
/// no part has; [`RecordError::Malformed`] for a file that is not what its manifest says; [`RecordError::Io`] for the disk.
pub fn join_sequences(parts: &Path, frames: Range<u64>, out: &Path) -> Result<SequenceReport, RecordError> {
    if frames.is_empty() {
        return Err(RecordError::request(format!("frames {}..{}: an empty range", frames.start, frames.end)));
    }
    let (head, mut found) = look(parts)?;
    found.retain(|number, _| frames.contains(number));
    if found.len() as u64 != frames.end - frames.start {
        let missing = frames.clone().find(|number| !found.contains_key(number)).unwrap_or(frames.start);
        return Err(RecordError::request(format!(
            "{}: no part has frame {missing} of {}..{}; draw it before the parts are put together",
            parts.display(),
            frames.start,
            frames.end
        )));
    }
    fs::create_dir_all(out).map_err(|error| RecordError::io(out, "create the folder", error))?;
    let manifest_path = out.join(MANIFEST_NAME);
    let old = read_manifest(out).map_or_else(|_| Vec::new(), |old| old.frames);
    if manifest_path.exists() {
        fs::remove_file(&manifest_path)
            .map_err(|error| RecordError::io(&manifest_path, "remove the old manifest", error))?;
    }
    for (folder, frame) in found.values() {
        copy(folder, frame, out)?;
    }
    let manifest = Manifest {
        complete: true,
        first_frame: frames.start,
        frames: found.into_values().map(|(_, frame)| frame).collect(),
        ..head
    };
    let write = || {
        let mut file = PartialFile::create(&manifest_path, &open_file)?;
        serde_json::to_writer_pretty(&mut file, &manifest)?;
        file.write_all(b"\n")?;
        file.commit(true)
    };
    write().map_err(|error| RecordError::io(&manifest_path, "write the manifest", error))?;
    for frame in old.iter().filter(|old| is_plain(&old.file) && !frames.contains(&old.number)) {
        // Of the sequence that was here before. One that cannot go does no harm: the manifest is what counts.
        let _ = fs::remove_file(out.join(&frame.file));
    }
    let bytes = manifest.frames.iter().map(|frame| frame.bytes).sum();
    Ok(SequenceReport { folder: out.to_owned(), frames: manifest.frames.len() as u64, kept: 0, bytes })
}

/// What all parts have in common, and each frame with the folder that it lies in.
type Parts = (Manifest, BTreeMap<u64, (PathBuf, ManifestFrame)>);

fn look(parts: &Path) -> Result<Parts, RecordError> {
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
                "{}: was not drawn to its end; draw it again",
                folder.display()
            )));
        }
        for frame in std::mem::take(&mut manifest.frames) {
            if !is_plain(&frame.file) {
                return Err(RecordError::request(format!(
                    "{}: its manifest names `{}`, which is no file of its folder",
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
                    "{}: drawn with another size, rate or settings than the parts before it",
                    folder.display()
                )));
            }
        }
    }
    let head = head.ok_or_else(|| {
        RecordError::request(format!("{}: holds no part; wanted folders of frames", parts.display()))
    })?;
    Ok((head, found))
}

/// Whether a name is that of a file in its folder, and leads nowhere else.
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
        // The control: one frame that is another is found, by the comparison and by its checksum.
        draw(&at("parts/c"), 8..9, 8);
        draw(&at("parts/d"), 7..8, 8);
        let frame = at("parts/d").join(frame_name(7, SequenceFormat::Png));
        let mut bytes = fs::read(&frame).expect("a file");
        let last = bytes.len() - 1;
        bytes[last] ^= 1;
        fs::write(&frame, &bytes).expect("a file");
        let error = join_sequences(&at("parts"), 3..13, &at("out")).expect_err("an altered frame");
        assert!(error.to_string().contains("CRC-32") && error.is_request(), "{error}");
        assert!(!at("out").join(MANIFEST_NAME).exists(), "what is not whole says so");
    }

    #[test]
    fn parts_that_do_not_fit_are_refused() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        fs::create_dir(at("parts")).expect("a folder");
        let refused = |frames: Range<u64>, wanted: &str| {
            let error = join_sequences(&at("parts"), frames, &at("out")).expect_err(wanted).to_string();
            assert!(error.contains(wanted), "{error}");
            assert!(!at("out").exists(), "nothing was begun");
        };
        refused(0..2, "holds no part");
        draw(&at("parts/a"), 0..2, 8);
        refused(0..0, "empty range");
        refused(0..3, "no part has frame 2 of 0..3");
        draw(&at("parts/b"), 2..3, 9);
        refused(0..3, "another size");
        let manifest = at("parts/b").join(MANIFEST_NAME);
        let text = fs::read_to_string(&manifest).expect("a manifest");
        fs::write(&manifest, text.replace("\"complete\": true", "\"complete\": false")).expect("a file");
        refused(0..3, "was not drawn to its end");
        fs::write(&manifest, text.replace("frame_000002.png", "../a/frame_000000.png")).expect("a file");
        refused(0..3, "no file of its folder");
    }
}
