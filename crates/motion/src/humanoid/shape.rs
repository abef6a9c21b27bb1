//! The roles of joints told by the shape of the skeleton, where names do not tell them: two pairs of equal limbs on a trunk.

use glam::Vec3;

use super::{Role, Side, common_ancestor, depths};

/// Largest difference between the lengths of two bones that mirror each other, as a fraction.
const ALIKE: f32 = 0.15;
/// Shortest limb, as a fraction of the longest chain of bones.
const SHORTEST_LIMB: f32 = 0.25;

/// A pair of limbs that leave one joint.
#[derive(Clone, Debug)]
struct Pair {
    from: usize,
    limbs: [Vec<usize>; 2],
    length: f32,
}

/// A tree of joints with their places at rest.
pub(super) struct Shape<'a> {
    parents: &'a [Option<usize>],
    places: &'a [Vec3],
    children: Vec<Vec<usize>>,
    depth: Vec<usize>,
    /// Length of the longest chain of bones below each joint.
    reach: Vec<f32>,
}

impl<'a> Shape<'a> {
    pub(super) fn new(parents: &'a [Option<usize>], places: &'a [Vec3]) -> Self {
        let mut children = vec![Vec::new(); parents.len()];
        let mut reach = vec![0.0_f32; parents.len()];
        for (j, parent) in parents.iter().enumerate().rev() {
            if let &Some(parent) = parent {
                children[parent].push(j);
                reach[parent] = reach[parent].max(reach[j] + places[j].distance(places[parent]));
            }
        }
        Self { parents, places, children, depth: depths(parents), reach }
    }

    /// Length of the bone that ends at a joint.
    fn bone(&self, joint: usize) -> f32 {
        self.parents[joint].map_or(0.0, |parent| self.places[joint].distance(self.places[parent]))
    }

    /// The longest chain of bones from a joint on.
    fn chain(&self, from: usize) -> Vec<usize> {
        let mut chain = vec![from];
        let mut at = from;
        let length = |&joint: &usize| self.reach[joint] + self.bone(joint);
        while let Some(&next) =
            self.children[at].iter().max_by(|a, b| length(a).total_cmp(&length(b)).then(b.cmp(a)))
        {
            chain.push(next);
            at = next;
        }
        chain
    }

    /// Whether two limbs consist of equal bones.
    fn are_twins(&self, a: &[usize], b: &[usize]) -> bool {
        // Fingers and toes may differ.
        let of_limb = a.len().min(b.len()).min(5);
        of_limb >= 3
            && a.len().abs_diff(b.len()) <= 1
            && a[..of_limb].iter().zip(&b[..of_limb]).skip(1).all(|(&a, &b)| {
                let (a, b) = (self.bone(a), self.bone(b));
                (a - b).abs() <= ALIKE * a.max(b) + 1e-6
            })
            && self.places[a[0]].distance(self.places[b[0]]) <= 0.5 * self.longest()
    }

    fn longest(&self) -> f32 {
        self.reach.iter().copied().fold(0.0, f32::max)
    }

    /// The pairs of limbs, longest first.
    fn pairs(&self) -> Vec<Pair> {
        let least = SHORTEST_LIMB * self.longest();
        let mut pairs = Vec::new();
        for (from, children) in self.children.iter().enumerate() {
            let limbs: Vec<Vec<usize>> = children
                .iter()
                .filter(|&&child| self.reach[child] >= least.max(1e-6))
                .map(|&child| self.chain(child))
                .collect();
            // Every joint is in a few limbs at most, so a joint with many children is none of a figure.
            for (i, a) in limbs.iter().enumerate().take(12) {
                for b in limbs.iter().take(12).skip(i + 1).filter(|b| self.are_twins(a, b)) {
                    let length = self.reach[a[0]].max(self.reach[b[0]]);
                    pairs.push(Pair { from, limbs: [a.clone(), b.clone()], length });
                }
            }
        }
        pairs.sort_by(|a, b| b.length.total_cmp(&a.length));
        pairs
    }

    /// The roles of a figure with two arms and two legs; empty for any other shape. `side` tells the side that the name of a joint states.
    pub(super) fn roles(&self, side: &dyn Fn(usize) -> Option<Side>) -> Vec<(Role, usize)> {
        let pairs = self.pairs();
        let Some((legs, arms)) = self.legs_and_arms(&pairs) else { return Vec::new() };
        let hips = legs.from;
        let head = self.head(arms, legs);
        if !self.is_above(hips, arms.from) || !self.is_upright(legs, head) {
            return Vec::new();
        }
        let mut roles = vec![(Role::Hips, hips), (Role::Head, head)];
        let left = self.left(legs, arms, head, side);
        let is_left =
            [legs, arms].map(|pair| named(pair, side).unwrap_or_else(|| self.across(pair).dot(left) > 0.0));
        for (which, side) in [Side::Left, Side::Right].into_iter().enumerate() {
            let [of_legs, of_arms] = is_left.map(|is_left| if is_left { which } else { 1 - which });
            let (Some(leg), Some(arm)) =
                (self.bones_of(&legs.limbs[of_legs]), self.bones_of(&arms.limbs[of_arms]))
            else {
                return Vec::new();
            };
            let (leg_joints, arm_joints) = (&legs.limbs[of_legs], &arms.limbs[of_arms]);
            roles.extend([
                (Role::Thigh(side), leg_joints[leg]),
                (Role::Shin(side), leg_joints[leg + 1]),
                (Role::Foot(side), leg_joints[leg + 2]),
                (Role::UpperArm(side), arm_joints[arm]),
                (Role::Forearm(side), arm_joints[arm + 1]),
                (Role::Hand(side), arm_joints[arm + 2]),
            ]);
            roles.extend(leg_joints.get(leg + 3).map(|&toe| (Role::Toe(side), toe)));
            roles.extend(arm.checked_sub(1).map(|before| (Role::Clavicle(side), arm_joints[before])));
        }
        roles
    }

    /// Whether the legs point away from the head, which those of an animal do not.
    fn is_upright(&self, legs: &Pair, head: usize) -> bool {
        let from = self.places[legs.from];
        let ends = legs.limbs.iter().filter_map(|limb| limb.last()).map(|&end| self.places[end] - from);
        let (legs, trunk) =
            (ends.sum::<Vec3>().normalize_or_zero(), (self.places[head] - from).normalize_or_zero());
        legs.dot(trunk) < -0.5
    }

    /// Whether a joint is another one or above it.
    fn is_above(&self, above: usize, joint: usize) -> bool {
        common_ancestor(self.parents, &self.depth, above, joint) == Some(above)
    }

    /// The two pairs of limbs of a figure. Legs leave the trunk nearer to its root than arms; where both leave one joint, arms are on the
    /// side of the head.
    fn legs_and_arms<'p>(&self, pairs: &'p [Pair]) -> Option<(&'p Pair, &'p Pair)> {
        let (first, second) = pairs.iter().enumerate().find_map(|(i, first)| {
            let apart = |other: &&Pair| {
                let within = |joint: usize, limbs: &[Vec<usize>; 2]| {
                    limbs.iter().any(|limb| self.is_above(limb[0], joint))
                };
                let different = other.limbs.iter().all(|limb| !first.limbs.iter().any(|of| of[0] == limb[0]));
                different && !within(other.from, &first.limbs) && !within(first.from, &other.limbs)
            };
            pairs[i + 1..].iter().find(apart).map(|second| (first, second))
        })?;
        if first.from != second.from {
            let first_is_upper = self.is_above(first.from, second.from);
            return Some(if first_is_upper { (first, second) } else { (second, first) });
        }
        let head = self.places[self.head(first, second)] - self.places[first.from];
        let along = |pair: &Pair| {
            let ends = pair.limbs.iter().filter_map(|limb| limb.last()).map(|&end| self.places[end]);
            (ends.sum::<Vec3>() * 0.5 - self.places[pair.from]).dot(head)
        };
        Some(if along(first) < along(second) { (first, second) } else { (second, first) })
    }

    /// The joint at the end of the neck: where the longest chain from the chest that is no limb branches, or its end.
    fn head(&self, arms: &Pair, legs: &Pair) -> usize {
        let is_limb =
            |&&child: &&usize| arms.limbs.iter().chain(&legs.limbs).any(|limb| self.is_above(child, limb[0]));
        let length = |&&joint: &&usize| self.reach[joint] + self.bone(joint);
        let others = self.children[arms.from].iter().filter(|child| !is_limb(child));
        let Some(&neck) = others.max_by(|a, b| length(a).total_cmp(&length(b)).then(b.cmp(a))) else {
            return arms.from;
        };
        let chain = self.chain(neck);
        let branches = chain.iter().find(|&&joint| self.children[joint].len() > 1);
        branches.or(chain.last()).copied().unwrap_or(neck)
    }

    /// Where in a limb its two long bones begin.
    fn bones_of(&self, limb: &[usize]) -> Option<usize> {
        let both = |i: usize| self.bone(limb[i + 1]) + self.bone(limb[i + 2]);
        (0..limb.len().saturating_sub(2)).max_by(|&a, &b| both(a).total_cmp(&both(b)).then(b.cmp(&a)))
    }

    /// From the second limb of a pair to the first.
    fn across(&self, pair: &Pair) -> Vec3 {
        self.places[pair.limbs[0][0]] - self.places[pair.limbs[1][0]]
    }

    /// The direction to the left of the figure: that of the names, otherwise that of a figure whose toes point forward.
    fn left(&self, legs: &Pair, arms: &Pair, head: usize, side: &dyn Fn(usize) -> Option<Side>) -> Vec3 {
        for pair in [legs, arms] {
            if let Some(is_left) = named(pair, side) {
                return self.across(pair) * if is_left { 1.0 } else { -1.0 };
            }
        }
        let up = self.places[head] - self.places[legs.from];
        let toes = legs.limbs.iter().filter_map(|limb| {
            let foot = self.bones_of(limb)? + 2;
            Some(self.places[*limb.get(foot + 1)?] - self.places[*limb.get(foot)?])
        });
        let forward: Vec3 = toes.sum();
        let left = up.cross(forward);
        // Without toes the figure is taken to face the viewer.
        if left.length() > 1e-3 * up.length() * forward.length() { left } else { Vec3::X }
    }
}

/// Whether the names state that the first limb of a pair is the left one.
fn named(pair: &Pair, side: &dyn Fn(usize) -> Option<Side>) -> Option<bool> {
    let of = |limb: &[usize]| limb.iter().find_map(|&joint| side(joint));
    match (of(&pair.limbs[0]), of(&pair.limbs[1])) {
        // Both alike states nothing.
        (Some(a), Some(b)) if a == b => None,
        (Some(a), _) => Some(a == Side::Left),
        (None, b) => b.map(|b| b == Side::Right),
    }
}
