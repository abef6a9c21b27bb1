// What the samples of a body with materials have besides those of samples.wgsl.

// Octahedral normal with bumps, index of the material, and occlusion; with a texture of roughness 8 bits of both.
@group(0) @binding(27) var bumps: texture_multisampled_2d<u32>;
// Colour in shade and emitted light.
@group(0) @binding(25) var shades: texture_multisampled_2d<u32>;

struct More {
    bump: vec3f,
    occlusion: f32,
    shade: vec3f,
    emissive: vec3f,
    material: u32,
    roughness: f32,
}

// See `pack_color` in material_surface.wgsl.
fn unpack_color(word: u32) -> vec3f {
    let root = vec3f(vec3u(word, word >> 10u, word >> 20u) & vec3u(1023u)) / 1023.0;
    return root * root;
}

// See `pack_light` in material_surface.wgsl.
fn unpack_light(word: u32) -> vec3f {
    let exponent = f32(word >> 27u) - 15.0;
    return vec3f(vec3u(word, word >> 9u, word >> 18u) & vec3u(511u)) * (exp2(exponent) / 511.0);
}

fn more_at(pixel: vec2u, k: i32) -> More {
    let words = textureLoad(bumps, pixel, k);
    let colored = textureLoad(shades, pixel, k);
    let is_rough_by_texture = materials[words.z].is_rough_by_texture != 0u;
    return More(
        unfolded(words.x, words.y),
        select(f32(words.w) / 65535.0, f32(words.w & 255u) / 255.0, is_rough_by_texture),
        unpack_color(colored.x | (colored.y << 16u)),
        unpack_light(colored.z | (colored.w << 16u)),
        words.z,
        f32(words.w >> 8u) / 255.0,
    );
}

fn are_alike(a: More, b: More) -> bool {
    return a.material == b.material;
}

fn added(a: More, b: More) -> More {
    return More(
        a.bump + b.bump,
        a.occlusion + b.occlusion,
        a.shade + b.shade,
        a.emissive + b.emissive,
        a.material,
        a.roughness + b.roughness,
    );
}

// What a group shows, at a position.
fn surface_of(group: Group, world: vec3f) -> Surface {
    let share = 1.0 / group.count;
    return Surface(
        world,
        group.sum.normal,
        group.sum.more.bump,
        group.sum.color_scalp * share,
        group.sum.hair * share,
        group.sum.more.occlusion * share,
        group.sum.more.shade * share,
        group.sum.more.emissive * share,
        group.sum.more.material,
        group.sum.more.roughness * share,
    );
}
