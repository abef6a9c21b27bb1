//! Shaders composed of several files, with errors that name the file and its line.

use std::collections::BTreeSet;

use crate::GpuError;

/// One file of WGSL.
#[derive(Clone, Copy, Debug)]
pub struct ShaderPart {
    /// Its path, for error messages.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

/// A shader that is the concatenation of several files.
#[derive(Clone, Debug)]
pub struct ShaderSource {
    parts: Vec<ShaderPart>,
    text: String,
}

impl ShaderSource {
    /// Concatenates `parts` in this order.
    pub fn new(parts: &[ShaderPart]) -> Self {
        let text = parts.iter().flat_map(|part| [part.text, "\n"]).collect();
        Self { parts: parts.to_vec(), text }
    }

    /// The concatenated text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Translates a line of the concatenated text into a part and its line; lines count from 1.
    pub fn locate(&self, line: usize) -> (&'static str, usize) {
        let mut first = 1;
        for part in &self.parts {
            let lines = part.text.lines().count().max(1) + usize::from(part.text.ends_with('\n'));
            if line < first + lines {
                return (part.name, line + 1 - first);
            }
            first += lines;
        }
        self.parts.last().map_or(("", line), |part| (part.name, line))
    }
}

/// Parses and validates a shader; needs no device.
///
/// # Errors
/// The part, the line and the reason.
pub fn check_shader(source: &ShaderSource) -> Result<naga::Module, GpuError> {
    check(source).map(|checked| checked.module)
}

/// A valid shader and the results of its validation.
pub(crate) struct CheckedShader {
    pub(crate) module: naga::Module,
    pub(crate) info: naga::valid::ModuleInfo,
}

impl CheckedShader {
    /// Whether the shader declares an `override` of this name.
    pub(crate) fn has_override(&self, name: &str) -> bool {
        self.module.overrides.iter().any(|(_, constant)| constant.name.as_deref() == Some(name))
    }

    /// The bindings of group 0 that an entry point uses.
    pub(crate) fn bindings_of(&self, entry: &str) -> BTreeSet<u32> {
        let Some(at) = self.module.entry_points.iter().position(|point| point.name == entry) else {
            return BTreeSet::new();
        };
        let used = self.info.get_entry_point(at);
        let variables = self.module.global_variables.iter();
        let used = variables.filter(|(handle, _)| !used[*handle].is_empty());
        used.filter_map(|(_, variable)| variable.binding.filter(|at| at.group == 0).map(|at| at.binding))
            .collect()
    }
}

pub(crate) fn check(source: &ShaderSource) -> Result<CheckedShader, GpuError> {
    let module = naga::front::wgsl::parse_str(&source.text).map_err(|error| {
        let line = error.location(&source.text).map_or(1, |at| at.line_number as usize);
        let (name, line) = source.locate(line);
        GpuError::Shader(format!("{name}, line {line}: {}", error.message()))
    })?;
    // `pack2x16float` and its inverse belong to core WebGPU, so every adapter supports them.
    let capabilities =
        naga::valid::Capabilities::default() | naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    let mut validator = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities);
    let info = validator.validate(&module).map_err(|error| {
        let span =
            error.spans().next().map_or(1, |(span, _)| span.location(&source.text).line_number as usize);
        let (name, line) = source.locate(span);
        let mut reason = error.as_inner().to_string();
        let mut cause = std::error::Error::source(error.as_inner());
        while let Some(deeper) = cause {
            reason = format!("{reason}: {deeper}");
            cause = deeper.source();
        }
        GpuError::Shader(format!("{name}, line {line}: {reason}"))
    })?;
    Ok(CheckedShader { module, info })
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: ShaderPart =
        ShaderPart { name: "good.wgsl", text: "const A: f32 = 1.0;\nconst B: f32 = 2.0;\n" };

    #[test]
    fn a_good_shader_passes() {
        let source = ShaderSource::new(&[GOOD]);
        check_shader(&source).expect("valid");
    }

    #[test]
    fn an_error_names_the_part_and_its_own_line() {
        let bad = ShaderPart { name: "bad.wgsl", text: "const C: f32 = A;\n\nconst D: f32 = Missing;\n" };
        let error = check_shader(&ShaderSource::new(&[GOOD, bad])).expect_err("unknown name").to_string();
        assert!(error.starts_with("bad.wgsl, line 3:"), "{error}");
    }

    #[test]
    fn an_entry_point_is_bound_to_what_it_uses() {
        let text = "@group(0) @binding(0) var<storage, read_write> a: array<u32>;\n\
            @group(0) @binding(3) var<storage, read_write> b: array<u32>;\n\
            fn deep() { b[0] = 1u; }\n\
            @compute @workgroup_size(1) fn both() { a[0] = 1u; deep(); }\n\
            @compute @workgroup_size(1) fn second() { deep(); }\n";
        let checked = check(&ShaderSource::new(&[ShaderPart { name: "a.wgsl", text }])).expect("valid");
        assert_eq!(checked.bindings_of("both"), BTreeSet::from([0, 3]));
        assert_eq!(checked.bindings_of("second"), BTreeSet::from([3]));
    }

    #[test]
    fn a_validation_error_names_the_part_too() {
        let bad = ShaderPart { name: "types.wgsl", text: "fn f() -> f32 {\n    return 1u;\n}\n" };
        let error = check_shader(&ShaderSource::new(&[GOOD, bad])).expect_err("wrong type").to_string();
        assert!(error.starts_with("types.wgsl, line"), "{error}");
    }
}
