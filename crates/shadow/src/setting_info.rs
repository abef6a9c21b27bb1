//! What can be set about each method, as text: for documents and reports.

use std::fmt::{Debug, Display};
use std::ops::RangeInclusive;

use crate::{
    DeepOpacityMapsSettings as Deep, DensityClusteringSettings as Clusters, ExactSettings as Exact,
    OccupancyMapsSettings as Occupancy, OpacityMapsSettings as Opacity, ShadowMethod, ShadowSettings,
    TEXEL_RESOLUTIONS, TexelFilter, VoxelMapSettings as Voxel,
};

/// One value that a user sets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SettingInfo {
    /// Its name in projects.
    pub name: &'static str,
    /// What it can be, with its unit: a range, or choices divided by commas.
    pub values: String,
    /// What it is to begin with.
    pub usual: String,
}

impl SettingInfo {
    fn new(name: &'static str, values: impl Display, usual: impl Display) -> Self {
        Self { name, values: values.to_string(), usual: usual.to_string() }
    }

    fn range<T: Display>(name: &'static str, range: &RangeInclusive<T>, usual: T) -> Self {
        Self::new(name, format_args!("{} to {}", range.start(), range.end()), usual)
    }

    fn choices(name: &'static str, choices: &[u32], usual: u32) -> Self {
        let choices: Vec<_> = choices.iter().map(u32::to_string).collect();
        Self::new(name, choices.join(", "), usual)
    }

    /// What all methods with a record for each light texel have.
    fn texels(resolution: u32, filter: TexelFilter) -> [Self; 2] {
        let (least, most) = (TEXEL_RESOLUTIONS.start(), TEXEL_RESOLUTIONS.end());
        [
            Self::new("resolution", format_args!("{least} to {most} texels, in steps of 16"), resolution),
            Self::new("filter", "nearest, bilinear, jitter", id(filter)),
        ]
    }
}

/// The id of a choice in projects, from the name of its variant.
fn id(choice: impl Debug) -> String {
    kebab(&format!("{choice:?}"))
}

fn kebab(name: &str) -> String {
    let mut id = String::new();
    for (at, letter) in name.char_indices() {
        if at > 0 && letter.is_uppercase() {
            id.push('-');
        }
        id.extend(letter.to_lowercase());
    }
    id
}

impl ShadowSettings {
    /// What can be set for all methods alike, beside the method.
    pub fn shared_settings() -> Vec<SettingInfo> {
        let usual = Self::default().extinction_scale;
        vec![SettingInfo::range("extinction_scale", &Self::EXTINCTION_SCALES, usual)]
    }
}

impl ShadowMethod {
    /// What can be set about this method alone, in the order of its settings.
    pub fn settings(self) -> Vec<SettingInfo> {
        match self {
            Self::None => Vec::new(),
            Self::VoxelMap => {
                let usual = Voxel::default();
                let (least, most) = (Voxel::RESOLUTIONS.start(), Voxel::RESOLUTIONS.end());
                vec![
                    SettingInfo::new(
                        "resolution",
                        format_args!("{least} to {most} cells, in steps of 8"),
                        usual.resolution,
                    ),
                    SettingInfo::new("extent", "fit, paper", id(usual.extent)),
                    SettingInfo::new("head_size", "0 to 10 m", usual.head_size),
                    SettingInfo::new("filter", "centred, paper", id(usual.filter)),
                    SettingInfo::new("deposit", "length, point-count", id(usual.deposit)),
                    SettingInfo::new("point_extinction", "from 0, per metre", usual.point_extinction),
                ]
            }
            Self::OpacityMaps => {
                let usual = Opacity::default();
                let own = SettingInfo::range("slices", &Opacity::SLICES, usual.slices);
                SettingInfo::texels(usual.resolution, usual.filter).into_iter().chain([own]).collect()
            }
            Self::DeepOpacityMaps => {
                let usual = Deep::default();
                let own = [
                    SettingInfo::range("layers", &Deep::LAYERS, usual.layers),
                    SettingInfo::new("growth", "even, linear", id(usual.growth)),
                    SettingInfo::range("depth_share", &Deep::DEPTH_SHARES, usual.depth_share),
                ];
                SettingInfo::texels(usual.resolution, usual.filter).into_iter().chain(own).collect()
            }
            Self::DensityClustering => {
                let usual = Clusters::default();
                let own = [
                    SettingInfo::range("clusters", &Clusters::CLUSTERS, usual.clusters),
                    SettingInfo::new("seeds", "uniform, toward-light, histogram", id(usual.seeds)),
                    SettingInfo::range("steps", &Clusters::STEPS, usual.steps),
                    SettingInfo::new("deviation", "exact, merged", id(usual.deviation)),
                    SettingInfo::new("prefiltered", "false, true", usual.prefiltered),
                ];
                SettingInfo::texels(usual.resolution, usual.filter).into_iter().chain(own).collect()
            }
            Self::OccupancyMaps => {
                let usual = Occupancy::default();
                let own = [
                    SettingInfo::choices("slices", &Occupancy::SLICES, usual.slices),
                    SettingInfo::choices("slabs", &Occupancy::SLABS, usual.slabs),
                ];
                SettingInfo::texels(usual.resolution, usual.filter).into_iter().chain(own).collect()
            }
            Self::Exact => {
                let usual = Exact::default();
                let (least, most) = (Exact::MEMORY_LIMITS.start() >> 20, Exact::MEMORY_LIMITS.end() >> 30);
                let own = SettingInfo::new(
                    "memory_limit_bytes",
                    format_args!("{least} MiB to {most} GiB"),
                    format_args!("{} GiB", usual.memory_limit_bytes >> 30),
                );
                SettingInfo::texels(usual.resolution, usual.filter).into_iter().chain([own]).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Name and value of each field, as `Debug` prints a struct of plain fields.
    fn fields(printed: &str) -> Vec<(String, String)> {
        let Some((_, fields)) = printed.split_once(" { ") else { return Vec::new() };
        let fields = fields.trim_end_matches(" }").split(", ");
        fields.filter_map(|field| field.split_once(": ")).map(|(a, b)| (a.to_owned(), b.to_owned())).collect()
    }

    #[test]
    fn every_field_is_described_with_its_usual_value() {
        let all = ShadowSettings::default();
        for &method in ShadowMethod::ALL {
            let printed = match method {
                ShadowMethod::None => String::new(),
                ShadowMethod::VoxelMap => format!("{:?}", all.voxel_map),
                ShadowMethod::OpacityMaps => format!("{:?}", all.opacity_maps),
                ShadowMethod::DeepOpacityMaps => format!("{:?}", all.deep_opacity_maps),
                ShadowMethod::DensityClustering => format!("{:?}", all.density_clustering),
                ShadowMethod::OccupancyMaps => format!("{:?}", all.occupancy_maps),
                ShadowMethod::Exact => format!("{:?}", all.exact),
            };
            let (fields, described) = (fields(&printed), method.settings());
            assert_eq!(fields.len(), described.len(), "{method}");
            for ((name, value), info) in fields.iter().zip(described) {
                assert_eq!(*name, info.name, "{method}");
                let number = info.usual.parse::<f64>();
                let same = info.usual == kebab(value)
                    || number.is_ok_and(|number| value.parse() == Ok(number))
                    || (info.name == "memory_limit_bytes" && info.usual == "8 GiB");
                assert!(same, "{method} {name}: {} described, {value} is", info.usual);
            }
        }
    }

    #[test]
    fn choices_are_those_that_projects_hold() {
        use serde::de::value::{Error, StrDeserializer};
        use serde::de::{Deserialize, IntoDeserializer};
        fn reads<'a, T: Deserialize<'a>>(text: &'a str) -> bool {
            let text: StrDeserializer<'a, Error> = text.into_deserializer();
            T::deserialize(text).is_ok()
        }
        for &method in ShadowMethod::ALL {
            for info in method.settings() {
                let known: fn(&str) -> bool = match (method, info.name) {
                    (ShadowMethod::VoxelMap, "extent") => |v| reads::<crate::voxel_map::MapExtent>(v),
                    (ShadowMethod::VoxelMap, "filter") => |v| reads::<crate::voxel_map::VoxelFilter>(v),
                    (_, "deposit") => |v| reads::<crate::voxel_map::VoxelDeposit>(v),
                    (_, "filter") => |v| reads::<TexelFilter>(v),
                    (_, "growth") => |v| reads::<crate::LayerGrowth>(v),
                    (_, "seeds") => |v| reads::<crate::ClusterSeeds>(v),
                    (_, "deviation") => |v| reads::<crate::ClusterDeviation>(v),
                    _ => continue,
                };
                assert!(info.values.split(", ").all(known), "{method} {}: {}", info.name, info.values);
            }
        }
    }
}
