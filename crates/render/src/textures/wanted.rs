//! Which chains of mip levels the materials of a body share, so that their memory is bounded.

use super::chain::{Content, levels_bytes};

/// Most memory of the levels that masks add to a body, together with all others, bytes.
pub(super) const CHAIN_BYTES: u64 = 512 << 20;

/// The chains that materials ask for: each an image by its number, and what its pixels mean.
#[derive(Debug)]
pub(super) struct Wanted {
    pub chains: Vec<(usize, Content)>,
    /// The memory of the levels so far, and the most of it that masks may use.
    bytes: u64,
    most: u64,
}

impl Wanted {
    pub fn new(most: u64) -> Self {
        Self { chains: Vec::new(), bytes: 0, most }
    }

    /// The index of the chain of an image of `size`. Masks with similar cutoffs share one, and those beyond the memory get one whose
    /// opacity is the mean of the texels: what they show is then less exact far away.
    pub fn chain(&mut self, image: usize, size: [u32; 2], content: Content) -> usize {
        let content = content.with_shared_cutoff();
        if let Some(found) = self.found(image, content) {
            return found;
        }
        let own = levels_bytes(size);
        let is_mask = matches!(content, Content::Mask(_));
        if is_mask && self.bytes.saturating_add(own) > self.most {
            return self.chain(image, size, Content::ColorByOpacity);
        }
        self.bytes = self.bytes.saturating_add(own);
        self.chains.push((image, content));
        self.chains.len() - 1
    }

    fn found(&self, image: usize, content: Content) -> Option<usize> {
        self.chains.iter().position(|one| *one == (image, content))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cutoffs(wanted: &mut Wanted, image: usize, size: [u32; 2]) -> Vec<usize> {
        (0..=255).map(|i| wanted.chain(image, size, Content::mask(i as f32 / 255.0))).collect()
    }

    #[test]
    fn masks_with_similar_cutoffs_share_a_chain() {
        let mut wanted = Wanted::new(u64::MAX);
        let chains = cutoffs(&mut wanted, 0, [4, 4]);
        assert!(wanted.chains.len() <= 10, "{:?}", wanted.chains);
        assert_eq!(chains[127], chains[129]);
        assert_ne!(chains[100], chains[160], "the control");
        assert_eq!(wanted.chain(0, [4, 4], Content::mask(0.5)), chains[128]);
        // The usual cutoff is not rounded, and masks that show all or nothing stay so.
        assert_eq!(wanted.chains[chains[128]], (0, Content::Mask(128)));
        assert_eq!(wanted.chains[chains[0]], (0, Content::Mask(0)));
        let none = wanted.chain(0, [4, 4], Content::mask(1.5));
        assert_eq!(wanted.chains[none], (0, Content::Mask(256)));
    }

    #[test]
    fn masks_beyond_the_memory_do_without_coverage() {
        let size = [4096, 4096];
        let of_all = |most| {
            let mut wanted = Wanted::new(most);
            (0..8).for_each(|image| _ = cutoffs(&mut wanted, image, size));
            wanted
        };
        let bounded = of_all(CHAIN_BYTES);
        // One chain of each image may be needed in any case.
        assert!(bounded.bytes <= CHAIN_BYTES + 8 * levels_bytes(size), "{}", bounded.bytes);
        assert!(bounded.chains.contains(&(7, Content::ColorByOpacity)), "{:?}", bounded.chains);
        let unbounded = of_all(u64::MAX);
        assert!(unbounded.bytes > 3 * CHAIN_BYTES, "the control: {}", unbounded.bytes);
    }
}
