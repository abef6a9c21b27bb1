// Adds weights per layer.

fn put(texel: u32, depth: f32, weight: u32) {
    let record = record_of(texel);
    let near = bitcast<f32>(~atomicLoad(&map[record]));
    atomicAdd(&map[record + 1u + layer_of(depth - near)], weight);
}
