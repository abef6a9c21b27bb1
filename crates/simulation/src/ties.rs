//! Hair ties: how strongly each point is held in its place in the rest shape of [`lovelock_groom::tied`].
//!
//! A tie enters the implicit solve of shape memory as a spring to the head's frame,
//! `a = omega^2 (x_rest - x)`, so it is stable at any strength. Hair that passes through a ring, or is combed
//! tight before it, moves with the head, and the solve transmits the pull to the points beyond.

use lovelock_groom::Hairstyle;

use crate::lanes::{LANES, Lane};

/// The tie strength at each point of the guides of a block, 1/s; negative where no tie holds it.
pub(crate) fn rows(style: &Hairstyle, lanes: &[u32; LANES]) -> Vec<Lane> {
    let points = style.guides.points_per_guide;
    let of = |guide: u32, i: usize| {
        let held = style.held.get(guide as usize * points + i).copied().unwrap_or(-1.0);
        // NaN holds nothing.
        if held >= 0.0 { held.min(MAX_HOLD) } else { -1.0 }
    };
    (0..points).map(|i| Lane(std::array::from_fn(|k| of(lanes[k], i)))).collect()
}

/// A strength of 1e4 1/s gives way by 3 micrometres at 300 m/s^2; anything beyond is below rounding.
const MAX_HOLD: f32 = 1e4;
