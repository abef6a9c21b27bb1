//! Transmittance of a rendered picture, on both backends.

use crate::common::{Scene, tuft_scene};
use glam::Vec3;
use lovelock_render::{
    Backend, FrameInput, FrameStats, KnownTransmittance, Picture, RenderError, Renderer, ShadowMethod,
};

/// Both backends; only the CPU without an adapter.
fn renderers() -> Vec<Renderer> {
    let open = |backend| match Renderer::open(backend) {
        Ok(renderer) => Some(renderer),
        Err(error) => {
            lovelock_testkit::skip_without_adapter(&error);
            None
        }
    };
    [Backend::Cpu, Backend::Gpu].into_iter().filter_map(open).collect()
}

fn draw(renderer: &mut Renderer, input: &FrameInput) -> (FrameStats, Picture) {
    let mut picture = Picture::default();
    let stats = renderer.picture(input, 96, 96, &mut picture).expect("a picture");
    (stats, picture)
}

fn points(scene: &Scene) -> Vec<Vec3> {
    (0..scene.strands.points()).map(|i| scene.strands.point(i)).collect()
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|&t| f64::from(t)).sum::<f64>() / values.len() as f64
}

#[test]
fn the_transmittance_of_a_picture_is_what_its_maps_say() {
    let mut scene = tuft_scene(60);
    assert!(scene.lights.iter().filter(|light| light.enabled).count() > 1);
    for renderer in &mut renderers() {
        let backend = renderer.backend();
        for &method in ShadowMethod::ALL {
            scene.shadow.method = method;
            let (stats, _) = draw(renderer, &scene.input());
            let used = renderer.transmittance(0).expect("a picture");
            assert_eq!(used.len(), scene.strands.points());
            // Rounding of a sum of floats.
            let difference = mean(&used) - f64::from(stats.mean_transmittance);
            assert!(difference.abs() < 1e-6, "{backend:?} {method}: {difference}");
            let asked = renderer.transmittance_at(0, &points(&scene)).expect("a picture");
            assert_eq!(asked, used, "{backend:?} {method}");
            let ray = renderer.along_ray(0, scene.strands.point(30)).expect("a picture");
            let has_marks = ray.as_ref().is_some_and(|ray| !ray.marks.is_empty());
            assert_eq!(ray.is_some(), backend == Backend::Cpu);
            assert_eq!(has_marks, backend == Backend::Cpu && method != ShadowMethod::None, "{method}");
            if method == ShadowMethod::None {
                continue;
            }
            // Controls: another light, and other points.
            assert_ne!(renderer.transmittance(1).expect("a picture"), used, "{backend:?} {method}");
            let moved: Vec<Vec3> = points(&scene).iter().map(|p| p + 0.01).collect();
            assert_ne!(
                renderer.transmittance_at(0, &moved).expect("a picture"),
                used,
                "{backend:?} {method}"
            );
        }
    }
}

#[test]
fn what_was_not_drawn_cannot_be_asked_about() {
    let scene = tuft_scene(20);
    let lights = scene.lights.iter().filter(|light| light.enabled).count();
    for renderer in &mut renderers() {
        assert!(matches!(renderer.transmittance(0), Err(RenderError::NoPicture)));
        assert!(matches!(renderer.transmittance_at(0, &[]), Err(RenderError::NoPicture)));
        let _ = draw(renderer, &scene.input());
        for light in [lights, usize::MAX] {
            let expected = |found: &RenderError| matches!(found, RenderError::NoLight { .. });
            assert!(renderer.transmittance(light).is_err_and(|error| expected(&error)));
            assert!(renderer.transmittance_at(light, &[Vec3::ZERO]).is_err_and(|error| expected(&error)));
        }
        assert!(renderer.transmittance(lights - 1).is_ok());
        let broken = [Vec3::NAN, Vec3::INFINITY, Vec3::splat(1e30), Vec3::ZERO];
        let answers = renderer.transmittance_at(0, &broken).expect("a picture");
        assert_eq!(answers[..3], [1.0; 3]);
        assert!((0.0..=1.0).contains(&answers[3]));
        assert_eq!(renderer.transmittance_at(0, &[]).expect("a picture"), [0.0; 0]);
    }
}

#[test]
fn building_and_asking_are_both_measured() {
    let scene = tuft_scene(60);
    for renderer in &mut renderers() {
        let (stats, _) = draw(renderer, &scene.input());
        if stats.passes.is_empty() {
            continue;
        }
        let names: Vec<_> = stats.passes.iter().map(|pass| pass.name.as_str()).collect();
        assert!(names.contains(&"shadow/ask"), "{names:?}");
        assert!(stats.build_ms() > 0.0 && stats.query_ms() > 0.0, "{names:?}");
        assert!(stats.build_ms() + stats.query_ms() <= stats.shadow_ms + 1e-9, "{stats:?}");
    }
}

#[test]
fn a_picture_of_known_transmittance_is_that_of_the_method_that_it_came_from() {
    for renderer in &mut renderers() {
        is_that_of_its_method(renderer);
    }
}

fn is_that_of_its_method(renderer: &mut Renderer) {
    let mut scene = tuft_scene(60);
    scene.shadow.method = ShadowMethod::Exact;
    let (_, expected) = draw(renderer, &scene.input());
    let lights = scene.lights.iter().filter(|light| light.enabled).count();
    let at_points: Vec<_> = (0..lights).map(|k| renderer.transmittance(k).expect("a picture")).collect();
    let positions = scene.body.as_ref().expect("a wall").1.positions.clone();
    let at_vertices: Vec<_> =
        (0..lights).map(|k| renderer.transmittance_at(k, &positions).expect("a picture")).collect();
    // The method does not matter.
    scene.shadow.method = ShadowMethod::VoxelMap;
    let (_, by_method) = draw(renderer, &scene.input());
    assert_ne!(by_method, expected);
    let mut with = |at_points: &[Vec<f32>], at_vertices: &[Vec<f32>]| {
        let known = Some(KnownTransmittance { at_points, at_vertices });
        let (stats, picture) = draw(renderer, &FrameInput { known, ..scene.input() });
        let precision = if renderer.backend() == Backend::Cpu { 1e-6 } else { 0.5 / 255.0 };
        assert!((f64::from(stats.mean_transmittance) - mean(&at_points[0])).abs() < precision);
        assert_eq!(renderer.transmittance(1).expect("a picture"), at_points[1]);
        picture
    };
    assert_eq!(with(&at_points, &at_vertices), expected);
    assert_eq!(with(&at_points, &[]), expected);
    // Controls: other light on the strands, and on the wall.
    let lit: Vec<_> = at_points.iter().map(|list| vec![1.0; list.len()]).collect();
    assert_ne!(with(&lit, &at_vertices), expected);
    let dark: Vec<_> = at_vertices.iter().map(|list| vec![0.0; list.len()]).collect();
    assert_ne!(with(&at_points, &dark), expected);
    // Without given transmittance the method matters again.
    assert_eq!(draw(renderer, &scene.input()).1, by_method);
}

#[test]
fn known_transmittance_that_does_not_fit_is_refused() {
    let scene = tuft_scene(20);
    for renderer in &mut renderers() {
        let at_points = vec![vec![1.0; 3]];
        let known = Some(KnownTransmittance { at_points: &at_points, at_vertices: &[] });
        let input = FrameInput { known, ..scene.input() };
        let found = renderer.picture(&input, 32, 32, &mut Picture::default());
        assert!(matches!(found, Err(RenderError::Known { found: 1, .. })), "{found:?}");
        let _ = draw(renderer, &scene.input());
    }
}
