// The depth of the body seen from a light.

struct DepthPass { shadow_from_world: mat4x4f }
@group(0) @binding(0) var<uniform> pass_uniform: DepthPass;

@vertex
fn depth_only(@location(0) position: vec3f) -> @builtin(position) vec4f {
    return pass_uniform.shadow_from_world * vec4f(position, 1.0);
}
