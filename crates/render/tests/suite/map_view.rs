//! The shadow map over an image.

use crate::common;

use common::{Scene, tuft_scene};
use glam::Vec3;
use lovelock_render::{Backend, Light, MapForm, MapValue, MapView, Picture, ShadowMethod};
use lovelock_testkit::flip;

fn scene(view: MapView) -> Scene {
    let mut s = tuft_scene(120);
    s.picture.map_view = view;
    s
}

fn drawn(scene: &Scene, backend: Backend) -> Option<Picture> {
    scene.draw_by(backend, 120, 90)
}

#[test]
fn the_map_is_drawn_by_both_backends_and_only_if_it_is_asked_for() {
    let plain = drawn(&scene(MapView::default()), Backend::Cpu).expect("a picture");
    // Other settings of what is not shown change nothing.
    let hidden = MapView { form: MapForm::Points, slice: 0.1, light: 3, ..MapView::default() };
    assert!(drawn(&scene(hidden), Backend::Cpu).expect("a picture") == plain);
    for (value, form) in [
        (MapValue::Transmittance, MapForm::AcrossLight),
        (MapValue::Density, MapForm::AlongLightY),
        (MapValue::Transmittance, MapForm::Points),
    ] {
        let s = scene(MapView { value, form, ..MapView::default() });
        let cpu = drawn(&s, Backend::Cpu).expect("a picture");
        let control = flip(&cpu.rgba, &plain.rgba, 120, 90);
        assert!(control.mean > 0.01, "{value:?}, {form:?}: {control:?}");
        let Some(gpu) = drawn(&s, Backend::Gpu) else { continue };
        let difference = flip(&gpu.rgba, &cpu.rgba, 120, 90);
        assert!(difference.mean < 0.005, "{value:?}, {form:?}: {difference:?}; without the map {control:?}");
    }
}

#[test]
fn every_method_and_every_light_has_a_map() {
    let view = MapView { value: MapValue::Transmittance, form: MapForm::AlongLightZ, ..MapView::default() };
    let mut pictures = Vec::new();
    for &method in ShadowMethod::ALL {
        let mut s = scene(view);
        s.shadow.method = method;
        pictures.push(drawn(&s, Backend::Cpu).expect("a picture"));
    }
    assert!(pictures[0] != pictures[1], "without a shadow the map is light everywhere");
    // A light that is off is not counted, beyond the last light the last one is shown, and without lights there is no map.
    let of = |light: u32, enabled: [bool; 2]| {
        let mut s = scene(MapView { light, ..view });
        let directions = [Vec3::new(0.2, -1.0, -0.3), Vec3::new(-1.0, -0.2, -0.4)];
        let lamp = |(direction, enabled)| Light { direction, enabled, ..Light::default() };
        s.lights = directions.into_iter().zip(enabled).map(lamp).collect();
        drawn(&s, Backend::Cpu).expect("a picture")
    };
    assert!(of(1, [true, true]) != of(2, [true, true]));
    assert!(of(1, [false, true]) == of(2, [false, true]));
    assert!(of(2, [true, true]) == of(4, [true, true]));
    assert!(of(1, [false, false]) == of(3, [false, false]));
}

#[test]
fn a_camera_inside_the_hair_and_hair_without_extent_are_drawn() {
    for form in [MapForm::AcrossLight, MapForm::AlongLightY, MapForm::AlongLightZ, MapForm::Points] {
        let mut s = scene(MapView { value: MapValue::Density, form, ..MapView::default() });
        s.camera.eye = Vec3::new(0.0, 0.02, 0.001);
        drawn(&s, Backend::Cpu).expect("a picture");
        for lines in [Vec::new(), vec![vec![Vec3::ZERO]], vec![vec![Vec3::ZERO, 0.1 * Vec3::Y]]] {
            let mut s = common::scene(&lines);
            s.shadow.method = ShadowMethod::VoxelMap;
            s.picture.map_view = MapView { value: MapValue::Transmittance, form, ..MapView::default() };
            drawn(&s, Backend::Cpu).expect("a picture");
        }
    }
}
