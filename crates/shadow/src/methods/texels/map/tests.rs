use std::sync::Arc;

use lovelock_groom::Strands;

use super::*;
use crate::LightFrame;
use crate::methods::{deep_opacity_maps, density_clustering, exact, occupancy_maps, opacity_maps};

/// Strands that wind through a box, with a NaN point.
fn strands() -> Strands {
    let mut made = Strands::default();
    let mut first_point = vec![0];
    for strand in 0..200_u32 {
        for point in 0..=20_u32 {
            let (s, p) = (strand as f32, point as f32);
            made.x.push(0.1 * (0.7 * s + 0.2 * p).sin());
            made.y.push(1.5 - 0.01 * p + 0.02 * (1.3 * s).cos());
            made.z.push(0.1 * (1.1 * s + 0.3 * p).cos());
        }
        first_point.push(made.x.len() as u32);
    }
    made.z[150] = f32::NAN;
    made.first_point = Arc::from(first_point);
    made
}

fn same_bits<M: TexelMethod>(settings: &ShadowSettings) {
    let strands = strands();
    let light = LightFrame::new(Vec3::new(0.2, -1.0, 0.3));
    let input = ShadowInput {
        strands: &strands,
        strand_width: 2e-3,
        extinction_scale: 0.15,
        light,
        anchor: Vec3::Y,
        maps: 1,
        projected: None,
    };
    let mut map = TexelMap::<M>::default();
    map.build(&input, settings).expect("fits");
    let mut bits = |width| {
        map.width = width;
        // One point more than full blocks, and points beside the hair.
        let ends = [0.0, 3.0, f32::INFINITY];
        let [x, y, z] = [&strands.x, &strands.y, &strands.z]
            .map(|axis| axis.iter().copied().chain(ends).collect::<Vec<_>>());
        let mut out = vec![f32::NAN; x.len()];
        map.transmittance_at(&x, &y, &z, &mut out);
        let alone = map.transmittance(Vec3::new(x[9], y[9], z[9]));
        assert_eq!(alone, out[9]);
        out.iter().map(|t| t.to_bits()).collect::<Vec<_>>()
    };
    let baseline = bits(Width::Baseline);
    for &width in Width::ALL.iter().filter(|width| width.is_available()) {
        assert!(bits(width) == baseline, "{} with {width:?}", M::METHOD);
    }
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    for filter in TexelFilter::ALL {
        let mut settings = ShadowSettings::default();
        settings.opacity_maps.filter = filter;
        settings.deep_opacity_maps.filter = filter;
        settings.density_clustering.filter = filter;
        settings.occupancy_maps.filter = filter;
        settings.exact.filter = filter;
        same_bits::<opacity_maps::Slices>(&settings);
        same_bits::<deep_opacity_maps::Layers>(&settings);
        same_bits::<density_clustering::Clustering>(&settings);
        same_bits::<occupancy_maps::Occupancy>(&settings);
        same_bits::<exact::SortedFragments>(&settings);
    }
}
