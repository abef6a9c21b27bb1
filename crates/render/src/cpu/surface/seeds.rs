//! The body's own shadow at every second pixel of a tile in both directions.
//!
//! Most of a body is fully lit or fully shaded. A pixel between such places has their light, and only pixels near the edge of a shadow
//! compare their depth with a map again.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use crate::MAX_LIGHTS;
use crate::cpu::tile::TILE;

/// Two samples of a pixel whose depths differ by less than this fraction show the same surface.
pub(super) const SAME_SURFACE: f32 = 0.004;

/// Places along each edge of a tile.
const SEEDS: usize = TILE / 2;

/// The share of each light that passes the body.
pub(super) type PastBody = [f32; MAX_LIGHTS];

/// What was found at the places of a tile.
#[derive(Clone, Debug)]
pub(super) struct Seeds {
    lit: [PastBody; SEEDS * SEEDS],
    /// Depth of the surface, 1 at the near plane; 0 where the light is not known.
    depth: [f32; SEEDS * SEEDS],
    /// Whether no pixel has the light of the places around it.
    pub is_exact: bool,
}

impl Default for Seeds {
    fn default() -> Self {
        Self { lit: [[0.0; MAX_LIGHTS]; SEEDS * SEEDS], depth: [0.0; SEEDS * SEEDS], is_exact: false }
    }
}

impl Seeds {
    /// Forgets all places.
    pub fn clear(&mut self) {
        self.depth.fill(0.0);
    }

    /// The place of a pixel, if it is one.
    pub fn place(x: usize, y: usize) -> Option<usize> {
        (x.is_multiple_of(2) && y.is_multiple_of(2)).then_some(y / 2 * SEEDS + x / 2)
    }

    /// Takes the light at a place, which a surface at `depth` fills.
    pub fn put(&mut self, place: usize, depth: f32, lit: PastBody) {
        (self.lit[place], self.depth[place]) = (lit, depth);
    }

    /// The light at a pixel that a surface at `depth` fills, if each light passes wholly or not at all at all places around it, and these
    /// show the same surface.
    pub fn between(&self, x: usize, y: usize, depth: f32) -> Option<PastBody> {
        let (right, below) = (x.div_ceil(2), y.div_ceil(2));
        if self.is_exact || right >= SEEDS || below >= SEEDS {
            return None;
        }
        let corners = [(x / 2, y / 2), (right, y / 2), (x / 2, below), (right, below)];
        let [first, others @ ..] = corners.map(|(x, y)| y * SEEDS + x);
        let is_same = |place: usize| (self.depth[place] - depth).abs() <= SAME_SURFACE * depth;
        let lit = self.lit[first];
        let is_whole = lit.iter().all(|share| *share == 0.0 || *share == 1.0);
        let alike = |&place: &usize| is_same(place) && self.lit[place] == lit;
        (is_whole && is_same(first) && others.iter().all(alike)).then_some(lit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_between_places_of_one_light_have_it_and_others_none() {
        let mut seeds = Seeds::default();
        assert_eq!((Seeds::place(4, 6), Seeds::place(5, 6), Seeds::place(4, 7)), (Some(50), None, None));
        let (lit, shaded) = ([1.0, 0.0, 1.0, 0.0], [0.0; MAX_LIGHTS]);
        for place in 0..SEEDS * SEEDS {
            seeds.put(place, 0.05, lit);
        }
        for (x, y) in [(1, 0), (0, 1), (1, 1), (29, 29), (30, 29)] {
            assert_eq!(seeds.between(x, y, 0.05), Some(lit), "{x} {y}");
        }
        // The last column and row have places on one side only.
        assert_eq!([seeds.between(31, 4, 0.05), seeds.between(4, 31, 0.05)], [None; 2]);
        assert_eq!(seeds.between(5, 5, 0.06), None, "another surface");
        // Another light at one place, and half a light, change the pixels around it alone.
        for other in [shaded, [0.5, 0.0, 1.0, 0.0]] {
            seeds.put(2 * SEEDS + 2, 0.05, other);
            for (x, y) in [(3, 4), (5, 4), (4, 3), (4, 5), (3, 3), (5, 5), (3, 5)] {
                assert_eq!(seeds.between(x, y, 0.05), None, "{x} {y}");
            }
            assert_eq!(seeds.between(7, 4, 0.05), Some(lit));
        }
        seeds.is_exact = true;
        assert_eq!(seeds.between(7, 4, 0.05), None);
        seeds.is_exact = false;
        seeds.clear();
        assert_eq!(seeds.between(7, 4, 0.05), None);
    }
}
