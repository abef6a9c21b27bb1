//! The sound beside a sequence. The manifest lists it, so that a later recording removes no other file.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use crate::RecordError;
use crate::manifest::ManifestSound;
use crate::sound::{SoundSource, write_wav};

/// The name of the sound's file in the folder of a sequence.
pub const SOUND_NAME: &str = "sound.wav";

/// Writes `samples` samples per channel into a folder. Returns the entry of the manifest.
pub(super) fn write(folder: &Path, source: &mut dyn SoundSource, samples: u64) -> io::Result<ManifestSound> {
    let path = folder.join(SOUND_NAME);
    let bytes = write_wav(&path, source, samples)?;
    Ok(ManifestSound { file: SOUND_NAME.to_owned(), bytes, crc32: checksum(&path)? })
}

/// Checks that the sound would replace no file but the one that the manifest before listed: it may be the very sound of the project.
pub(super) fn check_place(folder: &Path, listed: Option<&ManifestSound>) -> Result<(), RecordError> {
    let path = folder.join(SOUND_NAME);
    if fs::symlink_metadata(&path).is_err() || listed.is_some_and(|listed| is_own(folder, listed)) {
        return Ok(());
    }
    Err(RecordError::request(format!(
        "{}: found a file that the previous recording did not write, or that has changed since. The sound of this recording needs \
         the name: move the file, or record to another folder",
        path.display()
    )))
}

/// Removes the sound of an earlier recording. A file that has changed since belongs to somebody else and stays.
pub(crate) fn remove_own(folder: &Path, listed: &ManifestSound) {
    if is_own(folder, listed) {
        // Errors do no harm, because no manifest lists the file any more.
        let _ = fs::remove_file(folder.join(SOUND_NAME));
    }
}

/// Whether the sound in a folder is the one that a manifest lists.
fn is_own(folder: &Path, listed: &ManifestSound) -> bool {
    let path = folder.join(SOUND_NAME);
    let is_long = fs::symlink_metadata(&path).is_ok_and(|data| data.is_file() && data.len() == listed.bytes);
    let is_listed = listed.file == SOUND_NAME && is_long;
    is_listed && checksum(&path).is_ok_and(|crc32| crc32 == listed.crc32)
}

fn checksum(path: &Path) -> io::Result<String> {
    let (mut file, mut hasher) = (File::open(path)?, crc32fast::Hasher::new());
    let mut block = vec![0; 1 << 16];
    loop {
        match file.read(&mut block)? {
            0 => return Ok(format!("{:08x}", hasher.finalize())),
            count => hasher.update(&block[..count]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sound::testing::Clicks;
    use crate::{SequenceFormat, SequenceSettings, SequenceWriter, read_manifest};

    /// Starts a sequence of small frames in a folder.
    fn create(folder: &Path) -> SequenceWriter {
        let settings = SequenceSettings {
            width: 2,
            height: 2,
            fps: 30.0,
            first_frame: 0,
            format: SequenceFormat::Png,
            alpha: false,
            resume: false,
            settings: serde_json::Value::Null,
        };
        SequenceWriter::create(folder, settings).expect("a sequence")
    }

    /// Starts a sequence and writes three frames of it.
    fn begin(folder: &Path, has_sound: bool) -> SequenceWriter {
        let mut writer = create(folder);
        if has_sound {
            writer.set_sound(Box::new(Clicks::new(1, 0.0))).expect("a place for the sound");
        }
        (0..3).for_each(|_| writer.push(&[9; 16]).expect("a frame"));
        writer
    }

    fn record(folder: &Path, has_sound: bool) -> u64 {
        begin(folder, has_sound).finish().expect("a sequence").bytes
    }

    #[test]
    fn a_silent_recording_removes_the_sound_of_the_one_before() {
        let dir = tempfile::tempdir().expect("a folder");
        let sound = dir.path().join(SOUND_NAME);
        let bytes = record(dir.path(), true);
        let listed = read_manifest(dir.path()).expect("a manifest").sound.expect("a sound");
        assert_eq!((listed.file.as_str(), listed.bytes), (SOUND_NAME, 44 + 2 * 4800));
        assert_eq!(fs::metadata(&sound).expect("a sound").len(), listed.bytes);
        assert_eq!(record(dir.path(), false), bytes - listed.bytes);
        assert!(!sound.exists() && read_manifest(dir.path()).expect("a manifest").sound.is_none());
    }

    #[test]
    fn a_cancelled_recording_leaves_the_sound_to_the_next_one() {
        let dir = tempfile::tempdir().expect("a folder");
        record(dir.path(), true);
        // One without a frame changes nothing.
        let before = read_manifest(dir.path()).expect("a manifest");
        create(dir.path()).cancel();
        assert_eq!(read_manifest(dir.path()).expect("a manifest"), before);
        assert!(create(dir.path()).finish().is_err(), "no frames");
        assert_eq!(read_manifest(dir.path()).expect("a manifest"), before);
        assert_eq!(fs::read_dir(dir.path()).expect("a folder").count(), 5, "frames, sound and manifest");
        begin(dir.path(), false).cancel();
        assert_ne!(read_manifest(dir.path()).expect("a manifest"), before, "control: with frames");
        assert!(dir.path().join(SOUND_NAME).exists());
        record(dir.path(), false);
        assert!(!dir.path().join(SOUND_NAME).exists());
    }

    #[test]
    fn files_of_the_user_stay() {
        let dir = tempfile::tempdir().expect("a folder");
        let sound = dir.path().join(SOUND_NAME);
        // In a folder without a recording, and beside a silent one.
        fs::write(&sound, "mine").expect("a file");
        for _ in 0..2 {
            record(dir.path(), false);
            assert_eq!(fs::read(&sound).expect("a file"), b"mine");
        }
        let refused = |content: &[u8]| {
            let error = create(dir.path()).set_sound(Box::new(Clicks::new(1, 0.0)));
            let error = error.expect_err("a file of the user").to_string();
            assert!(error.contains(SOUND_NAME) && error.lines().count() == 1, "{error}");
            assert_eq!(fs::read(&sound).expect("a file"), content);
        };
        refused(b"mine");
        fs::remove_file(&sound).expect("a file");
        // The control: the sound of the recording before is replaced.
        record(dir.path(), true);
        record(dir.path(), true);
        // One that was edited since, with the same length.
        let mut edited = fs::read(&sound).expect("a file");
        edited[100] ^= 1;
        fs::write(&sound, &edited).expect("a file");
        refused(&edited);
        record(dir.path(), false);
        assert_eq!(fs::read(&sound).expect("a file"), edited);
        // The control is the test of the silent recording above.
    }
}
