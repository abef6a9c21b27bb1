// What a user's method may call while its map is built. Texels and words that do not exist read as 0, and writing them does nothing.

// The place of a word of a texel in a buffer with so many words per texel.
fn word_of(texel: u32, word: u32, words: u32) -> u32 {
    return texel * words + word;
}

fn in_record(texel: u32, word: u32) -> bool {
    return texel < texels.count && word < texels.parts;
}

fn in_scratch(texel: u32, word: u32) -> bool {
    return texel < texels.count && word < texels.merged;
}

fn record_load(texel: u32, word: u32) -> u32 {
    if (!in_record(texel, word)) {
        return 0u;
    }
    return atomicLoad(&map[word_of(texel, word, texels.parts)]);
}

fn record_store(texel: u32, word: u32, value: u32) {
    if (in_record(texel, word)) {
        atomicStore(&map[word_of(texel, word, texels.parts)], value);
    }
}

fn record_add(texel: u32, word: u32, value: u32) -> u32 {
    if (!in_record(texel, word)) {
        return 0u;
    }
    return atomicAdd(&map[word_of(texel, word, texels.parts)], value);
}

fn record_max(texel: u32, word: u32, value: u32) -> u32 {
    if (!in_record(texel, word)) {
        return 0u;
    }
    return atomicMax(&map[word_of(texel, word, texels.parts)], value);
}

fn scratch_load(texel: u32, word: u32) -> u32 {
    if (!in_scratch(texel, word)) {
        return 0u;
    }
    return atomicLoad(&scratch[word_of(texel, word, texels.merged)]);
}

fn scratch_store(texel: u32, word: u32, value: u32) {
    if (in_scratch(texel, word)) {
        atomicStore(&scratch[word_of(texel, word, texels.merged)], value);
    }
}

fn scratch_add(texel: u32, word: u32, value: u32) -> u32 {
    if (!in_scratch(texel, word)) {
        return 0u;
    }
    return atomicAdd(&scratch[word_of(texel, word, texels.merged)], value);
}

fn scratch_max(texel: u32, word: u32, value: u32) -> u32 {
    if (!in_scratch(texel, word)) {
        return 0u;
    }
    return atomicMax(&scratch[word_of(texel, word, texels.merged)], value);
}
