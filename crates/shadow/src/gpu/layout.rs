//! The layout of structures in shaders, for tests that compare it with their Rust twins.

use lovelock_gpu::{ShaderSource, check_shader};
use naga::TypeInner;

/// Offsets of the members of a structure of a composed shader, with its size at the end.
pub(crate) fn layout_in_shader(source: &ShaderSource, name: &str) -> Vec<usize> {
    let module = check_shader(source).expect("valid");
    let (_, ty) = module
        .types
        .iter()
        .find(|(_, ty)| ty.name.as_deref() == Some(name))
        .unwrap_or_else(|| panic!("no structure {name}"));
    let TypeInner::Struct { members, span } = &ty.inner else { panic!("{name} is no structure") };
    members.iter().map(|member| member.offset as usize).chain([*span as usize]).collect()
}
