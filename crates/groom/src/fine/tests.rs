use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};

use super::*;
use crate::{GroomSettings, GuideFrame, Hairstyle, PlainHead, StrandSet, Strands, Wisp, grow, interpolate};
use lovelock_base::simd::Width;

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

#[test]
fn the_list_of_a_style_does_not_depend_on_the_styles_of_before() {
    let of = |length: f32| {
        let settings = GroomSettings { wisps: 30, strands_per_wisp: 23, length, ..GroomSettings::default() };
        grow(&settings, &PlainHead.scalp(32), &PlainHead).expect("hair")
    };
    let (short, long) = (of(0.05), of(0.4));
    let mut dark = long.clone();
    dark.strands.shade.iter_mut().for_each(|shade| *shade *= 0.5);
    let mut moved = long.clone();
    moved.guides.x.iter_mut().for_each(|x| *x *= 1.3);
    let united_guides = sparse(20, 20).0.guides.clone();
    let (sparse, _) = sparse(20, 10);
    let mut united = (*sparse).clone();
    united.guides = united_guides;
    let mut cut = (*sparse).clone();
    cut.strands.first_point[20] += 1;
    for (name, a, b) in [
        ("length", short, long.clone()),
        ("shade", dark, long.clone()),
        ("roots", moved, long),
        ("a parting", united, (*sparse).clone()),
        ("a list that is no hairstyle", cut, (*sparse).clone()),
    ] {
        let count = 10 * b.strands.count();
        let (a, b) = (Arc::new(a), Arc::new(b));
        let (mut used, mut fresh) = (FineStrands::default(), FineStrands::default());
        used.follow(&a, count);
        let before = used.strands.clone();
        used.follow(&b, count);
        fresh.follow(&b, count);
        assert!(used.strands == fresh.strands && used.points_per_strand == fresh.points_per_strand, "{name}");
        assert_eq!(before == fresh.strands, name == "length", "{name}");
    }
}

#[test]
fn ties_keep_the_list() {
    let settings = GroomSettings { wisps: 60, strands_per_wisp: 12, length: 0.3, ..GroomSettings::default() };
    let style = Arc::new(grow(&settings, &PlainHead.scalp(32), &PlainHead).expect("hair"));
    let bun = Arc::new(crate::tied(&style, &[crate::HairTie::default()], &PlainHead));
    assert!(style.guides != bun.guides && style.strands != bun.strands, "hair is tied");
    let mut fine = FineStrands::default();
    fine.follow(&style, 3000);
    assert!(!fine.follow(&bun, 3000));
}

#[test]
fn short_hairs_are_as_long_beside_short_hair_as_beside_long() {
    let lengths = |length: f32| {
        let settings = GroomSettings { wisps: 30, strands_per_wisp: 23, length, ..GroomSettings::default() };
        let style = Arc::new(grow(&settings, &PlainHead.scalp(32), &PlainHead).expect("hair"));
        let mut fine = FineStrands::default();
        fine.follow(&style, 8000);
        let out = grown(&fine, 8000, &stored_points(&style));
        let points = fine.points_per_strand;
        let length = |i: usize| {
            (i * points + 1..(i + 1) * points).map(|k| out.point(k).distance(out.point(k - 1))).sum::<f32>()
        };
        let short = fine.strands.iter().enumerate().take(8000).filter(|(_, strand)| strand.is_short == 1);
        short.map(|(i, _)| length(i)).collect::<Vec<_>>()
    };
    let (short, long) = (lengths(0.1), lengths(0.4));
    assert!(short.len() > 100 && short.len() == long.len(), "{} {}", short.len(), long.len());
    for length in short.iter().chain(&long) {
        // A short hair lies beside its parent, which bends.
        assert!((0.003..0.035).contains(length), "{length}");
    }
    let mean = |of: &[f32]| of.iter().sum::<f32>() / of.len() as f32;
    let ratio = mean(&short) / mean(&long);
    println!("short hairs: {} and {} m in the mean", mean(&short), mean(&long));
    // Measured 1.04; lengths that are fractions of the parent's would give 0.25.
    assert!((ratio - 1.0).abs() < 0.15, "{ratio}");
}

#[test]
fn the_list_of_a_wisp_of_many_strands_is_made_in_time() {
    const COUNT: usize = 50_000;
    let (sparse, _) = sparse(1, 1);
    let mut random = lovelock_base::random::SplitMix64::new(3);
    let mut style = Hairstyle { guides: sparse.guides.clone(), ..Hairstyle::default() };
    style.guides.push(&[Vec3::X * 0.1, Vec3::new(0.1, -0.2, 0.0)]);
    style.guides.push(&[Vec3::Z * 0.1, Vec3::new(0.0, -0.2, 0.1)]);
    style.wisps = vec![Wisp { guides: [0, 1, 2], first_strand: 0, strand_count: COUNT as u32 }];
    let set = &mut style.strands;
    set.wisp = vec![0; COUNT];
    set.shade = vec![0.5; COUNT];
    set.first_point = (0..=COUNT as u32).map(|i| 2 * i).collect();
    set.guide_param = (0..2 * COUNT).map(|i| (i % 2) as f32).collect();
    set.taper = vec![1.0; 2 * COUNT];
    for offset in [&mut set.offset_normal, &mut set.offset_binormal, &mut set.offset_tangent] {
        *offset = vec![0.0; 2 * COUNT];
    }
    for spread in [true, false] {
        let mut style = style.clone();
        style.strands.weights = (0..COUNT)
            .map(|_| {
                let [b, c] = if spread { [random.unit(), random.unit()] } else { [0.2, 0.3] };
                [1.0 - b - c, b, c]
            })
            .collect();
        style.check().expect("a hairstyle");
        let ms = lovelock_testkit::clock::alone_ms(|| {
            FineStrands::default().follow(&Arc::new(style), 120_000);
        });
        println!("roots spread {spread}: {ms:.0} ms of CPU time");
        // Measured 47 ms on two cores.
        assert!(ms < 2000.0, "{ms}");
    }
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
    // Strands without a segment, which no hairstyle may have.
    let mut odd = (*style).clone();
    odd.strands.first_point = vec![0, 0, 1, 2];
    odd.strands.wisp = vec![0; 3];
    let mut fine = FineStrands::default();
    fine.follow(&Arc::new(odd), 50);
    let strands = Strands { first_point: vec![0, 0, 1, 2].into(), ..strands };
    assert_eq!(grown(&fine, 50, &strands).points(), 100);
}

#[test]
fn children_of_stubs_beside_long_strands_stay_stubs() {
    let style = small_style();
    let is_stub = |strand: u32| strand.is_multiple_of(3);
    let mut cut = (*style).clone();
    for strand in (0..style.strands.count() as u32).filter(|strand| is_stub(*strand)) {
        let ends = [0, 1].map(|k| style.strands.first_point[strand as usize + k] as usize);
        let set = &mut cut.strands;
        set.guide_param[ends[0]..ends[1]].iter_mut().for_each(|u| *u *= 1e-3);
        for offset in [&mut set.offset_normal, &mut set.offset_binormal, &mut set.offset_tangent] {
            let root = offset[ends[0]];
            offset[ends[0]..ends[1]].fill(root);
        }
    }
    let cut = Arc::new(cut);
    let (count, strands) = (12 * style.strands.count(), stored_points(&cut));
    let mut fine = FineStrands::default();
    fine.follow(&cut, count);
    let longest = |fine: &FineStrands| {
        let out = grown(fine, count, &strands);
        let points = fine.points_per_strand;
        let stubs = fine.strands[..count].iter().enumerate();
        let stubs = stubs.filter(|(_, strand)| strand.is_short == 0 && is_stub(strand.parents[0]));
        let length = |i: usize| {
            (1..points)
                .map(|k| out.point(i * points + k).distance(out.point(i * points + k - 1)))
                .sum::<f32>()
        };
        stubs.map(|(i, _)| length(i)).fold(0.0, f32::max)
    };
    let own = (0..style.strands.count() as u32).filter(|strand| is_stub(*strand)).map(|strand| {
        let ends = [0, 1].map(|k| strands.first_point[strand as usize + k] as usize);
        (ends[0] + 1..ends[1]).map(|k| strands.point(k).distance(strands.point(k - 1))).sum::<f32>()
    });
    let own = own.fold(0.0, f32::max);
    let stubs = longest(&fine);
    // Control: children that follow their parents whatever their lengths.
    let mut plain = FineStrands::default();
    plain.follow(&style, count);
    fine.strands.clone_from(&plain.strands);
    let spikes = longest(&fine);
    println!("stubs {own} m, their children {stubs} m, without regard to lengths {spikes} m");
    assert!(stubs < 2.0 * own && spikes > 10.0 * stubs);
    // Hair of even lengths has the children that it always had, and hair that grows again gets them back.
    fine.follow(&style, count);
    assert_eq!(fine.strands[..count], plain.strands[..count]);
}
