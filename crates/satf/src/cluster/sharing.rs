//! Macro-clusters: clusters whose hair lies alike share one set of features (Xu et al., "SATF", section 3.1).

use super::face::Face;
use super::settings::Grid;

/// Bands along a cluster in its summary.
const BANDS: usize = 4;

/// The hair of a cluster before sharing.
pub(super) struct Own {
    pub(super) scale: f32,
    pub(super) faces: Vec<Face>,
}

/// Features shared among clusters.
pub(super) struct Shared {
    /// The set of each cluster.
    pub(super) set_of: Vec<u32>,
    /// The amount that a part of 1 stands for in each cluster.
    pub(super) scales: Vec<f32>,
    /// The features of all sets.
    pub(super) faces: Vec<Face>,
}

/// A set's number, its parts' sum, and the shares of its bands and layers.
struct Summary {
    total: f32,
    shares: Vec<f32>,
}

impl Summary {
    fn of(faces: &[Face], grid: &Grid) -> Self {
        let mut shares = vec![0.0; BANDS * grid.layers];
        for (i, face) in faces.iter().enumerate() {
            let (row, sample) = (i / grid.sectors, i / (grid.sectors * grid.layers));
            shares[sample * BANDS / grid.samples() * grid.layers + row % grid.layers] += face.part();
        }
        let total: f32 = shares.iter().sum();
        if total > 0.0 {
            for share in &mut shares {
                *share /= total;
            }
        }
        Self { total, shares }
    }
}

/// Lets each cluster use the first set of another one that differs by at most `tolerance`: the part of its hair that would
/// have to move. Its amount of hair remains its own.
pub(super) fn share(clusters: &[Own], grid: &Grid, tolerance: f32) -> Shared {
    let mut out = Shared { set_of: Vec::new(), scales: Vec::new(), faces: Vec::new() };
    let mut summaries: Vec<Summary> = Vec::new();
    for own in clusters {
        let summary = Summary::of(&own.faces, grid);
        let like = summaries.iter().enumerate().position(|(set, of_set)| {
            let theirs = &out.faces[set * grid.faces()..][..grid.faces()];
            // Summing up never makes a difference larger: most sets are excluded by the summary.
            moved(&summary.shares, &of_set.shares) <= tolerance
                && difference(&own.faces, summary.total, theirs, of_set.total) <= tolerance
        });
        if let Some(set) = like {
            let theirs = summaries[set].total;
            out.scales.push(if theirs > 0.0 { own.scale * summary.total / theirs } else { 0.0 });
            out.set_of.push(set as u32);
        } else {
            out.scales.push(own.scale);
            out.set_of.push(summaries.len() as u32);
            out.faces.extend_from_slice(&own.faces);
            summaries.push(summary);
        }
    }
    out
}

/// The part of a distribution that has to move to make it another one.
fn moved(a: &[f32], b: &[f32]) -> f32 {
    0.5 * a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f32>()
}

fn difference(a: &[Face], total_a: f32, b: &[Face], total_b: f32) -> f32 {
    let (over_a, over_b) = (1.0 / total_a.max(1e-9), 1.0 / total_b.max(1e-9));
    0.5 * a.iter().zip(b).map(|(a, b)| (a.part() * over_a - b.part() * over_b).abs()).sum::<f32>()
}
