//! The voxel map with adaptive slices, and with density that does not know the direction of strands, against results on paper and the
//! converged shadow.

use crate::common::{HEAD, SplitMix64, strands};
use crate::grooms::Groom;
use glam::Vec3;
use lovelock_shadow::voxel_map::{VoxelDeposit, VoxelSlices};
use lovelock_shadow::{
    LightFrame, RayMarkKind, ShadowInput, ShadowMethod, ShadowSettings, converged, cpu_shadow,
};
use lovelock_testkit::suite::cases;

const LIGHT: Vec3 = Vec3::new(0.4, -1.0, -0.5);

fn settings(resolution: u32, slices: VoxelSlices, deposit: VoxelDeposit) -> ShadowSettings {
    let mut settings = ShadowSettings::default();
    (settings.voxel_map.resolution, settings.voxel_map.slices) = (resolution, slices);
    settings.voxel_map.deposit = deposit;
    settings
}

fn uniform(resolution: u32) -> ShadowSettings {
    settings(resolution, VoxelSlices::Uniform, VoxelDeposit::Length)
}

fn adaptive(resolution: u32) -> ShadowSettings {
    settings(resolution, VoxelSlices::Adaptive, VoxelDeposit::Length)
}

/// Transmittance at points.
fn at(input: &ShadowInput, settings: &ShadowSettings, points: &[Vec3]) -> Vec<f32> {
    let mut map = cpu_shadow(ShadowMethod::VoxelMap);
    map.build(input, settings).expect("it fits");
    points.iter().map(|p| map.transmittance(*p)).collect()
}

fn rmse(a: &[f32], b: &[f32]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    (squares / a.len() as f64).sqrt()
}

/// How far a sheet moves along the light per metre across it.
const SLOPE: f32 = 0.2;

/// A sheet of strands, 2 mm thick along the light and 30 cm wide, at a slope to the light.
fn sheet(light: &LightFrame) -> Vec<Vec<Vec3>> {
    let mut random = SplitMix64::new(9);
    let strand = |i: u16| {
        let across = 0.3 * ((f32::from(i) + random.unit()) / 8000.0 - 0.5);
        let depth = SLOPE * across + 0.001 * random.signed();
        [-0.05, 0.05].map(|along| HEAD + light.world_from_light(Vec3::new(depth, across, along))).to_vec()
    };
    (0..8000).map(strand).collect()
}

#[test]
fn a_thin_sheet_at_a_slope_is_a_step_where_cells_of_a_centimetre_are_a_ramp() {
    let light = LightFrame::new(LIGHT);
    let hair = strands(&sheet(&light));
    let input = ShadowInput {
        strands: &hair,
        strand_width: 2e-4,
        extinction_scale: 0.15,
        light,
        anchor: HEAD,
        maps: 1,
        projected: None,
    };
    // 8000 strands of 0.2 mm in 30 cm.
    let sheet = (-0.15_f32 * 2e-4 * 8000.0 / 0.3).exp();
    let mean = |settings: &ShadowSettings, behind: f32| {
        let place = |i: i32| {
            let across = 0.0031 * i as f32;
            let p = Vec3::new(SLOPE * across + behind, across, 0.0007 * i as f32);
            HEAD + light.world_from_light(p)
        };
        let found = at(&input, settings, &(-30..30).map(place).collect::<Vec<_>>());
        found.iter().sum::<f32>() / found.len() as f32
    };
    let mut wrong = 0.0_f32;
    for (behind, truth) in [(-0.02, 1.0), (-0.004, 1.0), (0.004, sheet), (0.02, sheet)] {
        let (found, coarse) = (mean(&adaptive(32), behind), mean(&uniform(32), behind));
        println!("{behind}: {found:.4}, by hand {truth:.4}, uniform {coarse:.4}");
        assert!((found - truth).abs() < 0.015, "{behind}: {found}, not {truth}");
        wrong = wrong.max((coarse - truth).abs());
    }
    assert!(wrong > 0.05, "control: uniform slices are off by {wrong}");
}

/// Errors against the converged shadow over the texels of `exact` at 500 random points, in 128³ cells: uniform, adaptive, and uniform with
/// density that does not know the direction of strands.
const MEASURED: [(&str, [f64; 3]); 5] = [
    ("slab", [0.0875, 0.0595, 0.0930]),
    ("tuft", [0.0695, 0.0423, 0.1016]),
    ("smooth", [0.0236, 0.0228, 0.0634]),
    ("curly", [0.0252, 0.0218, 0.0314]),
    ("straight.hair", [0.0597, 0.0425, 0.0900]),
];

/// The errors of settings at 500 random points of the hair.
fn errors<const N: usize>(groom: &Groom, of: [ShadowSettings; N]) -> [f64; N] {
    let mut random = SplitMix64::new(12);
    let hair = &groom.strands;
    let point = |_| hair.point((random.unit() * hair.points() as f32) as usize % hair.points());
    let points: Vec<_> = (0..500).map(point).collect();
    let axis = |axis: usize| points.iter().map(|p| p[axis]).collect::<Vec<_>>();
    let exact = ShadowSettings { method: ShadowMethod::Exact, ..ShadowSettings::default() };
    let truth = converged(&groom.input(), &exact, [&axis(0), &axis(1), &axis(2)]).expect("it fits");
    of.map(|settings| rmse(&at(&groom.input(), &settings, &points), &truth.transmittance))
}

#[test]
fn adaptive_slices_and_orientation_are_nearer_to_the_converged_shadow() {
    let names = MEASURED.map(|(name, _)| name);
    let isotropic = settings(128, VoxelSlices::Uniform, VoxelDeposit::Isotropic);
    let mut wrong = Vec::new();
    for groom in Groom::all().iter().filter(|groom| cases(&["tuft"], &names).contains(&groom.name)) {
        let found = errors(groom, [uniform(128), adaptive(128), isotropic]);
        println!("{}: uniform, adaptive, isotropic {found:.4?}", groom.name);
        let (_, measured) = MEASURED.iter().find(|(name, _)| *name == groom.name).expect("measured");
        let within = found.iter().zip(measured).all(|(found, of)| (0.9 * of..1.1 * of).contains(found));
        if !(within && found[1] < found[0] && found[0] < found[2]) {
            wrong.push((groom.name, found, measured));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
    // Control: where columns are wider than strands, each choice is found out in the place of another.
    for (name, [uniform, adaptive, isotropic]) in MEASURED {
        let apart = isotropic > 1.1 / 0.9 * uniform && uniform > 1.1 / 0.9 * adaptive;
        assert_eq!(apart, ["tuft", "straight.hair"].contains(&name), "{name}");
    }
}

#[test]
fn a_strand_seen_end_on_covers_less() {
    let light = LightFrame::new(LIGHT);
    // 20,000 strands of 8 mm, all at one angle to the light, in a box of 10 cm along the light and 6 cm across it.
    let slab = |sine: f32| {
        let mut random = SplitMix64::new(4);
        let half = 0.004 * Vec3::new((1.0 - sine * sine).sqrt(), sine, 0.0);
        let strand = |_| {
            let middle = Vec3::new(0.05, 0.03, 0.03) * random.signed_vec3();
            [middle - half, middle + half].map(|p| HEAD + light.world_from_light(p)).to_vec()
        };
        strands(&(0..20_000).map(strand).collect::<Vec<_>>())
    };
    for sine in [0.2_f32, 0.5, 1.0] {
        let hair = slab(sine);
        let input = ShadowInput {
            strands: &hair,
            strand_width: 1e-4,
            extinction_scale: 0.2,
            light,
            anchor: HEAD,
            maps: 1,
            projected: None,
        };
        // Behind the box: s w (total length) sinθ / area across the light.
        let depth = |sine: f32| 0.2 * 1e-4 * 20_000.0 * 0.008 * sine / (0.06 * 0.06);
        let place = |i: usize| {
            let across = Vec3::new(0.0, (i % 8) as f32 - 3.5, (i / 8) as f32 - 3.5) * 0.005;
            HEAD + light.world_from_light(across + 0.06 * Vec3::X)
        };
        let points: Vec<_> = (0..64).map(place).collect();
        let mean = |deposit: VoxelDeposit| {
            let light = at(&input, &settings(32, VoxelSlices::Uniform, deposit), &points);
            light.iter().sum::<f32>() / light.len() as f32
        };
        let oriented = (mean(VoxelDeposit::Length), (-depth(sine)).exp());
        let isotropic = (mean(VoxelDeposit::Isotropic), (-depth(std::f32::consts::FRAC_PI_4)).exp());
        println!("sine {sine}: oriented {oriented:.4?}, isotropic {isotropic:.4?}");
        for (found, expected) in [oriented, isotropic] {
            assert!((found - expected).abs() < 0.01, "{sine}: {found}, not {expected}");
        }
        // Control: neither is the other, but where the sine is near its mean.
        assert!((oriented.0 - isotropic.0).abs() > 0.08, "control, {sine}: {oriented:?}, {isotropic:?}");
    }
}

#[test]
fn marks_of_adaptive_cells_add_up_to_what_the_map_answers() {
    let groom = Groom::tuft();
    let input = groom.input();
    let mut map = cpu_shadow(ShadowMethod::VoxelMap);
    map.build(&input, &adaptive(64)).expect("it fits");
    let mut seen = 0;
    for point in (0..groom.strands.points()).step_by(977) {
        let marks = map.along_ray(groom.strands.point(point)).marks;
        let kinds: Vec<RayMarkKind> = ShadowMethod::VoxelMap.marks().to_vec();
        assert!(marks.iter().all(|mark| kinds.contains(&mark.kind) && mark.start <= mark.end));
        assert!(marks.windows(2).all(|pair| pair[0].end <= pair[1].start + 1e-6));
        let sum: f32 = marks.iter().map(|mark| mark.optical_depth).sum();
        if let Some(last) = marks.last() {
            assert!(((-sum).exp() - last.transmittance).abs() < 1e-4, "{sum}: {last:?}");
            seen += 1;
        }
    }
    assert!(seen > 20, "{seen}");
}

#[test]
fn switching_slices_frees_the_other_map_and_gives_the_same_again() {
    let groom = Groom::tuft();
    let points: Vec<_> = (0..groom.strands.points()).step_by(499).map(|i| groom.strands.point(i)).collect();
    let mut map = cpu_shadow(ShadowMethod::VoxelMap);
    let mut look = |settings: &ShadowSettings| {
        map.build(&groom.input(), settings).expect("it fits");
        (points.iter().map(|p| map.transmittance(*p)).collect::<Vec<_>>(), map.report().memory_bytes)
    };
    let (first, bytes) = look(&uniform(64));
    let (other, fewer) = look(&adaptive(64));
    assert_eq!(look(&uniform(64)), (first.clone(), bytes));
    assert!(first != other && fewer < bytes, "{fewer}, {bytes}");
    assert_eq!(look(&adaptive(64)).0, other);
}
