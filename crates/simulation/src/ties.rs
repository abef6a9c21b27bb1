//! What hair ties hold: the rest shape of [`lovelock_groom::tied`] says how firmly each point is held to its place.
//!
//! The hold enters the implicit solve of shape memory as a spring to the head's frame,
//! `a = omega^2 (x_rest - x)`, so it is stable at any strength: what passes through a ring, and what is combed
//! tight before it, moves with the head, and the solve carries the pull on to the points beyond.

use lovelock_groom::Hairstyle;

use crate::lanes::{LANES, Lane};

/// The hold of each point of the guides of a block, 1/s; negative where no tie holds it.
pub(crate) fn rows(style: &Hairstyle, lanes: &[u32; LANES]) -> Vec<Lane> {
    let points = style.guides.points_per_guide;
    let of = |guide: u32, i: usize| {
        let held = style.held.get(guide as usize * points + i).copied().unwrap_or(-1.0);
        // What is not a number holds nothing.
        if held >= 0.0 { held.min(STRONGEST) } else { -1.0 }
    };
    (0..points).map(|i| Lane(std::array::from_fn(|k| of(lanes[k], i)))).collect()
}

/// A hold of 1e4 1/s moves 3 micrometres at 300 m/s^2: more is nothing but rounding.
const STRONGEST: f32 = 1e4;
