// A texel's record, in words: the depth of the first fragment turned round, so that 0 stands for none at all; the weight at
// the end of each layer. `texels.whole.x`: layers. `texels.broken`: where each of 16 begins, from the first fragment on, then
// one over its thickness.

const MOST_LAYERS: u32 = 16u;

fn record_of(texel: u32) -> u32 {
    return texel * (texels.whole.x + 1u);
}

fn setting(at: u32) -> f32 {
    return texels.broken[at >> 2u][at & 3u];
}

// The layer that lies `depth` behind the first fragment, which is not negative; the last one reaches on.
fn layer_of(depth: f32) -> u32 {
    var layer = 0u;
    for (var k = 1u; k < texels.whole.x; k++) {
        layer += select(0u, 1u, setting(k) <= depth);
    }
    return layer;
}
