// A record consists of words: the inverted bits of the depth of the first fragment, so that 0 means no hair; then the weight
// before the end of each layer. `texels.integers.x`: layers. `texels.floats`: the start of each of 16 layers, relative to the first fragment,
// then 1 over the thickness of each.

const MAX_LAYERS: u32 = 16u;

fn record_of(texel: u32) -> u32 {
    return texel * (texels.integers.x + 1u);
}

fn setting(at: u32) -> f32 {
    return texels.floats[at >> 2u][at & 3u];
}

// The layer at `depth` (not negative) behind the first fragment. The last layer is unbounded.
fn layer_of(depth: f32) -> u32 {
    var layer = 0u;
    for (var k = 1u; k < texels.integers.x; k++) {
        layer += select(0u, 1u, setting(k) <= depth);
    }
    return layer;
}
