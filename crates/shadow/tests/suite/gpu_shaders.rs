//! Every composed shader of every method, without a device.

use lovelock_gpu::check_shader;
use lovelock_shadow::{ShadowMethod, all_shaders};

/// Storage buffers that a shader may use in core WebGPU.
const MAX_STORAGE_BUFFERS: usize = 8;

#[test]
fn every_composed_shader_is_valid_and_keeps_within_the_limits_of_webgpu() {
    let shaders = all_shaders();
    for (label, source) in &shaders {
        let module = check_shader(source).unwrap_or_else(|error| panic!("{label}: {error}"));
        let mut places: Vec<_> = module.global_variables.iter().filter_map(|(_, v)| v.binding).collect();
        let storage = module
            .global_variables
            .iter()
            .filter(|(_, variable)| matches!(variable.space, naga::AddressSpace::Storage { .. }));
        assert!(storage.count() <= MAX_STORAGE_BUFFERS, "{label}");
        places.sort_by_key(|place| (place.group, place.binding));
        assert!(places.windows(2).all(|two| two[0] != two[1]), "{label}: two things at one place");
        assert!(!module.entry_points.is_empty(), "{label}");
    }
    for &method in ShadowMethod::ALL {
        let prefix = format!("{method}: ");
        let of: Vec<_> = shaders.iter().filter_map(|(label, _)| label.strip_prefix(&prefix)).collect();
        assert!(of.contains(&"lookup"), "{method}: {of:?}");
        // Methods with a map have passes and cast a shadow on the ground.
        let passes = of.iter().filter(|label| label.starts_with("shadow/")).count();
        assert_eq!(
            (passes > 0, of.contains(&"columns")),
            (method != ShadowMethod::None, method != ShadowMethod::None)
        );
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
