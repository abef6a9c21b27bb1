//! `opaque`: every strand hides what is behind it; its coverage is rounded to the samples of the pixel.

use super::{Fragment, Layer};

/// The mean over samples of the nearest strand.
pub(super) fn resolve(fragments: &mut [Fragment]) -> Layer {
    let mut color = [0.0; 3];
    let mut through = 0.0;
    for sample in 0..4 {
        let nearest = fragments
            .iter()
            .filter(|fragment| fragment.seen & fragment.covered & 1 << sample != 0)
            .max_by(|a, b| a.depth.total_cmp(&b.depth).then_with(|| a.color[0].total_cmp(&b.color[0])));
        match nearest {
            Some(fragment) => {
                for (sum, c) in color.iter_mut().zip(fragment.color) {
                    *sum += 0.25 * c;
                }
            }
            None => through += 0.25,
        }
    }
    Layer { color, through }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_strand_takes_its_samples() {
        let near = Fragment { depth: 0.9, alpha: 0.5, color: [1.0, 0.0, 0.0], seen: 0b1111, covered: 0b0011 };
        let far = Fragment { depth: 0.1, alpha: 0.75, color: [0.0, 1.0, 0.0], seen: 0b1111, covered: 0b0111 };
        let layer = resolve(&mut [far, near]);
        assert_eq!(layer, Layer { color: [0.5, 0.25, 0.0], through: 0.25 });
    }
}
