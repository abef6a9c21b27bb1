//! Takes in which the number of guides changes.

use crate::take_scene::{
    Random, SMALL, Size, chunks, frame, header, is_frame, project, record_regrown, regrown_size,
};
use lovelock_record::{MAX_GUIDE_POINTS, TakeCondition, TakeError, TakeFrame, TakeReader, TakeWriter};
use std::fs;
use std::path::{Path, PathBuf};

const FRAMES: u64 = 100;

fn recorded() -> (tempfile::TempDir, PathBuf, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("regrown.take");
    record_regrown(&path, FRAMES);
    let bytes = fs::read(&path).unwrap();
    (folder, path, bytes)
}

fn open(path: &Path, bytes: &[u8]) -> Result<TakeReader, TakeError> {
    fs::write(path, bytes).unwrap();
    TakeReader::open(path)
}

fn sizes(take: &mut TakeReader) -> Vec<(u64, u32, u32)> {
    let layouts = take.layouts().unwrap();
    layouts.iter().map(|layout| (layout.first_frame, layout.guides, layout.points_per_guide)).collect()
}

#[test]
fn every_frame_comes_back_with_its_own_guides_in_any_order() {
    let (_folder, path, bytes) = recorded();
    let mut take = TakeReader::open(&path).unwrap();
    assert!(take.verify().unwrap().is_whole());
    assert_eq!(sizes(&mut take), [(0, 3, 4), (40, 5, 6), (75, 2, 9)]);
    let frames: Vec<u64> = chunks(&bytes).iter().map(|chunk| chunk.frames).filter(|&n| n > 0).collect();
    assert_eq!(frames, [30, 10, 30, 5, 25], "a chunk ends where the guides change");
    let mut random = Random(1);
    let mut out = TakeFrame::default();
    for n in (0..FRAMES).chain((0..300).map(|_| random.below(FRAMES as usize) as u64)) {
        take.frame_into(n, &mut out).unwrap();
        assert!(is_frame(&out, n, regrown_size(n)), "frame {n}");
        assert_eq!(*take.project_at(n).unwrap(), *project(n), "frame {n}");
    }
}

#[test]
fn nothing_is_interpolated_between_different_layouts() {
    let (_folder, path, _) = recorded();
    let mut take = TakeReader::open(&path).unwrap();
    let mut out = TakeFrame::default();
    for (place, shown) in [(39.2, 39), (39.49, 39), (39.5, 40), (39.9, 40), (74.4, 74), (74.6, 75)] {
        assert_eq!(take.frame_at(place / 60.0, &mut out).unwrap(), shown, "{place}");
        assert!(is_frame(&out, shown, regrown_size(shown)), "{place}");
    }
    // Negative control: frames with the same layout are interpolated.
    assert_eq!(take.frame_at(41.4 / 60.0, &mut out).unwrap(), 41);
    assert!(!is_frame(&out, 41, regrown_size(41)) && !is_frame(&out, 42, regrown_size(42)));
}

#[test]
fn unannounced_or_invalid_layouts_are_refused_and_recording_continues() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("refused.take");
    let mut writer = TakeWriter::create(&path, header(SMALL)).unwrap();
    writer.push(&frame(0, SMALL)).unwrap();
    let error = writer.push(&frame(1, Size(5, 6))).unwrap_err();
    assert!(error.to_string().contains("frame 1: 5 guides of 6 points; must be 3 of 4"), "{error}");
    for (guides, points) in [(0, 4), (3, 1), (usize::MAX, 2), (MAX_GUIDE_POINTS as usize, 2)] {
        let error = writer.set_layout(guides, points).unwrap_err();
        assert!(error.is_request() && error.to_string().contains("must be at least 1 guide"), "{error}");
    }
    writer.push(&frame(1, SMALL)).unwrap();
    // A layout that is set and set back before a frame has no effect.
    writer.set_layout(5, 6).unwrap();
    writer.set_layout(3, 4).unwrap();
    writer.push(&frame(2, SMALL)).unwrap();
    assert_eq!(writer.finish().unwrap().frames, 3);
    let mut take = TakeReader::open(&path).unwrap();
    assert_eq!(sizes(&mut take), [(0, 3, 4)]);
    assert!((0..3).all(|n| is_frame(&take.frame(n).unwrap(), n, SMALL)));
}

#[test]
fn cut_at_every_length_it_plays_to_its_last_complete_chunk() {
    let (_folder, path, bytes) = recorded();
    let all = chunks(&bytes);
    for length in (0..bytes.len()).step_by(7) {
        let wanted: u64 = all.iter().filter(|chunk| chunk.end <= length).map(|chunk| chunk.frames).sum();
        let Ok(mut take) = open(&path, &bytes[..length]) else {
            assert_eq!(wanted, 0, "{length}");
            continue;
        };
        assert!(
            matches!(take.condition(), TakeCondition::Cut { frames, .. } if frames == wanted),
            "{length}"
        );
        assert!((0..wanted).all(|n| is_frame(&take.frame(n).unwrap(), n, regrown_size(n))), "{length}");
        assert_eq!(sizes(&mut take).len(), 1 + usize::from(wanted > 40) + usize::from(wanted > 75));
    }
}

#[test]
fn a_changed_bit_affects_only_its_chunk() {
    let (_folder, path, bytes) = recorded();
    let all = chunks(&bytes);
    let mut random = Random(2);
    let mut lost_once = 0;
    for _ in 0..300 {
        let byte = random.below(bytes.len());
        let mut changed = bytes.clone();
        changed[byte] ^= 1 << random.below(8);
        let hit = all.iter().find(|chunk| (chunk.start..chunk.end).contains(&byte));
        let mut take = open(&path, &changed).unwrap();
        // Before playback, and so before the damage is known.
        let _ = take.layouts().unwrap();
        for n in 0..FRAMES {
            let mine = hit.is_some_and(|hit| (hit.first..hit.first + hit.frames).contains(&n));
            match take.frame(n) {
                Ok(played) => assert!(is_frame(&played, n, regrown_size(n)), "byte {byte}, frame {n}"),
                Err(error) => {
                    assert!(mine && matches!(error, TakeError::Lost { .. }), "byte {byte}, frame {n}");
                    lost_once += 1;
                }
            }
            let mut out = TakeFrame::default();
            if let Ok(shown) = take.frame_at((n as f64 - 0.3) / 60.0, &mut out) {
                let size = regrown_size(shown);
                let found = (out.guides.guides.count(), out.guides.guides.points_per_guide);
                assert_eq!(found, (size.0, size.1), "byte {byte}, frame {n}");
            }
        }
        assert!(!take.verify().unwrap().is_whole(), "byte {byte}");
    }
    assert!(lost_once > 100, "negative control: frames were lost");
}

#[test]
fn a_false_layout_is_reported_and_allocates_nothing() {
    let (_folder, path, bytes) = recorded();
    let third = &chunks(&bytes)[4];
    assert_eq!((third.first, third.frames), (40, 30));
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    let start = third.start + 64 + word(third.start + 32);
    let raw = zstd::decode_all(&bytes[start..start + word(third.start + 44)]).unwrap();
    let with = |guides: u32, points: u32| {
        let mut raw = raw.clone();
        raw[..4].copy_from_slice(&guides.to_le_bytes());
        raw[4..8].copy_from_slice(&points.to_le_bytes());
        let packed = zstd::encode_all(&raw[..], 1).unwrap();
        let mut chunk = bytes[third.start..start].to_vec();
        for (at, value) in [(44, packed.len() as u32), (52, crc32fast::hash(&packed))] {
            chunk[at..at + 4].copy_from_slice(&value.to_le_bytes());
        }
        let crc = crc32fast::hash(&chunk[..60]);
        chunk[60..64].copy_from_slice(&crc.to_le_bytes());
        // The file is cut after the chunk, because the index contains its original header.
        open(&path, &[&bytes[..third.start], &chunk, &packed].concat()).unwrap()
    };
    for (guides, points) in [(0, 6), (5, 0), (5, 1), (6, 5), (3, 6), (u32::MAX, u32::MAX), (1 << 19, 2)] {
        let mut take = with(guides, points);
        let error = take.frame(41).unwrap_err();
        assert!(matches!(error, TakeError::Lost { first: 40, last: 69, .. }), "{guides} {points}: {error}");
        assert!(is_frame(&take.frame(39).unwrap(), 39, SMALL));
    }
    let mut take = with(5, 6);
    assert!(is_frame(&take.frame(41).unwrap(), 41, regrown_size(41)), "the control");
}
