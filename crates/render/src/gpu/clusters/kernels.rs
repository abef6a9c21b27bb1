//! The kernels of clusters.

use lovelock_gpu::{Constant, Gpu, GpuError, Kernel, ShaderPart, ShaderSource};
use lovelock_satf::{ClusterSettings, ClusterView, LocalShadow, RecordLookup};

macro_rules! part {
    ($name:literal) => {
        ShaderPart {
            name: concat!("crates/render/src/gpu/clusters/", $name),
            text: include_str!($name),
        }
    };
}

const CLUSTERS: ShaderPart = part!("clusters.wgsl");
const LAYER: ShaderPart = part!("layer.wgsl");
const CELLS: ShaderPart = part!("cells.wgsl");
const RECORDS: ShaderPart = part!("records.wgsl");
const MAPS: ShaderPart = part!("maps.wgsl");
const VERTICES: ShaderPart = part!("vertices.wgsl");
const FRAGMENTS: ShaderPart = part!("fragments.wgsl");

/// The parts that call `take` for each fragment of clusters.
pub(in crate::gpu) const FRAGMENT_PARTS: [ShaderPart; 4] = [CLUSTERS, LAYER, CELLS, FRAGMENTS];

/// The most steps of loops per thread: half of what software adapters allow.
pub(super) const MOST_PIXELS_A_THREAD: f32 = 32_768.0;

/// What kernels of clusters are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::gpu) struct ClusterVariant {
    shadow: LocalShadow,
    lookup: RecordLookup,
    view: ClusterView,
}

impl ClusterVariant {
    /// The variant for these settings.
    pub fn of(settings: &ClusterSettings) -> Self {
        Self { shadow: settings.local_shadow, lookup: settings.lookup, view: settings.view }
    }

    /// The overrides of the shaders.
    pub fn constants(self) -> [Constant; 3] {
        let flag = |is: bool| f64::from(u8::from(is));
        // Twin of the constants in layer.wgsl.
        let shadow = match self.shadow {
            LocalShadow::Map => 0.0,
            LocalShadow::Layers => 1.0,
            LocalShadow::Linear => 2.0,
            LocalShadow::Directional => 3.0,
        };
        [
            ("LOCAL_SHADOW", shadow),
            ("NEAREST", flag(self.lookup == RecordLookup::Nearest)),
            ("SHOWS_RECORDS", flag(self.view == ClusterView::Records)),
        ]
    }

    pub(super) fn is_directional(self) -> bool {
        self.shadow == LocalShadow::Directional
    }

    /// Steps of the loop over the layers that shadow a pixel.
    pub(super) fn shadow_steps(self, layers: usize) -> usize {
        match self.shadow {
            LocalShadow::Map => 0,
            LocalShadow::Layers | LocalShadow::Linear => layers,
            LocalShadow::Directional => 2 * layers,
        }
    }
}

/// The kernels, of which those for maps are compiled for each variant that is used.
#[derive(Debug)]
pub(super) struct ClusterKernels {
    pub vertices: Kernel,
    maps: Vec<(ClusterVariant, Kernel)>,
}

impl ClusterKernels {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let vertices = Kernel::new(gpu, "cluster vertices", &vertices_source(), "place_vertices")?;
        Ok(Self { vertices, maps: Vec::new() })
    }

    /// The kernel that fills maps.
    pub fn maps(&mut self, gpu: &Gpu, variant: ClusterVariant) -> Result<&Kernel, GpuError> {
        // Maps depend on how records are read, and on whether light passes layers in its direction.
        let shadow = if variant.is_directional() { LocalShadow::Directional } else { LocalShadow::Map };
        let wanted = ClusterVariant { shadow, view: ClusterView::Hair, ..variant };
        let at = match self.maps.iter().position(|(known, _)| *known == wanted) {
            Some(at) => at,
            None => {
                let kernel =
                    Kernel::specialised(gpu, "cluster maps", &maps_source(), "fill_maps", &wanted.constants())?;
                self.maps.push((wanted, kernel));
                self.maps.len() - 1
            }
        };
        Ok(&self.maps[at].1)
    }
}

fn vertices_source() -> ShaderSource {
    ShaderSource::new(&[CLUSTERS, VERTICES])
}

fn maps_source() -> ShaderSource {
    ShaderSource::new(&[CLUSTERS, LAYER, CELLS, RECORDS, MAPS])
}

/// The composed shaders with their labels, without those of the passes over fragments.
pub(in crate::gpu) fn shaders() -> Vec<(String, ShaderSource)> {
    vec![("cluster vertices".to_owned(), vertices_source()), ("cluster maps".to_owned(), maps_source())]
}
