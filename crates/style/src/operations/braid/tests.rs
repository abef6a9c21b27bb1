use glam::{Vec2, Vec3};
use lovelock_groom::{GroomSettings, HairTie, PlainHead, grow, tied};

use super::*;
use crate::operations::testing::{acted, places, straight};

fn weave(braid: &Braid) -> Weave {
    Weave::new(braid, 0.5)
}

#[test]
fn bundles_cross_three_times_on_each_side_in_a_period_and_come_back() {
    let braid = Braid { taper: 0.0, ..Braid::default() };
    let weave = weave(&braid);
    let period = 3.0 * braid.pitch;
    let steps = 3000;
    let place = |bundle, n: usize| weave.middle(bundle, period * n as f32 / steps as f32).0;
    // The bundles are the same path, a third of a period apart.
    for n in (0..steps).step_by(100) {
        assert!(place(1, n).distance(place(0, n + steps / 3)) < 1e-5);
        assert!(place(0, n).distance(place(0, n + steps)) < 1e-5);
    }
    let (mut over, mut crossings) = (Vec::new(), [0, 0]);
    for (a, b) in [(0, 1), (1, 2), (2, 0)] {
        for n in 0..steps {
            let apart = |n| place(a, n).x - place(b, n).x;
            if apart(n) < 0.0 && apart(n + 1) >= 0.0 || apart(n) > 0.0 && apart(n + 1) <= 0.0 {
                let (p, q) = (place(a, n), place(b, n));
                crossings[usize::from(p.x > 0.0)] += 1;
                over.push((p.y - q.y).abs());
            }
        }
    }
    assert_eq!(crossings, [3, 3], "three on each side");
    // sin(2 p) of two bundles that cross is +-sqrt(3) / 2.
    let apart = 3.0_f32.sqrt() * 1.3 * braid.width / 6.0;
    assert!(over.iter().all(|y| (y - apart).abs() < 0.02 * apart), "{over:?} {apart}");
}

#[test]
fn bundles_touch_and_overlap_by_less_than_a_fifth() {
    for pitch in [0.65, 0.8, 1.0] {
        let braid = Braid { pitch: pitch * 0.03, taper: 0.0, ..Braid::default() };
        let weave = weave(&braid);
        let period = 3.0 * braid.pitch;
        let path = |bundle, n: usize| {
            let s = period * n as f32 / 300.0;
            weave.middle(bundle, s).0.extend(s)
        };
        let nearest = |p: Vec3| (0..900).map(|n| p.distance(path(1, n))).fold(f32::MAX, f32::min);
        let closest = (300..600).map(|n| nearest(path(0, n))).fold(f32::MAX, f32::min);
        let thick = 2.0 * weave.radius(0.0);
        assert!(closest > 0.78 * thick && closest < 1.05 * thick, "pitch {pitch}: {}", closest / thick);
    }
}

#[test]
fn a_strand_swings_from_side_to_side_three_pitches_apart() {
    let before = straight(Vec3::NEG_Y);
    // Straight hair of the whole head cannot gather: each wisp makes a braid of its own.
    let braid = Braid {
        count: 1000,
        width: 0.008,
        pitch: 0.01,
        tightness: 1.0,
        flyaways: 0.0,
        taper: 0.0,
        ..Braid::default()
    };
    let after = acted(braid.clone(), &before);
    after.check().expect("sound");
    let mut found = [0; 3];
    for (w, wisp) in after.wisps.iter().enumerate() {
        let guide =
            |i: usize| wisp.guides.map(|g| after.guides.point(g as usize, i)).iter().sum::<Vec3>() / 3.0;
        let middle = guide(20);
        // The guides themselves hang straight and keep their length.
        assert!((guide(10) - guide(20)).with_y(0.0).length() < 0.001, "wisp {w}");
        for g in wisp.guides {
            let length: f32 = (1..31)
                .map(|i| after.guides.point(g as usize, i).distance(after.guides.point(g as usize, i - 1)))
                .sum();
            assert!((length - 0.31).abs() < 1e-3, "wisp {w}: {length}");
        }
        for (n, strand) in (wisp.first_strand..wisp.first_strand + wisp.strand_count).enumerate() {
            let points = places(&after, strand as usize);
            let (low, high) = (middle.y - 0.03, middle.y + 0.03);
            let part: Vec<Vec3> = points.iter().copied().filter(|p| p.y > low && p.y < high).collect();
            assert!(part.len() >= 30, "{} points", part.len());
            // Strands of one bundle are in step: the widest part of a strand's path is the width of the braid.
            let flat = |p: Vec3| Vec2::new(p.x - middle.x, p.z - middle.z);
            let widest = part.iter().map(|p| flat(*p).length()).fold(0.0, f32::max);
            assert!(widest < 0.55 * braid.width && widest > 0.2 * braid.width, "{widest}");
            // Two periods of three pitches: the path comes back to where it was.
            let at = |y: f32| {
                let i =
                    part.windows(2).position(|pair| pair[0].y >= y && pair[1].y < y).expect("in the part");
                let t = (part[i].y - y) / (part[i].y - part[i + 1].y);
                flat(part[i].lerp(part[i + 1], t))
            };
            let (a, b, c) = (at(middle.y + 0.028), at(middle.y - 0.002), at(middle.y + 0.013));
            assert!(a.distance(b) < 0.25 * braid.width, "strand {strand}: {a} {b}");
            if a.distance(c) > 0.2 * braid.width {
                found[n % 3] += 1;
            }
        }
    }
    assert!(found.iter().all(|n| *n > 0), "half a period further, strands are elsewhere: {found:?}");
}

#[test]
fn tied_hair_makes_one_braid_for_each_tie_and_loose_hair_stays() {
    let settings = GroomSettings { wisps: 60, strands_per_wisp: 4, length: 0.6, ..GroomSettings::default() };
    let style = grow(&settings, &PlainHead.scalp(16), &PlainHead).expect("hair");
    let side = |x: f32| HairTie {
        at: Vec3::new(0.07 * x, 0.08, -0.05),
        axis: Vec3::new(x, -0.5, -0.3),
        reach: lovelock_groom::TieReach::AbovePlane,
        plane_point: Vec3::new(0.02 * x, 0.0, 0.0),
        plane_normal: Vec3::new(x, 0.0, 0.0),
        ..HairTie::default()
    };
    let before = tied(&style, &[side(1.0), side(-1.0)], &PlainHead);
    assert_eq!(before.ropes.len(), 2);
    let after = acted(Braid::default(), &before);
    after.check().expect("sound");
    assert_eq!(after.ropes.len(), 2);
    let mut held = vec![false; after.guides.count()];
    for rope in &before.ropes {
        rope.guides.iter().for_each(|(g, _)| held[*g as usize] = true);
    }
    let same = |g: usize| (0..31).all(|i| before.guides.point(g, i) == after.guides.point(g, i));
    assert!((0..held.len()).filter(|g| !held[*g]).count() > 6, "some hair is loose");
    assert!((0..held.len()).all(|g| held[g] || same(g)), "loose hair stays");
    // The guides of a rope lie on one line beyond its start.
    for rope in &after.ropes {
        let end = |n: usize| {
            let (g, first) = rope.guides[n];
            (first..30).map(|i| after.guides.point(g as usize, i as usize)).collect::<Vec<Vec3>>()
        };
        let length = |points: &[Vec3]| points.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f32>();
        let lines: Vec<Vec<Vec3>> = (0..rope.guides.len()).map(end).collect();
        let line = lines.iter().max_by(|a, b| length(a).total_cmp(&length(b))).expect("a guide");
        for (n, points) in lines.iter().enumerate() {
            // Chords of the longest guide, of which some guides reach past the end.
            let away = |p: Vec3| {
                let last = line.len() - 2;
                let to = |(k, pair): (usize, &[Vec3])| {
                    let along = (pair[1] - pair[0]).normalize_or_zero();
                    let past = if k == last { 0.1 } else { 0.0 };
                    let before = if k == 0 { 0.03 } else { 0.0 };
                    let at = (p - pair[0]).dot(along).clamp(-before, pair[0].distance(pair[1]) + past);
                    p.distance(pair[0] + along * at)
                };
                line.windows(2).enumerate().map(to).fold(f32::MAX, f32::min)
            };
            // Chords of a bent line leave it by some millimetres.
            let furthest = points.iter().skip(1).map(|p| away(*p)).fold(0.0, f32::max);
            assert!(furthest < 0.004, "guide {n}: {furthest}");
        }
    }
}
