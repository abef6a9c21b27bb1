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
