use std::path::Path;

use lovelock_base::settings::entries;
use lovelock_groom::{GroomSettings, HairLook, Preset};
use lovelock_simulation::SimulationSettings;
use lovelock_style::operations::{Curl, Wave};
use lovelock_style::{Layer, StyleStack};

use super::*;
use crate::Project;
use crate::project::{HairSection, HairSource, parse_project, text_of_project};

fn parse(text: &str) -> Style {
    Style::parse(Path::new("s"), text).expect("a style").0
}

#[test]
fn a_style_survives_text_and_missing_fields_have_their_defaults() {
    let mut project = Project::default();
    project.set_preset(Preset::Curly);
    project.hair.stack.push(Layer::of(Wave::default()));
    project.simulation.hold = 12.0;
    let style = Style {
        name: "Mine".to_owned(),
        text: "A sentence.".to_owned(),
        tags: vec!["short".to_owned()],
        ..Style::of_project(&project)
    };
    let text = style.text_of(Path::new("s.lovelockstyle")).expect("text");
    assert_eq!(Style::parse(Path::new("s"), &text).expect("a style"), (style, Vec::new()));
    assert_eq!(parse("(version: 3)"), Style::default());
}

#[test]
fn a_project_is_a_style_and_old_ones_are_migrated() {
    let mut project = Project::default();
    project.set_preset(Preset::Long);
    project.camera.distance = 3.0;
    let text = text_of_project(Path::new("p.lovelock"), &project).expect("text");
    assert_eq!(parse(&text), Style::of_project(&project));
    let old = "(version: 2, hair: (preset: long), simulation: (drag: 0.8, settle: 2.0))";
    assert_eq!(parse(old).simulation.settle, SimulationSettings::preset(Preset::Long).settle);
    let wild = "(version: 3, look: (roughness: 77.0), sparkle: 1)";
    let (style, problems) = Style::parse(Path::new("s"), wild).expect("a style");
    assert!(style.look.roughness <= 1.0);
    assert_eq!(problems.len(), 2, "{problems:?}");
}

#[test]
fn bad_files_are_refused_with_a_sentence() {
    let refused = |text: &str| Style::parse(Path::new("s"), text).expect_err("refused").to_string();
    assert!(refused("(version: 99)").contains("newer"), "{}", refused("(version: 99)"));
    for (text, says) in [
        ("", "s: is empty; must be a Lovelock style"),
        (" \n", "s: is empty; must be a Lovelock style"),
        ("\u{0}\u{1}", "s: begins with a control character; must be a Lovelock style"),
        ("hello\nthere", "s: begins with “hello”; must be a Lovelock style"),
        (
            "{ \"a\": \"a long text in JSON\" }",
            "s: begins with “{ \"a\": \"a long text”; must be a Lovelock style",
        ),
    ] {
        assert_eq!(refused(text), says);
    }
    for text in ["(version: 3, hair: (", "(version: 3, name: 4)", &"(".repeat(100_000)] {
        let message = refused(text);
        assert!(message.starts_with("s: line ") && message.ends_with("must be a style"), "{message}");
    }
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("large.lovelockstyle");
    std::fs::File::create(&path).expect("a file").set_len(100 << 20).expect("a hole");
    let message = Style::load(&path).expect_err("refused").to_string();
    assert!(message.contains("largest size of a style"), "{message}");
    assert!(Style::load(dir.path()).expect_err("refused").to_string().contains("is a folder"));
    std::fs::write(&path, "(version: 3)").expect("a file");
    assert_eq!(Style::load(&path).expect("a style").0.name, "large", "named as its file");
}

#[test]
fn a_style_brings_its_look_without_the_settings_that_all_styles_share() {
    let own = HairLook::default();
    let other = HairLook { extinction_scale: 0.5, eumelanin: 0.25, ..own };
    let (own_entries, other_entries) = (entries(&own), entries(&other));
    let taken = own.with_style(&other);
    for (entry, (own, other)) in entries(&taken).into_iter().zip(own_entries.into_iter().zip(other_entries)) {
        let is_shared = HairLook::SHARED.contains(&&entry.path[..]);
        assert!(!is_shared || own.value != other.value, "control: {} differs", entry.path);
        assert_eq!(entry.value, if is_shared { own.value } else { other.value }, "{}", entry.path);
    }
    assert_eq!(taken.eumelanin, 0.25);
}

#[test]
fn parts_are_taken_apart() {
    let style = &shipped::by_id("curly").expect("shipped").style;
    let of = |parts| {
        let mut project = Project::default();
        project.look.extinction_scale = 0.5;
        project.apply_style(style, parts);
        assert_eq!(project.look.extinction_scale, 0.5);
        project.look.extinction_scale = Project::default().look.extinction_scale;
        project
    };
    let start = Project::default();
    let all = of(StyleParts::ALL);
    assert!(all.hair != start.hair && all.look != start.look && all.simulation != start.simulation);
    let shape = of(StyleParts::SHAPE);
    assert_eq!((&shape.hair, shape.look, shape.simulation), (&all.hair, start.look, start.simulation));
    let colour = of(StyleParts::COLOUR);
    assert_eq!((&colour.hair, colour.look, colour.simulation), (&start.hair, all.look, start.simulation));
    let motion = of(StyleParts::MOTION);
    assert_eq!((&motion.hair, motion.look, motion.simulation), (&start.hair, start.look, all.simulation));
}

#[test]
fn a_style_replaces_the_layers_of_its_parts() {
    let stack = |operations: [lovelock_style::Operation; 2]| {
        let mut stack = StyleStack::default();
        for operation in operations {
            stack.push(Layer::of(operation));
        }
        stack
    };
    let mut project = Project::default();
    project.hair.stack = stack([Wave::default().into(), Wave::default().into()]);
    let mut style = Style::default();
    style.hair.stack = stack([Curl::default().into(), Curl::default().into()]);
    let layers = style.hair.stack.layers.clone();
    style.hair.stack.make_group(&[layers[1].id], "Ends");
    let mut colours = project.clone();
    colours.apply_style(&style, StyleParts::COLOUR);
    assert_eq!(colours.hair, project.hair, "none of them changes colours");
    let mut shape = project.clone();
    shape.apply_style(&style, StyleParts::SHAPE);
    assert_eq!(shape.hair.stack, style.hair.stack);
}

#[test]
fn shipped_presets_are_those_of_groom() {
    for preset in Preset::ALL {
        let style = &shipped::by_id(preset.id()).expect("shipped").style;
        assert_eq!(style.hair.groom, GroomSettings::preset(preset));
        assert_eq!(style.hair.ties, preset.ties());
        assert_eq!(style.simulation, SimulationSettings::preset(preset));
    }
    let message = unknown_style("curley").to_string();
    assert!(message.contains("`curley`") && message.contains("`curly`"), "{message}");
}

#[test]
fn controls_return_to_the_style_and_motion_follows_it() {
    let mut own = Style { name: "Own".to_owned(), ..Style::default() };
    own.hair.style = "own/Own".to_owned();
    (own.simulation.stiffness_root, own.simulation.weight) = (60.0, 2.0);
    let mut project = Project::default();
    project.apply_style(&own, StyleParts::ALL);
    assert_eq!(project.simulation, own.simulation);
    assert_eq!(project.hair.simulation(), own.simulation, "controls return to it");
    let text = text_of_project(Path::new("p"), &project).expect("text");
    assert_eq!(parse_project(Path::new("p"), &text).expect("a project"), (project.clone(), Vec::new()));
    project.set_preset(Preset::Long);
    assert_eq!(project.simulation, SimulationSettings::preset(Preset::Long), "nobody chose the other");
    project.hair.style = "of-another-version".to_owned();
    assert_eq!(project.hair.simulation(), SimulationSettings::preset(Preset::Long));
    assert_eq!(project.hair.shipped_groom(), GroomSettings::preset(Preset::Long));
}

#[test]
fn a_picked_hair_file_can_be_returned_to() {
    let mut project = Project::default();
    project.set_hair_file("/x.hair");
    project.apply_style(&Style::of_preset(Preset::Curly), StyleParts::ALL);
    assert_eq!(project.hair.source, HairSource::Grown);
    assert!(project.hair.file.is_some());
}

#[test]
fn every_file_reads_without_problems_and_says_what_it_is() {
    let mut ids = std::collections::BTreeSet::new();
    for (id, text) in shipped::FILES {
        let (style, problems) = Style::parse(Path::new(id), text).expect("a style");
        assert_eq!(problems, [], "{id}");
        assert!(!style.name.is_empty() && style.text.ends_with('.') && !style.tags.is_empty(), "{id}");
        assert_eq!(style.hair.stack.unknown(), [], "{id}");
        assert_eq!(style.hair.source, HairSource::Grown, "{id}");
    }
    let mut names = std::collections::BTreeSet::new();
    for shipped in shipped() {
        assert!(ids.insert(shipped.id) && names.insert(&shipped.style.name), "{} twice", shipped.id);
        let strands = shipped.style.strands().expect("grown");
        assert!((300..=40_000).contains(&strands), "{}: {strands} strands", shipped.id);
    }
}

#[test]
fn the_examples_of_the_documents_are_whole() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/examples");
    let files = std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let styles: Vec<_> =
        files.filter(|path| path.extension().is_some_and(|of| of == STYLE_EXTENSION)).collect();
    assert!(styles.len() >= 6, "{styles:?}");
    for path in styles {
        let (style, problems) = Style::load(&path).expect("a style");
        assert!(problems.is_empty(), "{}: {problems:?}", path.display());
        assert!(!style.hair.stack.layers.is_empty() && style.hair.stack.unknown().is_empty());
    }
}

#[test]
fn layers_of_a_style_go_with_it_and_those_of_the_user_stay() {
    let style = |operation: lovelock_style::Operation| {
        let mut stack = StyleStack::default();
        stack.push(Layer::of(operation));
        Style {
            hair: HairSection { stack, style: "own/a".to_owned(), ..HairSection::default() },
            ..Style::default()
        }
    };
    let kinds = |project: &Project| -> Vec<&str> {
        let known = |layer: &Layer| layer.operation.known().map(|operation| operation.kind().id);
        project.hair.stack.layers.iter().filter_map(known).collect()
    };
    let mut project = Project::default();
    assert_eq!(project.apply_style_below_layers(&style(Curl::default().into()), StyleParts::ALL), 0);
    project.hair.stack.push(Layer::of(Wave::default()));
    let users = project.hair.stack.layers[1].id;
    assert_eq!(project.apply_style_below_layers(&style(Curl::default().into()), StyleParts::ALL), 1);
    assert_eq!(kinds(&project), ["curl", "wave"], "the curls of the style are not there twice");
    assert!(project.hair.stack.layer(users).is_some());
    // The next style takes the curls away, and the file keeps what belongs to whom.
    let (saved, problems) = project.sanitised();
    assert!(problems.is_empty() && saved == project, "{problems:?}");
    assert_eq!(project.apply_style_below_layers(&Style::of_preset(Preset::Bun), StyleParts::ALL), 1);
    assert_eq!(kinds(&project), ["wave"]);
    // The control: a command replaces all.
    project.apply_style(&Style::of_preset(Preset::Bun), StyleParts::ALL);
    assert!(kinds(&project).is_empty());
}
