// The record of a pixel: start of its fragments, their number, and the number written so far. A fragment is a sort key (largest
// first), and its light and opacity as four half floats.

const RECORD_WORDS: u32 = 3u;
const FRAGMENT_WORDS: u32 = 3u;
