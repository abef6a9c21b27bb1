// The hair of a picture coloured by values, over a copy of the picture that may be dimmed and grey. Runs when the hair layer has the places of values in
// their range and 1 in place of colours; see value_points.wgsl. Twin of `paint_tile` in
// cpu/false_colors.rs and of `on_hair` in panes/src/heat.rs.

struct FalseColors {
    // Brightness of the copy, how much of its colour it keeps, and how strongly light and shadow show in the colours of values.
    behind: f32,
    saturation: f32,
    relief: f32,
    // Colours of the range from its start to its end, four bytes each, sRGB-encoded.
    table: array<vec4u, 64>,
}

@group(0) @binding(19) var<uniform> false_colors: FalseColors;
@group(0) @binding(20) var shown: texture_storage_2d<rgba8unorm, write>;

const LAST_COLOR: u32 = 255u;

fn color_of(k: u32) -> vec3f {
    return unpack4x8unorm(false_colors.table[k >> 2u][k & 3u]).rgb;
}

@compute @workgroup_size(64)
fn paint_values(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    let size = picture_size();
    if (i >= size.x * size.y) {
        return;
    }
    let pixel = vec2u(i % size.x, i / size.x);
    let lit = unpack4x8unorm(screen[i]).rgb;
    let luminance = dot(lit, vec3f(0.2126, 0.7152, 0.0722));
    let under = false_colors.behind * mix(vec3f(luminance), lit, false_colors.saturation);
    let light = 1.0 - false_colors.relief + false_colors.relief * sqrt(clamp(2.0 * luminance, 0.0, 1.0));
    let hair = hair_of(pixel);
    // Between two colours, so that the table shows no steps of its own.
    let place = clamp(mean_of(hair), 0.0, 1.0) * f32(LAST_COLOR);
    let below = min(u32(place), LAST_COLOR - 1u);
    let color = light * mix(color_of(below), color_of(below + 1u), place - f32(below));
    let share = select(0.0, clamp(1.0 - hair.w, 0.0, 1.0), hair.g > LEAST_SHARE);
    textureStore(shown, pixel, vec4f(mix(under, color, share), 1.0));
}
