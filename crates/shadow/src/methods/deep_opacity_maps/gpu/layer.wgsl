// A record consists of words: the inverted bits of the depth of the first fragment, so that 0 means no hair; then the weight
// before the end of each layer. `texels.parts`: layers.

fn record_of(texel: u32) -> u32 {
    return texel * (texels.parts + 1u);
}

// The start of a layer, relative to the first fragment.
fn start_of(layer: u32) -> f32 {
    return texels.starts[layer >> 2u][layer & 3u];
}

// 1 over the thickness of a layer.
fn per_depth_of(layer: u32) -> f32 {
    return texels.per_depth[layer >> 2u][layer & 3u];
}

// The layer at `depth` (not negative) behind the first fragment. The last layer is unbounded.
fn layer_of(depth: f32) -> u32 {
    var layer = 0u;
    for (var k = 1u; k < texels.parts; k++) {
        layer += select(0u, 1u, start_of(k) <= depth);
    }
    return layer;
}
