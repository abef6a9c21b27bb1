//! Translation of shaders into the language of another driver, for tests on machines that do not have it.

use naga::back::{PipelineConstants, hlsl, pipeline_constants};

use crate::{GpuError, ShaderSource, shader};

/// Translates a composed shader to HLSL, as Direct3D needs it; overrides without a value get 1.
///
/// # Errors
/// As [`check_shader`](crate::check_shader), or what HLSL cannot express.
pub fn to_hlsl(source: &ShaderSource) -> Result<String, GpuError> {
    let checked = shader::check(source)?;
    let refused = |reason: &dyn std::fmt::Display| {
        GpuError::Shader(format!("{}: cannot be translated to HLSL: {reason}", source.locate(usize::MAX).0))
    };
    let unset = checked.module.overrides.iter().filter(|(_, constant)| constant.init.is_none());
    let constants: PipelineConstants =
        unset.filter_map(|(_, constant)| Some((constant.name.clone()?, 1.0))).collect();
    let (module, info) =
        pipeline_constants::process_overrides(&checked.module, &checked.info, None, &constants)
            .map_err(|error| refused(&error))?;
    let mut text = String::new();
    let (options, of_pipeline) = (hlsl::Options::default(), hlsl::PipelineOptions::default());
    hlsl::Writer::new(&mut text, &options, &of_pipeline)
        .write(&module, &info, None)
        .map_err(|error| refused(&error))?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ShaderPart;

    #[test]
    fn a_kernel_becomes_a_function_of_hlsl() {
        let text = "override K: f32;\n@group(0) @binding(0) var<storage, read_write> a: array<f32>;\n\
            @compute @workgroup_size(64) fn fill(@builtin(global_invocation_id) id: vec3u) { a[id.x] = K; }\n";
        let source = ShaderSource::new(&[ShaderPart { name: "fill.wgsl", text }]);
        let hlsl = to_hlsl(&source).expect("a translation");
        assert!(hlsl.contains("[numthreads(64, 1, 1)]") && hlsl.contains("RWByteAddressBuffer"), "{hlsl}");
        // Control: what is no shader is not translated.
        let broken = ShaderSource::new(&[ShaderPart { name: "bad.wgsl", text: "fn f( {" }]);
        assert!(to_hlsl(&broken).is_err());
    }
}
