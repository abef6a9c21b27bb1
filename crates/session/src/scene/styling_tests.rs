use std::ops::ControlFlow;
use std::sync::Arc;

use lovelock_groom::Hairstyle;
use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_project::tracks::{Key, Track};
use lovelock_style::operations::{Curl, Length, Stiffness, Wave};
use lovelock_style::{Layer, Mask, MaskPart, MaskRegion, Operation};

use super::Scene;
use crate::clock::STEP_SECS;
use crate::dance::Dance;
use crate::engine::Engine;
use crate::take::TakeRecording;
use crate::testing::{load, played, small_project};

/// A project with one layer, whose weight has these keys.
fn keyed(operation: impl Into<Operation>, keys: &[(f64, f64)]) -> Project {
    let mut project = small_project();
    project.hair.stack.push(Layer::of(operation));
    let keys = keys.iter().map(|&(secs, value)| Key { secs, value: vec![value] }).collect();
    project.timeline.tracks = vec![Track { keys, ..Track::new("hair/stack/1/weight") }];
    project
}

/// The same project without tracks, and with that weight.
fn weighted(project: &Project, weight: f32) -> Project {
    let mut project = project.clone();
    project.timeline.tracks.clear();
    project.hair.stack.layers[0].weight = weight;
    project
}

fn engine_of(project: &Project) -> Engine {
    let mut engine = Engine::at_rest(load(project).0, project.simulation, STEP_SECS);
    engine.follow(project);
    engine
}

fn shape(style: &Hairstyle) -> impl PartialEq + std::fmt::Debug + use<> {
    (
        style.guides.clone(),
        style.strands.clone(),
        style.held.clone(),
        style.widest.clone(),
        style.motion.clone(),
    )
}

/// Length of all guides, metres.
fn length(scene: &Scene) -> f32 {
    let guides = &scene.style.guides;
    let link = |g: usize, p: usize| guides.point(g, p).distance(guides.point(g, p - 1));
    (0..guides.count()).map(|g| (1..guides.points_per_guide).map(|p| link(g, p)).sum::<f32>()).sum()
}

#[test]
fn keyed_weights_give_the_hairstyle_of_their_numbers() {
    for operation in [Operation::from(Wave::default()), Curl::default().into(), Stiffness::default().into()] {
        let project = keyed(operation, &[(0.5, 0.0), (1.5, 1.0)]);
        let mut engine = engine_of(&project);
        for (secs, weight) in [(0.0, 0.0), (1.0, 0.5), (2.0, 1.0)] {
            engine.seek(secs);
            let plain = load(&weighted(&project, weight)).0;
            assert_eq!(shape(&engine.snapshot().scene.style), shape(&plain.style), "{weight}");
        }
        let ends = [0.0, 1.0].map(|weight| load(&weighted(&project, weight)).0);
        assert_ne!(shape(&ends[0].style), shape(&ends[1].style), "control: the layer acts");
        // Settled, as a project without keys.
        engine.seek(4.0);
        engine.settle();
        let mut still = engine_of(&weighted(&project, 1.0));
        still.seek(4.0);
        still.settle();
        assert_eq!(engine.state_hash(), still.state_hash());
    }
}

#[test]
fn a_number_that_stays_gives_the_same_allocation() {
    let project = keyed(Curl::default(), &[(0.5, 0.0), (0.6, 1.0)]);
    let mut engine = engine_of(&project);
    engine.settle();
    let mut scenes = 0;
    let mut last = engine.snapshot().scene.clone();
    for _ in 0..60 {
        engine.step();
        let scene = Arc::clone(&engine.snapshot().scene);
        scenes += u32::from(!Arc::ptr_eq(&scene, &last));
        last = scene;
    }
    // Keys a tenth of a second apart.
    assert!((5..=7).contains(&scenes), "{scenes}");
}

#[test]
fn strands_that_follow_keys_do_not_touch_the_simulation() {
    let project = keyed(Curl { radius: 0.01, ..Curl::default() }, &[(0.5, 0.0), (1.5, 1.0)]);
    let [mut keyed, mut plain] = [&project, &weighted(&project, 0.0)].map(engine_of);
    for engine in [&mut keyed, &mut plain] {
        engine.settle();
        engine.advance_to_step(60);
    }
    assert_eq!(keyed.state_hash(), plain.state_hash());
    let [a, b] = [keyed.snapshot(), plain.snapshot()];
    assert_ne!(a.scene.style.strands, b.scene.style.strands, "control: curled");
}

#[test]
fn hair_that_is_cut_in_the_middle_is_shorter_from_there_and_whole_again_in_the_next_round() {
    let cut = Length { factor: 0.4, ..Length::default() };
    let project = keyed(cut, &[(1.0, 0.0), (1.0 + 0.5 * STEP_SECS, 1.0)]);
    let mut engine = engine_of(&project);
    let [whole, short] = [0.0, 1.0].map(|weight| length(&load(&weighted(&project, weight)).0));
    assert!(short < 0.6 * whole);
    let round = (engine.scene().duration_secs() / STEP_SECS).round() as u64;
    engine.seek(0.0);
    let mut before = None;
    for (step, wanted) in
        [(59, whole), (61, short), (round - 1, short), (round + 1, whole), (round + 61, short)]
    {
        engine.advance_to_step(step);
        let now = engine.snapshot();
        assert_eq!(length(&now.scene), wanted, "step {step}");
        if step == 61 {
            // What is left stays where it was.
            let before: Arc<crate::snapshot::FrameSnapshot> = before.take().expect("a step before");
            let (a, b, rest) = (&before.guides.guides, &now.guides.guides, &now.scene.style.guides);
            for g in 0..rest.count() {
                for i in 1..rest.points_per_guide {
                    if rest.point(g, i) != rest.point(g, i - 1) {
                        let moved = a.point(g, i).distance(b.point(g, i));
                        assert!(moved < 0.08, "guide {g} moves by {moved} m in two steps");
                    }
                }
            }
        }
        before = Some(now);
    }
    assert_eq!(engine.totals().recovered_guides, 0);
    assert!(engine.totals().max_stretch < 1e-4);
}

#[test]
fn a_wave_that_rises_for_two_seconds_moves_no_faster_than_the_dance() {
    let wave = Wave { height: 0.03, ..Wave::default() };
    let project = keyed(wave, &[(0.2, 0.0), (2.2, 1.0)]);
    // Of the guides: where the body pushes hair to another of its sides as the wave grows, its shape jumps, and it and its neighbours whip.
    let fastest = |project: &Project, part: f32| {
        let mut engine = engine_of(project);
        engine.settle();
        let mut last = crate::snapshot::FrameSnapshot::clone(&engine.snapshot());
        let mut most = vec![0.0_f32; last.guides.guides.count()];
        for _ in 0..140 {
            engine.step();
            let now = crate::snapshot::FrameSnapshot::clone(&engine.snapshot());
            let (a, b) = (&last.guides.guides, &now.guides.guides);
            for (g, most) in most.iter_mut().enumerate() {
                let moved = (0..a.points_per_guide).map(|i| a.point(g, i).distance(b.point(g, i)));
                *most = moved.fold(*most, f32::max);
            }
            last = now;
        }
        most.sort_unstable_by(f32::total_cmp);
        (most[((most.len() - 1) as f32 * part) as usize], engine.totals())
    };
    let ((rising, totals), (still, _)) = (fastest(&project, 0.75), fastest(&weighted(&project, 0.0), 1.0));
    println!("{rising} m a step, {still} m without");
    assert!(rising < 1.5 * still, "{rising} m a step, {still} m without");
    assert!(totals.recovered_guides == 0 && totals.max_stretch < 1e-4, "{totals:?}");
    // Control: at once.
    let at_once = &[(1.0, 0.0), (1.0 + 0.5 * STEP_SECS, 1.0)];
    let (jump, _) = fastest(&keyed(Wave { height: 0.03, ..Wave::default() }, at_once), 0.75);
    assert!(jump > 1.5 * still, "{jump}");
}

#[test]
fn a_seek_gives_the_frame_of_playing_from_its_station() {
    let project = keyed(Wave::default(), &[(1.0, 0.0), (3.0, 1.0)]);
    let mut gone_to = engine_of(&project);
    let mut stepped = engine_of(&project);
    stepped.seek(130.0 * STEP_SECS);
    stepped.settle();
    for step in 131..136 {
        stepped.step();
        gone_to.seek(f64::from(step) * STEP_SECS);
        gone_to.settle();
        assert_eq!(gone_to.state_hash(), stepped.state_hash(), "step {step}");
        assert_eq!(shape(&gone_to.snapshot().scene.style), shape(&stepped.snapshot().scene.style));
    }
    // And a recording that starts there.
    let mut go_on = |_| ControlFlow::Continue(());
    let (mut dance, _) = Dance::open(&project, &Access::new(), 60.0, &mut go_on).expect("a dance");
    dance.begin(135, dance.secs_of(135), &mut go_on).expect("begun");
    assert_eq!(dance.snapshot(135).expect("a frame").guides, stepped.snapshot().guides);
    let mut plain = engine_of(&weighted(&project, 0.0));
    plain.seek(135.0 * STEP_SECS);
    plain.settle();
    assert_ne!(plain.state_hash(), stepped.state_hash(), "control: the layer acts");
}

#[test]
fn a_take_shows_the_hairstyle_of_each_instant() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.take");
    let project = keyed(Curl { radius: 0.01, ..Curl::default() }, &[(0.2, 0.0), (0.8, 1.0)]);
    let mut engine = engine_of(&project);
    engine.settle();
    let mut take = TakeRecording::start(&path, &Arc::new(project.clone()), &engine).expect("a take");
    let mut frames = vec![crate::snapshot::FrameSnapshot::clone(&engine.snapshot())];
    for _ in 1..70 {
        engine.step();
        take.push(&engine).expect("a frame");
        frames.push(crate::snapshot::FrameSnapshot::clone(&engine.snapshot()));
    }
    take.finish().expect("a whole take");
    let mut player = played(&path);
    for n in [0, 20, 30, 69, 12, 40] {
        let frame = player.snapshot(n as f64 / 60.0).expect("a frame");
        assert_eq!(shape(&frame.scene.style), shape(&frames[n].scene.style), "frame {n}");
    }
    assert_ne!(shape(&frames[20].scene.style), shape(&frames[40].scene.style), "control: the layer acts");
}

#[test]
fn a_stiffer_side_moves_less() {
    // Mean distance of tips from their places at rest on the wearer's left and right, over a part of the dance.
    let swing = |mask: Option<Mask>| {
        let mut project = small_project();
        let stiff = Layer::of(Stiffness { factor: 6.0 });
        project
            .hair
            .stack
            .push(mask.map_or(Layer { on: false, ..stiff.clone() }, |mask| Layer { mask, ..stiff }));
        let mut engine = engine_of(&project);
        engine.settle();
        let (mut sums, mut counts) = ([0.0_f32; 2], [0.0_f32; 2]);
        for _ in 0..120 {
            engine.step();
            let now = engine.snapshot();
            let rest = &now.scene.style.guides;
            for g in (0..rest.count()).filter(|g| rest.point(*g, 0).x.abs() > 0.02) {
                let tip = rest.points_per_guide - 1;
                let at = now.guides.world_from_head.transform_point3(rest.point(g, tip));
                let side = usize::from(rest.point(g, 0).x < 0.0);
                sums[side] += at.distance(now.guides.guides.point(g, tip));
                counts[side] += 1.0;
            }
        }
        [sums[0] / counts[0], sums[1] / counts[1]]
    };
    let left = Mask::of(MaskPart { softness: 0.0, ..MaskPart::region(MaskRegion::Left) });
    let nowhere = Mask { parts: Vec::new(), inverted: true };
    let [stiff, none, off] = [Some(left), Some(nowhere), None].map(swing);
    println!("{stiff:?} {none:?} {off:?}");
    assert_eq!(none, off, "control: an empty mask");
    assert!(stiff[0] < 0.8 * off[0], "{} m on the stiff side, {} m without", stiff[0], off[0]);
    assert!((stiff[1] / off[1] - 1.0).abs() < 0.15, "{} m on the other side, {} m", stiff[1], off[1]);
}
