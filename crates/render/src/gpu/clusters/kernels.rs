//! The kernels of clusters.

use lovelock_gpu::{Constant, Gpu, GpuError, Kernel, ShaderPart, ShaderSource};
use lovelock_groom::HairShading;
use lovelock_satf::{ClusterSettings, ClusterView, LocalShadow, RecordLookup};

use crate::gpu::light_kernels::LightSet;

macro_rules! part {
    ($name:literal) => {
        ShaderPart { name: concat!("crates/render/src/gpu/clusters/", $name), text: include_str!($name) }
    };
}

const CLUSTERS: ShaderPart = part!("clusters.wgsl");
const LAYER: ShaderPart = part!("layer.wgsl");
const CELLS: ShaderPart = part!("cells.wgsl");
const RECORDS: ShaderPart = part!("records.wgsl");
const ENTRIES: ShaderPart = part!("entries.wgsl");
const MAPS: ShaderPart = part!("maps.wgsl");
const VERTICES: ShaderPart = part!("vertices.wgsl");
const SURFACE: ShaderPart = part!("surface.wgsl");
const RIB_LIGHT: ShaderPart = part!("rib_light.wgsl");
const PUBLISHED: ShaderPart = part!("published.wgsl");
const FRAGMENTS: ShaderPart = part!("fragments.wgsl");

/// The parts that call `take` for each fragment of clusters.
pub(in crate::gpu) const FRAGMENT_PARTS: [ShaderPart; 4] = [CLUSTERS, LAYER, CELLS, FRAGMENTS];

/// The parts that, after those of strand points, light ribs, as strands or as published.
pub(in crate::gpu) const RIB_PARTS: [ShaderPart; 4] = [CLUSTERS, SURFACE, RIB_LIGHT, PUBLISHED];

/// The most steps of loops per thread: half of what software adapters allow.
pub(super) const MAX_PIXELS_A_THREAD: f32 = 32_768.0;

/// What kernels of clusters are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::gpu) struct ClusterVariant {
    shadow: LocalShadow,
    lookup: RecordLookup,
    view: ClusterView,
    /// Lights that are on.
    lights: usize,
}

impl ClusterVariant {
    /// The variant for these settings and so many lights.
    pub fn of(settings: &ClusterSettings, lights: usize) -> Self {
        Self { shadow: settings.local_shadow, lookup: settings.lookup, view: settings.view, lights }
    }

    /// Lights that are on.
    pub(super) fn lights(self) -> usize {
        self.lights
    }

    /// The overrides of the shaders.
    pub fn constants(self) -> [Constant; 4] {
        let flag = |is: bool| f64::from(u8::from(is));
        // Twin of the constants in layer.wgsl.
        let shadow = match self.shadow {
            LocalShadow::Map => 0.0,
            LocalShadow::Layers => 1.0,
            LocalShadow::Linear => 2.0,
            LocalShadow::Directional => 3.0,
            LocalShadow::Exponential => 4.0,
        };
        [
            ("LOCAL_SHADOW", shadow),
            ("NEAREST", flag(self.lookup == RecordLookup::Nearest)),
            ("SHOWS_RECORDS", flag(self.view == ClusterView::Records)),
            ("CLUSTER_LIGHTS", self.lights as f64),
        ]
    }

    /// Whether layers shadow each other, so that the map of the hair is looked up where light enters clusters.
    pub(super) fn has_entries(self) -> bool {
        self.shadow != LocalShadow::Map
    }

    pub(super) fn is_directional(self) -> bool {
        self.shadow == LocalShadow::Directional
    }

    /// Steps of the loop over the layers that shadow a pixel.
    pub(super) fn shadow_steps(self, layers: usize) -> usize {
        match self.shadow {
            LocalShadow::Map => 0,
            LocalShadow::Layers | LocalShadow::Linear | LocalShadow::Exponential => layers,
            LocalShadow::Directional => 2 * layers * self.lights,
        }
    }
}

/// The kernels. Those that depend on settings are compiled when they are used for the first time.
#[derive(Debug)]
pub(super) struct ClusterKernels {
    pub vertices: Kernel,
    entries: Option<Kernel>,
    maps: Vec<(ClusterVariant, Kernel)>,
    rib_light: Vec<(RibVariant, Kernel)>,
}

/// What the kernel that lights ribs is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RibVariant {
    pub lights: LightSet,
    /// How they are shaded as strands; `None` for the published light.
    pub as_strands: Option<HairShading>,
    /// Whether ribs have colours of their own.
    pub colored: bool,
}

impl ClusterKernels {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let vertices = Kernel::new(gpu, "cluster vertices", &vertices_source(), "place_vertices")?;
        Ok(Self { vertices, entries: None, maps: Vec::new(), rib_light: Vec::new() })
    }

    /// The kernel that finds where light enters clusters.
    pub fn entries(&mut self, gpu: &Gpu) -> Result<&Kernel, GpuError> {
        let kernel = match self.entries.take() {
            Some(kernel) => kernel,
            None => Kernel::new(gpu, "cluster entries", &entries_source(), "place_entries")?,
        };
        Ok(self.entries.insert(kernel))
    }

    /// The kernel that lights ribs, whose shader is `source`.
    pub fn rib_light(
        &mut self,
        gpu: &Gpu,
        source: &ShaderSource,
        variant: RibVariant,
    ) -> Result<&Kernel, GpuError> {
        find_or_make(&mut self.rib_light, variant, || {
            let RibVariant { lights, as_strands, colored } = variant;
            let [count, standing] = lights.constants();
            let constants = [
                count,
                standing,
                ("SHADING", f64::from(as_strands.unwrap_or_default() as u8)),
                ("COLORED", f64::from(u8::from(colored))),
            ];
            let entry = if as_strands.is_some() { "light_ribs" } else { "published_points" };
            Kernel::specialised(gpu, "light on ribs", source, entry, &constants)
        })
    }

    /// The kernel that fills maps.
    pub fn maps(&mut self, gpu: &Gpu, variant: ClusterVariant) -> Result<&Kernel, GpuError> {
        // Maps depend on how records are read, and on whether light passes layers in its direction.
        let shadow = if variant.is_directional() { LocalShadow::Directional } else { LocalShadow::Map };
        let wanted = ClusterVariant { shadow, view: ClusterView::Hair, ..variant };
        find_or_make(&mut self.maps, wanted, || {
            Kernel::specialised(gpu, "cluster maps", &maps_source(), "fill_maps", &wanted.constants())
        })
    }
}

/// The kernel of `wanted`, made if it is not among those known.
fn find_or_make<K: PartialEq>(
    known: &mut Vec<(K, Kernel)>,
    wanted: K,
    make: impl FnOnce() -> Result<Kernel, GpuError>,
) -> Result<&Kernel, GpuError> {
    let at = if let Some(at) = known.iter().position(|(key, _)| *key == wanted) {
        at
    } else {
        known.push((wanted, make()?));
        known.len() - 1
    };
    Ok(&known[at].1)
}

fn vertices_source() -> ShaderSource {
    ShaderSource::new(&[CLUSTERS, SURFACE, VERTICES])
}

fn entries_source() -> ShaderSource {
    ShaderSource::new(&[CLUSTERS, ENTRIES])
}

fn maps_source() -> ShaderSource {
    ShaderSource::new(&[CLUSTERS, LAYER, CELLS, RECORDS, MAPS])
}

/// The composed shaders with their labels, without those of the passes over fragments.
pub(in crate::gpu) fn shaders() -> Vec<(String, ShaderSource)> {
    let all = [
        ("cluster vertices", vertices_source()),
        ("cluster entries", entries_source()),
        ("cluster maps", maps_source()),
    ];
    all.map(|(label, source)| (label.to_owned(), source)).to_vec()
}
