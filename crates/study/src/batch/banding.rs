//! Banding: errors of a method's slices in a slab of uniform density.

use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_metrics::{banding, errors};
use lovelock_render::ShadowSettings;
use lovelock_shadow::{LightFrame, MapKind, RayStructure, ShadowInput, cpu_shadow};

use crate::report::BandingReport;

/// Depth of the slab, and its extent across the light on the longer axis, metres.
const SIZE: f32 = 0.1;
/// Extent on the shorter axis: a strip is enough.
const STRIP: f32 = SIZE / 8.0;
/// Number of layers of strands, and of strands in each.
const LAYERS: usize = 1024;
const STRANDS: usize = 4;
/// Depth between the ends of a strand, in layers. It equals the distance of two strands in a row of texels, so that means over rays
/// contain strands at all depths.
const SLOPE: f32 = 16.0;
/// Optical depth of the slab.
const OPTICAL_DEPTH: f32 = 3.0;
/// Number of samples along the light, and of rays that are averaged.
const SAMPLES: usize = 256;
const RAYS: usize = 1024;

/// The banding of a method, by its CPU definition; the GPU backend agrees with it. `None` if the slab cannot be built, there is no
/// shadow, or strands are counted by points.
pub(super) fn slab(settings: &ShadowSettings) -> Option<BandingReport> {
    if settings.method.map_kind() == MapKind::None || settings.counts_points() {
        return None;
    }
    let light = LightFrame::default();
    let strands = strands(&light);
    let per_layer = STRANDS as f32 / STRIP;
    let input = ShadowInput {
        strands: &strands,
        strand_width: OPTICAL_DEPTH / (LAYERS as f32 * per_layer),
        extinction_scale: 1.0,
        light,
        anchor: Vec3::ZERO,
        maps: 1,
        projected: None,
    };
    let mut map = cpu_shadow(settings.method);
    map.build(&input, settings).ok()?;
    let depths: Vec<f32> = (0..SAMPLES).map(|i| depth(i) * SIZE).collect();
    let transmittance: Vec<f32> = depths
        .iter()
        .map(|&depth| {
            let at = |ray: usize| light.world_from_light(Vec3::new(depth, across(ray)[0], across(ray)[1]));
            let points: Vec<Vec3> = (0..RAYS).map(at).collect();
            let axis = |of: fn(&Vec3) -> f32| points.iter().map(of).collect::<Vec<f32>>();
            let mut out = vec![1.0; RAYS];
            map.transmittance_at(&axis(|p| p.x), &axis(|p| p.y), &axis(|p| p.z), &mut out);
            (out.iter().map(|&t| f64::from(t)).sum::<f64>() / RAYS as f64) as f32
        })
        .collect();
    let found = banding(&depths, &transmittance, OPTICAL_DEPTH / SIZE)?;
    let middle = light.world_from_light(Vec3::new(0.5 * SIZE, 0.5 * SIZE, 0.5 * STRIP));
    let slice = slice(&map.along_ray(middle));
    let truth: Vec<f32> = depths.iter().map(|depth| (-OPTICAL_DEPTH * depth / SIZE).exp()).collect();
    Some(BandingReport {
        residual: found.curvature,
        rmse: errors(&transmittance, &truth).rmse,
        amplitude: found.amplitude,
        period: found.period / f64::from(SIZE),
        slice: slice.map(|slice| f64::from(slice / SIZE)),
        slice_amplitude: slice.map(|slice| found.amplitude_at(f64::from(slice))),
        curve: depths.iter().map(|depth| depth / SIZE).zip(transmittance).collect(),
        optical_depth: f64::from(OPTICAL_DEPTH),
    })
}

/// The depth of a slice, metres, if the method has slices of equal depth.
fn slice(ray: &RayStructure) -> Option<f32> {
    let slices = ray.marks.iter().filter(|mark| mark.kind.resolves_depth);
    let depths = slices.map(|mark| mark.end - mark.start);
    let (low, high) = depths.fold((f32::INFINITY, 0.0_f32), |(low, high), d| (low.min(d), high.max(d)));
    // Depths are rounded differently from slice to slice.
    (low > 0.0 && low.is_finite() && high < 1.02 * low).then_some(0.5 * (low + high))
}

/// The middle of a sample, as a fraction of the slab without its ends, where strands begin and end.
fn depth(sample: usize) -> f32 {
    0.03 + 0.94 * (sample as f32 + 0.5) / SAMPLES as f32
}

/// Position of a ray, metres on the axes across the light: evenly distributed over the inner half of the strip, which contains
/// whole cycles of the strands' slope (the sequence of Roberts 2018, "R2").
fn across(ray: usize) -> [f32; 2] {
    let (i, g) = (ray as f64, 1.324_717_957_244_746);
    let [u, v] = [(0.5 + i / g).fract(), (0.5 + i / (g * g)).fract()];
    [SIZE * u as f32, STRIP * (0.25 + 0.5 * v as f32)]
}

/// Strands along the first axis across the light, layer behind layer, each layer offset by the golden ratio.
fn strands(light: &LightFrame) -> Strands {
    let mut made = Strands::default();
    let mut first_point = vec![0];
    let spacing = SIZE / LAYERS as f32;
    for layer in 0..LAYERS {
        let depth = (layer as f32 + 0.5) * spacing;
        let moved = (layer as f64 * 0.618_033_988_749_895).fract() as f32;
        for strand in 0..STRANDS {
            let row = STRIP * (strand as f32 + moved) / STRANDS as f32;
            for [end, slope] in [[0.0, -0.5], [SIZE, 0.5]] {
                let p = light.world_from_light(Vec3::new(depth + SLOPE * slope * spacing, end, row));
                made.x.push(p.x);
                made.y.push(p.y);
                made.z.push(p.z);
            }
            first_point.push(made.x.len() as u32);
        }
    }
    made.first_point = Arc::from(first_point);
    made
}

#[cfg(test)]
mod tests {
    use lovelock_render::{ShadowMethod, VoxelDeposit};

    use super::*;

    fn of(method: ShadowMethod, change: impl FnOnce(&mut ShadowSettings)) -> BandingReport {
        let mut settings = ShadowSettings { method, ..ShadowSettings::default() };
        change(&mut settings);
        slab(&settings).expect("a slab")
    }

    #[test]
    fn the_slab_is_uniform_and_layers_show_in_it() {
        let exact = of(ShadowMethod::Exact, |_| ());
        // Measured 3.5e-4 and 6.5e-5, from the discrete strands of the slab. Smaller errors of a method cannot be detected.
        assert!(exact.rmse < 6e-4 && exact.amplitude < 1.2e-4, "{} {}", exact.rmse, exact.amplitude);
        // 0.079 and 9.2e-3 measured.
        let layers = of(ShadowMethod::DeepOpacityMaps, |_| ());
        assert!(layers.rmse > 100.0 * exact.rmse, "{}", layers.rmse);
        assert!(layers.amplitude > 50.0 * exact.amplitude, "{}", layers.amplitude);
        // Optical depth is interpolated between slices, which is exact in a uniform slab: measured 6.2e-5.
        let slices = of(ShadowMethod::OpacityMaps, |_| ());
        assert!(slices.amplitude < 2.0 * exact.amplitude, "{}", slices.amplitude);
    }

    #[test]
    fn the_distance_of_slices_is_that_of_the_settings() {
        for (count, least) in [(16, 1.0 / 16.0), (64, 1.0 / 64.0)] {
            let found = of(ShadowMethod::OpacityMaps, |settings| settings.opacity_maps.slices = count);
            let slice = found.slice.expect("slices of one depth");
            // The map is a little deeper than the slab: 1.05 measured.
            assert!((least..1.1 * least).contains(&slice), "{count}: {slice}");
        }
        assert_eq!(of(ShadowMethod::Exact, |_| ()).slice, None);
    }

    #[test]
    fn what_has_no_slab_has_no_report() {
        let none = ShadowSettings { method: ShadowMethod::None, ..ShadowSettings::default() };
        assert_eq!(slab(&none), None);
        let mut by_points = ShadowSettings { method: ShadowMethod::VoxelMap, ..ShadowSettings::default() };
        by_points.voxel_map.deposit = VoxelDeposit::PointCount;
        assert_eq!(slab(&by_points), None);
    }
}
