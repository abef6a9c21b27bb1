//! Curves of transmittance on the GPU: fragments are listed and sorted, and each texel makes its curve of its list.

use lovelock_gpu::{Constant, ShaderPart};

use super::exact::gpu::SORTED_LIST;
use super::texels::gpu::curve::{MAKE, QUERY};
use super::texels::gpu::{GpuTexelMethod, Needs, Over, Pass};
use super::texels::{Curve, CurveMethod};

/// The GPU's part of a method with curves.
pub(crate) trait GpuCurveMethod: CurveMethod {
    /// The part that makes a curve of the steps of a texel.
    const COMPRESS: ShaderPart;

    /// The largest error of a step, if the method has such a setting.
    fn tolerance(&self) -> f32 {
        0.0
    }
}

impl<M: GpuCurveMethod> GpuTexelMethod for Curve<M> {
    const PASSES: &'static [Pass] = &[
        SORTED_LIST[0],
        SORTED_LIST[1],
        SORTED_LIST[2],
        SORTED_LIST[3],
        SORTED_LIST[4],
        Pass { name: "shadow/curves", over: Over::Texels, parts: &[MAKE[0], MAKE[1], MAKE[2], M::COMPRESS] },
    ];
    const QUERY: &'static [ShaderPart] = &QUERY;
    const LISTS: bool = true;
    const LIST_IS_SCRATCH: bool = true;

    fn needs(&self) -> Needs {
        // Words of the lists, and of the curve.
        let map_words = 2 + 2 * self.method.nodes() as u64;
        Needs { map_words, tolerance: self.method.tolerance(), ..Needs::default() }
    }

    fn constants(&self) -> Vec<Constant> {
        vec![("NODES", self.method.nodes() as f64)]
    }
}
