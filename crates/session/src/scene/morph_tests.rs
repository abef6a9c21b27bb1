use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_groom::{GuideFrame, Strands};
use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_project::styles::Style;
use lovelock_project::tracks::{Key, MORPH_TARGET, Track};
use lovelock_style::Layer;
use lovelock_style::operations::Curl;

use super::{Scene, SceneLoader};
use crate::clock::STEP_SECS;
use crate::engine::Engine;
use crate::testing::{farthest, load, small_project};

/// Another style than the small project's: shorter, with other roots, and curled.
fn other() -> Project {
    let mut project = small_project();
    (project.hair.groom.wisps, project.hair.groom.seed) = (20, 9);
    project.hair.groom.length = 0.12;
    project.hair.stack.push(Layer::of(Curl { radius: 0.01, ..Curl::default() }));
    project.simulation.hold = 30.0;
    project
}

fn morphing(amount: f32) -> Project {
    let mut project = small_project();
    project.start_morph(&Style::of_project(&other()));
    project.hair.morph.amount = amount;
    project
}

fn engine_of(project: &Project) -> Engine {
    let mut engine = Engine::at_rest(load(project).0, project.simulation, STEP_SECS);
    engine.follow(project);
    engine
}

/// Roots and tips of the strands that are longer than two millimetres, at rest.
fn strands(scene: &Scene) -> Vec<[Vec3; 2]> {
    let guides = scene.style.guides.clone();
    let frame = GuideFrame { time_secs: 0.0, world_from_head: Affine3A::IDENTITY, guides };
    let mut strands = Strands::default();
    lovelock_groom::interpolate(&scene.style, &frame, &mut strands);
    let ends =
        strands.first_point.windows(2).map(|ends| [ends[0], ends[1] - 1].map(|i| strands.point(i as usize)));
    ends.filter(|[root, tip]| root.distance(*tip) > 0.002).collect()
}

/// The largest distance of a strand of `a` from the nearest of `b`, by roots and tips, metres.
fn apart(a: &[[Vec3; 2]], b: &[[Vec3; 2]]) -> f32 {
    let between = |a: &[Vec3; 2], b: &[Vec3; 2]| a[0].distance(b[0]).max(a[1].distance(b[1]));
    let nearest = |a| b.iter().map(|b| between(a, b)).fold(f32::INFINITY, f32::min);
    a.iter().map(nearest).fold(0.0, f32::max)
}

#[test]
fn a_scene_at_the_ends_of_a_morph_has_the_strands_of_the_two_styles() {
    let scenes = [0.0, 0.5, 1.0].map(|amount| load(&morphing(amount)).0);
    let [own, second] = [small_project(), other()].map(|project| load(&project).0);
    let [start, middle, end] = scenes.each_ref().map(|scene| strands(scene));
    let [own, second] = [strands(&own), strands(&second)];
    assert_eq!((start.len(), end.len()), (own.len(), second.len()));
    let most = apart(&start, &own).max(apart(&end, &second));
    println!("{most} m at the ends, {} m in the middle", apart(&middle, &own));
    assert!(most < 1e-5 && apart(&middle, &own) > 0.005, "{most}");
    let layout = |scene: &Arc<Scene>| (scene.style.guides.count(), scene.style.guides.points_per_guide);
    assert_eq!(layout(&scenes[0]), layout(&scenes[2]));
}

#[test]
fn a_dragged_amount_keeps_the_hair_moving_without_a_jump_long_suite() {
    let (access, mut loader) = (Access::new(), SceneLoader::new());
    let fastest = |amounts: &mut dyn FnMut(u32) -> f32, loader: &mut SceneLoader| {
        let mut project = morphing(0.0);
        let mut engine =
            Engine::new(loader.load_now(&project, &access).expect("a scene").0, project.simulation);
        engine.follow(&project);
        engine.settle();
        let mut last = crate::snapshot::FrameSnapshot::clone(&engine.snapshot());
        let mut fastest = 0.0_f32;
        for step in 0..120 {
            let amount = amounts(step);
            if amount.to_bits() != project.hair.morph.amount.to_bits() {
                project.hair.morph.amount = amount;
                let scene = loader.load_now(&project, &access).expect("a scene").0;
                assert!(!engine.set_scene(scene), "the hair keeps moving");
                engine.follow(&project);
            }
            engine.step();
            let now = crate::snapshot::FrameSnapshot::clone(&engine.snapshot());
            fastest = fastest.max(farthest(&last, &now));
            last = now;
        }
        assert_eq!(engine.totals().recovered_guides, 0);
        fastest
    };
    let still = fastest(&mut |_| 0.0, &mut loader);
    let dragged = fastest(&mut |step| (step as f32 / 100.0).min(1.0), &mut loader);
    let at_once = fastest(&mut |step| if step < 60 { 0.0 } else { 1.0 }, &mut loader);
    println!("{still} m a step, {dragged} m while it morphs, {at_once} m at once");
    assert!(dragged < 2.0 * still && at_once > 1.2 * dragged, "{still}, {dragged}, {at_once}");
}

#[test]
fn keys_give_the_hair_of_their_amounts() {
    let mut project = morphing(0.0);
    let key = |(secs, value)| Key { secs, value: vec![value] };
    let keys = [(0.5, 0.0), (1.5, 1.0)].map(key).to_vec();
    project.timeline.tracks = vec![Track { keys, ..Track::new(MORPH_TARGET) }];
    let mut engine = engine_of(&project);
    for (secs, amount) in [(0.0, 0.0), (1.0, 0.5), (2.0, 1.0)] {
        engine.seek(secs);
        let plain = load(&morphing(amount)).0;
        let now = engine.snapshot();
        assert_eq!(
            (&now.scene.style.guides, &now.scene.style.strands),
            (&plain.style.guides, &plain.style.strands)
        );
    }
    engine.seek(4.0);
    engine.settle();
    let mut still = engine_of(&morphing(1.0));
    still.seek(4.0);
    still.settle();
    assert_eq!(engine.state_hash(), still.state_hash());
    let mut control = engine_of(&morphing(0.0));
    control.seek(4.0);
    control.settle();
    assert_ne!(control.state_hash(), still.state_hash());
}

#[test]
fn a_file_that_is_missing_leaves_the_first_style() {
    let mut project = morphing(0.5);
    let to = project.hair.morph.to.as_mut().expect("a style");
    to.hair.source = lovelock_project::project::HairSource::File;
    to.hair.file = Some(lovelock_project::files::FileRef::new("/nowhere/a.hair"));
    let (scene, problems) = load(&project);
    assert!(problems.iter().any(|problem| problem.message.contains("a.hair")), "{problems:?}");
    assert!(scene.style.strands.first_point.len() > 1);
}
