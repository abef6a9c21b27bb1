//! Guides on the lines of their cords.

use lovelock_base::numbers::smoothstep;
use lovelock_groom::{Hairstyle, Rope};

use super::Cord;
use crate::Scope;
use crate::guides::{Lengths, reshape_where};

/// Guides of a cord are free up to this distance from its middle, metres.
const LEAST_RADIUS: f32 = 0.001;

/// How guides gather.
#[derive(Clone, Copy, Debug)]
pub struct Gathering {
    /// Length over which they reach the line, metres.
    pub join: f32,
    /// How far they gather, as a fraction.
    pub amount: f32,
    /// How firmly the simulation keeps them together, 0 to 1.
    pub tightness: f32,
}

/// Lays guides on the lines of their cords, and makes each cord a rope.
pub fn gather(style: &mut Hairstyle, scope: &Scope<'_>, cords: &[Cord], how: &Gathering) {
    let mut of_wisp = vec![None; style.wisps.len()];
    for cord in cords {
        for member in &cord.members {
            of_wisp[member.wisp] = Some((cord, *member));
        }
    }
    let mut strengths = vec![0.0; style.guides.count()];
    for member in cords.iter().flat_map(|cord| &cord.members) {
        for g in style.wisps[member.wisp].guides {
            strengths[g as usize] = member.strength;
        }
    }
    // Where the first point of each guide beyond its start lies on the line.
    reshape_where(style, scope, &strengths, Lengths::Keep, |shape| {
        let Some((cord, member)) = shape.wisp.and_then(|wisp| of_wisp[wisp]) else { return };
        let first = (member.start.ceil() as usize).max(1);
        if first >= shape.points.len() {
            return;
        }
        let near = (first as f32 - member.start) * member.link;
        let mut metres = cord.line.nearest(shape.points[first], near - 0.03, near + 0.03);
        for i in first..shape.points.len() {
            let along = scope.along(shape.place(i));
            let amount = how.amount * smoothstep(0.0, how.join.max(1e-4), metres) * member.strength * along;
            let target = cord.line.at(metres);
            shape.points[i] = shape.points[i].lerp(target, amount.clamp(0.0, 1.0));
            metres += shape.link;
        }
    });
    tie(style, cords, how);
}

/// Makes each cord a rope, in place of those that its guides belonged to.
fn tie(style: &mut Hairstyle, cords: &[Cord], how: &Gathering) {
    if how.amount * how.tightness <= 0.0 {
        return;
    }
    let mut taken = vec![false; style.guides.count()];
    let mut made = Vec::new();
    for cord in cords {
        let mut rope = Rope { tightness: how.tightness, least_radius: LEAST_RADIUS, ..Rope::default() };
        for member in &cord.members {
            let first = (member.start + how.join / member.link).ceil();
            if first >= member.links || member.strength < 0.5 {
                continue;
            }
            for g in style.wisps[member.wisp].guides {
                let near = (first - member.start) * member.link;
                let p = style.guides.point(g as usize, first as usize);
                let metres = cord.line.nearest(p, near - 0.03, near + 0.03);
                // A guide that comes from further away reaches the line later.
                let late = ((how.join - metres) / member.link).ceil().max(0.0);
                if first + late >= member.links {
                    continue;
                }
                rope.guides.push((g, (first + late) as u32));
                rope.ahead.push((metres + late * member.link - how.join).max(0.0));
                taken[g as usize] = true;
            }
        }
        made.push(rope);
    }
    for rope in &mut style.ropes {
        let of = std::mem::take(&mut rope.guides);
        let ahead = std::mem::take(&mut rope.ahead);
        for (n, guide) in of.into_iter().enumerate() {
            if !taken[guide.0 as usize] {
                rope.guides.push(guide);
                rope.ahead.extend(ahead.get(n));
            }
        }
    }
    style.ropes.extend(made);
    style.ropes.retain(|rope| !rope.guides.is_empty());
}
