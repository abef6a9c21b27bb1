//! The definition of each transparency mode: how the fragments of a pixel are blended.
//!
//! Each is a function from all fragments of a pixel to their light and the fraction of the light behind them that they let
//! through. `Transparency::Sorted` needs no list of fragments and is in `hair::blend`.

mod exact;
mod occupancy;
mod opaque;
mod weighted;

use super::hair::list::{Fragment, Fragments};
use super::tile::HairPlanes;
use crate::Transparency;

/// The hair of one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Layer {
    /// Its light, multiplied by its coverage.
    pub color: [f32; 3],
    /// The fraction of the light behind it that it lets through.
    pub through: f32,
}

/// Blends the fragments of one pixel, which are in any order and have opacities above 0 and up to 1.
pub(crate) fn resolve(transparency: Transparency, fragments: &mut [Fragment]) -> Layer {
    match transparency {
        Transparency::Opaque => opaque::resolve(fragments),
        Transparency::WeightedAverage => weighted::resolve(fragments),
        Transparency::OccupancyOrder => occupancy::resolve(fragments),
        // Sorted segments of one pixel are sorted fragments.
        Transparency::Sorted | Transparency::Exact => exact::resolve(fragments),
    }
}

/// Blends the fragments of a whole tile.
pub(super) fn resolve_tile(transparency: Transparency, fragments: &mut Fragments, out: &mut HairPlanes) {
    let mut write = |at: usize, layer: Layer| {
        for (plane, color) in out.color.iter_mut().zip(layer.color) {
            plane[at] = color;
        }
        out.through[at] = layer.through;
    };
    if matches!(transparency, Transparency::Sorted | Transparency::Exact) {
        fragments.each_pixel_nearest_first(|at, sorted| write(at, exact::blend(sorted)));
    } else {
        fragments.each_pixel(|at, fragments| write(at, resolve(transparency, fragments)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL_SEEN: u32 = 0b1111;

    fn fragment(depth: f32, alpha: f32, grey: f32) -> Fragment {
        let covered = (1 << (alpha * 4.0 + 0.5) as u32) - 1;
        Fragment { depth, alpha, color: [grey; 3], seen: ALL_SEEN, covered }
    }

    fn modes() -> impl Iterator<Item = Transparency> {
        Transparency::ALL.into_iter()
    }

    #[test]
    fn one_opaque_layer_gives_its_own_color() {
        for mode in modes() {
            let layer = resolve(mode, &mut [fragment(0.5, 1.0, 0.7)]);
            // The occupancy estimate is normalised, so the colour differs by rounding only.
            assert!((layer.color[0] - 0.7).abs() < 1e-5 && layer.through < 1e-3, "{mode}: {layer:?}");
        }
    }

    #[test]
    fn one_layer_of_half_opacity_is_half_of_both() {
        for mode in modes() {
            let layer = resolve(mode, &mut [fragment(0.5, 0.5, 0.7)]);
            assert!((layer.color[0] - 0.35).abs() < 1e-5, "{mode}: {layer:?}");
            assert!((layer.through - 0.5).abs() < 1e-5, "{mode}: {layer:?}");
        }
    }

    #[test]
    fn layers_of_one_color_are_that_color_times_what_they_cover() {
        for mode in modes().filter(|mode| *mode != Transparency::Opaque) {
            let mut layers: Vec<_> = (1..=20).map(|i| fragment(0.01 * i as f32, 0.2, 0.5)).collect();
            let layer = resolve(mode, &mut layers);
            let through = 0.8_f32.powi(20);
            assert!((layer.through - through).abs() < 1e-5, "{mode}: {layer:?}");
            assert!((layer.color[0] - 0.5 * (1.0 - through)).abs() < 1e-5, "{mode}: {layer:?}");
        }
    }

    #[test]
    fn the_order_of_the_list_does_not_matter() {
        let layers: Vec<_> =
            (0..50).map(|i| fragment(0.01 * ((i * 17) % 50) as f32 + 0.01, 0.3, i as f32 * 0.02)).collect();
        for mode in modes() {
            let forward = resolve(mode, &mut layers.clone());
            let backward = resolve(mode, &mut layers.iter().rev().copied().collect::<Vec<_>>());
            for c in 0..3 {
                // Sums in a different order.
                assert!((forward.color[c] - backward.color[c]).abs() < 1e-5, "{mode}");
            }
        }
    }

    #[test]
    fn a_hundred_thousand_layers_and_equal_depths_are_numbers() {
        for mode in modes() {
            let mut many: Vec<_> =
                (0..100_000).map(|i| fragment(0.5, 0.01 + 0.9 * (i % 2) as f32, 0.5)).collect();
            let layer = resolve(mode, &mut many);
            assert!(layer.color.iter().all(|c| (0.0..=0.51).contains(c)), "{mode}: {layer:?}");
            assert!((0.0..=1e-3).contains(&layer.through), "{mode}: {layer:?}");
        }
    }

    #[test]
    fn what_the_body_hides_is_not_there() {
        for mode in modes() {
            let hidden = Fragment { seen: 0b0011, ..fragment(0.5, 1.0, 0.8) };
            let layer = resolve(mode, &mut [hidden]);
            assert!((layer.through - 0.5).abs() < 1e-4, "{mode}: {layer:?}");
        }
    }
}
