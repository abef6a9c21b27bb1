//! The effect of pre-filtered lines on density clustering: the error against the converged shadow, and the swimming, the change of the
//! light at a point while hair and lattice move relative to each other.
//!
//! `cargo run --release -p lovelock-shadow --example measure_lines` prints a table.

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/grooms.rs"]
mod grooms;

use common::SplitMix64;
use glam::Vec3;
use grooms::Groom;
use lovelock_groom::Preset;
use lovelock_shadow::{
    CpuShadow, LineFilter, ShadowMethod, ShadowSettings, TexelFilter, converged, cpu_shadow,
};

/// Thin lines, lines shared by two texels, and the standard deviations of Gaussians in widths of a strand.
const LINES: [&str; 6] = ["thin", "two texels", "0.3", "0.5", "1", "2"];
/// The number of points.
const POINTS: usize = 4000;
/// The number of positions of the lattice, within a texel.
const SHIFTS: usize = 16;

fn main() {
    println!(
        "| hairstyle | filter | lines | converged | swimming | build, fragments |\n|---|---|---|---|---|---|"
    );
    for groom in [Groom::tuft(), Groom::preset(Preset::Smooth), Groom::preset(Preset::Curly)] {
        let mut random = SplitMix64::new(12);
        let any = |random: &mut SplitMix64| {
            (random.unit() * groom.strands.points() as f32) as usize % groom.strands.points()
        };
        let at: Vec<Vec3> = (0..POINTS).map(|_| groom.strands.point(any(&mut random))).collect();
        let (x, y, z) = axes(&at);
        let settings =
            ShadowSettings { method: ShadowMethod::DensityClustering, ..ShadowSettings::default() };
        let truth = converged(&groom.input(), &settings, [&x, &y, &z]).expect("hair fits").transmittance;
        for filter in [TexelFilter::Nearest, TexelFilter::Bilinear] {
            for lines in LINES {
                let mut settings = settings;
                let own = &mut settings.density_clustering;
                (own.filter, own.prefiltered) = (filter, lines != "thin");
                if let Ok(width) = lines.parse() {
                    (own.line_filter, own.line_width) = (LineFilter::Gaussian, width);
                }
                let (error, swimming, fragments) = measure(&groom, &settings, &at, &truth);
                println!(
                    "| {} | {filter:?} | {lines} | {error:.4} | {swimming:.4} | {fragments} |",
                    groom.name
                );
            }
        }
    }
}

fn axes(of: &[Vec3]) -> (Vec<f32>, Vec<f32>, Vec<f32>) {
    let axis = |axis: fn(&Vec3) -> f32| of.iter().map(axis).collect();
    (axis(|p| p.x), axis(|p| p.y), axis(|p| p.z))
}

/// The RMSE against the reference at one position, the standard deviation over many positions, and the number of fragments.
fn measure(groom: &Groom, settings: &ShadowSettings, at: &[Vec3], truth: &[f32]) -> (f64, f64, u64) {
    let (x, y, z) = axes(at);
    let mut map = cpu_shadow(ShadowMethod::DensityClustering);
    let look = |anchor: Vec3, map: &mut dyn CpuShadow| {
        let input = lovelock_shadow::ShadowInput { anchor, ..groom.input() };
        map.build(&input, settings).expect("hair fits");
        let mut light = vec![0.0; at.len()];
        map.transmittance_at(&x, &y, &z, &mut light);
        light
    };
    let light = look(groom.input().anchor, &mut *map);
    let report = map.report();
    let squares = light.iter().zip(truth).map(|(a, b)| f64::from(a - b).powi(2));
    let error = (squares.sum::<f64>() / at.len() as f64).sqrt();
    let mut random = SplitMix64::new(5);
    let (mut sum, mut square) = (vec![0.0_f64; at.len()], vec![0.0_f64; at.len()]);
    for _ in 0..SHIFTS {
        let across = Vec3::new(0.0, random.unit(), random.unit()) * report.cell_size;
        let light = look(groom.input().anchor + groom.input().light.world_from_light(across), &mut *map);
        for ((sum, square), light) in sum.iter_mut().zip(&mut square).zip(light) {
            *sum += f64::from(light);
            *square += f64::from(light).powi(2);
        }
    }
    let n = SHIFTS as f64;
    let variances = sum.iter().zip(&square).map(|(sum, square)| (square / n - (sum / n).powi(2)).max(0.0));
    let swimming = (variances.sum::<f64>() / at.len() as f64).sqrt();
    (error, swimming, report.samples)
}
