//! Reads takes independently of the crate, as described in `docs/file_formats.md`.

use crate::take_scene;

use lovelock_record::TakeReader;
use std::fs;
use std::path::Path;
use take_scene::{Chunk, Size, chunks, frame, play_all, project, record, regrown_size, worst};

const SIZE: Size = Size(9, 7);

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn long_word(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap())
}

/// The text and the data part of a chunk.
fn parts(file: &[u8], chunk: &Chunk) -> [Vec<u8>; 2] {
    let header = &file[chunk.start..chunk.start + 64];
    assert_eq!(word(header, 12), 2, "the version");
    assert_eq!(word(header, 60), crc32fast::hash(&header[..60]));
    let mut at = chunk.start + 64;
    [32, 44].map(|part| {
        let [stored, raw, crc] = [0, 4, 8].map(|word_at| word(header, part + word_at));
        let packed = &file[at..at + stored as usize];
        at += stored as usize;
        assert_eq!(crc32fast::hash(packed), crc);
        let unpacked = if stored > 0 { zstd::decode_all(packed).unwrap() } else { Vec::new() };
        assert_eq!(unpacked.len(), raw as usize);
        unpacked
    })
}

/// The positions in a chunk's data part after its first eight bytes, in steps of 0.05 mm. Their index is
/// `((point * frames + frame) * 3 + axis) * guides + guide`.
fn positions(data: &[u8], frames: usize, Size(guides, points): Size) -> Vec<i32> {
    let coefficients = &data[80 * frames..][..12 * points];
    let coefficient = |p: usize, i: usize| {
        let at = (p * 6 + i) * 2;
        i32::from(i16::from_le_bytes([coefficients[at], coefficients[at + 1]]))
    };
    let numbers = &data[80 * frames + 12 * points..];
    let count = points * frames * 3 * guides;
    let mut rest = numbers[count..].iter();
    let mut links = vec![0_i32; count];
    for (at, &byte) in numbers[..count].iter().enumerate() {
        let residual = if byte == 255 {
            let mut value = 0_u32;
            for shift in (0..).step_by(7) {
                let next = u32::from(*rest.next().unwrap());
                value |= (next & 127) << shift;
                if next < 128 {
                    break;
                }
            }
            255 + value
        } else {
            u32::from(byte)
        };
        let e = if residual.is_multiple_of(2) { (residual / 2) as i32 } else { -((residual / 2) as i32) - 1 };
        let (guide, axis) = (at % guides, at / guides % 3);
        let (f, p) = ((at / guides / 3 % frames) as i64, (at / guides / 3 / frames) as i64);
        let d = |p: i64, f: i64| {
            let known = p >= 0 && f >= 0;
            if known { links[((p as usize * frames + f as usize) * 3 + axis) * guides + guide] } else { 0 }
        };
        let s = |p, f| d(p, f).wrapping_sub(d(p, f - 1));
        let c = match f {
            0 => [0, 0, 4096, 0, 0, 0],
            1 => [4096, 0, 4096, 0, 0, 0],
            2 => [8192, -4096, 4096, -4096, 0, 0],
            _ => [0, 1, 2, 3, 4, 5].map(|i| coefficient(p as usize, i)),
        };
        let taps = [d(p, f - 1), d(p, f - 2), s(p - 1, f), s(p - 1, f - 1), d(p, f - 3), s(p - 2, f)];
        let sum = (0..6).fold(2048_i32, |sum, i| sum.wrapping_add(c[i].wrapping_mul(taps[i])));
        links[at] = (sum >> 12).wrapping_add(e);
    }
    assert_eq!(rest.next(), None);
    let point = frames * 3 * guides;
    for at in point..count {
        links[at] += links[at - point];
    }
    links
}

#[test]
fn the_documented_layout_is_enough_to_read_a_take() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dance.take");
    record(&path, 130, SIZE);
    let file = fs::read(&path).unwrap();
    let all = chunks(&file);
    let kinds: Vec<&str> = all.iter().map(|chunk| std::str::from_utf8(&chunk.kind).unwrap()).collect();
    assert_eq!(kinds, ["HEAD", "HEAD", "FRMS", "FRMS", "FRMS", "FRMS", "FRMS", "HEAD", "INDX"]);

    let [head, none] = parts(&file, &all[0]);
    assert!(none.is_empty() && file[..all[0].end] == file[all[1].start..all[1].end]);
    let header: serde_json::Value = serde_json::from_slice(&head).unwrap();
    assert_eq!((&header["guides"], &header["points_per_guide"]), (&9.into(), &7.into()));
    assert_eq!((&header["frames_per_second"]["num"], &header["project"]), (&60.into(), &"(look: 0)".into()));
    let take = crc32fast::hash(&head);

    let mut reader = TakeReader::open(&path).unwrap();
    let mut seen = 0;
    for chunk in &all[2..7] {
        assert_eq!((chunk.first, word(&file, chunk.start + 56)), (seen, take));
        let [text, data] = parts(&file, chunk);
        assert_eq!((word(&data, 0), word(&data, 4)), (9, 7), "guides and points per guide");
        let data = &data[8..];
        let length = word(&text, 0) as usize;
        let mut now = text[4..4 + length].to_vec();
        let mut changes = &text[4 + length..];
        let frames = chunk.frames as usize;
        let steps = positions(data, frames, SIZE);
        for f in 0..frames {
            let n = chunk.first + f as u64;
            if !changes.is_empty() && word(changes, 0) as usize == f {
                let [before, after, middle] = [4, 8, 12].map(|at| word(changes, at) as usize);
                now.splice(before..now.len() - after, changes[16..16 + middle].iter().copied());
                changes = &changes[16 + middle..];
            }
            assert_eq!(std::str::from_utf8(&now).unwrap(), project(n));
            let meta = &data[80 * f..][..80];
            let wanted = frame(n, SIZE);
            assert_eq!(f64::from_bits(long_word(meta, 0)), wanted.guides.time_secs);
            assert_eq!(f64::from_bits(long_word(meta, 8)), wanted.clip_secs);
            assert_eq!(long_word(meta, 16), wanted.wall_frame);
            assert_eq!((word(meta, 24), word(meta, 28) == 1), (wanted.substeps, wanted.jumped));
            let m: Vec<f64> = (0..12).map(|i| f64::from(f32::from_bits(word(meta, 32 + 4 * i)))).collect();
            let played = reader.frame(n).unwrap().guides.guides;
            for guide in 0..SIZE.0 {
                for point in 0..SIZE.1 {
                    let h = [0, 1, 2].map(|axis| {
                        5e-5 * f64::from(steps[((point * frames + f) * 3 + axis) * SIZE.0 + guide])
                    });
                    let world = [0, 1, 2].map(|r| m[r] * h[0] + m[3 + r] * h[1] + m[6 + r] * h[2] + m[9 + r]);
                    let found = played.point(guide, point).to_array();
                    // Single precision at 2 m: 1.2e-7.
                    assert!((0..3).all(|r| (world[r] - f64::from(found[r])).abs() < 2e-7), "frame {n}");
                }
            }
        }
        assert!(changes.is_empty());
        // Negative control: the coefficients matter.
        let mut other = data.to_vec();
        other[80 * frames + 12 * 3] ^= 128;
        assert_ne!(positions(&other, frames, SIZE), steps);
        seen += chunk.frames;
    }
    assert_eq!(seen, 130);

    let index = parts(&file, &all[8])[1].clone();
    for (entry, chunk) in index.chunks_exact(72).zip(&all[2..7]) {
        assert_eq!(long_word(entry, 0), chunk.start as u64);
        assert_eq!(entry[8..], file[chunk.start..chunk.start + 64]);
    }
    let trailer = &file[file.len() - 40..];
    assert_eq!(trailer[..8], *b"\x9ALTEND\r\n");
    assert_eq!([8, 16, 24].map(|at| long_word(trailer, at)), [all[7].start as u64, all[8].start as u64, 130]);
    assert_eq!((word(trailer, 32), word(trailer, 36)), (take, crc32fast::hash(&trailer[..36])));
}

#[test]
fn takes_of_older_versions_still_play() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    for (name, version, frames) in [("version_1.take", 1, 70), ("version_2.take", 2, 100)] {
        let mut take = TakeReader::open(&data.join(name)).unwrap();
        assert!(take.verify().unwrap().is_whole());
        assert_eq!((take.frames(), take.header().version), (frames, version));
        let size = |n| if version == 1 { take_scene::SMALL } else { regrown_size(n) };
        for n in 0..frames {
            let played = take.frame(n).unwrap();
            // Sines differ between systems in the last place.
            assert!(worst(&played.guides.guides, &frame(n, size(n)).guides.guides) < 6e-5, "frame {n}");
            assert_eq!(*take.project_at(n).unwrap(), *project(n));
        }
        assert_eq!(take.layouts().unwrap().len(), if version == 1 { 1 } else { 3 });
    }
    // Control: a take of the present version passes the same test.
    let folder = tempfile::tempdir().unwrap();
    let new = folder.path().join("new.take");
    record(&new, 70, take_scene::SMALL);
    assert_eq!(play_all(&mut TakeReader::open(&new).unwrap(), take_scene::SMALL), 70);
}
