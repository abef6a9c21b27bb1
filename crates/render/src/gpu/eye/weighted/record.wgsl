// The record of a pixel: the sums of light times opacity and of opacities, in units of 2^-14, and the number of fragments. Twin of
// cpu/transparency/weighted.rs.

const RECORD_WORDS: u32 = 5u;
const LIGHT_ONE: f32 = 16384.0;
