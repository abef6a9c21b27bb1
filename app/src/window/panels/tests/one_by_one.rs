//! The panels one by one.

use egui::accesskit::{Role, Toggled};
use egui_kittest::kittest::{NodeT, Queryable};
use glam::Vec3;
use lovelock_groom::{GroomSettings, HAIR_COLOURS, HairTie, Preset, TieKind, Unit};
use lovelock_project::Project;
use lovelock_project::project::{BodySource, HairSource, MotionSource};
use lovelock_render::{HairDrawing, LightKind, MAX_LIGHTS, ShadowMethod, VoxelDeposit};
use lovelock_session::stats::Stage;
use lovelock_simulation::SimulationSettings;

use super::{Bench, panel};
use crate::window::command::Command;
use crate::window::pointer_tool::PointerTool;
use crate::window::purpose::Purpose;
use crate::window::testing::{Shown, control, controls, drag, is_on, texts, tooltip_at, type_at};

/// Chooses an entry of a combo box.
pub(super) fn choose<S>(harness: &mut egui_kittest::Harness<'_, S>, name: &str, entry: &str) {
    control(harness, Role::ComboBox, name).click();
    harness.run();
    control(harness, Role::Button, entry).click();
    harness.run();
}

#[test]
fn presets_are_applied_with_their_colours() {
    let mut harness = panel("Hairstyle", Project::default());
    harness.get_by_label(Preset::Curly.label()).click();
    harness.run();
    let project = &harness.state().state.project;
    assert_eq!(project.hair.preset, Preset::Curly);
    assert_eq!(project.hair.groom, GroomSettings::preset(Preset::Curly));
    assert_eq!(project.look, GroomSettings::preset(Preset::Curly).look);
    assert_eq!(project.simulation, project.hair.simulation());
    assert_ne!(project.simulation, Project::default().simulation, "curls are springs");
    let length = control(&harness, Role::SpinButton, "Length").rect().center();
    type_at(&mut harness, length, "12.5");
    assert_eq!(
        harness.state().state.project.hair.groom.length,
        0.125,
        "centimetres are shown, metres are kept"
    );
    control(&harness, Role::Button, "Defaults").click();
    harness.run();
    assert_eq!(harness.state().state.project.hair.groom, GroomSettings::preset(Preset::Curly));
}

#[test]
fn a_hair_file_is_requested_only_if_there_is_none() {
    let mut harness = panel("Hairstyle", Project::default());
    harness.get_by_label("From file…").click();
    harness.run();
    assert_eq!(harness.state().state.asked, [Command::PickFile(Purpose::Open)]);
    let mut project = Project::default();
    project.set_hair_file("/x.hair");
    project.hair.source = HairSource::Grown;
    harness.state_mut().state = Bench::new(project);
    harness.run();
    harness.get_by_label("From file…").click();
    harness.run();
    assert_eq!(harness.state().state.asked, []);
    assert_eq!(harness.state().state.project.hair.source, HairSource::File);
    choose(&mut harness, "Unit", "Inches");
    assert_eq!(harness.state().state.project.hair.import.unit, Unit::Inch);
    harness.state_mut().state.project.hair.import.unit = Unit::Custom(0.5);
    harness.run();
    assert_eq!(control(&harness, Role::ComboBox, "Unit").value().as_deref(), Some("0.5 m"), "not left empty");
}

#[test]
fn body_clip_file_and_head_joint_are_chosen() {
    let mut harness = panel("Body and motion", Project::default());
    let body = &mut harness.state_mut().state.body;
    body.joints = vec!["hips".to_owned(), "hips/head".to_owned()];
    body.head = "hips/head".to_owned();
    body.notes = vec!["one note".to_owned()];
    harness.run();
    assert!(harness.query_by_label("one note").is_some());
    harness.get_by_label("walk").click();
    harness.run();
    assert_eq!(harness.state().state.project.motion.clip, "walk");
    harness.get_by_label("Rest").click();
    harness.run();
    assert_eq!(harness.state().state.project.motion.source, MotionSource::Rest);
    harness.get_by_label("Motion file…").click();
    harness.run();
    assert_eq!(harness.state().state.asked, [Command::PickFile(Purpose::Motion)]);
    harness.get_by_label("Character file…").click();
    harness.run();
    assert_eq!(harness.state().state.asked.last(), Some(&Command::PickFile(Purpose::Body)));
    assert_eq!(harness.state().state.project.body.source, BodySource::Dancer, "no file yet");
    choose(&mut harness, "Head joint", "hips");
    assert_eq!(harness.state().state.project.body.head_joint.as_deref(), Some("hips"));
    choose(&mut harness, "Head joint", "Guess");
    assert_eq!(harness.state().state.project.body.head_joint, None);
    let on = is_on(&control(&harness, Role::CheckBox, "Loop"));
    control(&harness, Role::CheckBox, "Loop").click();
    harness.run();
    assert_eq!(harness.state().state.project.motion.looping, !on);
    assert!(harness.query_by_label("Loop blend").is_none(), "it says nothing where nothing loops");
}

#[test]
fn simulation_numbers_are_set_and_restored() {
    let mut harness = panel("Simulation", Project::default());
    let at = control(&harness, Role::SpinButton, "Bend damping").rect().center();
    type_at(&mut harness, at, "150");
    assert_eq!(harness.state().state.project.simulation.bend_damping, 0.15, "milliseconds are shown");
    let at = control(&harness, Role::SpinButton, "Substeps").rect().center();
    type_at(&mut harness, at, "5");
    assert_eq!(harness.state().state.project.simulation.substeps, 5);
    let at = control(&harness, Role::SpinButton, "Wind heading").rect().center();
    type_at(&mut harness, at, "90");
    let [x, y, z] = harness.state().state.project.simulation.wind.direction;
    assert!((x - 1.0).abs() < 1e-6 && y == 0.0 && z.abs() < 1e-6, "90 degrees is the dancer's left, +X");
    control(&harness, Role::Button, "Defaults").click();
    harness.run();
    assert_eq!(harness.state().state.project.simulation, SimulationSettings::default());
}

#[test]
fn the_stiffness_curve_is_edited_by_pointer_and_keys() {
    let mut harness = panel("Simulation", Project::default());
    let settings =
        |harness: &egui_kittest::Harness<'_, Shown<Bench>>| harness.state().state.project.simulation;
    let handle = |harness: &egui_kittest::Harness<'_, Shown<Bench>>, name: &str| {
        control(harness, Role::Slider, name).rect().center()
    };
    let (roots, middle, tips) =
        ("Stiffness curve, roots", "Stiffness curve, middle", "Stiffness curve, tips");
    let before = settings(&harness);
    for name in [roots, middle, tips] {
        let at = handle(&harness, name);
        assert!(tooltip_at(&mut harness, at).is_some_and(|tip| tip.contains("keys")), "{name}");
    }
    let from = handle(&harness, roots);
    drag(&mut harness, from, from - egui::vec2(0.0, 20.0));
    let lifted = settings(&harness);
    assert!(lifted.stiffness_root > before.stiffness_root + 10.0, "{lifted:?}");
    assert_eq!((lifted.stiffness_tip, lifted.stiffness_bias), (before.stiffness_tip, before.stiffness_bias));
    // The curve passes through the point to which its middle is dragged.
    let from = handle(&harness, middle);
    let to = from + egui::vec2(0.0, 8.0);
    drag(&mut harness, from, to);
    let bent = settings(&harness);
    assert!(bent.stiffness_bias > 0.55, "{bent:?}");
    assert!((handle(&harness, middle) - to).length() < 1.5);
    // A click gives a handle the focus, and keys move the focused handle.
    let from = handle(&harness, tips);
    crate::window::testing::click(&mut harness, from);
    harness.key_press(egui::Key::ArrowUp);
    harness.run();
    assert!((settings(&harness).stiffness_tip - bent.stiffness_tip - 0.6).abs() < 1e-4);
    harness.key_press_modifiers(egui::Modifiers::SHIFT, egui::Key::ArrowDown);
    harness.run();
    assert_eq!(settings(&harness).stiffness_tip, 0.0, "no further than its range");
    let at = handle(&harness, middle);
    crate::window::testing::double_click(&mut harness, at);
    assert_eq!(settings(&harness).stiffness_bias, before.stiffness_bias);
}

/// A project whose camera looks along -Z.
fn from_the_front() -> Project {
    let mut project = Project::default();
    (project.camera.azimuth, project.camera.elevation) = (0.0, 0.0);
    project
}

#[test]
fn the_sphere_sets_the_wind_direction() {
    let mut harness = panel("Simulation", from_the_front());
    let sphere = control(&harness, Role::Slider, "Wind direction").rect();
    drag(&mut harness, sphere.center(), sphere.center() + egui::vec2(0.0, -30.0));
    let [x, y, z] = harness.state().state.project.simulation.wind.direction;
    assert!(y < -0.5 && x.abs() < 0.1 && z.abs() < 0.9, "it comes from above: {x} {y} {z}");
    let at = control(&harness, Role::SpinButton, "Wind heading").rect().center();
    type_at(&mut harness, at, "180");
    let turned = harness.state().state.project.simulation.wind.direction;
    assert!((turned[1] - y).abs() < 1e-6 && turned[2] < 0.0, "as steep as before: {turned:?}");
}

#[test]
fn colliders_are_edited_by_name_and_restored() {
    let mut harness = panel("Colliders", Project::default());
    choose(&mut harness, "Collider", "upper arm left of a rather long name");
    let size = control(&harness, Role::SpinButton, "Size").rect().center();
    type_at(&mut harness, size, "150");
    control(&harness, Role::CheckBox, "Enabled").click();
    harness.run();
    let edits = harness.state().state.project.body.colliders.clone();
    let edit = edits.shapes["upper arm left of a rather long name"];
    assert_eq!((edits.shapes.len(), edit.enabled, edit.scale), (1, false, 1.5));
    choose(&mut harness, "Collider", "neck");
    assert!(is_on(&control(&harness, Role::CheckBox, "Enabled")), "the other one is as it was");
    control(&harness, Role::CheckBox, "Show").click();
    harness.run();
    assert!(harness.state().state.panels.colliders.on);
    assert_eq!(harness.state().state.project.body.colliders, edits, "to look is no change");
    control(&harness, Role::Button, "Colliders").click();
    harness.run();
    assert_eq!(harness.state().state.project.body.colliders, Project::default().body.colliders);
}

#[test]
fn ties_are_added_chosen_and_removed() {
    let mut harness = panel("Ties and scissors", Project::default());
    for kind in ["+ Ponytail", "+ Bun"] {
        control(&harness, Role::Button, kind).click();
        harness.run();
    }
    let kinds = |harness: &egui_kittest::Harness<'_, Shown<Bench>>| -> Vec<TieKind> {
        harness.state().state.project.hair.ties.iter().map(|tie| tie.kind).collect()
    };
    assert_eq!(kinds(&harness), [TieKind::Ponytail, TieKind::Bun]);
    let coils = control(&harness, Role::SpinButton, "Coils").rect().center();
    type_at(&mut harness, coils, "5");
    assert_eq!(harness.state().state.project.hair.ties[1].bun_coils, 5.0, "the new one is chosen");
    harness.get_by_label("Ponytail 1").click();
    harness.run();
    assert!(harness.query_by_role_and_label(Role::SpinButton, "Coils").is_none());
    control(&harness, Role::Button, "Remove").click();
    harness.run();
    assert_eq!(kinds(&harness), [TieKind::Bun]);
    for _ in 0..12 {
        control(&harness, Role::Button, "+ Bun").click();
        harness.run();
    }
    assert_eq!(kinds(&harness).len(), HairTie::MAX);
    harness.get_by_label("Scissors").click();
    harness.run();
    assert_eq!(harness.state().state.tool, PointerTool::Scissors);
    harness.state_mut().state.project.hair.cut.kept = vec![0.5];
    harness.run();
    control(&harness, Role::Button, "Grow back").click();
    harness.run();
    assert!(harness.state().state.project.hair.cut.is_empty());
}

#[test]
fn shadow_shows_the_settings_of_its_method() {
    let mut harness = panel("Shadow", Project::default());
    assert!(harness.query_by_label("Point extinction").is_none());
    choose(&mut harness, "Density", "By points, as printed");
    assert_eq!(harness.state().state.project.shadow.voxel_map.deposit, VoxelDeposit::PointCount);
    assert!(harness.query_all_by_label("Point extinction").count() > 0);
    choose(&mut harness, "Method", ShadowMethod::None.label());
    assert_eq!(harness.state().state.project.shadow.method, ShadowMethod::None);
    assert!(harness.query_by_label("Map resolution").is_none());
    assert!(harness.query_by_label_contains("2.0 MiB").is_some());
}

#[test]
fn lights_are_added_and_removed() {
    let mut harness = panel("Light", Project::default());
    let few = harness.state().state.project.lights.len();
    while let Some(add) = harness.query_by_label("Add a light") {
        add.click();
        harness.run();
    }
    let bench = &harness.state().state;
    assert_eq!(bench.project.lights.len(), MAX_LIGHTS);
    assert!(MAX_LIGHTS > few && bench.panels.light.selected == MAX_LIGHTS - 1, "the new one is selected");
    for left in (0..MAX_LIGHTS).rev() {
        harness.get_by_label("Remove").click();
        harness.run();
        assert_eq!(harness.state().state.project.lights.len(), left);
    }
    assert!(harness.query_by_label_contains("No light").is_some());
    harness.get_by_label("Add a light").click();
    harness.run();
    assert_eq!(harness.state().state.project.lights.len(), 1);
}

#[test]
fn the_selected_light_is_the_one_removed() {
    let mut harness = panel("Light", Project::default());
    let names: Vec<String> =
        harness.state().state.project.lights.iter().map(|light| light.name.clone()).collect();
    assert!(names.len() > 2, "{names:?}");
    control(&harness, Role::Button, &names[1]).click();
    harness.run();
    harness.get_by_label("Remove").click();
    harness.run();
    let left: Vec<String> =
        harness.state().state.project.lights.iter().map(|light| light.name.clone()).collect();
    assert_eq!(left.len(), names.len() - 1);
    assert!(!left.contains(&names[1]) && left[0] == names[0]);
}

#[test]
fn the_sphere_sets_the_light_direction() {
    let mut harness = panel("Light", from_the_front());
    let rect = control(&harness, Role::Slider, "Light direction").rect();
    // The camera looks along -Z: the middle of the sphere is a light from the front, the right rim a light from +X.
    drag(&mut harness, rect.center() + egui::vec2(3.0, 0.0), rect.center());
    let light = harness.state().state.project.lights[0].direction;
    assert!((light - Vec3::NEG_Z).length() < 0.05, "{light}");
    drag(&mut harness, rect.center(), rect.right_center() + egui::vec2(200.0, 0.0));
    let light = harness.state().state.project.lights[0].direction;
    assert!((light - Vec3::NEG_X).length() < 0.05, "{light}");
    for to in [rect.left_top(), rect.center(), egui::pos2(1e6, -1e6)] {
        drag(&mut harness, rect.center(), to);
        let light = harness.state().state.project.lights[0].direction;
        assert!((light.length() - 1.0).abs() < 1e-5, "{light} after a drag to {to}");
    }
}

#[test]
fn a_light_that_begins_to_stand_somewhere_shines_as_it_did() {
    let mut harness = panel("Light", Project::default());
    let before = Project::default().lights[0].clone();
    let labels = |harness: &egui_kittest::Harness<'_, _>| {
        let rows = controls(harness, Role::SpinButton);
        rows.into_iter().map(|(label, _)| label).collect::<Vec<_>>()
    };
    assert!(labels(&harness).contains(&"Softness".to_owned()));
    choose(&mut harness, "Light from", "Spot");
    let light = harness.state().state.project.lights[0].clone();
    assert_eq!(light.kind, LightKind::Spot);
    let head = Vec3::new(0.0, 1.6, 0.0);
    assert!((light.way_to(head) - before.direction.normalize_or_zero()).length() < 1e-5);
    let brightness = light.intensity * light.share_at(head);
    assert!((brightness - before.intensity).abs() < 1e-3, "{brightness} for {}", before.intensity);
    for label in
        ["Position x", "Position y", "Position z", "Azimuth", "Inner angle", "Outer angle", "Light radius"]
    {
        assert!(labels(&harness).contains(&label.to_owned()), "{label} of {:?}", labels(&harness));
    }
    for (label, rect) in controls(&harness, Role::SpinButton) {
        assert!(tooltip_at(&mut harness, rect.center()).is_some_and(|said| said.len() > 2), "{label}");
        assert!(rect.right() <= crate::window::testing::WIDTH, "{label} at {rect:?}");
    }
    choose(&mut harness, "Light from", "Point");
    assert!(
        !labels(&harness).contains(&"Azimuth".to_owned())
            && !labels(&harness).contains(&"Inner angle".to_owned())
    );
    let moved = harness.state().state.project.lights[0].position;
    assert_eq!(moved, light.position, "it stays where it stands");
    choose(&mut harness, "Light from", "Directional");
    assert!(labels(&harness).contains(&"Softness".to_owned()));
}

#[test]
fn swatches_apply_natural_colours_and_mark_the_one_in_use() {
    let mut project = Project::default();
    project.look.dye_amount = 0.5;
    let mut harness = panel("Look", project);
    let marked = |harness: &egui_kittest::Harness<'_, Shown<Bench>>| {
        let is_marked = |colour: &&lovelock_groom::HairColour| {
            control(harness, Role::Button, colour.name).accesskit_node().toggled() == Some(Toggled::True)
        };
        HAIR_COLOURS.iter().filter(is_marked).map(|colour| colour.name).collect::<Vec<_>>()
    };
    assert!(marked(&harness).is_empty(), "dyed hair has no natural colour");
    for colour in &HAIR_COLOURS {
        let before = harness.state().state.project.look;
        let at = control(&harness, Role::Button, colour.name).rect().center();
        assert!(tooltip_at(&mut harness, at).is_some_and(|said| said.contains(colour.name)));
        control(&harness, Role::Button, colour.name).click();
        harness.run();
        let mut wanted = before;
        colour.apply(&mut wanted);
        assert_eq!(harness.state().state.project.look, wanted, "{}", colour.name);
        assert_eq!(marked(&harness), [colour.name]);
    }
    // A swatch with the keyboard focus is chosen by Enter.
    control(&harness, Role::Button, "Black").focus();
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
    assert_eq!(marked(&harness), ["Black"]);
    let at = control(&harness, Role::SpinButton, "Grey").rect().center();
    type_at(&mut harness, at, "50");
    assert!(marked(&harness).is_empty(), "half grey hair is not black");
}

#[test]
fn controls_of_the_other_shading_and_of_other_counts_of_strands_are_hidden() {
    let mut harness = panel("Look", Project::default());
    for (shown, hidden) in [("Refraction", "Primary highlight"), ("Strand detail", "Strand number")] {
        assert!(harness.query_by_role_and_label(Role::SpinButton, shown).is_some(), "{shown}");
        assert!(harness.query_by_role_and_label(Role::SpinButton, hidden).is_none(), "{hidden}");
    }
    choose(&mut harness, "Shading", "Two highlights");
    choose(&mut harness, "Strands", "Fixed number");
    for (hidden, shown) in [("Refraction", "Primary highlight"), ("Strand detail", "Strand number")] {
        assert!(harness.query_by_role_and_label(Role::SpinButton, shown).is_some(), "{shown}");
        assert!(harness.query_by_role_and_label(Role::SpinButton, hidden).is_none(), "{hidden}");
    }
    choose(&mut harness, "Shading", "Kajiya-Kay, as published");
    let has = |name| harness.query_by_role_and_label(Role::SpinButton, name).is_some();
    assert!(has("Primary highlight") && !has("Secondary highlight"), "one highlight");
    assert!(has("Roughness"), "all have it");
}

#[test]
fn picture_settings_are_changed() {
    let mut harness = panel("Picture", Project::default());
    let ground = harness.state().state.project.picture.ground;
    control(&harness, Role::CheckBox, "Ground").click();
    harness.run();
    assert_eq!(harness.state().state.project.picture.ground, !ground);
    let exposure = control(&harness, Role::SpinButton, "Exposure").rect().center();
    type_at(&mut harness, exposure, "-1.5");
    assert_eq!(harness.state().state.project.picture.exposure_stops, -1.5);
}

#[test]
fn statistics_show_every_stage_and_fact() {
    let harness = panel("Statistics", Project::default());
    for stage in Stage::ALL.into_iter().filter(|stage| *stage != Stage::Encode) {
        assert!(harness.query_all_by_label(stage.label()).count() > 0, "{stage:?}");
    }
    assert!(harness.query_by_label("3.25 ms").is_some());
    assert!(harness.query_by_label("1280 × 720").is_some());
    assert!(harness.query_by_label("1.5 of 256 MiB").is_some(), "what is kept in memory, and the most of it");
}

#[test]
fn statistics_group_passes_and_show_their_sums() {
    let mut harness = panel("Statistics", Project::default());
    // The value on the same line as a name.
    let value = |harness: &egui_kittest::Harness<'_, Shown<Bench>>, name: &str| {
        let y = harness.get_by_label(name).rect().center().y;
        let values: Vec<_> = texts(harness)
            .into_iter()
            .filter(|(text, rect, _)| text.ends_with(" ms") && (rect.center().y - y).abs() < 4.0)
            .map(|(text, ..)| text)
            .collect();
        values.join(" ")
    };
    for (name, ms) in [
        ("Shadow, 2 passes", "3.75 ms"),
        ("Range", "1.25 ms"),
        ("Occupancy", "2.50 ms"),
        ("Draw, 2 passes", "13.25 ms"),
        ("Body depth", "4.75 ms"),
        ("Sort and blend", "8.50 ms"),
    ] {
        assert_eq!(value(&harness, name), ms, "{name}");
    }
    assert!(harness.query_by_label_contains("does not measure").is_none());
    let at = harness.get_by_label("Shadow, 2 passes").rect().center();
    assert!(tooltip_at(&mut harness, at).is_some_and(|tip| tip.contains("maps of all lights")));
    let at = harness.get_by_label("Picture").rect().center();
    assert!(tooltip_at(&mut harness, at).is_some_and(|tip| tip.contains("Size")), "facts are explained too");

    // A device without timers.
    harness.state_mut().state.passes.push(&[]);
    harness.run();
    assert!(harness.query_by_label("This device does not measure its passes.").is_some());
    assert!(harness.query_by_label("Range").is_none());
}

#[test]
fn controls_of_clusters_appear_with_what_they_change() {
    let mut harness = panel("Picture", Project::default());
    let has = |harness: &egui_kittest::Harness<'_, Shown<Bench>>, name: &str| {
        harness.query_all_by_label(name).next().is_some()
    };
    for name in ["Clusters", "Layers", "Clusters below", "Look-up"] {
        assert!(!has(&harness, name), "{name}");
    }
    choose(&mut harness, "Draw hair as", "Clusters");
    assert_eq!(harness.state().state.project.picture.draw, HairDrawing::Clusters);
    assert!(!has(&harness, "Clusters below"));
    let at = control(&harness, Role::SpinButton, "Layers").rect().center();
    type_at(&mut harness, at, "7");
    assert_eq!(harness.state().state.project.picture.clusters.layers, 7);
    assert!(has(&harness, "Detail") && !has(&harness, "Diffuse light"));
    choose(&mut harness, "Shading", "As published");
    assert!(!has(&harness, "Detail"));
    for name in ["Diffuse light", "Primary highlight", "Secondary highlight"] {
        control(&harness, Role::SpinButton, name);
    }
    assert!(!has(&harness, "Own shadow strength"), "the shadow map has none");
    choose(&mut harness, "Own shadow", "Outer layers, as published");
    control(&harness, Role::SpinButton, "Own shadow strength");
    choose(&mut harness, "Show", "Records");
    choose(&mut harness, "Draw hair as", "Strands near, clusters far");
    control(&harness, Role::SpinButton, "Clusters below");

    let project = harness.state().state.project.clone();
    let mut harness = panel("Look", project);
    assert!(
        !control(&harness, Role::ComboBox, "Strands").accesskit_node().is_disabled(),
        "near ones are drawn"
    );
    harness.state_mut().state.project.picture.draw = HairDrawing::Clusters;
    harness.run();
    assert!(control(&harness, Role::ComboBox, "Strands").accesskit_node().is_disabled());
}
