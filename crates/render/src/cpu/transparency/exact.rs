//! `exact`: all fragments of a pixel, sorted and blended, which is the result of depth peeling (Everitt 2001).

use super::{Fragment, Layer};

/// Blends from near to far.
pub(super) fn resolve(fragments: &mut [Fragment]) -> Layer {
    // Ties are broken by the other values, so that the result does not depend on the order of the list.
    let bits =
        |fragment: &Fragment| (fragment.alpha.to_bits(), fragment.color.map(f32::to_bits), fragment.seen);
    fragments.sort_unstable_by(|a, b| b.depth.total_cmp(&a.depth).then_with(|| bits(a).cmp(&bits(b))));
    let mut color = [0.0; 3];
    let mut through = 1.0;
    for fragment in fragments.iter() {
        let share = fragment.opacity() * through;
        for (sum, c) in color.iter_mut().zip(fragment.color) {
            *sum += share * c;
        }
        through -= share;
    }
    Layer { color, through: through.max(0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearer_layer_hides_the_farther() {
        let near =
            Fragment { depth: 0.9, alpha: 0.75, color: [1.0, 0.0, 0.0], seen: 0b1111, covered: 0b1111 };
        let far = Fragment { depth: 0.1, alpha: 0.5, color: [0.0, 1.0, 0.0], seen: 0b1111, covered: 0b1111 };
        for order in [[near, far], [far, near]] {
            let layer = resolve(&mut order.clone());
            // 0.75 red, half of the rest green, half of that behind.
            assert_eq!(layer, Layer { color: [0.75, 0.125, 0.0], through: 0.125 });
        }
    }
}
