use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};

use super::*;
use crate::simd::Width;
use crate::{GroomSettings, GuideFrame, Hairstyle, PlainHead, StrandSet, Strands, Wisp, grow, interpolate};

fn small_style() -> Arc<Hairstyle> {
    let settings = GroomSettings { wisps: 30, strands_per_wisp: 23, ..GroomSettings::default() };
    Arc::new(grow(&settings, &PlainHead.scalp(32), &PlainHead).expect("hair"))
}

fn stored_points(style: &Hairstyle) -> Strands {
    let turned = Affine3A::from_rotation_translation(Quat::from_rotation_y(0.7), Vec3::new(0.1, 1.5, 0.0));
    let mut strands = Strands::default();
    interpolate(style, &GuideFrame::at_rest(&style.guides, turned, 0.0), &mut strands);
    strands
}

fn grown(fine: &FineStrands, count: usize, strands: &Strands) -> Strands {
    let mut out = Strands::default();
    grow_fine(Width::widest(), fine, count, strands, &mut ParentPoints::default(), &mut out);
    out
}

#[test]
fn the_first_strands_are_the_stored_ones_spread_evenly() {
    let style = small_style();
    let mut fine = FineStrands::default();
    assert!(fine.follow(&style, style.strands.count()));
    let mut seen: Vec<u32> = fine.strands.iter().map(|strand| strand.parents[0]).collect();
    for share in [0.1, 0.25, 0.5, 0.8] {
        let part = &seen[..(share * seen.len() as f32) as usize];
        for wisp in &style.wisps {
            let own = wisp.first_strand..wisp.first_strand + wisp.strand_count;
            let found = part.iter().filter(|strand| own.contains(strand)).count() as f32;
            assert!((found - share * wisp.strand_count as f32).abs() <= 1.5, "{share}: {found}");
        }
    }
    let strands = stored_points(&style);
    let out = grown(&fine, seen.len(), &strands);
    let points = fine.points_per_strand;
    for (i, &strand) in seen.iter().enumerate() {
        let stored = strand as usize * points..(strand as usize + 1) * points;
        assert_eq!(out.x[i * points..(i + 1) * points], strands.x[stored]);
    }
    seen.sort_unstable();
    assert!(seen.iter().copied().eq(0..style.strands.count() as u32), "each once");
}

#[test]
fn children_lie_between_their_parents_and_gather_to_the_first() {
    let style = small_style();
    let stored = style.strands.count();
    let mut fine = FineStrands::default();
    fine.follow(&style, 12 * stored);
    let strands = stored_points(&style);
    let out = grown(&fine, 12 * stored, &strands);
    let points = fine.points_per_strand;
    let (mut at_root, mut at_tip) = (0.0, 0.0);
    for (i, strand) in fine.strands.iter().enumerate().skip(stored).take(10 * stored) {
        let wisps = strand.parents.map(|parent| style.strands.wisp[parent as usize]);
        assert_eq!(wisps, [wisps[0]; 3], "of one wisp");
        let root = out.point(i * points);
        let [a, b, c] = strand.parents.map(|parent| strands.point(parent as usize * points));
        let reach = a.distance(b).max(a.distance(c));
        assert!(root.distance(a) <= 1.01 * reach, "{i}");
        at_root += root.distance(a);
        // Where the parent is as long as the child.
        let end = out.point((i + 1) * points - 1);
        let first = strand.parents[0] as usize * points;
        at_tip +=
            (first..first + points).map(|k| strands.point(k).distance(end)).fold(f32::INFINITY, f32::min);
    }
    assert!(at_tip < 1.5 * at_root, "{at_tip} {at_root}");
    // Whatever the number, the strands are the same.
    let mut longer = FineStrands::default();
    longer.follow(&style, 2 * stored);
    longer.follow(&style, 20 * stored);
    assert_eq!(fine.strands[..12 * stored], longer.strands[..12 * stored]);
    // Neither vectors nor threads change a bit.
    let mut plain = Strands::default();
    grow_fine(Width::Baseline, &fine, 9 * stored, &strands, &mut ParentPoints::default(), &mut plain);
    let wide = grown(&fine, 9 * stored, &strands);
    assert!((&plain.x, &plain.y, &plain.z) == (&wide.x, &wide.y, &wide.z));
}

#[test]
fn combed_hair_keeps_its_list_and_other_hair_gets_its_own() {
    let style = small_style();
    let mut fine = FineStrands::default();
    fine.follow(&style, 3000);
    let mut combed = (*style).clone();
    combed.strands.offset_normal.iter_mut().for_each(|offset| *offset += 0.01);
    assert!(!fine.follow(&Arc::new(combed), 3000));
    let mut other = (*style).clone();
    other.strands.weights.iter_mut().for_each(|w| w.swap(0, 1));
    assert!(fine.follow(&Arc::new(other), 3000));
}

/// Straight strands that hang from a line of roots, each a wisp of its own; those after `parting` hang far to the side.
fn sparse(count: usize, parting: usize) -> (Arc<Hairstyle>, Strands) {
    let mut style = Hairstyle::default();
    style.guides.points_per_guide = 2;
    let mut set = StrandSet { first_point: vec![0], ..StrandSet::default() };
    let mut strands = Strands::default();
    for i in 0..count {
        let root = Vec3::X * 0.01 * i as f32;
        let tip = root + if i < parting { Vec3::new(0.0, -0.2, 0.0) } else { Vec3::new(0.4, -0.2, 0.0) };
        style.guides.push(&[root, tip]);
        let guides = [i as u32; 3];
        style.wisps.push(Wisp { guides, first_strand: i as u32, strand_count: 1 });
        set.wisp.push(i as u32);
        set.weights.push([1.0, 0.0, 0.0]);
        set.shade.push(0.5);
        // The strands have 2 to 4 points.
        let points = 2 + i % 3;
        for k in 0..points {
            let t = k as f32 / (points - 1) as f32;
            set.guide_param.push(t);
            let p = root.lerp(tip, t);
            strands.x.push(p.x);
            strands.y.push(p.y);
            strands.z.push(p.z);
        }
        set.first_point.push(set.guide_param.len() as u32);
    }
    let points = set.points();
    set.offset_normal = vec![0.0; points];
    set.offset_binormal = vec![0.0; points];
    set.offset_tangent = vec![0.0; points];
    set.taper = vec![1.0; points];
    strands.first_point = set.first_point.clone().into();
    style.strands = set;
    style.check().expect("a hairstyle");
    (Arc::new(style), strands)
}

#[test]
fn few_strands_are_multiplied_between_neighbours_but_not_across_a_parting() {
    let (style, strands) = sparse(20, 10);
    let mut fine = FineStrands::default();
    fine.follow(&style, 400);
    assert_eq!(fine.points_per_strand, 4);
    let mut between = 0;
    for strand in &fine.strands[20..] {
        let sides = strand.parents.map(|parent| parent < 10);
        assert_eq!(sides, [sides[0]; 3]);
        between += usize::from(strand.parents[0] != strand.parents[1]);
    }
    assert_eq!(between, fine.strands.len() - 20);
    // Straight strands of any number of points give straight strands.
    let out = grown(&fine, 20, &strands);
    for (i, strand) in fine.strands[..20].iter().enumerate() {
        let ends =
            strands.first_point[strand.parents[0] as usize..].iter().take(2).copied().collect::<Vec<_>>();
        let (first, last) = (strands.point(ends[0] as usize), strands.point(ends[1] as usize - 1));
        for k in 0..4 {
            assert!(out.point(i * 4 + k).distance(first.lerp(last, k as f32 / 3.0)) < 1e-6);
        }
    }
}

#[test]
fn nothing_and_single_strands_are_no_problem() {
    let mut fine = FineStrands::default();
    assert!(!fine.follow(&Arc::new(Hairstyle::default()), 100));
    assert_eq!(grown(&fine, 100, &Strands::default()).points(), 0);
    let (style, strands) = sparse(1, 1);
    let mut fine = FineStrands::default();
    assert!(fine.follow(&style, 50));
    assert!(fine.strands.iter().all(|strand| strand.parents == [0; 3]));
    assert_eq!(grown(&fine, 50, &strands).points(), 100);
}
