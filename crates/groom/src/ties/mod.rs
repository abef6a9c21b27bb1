//! Hair ties: a ponytail or a bun as a second rest shape of the same guides.
//!
//! 1. [`HairTie`]: the settings of a tie.
//! 2. [`route`]: the path of each wisp's middle over the head to the ring, pulled tight around the skull, and beyond
//!    the ring as a tail or wound up as a bun.
//! 3. [`lay`]: the wisp's guides along that path, outside the body, with unchanged link lengths.
//! 4. [`left_out`]: wisps that are too short for the ring, which lie on the head.
//! 5. [`offsets`]: the strands' offsets, flattened before the ring.
//!
//! [`Hairstyle::held`] lists for the simulator which points the tie holds, and [`Hairstyle::ropes`] which hair stays
//! together beyond it.

mod lay;
mod left_out;
mod offsets;
mod route;
mod settings;

use glam::Vec3;
use rayon::prelude::*;

pub use settings::{HairTie, TieKind, TieReach};

use crate::frame::widest_radii;
use crate::{Bounded, Hairstyle, Obstacle, Rope, Wisp};
use left_out::LeftOut;
use route::Ring;

/// How firmly a tie holds the hair inside it, 1/s: an acceleration of 300 m/s^2 moves the hair by 0.02 mm.
const RING_HOLD: f32 = 4000.0;
/// How firmly hair is held on the head before the tie, and in a bun, 1/s, at a tightness of 0 and 1.
const TAUT_HOLD: [f32; 2] = [60.0, 1000.0];
/// Hair must be this much longer than the distance to the ring to be gathered, metres.
const CAUGHT: f32 = 0.02;

/// A wisp that a ring gathers.
struct Gathered {
    wisp: usize,
    ring: usize,
    /// Its position in the ring, whose opening is the unit disc.
    disc: [f32; 2],
    /// Fraction of the gathered hair that lies below it, 0 to 1.
    layer: f32,
}

/// `style` with its hair gathered by `ties` into ponytails or buns at rest, with the same number of guides and points
/// and the same lengths. A wisp goes to the first tie that includes it and that all its guides can reach. One that is too
/// short for the ties that include it lies on the head where the hair around it is gathered; the other wisps stay as they
/// are. Only the first [`HairTie::MAX`] ties count. `obstacle` is the body without hair.
#[must_use]
pub fn tied(style: &Hairstyle, ties: &[HairTie], obstacle: &dyn Obstacle) -> Hairstyle {
    tied_where(style, ties, obstacle, |_| true)
}

/// As [`tied`], of the wisps for whose root, the middle of those of its guides in head space, `includes` is true. Wisps that a tie
/// holds already stay with it.
#[must_use]
pub fn tied_where(
    style: &Hairstyle,
    ties: &[HairTie],
    obstacle: &dyn Obstacle,
    includes: impl Fn(Vec3) -> bool,
) -> Hairstyle {
    let mut out = style.clone();
    let points = style.guides.points_per_guide;
    let Some((middle, half)) = style.scalp.hairy_box() else { return out };
    if ties.is_empty() || points < 3 {
        return out;
    }
    let obstacle = &Bounded(obstacle);
    let longest = (0..style.guides.count()).map(|g| lay::length(&style.guides, g)).fold(0.0, f32::max);
    if !longest.is_finite() {
        return out;
    }
    let rings: Vec<Ring> =
        ties.iter().take(HairTie::MAX).map(|tie| Ring::new(tie, obstacle, longest)).collect();
    let ears = middle.z - 0.1 * half.z;
    // From below the middle, the shortest path over the head crosses its top.
    let middle = middle - Vec3::Y * (0.5 * half.y);
    let (gathered, mut left) = gather(style, &rings, ears, includes);

    let laid: Vec<Option<lay::GatheredHair>> = gathered
        .par_iter()
        .map(|caught| lay::wisp(style, &rings[caught.ring], caught, middle, obstacle))
        .collect();
    let mut caught = Vec::new();
    out.held.resize(style.guides.x.len(), -1.0);
    let first_rope = out.ropes.len();
    out.ropes.extend(rings.iter().map(|ring| Rope { tightness: ring.tie.tightness, ..Rope::default() }));
    for (of, laid) in gathered.iter().zip(laid) {
        let Some(laid) = laid else {
            left.push(LeftOut { wisp: of.wisp, ring: of.ring });
            continue;
        };
        let tie = &rings[of.ring].tie;
        let taut = TAUT_HOLD[0] + (TAUT_HOLD[1] - TAUT_HOLD[0]) * tie.tightness;
        for (n, &guide) in style.wisps[of.wisp].guides.iter().enumerate() {
            let first = guide as usize * points;
            for (i, p) in laid.guides[n].iter().enumerate() {
                (out.guides.x[first + i], out.guides.y[first + i], out.guides.z[first + i]) = (p.x, p.y, p.z);
                let through = laid.ring_point[n];
                out.held[first + i] = match tie.kind {
                    _ if i + 1 == through || i == through => RING_HOLD,
                    _ if i < through => taut,
                    TieKind::Bun => taut,
                    TieKind::Ponytail => 0.0,
                };
            }
        }
        if tie.kind == TieKind::Ponytail {
            let guides = style.wisps[of.wisp].guides;
            let beyond = laid.ring_point.map(|i| i as u32 + 1);
            out.ropes[first_rope + of.ring].guides.extend(guides.into_iter().zip(beyond));
        }
        caught.push((of, laid));
    }
    let is_tied = |wisp: &Wisp| {
        let first = wisp.guides[0] as usize * points;
        out.held[first..first + points].iter().any(|hold| *hold >= 0.0)
    };
    let is_tied: Vec<bool> = style.wisps.iter().map(is_tied).collect();
    let lain = left_out::lain(style, &left, &is_tied, &rings, obstacle);
    for (wisp, guides) in &lain {
        for (&guide, of_guide) in style.wisps[*wisp].guides.iter().zip(guides) {
            let first = guide as usize * points;
            for (i, p) in of_guide.iter().enumerate() {
                (out.guides.x[first + i], out.guides.y[first + i], out.guides.z[first + i]) = (p.x, p.y, p.z);
            }
        }
    }
    out.ropes.retain(|rope| !rope.guides.is_empty());
    // The larger limit, so that strands neither narrow at once when a tie is made, nor at rest in a wide bun.
    if !out.widest.is_empty() {
        for (widest, tied) in out.widest.iter_mut().zip(widest_radii(&out.guides, &out.wisps)) {
            *widest = widest.max(tied);
        }
    }
    let first_of = |wisp: usize| style.strands.first_point[style.wisps[wisp].first_strand as usize] as usize;
    let of_caught = caught.par_iter().map(|(of, laid)| {
        let tie = &rings[of.ring].tie;
        (first_of(of.wisp), offsets::of_wisp(style, &out, of.wisp, laid, tie, obstacle))
    });
    let of_lain = lain
        .par_iter()
        .map(|(wisp, _)| (first_of(*wisp), offsets::of_left_out(style, &out, *wisp, obstacle)));
    let moved: Vec<(usize, Vec<Vec3>)> = of_caught.chain(of_lain).collect();
    for (first, offsets) in moved {
        for (k, offset) in offsets.into_iter().enumerate() {
            let set = &mut out.strands;
            set.offset_normal[first + k] = offset.x;
            set.offset_binormal[first + k] = offset.y;
            set.offset_tangent[first + k] = offset.z;
        }
    }
    out
}

/// The ring of each wisp and its position in that ring: hair from far away lies around hair from nearby, on the side
/// that it comes from. Also the wisps that rings include and that are too short for them.
fn gather(
    style: &Hairstyle,
    rings: &[Ring],
    ears: f32,
    includes: impl Fn(Vec3) -> bool,
) -> (Vec<Gathered>, Vec<LeftOut>) {
    let root_of = |wisp: &Wisp| root_of(style, wisp);
    let mut out = Vec::new();
    let held = |wisp: &Wisp| {
        let first = wisp.guides[0] as usize * style.guides.points_per_guide;
        style
            .held
            .get(first..first + style.guides.points_per_guide)
            .is_some_and(|of| of.iter().any(|v| *v >= 0.0))
    };
    let mut taken: Vec<bool> =
        style.wisps.iter().map(|wisp| held(wisp) || !includes(root_of(wisp))).collect();
    let mut short: Vec<Option<usize>> = vec![None; style.wisps.len()];
    for (r, ring) in rings.iter().enumerate() {
        let mut of_ring: Vec<(f32, usize, Vec3)> = Vec::new();
        for (w, wisp) in style.wisps.iter().enumerate() {
            let root = root_of(wisp);
            if taken[w] || !root.is_finite() || !ring.tie.includes(root, ears) {
                continue;
            }
            let straight = root.distance(ring.centre);
            let shortest =
                wisp.guides.iter().map(|&g| lay::length(&style.guides, g as usize)).fold(f32::MAX, f32::min);
            if shortest > straight + CAUGHT {
                of_ring.push((straight, w, root));
            } else {
                short[w].get_or_insert(r);
            }
        }
        of_ring.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let count = of_ring.len() as f32;
        for (rank, (_, w, root)) in of_ring.into_iter().enumerate() {
            let layer = (rank as f32 + 0.5) / count;
            let from = root - ring.centre;
            let angle = from.dot(ring.across[1]).atan2(from.dot(ring.across[0]));
            // Leaves some of the ring to the width of the wisps themselves.
            let out_of_middle = 0.8 * layer.sqrt();
            let disc = [out_of_middle * angle.cos(), out_of_middle * angle.sin()];
            taken[w] = true;
            out.push(Gathered { wisp: w, ring: r, disc, layer });
        }
    }
    let left = short.into_iter().enumerate().filter(|(w, _)| !taken[*w]);
    let left = left.filter_map(|(wisp, ring)| Some(LeftOut { wisp, ring: ring? })).collect();
    (out, left)
}

/// The middle of the roots of a wisp's guides, head space.
fn root_of(style: &Hairstyle, wisp: &Wisp) -> Vec3 {
    wisp.guides.iter().map(|&g| style.guides.point(g as usize, 0)).sum::<Vec3>() / 3.0
}

#[cfg(test)]
mod tests;
