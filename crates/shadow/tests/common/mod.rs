//! Strands to shadow: small hairstyles grown from a seed, and slabs of known density.
#![allow(dead_code, unreachable_pub, missing_docs)] // A module of each test and benchmark, which uses its part.

use std::sync::Arc;

use glam::Vec3;
use lovelock_base::settings::{Choices, Value, set_value};
use lovelock_groom::Strands;
use lovelock_shadow::{LightFrame, MapKind, ShadowInput, ShadowMethod, ShadowSettings, TexelFilter};

pub use lovelock_base::random::SplitMix64;

/// The methods with a record per texel, which have a limit of memory.
pub fn texel_methods() -> impl Iterator<Item = ShadowMethod> {
    ShadowMethod::ALL.iter().copied().filter(|method| method.map_kind() == MapKind::Texels)
}

/// Sets a setting of every method with a record per texel that has one of this name.
pub fn set_texels(settings: &mut ShadowSettings, name: &str, value: Value) {
    for method in texel_methods() {
        if let Some(section) = settings.of_method_mut(method) {
            set_value(section, name, value);
        }
    }
}

/// Gives the maps of every method with a record per texel so many texels along each edge.
pub fn set_resolution(settings: &mut ShadowSettings, edge: u32) {
    set_texels(settings, "resolution", Value::Count(u64::from(edge)));
}

/// Gives every method with a record per texel a filter.
pub fn set_filter(settings: &mut ShadowSettings, filter: TexelFilter) {
    set_texels(settings, "filter", Value::Choice(filter.names().0));
}

/// Whether a method measures how much hair there is, and does not take its density for known.
pub fn measures_hair(method: ShadowMethod) -> bool {
    !matches!(method, ShadowMethod::None | ShadowMethod::ApproximateDeep)
}

/// The part of the optical depth of strands across the light that a method sees. A grid for lights from everywhere takes the mean over all
/// directions of strands.
pub fn part_of_strands_across(method: ShadowMethod) -> f64 {
    if method == ShadowMethod::VoxelMarch { std::f64::consts::FRAC_PI_4 } else { 1.0 }
}

/// A method with maps of so many texels or cells along each edge.
pub fn of_edge(method: ShadowMethod, edge: u32) -> ShadowSettings {
    let mut settings = ShadowSettings { method, ..ShadowSettings::default() };
    settings.voxel_map.resolution = edge;
    settings.voxel_march.resolution = edge;
    // The tolerance is one of light, of which optical depths are made.
    (settings.deep_shadow_maps.tolerance, settings.deep_shadow_maps.nodes) = (0.002, 32);
    set_resolution(&mut settings, edge);
    settings
}

/// The default factor on optical depth.
pub const EXTINCTION: f32 = 0.15;

/// Strands through the given points.
pub fn strands(of: &[Vec<Vec3>]) -> Strands {
    let mut made = Strands::default();
    let mut first_point = vec![0];
    for p in of.iter().flatten() {
        made.x.push(p.x);
        made.y.push(p.y);
        made.z.push(p.z);
    }
    for strand in of {
        first_point.push(first_point[first_point.len() - 1] + strand.len() as u32);
    }
    made.first_point = Arc::from(first_point);
    made
}

/// A hairstyle to grow.
#[derive(Clone, Copy)]
pub struct Style {
    pub wisps: usize,
    pub strands_per_wisp: usize,
    pub segments: usize,
    /// Length of a strand, metres.
    pub length: f32,
    /// Radius of the curl, metres.
    pub curl: f32,
}

/// The published hairstyle: 134 wisps of 25 strands of 30 segments.
pub const SMOOTH: Style = Style { wisps: 134, strands_per_wisp: 25, segments: 30, length: 0.3, curl: 0.002 };
/// The published curly hairstyle: twice the segments.
pub const CURLY: Style = Style { wisps: 134, strands_per_wisp: 25, segments: 60, length: 0.3, curl: 0.012 };

/// The centre of the head that [`grow`] grows on.
pub const HEAD: Vec3 = Vec3::new(0.0, 1.6, 0.0);

/// Strands that together have as much hair as 100,000 of 80 µm, in a light from above and in front.
pub fn lit(strands: &Strands) -> ShadowInput<'_> {
    ShadowInput {
        strands,
        strand_width: 80e-6 * 100_000.0 / strands.count() as f32,
        extinction_scale: EXTINCTION,
        light: LightFrame::new(Vec3::new(0.4, -1.0, -0.5)),
        anchor: HEAD,
        maps: 1,
        projected: None,
    }
}

/// Tufts on the upper part of a head of 9 cm around [`HEAD`], which bend down and curl.
pub fn grow(style: Style, seed: u64) -> Vec<Vec<Vec3>> {
    let mut random = SplitMix64::new(seed);
    let mut grown = Vec::new();
    for wisp in 0..style.wisps {
        // A spiral over the cap of the sphere.
        let height = 1.0 - 1.1 * (wisp as f32 + 0.5) / style.wisps as f32;
        let turn = wisp as f32 * 2.399_963;
        let out = Vec3::new(turn.cos(), 0.0, turn.sin()) * (1.0 - height * height).sqrt() + Vec3::Y * height;
        let phase = std::f32::consts::TAU * random.unit();
        for _ in 0..style.strands_per_wisp {
            let offset = 0.012 * random.signed_vec3();
            let own = phase + 0.6 * random.signed();
            let (mut p, mut direction) = (HEAD + 0.09 * out + offset, out);
            let step = style.length / style.segments as f32;
            let mut strand = Vec::new();
            for segment in 0..=style.segments {
                let t = segment as f32 / style.segments as f32;
                let angle = own + 40.0 * t;
                let curl = Vec3::new(angle.cos(), 0.0, angle.sin()) * style.curl * t.min(0.2) * 5.0;
                strand.push(p + curl - 0.4 * t * offset);
                direction =
                    (direction + 0.25 * Vec3::NEG_Y * 30.0 / style.segments as f32).normalize_or_zero();
                p += step * direction;
                // Off the head.
                let from_head = p - HEAD;
                if from_head.length() < 0.1 {
                    p = HEAD + 0.1 * from_head.normalize_or(out);
                }
            }
            grown.push(strand);
        }
    }
    grown
}

/// The same curves with `factor` times the points, linearly: sampled more or less finely, of the same shape.
pub fn resampled(of: &[Vec<Vec3>], factor: f32) -> Vec<Vec<Vec3>> {
    let resample = |strand: &Vec<Vec3>| {
        let segments = ((strand.len() - 1) as f32 * factor).round().max(1.0) as usize;
        let at = |i: usize| {
            let t = i as f32 / segments as f32 * (strand.len() - 1) as f32;
            let whole = (t as usize).min(strand.len() - 2);
            strand[whole].lerp(strand[whole + 1], t - whole as f32)
        };
        (0..=segments).map(at).collect()
    };
    of.iter().map(resample).collect()
}
