//! Cuts wisps to length.

use super::cells::Cell;
use super::comb::Comb;
use super::path::Path;
use crate::GroomSettings;
use lovelock_base::numbers::smoothstep;
use lovelock_base::random::SplitMix64;

/// The length of each wisp, metres.
///
/// The longest hair sets the height of the hem: the height at which hair of the full length from the top of the head
/// ends. Lower hair is cut at the hem; layers shorten the higher hair.
pub(super) fn lengths(settings: &GroomSettings, comb: &Comb, cells: &[Cell], paths: &[Path]) -> Vec<f32> {
    let mut ends: Vec<f32> = cells
        .iter()
        .zip(paths)
        .filter(|(cell, _)| comb.rank(cell.centre.position) > 0.75)
        .map(|(_, path)| path.at(settings.length).0.y)
        .collect();
    ends.sort_by(f32::total_cmp);
    let hem = ends.get(ends.len() / 2).copied().unwrap_or(f32::NEG_INFINITY);
    // Hair that is too short to hang has no hem; it is cut to one length everywhere.
    let hangs = smoothstep(0.08, 0.2, settings.length);

    cells
        .iter()
        .zip(paths)
        .map(|(cell, path)| {
            let root = cell.centre.position;
            let to_hem =
                path.points.iter().position(|p| p.y <= hem).map_or(settings.length, |i| i as f32 * path.step);
            let uniform = settings.length * (1.0 - 0.4 * settings.layering * (1.0 - comb.rank(root)));
            let blunt = to_hem.clamp(0.25 * settings.length, 1.08 * settings.length);
            let mut length = uniform + (blunt - uniform) * hangs;
            length *= 1.0 - 0.45 * settings.layering * comb.rank(root) * hangs;
            length *= 1.0 - 0.4 * settings.face_framing * comb.frontness(root);
            if cell.fringe > 0.0 {
                length = length.min(settings.fringe_length);
            }
            let chance = SplitMix64::of_stream(settings.seed, 0xc07_0000 + cell.stream).bell();
            (length * (1.0 + 0.5 * settings.length_variation * chance)).max(0.012)
        })
        .collect()
}
