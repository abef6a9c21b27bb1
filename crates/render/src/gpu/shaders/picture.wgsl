// The final picture: hair over the body over the background.

@group(0) @binding(4) var normals: texture_multisampled_2d<u32>;
@group(0) @binding(5) var colors: texture_multisampled_2d<f32>;
// 0 where there is no body.
@group(0) @binding(6) var depths: texture_depth_multisampled_2d;
@group(0) @binding(7) var<storage, read> corners: array<u32>;
// The area that may contain hair: first column and row, columns and rows.
@group(0) @binding(11) var<uniform> hair_area: vec4u;
// The hair of each pixel of that area: its light, premultiplied by coverage, and the fraction of the light behind it that it lets
// through, as four half floats.
@group(0) @binding(8) var<storage, read> hair_layer: array<vec2u>;
// Red, green, blue and alpha of each pixel.
@group(0) @binding(9) var<storage, read_write> screen: array<u32>;
// Pixels that are not plain background, in four lists, and the length of each list.
@group(0) @binding(12) var<storage, read_write> listed: array<u32>;
@group(0) @binding(13) var<storage, read_write> list_count: array<atomic<u32>, 4>;
// The area that may contain hair or body, like `hair_area`; in whole cells.
@group(0) @binding(14) var<uniform> figure_area: vec4u;

// Workgroups along x, y and z of the kernels that draw the lists.
@group(0) @binding(18) var<storage, read_write> list_groups: array<u32, 12>;

// The transmittance of hair below which what is behind it is not shaded: a quarter of a step of 8 bits.
const UNSEEN: f32 = 1.0 / 1024.0;

// The content of the pixels of each list, which selects the kernel: on software adapters all threads of a vector execute what one of them
// needs.
const BODY: u32 = 0u;
const GROUND_ONLY: u32 = 1u;
const BODY_AND_GROUND: u32 = 2u;
// Hair in front of a uniform background.
const EVEN_GROUND: u32 = 3u;
override LIST: u32 = BODY;

// Whether there is a background behind hair and body; only layers.wgsl may change it.
override OVER_BACKGROUND: bool = true;

// The index of an item of a list. No pixel is in two lists, so two lists share a buffer of the size of the picture and grow toward each
// other.
fn place_in_list(list: u32, item: u32, pixels: u32) -> u32 {
    return (list >> 1u) * pixels + select(item, pixels - 1u - item, (list & 1u) == 1u);
}

// Twin of `background_form::PICTURE` in uniform.rs.
const PICTURE: u32 = 4u;

// The picture behind the figure: colours that a screen shows, sRGB-encoded, 10 bits each. Twin of `LaidBackdrop`.
@group(0) @binding(21) var<storage, read> backdrop_picture: array<u32>;

// The fraction of the light that arrives at the ground behind a pixel; 1 above the horizon.
fn light_on_ground(pixel: vec2u) -> vec3f {
    if (LIST == BODY || LIST == EVEN_GROUND) {
        return unpack_share(light_at(pixel)).rgb;
    }
    return ground_light(ndc_of(pixel)).rgb;
}

// The light of the background behind a pixel. A picture behind the figure is not in it.
fn backdrop(pixel: vec2u) -> vec3f {
    if (!OVER_BACKGROUND || frame.background_form == PICTURE) {
        return vec3f(0.0);
    }
    return graded(pixel) * light_on_ground(pixel);
}

// The fraction of a pixel with the transmittance `through` of its hair that shows a picture behind the figure. Shadows on the ground cover
// it as black does.
fn open_share(pixel: vec2u, through: f32) -> f32 {
    var open = through;
    if (LIST == BODY || LIST == BODY_AND_GROUND) {
        let samples = vec4f(
            textureLoad(depths, pixel, 0),
            textureLoad(depths, pixel, 1),
            textureLoad(depths, pixel, 2),
            textureLoad(depths, pixel, 3),
        );
        open *= dot(select(vec4f(0.25), vec4f(0.0), samples > vec4f(0.0)), vec4f(1.0));
    }
    return open * dot(light_on_ground(pixel), vec3f(1.0 / 3.0));
}

// Twin of the one in cpu/finish.rs.
const LEAST_COVER: f32 = 1e-5;

fn linear_of(encoded: vec3f) -> vec3f {
    let high = pow((max(encoded, vec3f(0.0)) + 0.055) / 1.055, vec3f(2.4));
    return select(high, encoded / 12.92, encoded <= vec3f(0.04045));
}

// A pixel of the picture behind the figure, sRGB-encoded.
fn picture_color(pixel: vec2u) -> vec3f {
    let packed = backdrop_picture[pixel.y * picture_size().x + pixel.x];
    return vec3f(vec3u(packed, packed >> 10u, packed >> 20u) & vec3u(1023u)) / 1023.0;
}

// A pixel of light over the picture behind it, which shows through by `open`. They are mixed as light that the screen emits: see `mixed` in
// backdrop/mod.rs.
fn pack_over(pixel: vec2u, light: vec3f, open: f32) -> u32 {
    let share = select(open, 1.0, open > 1.0 - LEAST_COVER);
    let over = tone_curve(light / max(1.0 - open, LEAST_COVER));
    let mixed = srgb(mix(linear_of(over), linear_of(picture_color(pixel)), share));
    return pack4x8unorm(vec4f(dithered(mixed, pixel), 1.0));
}

// The body and what is behind it. Samples of one smooth part are shaded together, at the centre of the pixel.
fn behind_hair(pixel: vec2u) -> vec3f {
    if (LIST == GROUND_ONLY || LIST == EVEN_GROUND) {
        return backdrop(pixel);
    }
    let a = sample_at(pixel, 0, textureLoad(depths, pixel, 0));
    let b = sample_at(pixel, 1, textureLoad(depths, pixel, 1));
    let c = sample_at(pixel, 2, textureLoad(depths, pixel, 2));
    let d = sample_at(pixel, 3, textureLoad(depths, pixel, 3));
    // Samples that are not shaded yet, one bit each.
    var open = vec4<bool>(a.depth > 0.0, b.depth > 0.0, c.depth > 0.0, d.depth > 0.0);
    let free = dot(select(vec4f(0.25), vec4f(0.0), open), vec4f(1.0));
    let ndc = ((vec2f(pixel) + 0.5) / frame.size - 0.5) * vec2f(2.0, -2.0);
    var sum = vec3f(0.0);
    loop {
        let first = select(select(select(3u, 2u, open.z), 1u, open.y), 0u, open.x);
        let one = chosen(a, b, c, d, first);
        // Every iteration shades at least one sample.
        open = open & (vec4u(first) != vec4u(0u, 1u, 2u, 3u));
        let together = open & vec4<bool>(
            belong_together(one, a),
            belong_together(one, b),
            belong_together(one, c),
            belong_together(one, d),
        );
        open = open & !together;
        var group = Group(one, 1.0);
        group = join(group, a, together.x);
        group = join(group, b, together.y);
        group = join(group, c, together.z);
        group = join(group, d, together.w);
        let world = frame.world_from_clip * vec4f(ndc, group.sum.depth / group.count, 1.0);
        sum += 0.25 * group.count * shade_surface(surface_of(group, world.xyz / world.w));
        // Tested at the end, as in `body_light`.
        continuing {
            break if !any(open);
        }
    }
    if (free > 0.0) {
        sum += free * backdrop(pixel);
    }
    return sum;
}

// The hair of a pixel: its light, premultiplied by coverage, and the fraction of the light behind it that it lets through.
fn hair_of(pixel: vec2u) -> vec4f {
    let place = pixel - hair_area.xy;
    // Left of and above the area these wrap around to large numbers.
    if (place.x < hair_area.z && place.y < hair_area.w) {
        let hair = hair_layer[place.y * hair_area.z + place.x];
        return vec4f(unpack2x16float(hair.x), unpack2x16float(hair.y));
    }
    return vec4f(0.0, 0.0, 0.0, 1.0);
}

fn pack_pixel(pixel: vec2u, light: vec3f) -> u32 {
    return pack4x8unorm(vec4f(tone_map(light, pixel), 1.0));
}

fn picture_size() -> vec2u {
    return vec2u(frame.size);
}

// The plain background: without hair, body and shadows on the ground. Kept from frame to frame.
@compute @workgroup_size(64)
fn plain_background(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    let size = picture_size();
    if (i < size.x * size.y) {
        let pixel = vec2u(i % size.x, i / size.x);
        if (frame.background_form == PICTURE) {
            screen[i] = pack4x8unorm(vec4f(dithered(picture_color(pixel), pixel), 1.0));
        } else {
            screen[i] = pack_pixel(pixel, graded(pixel));
        }
    }
}

// Classifies the light of cells, and lists the pixels outside the area of the figure that are not plain.
@compute @workgroup_size(64)
fn list_cells(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    let size = picture_size();
    let columns = corner_columns() - 1u;
    if (i >= columns * ((size.y + CELL - 1u) / CELL)) {
        return;
    }
    let cell = vec2u(i % columns, i / columns);
    let light = light_of_cell(cell);
    cells[i] = light;
    let first = cell * CELL;
    let place = first - figure_area.xy;
    if (light == ALL_LIGHT || (place.x < figure_area.z && place.y < figure_area.w)) {
        return;
    }
    let extent = min(vec2u(CELL), size - first);
    let count = extent.x * extent.y;
    let list = select(GROUND_ONLY, EVEN_GROUND, (light & EVEN_LIGHT) != 0u);
    let before = atomicAdd(&list_count[list], count);
    for (var k = 0u; k < count; k++) {
        let pixel = first + vec2u(k % extent.x, k / extent.x);
        listed[place_in_list(list, before + k, size.x * size.y)] = pixel.y * size.x + pixel.x;
    }
}

// Lists the pixels in the area of the figure that are not plain.
@compute @workgroup_size(64)
fn list_pixels(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= figure_area.z * figure_area.w) {
        return;
    }
    let pixel = figure_area.xy + vec2u(i % figure_area.z, i / figure_area.z);
    let hair = hair_of(pixel);
    let light = light_at(pixel);
    // Depths are not negative.
    let body = textureLoad(depths, pixel, 0) + textureLoad(depths, pixel, 1) + textureLoad(depths, pixel, 2)
        + textureLoad(depths, pixel, 3) > 0.0;
    let uneven = (light & EVEN_LIGHT) == 0u;
    let shown = select(select(EVEN_GROUND, GROUND_ONLY, uneven), select(BODY, BODY_AND_GROUND, uneven), body);
    let list = select(EVEN_GROUND, shown, hair.w > UNSEEN);
    if (list != EVEN_GROUND || light != ALL_LIGHT || any(hair != vec4f(0.0, 0.0, 0.0, 1.0))) {
        let size = picture_size();
        let item = atomicAdd(&list_count[list], 1u);
        listed[place_in_list(list, item, size.x * size.y)] = pixel.y * size.x + pixel.x;
    }
}

// Sizes the kernels that draw the lists: a thread for each pixel, but at most one row of workgroups.
@compute @workgroup_size(4)
fn size_lists(@builtin(local_invocation_index) list: u32) {
    list_groups[3u * list] = min((atomicLoad(&list_count[list]) + 63u) / 64u, 65535u);
    list_groups[3u * list + 1u] = 1u;
    list_groups[3u * list + 2u] = 1u;
}

// Draws the pixels of a list, which all threads share.
@compute @workgroup_size(64)
fn picture_lit(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let size = picture_size();
    let count = atomicLoad(&list_count[LIST]);
    for (var k = id.x; k < count; k += groups.x * 64u) {
        let i = listed[place_in_list(LIST, k, size.x * size.y)];
        let pixel = vec2u(i % size.x, i / size.x);
        let hair = hair_of(pixel);
        let light = hair.rgb + hair.w * behind_hair(pixel);
        if (frame.background_form == PICTURE) {
            screen[i] = pack_over(pixel, light, open_share(pixel, hair.w));
        } else {
            screen[i] = pack_pixel(pixel, light);
        }
    }
}
