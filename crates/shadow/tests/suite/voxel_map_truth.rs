//! Compares the voxel map with analytic results.

use crate::common::{CURLY, EXTINCTION, HEAD, SMOOTH, SplitMix64, Style, grow, resampled, strands};
use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_shadow::voxel_map::reference::{Addressing, DenseMap};
use lovelock_shadow::voxel_map::{MapExtent, VoxelDeposit, VoxelFilter, VoxelMap};
use lovelock_shadow::{CpuShadow, LightFrame, ShadowInput, ShadowSettings};

fn input(strands: &Strands, direction: Vec3) -> ShadowInput<'_> {
    let strand_width = 80e-6 * 100_000.0 / strands.count().max(1) as f32;
    ShadowInput {
        strands,
        strand_width,
        extinction_scale: EXTINCTION,
        light: LightFrame::new(direction),
        anchor: HEAD,
        maps: 1,
        projected: None,
    }
}

fn settings(resolution: u32) -> ShadowSettings {
    let mut settings = ShadowSettings::default();
    settings.voxel_map.resolution = resolution;
    settings
}

fn built(input: &ShadowInput, settings: &ShadowSettings) -> VoxelMap {
    let mut map = VoxelMap::default();
    map.build(input, settings).expect("fits");
    map
}

fn at_points(map: &VoxelMap, strands: &Strands) -> Vec<f32> {
    let mut out = vec![f32::NAN; strands.points()];
    map.transmittance_at(&strands.x, &strands.y, &strands.z, &mut out);
    out
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64
}

const LIGHT: Vec3 = Vec3::new(0.4, -1.0, -0.5);

/// A small head of hair: a wisp in nine strands of the published one.
fn small(style: Style) -> Strands {
    strands(&grow(Style { strands_per_wisp: 9, ..style }, 7))
}

/// A box full of short strands across the light, evenly spread: 0.2 m along the light (down), 0.16 m across.
fn slab(light: &LightFrame) -> Vec<Vec<Vec3>> {
    let mut random = SplitMix64::new(3);
    let count = 40_000;
    let mut made = Vec::new();
    for i in 0..count {
        // Uniform along the light, random across it.
        let along = 0.2 * (i as f32 + random.unit()) / count as f32;
        let middle = Vec3::new(along, 0.08 * random.signed(), 0.08 * random.signed());
        let half = 0.004 * if i % 2 == 0 { Vec3::Y } else { Vec3::Z };
        made.push(vec![
            HEAD + light.world_from_light(middle - half),
            HEAD + light.world_from_light(middle + half),
        ]);
    }
    made
}

#[test]
fn a_uniform_slab_dims_exponentially() {
    let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z, LIGHT];
    for direction in axes {
        let light = LightFrame::new(direction);
        let of = slab(&light);
        let hair = strands(&of);
        let input = ShadowInput { extinction_scale: 0.5, ..input(&hair, direction) };
        let map = built(&input, &settings(64));
        // κ = s_ext · w · (total length) / volume.
        let kappa =
            f64::from(input.extinction_scale) * f64::from(input.strand_width) * 0.008 * of.len() as f64
                / (0.2 * 0.16 * 0.16);
        for step in 0..=20 {
            let along = 0.2 * step as f32 / 20.0;
            // The mean over the middle of the slab, which evens out the scatter of the strands.
            let mut sum = 0.0;
            for j in 0..20 {
                for k in 0..20 {
                    let across = Vec3::new(0.0, j as f32 - 9.5, k as f32 - 9.5) * 0.006;
                    let p = HEAD + light.world_from_light(across + along * Vec3::X);
                    sum += f64::from(map.transmittance(p));
                }
            }
            let truth = (-kappa * f64::from(along)).exp();
            // 40,000 scattered strands: about 100 cross a column of cells over its depth, 10 % each, 400 columns;
            // the mean of exponentials of scattered depths is above the exponential of the mean by half their
            // variance, τ² / 200 here.
            assert!(
                (sum / 400.0 - truth).abs() < 0.012,
                "{direction}: T({along}) = {} not {truth}",
                sum / 400.0
            );
            // Control: half a slab, or twice the extinction, is distinguished.
            if step == 10 {
                assert!((sum / 400.0 - (-kappa * 0.05).exp()).abs() > 0.1);
                assert!((sum / 400.0 - (-2.0 * kappa * 0.1).exp()).abs() > 0.05);
            }
        }
    }
}

#[test]
fn brightness_does_not_depend_on_resolution() {
    for style in [SMOOTH, CURLY] {
        let hair = small(style);
        let means =
            [64, 128, 256].map(|n| mean(&at_points(&built(&input(&hair, LIGHT), &settings(n)), &hair)));
        for m in means {
            assert!((m / means[1] - 1.0).abs() < 0.03, "mean transmittance at 64, 128, 256: {means:?}");
        }
        assert!(means[1] > 0.1 && means[1] < 0.6, "not a shadow to speak of: {means:?}");
        // Control: the printed coupling loses a factor of 8 in depth an octave.
        let printed = [64, 128].map(|n| {
            let mut settings = settings(n);
            settings.voxel_map.deposit = VoxelDeposit::PointCount;
            mean(&at_points(&built(&input(&hair, LIGHT), &settings), &hair))
        });
        assert!(printed[1] / printed[0] > 1.3, "the printed formula: {printed:?}");
    }
}

#[test]
fn brightness_does_not_depend_on_the_samples_of_a_strand() {
    // Fine enough that every other point still follows the curl.
    let of = grow(Style { strands_per_wisp: 9, segments: 90, ..SMOOTH }, 7);
    let hair = strands(&of);
    let expected = mean(&at_points(&built(&input(&hair, LIGHT), &settings(128)), &hair));
    let mut printed = settings(128);
    printed.voxel_map.deposit = VoxelDeposit::PointCount;
    let printed_expected = mean(&at_points(&built(&input(&hair, LIGHT), &printed), &hair));
    for factor in [0.5, 2.0] {
        let again = strands(&resampled(&of, factor));
        let mean_at =
            |settings: &ShadowSettings| mean(&at_points(&built(&input(&again, LIGHT), settings), &hair));
        let ratio = mean_at(&settings(128)) / expected;
        assert!((ratio - 1.0).abs() < 0.02, "×{factor}: {ratio}");
        // Control: counting points depends on them.
        let ratio = mean_at(&printed) / printed_expected;
        assert!((ratio - 1.0).abs() > 0.05, "×{factor} by count: {ratio}");
    }
}

#[test]
fn a_cell_shadows_its_back_face_and_what_lies_behind() {
    // One short strand across light that falls straight down.
    let end = HEAD + Vec3::new(0.004, 0.0, 0.0);
    let far = [HEAD - 0.1 * Vec3::ONE, HEAD - 0.1 * Vec3::ONE, HEAD + 0.1 * Vec3::ONE];
    let hair = strands(&[vec![HEAD, end], far[..2].to_vec(), far[2..].to_vec()]);
    let input = ShadowInput { strand_width: 0.01, ..input(&hair, Vec3::NEG_Y) };
    let map = built(&input, &settings(64));
    let ds = map.lattice().expect("built").cell_size;
    let below = |cells: f32| map.transmittance(HEAD + Vec3::new(0.002, -cells * ds, 0.0));
    // The anchor is a corner of the lattice: the strand lies in the slice that begins at it.
    assert_eq!(below(-1.0), 1.0, "before the cell");
    assert_eq!(below(-0.01), 1.0, "just before the cell");
    let behind = below(1.5);
    assert!(behind < 0.999, "the cell's own hair counts behind it: {behind}");
    // Rounding of coordinates: 1.6 m in f32, in cells of 3.5 mm.
    assert!((below(1.0) - behind).abs() < 1e-4, "the value belongs to the back face");
    for cells in [3.0, 20.0, 1000.0] {
        assert_eq!(below(cells), behind, "empty cells keep the running value");
    }
    // Optical depth is linear within the cell.
    let half = below(0.5);
    let columns = (behind.ln() - 2.0 * half.ln()).abs();
    // The point reads columns of different depth, of which the logarithm is not the mean: second order in τ.
    assert!(columns < behind.ln().powi(2), "half way: {half}, behind: {behind}");
}

#[test]
fn a_single_lit_column_casts_a_symmetric_shadow() {
    // A strand in the middle of a cell across the light: half a cell from the lattice's corner.
    let probe = built(
        &input(&strands(&[vec![HEAD - 0.1 * Vec3::ONE, HEAD + 0.1 * Vec3::ONE]]), Vec3::X),
        &settings(64),
    );
    let ds = probe.lattice().expect("built").cell_size;
    let middle = HEAD + Vec3::new(0.0, 0.5, 0.5) * ds;
    let corners = [HEAD - 0.1 * Vec3::ONE, HEAD + 0.1 * Vec3::ONE];
    let hair = strands(&[
        vec![middle - 0.2 * ds * Vec3::Y, middle + 0.2 * ds * Vec3::Y],
        vec![corners[0]],
        vec![corners[1]],
    ]);
    let shadow = |filter: VoxelFilter, offset: Vec3| {
        let mut settings = settings(64);
        settings.voxel_map.filter = filter;
        let input = ShadowInput { strand_width: 0.05, ..input(&hair, Vec3::X) };
        let map = built(&input, &settings);
        assert_eq!(map.lattice().expect("built").cell_size, ds);
        map.transmittance(middle + 0.05 * Vec3::X + offset * ds)
    };
    for offset in [0.1, 0.25, 0.5, 0.75, 0.99] {
        for axis in [Vec3::Y, Vec3::Z] {
            let [left, right] = [-offset, offset].map(|o| shadow(VoxelFilter::Centred, o * axis));
            // Rounding of coordinates: 1.7 m in f32, in cells of 3.5 mm.
            assert!((left - right).abs() < 1e-4, "±{offset} {axis}: {left}, {right}");
            // Control: the printed filter casts it to one side.
            let [left, right] = [-offset, offset].map(|o| shadow(VoxelFilter::Paper, o * axis));
            assert!((left - right).abs() > 0.01, "±{offset} {axis}: {left}, {right}");
        }
    }
    // One cell away, a lone column has no shadow.
    assert_eq!(shadow(VoxelFilter::Centred, 1.01 * Vec3::Y), 1.0);
    assert!(shadow(VoxelFilter::Paper, 1.01 * Vec3::Y) < 1.0);
}

#[test]
fn without_a_filter_a_cell_has_one_value_that_of_its_back_face() {
    let corners = [HEAD - 0.1 * Vec3::ONE, HEAD + 0.1 * Vec3::ONE];
    let probe = built(&input(&strands(&[corners.to_vec()]), Vec3::X), &settings(64));
    let ds = probe.lattice().expect("built").cell_size;
    let middle = HEAD + 0.5 * ds * Vec3::ONE;
    let hair = strands(&[
        vec![middle - 0.2 * ds * Vec3::Y, middle + 0.2 * ds * Vec3::Y],
        vec![corners[0]],
        vec![corners[1]],
    ]);
    let input = ShadowInput { strand_width: 0.05, ..input(&hair, Vec3::X) };
    // τ = s w ℓ / ds², with ℓ = 0.4 ds.
    let depth = EXTINCTION * input.strand_width * 0.4 / ds;
    let mut settings = settings(64);
    let mut at = |filter: VoxelFilter, x: f32, y: f32, z: f32| {
        settings.voxel_map.filter = filter;
        let map = built(&input, &settings);
        assert_eq!(map.lattice().expect("built").cell_size, ds);
        map.transmittance(middle + Vec3::new(x, y, z) * ds)
    };
    for [x, y, z] in [[0.0; 3], [-0.49, 0.0, 0.0], [0.49, 0.49, -0.49], [2.0, -0.49, 0.49], [30.0, 0.0, 0.0]]
    {
        let found = at(VoxelFilter::Closest, x, y, z);
        // Faces are rounded to 1/4096.
        assert!((found - (-depth).exp()).abs() < 3e-4, "{x}, {y}, {z}: {found}, {}", (-depth).exp());
    }
    for [x, y, z] in [[-0.51, 0.0, 0.0], [2.0, 0.51, 0.0], [2.0, 0.0, -0.51]] {
        assert_eq!(at(VoxelFilter::Closest, x, y, z), 1.0, "{x}, {y}, {z}");
    }
    // The control: filtered, the middle of the cell has half of its depth, and its neighbours have some of it.
    let half = at(VoxelFilter::Centred, 0.0, 0.0, 0.0);
    assert!((half - (-0.5 * depth).exp()).abs() < 3e-4, "{half}");
    assert!(at(VoxelFilter::Centred, 2.0, 0.51, 0.0) < 1.0);
}

#[test]
fn points_before_or_beside_the_hair_are_lit() {
    let hair = small(SMOOTH);
    for direction in [LIGHT, Vec3::X, Vec3::NEG_X, Vec3::NEG_Y, Vec3::Z] {
        let input = ShadowInput { extinction_scale: 4.0, ..input(&hair, direction) };
        for extent in [MapExtent::Fit, MapExtent::Paper] {
            let mut settings = settings(64);
            settings.voxel_map.extent = extent;
            let map = built(&input, &settings);
            let light = input.light;
            for away in [0.5, 2.0, 1e3, 1e9] {
                assert_eq!(map.transmittance(HEAD - away * light.x), 1.0, "before, {away} m");
                for beside in [light.y, -light.y, light.z, -light.z] {
                    assert_eq!(
                        map.transmittance(HEAD + 0.1 * light.x + away * beside),
                        1.0,
                        "beside, {away} m"
                    );
                }
            }
            assert!(map.transmittance(HEAD + 0.5 * light.x) < 0.3, "behind");
        }
    }
}

/// `i_min − 1` reads 1: the paper's addressing would wrap to the darkest slice.
#[test]
fn the_slice_before_the_first_is_lit() {
    let hair = small(SMOOTH);
    let input = input(&hair, LIGHT);
    let map = DenseMap::build(&input, &settings(32), Addressing::Psi);
    let n = map.lattice.resolution as f32;
    for step in 0..1000 {
        let (j, k) = ((step % 32) as f32 + 0.3, (step / 32) as f32 + 0.6);
        let cell = map.lattice.first.as_vec3() + Vec3::new(0.5, j.min(n - 1.0), k.min(n - 1.0));
        let p = HEAD + input.light.world_from_light(cell * map.lattice.cell_size);
        assert_eq!(map.transmittance(p), 1.0);
    }
}

#[test]
fn extinction_darkens_and_none_lights_everything() {
    let hair = small(CURLY);
    let input = input(&hair, LIGHT);
    let mut last = vec![1.0_f32; hair.points()];
    for scale in [0.0, 0.01, 0.15, 1.0, 4.0, 1e3, f32::INFINITY] {
        let input = ShadowInput { extinction_scale: scale, ..input };
        let now = at_points(&built(&input, &settings(64)), &hair);
        if scale == 0.0 {
            assert!(now.iter().all(|t| *t == 1.0));
        }
        // Each sample is rounded to 2^-20 and each face to 2^-12; one that falls the other way shows.
        assert!(now.iter().zip(&last).all(|(now, last)| *now <= last + 2.5e-4), "at {scale}");
        assert!(now.iter().all(|t| (0.0..=1.0).contains(t)));
        last = now;
    }
    assert!(mean(&last) < 0.05, "opaque strands let nothing through");
    let nan = ShadowInput { extinction_scale: f32::NAN, ..input };
    assert!(at_points(&built(&nan, &settings(64)), &hair).iter().all(|t| *t == 1.0));
}
