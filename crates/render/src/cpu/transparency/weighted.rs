//! `weighted-average`: colours averaged by their opacity, without any order (Bavoil, Meyers 2008, "Order
//! Independent Transparency with Dual Depth Peeling").
//!
//! ```text
//! C = Σ α c / Σ α      ᾱ = Σ α / n      C (1 − (1 − ᾱ)ⁿ) + behind (1 − ᾱ)ⁿ
//! ```

use super::{Fragment, Layer};

/// The average of all fragments, blended as many times as there are fragments.
pub(super) fn resolve(fragments: &mut [Fragment]) -> Layer {
    let mut weighted = [0.0; 3];
    let mut sum = 0.0;
    for fragment in fragments.iter() {
        let alpha = fragment.opacity();
        sum += alpha;
        for (total, c) in weighted.iter_mut().zip(fragment.color) {
            *total += alpha * c;
        }
    }
    let mean = sum / fragments.len().max(1) as f32;
    let through = (1.0 - mean.min(1.0)).powi(fragments.len().min(1 << 20) as i32);
    let share = if sum > 0.0 { (1.0 - through) / sum } else { 0.0 };
    Layer { color: weighted.map(|c| c * share), through }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_are_averaged_whatever_the_order() {
        let near = Fragment { depth: 0.9, alpha: 0.5, color: [1.0, 0.0, 0.0], seen: 0b1111, covered: 0b1111 };
        let far = Fragment { depth: 0.1, alpha: 0.5, color: [0.0, 1.0, 0.0], seen: 0b1111, covered: 0b1111 };
        let layer = resolve(&mut [near, far]);
        assert_eq!(layer, Layer { color: [0.375, 0.375, 0.0], through: 0.25 });
    }
}
