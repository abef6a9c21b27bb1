use lovelock_groom::{
    GroomSettings, GuideFrame, Haircut, NoObstacle, PlainHead, Strands, TieKind, grow, interpolate,
};

use super::*;
use crate::operations::{HairTie, Scissors};
use crate::{Layer, apply_layer};

fn grown(settings: GroomSettings) -> Arc<Hairstyle> {
    Arc::new(grow(&settings, &PlainHead.scalp(16), &PlainHead).expect("hair"))
}

fn bob() -> Arc<Hairstyle> {
    grown(GroomSettings { wisps: 30, strands_per_wisp: 8, ..GroomSettings::default() })
}

/// Other roots, wisps, strands and points than [`bob`].
fn curls() -> Arc<Hairstyle> {
    grown(GroomSettings {
        seed: 9,
        wisps: 50,
        strands_per_wisp: 6,
        segments_per_strand: 60,
        length: 0.45,
        curl_radius: 0.008,
        ..GroomSettings::default()
    })
}

fn drawn(style: &Hairstyle) -> Vec<Vec<Vec3>> {
    style.check().expect("a sound hairstyle");
    let frame = GuideFrame::at_rest(&style.guides, glam::Affine3A::IDENTITY, 0.0);
    let mut strands = Strands::default();
    interpolate(style, &frame, &mut strands);
    let of = |pair: &[u32]| (pair[0]..pair[1]).map(|i| strands.point(i as usize)).collect();
    strands.first_point.windows(2).map(of).collect()
}

fn length_of(points: &[Vec3]) -> f32 {
    points.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// The largest distance of a strand of `style` from the same strand in `now`, and the length of the longest other strand of `now`.
fn against(morph: &Morph, side: usize, style: &Hairstyle, now: &Hairstyle) -> (f32, f32) {
    let (wanted, now) = (drawn(style), drawn(now));
    let (mut furthest, mut others) = (0.0_f32, 0.0_f32);
    let strands = morph.wisps.iter().flat_map(|wisp| &wisp.strands);
    for (of, points) in strands.zip(&now) {
        let Some(strand) = of[side] else {
            others = others.max(length_of(points));
            continue;
        };
        let wanted = &wanted[strand as usize];
        for (k, p) in points.iter().enumerate() {
            let at = k as f32 * (wanted.len() - 1) as f32 / (points.len() - 1) as f32;
            if at.fract() == 0.0 {
                furthest = furthest.max(p.distance(wanted[at as usize]));
            }
        }
    }
    (furthest, others)
}

#[test]
fn each_end_shows_one_hairstyle() {
    let styles = [bob(), curls()];
    let morph = Morph::new(styles.clone());
    for (side, amount) in [(0, 0.0), (1, 1.0)] {
        let (furthest, others) = against(&morph, side, &styles[side], &morph.at(amount, &NoObstacle));
        // The guides of the bob are resampled from 31 points to the 31 of the curls, so only rounding remains.
        assert!(furthest < 1e-5, "{amount}: {furthest}");
        assert!(others < 2e-3, "{amount}: {others}");
        let (half, _) = against(&morph, side, &styles[side], &morph.at(0.5, &NoObstacle));
        assert!(half > 0.02, "halfway there is hair of neither: {half}");
    }
}

#[test]
fn every_strand_of_both_has_one_place() {
    let styles = [bob(), curls()];
    let morph = Morph::new(styles.clone());
    for side in 0..2 {
        let strands = morph.wisps.iter().flat_map(|wisp| &wisp.strands).filter_map(|of| of[side]);
        let mut found: Vec<u32> = strands.collect();
        found.sort_unstable();
        assert_eq!(found, (0..styles[side].strands.count() as u32).collect::<Vec<_>>());
    }
}

#[test]
fn matched_roots_are_neighbours() {
    let styles = [bob(), curls()];
    let morph = Morph::new(styles.clone());
    let strands: Vec<_> = morph.wisps.iter().flat_map(|wisp| &wisp.strands).collect();
    let both = strands.iter().filter(|of| of.iter().all(Option::is_some)).count();
    assert!(2 * both > styles[0].strands.count(), "only {both} strands have a partner");
    let ends = [0.0, 1.0].map(|amount| drawn(&morph.at(amount, &NoObstacle)));
    let apart = |i: usize| ends[0][i][0].distance(ends[1][i][0]);
    let furthest = (0..strands.len()).map(apart).fold(0.0, f32::max);
    assert!(furthest < 0.09, "{furthest}");
}

/// The furthest that a point moves between two amounts.
fn furthest(morph: &Morph, amounts: [f32; 2]) -> f32 {
    let [a, b] = amounts.map(|amount| drawn(&morph.at(amount, &NoObstacle)));
    let points = a.iter().flatten().zip(b.iter().flatten());
    points.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn no_strand_jumps_while_the_amount_changes() {
    let morph = Morph::new([bob(), curls()]);
    let step = |i: u32, of: f32| [i as f32 / of, (i + 1) as f32 / of];
    let coarse = (0..20).map(|i| furthest(&morph, step(i, 20.0))).fold(0.0, f32::max);
    let fine = (0..160).map(|i| furthest(&morph, step(i, 160.0))).fold(0.0, f32::max);
    // Of a jump as much would be left in a step of an eighth.
    assert!(fine < 0.25 * coarse, "{fine} of {coarse}");
    // Hair of 0.45 m that turned half around in a straight line would move 0.07 m at its tip.
    assert!(coarse < 0.1, "{coarse}");
}

#[test]
fn a_guide_keeps_its_length_while_it_turns() {
    let [up, aside] =
        [Vec3::Y, Vec3::X].map(|direction| (0..4).map(|i| direction * i as f32).collect::<Vec<_>>());
    let half = between(&up, &aside, 0.5, &NoObstacle);
    assert!((length_of(&half) - 3.0).abs() < 1e-5);
    let diagonal = Vec3::new(1.0, 1.0, 0.0).normalize_or_zero();
    assert!(half[3].distance(3.0 * diagonal) < 1e-5, "{half:?}");
}

#[test]
fn hair_that_only_one_has_draws_back_into_the_scalp() {
    let bob = bob();
    let mut left = Hairstyle::clone(&bob);
    let kept: Vec<Wisp> = bob
        .wisps
        .iter()
        .copied()
        .filter(|wisp| bob.guides.point(wisp.guides[0] as usize, 0).x > 0.03)
        .collect();
    let strands: Vec<usize> = kept
        .iter()
        .flat_map(|w| w.first_strand..w.first_strand + w.strand_count)
        .map(|s| s as usize)
        .collect();
    let mut set = StrandSet { first_point: vec![0], ..StrandSet::default() };
    for (to, wisp) in kept.iter().enumerate() {
        set.wisp.extend((0..wisp.strand_count).map(|_| to as u32));
    }
    for s in strands {
        let range = bob.strands.first_point[s] as usize..bob.strands.first_point[s + 1] as usize;
        set.weights.push(bob.strands.weights[s]);
        set.shade.push(bob.strands.shade[s]);
        set.guide_param.extend(&bob.strands.guide_param[range.clone()]);
        set.offset_normal.extend(&bob.strands.offset_normal[range.clone()]);
        set.offset_binormal.extend(&bob.strands.offset_binormal[range.clone()]);
        set.offset_tangent.extend(&bob.strands.offset_tangent[range.clone()]);
        set.taper.extend(&bob.strands.taper[range]);
        set.first_point.push(set.guide_param.len() as u32);
    }
    let mut first_strand = 0;
    left.wisps = kept
        .iter()
        .map(|w| {
            let wisp = Wisp { first_strand, ..*w };
            first_strand += w.strand_count;
            wisp
        })
        .collect();
    left.strands = set;
    left.check().expect("half a hairstyle");
    let morph = Morph::new([Arc::clone(&bob), Arc::new(left)]);
    let right = |style: &Hairstyle| {
        let strands = drawn(style);
        strands.iter().filter(|p| p[0].x < -0.07).map(|p| length_of(p)).fold(0.0, f32::max)
    };
    let [before, half, after] = [0.0, 0.5, 1.0].map(|amount| right(&morph.at(amount, &NoObstacle)));
    assert!(before > 0.15 && after < 2e-3, "{before} {after}");
    assert!((half / before - 0.5).abs() < 0.1, "{half} of {before}");
}

#[test]
fn cut_and_tied_hair_stays_sound_at_every_amount() {
    let bob = bob();
    let cut = Scissors {
        cut: Haircut {
            first_root: bob.guides.point(0, 0),
            kept: (0..bob.guides.count()).map(|g| 0.3 + 0.02 * (g % 30) as f32).collect(),
        },
    };
    let tie = HairTie { kind: TieKind::Ponytail, ..HairTie::default() };
    let made =
        |layer, style: &Hairstyle| Arc::new(apply_layer(&layer, 1.0, style, &PlainHead).expect("a change"));
    let styles = [made(Layer::of(cut), &bob), made(Layer::of(tie), &curls())];
    let morph = Morph::new(styles.clone());
    for amount in [0.0, 0.2, 0.49, 0.5, 0.9, 1.0, f32::NAN, 7.0] {
        let now = morph.at(amount, &PlainHead);
        drawn(&now);
        assert_eq!(now.ropes.is_empty(), amount.is_nan() || amount < 0.5);
        assert_eq!(now.held.is_empty(), amount.is_nan() || amount < 0.5);
        assert!(now.guides.x.iter().all(|x| x.is_finite()));
    }
    for (side, amount) in [(0, 0.0), (1, 1.0)] {
        let (furthest, _) = against(&morph, side, &styles[side], &morph.at(amount, &PlainHead));
        assert!(furthest < 1e-4, "{amount}: {furthest}");
    }
}

#[test]
fn the_layout_is_the_same_for_every_amount() {
    let morph = Morph::new([bob(), curls()]);
    let [a, b] = [0.1, 0.8].map(|amount| morph.at(amount, &NoObstacle));
    assert_eq!(a.wisps, b.wisps);
    assert_eq!(a.guides.count(), b.guides.count());
    assert_eq!(a.strands.first_point, b.strands.first_point);
}

#[test]
fn factors_on_the_motion_are_mixed() {
    let [a, mut b] = [0, 1].map(|_| crate::operations::testing::straight(Vec3::NEG_Y));
    b.motion.stiffness = vec![3.0; b.guides.x.len()];
    let morph = Morph::new([Arc::new(a), Arc::new(b)]);
    for (amount, factor) in [(0.0, 1.0), (0.5, 2.0), (1.0, 3.0)] {
        let style = morph.at(amount, &lovelock_groom::NoObstacle);
        style.check().expect("sound");
        assert!(style.motion.stiffness.iter().all(|f| (f - factor).abs() < 1e-6), "{amount}");
        assert!(style.motion.hold.is_empty(), "control: a list that neither has");
    }
}

#[test]
fn colours_are_those_of_either_hairstyle_at_the_ends_and_mixed_between() {
    let [bob, curls] = [bob(), curls()];
    let dyed =
        apply_layer(&Layer::of(crate::operations::Dye::default()), 1.0, &bob, &NoObstacle).expect("a dye");
    let dye = dyed.strands.colours.mean();
    let morph = Morph::new([Arc::new(dyed), Arc::clone(&curls)]);
    let strands: Vec<_> = morph.wisps.iter().flat_map(|wisp| &wisp.strands).copied().collect();
    for amount in [0.0, 0.25, 1.0] {
        let made = morph.at(amount, &NoObstacle);
        made.check().expect("sound");
        for (of, samples) in strands.iter().zip(made.strands.colours.strands()) {
            let wanted = match of {
                [Some(_), Some(_)] => dye.mixed(lovelock_groom::StrandColour::BELOW, amount),
                [Some(_), None] => dye,
                _ => lovelock_groom::StrandColour::BELOW,
            };
            assert!((samples[3].kept - wanted.kept).abs() < 1e-6, "{of:?} at {amount}");
            assert!((samples[3].added[1] - wanted.added[1]).abs() < 1e-5, "{of:?} at {amount}");
        }
    }
    assert!(strands.iter().any(|of| of.iter().all(Option::is_some)), "some strands are matched");
    assert!(Morph::new([bob, curls]).at(0.5, &NoObstacle).strands.colours.is_empty());
}
