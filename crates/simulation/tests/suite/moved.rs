//! Hair that is moved from outside, as with a brush.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use lovelock_groom::{GroomSettings, GuideFrame, Guides, Hairstyle, PlainHead, Preset, grow};
use lovelock_simulation::{Simulation, SimulationSettings, StepInput};

use crate::common::STEP_SECS;

fn input(step: i32, moves: bool) -> StepInput<'static> {
    let at = if moves { Vec3::X * (0.03 * (step as f32 * 0.1).sin()) } else { Vec3::ZERO };
    StepInput::new(f64::from(step) / 60.0, Affine3A::from_translation(at), &[])
}

fn frame(simulation: &Simulation) -> GuideFrame {
    let guides = simulation.style().guides.clone();
    let mut frame = GuideFrame { time_secs: 0.0, world_from_head: Affine3A::IDENTITY, guides };
    simulation.frame(&mut frame);
    frame
}

fn furthest(a: &Guides, b: &Guides) -> f32 {
    (0..a.x.len())
        .map(|i| Vec3::new(a.x[i] - b.x[i], a.y[i] - b.y[i], a.z[i] - b.z[i]).length())
        .fold(0.0, f32::max)
}

fn mean(a: &Guides, b: &Guides) -> f32 {
    let of = |i: usize| Vec3::new(a.x[i] - b.x[i], a.y[i] - b.y[i], a.z[i] - b.z[i]).length();
    (0..a.x.len()).map(of).sum::<f32>() / a.x.len() as f32
}

fn points(guides: &Guides, guide: usize) -> Vec<Vec3> {
    (0..guides.points_per_guide).map(|i| guides.point(guide, i)).collect()
}

fn put(guides: &mut Guides, guide: usize, points: &[Vec3]) {
    for (i, p) in points.iter().enumerate() {
        let k = guide * guides.points_per_guide + i;
        (guides.x[k], guides.y[k], guides.z[k]) = (p.x, p.y, p.z);
    }
}

/// Every second wisp bent to one side, by an angle that grows toward the tip; and the rest shape to which the turns of the motion lead
/// back.
fn combed(now: &GuideFrame, style: &Hairstyle) -> (GuideFrame, Guides, Vec<usize>) {
    let (mut seen, mut rest) = (now.clone(), style.guides.clone());
    let guides: Vec<usize> =
        style.wisps.iter().step_by(2).flat_map(|w| w.guides).map(|g| g as usize).collect();
    for &guide in &guides {
        let [moving, still] = [&now.guides, &style.guides].map(|guides| points(guides, guide));
        let (mut new, mut at_rest) = (vec![moving[0]], vec![still[0]]);
        let mut turn = Quat::IDENTITY;
        for i in 1..moving.len() {
            let [m, r] = [&moving, &still].map(|p| (p[i] - p[i - 1]).normalize_or(Vec3::NEG_Y));
            turn = Quat::from_rotation_arc((turn * r).normalize_or(r), m) * turn;
            let bent = Quat::from_rotation_x(0.03 * i as f32) * m;
            let link = still[i].distance(still[i - 1]);
            new.push(new[i - 1] + bent * link);
            at_rest.push(at_rest[i - 1] + turn.inverse() * bent * link);
        }
        put(&mut seen.guides, guide, &new);
        put(&mut rest, guide, &at_rest);
    }
    (seen, rest, guides)
}

/// The largest movement of a point in a step over so many steps, metres.
fn fastest(simulation: &mut Simulation, steps: std::ops::Range<i32>, moves: bool) -> f32 {
    let mut last = frame(simulation).guides;
    let mut most = 0.0_f32;
    for step in steps {
        simulation.step(&input(step, moves), &SimulationSettings::default(), STEP_SECS);
        let now = frame(simulation).guides;
        most = most.max(furthest(&last, &now));
        last = now;
    }
    most
}

#[test]
fn combed_hair_stays_where_it_was_combed_without_a_kick() {
    let settings = GroomSettings { wisps: 12, strands_per_wisp: 2, ..GroomSettings::preset(Preset::Long) };
    let style = Arc::new(grow(&settings, &PlainHead.scalp(32), &PlainHead).expect("it grows"));
    for moves in [false, true] {
        let mut simulation = Simulation::new(Arc::clone(&style));
        simulation.reset(&input(0, moves));
        fastest(&mut simulation, 1..60, moves);
        let mut control = simulation.clone();
        let (seen, rest, guides) = combed(&frame(&simulation), &style);
        let far = furthest(&seen.guides, &frame(&simulation).guides);

        simulation.move_guides(&seen, &rest, &guides);
        let placed = furthest(&seen.guides, &frame(&simulation).guides);
        let during = fastest(&mut simulation, 60..64, moves);
        let before = frame(&simulation).guides;
        let next = Arc::new(Hairstyle { guides: rest.clone(), ..Hairstyle::clone(&style) });
        simulation.set_style(Arc::clone(&next));
        let jump = furthest(&before, &frame(&simulation).guides);
        let after = fastest(&mut simulation, 64..180, moves);
        let uncombed = fastest(&mut control, 60..180, moves);
        // Hair that had the new style from the start.
        let mut same = Simulation::new(Arc::clone(&next));
        same.reset(&input(0, moves));
        fastest(&mut same, 1..60, moves);
        let usual = fastest(&mut same, 60..180, moves);
        let off = mean(&frame(&same).guides, &frame(&simulation).guides);
        println!(
            "moves {moves}: combed by {far} m, placed within {placed} m, {during} m per step, jump {jump} m, then {after} m per \
             step; {usual} m with that style from the start, {uncombed} m uncombed; at the end {off} m apart in the mean"
        );
        assert!(far > 0.05 && placed < 2e-5 && jump < 2e-5, "{far} {placed} {jump}");
        assert!(during.max(after) < 1.3 * usual + 2e-4, "{during} {after} {usual}");
        assert!(off < 0.1 * far, "{off} of {far}");
        if !moves {
            let stayed = furthest(&seen.guides, &frame(&simulation).guides);
            assert!(stayed < 0.01 * far, "{stayed} of {far}");
        }
        // Control: with the old rest shape hair springs back.
        let mut loose = Simulation::new(Arc::clone(&style));
        loose.reset(&input(0, moves));
        fastest(&mut loose, 1..60, moves);
        loose.move_guides(&seen, &style.guides, &guides);
        let kick = fastest(&mut loose, 60..180, moves);
        println!("with the old rest shape {kick} m per step");
        assert!(kick > 1.2 * after, "{kick} {after}");
    }
}

#[test]
fn guides_that_do_not_fit_are_not_moved() {
    let settings = GroomSettings { wisps: 6, strands_per_wisp: 2, ..GroomSettings::default() };
    let style = Arc::new(grow(&settings, &PlainHead.scalp(32), &PlainHead).expect("it grows"));
    let mut simulation = Simulation::new(Arc::clone(&style));
    simulation.reset(&input(0, false));
    let hash = simulation.state_hash();
    let mut bad = frame(&simulation);
    bad.guides.x[5] = f32::NAN;
    simulation.move_guides(&bad, &style.guides, &[0, 99]);
    let other = GuideFrame { guides: Guides { points_per_guide: 31, ..Guides::default() }, ..bad };
    simulation.move_guides(&other, &style.guides, &[0]);
    assert_eq!(simulation.state_hash(), hash);
}
