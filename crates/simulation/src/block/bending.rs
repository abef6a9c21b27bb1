//! Shape memory: bending stiffness toward the rest shape, implicit and damped.
//!
//! The bend at a point is the second difference of the chain, `b_i = x_(i-1) - 2 x_i + x_(i+1)`; `b*_i` is
//! the rest bend in the frame that is carried along the chain by smallest rotations. Energy
//! `1/2 c |b - b*|^2` and the damping of its change are integrated implicitly (backward Euler), which is
//! stable for any stiffness. The matrix is pentadiagonal and depends only on stiffness, hold, link length and
//! time step, so it is factorised when one of these changes, and a substep only substitutes. The whole chain
//! responds at once; local corrections from link to link would need many iterations, and their stiffness
//! would change with the number of substeps.
//!
//! The coefficient is `c = h^2 B / l^4` with `B = EI / (rho A)`, the bending stiffness per mass of a fibre
//! (Euler-Bernoulli beam).

use crate::SimulationSettings;
use crate::factors::FactorRows;
use crate::lanes::{LANES, Lane, Lane3, ZERO, ZERO3, at, greater, lesser, put};

/// The largest `c (1 + gamma)`. Beyond it single precision loses the solution, and the hair is as stiff as
/// wire anyway.
const STIFFEST: f32 = 2e4;

/// The sharpness at which a bend follows the head and the guide in equal parts; see [`Bending::head_share`].
/// The shipped styles flutter from about ten times this.
const HALF_SHARPNESS: f32 = 4.0;

/// Length of the guide strand to which the angular frequency of the settings refers, metres.
const REFERENCE_LENGTH: f32 = 0.2;

/// `(beta_1 L)^2` of the lowest vibration mode of a beam clamped at one end.
const CANTILEVER: f32 = 3.516;

/// The constants of bends by name, for other devices.
pub(super) const CONSTANTS: [(&str, f64); 4] = [
    ("STIFFEST", STIFFEST as f64),
    ("HALF_SHARPNESS", HALF_SHARPNESS as f64),
    ("REFERENCE_LENGTH", REFERENCE_LENGTH as f64),
    ("CANTILEVER", CANTILEVER as f64),
];

/// The inputs of the matrix, besides the link lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendingKey {
    pub(crate) h: f32,
    pub(crate) stiffness_root: f32,
    pub(crate) stiffness_tip: f32,
    pub(crate) stiffness_bias: f32,
    pub(crate) damping_secs: f32,
    pub(crate) hold: f32,
    pub(crate) hold_reach: f32,
    pub(crate) weight: f32,
    pub(crate) weight_tip: f32,
    pub(crate) first_free: usize,
}

impl BendingKey {
    /// The inputs that `settings` give for substeps of `h` seconds.
    pub(crate) fn new(settings: &SimulationSettings, h: f32, first_free: usize) -> Self {
        Self {
            h,
            stiffness_root: settings.stiffness_root,
            stiffness_tip: settings.stiffness_tip,
            stiffness_bias: settings.stiffness_bias,
            damping_secs: settings.bend_damping,
            hold: settings.hold,
            hold_reach: settings.hold_reach,
            weight: settings.weight,
            weight_tip: settings.weight_tip,
            first_free,
        }
    }

    /// Angular frequencies of stiffness and hold at a fraction of a guide, 1/s. Both act on the mass of the hair.
    pub(crate) fn frequencies_at(&self, along: f32) -> [f32; 2] {
        let ramp = SimulationSettings {
            stiffness_root: self.stiffness_root,
            stiffness_tip: self.stiffness_tip,
            stiffness_bias: self.stiffness_bias,
            weight: self.weight,
            weight_tip: self.weight_tip,
            ..SimulationSettings::default()
        };
        let lighter = 1.0 / ramp.weight_at(along).sqrt();
        [ramp.stiffness_at(along) * lighter, self.hold * lighter]
    }

    /// Ratio of damping to stiffness in one substep.
    pub(crate) fn gamma(&self) -> f32 {
        self.damping_secs / self.h
    }
}

/// The factorised matrix of each lane. Rows are points.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bending {
    key: Option<BendingKey>,
    /// `c` of the bend around each point.
    stiffness: Vec<Lane>,
    /// Weight of the pull toward the style: `(h omega)^2`.
    hold: Vec<Lane>,
    /// Ratio of damping to stiffness in one substep, at the bend around each point.
    gamma: Vec<Lane>,
    /// `c (1 + gamma)`.
    damped: Vec<Lane>,
    /// How far the rest bend around each point rotates with the head, 0 to 1; the remainder rotates with the
    /// guide.
    ///
    /// A rest bend that rotates with the guide acts like a thruster: its force has no potential, and where
    /// the bend is sharp and stiff it makes the guide flutter. A part that stiff hardly rotates relative to
    /// the head, so the head's frame is as good there, and in it the force is conservative. The share grows
    /// with `c (1 + gamma)` times the bend per link.
    head_share: Vec<Lane>,
    inv_pivot: Vec<Lane>,
    below: Vec<Lane>,
    below2: Vec<Lane>,
    /// Factors of the same matrix, eliminated from the tip: how the free part beyond a point follows it.
    follow: Vec<Lane>,
    follow2: Vec<Lane>,
}

impl Bending {
    pub(crate) fn new(points: usize) -> Self {
        Self {
            key: None,
            stiffness: vec![ZERO; points],
            hold: vec![ZERO; points],
            gamma: vec![ZERO; points],
            damped: vec![ZERO; points],
            head_share: vec![ZERO; points],
            inv_pivot: vec![ZERO; points],
            below: vec![ZERO; points],
            below2: vec![ZERO; points],
            follow: vec![ZERO; points],
            follow2: vec![ZERO; points],
        }
    }

    pub(crate) fn stiffness(&self, point: usize) -> &Lane {
        &self.stiffness[point]
    }

    pub(crate) fn hold(&self, point: usize) -> &Lane {
        &self.hold[point]
    }

    pub(crate) fn gamma(&self, point: usize) -> &Lane {
        &self.gamma[point]
    }

    pub(crate) fn head_share(&self, point: usize) -> &Lane {
        &self.head_share[point]
    }

    /// Factorises the matrix if the settings or the time step have changed, and returns whether it did.
    /// `link` is the mean link of each guide, `inv_length` the inverse length of every link (0 beyond a
    /// guide's end), `rest_bend` the rest bends, and `tie_hold` the strength of ties at each point (negative
    /// where there is none). `factors` are those of the hairstyle; after a change of them, call
    /// [`Bending::invalidate`].
    #[inline(always)]
    pub(crate) fn prepare(
        &mut self,
        key: BendingKey,
        link: &Lane,
        inv_length: &[Lane],
        rest_bend: &[Lane3],
        tie_hold: &[Lane],
        factors: Option<&FactorRows>,
    ) -> bool {
        if self.key == Some(key) {
            return false;
        }
        self.key = Some(key);
        let count = self.stiffness.len();
        let gamma = key.gamma();
        let one = Lane::splat(1.0);
        for i in 0..count {
            let (stiffer, held, damper) = match factors {
                Some(factors) => (factors.stiffness[i], factors.hold[i], factors.damping[i]),
                None => (one, one, one),
            };
            let along = i as f32 / (count - 1).max(1) as f32;
            let [omega, hold] = key.frequencies_at(along);
            let root_b = omega * REFERENCE_LENGTH * REFERENCE_LENGTH / CANTILEVER;
            let bends = i > 0 && i + 1 < count;
            for k in 0..LANES {
                let c = key.h * root_b / (link[k] * link[k] + 1e-12) * stiffer[k];
                let gamma = gamma * damper[k];
                let gain = 1.0 + gamma;
                // The end of a guide that was cut is a tip.
                let bends = bends && inv_length[i + 1][k] > 0.0;
                self.stiffness[i][k] = if bends { lesser(c * c, STIFFEST / gain) } else { 0.0 };
                let reach = lesser(key.hold_reach, link[k] * (count - 1) as f32) + 1e-6;
                let fades = greater(1.0 - link[k] * i as f32 / reach, 0.0);
                let pull = key.h * hold * fades * fades * held[k];
                let pull = if tie_hold[i][k] >= 0.0 { key.h * tie_hold[i][k] } else { pull };
                self.hold[i][k] = pull * pull;
                let bend = at(&rest_bend[i], k).length_squared().sqrt() / (link[k] + 1e-9);
                let sharpness = self.stiffness[i][k] * gain * bend;
                self.gamma[i][k] = gamma;
                self.damped[i][k] = gain * self.stiffness[i][k];
                self.head_share[i][k] = sharpness / (sharpness + HALF_SHARPNESS);
            }
        }
        self.factorise(key.first_free);
        self.factorise_from_tip(key.first_free);
        true
    }

    /// Lets the next [`Bending::prepare`] factorise the matrix again.
    pub(crate) fn invalidate(&mut self) {
        self.key = None;
    }

    /// Whether nothing resists bending, so that the matrix is the identity.
    pub(crate) fn is_chain(&self) -> bool {
        self.stiffness.iter().chain(&self.hold).all(|row| *row == ZERO)
    }

    /// Passes the lower triangle of `H = D A^-1 D^T` to `fill`, by row and column. Rows and columns are the
    /// links from the first one with a free end on; `D` takes the difference of a link's ends.
    #[inline(always)]
    pub(crate) fn response(&self, first_free: usize, mut fill: impl FnMut(usize, usize, Lane)) {
        let count = self.stiffness.len();
        let first = first_free.max(1);
        // Three columns of A^-1 D^T at a time.
        let mut rows = vec![ZERO3; count];
        for from in (first..count).step_by(3) {
            rows.fill(ZERO3);
            for (axis, link) in (from..count.min(from + 3)).enumerate() {
                rows[link][axis] = Lane::splat(1.0);
                if link > first_free {
                    rows[link - 1][axis] = Lane::splat(-1.0);
                }
            }
            self.solve(first_free, &mut rows);
            for (axis, link) in (from..count.min(from + 3)).enumerate() {
                for r in link..count {
                    let (low, high) = (rows[r - 1][axis], rows[r][axis]);
                    let difference = if r > first_free { high.minus(low) } else { high };
                    fill(r - first, link - first, difference);
                }
            }
        }
    }

    /// `L D L^T` of `1 + hold + D2^T c (1 + gamma) D2` on the free points.
    #[inline(always)]
    fn factorise(&mut self, first_free: usize) {
        let count = self.stiffness.len();
        let e = |c: &[Lane], i: usize, k: usize| if i < count { c[i][k] } else { 0.0 };
        for i in first_free..count {
            for k in 0..LANES {
                let c = &self.damped;
                let left = if i > 0 { e(c, i - 1, k) } else { 0.0 };
                let diagonal = 1.0 + self.hold[i][k] + left + 4.0 * e(c, i, k) + e(c, i + 1, k);
                let (mut l1, mut l2) = (0.0, 0.0);
                let mut pivot = diagonal;
                if i >= first_free + 2 {
                    l2 = left * self.inv_pivot[i - 2][k];
                    pivot -= l2 * left;
                }
                if i > first_free {
                    let mut off = -2.0 * (left + e(c, i, k));
                    if i >= first_free + 2 {
                        off -= left * self.below[i - 1][k];
                    }
                    l1 = off * self.inv_pivot[i - 1][k];
                    pivot -= l1 * off;
                }
                self.below[i][k] = l1;
                self.below2[i][k] = l2;
                self.inv_pivot[i][k] = 1.0 / pivot;
            }
        }
    }

    /// `U D U^T` of the same matrix, from the tip to the root. Row `i` of `follow` is the coefficient of
    /// point `i` for point `i + 1`, and row `i` of `follow2` that for point `i + 2`.
    #[inline(always)]
    fn factorise_from_tip(&mut self, first_free: usize) {
        let count = self.stiffness.len();
        let (mut inv, mut inv2, mut beyond) = (ZERO, ZERO, ZERO);
        for i in (first_free.saturating_sub(1)..count).rev() {
            let c = |i: usize, k: usize| if i < count { self.damped[i][k] } else { 0.0 };
            let (mut one, mut two) = (ZERO, ZERO);
            for k in 0..LANES {
                let left = if i > 0 { c(i - 1, k) } else { 0.0 };
                let (here, right) = (c(i, k), c(i + 1, k));
                let mut pivot = 1.0 + self.hold[i][k] + left + 4.0 * here + right;
                if i + 2 < count {
                    two[k] = right * inv2[k];
                    pivot -= two[k] * right;
                }
                if i + 1 < count {
                    let off = -2.0 * (here + right) - if i + 2 < count { right * beyond[k] } else { 0.0 };
                    one[k] = off * inv[k];
                    pivot -= one[k] * off;
                }
                (inv2[k], inv[k]) = (inv[k], 1.0 / pivot);
            }
            self.follow[i] = one;
            self.follow2[i] = two;
            beyond = one;
        }
    }

    /// Displacement of the point after `point` when its two predecessors are displaced by `before` and `here`
    /// (`here` belongs to `point`) and no other force acts beyond them.
    #[inline(always)]
    pub(crate) fn follow(&self, point: usize, before: &Lane3, here: &Lane3) -> Lane3 {
        let mut out = ZERO3;
        let (one, two) = (&self.follow[point], &self.follow2[point.saturating_sub(1)]);
        for k in 0..LANES {
            let d = at(here, k) * -one[k] - at(before, k) * two[k];
            put(&mut out, k, d);
        }
        out
    }

    /// Solves for the displacement caused by the force `rhs`, in place.
    #[inline(always)]
    pub(crate) fn solve(&self, first_free: usize, rhs: &mut [Lane3]) {
        let (mut one, mut two) = (ZERO3, ZERO3);
        for i in first_free..rhs.len() {
            let y = self.forward(i, &rhs[i], &one, &two);
            rhs[i] = y;
            (two, one) = (one, y);
        }
        (one, two) = (ZERO3, ZERO3);
        for i in (first_free..rhs.len()).rev() {
            let y = self.backward(i, &rhs[i], &one, &two);
            rhs[i] = y;
            (two, one) = (one, y);
        }
    }

    /// Back substitution, the second half of [`Bending::solve`], for rows that have been through
    /// [`Bending::forward`]; adds the displacements to `points`.
    #[inline(always)]
    pub(crate) fn finish(&self, first_free: usize, rhs: &mut [Lane3], points: &mut [Lane3]) {
        let (mut one, mut two) = (ZERO3, ZERO3);
        for (i, (row, point)) in rhs.iter_mut().zip(points).enumerate().skip(first_free).rev() {
            let y = self.backward(i, row, &one, &two);
            *row = y;
            *point = [point[0].plus(y[0]), point[1].plus(y[1]), point[2].plus(y[2])];
            (two, one) = (one, y);
        }
    }

    /// Forward elimination of the force at point `i`; `one` and `two` are the results for the two points
    /// before.
    #[inline(always)]
    pub(crate) fn forward(&self, i: usize, force: &Lane3, one: &Lane3, two: &Lane3) -> Lane3 {
        let (mut y, l1, l2) = (ZERO3, &self.below[i], &self.below2[i]);
        for k in 0..LANES {
            let v = at(force, k) - at(two, k) * l2[k] - at(one, k) * l1[k];
            put(&mut y, k, v);
        }
        y
    }

    /// Back substitution at point `i`, whose eliminated force is `left`; `one` and `two` are the
    /// displacements of the next two points.
    #[inline(always)]
    fn backward(&self, i: usize, left: &Lane3, one: &Lane3, two: &Lane3) -> Lane3 {
        let (mut y, inv) = (ZERO3, &self.inv_pivot[i]);
        let l1 = self.below.get(i + 1).unwrap_or(&ZERO);
        let l2 = self.below2.get(i + 2).unwrap_or(&ZERO);
        for k in 0..LANES {
            let v = at(left, k) * inv[k] - at(two, k) * l2[k] - at(one, k) * l1[k];
            put(&mut y, k, v);
        }
        y
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn key(first_free: usize) -> BendingKey {
        BendingKey {
            h: 1.0 / 240.0,
            stiffness_root: 14.0,
            stiffness_tip: 5.0,
            stiffness_bias: 0.5,
            damping_secs: 0.02,
            hold: 4.0,
            hold_reach: 2.0,
            weight: 1.0,
            weight_tip: 1.0,
            first_free,
        }
    }

    /// `(1 + hold + gain D2^T c D2) x`, computed from the definition.
    fn multiply(b: &Bending, gain: f32, first_free: usize, x: &[Vec3]) -> Vec<Vec3> {
        let mut out: Vec<Vec3> = (0..x.len()).map(|i| x[i] * (1.0 + b.hold(i)[0])).collect();
        for i in 1..x.len() - 1 {
            let bend = (x[i - 1] - 2.0 * x[i] + x[i + 1]) * gain * b.stiffness(i)[0];
            out[i - 1] += bend;
            out[i] -= 2.0 * bend;
            out[i + 1] += bend;
        }
        out.drain(..first_free);
        out
    }

    #[test]
    fn the_solution_solves_the_system() {
        for first_free in 0..3 {
            let mut b = Bending::new(9);
            b.prepare(
                key(first_free),
                &Lane::splat(0.01),
                &[Lane::splat(100.0); 9],
                &[ZERO3; 9],
                &[Lane::splat(-1.0); 9],
                None,
            );
            let mut x: Vec<Vec3> =
                (0..9).map(|i| Vec3::new((i as f32).sin(), (i as f32 * 2.0).cos(), 0.1 * i as f32)).collect();
            x[..first_free].fill(Vec3::ZERO);
            let f = multiply(&b, 1.0 + key(0).gamma(), first_free, &x);
            let mut rows = vec![ZERO3; 9];
            for (row, f) in rows[first_free..].iter_mut().zip(&f) {
                for k in 0..LANES {
                    put(row, k, *f);
                }
            }
            b.solve(first_free, &mut rows);
            for (row, want) in rows.iter().zip(&x).skip(first_free) {
                // The condition number is about a thousand; f32 leaves four digits of a value near 1.
                assert!((at(row, 5) - *want).length() < 1e-3, "{} against {want}", at(row, 5));
            }
        }
    }

    #[test]
    fn the_chain_beyond_a_moved_point_follows_without_force() {
        let mut b = Bending::new(12);
        b.prepare(
            key(2),
            &Lane::splat(0.01),
            &[Lane::splat(100.0); 12],
            &[ZERO3; 12],
            &[Lane::splat(-1.0); 12],
            None,
        );
        let splat = |v: Vec3| crate::lanes::splat3(v);
        let mut rows = vec![ZERO3; 12];
        rows[4] = splat(Vec3::new(0.2, -0.1, 0.05));
        rows[5] = splat(Vec3::new(0.5, 0.3, -0.2));
        for i in 6..12 {
            rows[i] = b.follow(i - 1, &rows[i - 2], &rows[i - 1]);
        }
        let x: Vec<Vec3> = rows.iter().map(|r| at(r, 7)).collect();
        let forces = multiply(&b, 1.0 + key(0).gamma(), 0, &x);
        let size = forces[4].length();
        assert!(size > 1.0, "what moves them is a force");
        // Rounding errors relative to the size of those forces.
        assert!(forces[6..].iter().all(|f| f.length() < 1e-3 * size), "{forces:?}");
        assert!(x[11].length() > 0.1, "a stiff guide goes along");
    }

    #[test]
    fn zero_stiffness_gives_the_identity() {
        let mut b = Bending::new(5);
        let soft = BendingKey { stiffness_root: 0.0, stiffness_tip: 0.0, hold: 0.0, ..key(1) };
        b.prepare(
            soft,
            &Lane::splat(0.01),
            &[Lane::splat(100.0); 5],
            &[ZERO3; 5],
            &[Lane::splat(-1.0); 5],
            None,
        );
        let mut rows = vec![[Lane::splat(0.25); 3]; 5];
        b.solve(1, &mut rows);
        assert!(rows[1..].iter().all(|r| *r == [Lane::splat(0.25); 3]));
    }

    #[test]
    fn zero_length_links_give_finite_factors() {
        let mut b = Bending::new(5);
        b.prepare(key(1), &ZERO, &[Lane::splat(100.0); 5], &[ZERO3; 5], &[Lane::splat(-1.0); 5], None);
        assert!(b.inv_pivot[1..].iter().flat_map(|row| row.iter()).all(|v| v.is_finite()));
    }
}
