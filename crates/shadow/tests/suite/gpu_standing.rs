//! Lights that stand somewhere: every method on the GPU against its definition on the CPU.

use glam::Vec3;
use lovelock_shadow::voxel_map::VoxelDeposit;
use lovelock_shadow::{
    LightFrame, LightSource, MapKind, ShadowInput, ShadowMethod, ShadowSettings, cpu_shadow,
};

use crate::common::{SplitMix64, of_edge};
use crate::gpu::{Built, device};
use crate::grooms::Groom;

/// Mean, 99th percentile and maximum of the differences of transmittance. A fragment at the border of two texels may go to either one,
/// because places on the plane are rounded differently, so the maximum is that of one strand.
#[derive(Debug)]
struct Differences([f32; 3]);

impl Differences {
    fn of(a: &[f32], b: &[f32]) -> Self {
        let mut all: Vec<_> = a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect();
        all.sort_by(f32::total_cmp);
        let mean = all.iter().sum::<f32>() / all.len() as f32;
        Self([mean, all[all.len() * 99 / 100], all[all.len() - 1]])
    }

    fn within(&self, most: [f32; 3]) -> bool {
        self.0.iter().zip(most).all(|(found, most)| *found <= most)
    }
}

/// Half a step of 8 bits is 0.00196. Measured: 0.0010, 0.0031 and, of density clustering, 0.14.
fn most(method: ShadowMethod) -> [f32; 3] {
    // As in directional light, a fragment half way between two centres may go to either one.
    let by_chance = [ShadowMethod::DensityClustering, ShadowMethod::RayTraced].contains(&method);
    [0.0015, 0.006, if by_chance { 0.25 } else { 0.1 }]
}

fn points(groom: &Groom) -> Vec<Vec3> {
    let mut random = SplitMix64::new(4);
    let at = |i: usize| {
        let p = groom.strands.point((random.unit() * (groom.strands.points() - 1) as f32) as usize);
        if i.is_multiple_of(3) { p + 0.1 * random.signed_vec3() } else { p }
    };
    (0..1500).map(at).chain([Vec3::NAN, Vec3::splat(40.0)]).collect()
}

/// Places of lights: before the hair, beside it, between its strands, and a kilometre away.
fn places(groom: &Groom) -> [Vec3; 4] {
    let anchor = groom.input().anchor;
    let within = groom.strands.point(groom.strands.points() / 3) + Vec3::splat(0.003);
    [
        anchor + Vec3::new(-0.2, 0.5, 0.3),
        anchor + Vec3::new(0.05, 0.02, 0.1),
        within,
        anchor + 1000.0 * Vec3::Y,
    ]
}

fn defined(input: &ShadowInput, settings: &ShadowSettings, at: &[Vec3]) -> Vec<f32> {
    let mut map = cpu_shadow(settings.method);
    map.build(input, settings).expect("it fits");
    at.iter().map(|&p| map.transmittance(p)).collect()
}

fn lit(groom: &Groom, position: Vec3) -> ShadowInput<'_> {
    let source = LightSource { position, radius: 0.01 };
    let anchor = groom.input().anchor;
    ShadowInput { light: LightFrame::new(Vec3::NEG_Y).standing(source, anchor), ..groom.input() }
}

#[test]
fn transmittance_is_that_of_the_definition_wherever_the_light_stands() {
    let Some(gpu) = device() else { return };
    let groom = Groom::tuft();
    let at = points(&groom);
    for &method in ShadowMethod::ALL {
        let mut built = Built::empty(gpu, method);
        let settings = of_edge(method, 128);
        let mut dark = 0;
        for position in places(&groom) {
            let input = lit(&groom, position);
            built.build(0, &input, &settings).expect("it fits");
            let (found, wanted) = (built.look_up(&at), defined(&input, &settings, &at));
            let off = Differences::of(&found, &wanted);
            assert!(off.within(most(method)), "{method} at {position}: {off:?}");
            assert_eq!(found[1500..], [1.0, 1.0], "{method} at {position}");
            dark += wanted.iter().filter(|t| **t < 0.7).count();
        }
        if method.map_kind() != MapKind::None {
            assert!(dark > 500, "{method}: {dark} points are dark");
            // Control: the light of another place is another one.
            let [a, b, ..] = places(&groom).map(|position| defined(&lit(&groom, position), &settings, &at));
            assert!(!Differences::of(&a, &b).within(most(method)), "{method}");
        }
    }
}

#[test]
fn counted_points_become_denser_near_the_light_on_both_backends() {
    let Some(gpu) = device() else { return };
    let groom = Groom::tuft();
    let at = points(&groom);
    let method = ShadowMethod::VoxelMap;
    let mut settings = of_edge(method, 64);
    settings.voxel_map.deposit = VoxelDeposit::PointCount;
    for position in places(&groom) {
        let input = lit(&groom, position);
        let mut built = Built::new(gpu, method, &input, &settings);
        let off = Differences::of(&built.look_up(&at), &defined(&input, &settings, &at));
        assert!(off.within(most(method)), "{position}: {off:?}");
    }
}

#[test]
fn lights_of_all_kinds_share_a_picture() {
    let Some(gpu) = device() else { return };
    let groom = Groom::tuft();
    let at = points(&groom);
    let [before, _, within, _] = places(&groom);
    for method in [ShadowMethod::VoxelMap, ShadowMethod::Exact] {
        let mut built = Built::empty(gpu, method);
        let settings = of_edge(method, 64);
        // The kinds change from frame to frame.
        for frame in 0..2 {
            let of = |slot: usize| match (slot + frame) % 3 {
                0 => groom.input(),
                1 => lit(&groom, before),
                _ => lit(&groom, within),
            };
            let inputs = [0, 1, 2].map(|slot| ShadowInput { maps: 3, ..of(slot) });
            for (slot, input) in inputs.iter().enumerate() {
                built.build(slot, input, &settings).expect("it fits");
            }
            let words = built.ask_slots(&[0, 1, 2], &at);
            for (slot, input) in inputs.iter().enumerate() {
                let byte = |word: &u32| (word >> (8 * slot) & 0xff) as f32 / 255.0;
                let found: Vec<_> = words.iter().map(byte).collect();
                let off = Differences::of(&found, &defined(input, &settings, &at));
                assert!(off.within(most(method)), "{method}, frame {frame}, light {slot}: {off:?}");
                assert!(built.shadow.report(slot).memory_bytes > 0);
            }
            assert!(words.iter().all(|word| word >> 24 == 0xff), "{method}: the fourth light");
        }
    }
}
