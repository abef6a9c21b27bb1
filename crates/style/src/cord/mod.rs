//! Hair that gathers onto lines: what braids, coils and locs have in common.
//!
//! 1. [`cords`]: which wisps gather, where they begin to, and the line of each cord.
//! 2. [`gather`]: the guides on their lines, as ropes that the simulation keeps together.
//! 3. [`lay`]: the strands around the lines, with points of their own, so that patterns may be finer than the links of guides.
//!
//! The strands of a cord follow the middle of their wisp. Their places across the cord are measured in the frame of its line and kept as
//! offsets in the frame of the wisp: beyond a tie both turn alike.

mod gather;
mod lay;
mod line;
mod patches;

use glam::Vec3;
use lovelock_groom::Hairstyle;

pub use gather::{Gathering, gather};
pub use lay::{CordPlace, CordStrand, lay};
pub use line::Line;

use crate::Scope;
use crate::guides::wisp_means;

/// How cords are made.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Number of cords into which loose hair divides. Hair that ties hold makes one for each tie, and loose hair then none.
    pub count: u32,
    /// Length of hair before a cord begins, from the tie or the root, metres.
    pub start: f32,
    /// Distance of lines from the body, metres.
    pub clear: f32,
}

/// Hair that gathers onto a line.
pub struct Cord {
    /// Its wisps.
    pub members: Vec<Member>,
    /// Its middle.
    pub line: Line,
}

/// A wisp of a cord.
#[derive(Clone, Copy, Debug)]
pub struct Member {
    /// Its index.
    pub wisp: usize,
    /// Where it reaches the line, in links.
    pub start: f32,
    /// Mean length of its links, metres.
    pub link: f32,
    /// Links that it has, without the cut part.
    pub links: f32,
    /// [`Scope::at`] its root.
    pub strength: f32,
}

/// Hair shorter than this beyond the start of a cord does not belong to it, metres.
const SHORTEST: f32 = 0.015;
/// Loose hair cannot gather in less than this multiple of the distance of its roots from their middle.
const SLANT: f32 = 0.9;

/// The cords of the hair on which a layer acts.
pub fn cords(style: &Hairstyle, scope: &Scope<'_>, plan: &Plan) -> Vec<Cord> {
    let strengths = scope.wisps(style);
    let means = wisp_means(style);
    let acting = |w: &usize| strengths[*w] > 0.0 && means[*w].iter().all(|p| p.is_finite());
    let wisps: Vec<usize> = (0..style.wisps.len()).filter(acting).collect();
    let ties = ties_of_wisps(style);
    let tied: Vec<usize> = wisps.iter().copied().filter(|&w| ties[w].is_some()).collect();
    let groups = if tied.is_empty() {
        let roots: Vec<Vec3> = wisps.iter().map(|&w| means[w][0]).collect();
        let groups = patches::divide(&roots, plan.count as usize);
        groups.into_iter().map(|group| group.into_iter().map(|i| wisps[i]).collect()).collect()
    } else {
        let mut groups: Vec<Vec<usize>> = vec![Vec::new(); style.ropes.len()];
        for w in tied {
            let Some((rope, _)) = ties[w] else { continue };
            groups[rope].push(w);
        }
        groups
    };
    let cord = |group: Vec<usize>| cord(style, scope, plan, &group, (&means, &ties, &strengths));
    groups.into_iter().filter_map(cord).collect()
}

type Found<'a> = (&'a [Vec<Vec3>], &'a [Option<(usize, f32)>], &'a [f32]);

fn cord(
    style: &Hairstyle,
    scope: &Scope<'_>,
    plan: &Plan,
    group: &[usize],
    (means, ties, strengths): Found<'_>,
) -> Option<Cord> {
    let roots: Vec<Vec3> = group
        .iter()
        .flat_map(|&w| style.wisps[w].guides)
        .map(|g| style.guides.point(g as usize, 0))
        .collect();
    let middle = roots.iter().sum::<Vec3>() / roots.len().max(1) as f32;
    let squares: f32 = roots.iter().map(|root| root.distance_squared(middle)).sum();
    let spread = (squares / roots.len().max(1) as f32).sqrt();
    let mut members = Vec::new();
    for &w in group {
        let mean = &means[w];
        let long = |i: &usize| mean[*i].distance(mean[*i - 1]) > 1e-6;
        let Some(links) = (1..mean.len()).rev().find(long) else { continue };
        let arc: f32 = mean[..=links].windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let link = arc / links as f32;
        let start = match ties[w] {
            Some((_, ring)) => ring + plan.start / link,
            None => plan.start.max(SLANT * spread) / link,
        };
        let links = links as f32;
        if (links - start) * link > SHORTEST {
            members.push(Member { wisp: w, start, link, links, strength: strengths[w] });
        }
    }
    if members.is_empty() {
        return None;
    }
    let line = Line::of(&members, means, scope, plan.clear);
    Some(Cord { members, line })
}

/// The rope of each wisp, and where it passes the tie, in links; none of wisps that no tie holds.
fn ties_of_wisps(style: &Hairstyle) -> Vec<Option<(usize, f32)>> {
    let mut of_guide = vec![None; style.guides.count()];
    for (r, rope) in style.ropes.iter().enumerate() {
        for (guide, beyond) in &rope.guides {
            // A tie passes between the last point before it and the first beyond it.
            of_guide[*guide as usize] = Some((r, (*beyond as f32 - 0.5).max(0.0)));
        }
    }
    let of_wisp = |guides: [u32; 3]| {
        let of = guides.map(|g| of_guide[g as usize]);
        let [Some((rope, a)), Some((_, b)), Some((_, c))] = of else { return None };
        Some((rope, (a + b + c) / 3.0))
    };
    style.wisps.iter().map(|wisp| of_wisp(wisp.guides)).collect()
}
