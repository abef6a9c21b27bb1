//! The shaders and kernels of passes.

use lovelock_gpu::{Gpu, GpuError, Kernel, ShaderPart, ShaderSource};

use super::modes::{HairOutput, Mode, Over, Pass};
use super::part;
use crate::Transparency;
use crate::gpu::clusters::{ClusterVariant, FRAGMENT_PARTS};

const FRAME: ShaderPart = part!("frame.wgsl");
const FRAGMENT: ShaderPart = part!("fragment.wgsl");
const FRAGMENTS: ShaderPart = part!("fragments.wgsl");
const EACH_PIXEL: ShaderPart = part!("each_pixel.wgsl");
const BEHIND: ShaderPart = part!("behind.wgsl");

impl Pass {
    fn source(&self) -> ShaderSource {
        let last: &[ShaderPart] = match self.over {
            Over::Fragments => &[FRAGMENT, FRAGMENTS],
            Over::Pixels => &[EACH_PIXEL],
            Over::Groups(_) => &[],
        };
        let parts: Vec<_> = [FRAME].iter().chain(self.parts).chain(last).copied().collect();
        ShaderSource::new(&parts)
    }

    /// The same pass over the fragments of clusters.
    fn cluster_source(&self) -> ShaderSource {
        let parts: Vec<_> =
            [FRAME, FRAGMENT].iter().chain(self.parts).chain(&FRAGMENT_PARTS).copied().collect();
        ShaderSource::new(&parts)
    }

    /// The kernel over the fragments of clusters.
    pub fn cluster_kernel(&self, gpu: &Gpu, variant: ClusterVariant) -> Result<Kernel, GpuError> {
        Kernel::specialised(gpu, self.name, &self.cluster_source(), "each_fragment", &variant.constants())
    }

    /// The kernel, for segments with or without streaks.
    pub fn kernel(&self, gpu: &Gpu, streaked: bool) -> Result<Kernel, GpuError> {
        let entry = match self.over {
            Over::Fragments => "each_fragment",
            Over::Pixels => "each_pixel",
            Over::Groups(entry) => entry,
        };
        let constants = [("STREAKED", f64::from(u8::from(streaked)))];
        Kernel::specialised(gpu, self.name, &self.source(), entry, &constants)
    }
}

pub(super) fn behind_source() -> ShaderSource {
    ShaderSource::new(&[FRAME, BEHIND, EACH_PIXEL])
}

/// Every composed shader with its label.
pub(in crate::gpu) fn shaders() -> Vec<(String, ShaderSource)> {
    let behind = ("behind".to_owned(), behind_source());
    let blended = Transparency::ALL.into_iter().map(|mode| (mode.to_string(), HairOutput::Blended(mode)));
    let all = blended.chain([("nearest".to_owned(), HairOutput::NearestDepth)]);
    let modes = all.flat_map(|(name, drawn)| {
        let passes = Mode::of(drawn).passes.iter();
        passes
            .flat_map(move |pass| {
                let clusters = (pass.over == Over::Fragments)
                    .then(|| (format!("{name}: {} of clusters", pass.name), pass.cluster_source()));
                std::iter::once((format!("{name}: {}", pass.name), pass.source())).chain(clusters)
            })
            .collect::<Vec<_>>()
    });
    std::iter::once(behind).chain(modes).collect()
}
