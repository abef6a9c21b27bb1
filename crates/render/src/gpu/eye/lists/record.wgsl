// What lists keep of a pixel: where its fragments begin, how many there are, and how many are there already. A fragment is a
// key by which it is sorted, the largest first, and its light and opacity as four half floats.

const RECORD_WORDS: u32 = 3u;
const FRAGMENT_WORDS: u32 = 3u;
