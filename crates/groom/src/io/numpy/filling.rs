//! Points that fill the rows of an array behind shorter strands.

use std::collections::HashMap;

use glam::Vec3;
use lovelock_base::words::counted;

use crate::io::file::RawHair;

/// A filling point is this many times farther from the strand than its points are from each other.
const JUMP: f32 = 2.0;

/// Ends strands where no number follows, and where only copies of one point follow that is zero or the end of several strands. A strand whose
/// points lead there, as those of a tail lead to its tie, keeps it.
pub(super) fn end_strands(raw: &mut RawHair) {
    let mut ends: Vec<usize> = Vec::with_capacity(raw.point_counts.len());
    let mut number_of: HashMap<[u32; 3], u32> = HashMap::new();
    let all = std::mem::take(&mut raw.points);
    let counts = std::mem::take(&mut raw.point_counts);
    for strand in strands_of(&all, &counts) {
        let end = strand.iter().rposition(|point| point.is_finite()).map_or(strand.len(), |last| last + 1);
        ends.push(end);
        if let Some(&last) = strand[..end].last() {
            *number_of.entry(bits(last)).or_default() += 1;
        }
    }
    let mut filled = 0_u64;
    for (strand, end) in strands_of(&all, &counts).zip(ends) {
        let strand = &strand[..end];
        let is_filling = |point: Vec3| {
            point == Vec3::ZERO || number_of.get(&bits(point)).is_some_and(|&number| number > 1)
        };
        let end = match strand.last() {
            Some(&last) if is_filling(last) => end_before(strand, last),
            _ => end,
        };
        filled += u64::from(end < strand.len());
        raw.points.extend(&strand[..end]);
        raw.point_counts.push(end as u32);
    }
    if filled > 0 {
        let strands = counted(filled, "strand ends", "strands end");
        raw.notes
            .push(format!("{strands} with copies of one point, which fill the array and were left out."));
    }
}

fn strands_of<'a>(points: &'a [Vec3], counts: &'a [u32]) -> impl Iterator<Item = &'a [Vec3]> {
    let mut rest = points;
    counts.iter().map(move |&count| {
        let (strand, after) = rest.split_at((count as usize).min(rest.len()));
        rest = after;
        strand
    })
}

fn bits(point: Vec3) -> [u32; 3] {
    // Both zeros are the same place.
    (point + Vec3::ZERO).to_array().map(f32::to_bits)
}

/// The number of points before the copies of `last` at the end of a strand, or all if the strand leads there.
fn end_before(strand: &[Vec3], last: Vec3) -> usize {
    let end = strand.iter().rposition(|&point| point != last).map_or(0, |before| before + 1);
    let longest = strand[..end].array_windows().map(|[a, b]| a.distance(*b)).fold(0.0, f32::max);
    match strand[..end].last() {
        Some(before) if before.distance(last) <= JUMP * longest => strand.len(),
        _ => end,
    }
}
