//! The uniform of texels against the shaders.

use std::mem::offset_of;

use super::*;
use crate::all_shaders;
use lovelock_gpu::layout_in_shader;

#[test]
fn the_uniform_has_the_layout_of_every_shader() {
    let expected = [
        offset_of!(TexelUniform, anchor),
        offset_of!(TexelUniform, column),
        offset_of!(TexelUniform, row),
        offset_of!(TexelUniform, depth),
        offset_of!(TexelUniform, size),
        offset_of!(TexelUniform, integers),
        offset_of!(TexelUniform, floats),
        size_of::<TexelUniform>(),
    ];
    let shaders = all_shaders();
    let of_texels = shaders.iter().filter(|(_, source)| source.text().contains("struct TexelUniform"));
    let checked = of_texels.map(|(label, source)| {
        assert_eq!(layout_in_shader(source, "TexelUniform"), expected, "{label}");
    });
    // Five methods of two passes at least, each with two queries.
    assert!(checked.count() >= 20);
}
