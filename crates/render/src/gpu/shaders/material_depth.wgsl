// The depth of surfaces with holes seen from a light.

struct DepthPass { shadow_from_world: mat4x4f }
@group(0) @binding(0) var<uniform> pass_uniform: DepthPass;

struct Seen {
    @builtin(position) position: vec4f,
    @location(0) coordinates: vec4f,
    @location(1) opacity: f32,
}

@vertex
fn depth_with_holes(
    @location(0) position: vec3f,
    @location(4) coordinates: vec4f,
    @location(5) opacity_occlusion: vec2f,
) -> Seen {
    return Seen(pass_uniform.shadow_from_world * vec4f(position, 1.0), coordinates, opacity_occlusion.x);
}

// The opacity from which a blended surface blocks light. Twin of the constant in cpu/surface/materials.rs.
const BLOCKING: f32 = 0.5;

@fragment
fn keep_opaque(in: Seen) {
    let c = Coordinates(in.coordinates, dpdx(in.coordinates), dpdy(in.coordinates));
    if (!is_there(c, in.opacity, BLOCKING)) {
        discard;
    }
}
