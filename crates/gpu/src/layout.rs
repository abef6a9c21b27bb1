//! The layout of structures in shaders, for tests that compare it with their Rust twins.

use naga::TypeInner;

use crate::{ShaderSource, check_shader};

/// Offsets of the members of a structure of a composed shader, with its size at the end, bytes.
///
/// # Panics
/// The shader is not valid, or has no such structure.
pub fn layout_in_shader(source: &ShaderSource, name: &str) -> Vec<usize> {
    let module = check_shader(source).unwrap_or_else(|error| panic!("{error}"));
    let (_, ty) = module
        .types
        .iter()
        .find(|(_, ty)| ty.name.as_deref() == Some(name))
        .unwrap_or_else(|| panic!("no structure {name}"));
    let TypeInner::Struct { members, span } = &ty.inner else { panic!("{name} is no structure") };
    members.iter().map(|member| member.offset as usize).chain([*span as usize]).collect()
}
