//! Scattering by fibres in images.

use crate::common;

use common::{Scene, one_strand, scene, tuft_scene};
use glam::Vec3;
use lovelock_groom::HairShading;
use lovelock_render::{Backend, CpuRenderer, Layers, ShadowMethod};
use lovelock_testkit::flip;

fn fibres(mut scene: Scene) -> Scene {
    scene.look.shading = HairShading::Fibre;
    scene
}

/// Mean light of the pixels.
fn light(scene: &Scene) -> Vec3 {
    let mut layers = Layers::default();
    CpuRenderer::default().layers(&scene.input(), 64, 64, false, &mut layers).expect("layers");
    layers.light.iter().map(|&[r, g, b, _]| Vec3::new(r, g, b)).sum::<Vec3>() / (64.0 * 64.0)
}

#[test]
fn both_backends_scatter_alike() {
    // Measured on a software adapter: mean 0.0018 to 0.0029 and 99th percentile 0.009 to 0.022. The control, smoother fibres, has 0.0077 to
    // 0.018 and 0.26 to 0.50.
    let (w, h) = (240, 180);
    for (eumelanin, method) in
        [(0.05, ShadowMethod::VoxelMap), (1.3, ShadowMethod::VoxelMap), (8.0, ShadowMethod::None)]
    {
        let mut scene = fibres(tuft_scene(400));
        scene.look.eumelanin = eumelanin;
        (scene.look.grey, scene.look.highlights) = (0.2, 0.3);
        scene.shadow.method = method;
        let Some(gpu) = scene.draw_by(Backend::Gpu, w, h) else { return };
        let cpu = scene.draw_by(Backend::Cpu, w, h).expect("a picture");
        scene.look.roughness *= 0.6;
        let other = scene.draw_by(Backend::Cpu, w, h).expect("a picture");
        let difference = flip(&gpu.rgba, &cpu.rgba, w, h);
        let control = flip(&gpu.rgba, &other.rgba, w, h);
        println!("{eumelanin}: {difference:?}; smoother fibres {control:?}");
        assert!(difference.mean < 0.005 && difference.p99 < 0.06, "{difference:?}");
        assert!(control.mean > 1.5 * difference.mean, "{control:?}");
    }
}

#[test]
fn white_hair_in_white_surroundings_is_white() {
    // White fibres scatter everything: in light from all sides they are as bright as it, whatever their shape and however many there are.
    let radiance = Vec3::new(0.5, 1.0, 2.0);
    let seen = |lines: &[Vec<Vec3>], eumelanin: f32| {
        let mut scene = fibres(scene(lines));
        (scene.look.eumelanin, scene.look.pheomelanin, scene.look.tip_lightening) = (eumelanin, 0.0, 0.0);
        // Narrow strands, because wide ones are streaked.
        scene.look.real_hairs = 100.0 * lines.len() as f32;
        scene.lights.clear();
        scene.surroundings = Some(common::panorama(|_, _| radiance));
        let mut layers = Layers::default();
        CpuRenderer::default().layers(&scene.input(), 64, 64, false, &mut layers).expect("layers");
        let (mut sum, mut covered) = (Vec3::ZERO, 0.0);
        for &[r, g, b, alpha] in &layers.light {
            sum += Vec3::new(r, g, b);
            covered += alpha;
        }
        sum / covered / radiance
    };
    for (name, lines) in [("a strand", one_strand()), ("a tuft", common::tuft(400))] {
        let [white, brown] = [0.0, 1.3].map(|eumelanin| seen(&lines, eumelanin));
        println!("{name}: white hair {white}, brown hair {brown}");
        // Measured 2e-7, and 0.36 and 0.06 for brown hair.
        assert!((white - 1.0).abs().max_element() < 1e-4, "{name}: {white}");
        assert!(brown.max_element() < 0.6, "{name}, the control: {brown}");
    }
}

#[test]
fn light_from_all_directions_grows_with_its_setting() {
    let mut scene = fibres(scene(&one_strand()));
    scene.lights.clear();
    let once = light(&scene);
    scene.picture.ambient *= 2.0;
    let twice = light(&scene);
    assert!(once.min_element() > 0.0 && (twice / once - 2.0).abs().max_element() < 1e-3, "{twice} {once}");
}

#[test]
fn extreme_fibres_and_no_lights_give_finite_images() {
    for (roughness, sigma, width) in
        [(0.05, 0.0, 0.0), (1.0, 100.0, 1.0), (f32::NAN, f32::NAN, f32::NAN), (0.0, 1e9, 1e9)]
    {
        for lights in [0, 1] {
            let mut scene = fibres(tuft_scene(60));
            (scene.look.roughness, scene.look.roughness_around) = (roughness, roughness);
            (scene.look.eumelanin, scene.look.diameter) = (sigma, width * 80e-6);
            (scene.look.grey, scene.look.dye_amount, scene.look.refraction) =
                (roughness, roughness, roughness);
            scene.lights.truncate(lights);
            let found = light(&scene);
            assert!(found.is_finite() && found.min_element() >= 0.0, "{roughness} {sigma}: {found}");
        }
    }
}

#[test]
fn light_between_strands_brightens_fair_hair_most() {
    let gain = |eumelanin: f32| {
        let mut scene = fibres(tuft_scene(400));
        scene.shadow.method = ShadowMethod::Exact;
        (scene.look.eumelanin, scene.look.real_hairs) = (eumelanin, 60_000.0);
        // From behind, where light only comes through hair.
        scene.lights.truncate(1);
        scene.lights[0].direction = Vec3::new(0.0, -0.3, 1.0);
        scene.body = None;
        scene.picture.ambient = 0.0;
        let with = light(&scene).element_sum();
        scene.look.many_scattering = 0.0;
        with / light(&scene).element_sum()
    };
    let (fair, black) = (gain(0.05), gain(8.0));
    println!("light between strands: fair hair {fair}, black hair {black}");
    // Measured 5.3 and 1.05.
    assert!(fair > 1.3 && black < 1.3 && fair > 1.2 * black, "{fair} {black}");
}
