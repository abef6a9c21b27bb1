use glam::{Affine3A, Vec3};
use lovelock_base::settings::Settings;

use super::*;
use crate::{GroomSettings, GuideFrame, PlainHead, Preset, Scalp, Strands, grow, interpolate};

fn long() -> Hairstyle {
    let settings = GroomSettings { wisps: 60, strands_per_wisp: 6, ..GroomSettings::preset(Preset::Long) };
    grow(&settings, &PlainHead.scalp(32), &PlainHead).expect("it grows")
}

fn lengths(style: &Hairstyle) -> Vec<f32> {
    let n = style.guides.points_per_guide;
    (0..style.guides.count())
        .flat_map(|g| (1..n).map(move |i| (g, i)))
        .map(|(g, i)| style.guides.point(g, i).distance(style.guides.point(g, i - 1)))
        .collect()
}

/// Where the guides of gathered wisps cross the plane of the ring from the head's side, as distances from its axis.
fn crossings(style: &Hairstyle, tie: &HairTie) -> Vec<f32> {
    let ring = Ring::new(tie, &PlainHead, 0.6);
    let n = style.guides.points_per_guide;
    let mut out = Vec::new();
    for g in 0..style.guides.count() {
        let Some(i) = (1..n).find(|i| style.held[g * n + i] >= RING_HOLD) else { continue };
        // The ring is crossed between the two points that it holds.
        let (a, b) = (style.guides.point(g, i), style.guides.point(g, (i + 1).min(n - 1)));
        let nearest = (0..=20).map(|t| {
            let from = a.lerp(b, t as f32 / 20.0) - ring.centre;
            (from - ring.axis * from.dot(ring.axis)).length()
        });
        out.push(nearest.fold(f32::MAX, f32::min));
    }
    out
}

#[test]
fn a_tied_style_keeps_lengths_and_roots_and_stays_out_of_the_head() {
    let style = long();
    for kind in [TieKind::Ponytail, TieKind::Bun] {
        let tie = HairTie { kind, ..HairTie::default() };
        let tied = tied(&style, &[tie], &PlainHead);
        tied.check().expect("sound");
        // At rest no strand is drawn narrower than its guides lie.
        let at_rest = GuideFrame::at_rest(&tied.guides, Affine3A::IDENTITY, 0.0);
        let drawn = |style: &Hairstyle| {
            let mut strands = Strands::default();
            interpolate(style, &at_rest, &mut strands);
            [strands.x, strands.y, strands.z]
        };
        assert!(drawn(&tied) == drawn(&Hairstyle { widest: Vec::new(), ..tied.clone() }), "{kind:?}");
        // Hair beyond a ring is a rope; all of a bun is held in its place.
        let in_ropes = tied.ropes.iter().flat_map(|rope| &rope.guides).count();
        let in_rings = crossings(&tied, &tie).len();
        assert_eq!(in_ropes, if kind == TieKind::Ponytail { in_rings } else { 0 }, "{kind:?}");
        for (a, b) in lengths(&style).iter().zip(lengths(&tied)) {
            // Positions of half a metre in f32, and links of 1 cm.
            assert!((a - b).abs() < 1e-6, "{a} became {b}");
        }
        let n = style.guides.points_per_guide;
        let mut deepest = 0.0_f32;
        for g in 0..style.guides.count() {
            assert_eq!(style.guides.point(g, 0), tied.guides.point(g, 0));
            for i in 1..n {
                deepest = deepest.min(PlainHead.distance(tied.guides.point(g, i)).0);
            }
        }
        // The plain head's distance is a first-order estimate; points are pushed out in eight rounds.
        assert!(deepest > -0.002, "{kind:?}: {deepest}");
        // Strands leave the scalp at the same points as before.
        let roots = |style: &Hairstyle| -> Vec<Vec3> {
            style
                .wisps
                .iter()
                .flat_map(|w| {
                    let curve = crate::WispCurve::at_rest(&style.guides, w);
                    (w.first_strand..w.first_strand + w.strand_count).map(move |s| {
                        let i = style.strands.first_point[s as usize] as usize;
                        let set = &style.strands;
                        let o =
                            Vec3::new(set.offset_normal[i], set.offset_binormal[i], set.offset_tangent[i]);
                        curve.point(set.weights[s as usize], set.guide_param[i], o)
                    })
                })
                .collect()
        };
        for (a, b) in roots(&style).iter().zip(roots(&tied)) {
            assert!((*a - b).length() < 1e-5);
        }
    }
}

#[test]
fn hair_passes_through_the_ring() {
    let style = long();
    let tie = HairTie::default();
    let tied = tied(&style, &[tie], &PlainHead);
    let crossings = crossings(&tied, &tie);
    assert!(crossings.len() > style.guides.count() * 9 / 10, "only {} are gathered", crossings.len());
    // The discs of the wisps in the ring are 0.2 of its width.
    let outside = crossings.iter().filter(|d| **d > 1.15 * tie.radius).count();
    assert!(outside == 0, "{outside} of {} pass beside it: {crossings:?}", crossings.len());
}

#[test]
fn reach_selects_what_is_gathered_and_the_rest_stays() {
    let style = long();
    let n = style.guides.points_per_guide;
    let all = tied(&style, &[HairTie::default()], &PlainHead);
    let half = HairTie { reach: TieReach::AbovePlane, plane_point: Vec3::Y * 0.13, ..HairTie::default() };
    let half = tied(&style, &[half], &PlainHead);
    let count = |s: &Hairstyle| (0..s.guides.count()).filter(|g| s.held[g * n + 1] >= 0.0).count();
    assert!(count(&half) > 30 && count(&half) < count(&all) - 30, "{} of {}", count(&half), count(&all));
    // What even a tie of all hair leaves out is too short.
    for g in (0..style.guides.count()).filter(|g| half.held[g * n + 1] < 0.0 && all.held[g * n + 1] >= 0.0) {
        assert_eq!(style.guides.point(g, n - 1), half.guides.point(g, n - 1));
    }
    let none = HairTie {
        reach: TieReach::InSphere,
        sphere_at_ring: false,
        sphere_centre: Vec3::ONE * 0.5,
        ..HairTie::default()
    };
    assert_eq!(tied(&style, &[none], &PlainHead).guides, style.guides);
    // With a sphere around the ring, the unused centre has no effect.
    let near = HairTie { sphere_at_ring: true, sphere_radius: 0.07, ..none };
    let near = tied(&style, &[near], &PlainHead);
    assert!(count(&near) > 10 && count(&near) < count(&all) - 30, "{} of {}", count(&near), count(&all));
    for g in (0..style.guides.count()).filter(|g| near.held[g * n + 1] >= 0.0) {
        let root = style.guides.point(g, 0);
        // Wisps are gathered by the mean of their three roots.
        assert!(root.distance(HairTie::default().at) < 0.07 + 0.03, "{root}");
    }
}

#[test]
fn two_ties_share_the_hair_and_short_hair_stays_free() {
    let style = long();
    let plait = |side: f32| HairTie {
        at: Vec3::new(0.07 * side, 0.06, -0.07),
        axis: Vec3::new(side, -0.3, -0.5),
        reach: TieReach::InSphere,
        sphere_at_ring: false,
        sphere_centre: Vec3::new(0.1 * side, 0.1, 0.0),
        sphere_radius: 0.13,
        ..HairTie::default()
    };
    let two = tied(&style, &[plait(1.0), plait(-1.0)], &PlainHead);
    let n = style.guides.points_per_guide;
    let tips = |sign: f32| {
        (0..style.guides.count())
            .filter(|g| two.held[g * n + 1] >= 0.0 && sign * two.guides.point(*g, n - 1).x > 0.02)
            .count()
    };
    assert!(tips(1.0) > 30 && tips(-1.0) > 30, "{} and {}", tips(1.0), tips(-1.0));
    let short = grow(
        &GroomSettings { wisps: 60, length: 0.04, ..GroomSettings::default() },
        &PlainHead.scalp(32),
        &PlainHead,
    )
    .expect("it grows");
    let tied = tied(&short, &[HairTie::default()], &PlainHead);
    assert!(tied.held.iter().filter(|h| **h >= 0.0).count() < tied.held.len() / 10);
}

#[test]
fn a_tie_and_its_mirror_image_divide_the_hair_at_the_plane() {
    let style = long();
    let left = HairTie {
        at: Vec3::new(0.08, 0.1, -0.03),
        axis: Vec3::new(1.0, 0.2, -0.3),
        reach: TieReach::AbovePlane,
        plane_point: Vec3::ZERO,
        plane_normal: Vec3::X,
        ..HairTie::default()
    };
    let right = left.mirrored();
    assert_eq!((right.at.x, right.axis.x, right.plane_normal), (-0.08, -1.0, Vec3::NEG_X));
    assert_eq!(right.mirrored(), left);
    let two = tied(&style, &[left, right], &PlainHead);
    let n = style.guides.points_per_guide;
    let (mut sides, mut crossed) = ([0_usize; 2], 0);
    for wisp in &style.wisps {
        let root = wisp.guides.iter().map(|&g| style.guides.point(g as usize, 0)).sum::<Vec3>() / 3.0;
        for &g in wisp.guides.iter().filter(|&&g| two.held[g as usize * n + 1] >= 0.0) {
            let ring = (1..n).find(|&i| two.held[g as usize * n + i] >= RING_HOLD).expect("a ring");
            sides[usize::from(root.x < 0.0)] += 1;
            crossed += usize::from(two.guides.point(g as usize, ring).x * root.x < 0.0);
        }
    }
    assert!(sides.iter().all(|&side| side > 50) && crossed == 0, "{sides:?}, {crossed} on the wrong side");
}

#[test]
fn a_patch_in_an_old_file_is_read_with_defaults() {
    let old: HairTie =
        serde_json::from_str(r#"{"reach":"InSphere","sphere_centre":[0.1,0.2,0.0]}"#).expect("a tie");
    assert_eq!(old.sphere_middle(), Vec3::new(0.1, 0.2, 0.0));
    assert_eq!(HairTie::default().sphere_middle(), HairTie::default().at);
}

#[test]
fn invalid_ties_give_hair_that_can_be_drawn() {
    let style = long();
    let bad = HairTie {
        at: Vec3::NAN,
        axis: Vec3::ZERO,
        radius: f32::INFINITY,
        bun_coils: f32::NAN,
        kind: TieKind::Bun,
        ..HairTie::default()
    };
    let tied = tied(&style, &[bad; 20], &PlainHead);
    assert!(tied.guides.x.iter().chain(&tied.strands.offset_normal).all(|v| v.is_finite()));
    assert_eq!(HairTie::default(), HairTie::default().clamped());
}

#[test]
fn a_tie_is_placed_on_any_head() {
    let tie = HairTie::on(&PlainHead.scalp(32), Vec3::new(0.0, 0.5, -1.0), TieKind::Bun);
    let (distance, n) = PlainHead.distance(tie.at);
    // The distance is a first-order estimate.
    assert!((distance - 0.012).abs() < 0.002, "{distance}");
    assert!(tie.axis.dot(n) > 0.9 && tie.at.z < -0.06 && tie.at.y > 0.12, "{tie:?}");
    let nowhere = HairTie::on(&Scalp::default(), Vec3::NEG_Z, TieKind::Bun);
    assert_eq!(nowhere, HairTie { kind: TieKind::Bun, ..HairTie::default() });
}

/// Whether a guide is where it was, and the strands of its wisp are.
fn is_unchanged(wisp: &crate::Wisp, [before, after]: [&Hairstyle; 2]) -> bool {
    let n = before.guides.points_per_guide;
    let (a, b) = (&before.strands, &after.strands);
    let first = wisp.first_strand as usize;
    let last = first + wisp.strand_count as usize;
    let of_strands = a.first_point[first] as usize..a.first_point[last] as usize;
    let same_guide = |g: usize| (0..n).all(|i| before.guides.point(g, i) == after.guides.point(g, i));
    wisp.guides.iter().all(|&g| same_guide(g as usize))
        && a.offset_normal[of_strands.clone()] == b.offset_normal[of_strands.clone()]
        && a.offset_binormal[of_strands.clone()] == b.offset_binormal[of_strands.clone()]
        && a.offset_tangent[of_strands.clone()] == b.offset_tangent[of_strands]
}

#[test]
fn hair_that_is_too_short_for_a_tie_lies_on_the_head() {
    let settings = GroomSettings { strands_per_wisp: 4, ..GroomSettings::preset(Preset::Smooth) };
    let style = grow(&settings, &PlainHead.scalp(32), &PlainHead).expect("it grows");
    let after = tied(&style, &[HairTie::default()], &PlainHead);
    after.check().expect("sound");
    let n = style.guides.points_per_guide;
    let is_held = |wisp: &crate::Wisp| after.held[wisp.guides[0] as usize * n + 1] >= 0.0;
    let moved: Vec<&crate::Wisp> =
        style.wisps.iter().filter(|wisp| !is_held(wisp) && !is_unchanged(wisp, [&style, &after])).collect();
    assert!(moved.len() >= 6, "only {} wisps are left out", moved.len());
    // Mean and 95th percentile of the distance from the head, millimetres.
    let off = |style: &Hairstyle| {
        let guides = moved.iter().flat_map(|wisp| wisp.guides);
        let points = guides.flat_map(|g| (1..n).map(move |i| (g as usize, i)));
        let mut off: Vec<f32> =
            points.map(|(g, i)| 1e3 * PlainHead.distance(style.guides.point(g, i)).0).collect();
        off.sort_by(f32::total_cmp);
        (off.iter().sum::<f32>() / off.len() as f32, off[off.len() * 19 / 20])
    };
    // The control: hair that keeps the shape of the fuller style.
    let (before, now) = (off(&style), off(&after));
    assert!(before.0 > 12.0 && before.1 > 25.0, "{before:?}");
    assert!(now.0 < 0.75 * before.0 && now.1 < 0.75 * before.1, "{before:?} became {now:?}");
    for (a, b) in lengths(&after).into_iter().zip(lengths(&style)) {
        assert!((a - b).abs() < 1e-5, "{a} {b}");
    }
    for wisp in moved {
        for g in wisp.guides.map(|g| g as usize) {
            assert_eq!(after.guides.point(g, 0), style.guides.point(g, 0));
            let links: Vec<Vec3> =
                (1..n).map(|i| after.guides.point(g, i) - after.guides.point(g, i - 1)).collect();
            let sharpest = links.windows(2).map(|pair| pair[0].angle_between(pair[1])).fold(0.0, f32::max);
            // Near its root hair turns from the scalp onto it: 1.54 in one guide.
            assert!(sharpest < std::f32::consts::FRAC_PI_2, "guide {g} is folded: {sharpest}");
        }
        let curves = [&style, &after].map(|style| crate::WispCurve::at_rest(&style.guides, wisp));
        for s in wisp.first_strand..wisp.first_strand + wisp.strand_count {
            let i = style.strands.first_point[s as usize] as usize;
            let root = |curve: &crate::WispCurve, set: &crate::StrandSet| {
                let o = Vec3::new(set.offset_normal[i], set.offset_binormal[i], set.offset_tangent[i]);
                curve.point(set.weights[s as usize], set.guide_param[i], o)
            };
            let moves = root(&curves[0], &style.strands).distance(root(&curves[1], &after.strands));
            assert!(moves < 1e-5, "a strand of guide {} leaves its root by {moves}", wisp.guides[0]);
        }
    }
}

#[test]
fn a_tie_that_leaves_nothing_out_moves_no_other_hair() {
    let style = long();
    let n = style.guides.points_per_guide;
    let near = HairTie {
        reach: TieReach::InSphere,
        sphere_at_ring: true,
        sphere_radius: 0.06,
        ..HairTie::default()
    };
    let after = tied(&style, &[near], &PlainHead);
    let is_held = |wisp: &&crate::Wisp| after.held[wisp.guides[0] as usize * n + 1] >= 0.0;
    let (held, others): (Vec<&crate::Wisp>, Vec<&crate::Wisp>) = style.wisps.iter().partition(is_held);
    assert!(held.len() > 3 && others.len() > 30, "{} and {}", held.len(), others.len());
    assert!(others.iter().all(|wisp| is_unchanged(wisp, [&style, &after])));
    // Nor does a tie that gathers nothing, whose hair has lost nothing that it lay on.
    let short = GroomSettings { wisps: 60, strands_per_wisp: 4, length: 0.05, ..GroomSettings::default() };
    let short = grow(&short, &PlainHead.scalp(32), &PlainHead).expect("it grows");
    let far = HairTie { at: Vec3::new(0.0, 0.3, -0.3), ..HairTie::default() };
    let after = tied(&short, &[far], &PlainHead);
    assert!(after.held.iter().all(|hold| *hold < 0.0), "control: nothing is gathered");
    assert!(short.wisps.iter().all(|wisp| is_unchanged(wisp, [&short, &after])));
}
