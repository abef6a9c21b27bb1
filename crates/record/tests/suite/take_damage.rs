//! Takes that are cut, changed or unfinished.

use crate::take_scene;

use lovelock_record::{TAKE_VERSION, TakeCondition, TakeError, TakeFrame, TakeReader, TakeWriter};
use lovelock_testkit::suite::sample;
use std::fs;
use std::path::Path;
use take_scene::{Random, SMALL, Size, chunks, frame, header, is_frame, play_all, record};

const FRAMES: u64 = 310;

/// The bytes of an intact take.
fn whole(folder: &Path, size: Size) -> Vec<u8> {
    let path = folder.join("whole.take");
    record(&path, FRAMES, size);
    fs::read(&path).unwrap()
}

/// Opens `bytes` as a take at `path`.
fn open(path: &Path, bytes: &[u8]) -> Result<TakeReader, TakeError> {
    fs::write(path, bytes).unwrap();
    TakeReader::open(path)
}

/// Cuts a take to `length` bytes and checks that all complete chunks play and that the take reports where it ends.
fn cut_to(path: &Path, bytes: &[u8], length: usize, size: Size) {
    let whole_chunks = chunks(bytes);
    let wanted: u64 = whole_chunks.iter().filter(|chunk| chunk.end <= length).map(|chunk| chunk.frames).sum();
    let result = open(path, &bytes[..length]);
    if length == bytes.len() {
        assert!(result.unwrap().condition().is_whole(), "the control");
        return;
    }
    if wanted == 0 {
        let error = result.err().unwrap();
        let named = error.is_request() && error.to_string().contains("cut.take");
        assert!(named && !error.to_string().contains("version"), "{length}: {error}");
        return;
    }
    let mut take = result.unwrap();
    assert!(
        matches!(take.condition(), TakeCondition::Cut { frames, .. } if frames == wanted),
        "{length}: {}",
        take.condition()
    );
    assert_eq!(take.frames(), wanted);
    assert_eq!(play_all(&mut take, size), wanted);
    assert!(matches!(take.frame(wanted), Err(TakeError::NoSuchFrame { .. })));
}

#[test]
fn a_take_cut_anywhere_plays_to_its_last_complete_chunk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.take");
    let size = Size(20, 12);
    let bytes = whole(folder.path(), size);
    let mut random = Random(1);
    for _ in 0..100 {
        cut_to(&path, &bytes, random.below(bytes.len()), size);
    }
    cut_to(&path, &bytes, bytes.len(), size);
}

/// Changes one bit of a take and checks that the damage is reported, no frame is wrong, and at most one chunk is lost.
fn flip(path: &Path, bytes: &[u8], bit: usize, size: Size) {
    let mut changed = bytes.to_vec();
    changed[bit / 8] ^= 1 << (bit % 8);
    let mut take = open(path, &changed).unwrap();
    let whole_chunks = chunks(bytes);
    let hit = whole_chunks.iter().find(|chunk| (chunk.start..chunk.end).contains(&(bit / 8)));
    let may_lose = |n: u64| hit.is_some_and(|hit| n >= hit.first && n < hit.first + hit.frames);
    assert_eq!(take.frames(), FRAMES, "bit {bit}");
    for n in 0..FRAMES {
        let project = take.project_at(n).map(|text| *text == *take_scene::project(n));
        match (take.frame(n), project) {
            (Ok(played), Ok(right)) => assert!(right && is_frame(&played, n, size), "bit {bit}, frame {n}"),
            (Err(TakeError::Lost { first, last, .. }), _) | (_, Err(TakeError::Lost { first, last, .. })) => {
                assert!(may_lose(n) && (first..=last).contains(&n), "bit {bit}, frame {n}");
                let near = take.nearest(n).unwrap();
                assert!(!may_lose(near) && take.frame(near).is_ok(), "bit {bit}, frame {n}");
            }
            (Err(error), _) | (_, Err(error)) => panic!("bit {bit}, frame {n}: {error}"),
        }
    }
    let condition = take.verify().unwrap();
    assert!(!condition.is_whole(), "bit {bit} was not found");
    assert!(condition.lost_frames() <= hit.map_or(0, |hit| hit.frames), "bit {bit}: {condition}");
}

#[test]
fn a_changed_bit_is_found_and_affects_only_its_chunk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("changed.take");
    let size = Size(8, 6);
    let bytes = whole(folder.path(), size);
    let mut random = Random(2);
    for _ in sample(0..300, 6) {
        flip(&path, &bytes, random.below(bytes.len() * 8), size);
    }
    // Every byte, in the short suite every seventh, of the first headers, of one chunk's header, and of everything after the frames.
    let all = chunks(&bytes);
    let (third, last) = (&all[3], &all[all.len() - 2]);
    assert_eq!((third.kind, last.kind), (*b"FRMS", *b"HEAD"));
    let every = (0..64).chain(third.start..third.start + 64).chain(last.start..bytes.len());
    for byte in sample(every, 7) {
        flip(&path, &bytes, byte * 8 + random.below(8), size);
    }
    // Negative control: the unchanged take.
    let mut take = open(&path, &bytes).unwrap();
    assert!(take.verify().unwrap().is_whole());
}

#[test]
fn damage_in_a_take_without_an_index_affects_only_its_chunk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("changed.take.part");
    let bytes = whole(folder.path(), SMALL);
    let all = chunks(&bytes);
    let end = all[all.len() - 3].end;
    let mut random = Random(3);
    for run in 0..200 {
        let mut changed = bytes[..end].to_vec();
        let hit = &all[2 + random.below(4)];
        let place = if run % 2 == 0 { random.below(64) } else { random.below(hit.end - hit.start) };
        changed[hit.start + place] ^= 1 << random.below(8);
        let mut take = open(&path, &changed).unwrap();
        take.verify().unwrap();
        assert!(
            matches!(take.condition(), TakeCondition::Damaged { ref lost, cut: true, .. }
                if lost[..] == *std::slice::from_ref(&(hit.first..hit.first + hit.frames))),
            "{run}: {}",
            take.condition()
        );
        for n in 0..FRAMES {
            let lost = (hit.first..hit.first + hit.frames).contains(&n);
            match take.frame(n) {
                Ok(played) => assert!(!lost && is_frame(&played, n, SMALL)),
                Err(error) => assert!(lost && error.to_string().contains("is lost"), "{error}"),
            }
        }
        // Playback continues: an instant beside a lost frame shows its intact neighbour.
        let mut out = TakeFrame::default();
        if hit.first > 0 {
            take.frame_at((hit.first as f64 - 0.5) / 60.0, &mut out).unwrap();
            assert!(is_frame(&out, hit.first - 1, SMALL));
        }
        take.frame_at((hit.first + hit.frames) as f64 / 60.0 - 0.5 / 60.0, &mut out).unwrap();
        assert!(is_frame(&out, hit.first + hit.frames, SMALL));
    }
}

#[test]
fn inserted_or_removed_bytes_affect_only_their_chunks() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shifted.take");
    let bytes = whole(folder.path(), SMALL);
    let all = chunks(&bytes);
    let hit = &all[4];
    let middle = usize::midpoint(hit.start, hit.end);
    let longer = [&bytes[..middle], b"some bytes that were never there", &bytes[middle..]].concat();
    let shorter = [&bytes[..middle], &bytes[middle + 9..]].concat();
    let zeros = [&bytes[..middle], &vec![0; hit.end - middle], &bytes[hit.end..]].concat();
    let without = [&bytes[..hit.start], &bytes[hit.end..]].concat();
    let twice = [&bytes[..hit.end], &bytes[hit.start..]].concat();
    let after = [&bytes[..], &[7; 5000]].concat();
    for (name, changed, most_lost) in [
        ("longer", longer, hit.frames),
        // The chunk now overlaps the next one, which is lost too.
        ("shorter", shorter, hit.frames + all[5].frames),
        ("zeros", zeros, hit.frames),
        ("without", without, hit.frames),
        ("twice", twice, 0),
        ("after", after, 0),
    ] {
        let mut take = open(&path, &changed).unwrap();
        let mut lost = 0;
        for n in 0..take.frames() {
            match take.frame(n) {
                Ok(played) => assert!(is_frame(&played, n, SMALL), "{name}, frame {n}"),
                Err(_) => lost += 1,
            }
        }
        let condition = take.verify().unwrap();
        assert!(take.frames() == FRAMES && lost <= most_lost, "{name}: {condition}");
        assert!(!condition.is_whole(), "{name}: {condition}");
    }
}

#[test]
fn other_files_and_other_versions_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.take");
    let refused = |bytes: &[u8]| open(&path, bytes).err().unwrap();
    for bytes in [&b""[..], b"\x9A", b"(version: 1, body: ())", &vec![0; 100_000]] {
        let error = refused(bytes);
        assert!(matches!(error, TakeError::NotATake { .. }), "{error}");
        let why = if bytes.is_empty() { "is empty; must be a take" } else { "does not begin like a take" };
        assert!(error.to_string().ends_with(&format!("other.take: {why}")), "{error}");
    }
    assert!(TakeReader::open(folder.path()).err().unwrap().is_request());
    let missing = TakeReader::open(&folder.path().join("missing.take")).err().unwrap();
    assert!(matches!(missing, TakeError::Io { .. }), "{missing}");
    let mut writer = TakeWriter::create(&folder.path().join("there.take"), header(SMALL)).unwrap();
    writer.push(&frame(0, SMALL)).unwrap();
    drop(writer);
    let missing = TakeReader::open(&folder.path().join("there.take")).err().unwrap();
    assert!(missing.to_string().contains("the unfinished take"), "{missing}");

    // A take of a newer version with correct checksums.
    let mut bytes = whole(folder.path(), SMALL);
    for chunk in chunks(&bytes) {
        let header = &mut bytes[chunk.start..chunk.start + 64];
        header[12..16].copy_from_slice(&(TAKE_VERSION + 1).to_le_bytes());
        let crc = crc32fast::hash(&header[..60]);
        header[60..].copy_from_slice(&crc.to_le_bytes());
    }
    let error = refused(&bytes);
    let (found, newest) = (TAKE_VERSION + 1, TAKE_VERSION);
    assert_eq!(
        error.to_string(),
        format!(
            "{}: is a take of version {found}; this program reads takes up to version {newest}",
            path.display()
        )
    );
}

#[test]
fn a_take_without_frames_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("none.take");
    let error = TakeWriter::create(&path, header(SMALL)).unwrap().finish().unwrap_err();
    assert!(error.is_request() && error.to_string().contains("at least one"), "{error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    let bytes = whole(folder.path(), SMALL);
    let error = open(&path, &bytes[..chunks(&bytes)[1].end]).err().unwrap();
    assert!(matches!(error, TakeError::Empty { .. }) && error.to_string().contains("none.take"), "{error}");
}

#[test]
fn headers_with_huge_lengths_allocate_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("absurd.take");
    let bytes = whole(folder.path(), SMALL);
    let end = chunks(&bytes).len() - 2;
    let third = chunks(&bytes).swap_remove(3);
    let cut = chunks(&bytes)[end - 1].end;
    // Offsets in a chunk's header with new values: frames, lengths before and after compression, the first frame.
    for (at, word) in [
        (24, 61),
        (24, u32::MAX),
        (28, u32::MAX),
        (32, u32::MAX),
        (36, 1 << 27),
        (48 - 4, u32::MAX),
        (48, 1 << 27),
        (48, u32::MAX),
        (16, 1 << 30),
        (20, u32::MAX),
    ] {
        let mut changed = bytes[..cut].to_vec();
        let header = &mut changed[third.start..third.start + 64];
        header[at..at + 4].copy_from_slice(&word.to_le_bytes());
        let crc = crc32fast::hash(&header[..60]);
        header[60..].copy_from_slice(&crc.to_le_bytes());
        let Ok(mut take) = open(&path, &changed) else { panic!("{at}: {word}") };
        assert!(take.frames() <= FRAMES, "{at}: {word}");
        for n in 0..take.frames() {
            if let Ok(played) = take.frame(n) {
                assert!(is_frame(&played, n, SMALL), "{at}: {word}: frame {n}");
            }
            let _ = take.project_at(n);
        }
        assert!(!take.verify().unwrap().is_whole(), "{at}: {word}");
    }
}
