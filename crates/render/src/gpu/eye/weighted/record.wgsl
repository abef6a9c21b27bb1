// What weighted averages keep of a pixel: the sum of light times opacity and of opacities, in 2^-14, and the number of
// fragments. Twin of cpu/transparency/weighted.rs.

const RECORD_WORDS: u32 = 5u;
const LIGHT_ONE: f32 = 16384.0;
