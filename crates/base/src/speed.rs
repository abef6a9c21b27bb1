//! Loops that show how fast a machine is. They stand in this crate because it is compiled with full optimisation.

// The multiply-adds run in the widest vectors of the CPU; calling that version takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use crate::random::SplitMix64;
use crate::simd_versions;

/// Chains of multiply-adds per thread: eight registers of 256 bits.
pub const CHAINS: usize = 64;
/// Links of a chain per pass.
pub const LINKS: usize = 1 << 18;

simd_versions! {
    /// The sum of the ends of [`CHAINS`] chains of [`LINKS`] links `x = x * factor + term`.
    pub fn chains(factor: f32, term: f32) -> f32 {
        chains_plain(factor, term)
    }
}

#[inline(always)]
fn chains_plain(factor: f32, term: f32) -> f32 {
    let mut chains: [f32; CHAINS] = std::array::from_fn(|chain| chain as f32);
    for _ in 0..LINKS {
        for x in &mut chains {
            *x = *x * factor + term;
        }
    }
    chains.iter().sum()
}

/// Adds 1 at `additions` random places of `table`, whose length is a power of two.
pub fn scatter(table: &mut [u32], seed: u64, additions: usize) {
    let mut random = SplitMix64::new(seed);
    let last = table.len() - 1;
    for _ in 0..additions {
        let place = random.bits() as usize & last;
        table[place] = table[place].wrapping_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::Width;

    #[test]
    fn every_version_of_the_chains_ends_at_the_fixed_point() {
        // x = x / 2 + 1 tends to 2.
        for &width in Width::ALL.iter().filter(|width| width.is_available()) {
            assert_eq!(chains(width, 0.5, 1.0), 2.0 * CHAINS as f32, "{width:?}");
        }
    }

    #[test]
    fn scattered_additions_reach_the_whole_table() {
        let mut table = vec![0; 1 << 10];
        scatter(&mut table, 7, 1 << 14);
        assert_eq!(table.iter().sum::<u32>(), 1 << 14);
        assert!(table.iter().all(|count| *count > 0), "16 additions per entry on average");
    }
}
