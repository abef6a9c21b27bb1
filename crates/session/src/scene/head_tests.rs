//! Every preset on the characters of the folder of real files.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_groom::{GuideFrame, Preset, Strands, interpolate};
use lovelock_motion::LengthUnit;
use lovelock_project::Project;
use lovelock_project::error::Problem;
use lovelock_project::files::Access;

use super::parts::BodyKey;
use super::scalp_part::ScalpPart;
use super::{Scene, SceneLoader};
use crate::testing::small_project;

fn character(name: &str) -> Option<PathBuf> {
    let folder = lovelock_testkit::data_dir()?;
    Some(folder.join("characters").join(name)).filter(|path| path.exists())
}

/// The scene of a project with a character that a person picked, and the problems.
fn load(project: &Project) -> (Arc<Scene>, Vec<Problem>) {
    SceneLoader::new().load_now(project, &access(project)).expect("a scene")
}

fn access(project: &Project) -> Access {
    let mut access = Access::new();
    if let Some(file) = &project.body.file {
        access.pick(&file.path);
    }
    access
}

fn of_preset(preset: Preset) -> Project {
    let mut project = Project::default();
    project.set_preset(preset);
    project.hair.groom.wisps = project.hair.groom.wisps.min(60);
    project.hair.groom.strands_per_wisp = 4;
    project
}

fn strands(scene: &Scene) -> Strands {
    let mut out = Strands::default();
    interpolate(&scene.style, &GuideFrame::at_rest(&scene.style.guides, Affine3A::IDENTITY, 0.0), &mut out);
    out
}

#[test]
fn every_preset_grows_on_every_character_long_suite() {
    for name in
        ["mh_body.glb", "CesiumMan.glb", "robot.glb", "Fox.glb", "MorphStressTest.gltf", "SimpleSkin.gltf"]
    {
        let Some(path) = character(name) else {
            eprintln!("skipped: {name} is not in the folder of real files");
            return;
        };
        for preset in Preset::ALL {
            let mut project = of_preset(preset);
            project.set_body_file(&path);
            let (scene, problems) = load(&project);
            assert!(problems.is_empty(), "{name} {preset:?}: {problems:?}");
            let skull = scene.skull.expect("a skull");
            let key = BodyKey::of(&project.body, &access(&project)).expect("readable");
            let body = key.load().expect("a body");
            let scalp = ScalpPart::new(&body, &project.body.scalp);
            let strands = strands(&scene);
            let at = |i: usize| Vec3::new(strands.x[i], strands.y[i], strands.z[i]);
            let roots: Vec<Vec3> =
                (0..strands.count()).map(|s| at(strands.first_point[s] as usize)).collect();
            assert!(roots.len() > 150, "{name} {preset:?}: {} strands", roots.len());
            let scale = scene.hair_scale;
            let away: Vec<f32> = roots.iter().map(|p| body.rest.distance(*p).0 / scale).collect();
            let share =
                |is: &dyn Fn(f32) -> bool| away.iter().filter(|d| is(**d)).count() as f32 / away.len() as f32;
            let on_skin = share(&|d| d.abs() < 0.002);
            let deep =
                (0..strands.points()).filter(|&i| body.rest.distance(at(i)).0 < -0.004 * scale).count();
            let deep = deep as f32 / strands.points() as f32;
            let of_roots =
                |is: &dyn Fn(Vec3) -> bool| roots.iter().filter(|p| is(skull.relative(**p))).count();
            let crown = of_roots(&|p| p.normalize_or_zero().y > 0.85);
            let face = of_roots(&|p| p.z > 0.3 && p.y < -0.1 && p.x.abs() < 0.5);
            eprintln!(
                "{name} {preset:?}: scale {scale:.3}, half {:.3}, on skin {on_skin:.2}, inside {deep:.4}, crown {crown}, face {face}, head at {:.2}",
                skull.half,
                body.body.skeleton.rest_position(body.body.head_joint) + skull.middle
            );
            // A sheet encloses nothing: its scalp is a cap around it.
            let is_sheet = scalp.notes.iter().any(|note| note.message.contains("encloses no skull"));
            assert_eq!(is_sheet, ["SimpleSkin.gltf", "MorphStressTest.gltf"].contains(&name), "{name}");
            assert!(is_sheet || on_skin > 0.5, "{name} {preset:?}: {on_skin} on the skin");
            assert!(is_sheet || deep < 0.01, "{name} {preset:?}: {deep} of the points are inside the body");
            assert!(crown > 4, "{name} {preset:?}: {crown} roots on the crown");
            assert_eq!(face, 0, "{name} {preset:?}: roots in the face");
        }
    }
}

#[test]
fn a_head_of_a_hundred_times_the_size_wears_the_same_hair() {
    let Some(path) = character("mh_body.glb") else {
        eprintln!("skipped: mh_body.glb is not in the folder of real files");
        return;
    };
    let styled = |unit| {
        let mut project = of_preset(Preset::Ponytail);
        project.set_body_file(&path);
        project.body.settings.unit = unit;
        load(&project).0
    };
    let (large, small) = (styled(LengthUnit::Metres), styled(LengthUnit::Centimetres));
    let scale = large.hair_scale / small.hair_scale;
    assert!((scale / 100.0 - 1.0).abs() < 0.05, "{scale}");
    let (a, b) = (strands(&large), strands(&small));
    assert_eq!(a.points(), b.points());
    let near = (0..a.points())
        .filter(|&i| {
            let [p, q] = [&a, &b].map(|s| Vec3::new(s.x[i], s.y[i], s.z[i]));
            p.distance(q * 100.0) < 0.006 * large.hair_scale
        })
        .count();
    let near = near as f32 / a.points() as f32;
    assert!(near > 0.9, "{near} of the points lie alike");
}

#[test]
fn the_dancers_own_scalp_stays_until_it_is_corrected() {
    let scene = crate::testing::scene();
    assert_eq!(scene.hair_scale, 1.0);
    let mut loader = SceneLoader::new();
    let mut project = small_project();
    let mut load = |project: &Project| loader.load_now(project, &Access::new()).expect("a scene").0;
    let plain = load(&project);
    assert_eq!(plain.style.scalp, scene.style.scalp);
    assert!(Arc::ptr_eq(&plain.body, &load(&project).body));
    project.body.scalp.paint(Vec3::Y, 0.5, 1.0, true);
    let shaved = load(&project);
    let skull = shaved.skull.expect("a skull");
    let on_top = |scene: &Scene| {
        let guides = &scene.style.guides;
        let toward = |g: usize| skull.relative(guides.point(g, 0)).normalize_or_zero().y;
        (0..guides.count()).filter(|&g| toward(g) > 0.95).count()
    };
    assert!(on_top(&plain) > 0 && on_top(&shaved) == 0, "{} and {}", on_top(&plain), on_top(&shaved));
    project.body.scalp = lovelock_motion::ScalpFit::default();
    for place in 0..lovelock_motion::ScalpFit::PLACES.len() {
        project.body.scalp.raise_at(place, 0.3);
    }
    let raised = load(&project);
    let area = |scene: &Scene| scene.style.scalp.hairy_area(0.5);
    assert!(area(&raised) < 0.85 * area(&plain), "{} of {}", area(&raised), area(&plain));
}

#[test]
fn a_file_that_is_no_character_is_refused_in_a_sentence() {
    for name in [
        "RecursiveNodes.gltf",
        "BoxWithInfinites.glb",
        "IndexOutOfRange.gltf",
        "badArray.gltf",
        "quad_skin.glb",
        "BoxTextured.gltf",
    ] {
        let Some(path) = character("broken").map(|folder| folder.join(name)).filter(|path| path.exists())
        else {
            eprintln!("skipped: {name} is not in the folder of real files");
            return;
        };
        let mut project = small_project();
        project.set_body_file(&path);
        let (scene, problems) = load(&project);
        // What can be read has a scalp or says why not.
        assert!(scene.style.strands.count() > 0 || !problems.is_empty(), "{name}");
        for problem in problems {
            assert!(problem.message.len() > 20, "{name}: {problem}");
            eprintln!("{name}: {problem}");
        }
    }
}
