// The background: a graded backdrop that runs into the ground without a seam, with the shadows on the ground.

struct Screen {
    @builtin(position) position: vec4f,
    @location(0) ndc: vec2f,
}

@vertex
fn screen(@builtin(vertex_index) vertex: u32) -> Screen {
    let ndc = vec2f(f32((vertex << 1u) & 2u), f32(vertex & 2u)) * 2.0 - 1.0;
    return Screen(vec4f(ndc, 0.0, 1.0), ndc);
}

@fragment
fn backdrop(in: Screen) -> @location(0) vec4f {
    let down = 0.5 - 0.5 * in.ndc.y;
    // A soft pool of light behind the figure.
    let pool = 1.0 - 0.28 * smoothstep(0.2, 1.5, length(in.ndc * vec2f(0.8, 0.7)));
    var color = mix(frame.background_top.xyz, frame.background_bottom.xyz, smoothstep(0.0, 1.0, down)) * pool;

    if (frame.ambient_up_ground.w > 0.5) {
        let near = frame.world_from_clip * vec4f(in.ndc, 1.0, 1.0);
        let eye = frame.eye_lights.xyz;
        let ray = normalize(near.xyz / near.w - eye);
        if (ray.y < -1e-3 && eye.y > 0.0) {
            let p = eye - ray * (eye.y / ray.y);
            // The share of the light that is left; where nothing is in the way the ground is the backdrop.
            let up = vec3f(0.0, 1.0, 0.0);
            var full = 0.5 * ambient(up) * 3.14159;
            var lit = full;
            for (var k = 0u; k < light_count(); k++) {
                let light = frame.lights[k];
                let share = light.radiance_blur.xyz * max(-light.direction_specular.y, 0.0);
                full += share;
                lit += share * body_light(k, p, 0.004, 6u) * columns_light(k, p);
            }
            color *= lit / max(full, vec3f(1e-4));
        }
    }
    return vec4f(color, 1.0);
}
