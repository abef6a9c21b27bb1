use std::path::Path;

use lovelock_groom::Preset;
use lovelock_simulation::SimulationSettings;

use super::{Style, shipped};
use crate::Project;
use crate::animation::{Animation, StyleTracks};
use crate::project::{HairMorph, HairSource, parse_project, text_of_project};
use crate::tracks::{Key, MORPH_TARGET, Track};

/// From `smooth` to `curly`.
fn morphing(amount: f32) -> Project {
    let mut project = Project::default();
    project.start_morph(&shipped::by_id("curly").expect("shipped").style);
    project.hair.morph.amount = amount;
    project
}

fn keyed(keys: &[(f64, f64)]) -> Project {
    let mut project = morphing(0.0);
    let keys = keys.iter().map(|&(secs, value)| Key { secs, value: vec![value] }).collect();
    project.timeline.tracks = vec![Track { keys, ..Track::new(MORPH_TARGET) }];
    project
}

#[test]
fn colours_and_motion_are_those_of_the_two_styles_at_the_ends_and_between_them_inside() {
    let curly = &shipped::by_id("curly").expect("shipped").style;
    let own = Project::default();
    let [start, middle, end] = [0.0, 0.5, 1.0].map(morphing);
    assert_eq!(start.seen_at(0.0).look, own.look);
    let wanted = lovelock_groom::HairLook { extinction_scale: own.look.extinction_scale, ..curly.look };
    assert_eq!(end.seen_at(0.0).look, wanted);
    assert_ne!(own.look, wanted, "control: other colours");
    let between = |at: f32, a: f32, b: f32| (at - 0.5 * (a + b)).abs() < 1e-6;
    let seen = middle.seen_at(0.0).look;
    assert!(between(seen.eumelanin, own.look.eumelanin, curly.look.eumelanin), "{}", seen.eumelanin);
    let moves = |project: &Project| Animation::of(project).expect("a morph").simulation_at(0.0);
    assert_eq!(moves(&start), own.simulation);
    assert_eq!(moves(&end).stiffness_root, curly.simulation.stiffness_root);
    let stiffness = moves(&middle).stiffness_root;
    assert!(
        between(stiffness, own.simulation.stiffness_root, curly.simulation.stiffness_root),
        "{stiffness}"
    );
    assert_ne!(own.simulation.stiffness_root, curly.simulation.stiffness_root, "control: other motion");
    // The world is not a style's.
    let mut moon = morphing(1.0);
    moon.simulation.gravity = 1.6;
    assert_eq!(moves(&moon).gravity, 1.6);
    assert_eq!(Animation::of(&own), None);
}

#[test]
fn keys_move_the_amount() {
    let project = keyed(&[(1.0, 0.0), (3.0, 1.0)]);
    let looks = [0.0, 2.0, 9.0].map(|secs| project.seen_at(secs).look);
    let still = [0.0, 0.5, 1.0].map(|amount| morphing(amount).seen_at(0.0).look);
    assert_eq!(looks, still);
    let tracks = StyleTracks::of(&project).expect("a track");
    assert_eq!([0.0, 2.0, 9.0].map(|secs| tracks.values_at(secs).amount()), [0.0, 0.5, 1.0].map(Some));
    assert_eq!(StyleTracks::of(&morphing(0.5)), None);
    assert_eq!(project.timeline.tracks[0].label_in(&project.hair.stack), "Morph");
}

#[test]
fn a_morph_ends_with_either_style() {
    let own = Project::default();
    let mut ended = morphing(0.7);
    ended.end_morph();
    assert_eq!(ended, own);
    let mut taken = morphing(0.7);
    taken.take_morph();
    let mut wanted = own;
    wanted.set_preset(Preset::Curly);
    assert_eq!(taken, wanted);
}

#[test]
fn a_morph_survives_text_and_is_kept_in_range() {
    let project = morphing(0.25);
    let text = text_of_project(Path::new("p.lovelock"), &project).expect("text");
    assert_eq!(
        parse_project(Path::new("p.lovelock"), &text).expect("a project"),
        (project.clone(), Vec::new())
    );
    let mut wild = morphing(f32::NAN);
    let to = wild.hair.morph.to.as_mut().expect("a style");
    to.hair.groom.length = 1e9;
    to.simulation.weight = f32::INFINITY;
    to.name = "x\u{7}".repeat(1000);
    // A chain of styles is not followed.
    to.hair.morph = morphing(0.5).hair.morph;
    let (sane, problems) = wild.sanitised();
    let to = sane.hair.morph.to.as_ref().expect("a style");
    assert!(to.hair.groom.length < 10.0 && to.simulation.weight.is_finite());
    assert_eq!((sane.hair.morph.amount, to.name.len()), (0.0, HairMorph::LONGEST_NAME));
    assert_eq!(to.hair.morph, HairMorph::default());
    assert!(!problems.is_empty());
}

#[test]
fn the_file_of_the_second_style_is_a_file_of_the_project() {
    let mut style = Style::default();
    style.hair.source = HairSource::File;
    style.hair.file = Some(crate::files::FileRef::new("/x/other.hair"));
    let mut project = Project::default();
    project.start_morph(&style);
    assert!(project.files().iter().any(|(_, file)| file.path == Path::new("/x/other.hair")));
    assert!(project.file_refs_mut().any(|file| file.path == Path::new("/x/other.hair")));
    project.end_morph();
    assert!(project.files().is_empty());
    assert_eq!(project.simulation, SimulationSettings::default());
}
