//! Translation of shaders into the languages of other drivers, for tests on machines that do not have them.

use std::fmt;

use naga::back::{PipelineConstants, hlsl, msl, pipeline_constants};

use crate::{GpuError, ShaderSource, shader};

/// Checks that a composed shader can be translated into the languages of Direct3D and Metal.
///
/// # Errors
/// As [`check_shader`](crate::check_shader), or what a language cannot express.
pub fn check_translations(source: &ShaderSource) -> Result<(), GpuError> {
    Language::ALL.into_iter().try_for_each(|language| translate(source, language).map(drop))
}

/// The language of a driver.
#[derive(Clone, Copy)]
enum Language {
    /// That of Direct3D.
    Hlsl,
    /// That of Metal, version 2.3.
    Msl,
}

impl Language {
    const ALL: [Self; 2] = [Self::Hlsl, Self::Msl];
}

impl fmt::Display for Language {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Hlsl => "HLSL",
            Self::Msl => "MSL",
        })
    }
}

/// Translates a shader. Overrides without a value get 1, and for Metal the places of buffers and textures are made up.
fn translate(source: &ShaderSource, language: Language) -> Result<String, GpuError> {
    let checked = shader::check(source)?;
    let refused = |reason: &dyn fmt::Display| {
        let file = source.locate(usize::MAX).0;
        GpuError::Shader(format!("{file}: cannot be translated to {language}: {reason}"))
    };
    let unset = checked.module.overrides.iter().filter(|(_, constant)| constant.init.is_none());
    let constants: PipelineConstants =
        unset.filter_map(|(_, constant)| Some((constant.name.clone()?, 1.0))).collect();
    let (module, info) =
        pipeline_constants::process_overrides(&checked.module, &checked.info, None, &constants)
            .map_err(|error| refused(&error))?;
    match language {
        Language::Hlsl => {
            let mut text = String::new();
            let (options, of_pipeline) = (hlsl::Options::default(), hlsl::PipelineOptions::default());
            hlsl::Writer::new(&mut text, &options, &of_pipeline)
                .write(&module, &info, None)
                .map_err(|error| refused(&error))?;
            Ok(text)
        }
        Language::Msl => {
            let options = msl::Options { lang_version: (2, 3), ..msl::Options::default() };
            let (text, translated) =
                msl::write_string(&module, &info, &options, &msl::PipelineOptions::default())
                    .map_err(|error| refused(&error))?;
            translated
                .entry_point_names
                .into_iter()
                .try_for_each(|name| name.map(drop))
                .map_err(|error| refused(&error))?;
            Ok(text)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ShaderPart;

    #[test]
    fn a_kernel_becomes_a_function_of_either_language() {
        let text = "override K: f32;\n@group(0) @binding(0) var<storage, read_write> a: array<f32>;\n\
            @compute @workgroup_size(64) fn fill(@builtin(global_invocation_id) id: vec3u) { a[id.x] = K; }\n";
        let source = ShaderSource::new(&[ShaderPart { name: "fill.wgsl", text }]);
        let broken = ShaderSource::new(&[ShaderPart { name: "bad.wgsl", text: "fn f( {" }]);
        for (language, words) in Language::ALL
            .into_iter()
            .zip([["[numthreads(64, 1, 1)]", "RWByteAddressBuffer"], ["kernel void fill", "device"]])
        {
            let found = translate(&source, language).expect("a translation");
            assert!(words.iter().all(|word| found.contains(word)), "{found}");
            assert!(translate(&broken, language).is_err(), "control: what is no shader is not translated");
        }
        check_translations(&source).expect("both");
    }
}
