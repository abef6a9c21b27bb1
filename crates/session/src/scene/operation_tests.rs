use std::path::Path;
use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::{Blade, HairTie, Haircut, Strands, TieKind};
use lovelock_project::Project;
use lovelock_project::error::{Place, ProblemKind};
use lovelock_project::files::Access;
use lovelock_project::project::{project_of_text, text_of_project};
use lovelock_style::operations::Length;
use lovelock_style::{Layer, Mask, MaskPart, MaskRegion, Operation, UnknownOperation};

use super::Scene;
use super::loader::SceneLoader;
use crate::snapshot::FrameSnapshot;
use crate::testing::{settled, small_project};

fn load(loader: &mut SceneLoader, project: &Project) -> Arc<Scene> {
    let (scene, problems) = loader.load_now(project, &Access::new()).expect("a scene");
    assert_eq!(problems, []);
    scene
}

fn saved_and_read(project: &Project) -> Project {
    let path = Path::new("hair.lovelock");
    let text = text_of_project(path, project).expect("it is written");
    let (project, problems) = project_of_text(path, &text).expect("it is read");
    assert_eq!(problems, []);
    project
}

#[test]
fn a_tied_project_is_saved_loaded_and_untied() {
    let mut loader = SceneLoader::new();
    let mut project = small_project();
    project.hair.groom.length = 0.5;
    let loose = load(&mut loader, &project);
    project.hair.ties = vec![HairTie { kind: TieKind::Bun, ..HairTie::default() }];
    let tied = load(&mut loader, &project);
    assert!(loose.style.held.is_empty() && tied.style.held.iter().any(|h| *h > 0.0));
    assert_ne!(loose.style.guides, tied.style.guides);

    let again = saved_and_read(&project);
    assert_eq!(again.hair.ties, project.hair.ties);
    assert_eq!(load(&mut SceneLoader::new(), &again).style.guides, tied.style.guides);
    project.motion.speed = 0.5;
    assert!(Arc::ptr_eq(&load(&mut loader, &project).style, &tied.style), "another speed does not tie again");
    project.hair.ties.clear();
    assert!(Arc::ptr_eq(&load(&mut loader, &project).style, &loose.style));

    // One that gathers nothing is said by the name that the window gives it.
    let far = HairTie { at: Vec3::new(0.0, 0.6, -0.6), ..HairTie::default() };
    project.hair.ties = vec![HairTie { kind: TieKind::Bun, ..HairTie::default() }, far];
    let (_, problems) = loader.load_now(&project, &Access::new()).expect("a scene");
    let is_it =
        problems.len() == 1 && problems[0].place == Place::Hair && problems[0].kind == ProblemKind::Ignored;
    assert!(is_it && problems[0].message.starts_with("\"Ponytail 2\" gathers no hair"), "{problems:?}");

    project.hair.ties = vec![HairTie { radius: -1.0, ..HairTie::default() }; 20];
    let (sane, problems) = project.sanitised();
    assert_eq!((sane.hair.ties.len(), sane.hair.ties[0].radius), (HairTie::MAX, 0.004));
    assert!(!problems.is_empty());
}

#[test]
fn a_cut_in_motion_is_kept_by_the_project_and_undone_with_it() {
    let mut loader = SceneLoader::new();
    let mut project = small_project();
    let mut engine = settled(load(&mut loader, &project), &project);
    engine.advance_to_step(40);
    let before = engine.snapshot();
    let chin = Blade::Plane { point: Vec3::new(0.0, -0.02, 0.0), normal: Vec3::NEG_Y };
    let world = chin.moved(&before.guides.world_from_head);
    let cut = Haircut::of(&before.scene.style, &before.guides, &world).expect("it meets hair");
    let uncut = project.clone();
    project.hair.cut = project.hair.cut.and(&cut);

    let project = saved_and_read(&project);
    let short = load(&mut loader, &project);
    assert!(short.style.strands.points() < before.scene.style.strands.points());
    engine.set_scene(Arc::clone(&short));
    let after = engine.snapshot();
    let (a, b, rest) = (&before.guides.guides, &after.guides.guides, &short.style.guides);
    for g in 0..rest.count() {
        for i in 1..rest.points_per_guide {
            if rest.point(g, i) != rest.point(g, i - 1) {
                // A chain of 31 links is rebuilt in f32.
                assert!(a.point(g, i).distance(b.point(g, i)) < 2e-5, "guide {g} jumps at {i}");
            }
        }
    }
    engine.advance_to_step(80);
    assert_eq!(engine.totals().recovered_guides, 0);
    assert!(engine.totals().max_stretch < 1e-5);

    let whole = load(&mut loader, &uncut);
    assert_eq!(whole.style.strands.points(), before.scene.style.strands.points());

    let mut other = project.clone();
    other.hair.groom.wisps = 20;
    let (_, problems) = loader.load_now(&other, &Access::new()).expect("a scene");
    assert!(
        problems.iter().any(|p| p.place == Place::Hair && p.kind == ProblemKind::Ignored),
        "{problems:?}"
    );
}

#[test]
fn light_and_shadow_do_not_change_the_motion() {
    let scene = load(&mut SceneLoader::new(), &small_project());
    let moved = |change: &dyn Fn(&mut Project)| {
        let mut project = small_project();
        change(&mut project);
        let mut engine = settled(Arc::clone(&scene), &project);
        engine.follow(&project);
        engine.advance_to_step(60);
        engine.state_hash()
    };
    let as_it_is = moved(&|_| {});
    let other_light = moved(&|project| {
        project.lights.truncate(1);
        project.lights[0].direction = Vec3::new(-1.0, -0.2, 0.4);
        project.shadow.method = lovelock_render::ShadowMethod::VoxelMap;
        project.shadow.voxel_map.resolution = 16;
        project.camera.azimuth = 2.0;
        project.look.diameter *= 2.0;
    });
    assert_eq!(as_it_is, other_light, "appearance must not change the motion");
    assert_ne!(
        as_it_is,
        moved(&|project| project.simulation.repulsion.strength = 1.0),
        "control: the hash depends on the motion"
    );
}

/// The largest distance of a strand point between two snapshots, metres.
fn furthest_of(a: &FrameSnapshot, b: &FrameSnapshot) -> f32 {
    let of = |frame: &FrameSnapshot| {
        let mut strands = Strands::default();
        frame.interpolate(&mut strands);
        strands
    };
    let (a, b) = (of(a), of(b));
    (0..a.x.len()).map(|i| a.point(i).distance(b.point(i))).fold(0.0, f32::max)
}

#[test]
fn strands_that_are_tied_in_motion_do_not_jump() {
    let mut loader = SceneLoader::new();
    let mut project = small_project();
    project.hair.groom.length = 0.5;
    let loose = load(&mut loader, &project);
    project.hair.ties = vec![HairTie::default()];
    let tied = load(&mut loader, &project);
    for [from, to] in [[&loose, &tied], [&tied, &loose]] {
        let mut engine = settled(Arc::clone(from), &project);
        engine.advance_to_step(40);
        let before = engine.snapshot();
        assert!(!engine.set_scene(Arc::clone(to)), "the hair keeps moving");
        let after = engine.snapshot();
        let jump = furthest_of(&before, &after);
        // Guides and the frames along them are rebuilt in f32.
        assert!(jump < 5e-4, "{jump} m at once");
        // Control: strands that change at once.
        let mut combed = FrameSnapshot::clone(&after);
        combed.scene = Arc::clone(to);
        assert!(furthest_of(&before, &combed) > 3e-3, "{}", furthest_of(&before, &combed));
        engine.advance_to_step(40 + 60);
        let there = engine.snapshot();
        assert!(Arc::ptr_eq(&there.scene, to), "a second later it is the style itself");
        assert!(engine.totals().max_stretch < 1e-5);
    }
}

#[test]
fn layers_act_after_ties_and_survive_the_project_file() {
    let mut loader = SceneLoader::new();
    let mut project = small_project();
    let plain = load(&mut loader, &project);
    let left = Mask::of(MaskPart::region(MaskRegion::Left));
    let shorter = Layer { mask: left, ..Layer::of(Length { factor: 0.4, ..Length::default() }) };
    project.hair.stack.push(shorter);
    let project = saved_and_read(&project);
    let cut = load(&mut loader, &project);
    // Guides of a wisp stay as long as its longest strand needs, so the mean is halved and not the maximum.
    let mean = |scene: &Scene, side: f32| {
        let guides = &scene.style.guides;
        let length = |g: usize| {
            (1..guides.points_per_guide)
                .map(|p| guides.point(g, p).distance(guides.point(g, p - 1)))
                .sum::<f32>()
        };
        let of_side: Vec<f32> =
            (0..guides.count()).filter(|&g| guides.point(g, 0).x * side > 0.03).map(length).collect();
        of_side.iter().sum::<f32>() / of_side.len() as f32
    };
    assert_eq!(mean(&cut, -1.0), mean(&plain, -1.0));
    let part = mean(&cut, 1.0) / mean(&plain, 1.0);
    assert!(part < 0.6, "{part}");
}

#[test]
fn a_layer_of_another_version_is_kept_and_said() {
    let mut project = small_project();
    let operation =
        Operation::Unknown(UnknownOperation { id: "crystal".to_owned(), ..UnknownOperation::default() });
    project.hair.stack.push(Layer { operation, ..Layer::default() });
    let project = saved_and_read(&project);
    assert_eq!(project.hair.stack.layers[0].operation.id(), "crystal");
    let (_, problems) = SceneLoader::new().load_now(&project, &Access::new()).expect("a scene");
    assert_eq!(problems.len(), 1);
    assert_eq!((problems[0].place, problems[0].kind.clone()), (Place::Hair, ProblemKind::Ignored));
    assert!(problems[0].message.contains("`crystal`"), "{}", problems[0].message);
}
