use super::{SequenceSettings, SequenceWriter, frame_name};
use crate::partial::Opener;
use crate::partial::failing::small_disk;
use crate::{Manifest, RecordError, read_manifest};
use std::fs;
use std::path::Path;
use std::sync::Arc;

fn settings() -> SequenceSettings {
    SequenceSettings {
        width: 33,
        height: 7,
        fps: 24.0,
        first_frame: 0,
        alpha: false,
        settings: serde_json::json!({ "shadow": "voxel-map", "resolution": 128 }),
    }
}

fn picture(seed: u8) -> Vec<u8> {
    (0..33 * 7)
        .flat_map(|i: u32| [seed, (i % 33 * 7) as u8, (i / 33 * 30) as u8, 128 + (i % 100) as u8])
        .collect()
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// Every file that the manifest lists is there, of the length and the checksum it says.
fn check_files(folder: &Path, manifest: &Manifest) {
    for frame in &manifest.frames {
        let bytes = fs::read(folder.join(&frame.file)).unwrap();
        assert_eq!(frame.bytes, bytes.len() as u64);
        assert_eq!(frame.crc32, format!("{:08x}", crc32fast::hash(&bytes)));
    }
}

#[test]
fn frames_come_back_exactly() {
    for alpha in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("frames é");
        let mut writer =
            SequenceWriter::create(&folder, SequenceSettings { alpha, first_frame: 7, ..settings() })
                .unwrap();
        (0..12).for_each(|frame| writer.push(&picture(frame)).unwrap());
        let report = writer.finish().unwrap();
        let manifest = read_manifest(&folder).unwrap();
        assert_eq!((report.frames, manifest.frames.len(), manifest.complete), (12, 12, true));
        assert_eq!(report.bytes, manifest.frames.iter().map(|frame| frame.bytes).sum::<u64>());
        assert_eq!((manifest.width, manifest.height, manifest.fps, manifest.first_frame), (33, 7, 24.0, 7));
        assert_eq!(manifest.settings["resolution"], 128);
        check_files(&folder, &manifest);
        for (index, frame) in manifest.frames.iter().enumerate() {
            assert_eq!((frame.number, &frame.file), (index as u64 + 7, &frame_name(index as u64 + 7)));
            let image = image::open(folder.join(&frame.file)).unwrap();
            let wanted = picture(index as u8);
            if alpha {
                assert_eq!(image.into_rgba8().into_raw(), wanted);
            } else {
                assert_eq!(image.color(), image::ColorType::Rgb8);
                let opaque: Vec<u8> = wanted.chunks(4).flat_map(|pixel| pixel[..3].to_vec()).collect();
                assert_eq!(image.into_rgb8().into_raw(), opaque);
            }
        }
        assert_eq!(files(&folder).len(), 13, "frames and manifest alone");
    }
}

#[test]
fn a_cancel_keeps_whole_frames_and_says_incomplete() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = SequenceWriter::create(folder.path(), settings()).unwrap();
    (0..3).for_each(|frame| writer.push(&picture(frame)).unwrap());
    writer.cancel();
    let manifest = read_manifest(folder.path()).unwrap();
    assert!(!manifest.complete);
    check_files(folder.path(), &manifest);
    assert!(files(folder.path()).iter().all(|name| !name.ends_with(".partial")));
}

#[test]
fn a_shorter_sequence_replaces_a_longer_one_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("notes.png"), b"mine").unwrap();
    for frames in [5, 2] {
        let mut writer = SequenceWriter::create(folder.path(), settings()).unwrap();
        (0..frames).for_each(|frame| writer.push(&picture(frame)).unwrap());
        writer.finish().unwrap();
    }
    assert_eq!(files(folder.path()), ["frame_000000.png", "frame_000001.png", "manifest.json", "notes.png"]);
}

#[test]
fn a_manifest_cannot_name_files_to_remove() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = SequenceWriter::create(folder.path(), settings()).unwrap();
    writer.push(&picture(0)).unwrap();
    writer.finish().unwrap();
    let path = folder.path().join("manifest.json");
    let text = fs::read_to_string(&path).unwrap().replace("\"frame_000000.png\"", "\"precious.txt\"");
    fs::write(&path, text).unwrap();
    fs::write(folder.path().join("precious.txt"), b"mine").unwrap();
    let mut writer =
        SequenceWriter::create(folder.path(), SequenceSettings { first_frame: 5, ..settings() }).unwrap();
    writer.push(&picture(0)).unwrap();
    writer.finish().unwrap();
    assert!(folder.path().join("precious.txt").exists());
}

#[test]
fn a_full_disk_stops_the_sequence_and_leaves_no_unfinished_frame() {
    let folder = tempfile::tempdir().unwrap();
    let opener: Arc<Opener> = Arc::new(small_disk(50));
    let mut writer = SequenceWriter::create_on(folder.path(), settings(), &opener).unwrap();
    let mut pushed = 0;
    let error = loop {
        if let Err(error) = writer.push(&picture(0)) {
            break error;
        }
        pushed += 1;
        assert!(pushed < 10_000, "the disk never got full");
    };
    let RecordError::Io { source, .. } = &error else { panic!("{error:?}") };
    assert_eq!(source.kind(), std::io::ErrorKind::StorageFull);
    assert!(error.to_string().contains("frame_") && !error.is_request(), "{error}");
    assert!(matches!(writer.push(&picture(0)), Err(RecordError::Stopped { .. })));
    drop(writer);
    assert!(files(folder.path()).is_empty());
}

#[test]
fn impossible_sequences_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, b"").unwrap();
    assert!(SequenceWriter::create(&file, settings()).unwrap_err().is_request());
    for bad in [
        SequenceSettings { width: 0, ..settings() },
        SequenceSettings { height: 100_000, ..settings() },
        SequenceSettings { fps: f64::NAN, ..settings() },
    ] {
        assert!(SequenceWriter::create(&folder.path().join("new"), bad).unwrap_err().is_request());
    }
    assert!(!folder.path().join("new").exists());
    let empty = SequenceWriter::create(&folder.path().join("empty"), settings()).unwrap();
    assert!(empty.finish().unwrap_err().is_request());
    assert!(files(&folder.path().join("empty")).is_empty());
}

#[test]
fn foreign_manifests_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(read_manifest(folder.path()), Err(RecordError::Io { .. })));
    for text in ["", "[]", "{\"format\": \"other\"}", "\u{0}"] {
        fs::write(folder.path().join("manifest.json"), text).unwrap();
        let error = read_manifest(folder.path()).unwrap_err();
        assert!(error.is_request() && error.to_string().contains("manifest.json"), "{error}");
    }
}
