//! What the operations of strands do to strands of known shape.

use glam::Vec3;
use lovelock_groom::{GroomSettings, Hairstyle, PlainHead, WispCurve, grow};

use crate::{Layer, Operation, apply_layer};

use super::{Clump, Frizz, Strays, Taper, Wander, Width};

/// Hair whose strands follow their guides exactly and have one width.
fn plain() -> Hairstyle {
    let settings = GroomSettings { wisps: 8, strands_per_wisp: 60, length: 0.4, ..GroomSettings::default() };
    let mut style = grow(&settings, &PlainHead.scalp(16), &PlainHead).expect("hair");
    let set = &mut style.strands;
    set.offset_normal.fill(0.0);
    set.offset_binormal.fill(0.0);
    set.offset_tangent.fill(0.0);
    set.taper.fill(1.0);
    style
}

fn applied(style: &Hairstyle, operation: impl Into<Operation>) -> Hairstyle {
    apply_layer(&Layer::of(operation.into()), 1.0, style, &PlainHead).expect("a change")
}

/// The offset of the first and the last point of each strand.
fn ends(style: &Hairstyle) -> Vec<[Vec3; 2]> {
    let set = &style.strands;
    let at = |i: usize| Vec3::new(set.offset_normal[i], set.offset_binormal[i], set.offset_tangent[i]);
    set.first_point.windows(2).map(|w| [at(w[0] as usize), at(w[1] as usize - 1)]).collect()
}

/// Root mean square distance of tips from the mean of their wisp, across the hair.
fn spread(style: &Hairstyle) -> f32 {
    let set = &style.strands;
    let (mut sum, mut count) = (0.0, 0.0);
    for wisp in &style.wisps {
        let curve = WispCurve::at_rest(&style.guides, wisp);
        let strands = wisp.first_strand as usize..(wisp.first_strand + wisp.strand_count) as usize;
        let places: Vec<Vec3> = strands
            .map(|s| {
                let range = set.first_point[s] as usize..set.first_point[s + 1] as usize;
                let i = range.end - 1;
                let offset = Vec3::new(set.offset_normal[i], set.offset_binormal[i], set.offset_tangent[i]);
                let u = set.guide_param[i];
                // Without the part along the hair, because strands end at different lengths.
                let frame = curve.frame(u);
                let across =
                    frame.transpose() * (curve.blend(set.weights[s], u) - curve.blend([1.0 / 3.0; 3], u));
                (across + offset) * Vec3::new(1.0, 1.0, 0.0)
            })
            .collect();
        let mean = places.iter().sum::<Vec3>() / places.len() as f32;
        sum += places.iter().map(|p| p.distance_squared(mean)).sum::<f32>();
        count += places.len() as f32;
    }
    (sum / count).sqrt()
}

#[test]
fn clumps_narrow_wisps_toward_tips_and_keep_roots() {
    let style = plain();
    let before = spread(&style);
    let of = |level| applied(&style, Clump { amount: 1.0, level, ..Clump::default() });
    let (whole, parts, smaller) = (spread(&of(1)), spread(&of(2)), spread(&of(3)));
    println!("{before} {whole} {parts} {smaller}");
    assert!(whole < 0.1 * before, "{whole} of {before}");
    assert!(whole < 0.5 * parts && parts < 1.2 * before);
    assert!(ends(&of(2)).iter().all(|[root, _]| root.length() < 1e-6));
    assert_ne!(ends(&of(2)), ends(&of(3)));
}

#[test]
fn frizz_bends_within_its_amplitude() {
    let style = plain();
    let made = applied(&style, Frizz { amplitude: 0.002, wavelength: 0.02 });
    assert!(made.strands.points() > style.strands.points());
    let highest = made.strands.offset_normal.iter().fold(0.0, |a: f32, b| a.max(b.abs()));
    assert!(highest > 0.001 && highest <= 0.0028, "{highest}");
    assert!(ends(&made).iter().all(|[root, _]| root.length() < 1e-6));
}

#[test]
fn a_share_of_strands_strays_within_reach() {
    let style = plain();
    let made = ends(&applied(&style, Strays { share: 0.25, reach: 0.03 }));
    let strays = made.iter().filter(|[_, tip]| tip.length() > 0.0).count() as f32 / made.len() as f32;
    assert!((strays - 0.25).abs() < 0.07, "{strays}");
    assert!(made.iter().all(|[root, tip]| root.length() == 0.0 && tip.length() <= 0.0301));
}

#[test]
fn strands_wander_within_the_distance() {
    let style = plain();
    let made = ends(&applied(&style, Wander { distance: 0.01, wavelength: 0.2 }));
    let furthest = made.iter().map(|[_, tip]| tip.length()).fold(0.0, f32::max);
    assert!(furthest > 0.008 && furthest < 0.0142, "{furthest}");
    assert!(made.iter().all(|[root, _]| root.length() < 1e-6));
}

#[test]
fn widths_follow_factor_and_tips_thin() {
    let style = plain();
    assert!(applied(&style, Width { factor: 0.5 }).strands.taper.iter().all(|w| (w - 0.5).abs() < 1e-6));
    let made = applied(&style, Taper { fraction: 0.5, tip: 0.2 }).strands;
    for points in made.first_point.windows(2) {
        let widths = &made.taper[points[0] as usize..points[1] as usize];
        assert!((widths[0] - 1.0).abs() < 1e-6 && (widths[widths.len() - 1] - 0.2).abs() < 1e-5);
        assert!((widths[widths.len() / 3] - 1.0).abs() < 1e-6, "the half at the root keeps its width");
    }
}
