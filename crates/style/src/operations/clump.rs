//! Strands that gather into locks.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::{Hairstyle, StrandSet, WispCurve};

use crate::operate::{Kind, Operate, RampInfo, Subject};
use crate::strands::displace;
use crate::{Ramp, Scope};

/// Gathers strands toward the middle strand of their lock.
#[derive(Clone, Debug, PartialEq)]
pub struct Clump {
    /// How far strands gather, as a fraction of the way to the middle strand.
    pub amount: f32,
    /// Which locks gather: 1 for wisps, 2 for their parts, 3 for the parts of those.
    pub level: u32,
    /// Parts of a lock, at levels 2 and 3.
    pub parts: u32,
    /// Factor on the amount along the strand.
    pub tightness: Ramp,
}

impl Default for Clump {
    fn default() -> Self {
        Self { amount: 0.6, level: 1, parts: 5, tightness: Ramp::default() }
    }
}

impl Settings for Clump {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, amount),
            [0.0, 1.0],
            "Amount",
            "How far strands move toward the centre of their lock. At 100 % they meet.",
        )
        .unit(Unit::FRACTION),
        Setting::count(
            field!(Self, level),
            [1, 3],
            "Level",
            "Size of the locks: 1 is whole wisps, 2 parts of wisps, 3 parts of those parts.",
        ),
        Setting::count(
            field!(Self, parts),
            [2, 20],
            "Parts",
            "Number of smaller locks into which each lock divides at levels 2 and 3.",
        ),
    ];
}

impl Operate for Clump {
    const KIND: Kind = Kind {
        id: "clump",
        label: "Clump",
        text: "Gathers strands toward the centre of their lock.",
        subject: Subject::Strands,
    };
    const RAMPS: &'static [RampInfo] = &[RampInfo {
        name: "tightness",
        label: "Tightness along the hair",
        text: "Multiplies the amount along the hair.",
    }];

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        if self.amount == 0.0 {
            return;
        }
        let middles = middles(&style.strands, self.level, self.parts as usize);
        let curves: Vec<WispCurve> =
            style.wisps.iter().map(|wisp| WispCurve::at_rest(&style.guides, wisp)).collect();
        let old = style.strands.clone();
        let last = (style.guides.points_per_guide - 1) as f32;
        displace(style, scope, |point| {
            let middle = middles[point.strand];
            if middle == point.strand {
                return point.offset;
            }
            let end = old.first_point[point.strand + 1];
            let u = (point.place * old.guide_param[end as usize - 1]).min(last);
            let curve = &curves[point.wisp];
            let apart = curve.blend(old.weights[middle], u) - curve.blend(old.weights[point.strand], u);
            let target = curve.frame(u).transpose() * apart + offset_at(&old, middle, u);
            let amount = self.amount
                * point.strength
                * scope.along(point.place)
                * self.tightness.at(point.place)
                * smoothstep(0.05, 0.6, point.place);
            point.offset.lerp(target, amount.clamp(0.0, 1.0))
        });
    }

    fn ramp(&self, _index: usize) -> &Ramp {
        &self.tightness
    }

    fn ramp_mut(&mut self, _index: usize) -> &mut Ramp {
        &mut self.tightness
    }
}

/// The offset of a strand at the guides' parameter `u`: that of its tip beyond the tip.
fn offset_at(set: &StrandSet, strand: usize, u: f32) -> Vec3 {
    let (first, end) = (set.first_point[strand] as usize, set.first_point[strand + 1] as usize);
    let offset = |i: usize| Vec3::new(set.offset_normal[i], set.offset_binormal[i], set.offset_tangent[i]);
    let next = first + set.guide_param[first..end].partition_point(|&own| own < u);
    if next == first {
        return offset(first);
    }
    if next == end {
        return offset(end - 1);
    }
    let (a, b) = (set.guide_param[next - 1], set.guide_param[next]);
    offset(next - 1).lerp(offset(next), (u - a) / (b - a).max(1e-9))
}

/// The middle strand of the lock of each strand.
fn middles(set: &StrandSet, level: u32, parts: usize) -> Vec<usize> {
    let mut out: Vec<usize> = (0..set.count()).collect();
    let strands: Vec<usize> = (0..set.count()).collect();
    for members in strands.chunk_by(|&a, &b| set.wisp[a] == set.wisp[b]) {
        let mut locks = vec![members.to_vec()];
        for _ in 1..level {
            locks = locks.iter().flat_map(|lock| divided(set, lock, parts)).collect();
        }
        for lock in locks {
            let mean = |g: usize| lock.iter().map(|&i| set.weights[i][g]).sum::<f32>() / lock.len() as f32;
            let mean = [mean(0), mean(1), mean(2)];
            let nearest = lock
                .iter()
                .min_by(|a, b| apart(set.weights[**a], mean).total_cmp(&apart(set.weights[**b], mean)));
            if let Some(&middle) = nearest {
                for &strand in &lock {
                    out[strand] = middle;
                }
            }
        }
    }
    out
}

/// A lock divided into at most `parts`: each strand belongs to the nearest of a few strands, by its weights.
fn divided(set: &StrandSet, lock: &[usize], parts: usize) -> Vec<Vec<usize>> {
    let step = lock.len().div_ceil(parts.max(1)).max(1);
    let centres: Vec<[f32; 3]> = lock.iter().step_by(step).map(|&i| set.weights[i]).collect();
    let mut out = vec![Vec::new(); centres.len()];
    for &strand in lock {
        let own = set.weights[strand];
        let nearest =
            (0..centres.len()).min_by(|&a, &b| apart(centres[a], own).total_cmp(&apart(centres[b], own)));
        out[nearest.unwrap_or(0)].push(strand);
    }
    out.retain(|part| !part.is_empty());
    out
}

fn apart(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|g| (a[g] - b[g]).powi(2)).sum()
}
