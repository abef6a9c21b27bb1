//! Light, shadow and blending of layers.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::{Vec2, Vec3};
use lovelock_satf::composite::{LayerSample, composite};
use lovelock_satf::lighting::ClusterLighting;
use lovelock_satf::shadow::{LocalShadow, crossings, optical_depth, transmittance};

/// A direction at the angle `a` from x toward y.
fn at(a: f32) -> Vec3 {
    Vec3::new(a.cos(), a.sin(), 0.0)
}

/// The angle at which `value` is largest.
fn peak(value: impl Fn(f32) -> f32) -> f32 {
    (0..=3000).map(|i| i as f32 * FRAC_PI_2 / 1500.0).max_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap()
}

#[test]
fn highlights_are_brightest_on_the_cone_of_mirrored_light() {
    let lighting = ClusterLighting { primary_shift: 0.0, secondary_shift: 0.0, ..ClusterLighting::default() };
    for angle in [0.6, 1.2, FRAC_PI_2, 2.0] {
        let light = at(angle);
        let parts = |eye: f32| lighting.parts(Vec3::X, Vec3::Y, light, at(eye));
        let mirrored = std::f32::consts::PI - angle;
        assert!((peak(|eye| parts(eye).primary) - mirrored).abs() < 0.01, "{angle}");
        assert!((parts(mirrored).primary - lighting.primary).abs() < 1e-4);
        assert!((parts(mirrored).secondary - lighting.secondary).abs() < 1e-4);
        if (angle - FRAC_PI_2).abs() > 0.1 {
            // With the printed sign the maximum would be at the light itself.
            assert!(parts(angle).primary < 0.8 * lighting.primary, "the control");
        }
    }
}

#[test]
fn the_primary_highlight_moves_to_the_tip_and_the_secondary_to_the_root() {
    // Hair on an arc, from the root at angle π to the tip at 0, under light and eye straight above.
    let lighting = ClusterLighting::default();
    let along = |a: f32| {
        let angle = std::f32::consts::PI - a;
        (Vec3::new(angle.sin(), -angle.cos(), 0.0), at(angle))
    };
    let parts = |a: f32, of: &ClusterLighting| {
        let (tangent, normal) = along(a);
        of.parts(tangent, normal, Vec3::Y, Vec3::Y)
    };
    let tangent = along(FRAC_PI_2).0;
    assert!(tangent.abs_diff_eq(Vec3::X, 1e-5), "tangents lead to the tip");
    let primary = peak(|a| parts(a, &lighting).primary);
    let secondary = peak(|a| parts(a, &lighting).secondary);
    assert!((primary - FRAC_PI_2 - 0.1_f32.atan()).abs() < 0.01, "{primary}");
    assert!((secondary - FRAC_PI_2 + 0.15_f32.atan()).abs() < 0.01, "{secondary}");
    let unshifted = ClusterLighting { primary_shift: 0.0, ..lighting };
    assert!((peak(|a| parts(a, &unshifted).primary) - FRAC_PI_2).abs() < 0.01, "the control");
}

#[test]
fn diffuse_light_is_the_sine_of_the_angle_to_the_strand() {
    let lighting = ClusterLighting::default();
    let diffuse = |a: f32| lighting.parts(Vec3::X, Vec3::Y, at(a), Vec3::Z).diffuse;
    assert!((diffuse(FRAC_PI_2) - 0.35).abs() < 1e-6 && diffuse(0.0) < 1e-3);
    assert!((diffuse(0.5) - 0.35 * 0.5_f32.sin()).abs() < 1e-5);
    let parts = lighting.parts(Vec3::X, Vec3::Y, Vec3::Y, Vec3::Y);
    let red = parts.color(Vec3::new(1.0, 0.0, 0.0), Vec3::ONE);
    assert!((red.y - parts.primary).abs() < 1e-6 && red.x > red.y);
    let none = lighting.parts(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    assert!(none.primary.is_finite() && none.secondary.is_finite());
}

#[test]
fn layers_let_light_through_one_after_the_other() {
    let layers = [0.3, 0.5, 0.2];
    let exact: f32 = layers.iter().map(|a| 1.0 - a).product();
    let through = |mode, strength| transmittance(mode, strength, layers);
    assert!((through(LocalShadow::Layers, 1.0) - exact).abs() < 1e-6);
    assert!((through(LocalShadow::Layers, 2.0) - exact * exact).abs() < 1e-6);
    // The opacities in place of their optical depths let more through.
    assert!(((-1.0_f32).exp() - exact).abs() > 0.05, "the control");
    // Equation 12: e^(−k Σ α), and its approximation 1 − k Σ α.
    assert!((through(LocalShadow::Exponential, 1.0) - (-1.0_f32).exp()).abs() < 1e-6);
    assert!((through(LocalShadow::Exponential, 0.1) - (-0.1_f32).exp()).abs() < 1e-6);
    assert!((through(LocalShadow::Linear, 0.1) - 0.9).abs() < 1e-6);
    assert_eq!(transmittance(LocalShadow::Exponential, 1.0, []), 1.0);
    assert_eq!(through(LocalShadow::Linear, 1.0), 0.0);
    assert!((through(LocalShadow::Linear, 0.5) - 0.5).abs() < 1e-6);
    assert_eq!(through(LocalShadow::Linear, 3.0), 0.0, "never negative");
    assert_eq!(transmittance(LocalShadow::Layers, 1.0, []), 1.0);
    assert!(transmittance(LocalShadow::Layers, 1.0, [1.0]) < 2e-6);
    assert!(optical_depth(1.0).is_finite() && optical_depth(7.0).is_finite());
}

#[test]
fn light_crosses_outer_layers_on_its_side_and_all_layers_on_the_other() {
    let radii = [0.4, 0.6, 0.8, 1.0];
    let met = |layer: usize, u: f32, toward: Vec2| {
        let mut all = Vec::new();
        crossings(&radii, layer, u, toward, |c| all.push(c));
        all
    };
    // Toward the light, only the layers outside count, at the same angle.
    let lit = met(1, 0.0, Vec2::X);
    assert_eq!(lit.iter().map(|c| c.layer).collect::<Vec<_>>(), [2, 3]);
    assert!(lit.iter().all(|c| c.u.min(TAU - c.u) < 1e-5 && (c.facing - 1.0).abs() < 1e-5));
    // On the far side light comes through everything inside, and the near half.
    let dark = met(1, 0.5 * TAU, Vec2::X);
    let mut layers: Vec<_> = dark.iter().map(|c| c.layer).collect();
    layers.sort_unstable();
    assert_eq!(layers, [0, 0, 1, 2, 3]);
    assert_eq!(dark.iter().filter(|c| c.facing < 0.0).count(), 1);
    // From the side, the angle is where the light meets the layer.
    let side = met(1, 0.0, Vec2::Y);
    for crossing in &side {
        let exact = (0.6 / radii[crossing.layer]).acos();
        assert!((crossing.u - exact).abs() < 1e-4, "{crossing:?}");
        assert!((crossing.facing - exact.sin()).abs() < 1e-4);
    }
    assert_eq!(side.len(), 2);
    assert!(met(9, 0.0, Vec2::X).is_empty() && met(0, 0.0, Vec2::ZERO).is_empty());
}

#[test]
fn one_opaque_layer_returns_its_own_colour_and_empty_ones_the_background() {
    let (behind, color) = (Vec3::new(0.1, 0.2, 0.3), Vec3::new(0.7, 0.5, 0.4));
    let layer = |opacity| LayerSample { color, opacity };
    assert_eq!(composite(behind, [layer(1.0)]), color);
    assert_eq!(composite(behind, [layer(0.0); 5]), behind);
    assert_eq!(composite(behind, []), behind);
    // A colour that is multiplied by the opacity already, as the printed equations have it, would be too dark.
    let half = composite(Vec3::ZERO, [layer(0.5)]);
    assert!(half.abs_diff_eq(0.5 * color, 1e-6) && (half - 0.25 * color).length() > 0.1, "the control");
}

#[test]
fn layers_are_blended_as_in_equation_14() {
    let behind = Vec3::splat(0.9);
    let layers: Vec<LayerSample> = [(0.2, 0.5), (0.8, 0.3), (0.4, 0.6)]
        .map(|(light, opacity)| LayerSample { color: Vec3::splat(light), opacity })
        .into();
    let beyond = |k: usize| layers[k..].iter().map(|l| 1.0 - l.opacity).product::<f32>();
    let exact =
        (0..3).fold(behind * beyond(0), |sum, k| sum + layers[k].color * layers[k].opacity * beyond(k + 1));
    assert!(composite(behind, layers.iter().copied()).abs_diff_eq(exact, 1e-6));
    let reversed = composite(behind, layers.iter().rev().copied());
    assert!((reversed - exact).length() > 0.05, "the control: the order matters");
}
