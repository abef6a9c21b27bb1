//! Every composed shader is valid, and its structures have the layout that Rust writes. Needs no device.

use lovelock_render::{all_shaders, check_shader};

#[test]
fn every_shader_is_valid() {
    for (label, source) in all_shaders() {
        if let Err(error) = check_shader(&source) {
            panic!("{label}: {error}");
        }
    }
}

#[test]
fn every_shader_has_a_translation_for_direct3d() {
    for (label, source) in all_shaders() {
        if let Err(error) = lovelock_gpu::to_hlsl(&source) {
            panic!("{label}: {error}");
        }
    }
}
