//! Several lights, and ambient light, on hair that is drawn as clusters.

use glam::Vec3;
use lovelock_groom::HairLook;
use lovelock_render::{
    ClusterSettings, ClusterShading, CpuRenderer, HairDrawing, Layers, Light, LocalShadow,
};

use super::clusters::{drawn, lock};
use crate::common::{self, Scene};

/// A lock as clusters, lit from these directions.
fn lit_from(to_lights: &[Vec3], clusters: ClusterSettings) -> Scene {
    let mut scene = lock(300);
    scene.camera.eye = Vec3::new(0.3, 0.1, 1.0);
    (scene.picture.draw, scene.picture.clusters) = (HairDrawing::Clusters, clusters);
    scene.picture.ambient = 0.0;
    let light = |(i, to_light): (usize, &Vec3)| Light {
        direction: -*to_light,
        color: Vec3::ONE - 0.3 * i as f32 * Vec3::X,
        ..Light::default()
    };
    scene.lights = to_lights.iter().enumerate().map(light).collect();
    scene
}

/// The mean difference of light of two images, as a fraction of the mean light of the first.
fn difference(a: &[Vec3], b: &[Vec3]) -> f32 {
    let sum = |of: &mut dyn Iterator<Item = Vec3>| of.map(|light| light.abs().element_sum()).sum::<f32>();
    sum(&mut a.iter().zip(b).map(|(a, b)| a - b)) / sum(&mut a.iter().copied())
}

fn light_of(layers: &Layers) -> Vec<Vec3> {
    layers.light.iter().map(|&[r, g, b, _]| Vec3::new(r, g, b)).collect()
}

#[test]
fn each_light_has_a_record_of_its_own() {
    // Light is additive: what two lights give is what each of them gives alone, if records and shadows of layers are its own.
    let (right, left) = (Vec3::new(1.0, 0.3, 0.4), Vec3::new(-0.8, 0.5, -0.3));
    let default = ClusterSettings::default();
    for clusters in [
        default,
        ClusterSettings { shading: ClusterShading::Paper, ..default },
        ClusterSettings { local_shadow: LocalShadow::Exponential, ..default },
        ClusterSettings { local_shadow: LocalShadow::Directional, ..default },
    ] {
        let seen = |to_lights: &[Vec3]| {
            let mut scene = lit_from(to_lights, clusters);
            if to_lights.len() == 1 && to_lights[0] != right {
                // The colour of the second light.
                scene.lights[0].color = Vec3::ONE - 0.3 * Vec3::X;
            }
            light_of(&drawn(&mut CpuRenderer::default(), &scene, 64))
        };
        let both = seen(&[right, left]);
        let sum = |a: Vec<Vec3>, b: Vec<Vec3>| a.iter().zip(&b).map(|(a, b)| a + b).collect::<Vec<_>>();
        let apart = sum(seen(&[right]), seen(&[left]));
        let found = difference(&both, &apart);
        // The control: a light a little beside has other records.
        let beside = sum(seen(&[right]), seen(&[left + 0.6 * Vec3::Z]));
        let control = difference(&both, &beside);
        println!("{:?}, {:?}: {found}; control {control}", clusters.shading, clusters.local_shadow);
        assert!(found < 1e-3, "{clusters:?}: {found}");
        assert!(control > 0.005, "{clusters:?}: {control}");
    }
}

#[test]
fn ambient_light_is_neither_reflected_by_records_nor_shadowed_by_layers() {
    let around = Vec3::new(0.9, 0.6, 0.3);
    let of = |local_shadow, intensity: f32| {
        let settings =
            ClusterSettings { shading: ClusterShading::Paper, local_shadow, ..ClusterSettings::default() };
        let mut scene = lit_from(&[Vec3::new(1.0, 0.3, 0.4)], settings);
        scene.lights[0].intensity = intensity;
        scene.picture.ambient = 0.5;
        scene.surroundings = Some(common::panorama(|_, _| around));
        let layers = drawn(&mut CpuRenderer::default(), &scene, 64);
        let hair = layers.light.iter().filter(|[.., alpha]| *alpha > 0.05);
        let colors: Vec<Vec3> = hair.map(|&[r, g, b, alpha]| Vec3::new(r, g, b) / alpha).collect();
        assert!(colors.len() > 100);
        let expected = 0.22 * around * HairLook::body_color(scene.look.absorption());
        colors.iter().map(|color| (*color / expected - 1.0).abs().max_element()).fold(0.0, f32::max)
    };
    for mode in [LocalShadow::Map, LocalShadow::Exponential, LocalShadow::Directional] {
        let found = of(mode, 0.0);
        assert!(found < 1e-3, "{mode:?}: {found}");
    }
    let control = of(LocalShadow::Exponential, 1.0);
    assert!(control > 0.5, "light of a lamp is another colour: {control}");
}
