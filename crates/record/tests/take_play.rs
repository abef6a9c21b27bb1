//! Takes as their users meet them: recorded, finished and played.

use glam::{Affine3A, EulerRot, Quat, Vec3};
use lovelock_groom::{GuideFrame, Guides};
use lovelock_record::{MOST_ERROR_M, TakeFrame, TakeHeader, TakeReader, TakeWriter};
use std::path::Path;

const GUIDES: usize = 12;
const POINTS: usize = 9;
const LINK_M: f32 = 0.02;

fn header() -> TakeHeader {
    TakeHeader {
        guides: GUIDES as u32,
        points_per_guide: POINTS as u32,
        project: "(look: 0)".to_owned(),
        clip: "dance".to_owned(),
        clip_secs: 9.6,
        ..TakeHeader::default()
    }
}

/// Chains that swing below a head that turns and walks.
fn frame(n: u64) -> TakeFrame {
    let t = n as f32 / 60.0;
    let turn = Quat::from_euler(EulerRot::YXZ, (t * 3.0).sin(), 0.3 * (t * 5.0).cos(), 0.1);
    let head = Affine3A::from_rotation_translation(turn, Vec3::new(t.sin(), 1.6, t));
    let mut guides = Guides { points_per_guide: POINTS, ..Guides::default() };
    for g in 0..GUIDES {
        let round = g as f32 * 0.5;
        let mut p = head.transform_point3(0.1 * Vec3::new(round.cos(), 0.5, round.sin()));
        let mut points = vec![p];
        for i in 1..POINTS {
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

fn record(path: &Path, frames: u64) {
    let mut writer = TakeWriter::create(path, header()).unwrap();
    for n in 0..frames {
        if n % 50 == 20 {
            writer.change(&format!("(look: {n})")).unwrap();
        }
        writer.push(&frame(n)).unwrap();
    }
    let report = writer.finish().unwrap();
    assert_eq!(report.frames, frames);
    assert_eq!(report.bytes, std::fs::metadata(path).unwrap().len());
}

fn worst(a: &Guides, b: &Guides) -> f64 {
    assert_eq!(a.points_per_guide, b.points_per_guide);
    (0..a.x.len())
        .map(|i| {
            let at = |g: &Guides| Vec3::new(g.x[i], g.y[i], g.z[i]).as_dvec3();
            at(a).distance(at(b))
        })
        .fold(0.0, f64::max)
}

#[test]
fn a_played_frame_is_the_recorded_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dance.take");
    record(&path, 150);
    let mut take = TakeReader::open(&path).unwrap();
    assert!(take.condition().is_whole());
    assert_eq!((take.frames(), take.header()), (150, &header()));
    let mut seen = 0.0_f64;
    for n in (0..150).chain((0..150).rev()) {
        let (played, wanted) = (take.frame(n).unwrap(), frame(n));
        seen = seen.max(worst(&played.guides.guides, &wanted.guides.guides));
        let but_positions = TakeFrame {
            guides: GuideFrame { guides: wanted.guides.guides.clone(), ..played.guides.clone() },
            ..played
        };
        assert_eq!(but_positions, wanted);
        let step = if n < 20 { 0 } else { (n - 20) / 50 * 50 + 20 };
        assert_eq!(&*take.project_at(n).unwrap(), &format!("(look: {step})"));
    }
    assert!(seen < MOST_ERROR_M, "{seen}");
    // The control: the frame before is another one.
    assert!(worst(&take.frame(10).unwrap().guides.guides, &frame(9).guides.guides) > 20.0 * MOST_ERROR_M);
    assert!(take.verify().unwrap().is_whole());
}
