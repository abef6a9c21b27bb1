//! Takes on failing disks, and what is read when a take is opened.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{Affine3A, Vec3};
use lovelock_groom::{GuideFrame, Guides};

use super::disk::Disk;
use super::source::Source;
use super::{TakeCondition, TakeError, TakeFrame, TakeHeader, TakeReader, TakeWriter};

const GUIDES: usize = 3;
const POINTS: usize = 4;

fn header() -> TakeHeader {
    let (guides, points_per_guide) = (GUIDES as u32, POINTS as u32);
    TakeHeader { guides, points_per_guide, project: "(look: 0)".to_owned(), ..TakeHeader::default() }
}

fn frame(n: u64) -> TakeFrame {
    let along = |k: u64| (0..GUIDES * POINTS).map(|i| ((n * k + i as u64) % 97) as f32 * 0.01).collect();
    let guides = Guides { points_per_guide: POINTS, x: along(1), y: along(3), z: along(5) };
    let world_from_head = Affine3A::from_translation(Vec3::splat(n as f32 * 0.001));
    TakeFrame {
        guides: GuideFrame { time_secs: 0.0, world_from_head, guides },
        wall_frame: n,
        ..Default::default()
    }
}

/// A disk with room for a given number of bytes, whose `sync` does not wait.
struct SmallDisk {
    file: File,
    room: u64,
}

impl Write for SmallDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let fits = bytes.len().min(usize::try_from(self.room).unwrap_or(usize::MAX));
        if fits == 0 && !bytes.is_empty() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.room -= fits as u64;
        self.file.write(&bytes[..fits])
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Disk for SmallDisk {
    fn sync(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn create(path: &Path, room: u64) -> Result<TakeWriter, TakeError> {
    TakeWriter::create_on(path, header(), &move |file| Box::new(SmallDisk { file, room }))
}

/// Records `frames` frames. Returns their size in bytes.
fn record(path: &Path, frames: u64) -> u64 {
    let mut writer = create(path, u64::MAX).unwrap();
    (0..frames).for_each(|n| writer.push(&frame(n)).unwrap());
    writer.finish().unwrap().bytes
}

#[test]
fn a_full_disk_keeps_what_was_written_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dance.take");
    let part = folder.path().join("dance.take.part");
    record(&path, 7);
    let bytes = record(&folder.path().join("other.take"), 300);
    let mut kept_least = u64::MAX;
    for room in (0..bytes).step_by(bytes as usize / 60).chain([bytes - 1]) {
        let record = || {
            let mut writer = create(&path, room)?;
            for n in 0..300 {
                writer.push(&frame(n))?;
            }
            writer.finish()
        };
        let error = record().unwrap_err();
        let TakeError::Write { kept, ref action, .. } = error else { panic!("{room}: {error}") };
        let text = error.to_string();
        assert!(text.contains("dance.take.part: could not write ") && !error.is_request(), "{text}");
        if kept > 0 {
            assert!(text.contains(&format!("; frames 0 to {} were kept", kept - 1)), "{text}");
            let mut take = TakeReader::open(&part).unwrap();
            assert!(
                matches!(take.condition(), TakeCondition::Cut { frames, .. } if frames == kept),
                "{action}"
            );
            assert!((0..kept).all(|n| take.frame(n).unwrap().wall_frame == n));
            kept_least = kept_least.min(kept);
            fs::remove_file(&part).unwrap();
        } else if part.exists() {
            assert!(matches!(TakeReader::open(&part), Err(TakeError::Empty { .. })), "{room}");
            fs::remove_file(&part).unwrap();
        }
        assert_eq!(TakeReader::open(&path).unwrap().frames(), 7, "the existing take is unchanged");
    }
    assert_eq!(kept_least, 30, "a single chunk is kept too");
    // Negative control: with enough room nothing fails.
    let mut writer = create(&path, bytes).unwrap();
    (0..300).for_each(|n| writer.push(&frame(n)).unwrap());
    assert_eq!(writer.finish().unwrap().frames, 300);
    assert_eq!(TakeReader::open(&path).unwrap().frames(), 300);
}

#[test]
fn a_stopped_take_returns_the_error_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = create(&folder.path().join("dance.take"), 2000).unwrap();
    let failed = (0..100_000).find_map(|n| writer.push(&frame(n)).err()).unwrap();
    assert!(matches!(failed, TakeError::Write { .. }), "{failed}");
    let again = writer.push(&frame(0)).unwrap_err();
    assert!(
        matches!(again, TakeError::Stopped { .. }) && again.to_string().contains("earlier error"),
        "{again}"
    );
    assert!(matches!(writer.finish().unwrap_err(), TakeError::Stopped { .. }));
}

#[cfg(target_os = "linux")]
#[test]
fn the_device_that_is_always_full_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dance.take");
    let full = |_: File| -> Box<dyn Disk> {
        Box::new(fs::OpenOptions::new().write(true).open("/dev/full").unwrap())
    };
    let error = TakeWriter::create_on(&path, header(), &full).err().unwrap();
    assert!(error.to_string().contains("No space left"), "{error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "nothing was recorded, so nothing is left");
}

/// A file in memory.
struct Memory(Vec<u8>);

impl Source for Memory {
    fn read_at(&mut self, offset: u64, buffer: &mut [u8]) -> io::Result<()> {
        let from = usize::try_from(offset).ok().and_then(|offset| self.0.get(offset..)?.get(..buffer.len()));
        buffer.copy_from_slice(from.ok_or(io::ErrorKind::UnexpectedEof)?);
        Ok(())
    }
}

fn open(bytes: &[u8]) -> Result<TakeReader, TakeError> {
    TakeReader::open_source(Path::new("memory.take"), Box::new(Memory(bytes.to_vec())), bytes.len() as u64)
}

#[test]
fn a_take_opens_at_every_length() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("whole.take");
    record(&path, 100);
    let bytes = fs::read(&path).unwrap();
    let mut seen = Vec::new();
    for length in 0..bytes.len() {
        match open(&bytes[..length]) {
            Ok(take) => {
                let frames = take.frames();
                assert!(matches!(take.condition(), TakeCondition::Cut { frames: cut, .. } if cut == frames));
                seen.push(frames);
            }
            Err(error) => assert!(seen.is_empty() && error.is_request(), "{length}: {error}"),
        }
    }
    assert!(open(&bytes).unwrap().condition().is_whole(), "the control");
    assert!(seen.is_sorted());
    seen.dedup();
    assert_eq!(seen, [30, 60, 90, 100]);
}

#[test]
fn every_changed_byte_is_found_and_no_frame_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("whole.take");
    record(&path, 70);
    let mut bytes = fs::read(&path).unwrap();
    let wanted: Vec<TakeFrame> = {
        let mut take = open(&bytes).unwrap();
        (0..70).map(|n| take.frame(n).unwrap()).collect()
    };
    for byte in 0..bytes.len() {
        bytes[byte] ^= 1 << (byte % 8);
        let mut take = open(&bytes).unwrap();
        let played = (0..70).filter(|&n| match take.frame(n) {
            Ok(frame) => {
                assert!(frame == wanted[n as usize], "byte {byte}, frame {n}");
                true
            }
            Err(error) => {
                assert!(matches!(error, TakeError::Lost { .. }), "byte {byte}: {error}");
                false
            }
        });
        assert!(played.count() >= 40, "byte {byte}");
        assert!(!take.verify().unwrap().is_whole(), "byte {byte}");
        bytes[byte] ^= 1 << (byte % 8);
    }
    assert!(open(&bytes).unwrap().verify().unwrap().is_whole(), "the control");
}

/// Counts the reads of a file.
struct Counting {
    file: File,
    reads: Arc<AtomicU64>,
    bytes: Arc<AtomicU64>,
}

impl Source for Counting {
    fn read_at(&mut self, offset: u64, buffer: &mut [u8]) -> io::Result<()> {
        self.reads.fetch_add(1, Ordering::Relaxed);
        self.bytes.fetch_add(buffer.len() as u64, Ordering::Relaxed);
        self.file.read_at(offset, buffer)
    }
}

#[test]
fn ten_minutes_open_without_reading_a_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.take");
    let length = record(&path, 36_000);
    let open = |length: u64| {
        let (reads, bytes) = (Arc::<AtomicU64>::default(), Arc::<AtomicU64>::default());
        let file = File::open(&path).unwrap();
        let source = Counting { file, reads: Arc::clone(&reads), bytes: Arc::clone(&bytes) };
        let take = TakeReader::open_source(&path, Box::new(source), length).unwrap();
        (take, move || (reads.load(Ordering::Relaxed), bytes.load(Ordering::Relaxed)))
    };
    let (mut take, read) = open(length);
    assert_eq!((take.frames(), take.condition()), (36_000, TakeCondition::Whole));
    println!("opened by {} reads of {} bytes", read().0, read().1);
    // Start, trailer, header and index, which has 1200 entries of 72 bytes before compression.
    assert!(read().0 <= 8 && read().1 < 1200 * 72, "{:?}", read());
    // Each frame takes one more read.
    let before = read().0;
    assert_eq!(take.frame(20_000).unwrap().wall_frame, 20_000);
    assert_eq!(read().0, before + 1);
    assert_eq!(take.frame(19_999).unwrap().wall_frame, 19_999);
    assert_eq!(take.frame(19_990).unwrap().wall_frame, 19_990);
    assert!(read().0 <= before + 2, "a cached chunk is not read again");
    // Negative control: without its end every chunk is read.
    let (take, read) = open(length - 1);
    assert!(matches!(take.condition(), TakeCondition::Cut { frames: 36_000, .. }));
    assert!(read().0 > 1200);
}

#[test]
fn a_long_take_does_not_grow_memory_as_it_plays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.take");
    record(&path, 3000);
    let mut take = TakeReader::open(&path).unwrap();
    let chunk = 30 * (GUIDES * POINTS * 12 + 200);
    take.set_cache_bytes(5 * chunk);
    for n in (0..3000).chain((0..3000).rev()) {
        take.frame(n).unwrap();
        assert!(take.cached_bytes() <= 5 * chunk, "frame {n}");
    }
    assert!(take.cached_bytes() > 3 * chunk, "negative control: the cache is used");
}

#[test]
fn ten_minutes_of_a_dragged_slider_stay_small() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dragged.take");
    // A text as long as a project, with a value in its middle that changes at every frame.
    let line = |i: u64| format!("    field_{i}: {},\n", i * 37 % 1000);
    let (head, tail): (String, String) = ((0..200).map(line).collect(), (200..400).map(line).collect());
    let text = |n: u64| format!("(\n{head}    dragged: {},\n{tail})", (n as f64 * 0.37).sin());
    // A minute in the short suite.
    let frames = if lovelock_testkit::suite::is_long() { 36_000 } else { 3600 };
    let write = |change: bool| {
        let mut writer = create(&path, u64::MAX).unwrap();
        for n in 0..frames {
            writer.change(&text(if change { n } else { 0 })).unwrap();
            writer.push(&frame(0)).unwrap();
        }
        writer.finish().unwrap().bytes
    };
    let still = write(false);
    let dragged = write(true);
    let mut take = TakeReader::open(&path).unwrap();
    for n in [0, 1, 29, 30, 31, frames / 2 - 223, frames - 1] {
        assert_eq!(*take.project_at(n).unwrap(), *text(n), "{n}");
    }
    println!(
        "{} bytes per project, {} per frame that changes it",
        text(1).len(),
        (dragged - still) as f64 / frames as f64
    );
    // Measured: 15 bytes per change, of which the digits take 8.
    assert!(dragged - still < frames * 20, "{still} {dragged}");
}
