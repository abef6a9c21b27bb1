// Optical depth of the fragments before a point. Fragments at exactly its depth do not count.

@group(0) @binding(5) var<storage, read> list: array<vec2u>;

const LIST_HEAD: u32 = 2u;

fn depth_before(texel: u32, depth: f32) -> f32 {
    // A list that was too small is rebuilt; until then nothing beyond its end is read.
    let end = min(map[texel * 2u + 1u], arrayLength(&list) - LIST_HEAD);
    let start = min(map[texel * 2u], end);
    var low = start;
    var high = end;
    while (low < high) {
        let middle = low + ((high - low) >> 1u);
        if (bitcast<f32>(list[LIST_HEAD + middle].x) < depth) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    if (low == start) {
        return 0.0;
    }
    return depth_of_weight(f32(list[LIST_HEAD + low - 1u].y));
}
