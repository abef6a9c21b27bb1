//! `exact`: all fragments of a pixel, sorted and blended, which is the result of depth peeling (Everitt 2001).

use super::{Fragment, Layer};
use crate::cpu::hair::list::nearest_first;
use crate::cpu::tile::OPAQUE;

/// Sorts the fragments and blends them.
pub(super) fn resolve(fragments: &mut [Fragment]) -> Layer {
    fragments.sort_unstable_by(nearest_first);
    blend(fragments)
}

/// Blends fragments in the order of [`nearest_first`], until the pixel is opaque.
pub(super) fn blend(fragments: &[Fragment]) -> Layer {
    let mut color = [0.0; 3];
    let mut through = 1.0;
    for fragment in fragments {
        if through <= OPAQUE {
            break;
        }
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
