//! The strands of a wisp sorted into the sectors of its layers.

use glam::Vec2;

use super::face::Face;
use super::placing::Placed;
use super::settings::Grid;
use crate::features::Curl;

/// Sums over the strands of a sector.
#[derive(Clone, Copy, Default)]
struct Sums {
    amount: f32,
    s: f32,
    t: f32,
    reach: f32,
}

/// The features of all sectors of a wisp, `[sample][layer][sector]`, and the amount of hair that a part of 1 stands for, in
/// strands of full width.
pub(super) fn sort(placed: &Placed, grid: &Grid) -> (f32, Vec<Face>) {
    let mut sums = vec![Sums::default(); grid.faces()];
    for strand in placed.places.chunks_exact(placed.halves) {
        for sample in 0..grid.samples() {
            add(strand, sample, grid, &mut sums);
        }
    }
    let scale = sums.iter().map(|sum| sum.amount).fold(0.0, f32::max);
    let faces = sums.iter().map(|sum| {
        if sum.amount > 0.0 {
            let curl = Curl::of_reach(sum.reach / sum.amount);
            Face::new(sum.amount / scale, sum.s / sum.amount, sum.t / sum.amount, curl)
        } else {
            Face::default()
        }
    });
    (scale, faces.collect())
}

/// Adds a strand to the sectors of `sample` that it crosses from half a volume before it to half a volume beyond.
fn add(strand: &[(Vec2, f32)], sample: usize, grid: &Grid, sums: &mut [Sums]) {
    let middle = 2 * sample;
    let near = middle.saturating_sub(1)..(middle + 2).min(strand.len());
    let weights: f32 = near.clone().map(|half| weight(half, middle)).sum();
    let mut farthest = 0.0_f32;
    for half in near.clone() {
        for other in half + 1..near.end {
            if strand[half].1 > 0.0 && strand[other].1 > 0.0 {
                farthest = farthest.max(strand[half].0.distance(strand[other].0));
            }
        }
    }
    for half in near {
        let (place, width) = strand[half];
        let amount = width * weight(half, middle) / weights;
        if amount > 0.0 {
            let (layer, t) = grid.layer_at(place.length());
            let (sector, s) = grid.sector_at(place.to_angle());
            let sum = &mut sums[grid.face(sample, layer, sector)];
            let across = grid.radius(layer) * std::f32::consts::TAU / grid.sectors as f32;
            sum.amount += amount;
            sum.s += amount * s;
            sum.t += amount * t;
            sum.reach += amount * farthest / across;
        }
    }
}

fn weight(half: usize, middle: usize) -> f32 {
    if half == middle { 0.5 } else { 0.25 }
}
