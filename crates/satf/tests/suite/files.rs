//! The database as a file, and in a folder.

use std::fs;

use lovelock_satf::Database;
use lovelock_satf::cache::{Note, load_or_build, path_in};
use lovelock_satf::file::{DatabaseError, VERSION};

use crate::database;

#[test]
fn a_file_holds_the_whole_database_in_four_mebibytes() {
    let bytes = database().to_bytes();
    assert!(bytes.len() <= 4 << 20, "{}", bytes.len());
    assert!(Database::from_bytes(&bytes).unwrap() == *database());
}

#[test]
fn damaged_files_are_refused_for_the_right_reason() {
    let bytes = database().to_bytes();
    let refused = |bytes: &[u8]| Database::from_bytes(bytes).unwrap_err();
    assert_eq!(refused(b""), DatabaseError::NotADatabase);
    assert_eq!(refused(b"PNG, or something else"), DatabaseError::NotADatabase);
    for length in [1, 8, 20, 27, 28, 1000, bytes.len() - 1] {
        let error = refused(&bytes[..length]);
        assert!(
            matches!(error, DatabaseError::CutShort { found, .. } if found == length),
            "{length}: {error}"
        );
    }
    let changed = |at: usize| {
        let mut bytes = bytes.clone();
        bytes[at] ^= 4;
        refused(&bytes)
    };
    assert_eq!(changed(0), DatabaseError::NotADatabase);
    assert_eq!(changed(8), DatabaseError::OtherVersion(VERSION ^ 4));
    assert!(matches!(changed(12), DatabaseError::CutShort { .. } | DatabaseError::Contents));
    assert!(matches!(changed(19), DatabaseError::CutShort { .. }));
    assert_eq!(changed(20), DatabaseError::Checksum);
    assert_eq!(changed(bytes.len() / 2), DatabaseError::Checksum);
    assert_eq!(refused(&[&bytes[..], &[0]].concat()), DatabaseError::Contents);
}

#[test]
fn a_folder_keeps_the_database_and_a_damaged_file_is_replaced_and_told() {
    let folder = tempfile::tempdir().unwrap();
    // A folder that does not exist yet is made.
    let folder = folder.path().join("cache");
    let (built, note) = load_or_build(&folder, &|_| ());
    assert!(built == *database() && note.is_none());
    let path = path_in(&folder);
    let kept = fs::read(&path).unwrap();
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "no temporary file is left");

    let (read, note) = load_or_build(&folder, &|_| panic!("built although it is there"));
    assert!(read == built && note.is_none());

    let changed = |at: usize| {
        let mut bytes = kept.clone();
        bytes[at] ^= 4;
        bytes
    };
    let (cut, other_version, other_byte) =
        (kept[..kept.len() / 2].to_vec(), changed(8), changed(kept.len() / 2));
    for damaged in [cut, other_version, other_byte] {
        let expected = Database::from_bytes(&damaged).unwrap_err().to_string();
        fs::write(&path, &damaged).unwrap();
        let (again, note) = load_or_build(&folder, &|_| ());
        assert!(again == built, "{expected}");
        assert!(
            matches!(&note, Some(Note::MadeAgain { path: told, reason }) if *told == path && reason.contains(&expected)),
            "{note:?} does not contain {expected}"
        );
        assert_eq!(fs::read(&path).unwrap(), kept, "{expected}");
        assert!(load_or_build(&folder, &|_| ()).1.is_none(), "it is told once");
    }
}

#[test]
fn a_folder_that_cannot_be_written_is_told_and_the_database_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a file");
    fs::write(&file, "not a folder").unwrap();
    let (built, note) = load_or_build(&file, &|_| ());
    assert!(built == *database());
    assert!(note.is_some());
    assert_eq!(fs::read(&file).unwrap(), b"not a folder");
}
