//! What the registry holds about each shadow method, and the names of methods.

use std::fmt;
use std::str::FromStr;

use lovelock_base::field;
use lovelock_base::settings::{
    AnySettings, Choices, Part, PartMut, Setting, Settings, Value, find, set_value,
};
use lovelock_gpu::{Gpu, GpuError, ShaderSource};

use super::texels::{TEXEL_RESOLUTIONS, TexelFrame};
use super::{ShadowMethod, ShadowSettings};
use crate::area::{GpuSoftMaps, SoftMap, average_shaders};
use crate::perspective::{GpuLightMaps, LightMap, MakeGpuShadow, margin};
use crate::{Bounds, CpuShadow, GpuShadow, RayMarkKind, ShadowInput};

/// Everything about one shadow method that the rest of the program uses. Each method's folder has one.
#[derive(Debug)]
pub(crate) struct Method {
    /// The stable name of the command line, of projects and of reports.
    pub id: &'static str,
    /// The name in the interface.
    pub label: &'static str,
    /// One sentence: what it does and whose it is.
    pub description: &'static str,
    /// The publication that the method comes from.
    pub source: Option<&'static str>,
    /// What to change where the map does not fit into memory: the end of an error message.
    pub advice: &'static str,
    /// What a map consists of.
    pub map: MapKind,
    /// The size of the map with these settings; `None` where there is no map.
    pub size: fn(&ShadowSettings) -> Option<MapSize>,
    /// Words of 32 bits of each texel or cell of the map; lists of fragments come in addition.
    pub words: fn(&ShadowSettings) -> u64,
    /// What a map holds along a ray of its light.
    pub marks: &'static [RayMarkKind],
    /// Its section of the settings.
    pub settings: fn(&ShadowSettings) -> Option<&dyn AnySettings>,
    /// The texels over which [`converged`](crate::converged) transmittance is comparable with that of the method.
    pub footprint: fn(&ShadowInput, &ShadowSettings, &Bounds) -> TexelFrame,
    /// Whether strands block light, with these settings, by the number of their points and not by their length.
    pub counts_points: fn(&ShadowSettings) -> bool,
    /// See [`ShadowMethod::sums_strands`].
    pub sums_strands: bool,
    /// Whether the method itself follows the rays of lights that stand somewhere, in the world. Otherwise they are made parallel for it.
    pub in_world: bool,
    /// An empty map on the CPU.
    pub cpu: fn() -> Box<dyn CpuShadow + Send + Sync>,
    /// The pipelines of the GPU's passes, for the strands themselves or for projected ones.
    pub gpu: MakeGpuShadow,
    /// Every composed shader with its label.
    pub shaders: fn() -> Vec<(String, ShaderSource)>,
}

/// What the map of a method consists of, and so what a transmittance is the mean of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MapKind {
    /// There is no map.
    None,
    /// A record per texel across the light; its depths are those of its hair.
    Texels,
    /// Cells of a cube.
    Cells,
    /// There is no map: rays go through the hair itself.
    Rays,
}

/// The size of a map, as it is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapSize {
    /// Texels or cells along each edge.
    pub edge: u32,
    /// Slices, layers or bins per texel, where their number is set.
    pub per_texel: Option<u32>,
}

impl ShadowMethod {
    /// The stable name of the command line, of projects and of reports.
    pub fn id(self) -> &'static str {
        if let Self::User(user) = self { user.id() } else { self.method().id }
    }

    /// The name in the interface.
    pub fn label(self) -> &'static str {
        if let Self::User(user) = self { user.label() } else { self.method().label }
    }

    /// One sentence: what it does and whose it is.
    pub fn description(self) -> &'static str {
        if let Self::User(user) = self { user.description() } else { self.method().description }
    }

    /// The publication that the method comes from; `None` where there is none.
    pub const fn source(self) -> Option<&'static str> {
        self.method().source
    }

    /// What to change where the map does not fit into memory.
    pub(crate) const fn advice(self) -> &'static str {
        self.method().advice
    }

    /// What a map of the method consists of.
    pub const fn map_kind(self) -> MapKind {
        self.method().map
    }

    /// Whether the method itself follows the rays of lights that stand somewhere, in the world; see
    /// [`GpuShadowInput::extent`](crate::GpuShadowInput::extent).
    pub const fn in_world(self) -> bool {
        self.method().in_world
    }

    /// Whether optical depth is a sum over strands, each in proportion to [`ShadowInput::extinction_scale`]: then a sample of the
    /// strands, with a larger scale, casts about the shadow of all.
    pub const fn sums_strands(self) -> bool {
        self.method().sums_strands
    }

    /// What a map of the method holds along a ray of its light.
    pub const fn marks(self) -> &'static [RayMarkKind] {
        self.method().marks
    }
}

impl ShadowSettings {
    /// The settings of one method; `None` if it has none.
    pub fn of_method(&self, method: ShadowMethod) -> Option<&dyn AnySettings> {
        if let ShadowMethod::User(user) = method {
            return Some(self.of_any_user(user));
        }
        (method.method().settings)(self)
    }

    /// The same, to be changed.
    pub fn of_method_mut(&mut self, method: ShadowMethod) -> Option<&mut dyn AnySettings> {
        if let ShadowMethod::User(user) = method {
            return Some(self.of_any_user_mut(user));
        }
        self.sections_mut().into_iter().find(|(of, _)| *of == method).map(|(_, settings)| settings)
    }

    /// The size of the map of the method in use; `None` where it has no map.
    pub fn map_size(&self) -> Option<MapSize> {
        (self.method.method().size)(self)
    }

    /// The size of the map in short, such as `128³` or `512² × 4`, or the number of rays; empty where there is neither.
    pub fn size_label(&self) -> String {
        if self.method.map_kind() == MapKind::Rays {
            let rays = self.ray_traced.rays;
            return format!("{rays} {}", if rays == 1 { "ray" } else { "rays" });
        }
        let Some(MapSize { edge, per_texel }) = self.map_size() else { return String::new() };
        let power = if self.method.map_kind() == MapKind::Cells { '³' } else { '²' };
        per_texel.map_or_else(|| format!("{edge}{power}"), |count| format!("{edge}{power} × {count}"))
    }

    /// Memory of one map whose texels or cells all hold hair, bytes: an upper limit, because texels are never narrower than strands.
    /// Lists of fragments, which only [`ShadowMethod::Exact`] stores, come in addition. 0 where there is no map.
    pub fn map_bytes(&self) -> u64 {
        let settings = self.clamped();
        let Some(MapSize { edge, .. }) = settings.map_size() else { return 0 };
        let power = if settings.method.map_kind() == MapKind::Cells { 3 } else { 2 };
        4 * (settings.method.method().words)(&settings) * u64::from(edge).pow(power)
    }

    /// The texels over which [`converged`](crate::converged) transmittance is comparable with that of the method in use.
    pub(crate) fn footprint(&self, input: &ShadowInput, bounds: &Bounds) -> TexelFrame {
        (self.method.method().footprint)(input, self, bounds)
    }

    /// Whether strands block light by the number of their points and not by their length: then shadows depend on how finely
    /// strands are sampled.
    pub fn counts_points(&self) -> bool {
        (self.method.method().counts_points)(self)
    }

    /// The settings of the maps on the sides of a cube around a light: they have half of the resolution, because hair is near
    /// and six maps otherwise need six times the memory: then three quarters of one map's with cells, and half as much again with texels.
    pub(crate) fn for_sides(&self) -> Self {
        let mut settings = *self;
        if let Some(section) = settings.of_method_mut(self.method)
            && let Some((_, Value::Count(edge))) = find(&*section, "resolution")
        {
            set_value(section, "resolution", Value::Count(edge / 2));
        }
        settings
    }

    /// How far the maps on the sides of a cube around a light reach into each other, as a tangent.
    pub(crate) fn face_margin(&self) -> f32 {
        let cells = self.for_sides().map_size().filter(|_| self.method.map_kind() == MapKind::Cells);
        margin(cells.map_or(*TEXEL_RESOLUTIONS.start(), |size| size.edge))
    }
}

/// An empty map of `method` on the CPU: everything is lit until it is built.
pub fn cpu_shadow(method: ShadowMethod) -> Box<dyn CpuShadow + Send + Sync> {
    if method.map_kind() == MapKind::Rays {
        // They go to all of the light's area.
        return (method.method().cpu)();
    }
    Box::new(SoftMap::new(method, hard_cpu_shadow))
}

/// The same for one sample of a light.
fn hard_cpu_shadow(method: ShadowMethod) -> Box<dyn CpuShadow + Send + Sync> {
    match method {
        ShadowMethod::User(user) => user.on_device(),
        method if method.in_world() => (method.method().cpu)(),
        method => Box::new(LightMap::new(method.method().cpu)),
    }
}

/// Compiles a method's pipelines for the GPU; its maps are empty.
///
/// # Errors
/// A shader that does not compile, by file and line.
pub fn gpu_shadow(method: ShadowMethod, gpu: &Gpu) -> Result<Box<dyn GpuShadow>, GpuError> {
    if method.map_kind() == MapKind::Rays {
        // They go to all of the light's area.
        return (method.method().gpu)(method, gpu, false);
    }
    Ok(Box::new(GpuSoftMaps::new(gpu, method, hard_gpu_shadow)?))
}

/// The same for one sample of each light.
fn hard_gpu_shadow(method: ShadowMethod, gpu: &Gpu) -> Result<Box<dyn GpuShadow>, GpuError> {
    if method.in_world() {
        return (method.method().gpu)(method, gpu, false);
    }
    Ok(Box::new(GpuLightMaps::new(gpu, method, method.method().gpu)?))
}

/// Every composed shader of every method with its label, so that a test can validate them without a device.
pub fn all_shaders() -> Vec<(String, ShaderSource)> {
    let of = |method: &ShadowMethod| {
        let named = move |(label, source)| (format!("{method}: {label}"), source);
        (method.method().shaders)().into_iter().map(named).collect::<Vec<_>>()
    };
    ShadowMethod::ALL.iter().flat_map(of).chain(GpuLightMaps::shaders()).chain(average_shaders()).collect()
}

impl Choices for ShadowMethod {
    const ALL: &'static [Self] = Self::ALL;

    fn more() -> Vec<Self> {
        Self::of_users()
    }

    fn names(self) -> (&'static str, &'static str) {
        (self.id(), self.label())
    }
}

impl ShadowMethod {
    /// The name of its section in projects.
    fn section(self) -> String {
        self.method().id.replace('-', "_")
    }
}

impl Settings for ShadowSettings {
    const TABLE: &'static [Setting<Self>] = &[Setting::choice::<ShadowMethod>(
        field!(Self, method),
        "Method",
        "How the light that reaches a hair through other hair is computed.",
    )];

    fn parts(&self) -> Vec<Part<'_>> {
        let part = |method: &ShadowMethod| Some((method.section().into(), self.of_method(*method)?));
        ShadowMethod::ALL.iter().filter_map(part).chain(self.user_part()).collect()
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        if let ShadowMethod::User(user) = self.method {
            // The settings of another user's method give way.
            self.of_any_user_mut(user);
        }
        self.sections_mut().into_iter().map(|(of, settings)| (of.section().into(), settings)).collect()
    }
}

impl fmt::Display for ShadowMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.id())
    }
}

/// A name that is no shadow method's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no shadow method is called \"{found}\"; must be one of: {}", ids())]
pub struct UnknownShadowMethod {
    /// The name that was asked for.
    pub found: String,
}

fn ids() -> String {
    let ids: Vec<_> = ShadowMethod::ALL.iter().map(|method| method.id()).collect();
    ids.join(", ")
}

impl FromStr for ShadowMethod {
    type Err = UnknownShadowMethod;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.iter().find(|method| method.id() == name);
        // Whoever asks for a folder by its name may read it; a project may not: see `TryFrom`.
        let users = || Self::of_text(name).inspect(|method| method.allow());
        found.copied().or_else(users).ok_or_else(|| UnknownShadowMethod { found: name.to_owned() })
    }
}

impl TryFrom<String> for ShadowMethod {
    type Error = UnknownShadowMethod;

    fn try_from(name: String) -> Result<Self, Self::Error> {
        let own = Self::ALL.iter().all(|method| method.id() != name).then(|| Self::of_text(&name)).flatten();
        own.map_or_else(|| name.parse(), Ok)
    }
}

impl From<ShadowMethod> for String {
    fn from(method: ShadowMethod) -> Self {
        if let ShadowMethod::User(user) = method {
            return user.text();
        }
        method.id().to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_distinct_and_read_back() {
        for (i, &method) in ShadowMethod::ALL.iter().enumerate() {
            assert_eq!(method.id().parse(), Ok(method));
            assert_eq!(String::from(method), method.to_string());
            assert!(ShadowMethod::ALL[..i].iter().all(|other| other.id() != method.id()));
        }
    }

    #[test]
    fn every_method_is_listed_in_order() {
        let place = |method: ShadowMethod| match method {
            ShadowMethod::None => 0,
            ShadowMethod::VoxelMap => 1,
            ShadowMethod::OpacityMaps => 2,
            ShadowMethod::DeepOpacityMaps => 3,
            ShadowMethod::DensityClustering => 4,
            ShadowMethod::OccupancyMaps => 5,
            ShadowMethod::DeepShadowMaps => 6,
            ShadowMethod::ApproximateDeep => 7,
            ShadowMethod::Fourier => 8,
            ShadowMethod::Adaptive => 9,
            ShadowMethod::Moments => 10,
            ShadowMethod::VoxelMarch => 11,
            ShadowMethod::RayTraced => 12,
            ShadowMethod::Exact => 13,
            ShadowMethod::User(_) => usize::MAX,
        };
        assert!(ShadowMethod::ALL.iter().enumerate().all(|(at, method)| place(*method) == at));
    }

    #[test]
    fn every_section_can_be_changed() {
        let mut settings = ShadowSettings::default();
        let sections: Vec<_> = settings.parts().into_iter().map(|(name, _)| name).collect();
        assert_eq!(settings.parts_mut().into_iter().map(|(name, _)| name).collect::<Vec<_>>(), sections);
        for &method in ShadowMethod::ALL {
            assert_eq!(sections.iter().any(|name| *name == method.section()), method != ShadowMethod::None);
        }
    }

    #[test]
    fn a_map_has_a_size_marks_and_a_label() {
        let labels = ShadowMethod::ALL.iter().map(|&method| {
            let settings = ShadowSettings { method, ..ShadowSettings::default() };
            let has_map = matches!(method.map_kind(), MapKind::Texels | MapKind::Cells);
            assert_eq!(settings.map_size().is_some(), has_map, "{method}");
            assert_eq!(!method.marks().is_empty(), method != ShadowMethod::None, "{method}");
            settings.size_label()
        });
        let expected = [
            "",
            "128³",
            "512² × 128",
            "512² × 4",
            "512² × 4",
            "512² × 128",
            "512² × 16",
            "512²",
            "512² × 7",
            "512² × 8",
            "512² × 4",
            "128³",
            "4 rays",
            "512²",
        ];
        assert_eq!(labels.collect::<Vec<_>>(), expected);
    }

    #[test]
    fn the_memory_of_a_map_is_that_on_paper() {
        let bytes = |method| ShadowSettings { method, ..ShadowSettings::default() }.map_bytes();
        assert_eq!((bytes(ShadowMethod::None), bytes(ShadowMethod::RayTraced)), (0, 0));
        // One word for each of 128³ cells.
        assert_eq!(bytes(ShadowMethod::VoxelMap), 8 << 20);
        // 512² texels: 128 slices; 4 layers and the first depth; 3 numbers for each of 4 clusters.
        assert_eq!(bytes(ShadowMethod::OpacityMaps), 128 << 20);
        assert_eq!(bytes(ShadowMethod::DeepOpacityMaps), 5 << 20);
        assert_eq!(bytes(ShadowMethod::DensityClustering), 12 << 20);
        // Sintorn and Assarsson 2009 print 10 MB for 512² texels.
        assert!((10 << 20..=12 << 20).contains(&bytes(ShadowMethod::OccupancyMaps)));
        // A header of two words and two for each of 16 nodes, and of 8; the nearest depth; a header of three words, and two for each of 7
        // terms, and one for each of 4 moments.
        assert_eq!(bytes(ShadowMethod::DeepShadowMaps), 34 << 20);
        assert_eq!(bytes(ShadowMethod::Adaptive), 18 << 20);
        assert_eq!(bytes(ShadowMethod::ApproximateDeep), 1 << 20);
        assert_eq!(bytes(ShadowMethod::Fourier), 17 << 20);
        assert_eq!(bytes(ShadowMethod::Moments), 7 << 20);
        // A brick of 8³ cells holds 9³ words: less than two for each cell.
        assert_eq!(bytes(ShadowMethod::VoxelMarch), 16 << 20);
        let mut settings = ShadowSettings { method: ShadowMethod::Moments, ..ShadowSettings::default() };
        settings.moments.bits = 16;
        assert_eq!(settings.map_bytes(), 5 << 20, "two moments a word");
        let mut settings = ShadowSettings::default();
        settings.voxel_map.resolution = u32::MAX;
        assert_eq!(settings.map_bytes(), 4 * 512_u64.pow(3), "not more than the finest map");
        settings.voxel_map.resolution = 0;
        assert_eq!(settings.map_bytes(), 4 * 16_u64.pow(3));
    }

    #[test]
    fn projects_hold_the_id() {
        use serde::de::value::{Error, StrDeserializer};
        use serde::de::{Deserialize, IntoDeserializer};
        for &method in ShadowMethod::ALL {
            let text: StrDeserializer<'_, Error> = method.id().into_deserializer();
            assert_eq!(ShadowMethod::deserialize(text), Ok(method));
        }
        let text: StrDeserializer<'_, Error> = "fog".into_deserializer();
        let error = ShadowMethod::deserialize(text).unwrap_err().to_string();
        assert!(error.contains("fog") && error.contains("voxel-map"), "{error}");
    }

    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        let error = "Voxel map".parse::<ShadowMethod>().unwrap_err().to_string();
        assert_eq!(
            error,
            "no shadow method is called \"Voxel map\"; must be one of: none, voxel-map, opacity-maps, deep-opacity-maps, \
             density-clustering, occupancy-maps, deep-shadow-maps, approximate-deep, fourier, adaptive, moments, voxel-march, \
             ray-traced, exact"
        );
    }
}
