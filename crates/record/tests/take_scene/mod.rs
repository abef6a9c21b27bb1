//! A scene for the tests of takes: chains that swing below a turning and walking head.
#![allow(dead_code, missing_docs, reason = "each test uses a part of it")]

use glam::{Affine3A, EulerRot, Quat, Vec3};
use lovelock_groom::{GuideFrame, Guides};
use lovelock_record::{TakeFrame, TakeHeader, TakeReader, TakeWriter};
use std::path::Path;

pub const LINK_M: f32 = 0.02;

/// Number of chains and of points per chain.
#[derive(Clone, Copy)]
pub struct Size(pub usize, pub usize);

/// A size that is small enough to be read thousands of times.
pub const SMALL: Size = Size(3, 4);

pub fn header(Size(guides, points): Size) -> TakeHeader {
    TakeHeader {
        guides: guides as u32,
        points_per_guide: points as u32,
        project: "(look: 0)".to_owned(),
        clip: "dance".to_owned(),
        clip_secs: 9.6,
        ..TakeHeader::default()
    }
}

/// Frame `n` of the motion.
pub fn frame(n: u64, Size(count, points_per_guide): Size) -> TakeFrame {
    let t = n as f32 / 60.0;
    let turn = Quat::from_euler(EulerRot::YXZ, (t * 3.0).sin(), 0.3 * (t * 5.0).cos(), 0.1);
    let head = Affine3A::from_rotation_translation(turn, Vec3::new(t.sin(), 1.6, t));
    let mut guides = Guides { points_per_guide, ..Guides::default() };
    for g in 0..count {
        let round = g as f32 * 0.5;
        let mut p = head.transform_point3(0.1 * Vec3::new(round.cos(), 0.5, round.sin()));
        let mut points = vec![p];
        for i in 1..points_per_guide {
            let swing = 0.4 * (t * 4.0 + round + i as f32 * 0.3).sin();
            p += LINK_M * Vec3::new(swing.sin(), -swing.cos(), 0.0);
            points.push(p);
        }
        guides.push(&points);
    }
    TakeFrame {
        guides: GuideFrame { time_secs: 100.0 + f64::from(t), world_from_head: head, guides },
        clip_secs: (n as f64 / 60.0) % 9.6,
        wall_frame: 7 + n,
        substeps: 4 + (n % 3) as u32,
        jumped: n == 90,
    }
}

/// The project's text at a frame.
pub fn project(n: u64) -> String {
    if n < 20 { "(look: 0)".to_owned() } else { format!("(look: {})", (n - 20) / 50 * 50 + 20) }
}

/// Records a take of `frames` frames and finishes it.
pub fn record(path: &Path, frames: u64, size: Size) {
    let mut writer = TakeWriter::create(path, header(size)).unwrap();
    for n in 0..frames {
        writer.change(&project(n)).unwrap();
        writer.push(&frame(n, size)).unwrap();
    }
    let report = writer.finish().unwrap();
    assert_eq!(report.frames, frames);
    assert_eq!(report.bytes, std::fs::metadata(path).unwrap().len());
}

/// The size of each frame in a take whose number of guides changes twice.
pub fn regrown_size(n: u64) -> Size {
    match n {
        40..75 => Size(5, 6),
        75.. => Size(2, 9),
        _ => SMALL,
    }
}

/// Records a take of `frames` frames of [`regrown_size`] and finishes it.
pub fn record_regrown(path: &Path, frames: u64) {
    let mut writer = TakeWriter::create(path, header(SMALL)).unwrap();
    for n in 0..frames {
        let size = regrown_size(n);
        writer.set_layout(size.0, size.1).unwrap();
        writer.change(&project(n)).unwrap();
        writer.push(&frame(n, size)).unwrap();
    }
    assert_eq!(writer.finish().unwrap().frames, frames);
}

/// The largest distance between corresponding points, in metres.
pub fn worst(a: &Guides, b: &Guides) -> f64 {
    assert_eq!((a.points_per_guide, a.x.len()), (b.points_per_guide, b.x.len()));
    let at = |g: &Guides, i: usize| Vec3::new(g.x[i], g.y[i], g.z[i]).as_dvec3();
    (0..a.x.len()).map(|i| at(a, i).distance(at(b, i))).fold(0.0, f64::max)
}

/// Whether a played frame is frame `n`: positions to within the stated error, everything else exactly.
pub fn is_frame(played: &TakeFrame, n: u64, size: Size) -> bool {
    let wanted = frame(n, size);
    let but_positions = TakeFrame {
        guides: GuideFrame { guides: wanted.guides.guides.clone(), ..played.guides.clone() },
        ..*played
    };
    but_positions == wanted
        && worst(&played.guides.guides, &wanted.guides.guides) < lovelock_record::MAX_ERROR_M
}

/// Plays every frame of a take without lost frames. Returns their number.
pub fn play_all(take: &mut TakeReader, size: Size) -> u64 {
    for n in 0..take.frames() {
        assert!(is_frame(&take.frame(n).unwrap(), n, size), "frame {n}");
        assert_eq!(*take.project_at(n).unwrap(), *project(n), "frame {n}");
    }
    take.frames()
}

/// A chunk as described in `docs/file_formats.md`.
#[derive(Debug)]
pub struct Chunk {
    pub start: usize,
    pub end: usize,
    pub kind: [u8; 4],
    pub first: u64,
    pub frames: u64,
}

/// The chunks of an intact take.
pub fn chunks(bytes: &[u8]) -> Vec<Chunk> {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let mut chunks = Vec::new();
    let mut at = 0;
    while bytes[at..].starts_with(b"\x9ALTAKE\r\n") {
        let end = at + 64 + word(at + 32) as usize + word(at + 44) as usize;
        chunks.push(Chunk {
            start: at,
            end,
            kind: bytes[at + 8..at + 12].try_into().unwrap(),
            first: u64::from(word(at + 16)),
            frames: u64::from(word(at + 24)),
        });
        at = end;
    }
    assert_eq!(bytes.len() - at, 40, "the trailer");
    chunks
}

/// Random numbers from a seed.
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % bound
    }
}
