//! Light from a picture of the surroundings, and files that are no such picture.

use std::path::Path;
use std::sync::Arc;

use exr::prelude::write_rgb_file;
use lovelock_project::error::{Place, Problem};
use lovelock_project::files::Access;

use super::SceneLoader;
use crate::take::TakePlayer;
use crate::testing::{recorded, settled, small_project};

/// Writes a picture of one colour with a lamp at the top.
fn picture(path: &Path, width: usize) {
    let radiance = |_: usize, y: usize| if y == 0 { (9.0, 8.0, 7.0) } else { (0.2, 0.3, 0.4) };
    write_rgb_file(path, width, 16, radiance).expect("a picture");
}

#[test]
fn a_picture_of_the_surroundings_lights_every_frame_and_is_read_once() {
    let dir = tempfile::tempdir().expect("a folder");
    let sky = dir.path().join("sky.exr");
    picture(&sky, 32);
    let mut access = Access::new();
    access.pick(&sky);
    let (mut loader, mut project) = (SceneLoader::new(), small_project());
    let (plain, _) = loader.load_now(&project, &access).expect("a scene");
    assert!(plain.surroundings.light.is_none(), "a sky above a ground");
    project.set_surroundings_file(&sky);
    let (scene, problems) = loader.load_now(&project, &access).expect("a scene");
    assert_eq!(problems, []);
    assert!(Arc::ptr_eq(&plain.style, &scene.style) && Arc::ptr_eq(&plain.body, &scene.body), "light alone");
    assert_eq!(scene.surroundings.light.as_ref().map(|of| of.size()), Some([32, 16]));
    let frame = settled(Arc::clone(&scene), &project).snapshot();
    let camera = frame.camera(&project.camera);
    assert!(frame.frame_input(&project, &camera).surroundings.is_some());

    project.hair.groom.length = 0.2;
    let (longer, _) = loader.load_now(&project, &access).expect("a scene");
    let same = |a: &super::Scene, b: &super::Scene| a.surroundings.is(&b.surroundings);
    assert!(same(&scene, &longer), "not read again");
    // A picture that is not twice as wide as high is stretched, which a note says.
    picture(&sky, 48);
    let (changed, problems) = loader.load_now(&project, &access).expect("a scene");
    assert!(!same(&scene, &changed) && problems.is_empty(), "{problems:?}");
    assert!(changed.notes.iter().any(|note| note.place == Place::Surroundings), "{:?}", changed.notes);

    project.surroundings.file = None;
    let (plain, problems) = loader.load_now(&project, &access).expect("a scene");
    assert!(plain.surroundings.light.is_none() && problems.is_empty());
}

#[test]
fn a_file_that_is_no_picture_is_named_and_the_old_light_stays() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name);
    picture(&at("sky.exr"), 32);
    let whole = std::fs::read(at("sky.exr")).expect("a picture");
    std::fs::write(at("cut.exr"), &whole[..whole.len() / 2]).expect("a file");
    std::fs::write(at("text.hdr"), "no picture").expect("a file");
    let access = Access::for_project(&at("p.lovelock"));
    let (mut loader, mut project) = (SceneLoader::new(), small_project());
    let refused = |problems: &[Problem], name: &str| {
        assert!(problems.len() == 1 && problems[0].is_failure(), "{problems:?}");
        assert_eq!(problems[0].place, Place::Surroundings);
        let message = &problems[0].message;
        assert!(message.contains(name) && message.contains("the previous light stays"), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    };
    // Without a picture before, the sky above the ground stays.
    project.set_surroundings_file(at("text.hdr"));
    let (scene, problems) = loader.load_now(&project, &access).expect("a scene");
    refused(&problems, "text.hdr");
    assert!(scene.surroundings.light.is_none());

    project.set_surroundings_file(at("sky.exr"));
    let (before, problems) = loader.load_now(&project, &access).expect("a scene");
    assert_eq!(problems, []);
    for name in ["cut.exr", "text.hdr", "gone.exr"] {
        project.set_surroundings_file(at(name));
        // Every load reports the problem, also those that do not read the file again.
        for _ in 0..2 {
            let (after, problems) = loader.load_now(&project, &access).expect("a scene");
            refused(&problems, name);
            let kept = after.surroundings.light.as_ref().expect("the old light");
            assert!(Arc::ptr_eq(kept, before.surroundings.light.as_ref().expect("a picture")), "{name}");
        }
    }
}

#[test]
fn a_take_plays_in_the_light_of_the_project_that_plays_it() {
    let dir = tempfile::tempdir().expect("a folder");
    let sky = dir.path().join("sky.exr");
    picture(&sky, 32);
    let mut project = small_project();
    project.set_surroundings_file(&sky);
    let access = Access::for_project(&dir.path().join("p.lovelock"));
    let lit = SceneLoader::new().load_now(&project, &access).expect("a scene").0;

    let path = dir.path().join("a.take");
    recorded(&path, &project, 10, |_, _| {});
    let (mut player, _) = TakePlayer::open(&path, &Access::new()).expect("a take that plays");
    let before = player.snapshot(0.0).expect("a frame");
    assert!(before.scene.surroundings.light.is_none());
    assert!(player.set_surroundings(lit.surroundings.clone(), Vec::new()));
    assert!(!player.set_surroundings(lit.surroundings.clone(), Vec::new()), "the same again");
    let after = player.snapshot(0.1).expect("a frame");
    assert!(after.scene.surroundings.light.is_some() && Arc::ptr_eq(&before.scene.style, &after.scene.style));
    assert!(player.set_surroundings(super::Surroundings::default(), Vec::new()));
    assert!(player.snapshot(0.0).expect("a frame").scene.surroundings.light.is_none());
}

#[test]
fn a_picture_behind_the_figure_is_loaded_and_a_broken_one_leaves_its_colour() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name);
    picture(&at("room.exr"), 32);
    std::fs::write(at("text.png"), "no picture").expect("a file");
    let access = Access::for_project(&at("p.lovelock"));
    let (mut loader, mut project) = (SceneLoader::new(), small_project());
    project.set_backdrop_file(at("room.exr"));
    let (scene, problems) = loader.load_now(&project, &access).expect("a scene");
    assert_eq!(problems, []);
    assert_eq!(scene.surroundings.backdrop.as_ref().map(|of| of.size()), Some([32, 16]));
    assert!(scene.surroundings.light.is_none(), "it gives no light");
    let frame = settled(Arc::clone(&scene), &project).snapshot();
    let camera = frame.camera(&project.camera);
    assert!(frame.frame_input(&project, &camera).backdrop.is_some());
    for name in ["text.png", "gone.jpg"] {
        project.set_backdrop_file(at(name));
        let (scene, problems) = loader.load_now(&project, &access).expect("a scene");
        assert!(problems.len() == 1 && problems[0].place == Place::Backdrop, "{problems:?}");
        let message = &problems[0].message;
        assert!(message.contains(name) && message.contains("the background has one colour"), "{message}");
        assert!(scene.surroundings.backdrop.is_none(), "{name}");
    }
}
