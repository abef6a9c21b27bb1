//! How surfaces with materials reflect light: the twin of the functions of `material_shading.wgsl`.
//!
//! No surface reflects more light than arrives: diffuse light gets what highlights leave over, and light that spreads below the surface
//! past the edge of shade is taken from the rest.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use crate::cpu::math::{clamp, max, mix, pow, saturate};

/// The cosine by which light arrives on a surface below which it spreads by `width`, 0..=1: a parabola between `-width` and `width`,
/// which meets the cosine itself with the same slope. Its integral over all directions is that of the cosine, so that no light is
/// made.
#[inline(always)]
pub(super) fn spread(cosine: f32, width: f32) -> f32 {
    let width = max(width, 1e-3);
    let within = clamp(cosine + width, 0.0, 2.0 * width);
    let beyond = max(cosine - width, 0.0);
    (within * within / (4.0 * width) + beyond) / (1.0 + width * width * (1.0 / 3.0))
}

/// The cosine to use for a surface with a normal map: near the edge of shade that of the surface itself, so that no bump is lit that
/// lies behind the edge.
#[inline(always)]
pub(super) fn bumped(of_surface: f32, of_bump: f32) -> f32 {
    mix(of_surface, of_bump, saturate(of_surface * (1.0 / 0.3)))
}

/// The distribution of microfacets (Walter et al. 2007, GGX) times their visibility (Smith; Hammon 2017) at the cosine `nh` of the half
/// vector, `nl` of the light and `nv` of the eye.
#[inline(always)]
pub(super) fn lobe(nh: f32, nl: f32, nv: f32, roughness: f32) -> f32 {
    let alpha = roughness * roughness;
    let a2 = alpha * alpha;
    let d = nh * nh * (a2 - 1.0) + 1.0;
    let distribution = a2 * std::f32::consts::FRAC_1_PI / max(d * d, 1e-9);
    distribution * 0.5 / max(mix(2.0 * nl * nv, nl + nv, alpha), 1e-4)
}

/// Schlick's approximation of Fresnel's equations, at the cosine between the light and the half vector.
#[inline(always)]
pub(super) fn fresnel(reflectance: f32, lh: f32) -> f32 {
    let grazing = 1.0 - saturate(lh);
    let square = grazing * grazing;
    reflectance + (1.0 - reflectance) * square * square * grazing
}

/// The share of light from all directions that highlights reflect toward the eye, a little more than it is: a fit to the integrals of
/// [`lobe`] times [`fresnel`] for reflectances up to 0.05. The first term is what they reflect along the normal, the second Fresnel's rise
/// toward grazing angles, which roughness lowers.
#[inline(always)]
pub(super) fn reflected_share(nv: f32, roughness: f32, reflectance: f32) -> f32 {
    let grazing = 1.0 - saturate(nv);
    let square = grazing * grazing;
    let lowered = 12.0 * pow(roughness, 1.45) * pow(grazing, max(1.5 / roughness - 1.5, 0.0));
    let rise = square * square * grazing / (1.0 + lowered);
    saturate(reflectance * (1.03 - 0.68 * roughness * roughness) + rise + 0.0055)
}

/// How much the rim of cloth replaces its colour, at the cosine of the eye.
#[inline(always)]
pub(super) fn rim(nv: f32, share: f32) -> f32 {
    let grazing = 1.0 - saturate(nv);
    share * grazing * grazing * grazing
}

/// How lit a drawing is, 0 in shade to 1 in light (`MToon` of VRM 1.0).
#[inline(always)]
pub(super) fn toon_ramp(cosine: f32, shift: f32, toony: f32) -> f32 {
    // An edge of at least a hundredth, so that it is not a line of steps.
    let edge = max(1.0 - toony, 0.01);
    saturate((cosine + shift + edge) / (2.0 * edge))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use lovelock_motion::{Material, Region};
    use lovelock_picture::BodyLook;

    use super::*;
    use crate::surface_material::SurfaceMaterial;

    /// Directions that share the sphere evenly.
    fn directions(count: usize) -> impl Iterator<Item = Vec3> {
        (0..count).map(move |i| {
            let z = 1.0 - (2.0 * i as f32 + 1.0) / count as f32;
            let (turn, out) = (2.399_963_2 * i as f32, (1.0 - z * z).max(0.0).sqrt());
            Vec3::new(out * turn.cos(), out * turn.sin(), z)
        })
    }

    /// The highlights that a surface with the normal Z reflects toward `v` of light from `l`, per unit of irradiance across the light.
    fn gloss(m: &SurfaceMaterial, l: Vec3, v: Vec3) -> f32 {
        let (nl, nv, h) = (l.z.max(0.0), v.z.max(1e-3), (l + v).normalize_or_zero());
        let lobes = m.roughness.map(|roughness| lobe(h.z, nl, nv, roughness));
        if m.reflectance > 0.0 {
            fresnel(m.reflectance, l.dot(h)) * mix(lobes[0], lobes[1], m.second) * nl
        } else {
            0.0
        }
    }

    /// The diffuse light likewise, of a white surface, times pi.
    fn diffuse(m: &SurfaceMaterial, l: Vec3, v: Vec3) -> Vec3 {
        let shares = m.roughness.map(|roughness| reflected_share(v.z.max(1e-3), roughness, m.reflectance));
        let left = if m.reflectance > 0.0 { 1.0 - mix(shares[0], shares[1], m.second) } else { 1.0 };
        // The rim of white cloth is as white.
        Vec3::from_array(m.spread.to_array().map(|width| spread(l.z, width))) * left
    }

    /// The highlights toward `v` of a white sphere of light: its directions mirrored at half vectors that are drawn as [`lobe`]
    /// distributes them.
    fn gloss_in_white_sphere(m: &SurfaceMaterial, v: Vec3) -> f32 {
        let count = 4000;
        let of_lobe = |roughness: f32| {
            let a2 = roughness.powi(4);
            let sum: f32 = (0..count)
                .map(|i| {
                    let u = (i as f32 + 0.5) / count as f32;
                    let z = ((1.0 - u) / (1.0 + (a2 - 1.0) * u)).sqrt();
                    let (turn, out) = (2.399_963_2 * i as f32, (1.0 - z * z).max(0.0).sqrt());
                    let h = Vec3::new(out * turn.cos(), out * turn.sin(), z);
                    let l = 2.0 * v.dot(h) * h - v;
                    if v.dot(h) <= 0.0 || l.z <= 0.0 {
                        return 0.0;
                    }
                    // Over the density of the directions: the distribution cancels.
                    let distribution = a2 * std::f32::consts::FRAC_1_PI / (z * z * (a2 - 1.0) + 1.0).powi(2);
                    let density = distribution * z / (4.0 * v.dot(h));
                    fresnel(m.reflectance, l.dot(h)) * lobe(z, l.z, v.z, roughness) * l.z / density
                })
                .sum();
            sum / count as f32
        };
        if m.reflectance > 0.0 {
            mix(of_lobe(m.roughness[0]), of_lobe(m.roughness[1]), m.second)
        } else {
            0.0
        }
    }

    fn surfaces() -> Vec<(String, SurfaceMaterial)> {
        let mut all = Vec::new();
        for region in [Region::Skin, Region::Eye, Region::Cloth, Region::Other] {
            for roughness in [0.1, 0.35, 0.6, 1.0] {
                for scattering in [0.0, 2.0] {
                    let look = BodyLook { scattering, ..BodyLook::default() };
                    let material = Material { region, roughness, ..Material::default() };
                    let name = format!("{region:?}, roughness {roughness}, scattering {scattering}");
                    all.push((name, SurfaceMaterial::new(&material, &look)));
                }
            }
        }
        all
    }

    /// The light toward the eye from an even white sphere of light, for several directions of the eye.
    fn in_white_sphere(m: &SurfaceMaterial) -> Vec<Vec3> {
        let count = 4000;
        let of = |nv: f32| {
            let v = Vec3::new((1.0 - nv * nv).max(0.0).sqrt(), 0.0, nv);
            let matt = directions(count).map(|l| diffuse(m, l, v)).sum::<Vec3>() * 4.0 / count as f32;
            matt + gloss_in_white_sphere(m, v)
        };
        [1.0, 0.8, 0.5, 0.35, 0.25, 0.15, 0.1, 0.05].map(of).to_vec()
    }

    #[test]
    fn no_surface_reflects_more_light_than_arrives() {
        for (name, m) in surfaces() {
            let all = in_white_sphere(&m);
            let most = all.iter().map(|c| c.max_element()).fold(0.0, f32::max);
            let least = all.iter().map(|c| c.min_element()).fold(2.0, f32::min);
            println!("{name}: {least:.4} to {most:.4}");
            // The sums over directions are exact to a few thousandths. A white surface keeps little.
            assert!(most < 1.003, "{name}: {all:?}");
            assert!(least > 0.93, "{name}: {all:?}");
        }
        // Control: light that wraps around the edge without taking it from elsewhere.
        let wrapped = |l: Vec3| ((l.z + 0.8) / 1.8).max(0.0);
        let sum = directions(4000).map(wrapped).sum::<f32>() * 4.0 / 4000.0;
        assert!(sum > 1.5, "{sum}");
    }

    #[test]
    fn a_white_ball_reflects_what_a_light_sends() {
        // Over all normals of a ball in one light, seen from everywhere: reflected power over arriving power. Smooth highlights are
        // narrower than the directions are apart.
        for (name, m) in surfaces().into_iter().filter(|(_, m)| m.roughness.iter().all(|&r| r > 0.5)) {
            let (mut sent, mut arriving) = (Vec3::ZERO, 0.0);
            for l in directions(400) {
                arriving += l.z.max(0.0);
                for v in directions(400).filter(|v| v.z > 0.0) {
                    sent += (diffuse(&m, l, v) + gloss(&m, l, v) * std::f32::consts::PI) * v.z;
                }
            }
            // Radiance times cosine over the half sphere, over pi.
            let share = sent / (arriving * 400.0) * 4.0;
            println!("{name}: {share}");
            assert!(share.max_element() < 1.005 && share.min_element() > 0.93, "{name}: {share}");
        }
    }

    #[test]
    fn red_reaches_past_the_edge_of_shade_and_the_lit_side_keeps_its_colour() {
        let skin = SurfaceMaterial::new(&Material::default(), &BodyLook::default());
        let at = |cosine: f32| skin.spread.to_array().map(|width| spread(cosine, width));
        let [r, g, b] = at(0.0);
        assert!(r > 1.8 * g && g > 1.3 * b && b > 0.0, "{r} {g} {b}");
        let [r, _, b] = at(1.0);
        assert!((r / b - 1.0).abs() < 0.06, "{r} {b}");
        assert_eq!(at(-0.5), [0.0; 3]);
        // Without scattering it is the cosine.
        for cosine in [-0.3, 0.0, 0.2, 0.9] {
            assert!((spread(cosine, 0.0) - cosine.max(0.0)).abs() < 3e-4, "{cosine}");
        }
        assert!((spread(0.42, 0.42) - 0.42 / (1.0 + 0.42 * 0.42 / 3.0)).abs() < 1e-6);
    }

    #[test]
    fn bumps_are_not_lit_behind_the_edge_of_shade() {
        assert_eq!(bumped(-0.1, 0.9), -0.1);
        assert_eq!(bumped(0.5, 0.9), 0.9);
        assert_eq!(toon_ramp(0.5, 0.0, 0.95), 1.0);
        assert_eq!(toon_ramp(-0.5, 0.0, 0.95), 0.0);
        assert!((toon_ramp(0.0, 0.0, 0.5) - 0.5).abs() < 1e-6);
        assert!((toon_ramp(-0.2, 0.2, 0.5) - 0.5).abs() < 1e-6);
    }
}
