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
fn every_shader_has_translations_for_direct3d_and_metal() {
    for (label, source) in all_shaders() {
        if let Err(error) = lovelock_gpu::check_translations(&source) {
            panic!("{label}: {error}");
        }
    }
}
