//! The march through voxels against answers known on paper, and against the sorted truth.

use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_shadow::{
    CpuShadow, LightFrame, LightSource, ShadowInput, ShadowMethod, ShadowSettings, cpu_shadow,
};

use crate::common::{EXTINCTION, HEAD, SplitMix64, strands};
use crate::grooms::Groom;

const WIDTH: f32 = 2e-4;

fn input(strands: &Strands, light: LightFrame) -> ShadowInput<'_> {
    ShadowInput {
        strands,
        strand_width: WIDTH,
        extinction_scale: 1.0,
        light,
        anchor: HEAD,
        maps: 1,
        projected: None,
    }
}

fn with(resolution: u32) -> ShadowSettings {
    let mut settings = ShadowSettings { method: ShadowMethod::VoxelMarch, ..ShadowSettings::default() };
    settings.voxel_march.resolution = resolution;
    settings
}

fn built(input: &ShadowInput, settings: &ShadowSettings) -> Box<dyn CpuShadow + Send + Sync> {
    let mut map = cpu_shadow(ShadowMethod::VoxelMarch);
    map.build(input, settings).expect("it fits");
    map
}

/// Mean optical depth before points spread over the middle of the box, at a height above its own.
fn depth_at(map: &dyn CpuShadow, height: f32) -> f64 {
    let mut random = SplitMix64::new(7);
    let depth = |_| {
        let p = HEAD + Vec3::new(0.03 * random.signed(), height, 0.03 * random.signed());
        f64::from(-map.transmittance(p).ln())
    };
    (0..500).map(depth).sum::<f64>() / 500.0
}

/// Short strands of every direction, spread evenly in a box of half size `half` around a point.
fn cloud(middle: Vec3, half: Vec3, count: usize, seed: u64) -> Vec<Vec<Vec3>> {
    let mut random = SplitMix64::new(seed);
    let strand = |_| {
        let at = middle + half * random.signed_vec3();
        let mut along = random.signed_vec3();
        // Directions of a ball, not of a cube.
        while along.length() > 1.0 || along.length() < 0.1 {
            along = random.signed_vec3();
        }
        vec![at - 0.002 * along.normalize_or_zero(), at + 0.002 * along.normalize_or_zero()]
    };
    (0..count).map(strand).collect()
}

/// Optical depth of all of such a box seen from above: `w ℓ π/4` for each strand, over the area.
fn on_paper(count: usize, half: Vec3) -> f64 {
    f64::from(WIDTH * 0.004) * std::f64::consts::FRAC_PI_4 * count as f64 / f64::from(4.0 * half.x * half.z)
}

#[test]
fn one_slab_has_the_depth_of_its_strands_from_any_light() {
    let half = Vec3::new(0.1, 0.03, 0.1);
    let hair = strands(&cloud(HEAD, half, 40_000, 3));
    let all = on_paper(40_000, half);
    assert!((0.4..0.8).contains(&all), "{all}");
    let above = |distance: f32| {
        let source = LightSource { position: HEAD + distance * Vec3::Y, radius: 0.01 };
        LightFrame::default().standing(source, HEAD)
    };
    for light in [LightFrame::default(), above(1.0), above(0.2), above(500.0)] {
        for resolution in [64, 128] {
            let map = built(&input(&hair, light), &with(resolution));
            // Before it, in its middle and behind it; below it the window ends.
            for (height, part) in [(0.04, 0.0), (0.0, 0.5), (-0.045, 1.0), (-0.4, 1.0)] {
                let found = depth_at(&*map, height);
                // Rays from a near light are slanted by up to 12 degrees and so longer; the number of strands before a point varies.
                assert!(
                    (found - part * all).abs() < 0.06 * all,
                    "{light:?}, {resolution}, {height}: {found} of {all}"
                );
            }
        }
    }
    // A light below it sees the other side.
    let source = LightSource { position: HEAD - 0.5 * Vec3::Y, radius: 0.01 };
    let map = built(&input(&hair, LightFrame::default().standing(source, HEAD)), &with(128));
    assert!(depth_at(&*map, -0.045) < 0.02 * all && depth_at(&*map, 0.045) > 0.9 * all);
}

#[test]
fn two_slabs_leave_the_gap_between_them_as_it_is() {
    let half = Vec3::new(0.1, 0.01, 0.1);
    let mut both = cloud(HEAD + 0.04 * Vec3::Y, half, 20_000, 3);
    both.extend(cloud(HEAD - 0.04 * Vec3::Y, half, 40_000, 4));
    let hair = strands(&both);
    let (first, second) = (on_paper(20_000, half), on_paper(40_000, half));
    let map = built(&input(&hair, LightFrame::default()), &with(128));
    for (height, expected) in
        [(0.06, 0.0), (0.025, first), (0.0, first), (-0.025, first), (-0.06, first + second)]
    {
        let found = depth_at(&*map, height);
        assert!((found - expected).abs() < 0.06 * (first + second), "{height}: {found}, not {expected}");
    }
}

#[test]
fn strands_across_and_along_the_light_count_alike_which_is_how_it_fails() {
    let of = |along: Vec3| {
        let mut random = SplitMix64::new(3);
        let strand = |_| {
            let at = HEAD + Vec3::new(0.1, 0.03, 0.1) * random.signed_vec3();
            vec![at - 0.002 * along, at + 0.002 * along]
        };
        strands(&(0..40_000).map(strand).collect::<Vec<_>>())
    };
    let all = on_paper(40_000, Vec3::new(0.1, 0.03, 0.1));
    for along in [Vec3::X, Vec3::Y, Vec3::Z] {
        let map = built(&input(&of(along), LightFrame::default()), &with(64));
        let found = depth_at(&*map, -0.06);
        assert!((found - all).abs() < 0.05 * all, "{along}: {found} of {all}");
    }
    // Control: the voxel map along the light sees that strands along it cast nothing.
    let hair = of(Vec3::Y);
    let mut map = cpu_shadow(ShadowMethod::VoxelMap);
    map.build(&input(&hair, LightFrame::default()), &ShadowSettings::default()).expect("it fits");
    assert!(depth_at(&*map, -0.06) < 0.01 * all);
}

#[test]
fn an_opaque_card_hides_all_behind_it_and_nothing_a_cell_before_it() {
    // A sheet of strands, as dense as a head: what lies behind it is dark.
    let mut sheet = Vec::new();
    for row in 0..200 {
        let z = -0.1 + 0.001 * row as f32;
        sheet.push(vec![HEAD + Vec3::new(-0.1, 0.0, z), HEAD + Vec3::new(0.1, 0.0, z)]);
    }
    // Hair behind it, and hair in front.
    sheet.extend(cloud(HEAD - 0.05 * Vec3::Y, Vec3::new(0.05, 0.01, 0.05), 500, 3));
    sheet.extend(cloud(HEAD + 0.05 * Vec3::Y, Vec3::new(0.05, 0.01, 0.05), 500, 4));
    let hair = strands(&sheet);
    let card = ShadowInput { extinction_scale: 200.0, ..input(&hair, LightFrame::default()) };
    let map = built(&card, &with(128));
    let cell = map.report().cell_size;
    let mut random = SplitMix64::new(5);
    for _ in 0..200 {
        let across = Vec3::new(0.08 * random.signed(), 0.0, 0.08 * random.signed());
        let behind = map.transmittance(HEAD + across - 2.0 * cell * Vec3::Y);
        assert!(behind < 1e-3, "{behind}");
        let before = map.transmittance(HEAD + across + 0.07 * Vec3::Y);
        assert_eq!(before, 1.0);
    }
}

#[test]
fn finer_cells_and_shorter_steps_come_nearer_to_the_truth_of_hair_of_every_direction() {
    // Few enough strands that single ones matter.
    let half = Vec3::splat(0.06);
    let hair = strands(&cloud(HEAD, half, 60_000, 9));
    let thin = ShadowInput { strand_width: 6e-4, ..input(&hair, LightFrame::new(Vec3::new(0.3, -1.0, 0.2))) };
    let mut exact = cpu_shadow(ShadowMethod::Exact);
    exact.build(&thin, &ShadowSettings::default()).expect("it fits");
    let mut random = SplitMix64::new(2);
    let points: Vec<_> = (0..4000).map(|_| HEAD + 0.06 * random.signed_vec3()).collect();
    let error = |settings: &ShadowSettings| {
        let map = built(&thin, settings);
        let squares =
            points.iter().map(|p| f64::from(map.transmittance(*p) - exact.transmittance(*p)).powi(2));
        (squares.sum::<f64>() / points.len() as f64).sqrt()
    };
    let by_cells = [16, 32, 64, 128].map(|resolution| error(&with(resolution)));
    println!("16 to 128 cells: {by_cells:.4?}");
    assert!(by_cells.is_sorted_by(|more, less| more > less), "{by_cells:?}");
    let by_step = [4.0, 2.0, 1.0].map(|step| {
        let mut settings = with(64);
        settings.voxel_march.step = step;
        error(&settings)
    });
    println!("steps of 4, 2 and 1 cells: {by_step:.4?}");
    assert!(by_step.is_sorted_by(|more, less| more > less), "{by_step:?}");
}

#[test]
fn jitter_moves_light_of_single_points_and_keeps_the_mean() {
    let groom = Groom::tuft();
    let mut settings = with(64);
    settings.voxel_march.step = 3.0;
    let mean = |settings: &ShadowSettings| {
        let map = built(&groom.input(), settings);
        let hair = &groom.strands;
        let mut out = vec![f32::NAN; hair.points()];
        map.transmittance_at(&hair.x, &hair.y, &hair.z, &mut out);
        (out.iter().map(|t| f64::from(*t)).sum::<f64>() / out.len() as f64, out)
    };
    let (still, at_still) = mean(&settings);
    settings.voxel_march.jitter = true;
    let (jittered, at_jittered) = mean(&settings);
    // Optical depth is kept in the mean, light nearly.
    assert!((still - jittered).abs() < 0.02, "{still}, {jittered}");
    let moved = at_still.iter().zip(&at_jittered).filter(|(a, b)| (**a - **b).abs() > 1e-3).count();
    assert!(moved > at_still.len() / 4, "{moved}");
    assert!(groom.extinction_scale == EXTINCTION);
}
