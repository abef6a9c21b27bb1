//! Lights with an area, against the penumbra of a card that is known on paper: every method on both backends.

use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_shadow::{
    LightArea, LightFrame, LightSource, MapKind, ShadowInput, ShadowMethod, ShadowSettings, converged,
    cpu_shadow,
};

use crate::common::{HEAD, of_edge, strands};
use crate::gpu::{Built, device};
use crate::grooms::Groom;

/// Distance from the card to the points, metres.
const BELOW: f32 = 0.05;

/// An opaque card across the vertical through [`HEAD`], which ends at its x.
fn card() -> Strands {
    let strand = |i: usize| {
        let at = |z: f32| HEAD + Vec3::new(-2.5e-4 - 5e-4 * i as f32, 0.0, z);
        (-5..=5).map(|part| at(0.01 * part as f32)).collect()
    };
    strands(&(0..120).map(strand).collect::<Vec<_>>())
}

fn input(strands: &Strands, light: LightFrame) -> ShadowInput<'_> {
    ShadowInput {
        strands,
        strand_width: 5e-4,
        extinction_scale: 20.0,
        light,
        anchor: HEAD,
        maps: 1,
        projected: None,
    }
}

/// Methods that cast a shadow.
fn methods() -> impl Iterator<Item = ShadowMethod> {
    ShadowMethod::ALL.iter().copied().filter(|method| method.map_kind() != MapKind::None)
}

/// The area of the part of a disc of radius 1 beyond a chord at -t, as a share.
fn share_of_disc(t: f32) -> f32 {
    let t = t.clamp(-1.0, 1.0);
    0.5 + (t * (1.0 - t * t).sqrt() + t.asin()) / std::f32::consts::PI
}

/// Places across the edge of the shadow, in units of half the width of the penumbra.
fn places() -> Vec<f32> {
    (-12..=12).map(|i| 0.1 * i as f32).collect()
}

fn light(angle: f32, samples: u32) -> LightFrame {
    LightFrame { area: LightArea { angle, samples }, ..LightFrame::new(Vec3::NEG_Y) }
}

fn lamp(distance: f32, radius: f32, samples: u32) -> LightFrame {
    let source = LightSource { position: HEAD + distance * Vec3::Y, radius };
    LightFrame {
        area: LightArea { angle: 0.0, samples },
        ..LightFrame::new(Vec3::NEG_Y).standing(source, HEAD)
    }
}

/// The largest difference from the answer on paper where half the penumbra is `half` metres wide.
fn worst(half: f32, at: impl Fn(&[Vec3]) -> Vec<f32>) -> f32 {
    let points: Vec<_> = places().iter().map(|t| HEAD + Vec3::new(t * half, -BELOW, 0.0)).collect();
    let found = at(&points);
    let off = places().into_iter().zip(found).map(|(t, found)| (found - share_of_disc(t)).abs());
    off.fold(0.0, f32::max)
}

fn defined(input: &ShadowInput, settings: &ShadowSettings, at: &[Vec3]) -> Vec<f32> {
    let mut map = cpu_shadow(settings.method);
    map.build(input, settings).expect("it fits");
    let [x, y, z] = [0, 1, 2].map(|axis| at.iter().map(|p| p[axis]).collect::<Vec<_>>());
    let mut out = vec![f32::NAN; at.len()];
    map.transmittance_at(&x, &y, &z, &mut out);
    // Both ways to look up.
    assert!(at.iter().zip(&out).all(|(p, t)| (map.transmittance(*p) - t).abs() < 1e-5));
    out
}

fn settings(method: ShadowMethod) -> ShadowSettings {
    let mut settings = of_edge(method, if method.map_kind() == MapKind::Cells { 128 } else { 256 });
    settings.ray_traced.rays = 256;
    settings
}

#[test]
fn the_penumbra_of_a_card_is_that_on_paper_for_every_method() {
    let hair = card();
    let angle = 0.2_f32;
    let half = BELOW * angle.tan();
    for method in methods() {
        let off = |light| worst(half, |at| defined(&input(&hair, light), &settings(method), at));
        let soft = off(light(angle, 64));
        assert!(soft < 0.08, "{method}: {soft}");
        let hard = off(light(angle, 1));
        assert!(hard > 0.3, "{method}, control: a hard edge: {hard}");
        let other = off(light(0.5 * angle, 64));
        assert!(other > 0.15, "{method}, control: half the angle: {other}");
    }
}

#[test]
fn a_lamp_has_the_penumbra_of_its_radius() {
    let hair = card();
    let (distance, radius) = (0.25, 0.05);
    let half = BELOW * radius / distance;
    for method in methods() {
        let off = |light| worst(half, |at| defined(&input(&hair, light), &settings(method), at));
        let soft = off(lamp(distance, radius, 64));
        assert!(soft < 0.09, "{method}: {soft}");
        let hard = off(lamp(distance, radius, 1));
        assert!(hard > 0.3, "{method}, control: {hard}");
    }
}

#[test]
fn the_converged_penumbra_has_more_samples_than_any_method() {
    let hair = card();
    let angle = 0.2_f32;
    let off = |samples| {
        let input = input(&hair, light(angle, samples));
        worst(BELOW * angle.tan(), |at| {
            let [x, y, z] = [0, 1, 2].map(|axis| at.iter().map(|p| p[axis]).collect::<Vec<_>>());
            let found = converged(&input, &settings(ShadowMethod::Exact), [&x, &y, &z]).expect("it fits");
            assert_eq!(found.light_samples > 1, samples > 1);
            found.transmittance
        })
    };
    assert!(off(2) < 0.05, "{}", off(2));
    assert!(off(1) > 0.3, "control");
}

#[test]
fn errors_fall_with_samples() {
    let hair = card();
    let angle = 0.2_f32;
    let off = |samples| {
        worst(BELOW * angle.tan(), |at| {
            defined(&input(&hair, light(angle, samples)), &settings(ShadowMethod::Exact), at)
        })
    };
    let all = [1, 4, 16, 64].map(off);
    assert!(all.windows(2).all(|pair| pair[1] < pair[0]) && all[2] < 0.15, "{all:?}");
}

#[test]
fn maps_of_samples_share_the_limit_of_memory() {
    let hair = card();
    let mut settings = settings(ShadowMethod::Exact);
    settings.exact.memory_limit_bytes = 16 << 20;
    let report = |samples| {
        let mut map = cpu_shadow(settings.method);
        let built = map.build(&input(&hair, light(0.1, samples)), &settings);
        let light = map.transmittance(HEAD - BELOW * Vec3::Y - 0.03 * Vec3::X);
        built.map(|()| map.report()).map_err(|error| (error.to_string(), light))
    };
    let (one, four) = (report(1).expect("it fits"), report(4).expect("it fits"));
    let ratio = four.memory_bytes as f64 / one.memory_bytes as f64;
    assert!((3.0..5.0).contains(&ratio), "{ratio}");
    assert!(one.needed_bytes < 16 << 20);
    let (error, light) = report(64).expect_err("it does not fit");
    assert!(error.contains("exact"), "{error}");
    assert_eq!(light, 1.0, "everything is lit");
}

/// Mean and largest difference.
fn difference(a: &[f32], b: &[f32]) -> [f32; 2] {
    let all = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    let (sum, most) = all.fold((0.0, 0.0_f32), |(sum, most), off| (sum + off, most.max(off)));
    [sum / a.len() as f32, most]
}

#[test]
fn both_backends_agree_on_soft_shadows() {
    let Some(gpu) = device() else { return };
    let groom = Groom::tuft();
    let anchor = groom.input().anchor;
    let at: Vec<_> = (0..groom.strands.points()).step_by(7).map(|i| groom.strands.point(i)).collect();
    let area = LightArea { angle: 0.1, samples: 5 };
    let parallel = LightFrame { area, ..LightFrame::new(Vec3::new(0.3, -1.0, 0.2)) };
    let source = LightSource { position: anchor + Vec3::new(-0.2, 0.5, 0.3), radius: 0.05 };
    let standing = LightFrame { area, ..LightFrame::new(Vec3::NEG_Y).standing(source, anchor) };
    for &method in ShadowMethod::ALL {
        // Density between the centres of cells blurs hard shadows more than texels do.
        let settings = of_edge(method, if method == ShadowMethod::VoxelMarch { 192 } else { 64 });
        let mut built = Built::empty(gpu, method);
        for light in [parallel, standing] {
            let input = ShadowInput { light, ..groom.input() };
            built.build(0, &input, &settings).expect("it fits");
            let (found, wanted) = (built.look_up(&at), defined(&input, &settings, &at));
            let [mean, most] = difference(&found, &wanted);
            assert!(mean < 0.002 && most < 0.1, "{method}: {mean}, {most}");
            if method.map_kind() != MapKind::None {
                let hard = ShadowInput { light: LightFrame { area: LightArea::HARD, ..light }, ..input };
                let [mean, _] = difference(&found, &defined(&hard, &settings, &at));
                println!("{method}: a hard shadow differs by {mean}");
                assert!(mean > 0.004, "{method}, control: a hard shadow: {mean}");
            }
        }
    }
}

#[test]
fn soft_and_hard_lights_share_a_picture() {
    let Some(gpu) = device() else { return };
    let groom = Groom::tuft();
    let at: Vec<_> = (0..groom.strands.points()).step_by(7).map(|i| groom.strands.point(i)).collect();
    for method in [ShadowMethod::VoxelMap, ShadowMethod::Exact, ShadowMethod::Adaptive] {
        let settings = of_edge(method, 64);
        let mut built = Built::empty(gpu, method);
        // The number of samples changes from frame to frame.
        for samples in [[3, 1, 6], [1, 1, 1], [2, 6, 1]] {
            let inputs = [0, 1, 2].map(|slot| {
                let way = [Vec3::new(0.3, -1.0, 0.2), Vec3::new(-0.6, -0.5, 0.1), Vec3::X][slot];
                let area = LightArea { angle: 0.2, samples: samples[slot] };
                ShadowInput { light: LightFrame { area, ..LightFrame::new(way) }, maps: 3, ..groom.input() }
            });
            for (slot, input) in inputs.iter().enumerate() {
                built.build(slot, input, &settings).expect("it fits");
            }
            let words = built.ask_slots(&[0, 1, 2], &at);
            for (slot, input) in inputs.iter().enumerate() {
                let byte = |word: &u32| (word >> (8 * slot) & 0xff) as f32 / 255.0;
                let found: Vec<_> = words.iter().map(byte).collect();
                let [mean, most] = difference(&found, &defined(input, &settings, &at));
                assert!(mean < 0.002 && most < 0.1, "{method}, {samples:?}, light {slot}: {mean}, {most}");
            }
        }
    }
}
