//! Strands around the lines of their cords.

use glam::{Vec2, Vec3};
use lovelock_base::numbers::smoothstep;
use lovelock_groom::{Guides, Hairstyle, WispCurve};
use rayon::prelude::*;

use super::{Cord, Member};
use crate::Scope;
use crate::strands::{refine_where, slices};

/// Rows of a wisp's table for each link.
const ROWS: f32 = 6.0;
/// Distance over which a strand's root blends into the curve of its guides, metres.
const ROOT_JOIN: f32 = 0.02;
/// The share of strands that reaches the end of a cord.
const REACHES_END: f32 = 0.2;

/// A strand of a cord.
#[derive(Clone, Copy, Debug)]
pub struct CordStrand {
    /// Its rank by the angle of its root around the line, as a fraction of all strands of the cord.
    pub rank: f32,
    /// Where all but a fifth of the strands of its cord have ended, metres from the start.
    pub end: f32,
    /// A place in the unit disc, by chance.
    pub disc: Vec2,
    /// Numbers by chance, 0 to 1.
    pub chance: [f32; 4],
}

/// Where a strand runs at a place of the line.
#[derive(Clone, Copy, Debug)]
pub struct CordPlace {
    /// Place across the cord: to the side, and toward the head, metres.
    pub place: Vec2,
    /// The share of its own place that is kept, 0 to 1.
    pub own: f32,
}

/// Lays the strands of cords, whose guides were `before` until they gathered: `place` returns where a strand runs at a distance from the start of its cord, metres. They take that place
/// over `join` metres, and no segment of theirs is longer than `segment` beyond the start.
pub fn lay(
    style: &mut Hairstyle,
    before: &Guides,
    scope: &Scope<'_>,
    cords: &[Cord],
    (join, segment): (f32, f32),
    place: impl Fn(&Cord, &CordStrand, f32) -> CordPlace + Sync,
) {
    let mut members: Vec<Option<(usize, Member)>> = vec![None; style.wisps.len()];
    for (c, cord) in cords.iter().enumerate() {
        for member in &cord.members {
            members[member.wisp] = Some((c, *member));
        }
    }
    let of = &members;
    let wisp_of: Vec<u32> = style.strands.wisp.clone();
    refine_where(style, |strand| {
        of[wisp_of[strand] as usize].map(|(_, member)| (member.start - 1.0, segment))
    });
    let tables: Vec<Option<Table>> = members
        .par_iter()
        .map(|member| member.as_ref().map(|(c, member)| Table::new(style, &cords[*c], member)))
        .collect();
    let strands = strands_of(style, scope, cords, &tables);
    let even = scope.is_even();
    let set = &mut style.strands;
    let firsts: Vec<u32> = style
        .wisps
        .iter()
        .map(|wisp| set.first_point[wisp.first_strand as usize])
        .chain([set.guide_param.len() as u32])
        .collect();
    let normals = slices(&mut set.offset_normal, &firsts);
    let binormals = slices(&mut set.offset_binormal, &firsts);
    let tangents = slices(&mut set.offset_tangent, &firsts);
    let (params, first_point, all_weights) = (&set.guide_param, &set.first_point, &set.weights);
    let wisps = &style.wisps;
    let offsets = normals.into_par_iter().zip(binormals).zip(tangents).enumerate();
    offsets.for_each(|(w, ((normal, binormal), tangent))| {
        let (Some((c, member)), Some(table)) = (members[w], &tables[w]) else { return };
        let (cord, wisp) = (&cords[c], &wisps[w]);
        let old_curve = WispCurve::at_rest(before, wisp);
        let first = firsts[w] as usize;
        for strand in wisp.first_strand as usize..(wisp.first_strand + wisp.strand_count) as usize {
            let points = first_point[strand] as usize..first_point[strand + 1] as usize;
            let weights = all_weights[strand];
            let of_strand = &strands[strand];
            let end = params[points.end - 1].max(1e-6);
            let u0 = params[points.start];
            let k = points.start - first;
            let offset = Vec3::new(normal[k], binormal[k], tangent[k]);
            let root = old_curve.point(weights, u0, offset);
            let moved =
                table.curve.offset_to([1.0 / 3.0; 3], u0, root) - (table.at(u0).apart(weights) + offset);
            for i in points {
                let k = i - first;
                let offset = Vec3::new(normal[k], binormal[k], tangent[k]);
                let u = params[i];
                let row = table.at(u);
                let back = (1.0 - u * member.link / ROOT_JOIN).max(0.0);
                let along = if even { 1.0 } else { scope.along(u / end) };
                let amount = (smoothstep(0.0, join, row.metres) * member.strength * along).clamp(0.0, 1.0);
                let own_place = || row.apart(weights) + offset;
                let new = if amount > 0.0 {
                    let CordPlace { place, own } = place(cord, of_strand, row.metres);
                    let mut target = row.to_line + row.side * place.x + row.deep * place.y;
                    if own > 0.0 {
                        target += (own_place() - row.to_line) * own;
                    }
                    if amount < 1.0 {
                        (own_place() + moved * (back * back)).lerp(target, amount)
                    } else {
                        target
                    }
                } else {
                    own_place() + moved * (back * back)
                };
                if new.is_finite() {
                    (normal[k], binormal[k], tangent[k]) = (new.x, new.y, new.z);
                }
            }
        }
    });
    for (strand, wisp) in wisp_of.iter().enumerate() {
        if members[*wisp as usize].is_some() {
            set.weights[strand] = [1.0 / 3.0; 3];
        }
    }
}

/// The strands of cords; those of others are empty.
fn strands_of(
    style: &Hairstyle,
    scope: &Scope<'_>,
    cords: &[Cord],
    tables: &[Option<Table>],
) -> Vec<CordStrand> {
    let set = &style.strands;
    let none = CordStrand { rank: 0.0, end: 0.0, disc: Vec2::ZERO, chance: [0.0; 4] };
    let mut out = vec![none; set.count()];
    for cord in cords {
        let middle = cord.line.at(0.0);
        let (side, deep) = cord.line.frame(0.0);
        let mut angles: Vec<(f32, usize)> = Vec::new();
        let mut ends: Vec<f32> = Vec::new();
        for member in &cord.members {
            let wisp = &style.wisps[member.wisp];
            let roots = wisp.guides.map(|g| style.guides.point(g as usize, 0));
            for strand in wisp.first_strand as usize..(wisp.first_strand + wisp.strand_count) as usize {
                let last = set.guide_param[set.first_point[strand + 1] as usize - 1];
                ends.extend(tables[member.wisp].as_ref().map(|table| table.at(last).metres.max(0.0)));
                let w = set.weights[strand];
                let from = roots[0] * w[0] + roots[1] * w[1] + roots[2] * w[2] - middle;
                angles.push((from.dot(side).atan2(from.dot(deep)), strand));
            }
        }
        angles.sort_by(|a, b| a.0.total_cmp(&b.0));
        let count = angles.len() as f32;
        let end = if ends.is_empty() {
            0.0
        } else {
            let rank = (((1.0 - REACHES_END) * count) as usize).min(ends.len() - 1);
            *ends.select_nth_unstable_by(rank, f32::total_cmp).1
        };
        for (n, (_, strand)) in angles.into_iter().enumerate() {
            let mut random = scope.random(0, strand);
            let (angle, radius) = (random.angle(), random.unit().sqrt());
            let disc = Vec2::from_angle(angle) * radius;
            let chance = [(); 4].map(|()| random.unit());
            out[strand] = CordStrand { rank: n as f32 / count, end, disc, chance };
        }
    }
    out
}

/// What the strands of a wisp have in common at places along it.
struct Table {
    curve: WispCurve,
    rows: Vec<Row>,
}

/// Vectors in the frame of a wisp.
#[derive(Clone, Copy)]
struct Row {
    /// Place along the line, metres.
    metres: f32,
    /// From the middle of the wisp to the line.
    to_line: Vec3,
    /// The directions of the line's frame.
    side: Vec3,
    deep: Vec3,
    /// From the middle of the wisp to its guides.
    guides: [Vec3; 3],
}

impl Row {
    /// From the middle of the wisp to the curve that weights blend.
    fn apart(&self, w: [f32; 3]) -> Vec3 {
        self.guides[0] * w[0] + self.guides[1] * w[1] + self.guides[2] * w[2]
    }
}

impl Table {
    fn new(style: &Hairstyle, cord: &Cord, member: &Member) -> Self {
        let curve = WispCurve::at_rest(&style.guides, &style.wisps[member.wisp]);
        let links = (style.guides.points_per_guide - 1) as f32;
        let count = (links * ROWS) as usize;
        let mut rows = Vec::with_capacity(count + 1);
        let mut before: Option<(f32, Vec3)> = None;
        for k in 0..=count {
            let u = k as f32 / ROWS;
            let frame = curve.frame(u).transpose();
            let middle = curve.blend([1.0 / 3.0; 3], u);
            let metres = match before {
                _ if u < member.start - 1.0 => (u - member.start) * member.link,
                None => {
                    let near = (u - member.start) * member.link;
                    cord.line.nearest(middle, near - 0.03, near + 0.03)
                }
                Some((metres, last)) => {
                    let step = middle.distance(last);
                    cord.line.nearest(middle, metres, metres + 1.5 * step).max(metres)
                }
            };
            if u >= member.start - 1.0 {
                before = Some((metres, middle));
            }
            let (side, deep) = cord.line.frame(metres);
            let guide = |g: usize| {
                let mut weights = [0.0; 3];
                weights[g] = 1.0;
                frame * (curve.blend(weights, u) - middle)
            };
            rows.push(Row {
                metres,
                to_line: frame * (cord.line.at(metres) - middle),
                side: frame * side,
                deep: frame * deep,
                guides: [guide(0), guide(1), guide(2)],
            });
        }
        Self { curve, rows }
    }

    fn at(&self, u: f32) -> Row {
        let at = (u * ROWS).clamp(0.0, (self.rows.len() - 1) as f32);
        let i = (at as usize).min(self.rows.len() - 2);
        let (a, b, t) = (&self.rows[i], &self.rows[i + 1], at - i as f32);
        Row {
            metres: a.metres + (b.metres - a.metres) * t,
            to_line: a.to_line.lerp(b.to_line, t),
            side: a.side.lerp(b.side, t),
            deep: a.deep.lerp(b.deep, t),
            guides: [0, 1, 2].map(|g| a.guides[g].lerp(b.guides[g], t)),
        }
    }
}
