// Rasterises segments as ribbons that face the camera. Widths below a pixel become coverage: a strand of 0.2 pixels is drawn one
// pixel wide with a fifth of its opacity, so that it neither breaks up nor becomes heavier with distance. Twin of
// cpu/hair/fragments.rs and cpu/hair/list.rs. A pass defines `take(pixel, fragment)`.
//
// Several threads share a segment that may cover very many pixels, because software adapters end loops after 65,535 iterations.

// Whether a strand may be wide enough on the screen to be streaked.
override STREAKED: bool = true;

@compute @workgroup_size(64)
fn each_fragment(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let thread = id.x + id.y * groups.x * 64u;
    let segment = thread / eye.lanes;
    if (segment >= eye.segments) {
        return;
    }
    let first = segments[segment];
    let a = shaded[first];
    let b = shaded[first + 1u];
    if (!(a.half_width >= 0.0 && b.half_width >= 0.0)) {
        return;
    }
    let d = b.at.xy - a.at.xy;
    let length = sqrt(d.x * d.x + d.y * d.y);
    if (!(length >= 1e-4)) {
        return;
    }
    let normal = vec2f(-d.y, d.x) / length;
    // `across` is perpendicular to the strand.
    let run_a = vec2f(a.across.y, -a.across.x);
    let run_b = vec2f(b.across.y, -b.across.x);
    let half_a = max(a.half_width, 0.5);
    let half_b = max(b.half_width, 0.5);
    let reach = max(half_a, half_b) + 0.5;
    let opacity_a = eye.opacity * min(a.half_width * 2.0, 1.0);
    let opacity_b = eye.opacity * min(b.half_width * 2.0, 1.0);
    let streaked = max(half_a, half_b) > 0.8;
    let blue_hash = unpack2x16float(a.color.y);
    let color_a = vec3f(unpack2x16float(a.color.x), blue_hash.x);
    let color_b = vec3f(unpack2x16float(b.color.x), unpack2x16float(b.color.y).x);
    let hash = blue_hash.y;
    let middle_distance = 0.5 / max(a.at.z, 1e-9) + 0.5 / max(b.at.z, 1e-9);

    // The outer loop runs along the longer axis; on the other axis there is a run of pixels.
    let low_corner = min(a.at.xy - abs(a.across) * reach, b.at.xy - abs(b.across) * reach);
    let high_corner = max(a.at.xy + abs(a.across) * reach, b.at.xy + abs(b.across) * reach);
    let low = max(low_corner, vec2f(eye.corner));
    let high = min(high_corner, vec2f(eye.corner + eye.size));
    if (!(low.x < high.x && low.y < high.y)) {
        return;
    }
    let by_row = abs(d.y) > abs(d.x);
    let begin = select(low, low.yx, by_row);
    let until = select(high, high.yx, by_row);
    let start = select(a.at.xy, a.at.yx, by_row);
    let step = select(d, d.yx, by_row);
    let slope = step.y / step.x;
    let half_run = reach * length / abs(step.x);
    let last = i32(ceil(until.x - 0.5));
    // One loop over both axes: on software adapters each inner loop would cost an empty iteration.
    let lanes = i32(eye.lanes);
    var major = i32(ceil(begin.x - 0.5)) + i32(thread % eye.lanes) - lanes;
    var minor = 0;
    var end = 0;
    loop {
        minor++;
        if (minor >= end) {
            major += lanes;
            if (major >= last) {
                break;
            }
            let middle = start.y + slope * (f32(major) + 0.5 - start.x);
            end = i32(ceil(min(middle + half_run, until.y) - 0.5));
            minor = i32(ceil(max(middle - half_run, begin.y) - 0.5));
        }
        if (minor < end) {
            let at = select(vec2u(u32(major), u32(minor)), vec2u(u32(minor), u32(major)), by_row);
            let centre = vec2f(at) + 0.5;
            let p = centre - a.at.xy;
            // A pixel belongs to the segment between the lines across the strand through its two ends, which neighbouring
            // segments share.
            let after_a = dot(p, run_a);
            let after_b = dot(centre - b.at.xy, run_b);
            if (!(after_a >= 0.0 && after_b < 0.0)) {
                continue;
            }
            let along = clamp(after_a / max(after_a - after_b, 1e-6), 0.0, 1.0);
            let half_width = half_a + (half_b - half_a) * along;
            let offset = dot(p, normal);
            var alpha = (opacity_a + (opacity_b - opacity_a) * along)
                * clamp(half_width + 0.5 - abs(offset), 0.0, 1.0);
            if (alpha <= 0.0) {
                continue;
            }
            let depth = a.at.z + (b.at.z - a.at.z) * along;
            let seen = vec4f(depth) >= textureLoad(depths, at - eye.corner, 0);
            if (!any(seen)) {
                continue;
            }
            var gain = 1.0;
            if (STREAKED && streaked) {
                // A strand represents many hairs: where it is wide enough to show them, it is streaked.
                let across = offset / half_width;
                let wave = smoothstep(0.8, 2.0, half_width)
                    * (sin(across * 5.0 + hash * 41.0) * 0.6 + sin(across * 11.0 - hash * 73.0) * 0.4);
                alpha = clamp(alpha * (1.0 + 0.22 * wave), 0.0, 1.0);
                gain = 1.0 + 0.18 * wave;
            }
            let color = (color_a + (color_b - color_a) * along) * gain;
            take((at.y - eye.corner.y) * eye.size.x + at.x - eye.corner.x, Fragment(depth, alpha, seen, color, hash, middle_distance, at));
        }
    }
}
