//! The choices of the voxel map on five hairstyles: errors of uniform and of adaptive slices against the converged shadow, and of density
//! by orientation and without it.
//!
//! `cargo run --release -p lovelock-shadow --example measure_voxel_map` prints both tables.

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/grooms.rs"]
mod grooms;

use common::SplitMix64;
use grooms::Groom;
use lovelock_base::clock::Stopwatch;
use lovelock_groom::Preset;
use lovelock_shadow::voxel_map::{VoxelDeposit, VoxelSlices};
use lovelock_shadow::{ShadowMethod, ShadowSettings, converged, cpu_shadow};

/// The number of points.
const POINTS: usize = 2000;

fn main() {
    let grooms: Vec<_> =
        [Groom::slab(), Groom::tuft(), Groom::preset(Preset::Smooth), Groom::preset(Preset::Curly)]
            .into_iter()
            .chain(Groom::straight())
            .map(Measured::new)
            .collect();
    println!("| hairstyle | cells | uniform | adaptive | change | MiB | MiB | build, ms | build, ms |");
    println!("|---|---|---|---|---|---|---|---|---|");
    for of in &grooms {
        for resolution in [32, 64, 128, 256] {
            let measure = |slices: VoxelSlices| {
                let mut settings = ShadowSettings::default();
                (settings.voxel_map.resolution, settings.voxel_map.slices) = (resolution, slices);
                of.measure(&settings)
            };
            let [uniform, adaptive] = [VoxelSlices::Uniform, VoxelSlices::Adaptive].map(measure);
            println!(
                "| {} | {resolution}³ | {:.4} | {:.4} | {:+.0} % | {:.1} | {:.1} | {:.1} | {:.1} |",
                of.groom.name,
                uniform.error,
                adaptive.error,
                100.0 * (adaptive.error / uniform.error - 1.0),
                uniform.mib,
                adaptive.mib,
                uniform.ms,
                adaptive.ms
            );
        }
    }
    println!("\n| hairstyle | by length | isotropic | bias | bias |\n|---|---|---|---|---|");
    for of in &grooms {
        let measure = |deposit: VoxelDeposit| {
            let mut settings = ShadowSettings::default();
            settings.voxel_map.deposit = deposit;
            of.measure(&settings)
        };
        let [length, isotropic] = [VoxelDeposit::Length, VoxelDeposit::Isotropic].map(measure);
        println!(
            "| {} | {:.4} | {:.4} | {:+.4} | {:+.4} |",
            of.groom.name, length.error, isotropic.error, length.bias, isotropic.bias
        );
    }
}

/// A hairstyle with random points and the converged shadow at them, over texels of the default map of `exact`.
struct Measured {
    groom: Groom,
    points: [Vec<f32>; 3],
    truth: Vec<f32>,
}

/// What is measured of one setting.
struct Row {
    /// RMSE.
    error: f64,
    /// Mean difference.
    bias: f64,
    /// Memory of the map for one worker, MiB.
    mib: f64,
    /// The shortest of five builds.
    ms: f64,
}

impl Measured {
    fn new(groom: Groom) -> Self {
        let mut random = SplitMix64::new(12);
        let hair = &groom.strands;
        let at: Vec<_> = (0..POINTS)
            .map(|_| hair.point((random.unit() * hair.points() as f32) as usize % hair.points()))
            .collect();
        let points = [0, 1, 2].map(|axis| at.iter().map(|p| p[axis]).collect::<Vec<_>>());
        let exact = ShadowSettings { method: ShadowMethod::Exact, ..ShadowSettings::default() };
        let [x, y, z] = &points;
        let truth = converged(&groom.input(), &exact, [x, y, z]).expect("hair fits").transmittance;
        Self { groom, points, truth }
    }

    fn measure(&self, settings: &ShadowSettings) -> Row {
        let mut map = cpu_shadow(ShadowMethod::VoxelMap);
        let build = |_| {
            let watch = Stopwatch::start();
            map.build(&self.groom.input(), settings).expect("hair fits");
            watch.ms()
        };
        let ms = (0..5).map(build).fold(f64::INFINITY, f64::min);
        let mut light = vec![0.0; POINTS];
        let [x, y, z] = &self.points;
        map.transmittance_at(x, y, z, &mut light);
        let differences = || light.iter().zip(&self.truth).map(|(a, b)| f64::from(a - b));
        let count = POINTS as f64;
        let grids = if settings.voxel_map.slices == VoxelSlices::Uniform {
            u64::from(settings.voxel_map.resolution).pow(3) * 4
        } else {
            map.report().memory_bytes
        };
        Row {
            error: (differences().map(|d| d * d).sum::<f64>() / count).sqrt(),
            bias: differences().sum::<f64>() / count,
            mib: grids as f64 / (1024.0 * 1024.0),
            ms,
        }
    }
}
