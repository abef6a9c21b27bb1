//! The panel of the shadow method.

use egui::accesskit::Role;
use egui::{Key, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use lovelock_project::Project;
use lovelock_render::{MapForm, MapValue, ShadowMethod};

use super::one_by_one::choose;
use super::{Bench, panel};
use crate::window::control::said;
use crate::window::testing::{Shown, control, drag, press, type_at};

/// The resolution of the voxel map.
fn resolution(harness: &Harness<'_, Shown<Bench>>) -> u32 {
    harness.state().state.project.shadow.voxel_map.resolution
}

#[test]
fn the_resolution_of_a_map_slides_through_its_sizes_and_shows_the_memory_before_it_is_released() {
    let mut harness = panel("Shadow", Project::default());
    assert!(harness.query_by_label("At most 8.0 MiB per light and thread").is_some());
    let rail = control(&harness, Role::Slider, "Map resolution").rect();
    let stops = [16, 32, 48, 64, 96, 128, 192, 256, 384, 512];
    let mut met = Vec::new();
    harness.hover_at(rail.center());
    press(&harness, rail.center(), true);
    harness.run();
    for step in 0..=200 {
        let x = rail.left() + rail.width() * step as f32 / 200.0;
        harness.hover_at(pos2(x, rail.center().y));
        harness.run();
        // The button is still held: the value and its memory follow.
        met.push(resolution(&harness));
        let mib = f64::from(resolution(&harness)).powi(3) * 4.0 / f64::from(1 << 20);
        let memory = format!("At most {mib:.1} MiB per light and thread");
        assert!(harness.query_by_label(&memory).is_some(), "{memory}");
    }
    press(&harness, rail.right_center(), false);
    harness.run();
    met.dedup();
    assert_eq!(met, stops);
    assert_eq!(resolution(&harness), 512);
    // The texels of another method have stops of their own.
    harness.state_mut().state.project.shadow.method = ShadowMethod::OccupancyMaps;
    harness.run();
    let rail = control(&harness, Role::Slider, "Map resolution").rect();
    drag(&mut harness, rail.center(), rail.right_center());
    assert_eq!(harness.state().state.project.shadow.occupancy_maps.resolution, 4096);
    drag(&mut harness, rail.center(), rail.left_center());
    assert_eq!(harness.state().state.project.shadow.occupancy_maps.resolution, 64);
}

#[test]
fn a_resolution_is_typed_and_one_that_cannot_be_is_refused_with_a_sentence() {
    let mut harness = panel("Shadow", Project::default());
    let field = control(&harness, Role::SpinButton, "Map resolution").rect().center();
    for (text, expected, message) in [
        ("104", 104, ""),
        ("0", 104, "Map resolution: found 0; must be 16 to 512. It stays 104³."),
        ("100000", 104, "Map resolution: found 100000; must be 16 to 512. It stays 104³."),
        ("-64", 104, "Map resolution: found -64; must be 16 to 512. It stays 104³."),
        ("100", 104, "Map resolution: found 100; must be a multiple of 8. It is set to 104³."),
        ("many", 104, ""),
        ("64³", 64, ""),
    ] {
        type_at(&mut harness, field, text);
        assert_eq!(resolution(&harness), expected, "{text}");
        assert_eq!(said(&harness.ctx).join(" "), message, "{text}");
    }
    // From a number between two stops, keys reach the next stop.
    harness.state_mut().state.project.shadow.voxel_map.resolution = 104;
    harness.run();
    control(&harness, Role::Slider, "Map resolution").focus();
    harness.run();
    harness.key_press(Key::ArrowRight);
    harness.run();
    assert_eq!(resolution(&harness), 128);
    harness.key_press(Key::ArrowLeft);
    harness.run();
    assert_eq!(resolution(&harness), 96);
}

#[test]
fn the_map_over_the_hair_has_a_slider_for_its_slice() {
    let mut harness = panel("Shadow", Project::default());
    let has = |harness: &Harness<'_, Shown<Bench>>, name: &str| {
        harness.query_by_role_and_label(Role::SpinButton, name).is_some()
    };
    assert!(!has(&harness, "Slice") && !has(&harness, "Map opacity"), "nothing is shown");
    choose(&mut harness, "Map shown", "Density");
    assert!(has(&harness, "Slice") && has(&harness, "Density range") && !has(&harness, "Points"));
    let rail = control(&harness, Role::Slider, "Slice").rect();
    drag(&mut harness, rail.center(), rail.right_center());
    let view = |harness: &Harness<'_, Shown<Bench>>| harness.state().state.project.picture.map_view;
    assert_eq!((view(&harness).value, view(&harness).slice), (MapValue::Density, 1.0));
    choose(&mut harness, "Map shown", "Transmittance");
    choose(&mut harness, "Map as", "Points");
    assert_eq!((view(&harness).value, view(&harness).form), (MapValue::Transmittance, MapForm::Points));
    assert!(has(&harness, "Points") && !has(&harness, "Slice") && !has(&harness, "Density range"));
}
