//! The order in which stored strands are drawn: every prefix is spread evenly over all wisps.

/// The indices of all strands, of which `wisp` has the wisps, in their order.
///
/// Strand `i` of a wisp has the key `(reversed(i) + random) / count`, where `reversed` reverses the bits of the index, so that the strands
/// below any key are as many in each wisp, up to one, and are spread over the wisp.
pub(super) fn evenly(wisp: &[u32]) -> Vec<u32> {
    let mut keys: Vec<(u32, u32)> = Vec::with_capacity(wisp.len());
    for members in wisp.chunk_by(|a, b| a == b) {
        let first = keys.len() as u32;
        let count = members.len() as u32;
        let bits = u32::BITS - count.next_power_of_two().trailing_zeros();
        // Ranks within the wisp: bit reversal of a range that is no power of two leaves gaps.
        let mut ranks: Vec<u32> = (0..count).collect();
        ranks.sort_unstable_by_key(|&i| if bits < u32::BITS { i.reverse_bits() >> bits } else { 0 });
        for (rank, i) in ranks.into_iter().enumerate() {
            let random = f64::from(hash(first + i)) / f64::from(u32::MAX);
            let key = (rank as f64 + random) / f64::from(count);
            keys.push(((key * f64::from(u32::MAX)) as u32, first + i));
        }
    }
    keys.sort_unstable();
    keys.into_iter().map(|(_, strand)| strand).collect()
}

/// A place within a cube of half edge 1 for strand `i` of the list: constant along the strand and in time. Twin of `place_of` in
/// grow.wgsl.
pub(super) fn place(i: u32) -> [f32; 3] {
    let h = hash(i);
    [h, h >> 10, h >> 20].map(|bits| (bits & 0x3ff) as f32 * (2.0 / 1023.0) - 1.0)
}

/// A hash of a number, spread over all 32 bits (Mueller's multiplicative mix).
pub(super) fn hash(x: u32) -> u32 {
    let x = (x ^ (x >> 16)).wrapping_mul(0x045d_9f3b);
    let x = (x ^ (x >> 16)).wrapping_mul(0x045d_9f3b);
    x ^ (x >> 16)
}
