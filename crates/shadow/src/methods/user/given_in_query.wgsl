// What a user's method may call while points are looked up: only the record is there, and nothing is written.

fn record_load(texel: u32, word: u32) -> u32 {
    if (texel >= texels.count || word >= texels.parts) {
        return 0u;
    }
    return map[texel * texels.parts + word];
}

fn record_store(texel: u32, word: u32, value: u32) {}

fn record_add(texel: u32, word: u32, value: u32) -> u32 {
    return record_load(texel, word);
}

fn record_max(texel: u32, word: u32, value: u32) -> u32 {
    return record_load(texel, word);
}

fn scratch_load(texel: u32, word: u32) -> u32 {
    return 0u;
}

fn scratch_store(texel: u32, word: u32, value: u32) {}

fn scratch_add(texel: u32, word: u32, value: u32) -> u32 {
    return 0u;
}

fn scratch_max(texel: u32, word: u32, value: u32) -> u32 {
    return 0u;
}
