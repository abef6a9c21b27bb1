//! The uniform of texels against the shaders.

use std::mem::offset_of;

use super::*;
use crate::all_shaders;
use lovelock_gpu::layout_in_shader;

#[test]
fn the_uniform_has_the_layout_of_every_shader() {
    let expected = [
        offset_of!(TexelUniform, anchor),
        offset_of!(TexelUniform, optical_depth),
        offset_of!(TexelUniform, column),
        offset_of!(TexelUniform, first_column),
        offset_of!(TexelUniform, row),
        offset_of!(TexelUniform, first_row),
        offset_of!(TexelUniform, depth),
        offset_of!(TexelUniform, first_depth),
        offset_of!(TexelUniform, edge),
        offset_of!(TexelUniform, segments),
        offset_of!(TexelUniform, count),
        offset_of!(TexelUniform, parts),
        offset_of!(TexelUniform, seeds),
        offset_of!(TexelUniform, merged),
        offset_of!(TexelUniform, prefiltered),
        offset_of!(TexelUniform, line_deviation),
        offset_of!(TexelUniform, plane),
        offset_of!(TexelUniform, start),
        offset_of!(TexelUniform, slope),
        offset_of!(TexelUniform, most),
        offset_of!(TexelUniform, tolerance),
        offset_of!(TexelUniform, bias),
        offset_of!(TexelUniform, overestimation),
        offset_of!(TexelUniform, starts),
        offset_of!(TexelUniform, per_depth),
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
