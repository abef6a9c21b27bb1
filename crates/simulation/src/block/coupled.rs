//! Lengths and bends coupled: the length step of the links in the metric of the bends.
//!
//! Bends are solved without regard to lengths; moving points then restores the lengths. If every point moved
//! equally easily, that would undo the bends: a guide that is folded link by link can only straighten by
//! pushing everything below it along, which costs more than folding again. The length step therefore uses the
//! norm of the implicit bends, `A = 1 + hold + (1 + gamma) D2^T c D2`, in which a displacement that bends the
//! guide costs as much as its stiffness demands. The result is the exact solution of one linear system,
//! `[A J^T; J 0]`, as in fast projection (Goldenthal et al. 2007) with implicit bends.
//!
//! The multipliers solve `S l = r` with `S_ij = (n_i . n_j) H_ij`, where `H = D A^-1 D^T` is the change of
//! the difference across link `i` caused by a force along link `j`. `A` does not depend on directions, so `H`
//! depends only on settings and time step and is computed when `A` is factorised. `S` is dense, symmetric and
//! positive definite (the Schur product of two such matrices), and is solved by Cholesky factorisation.

use super::bending::Bending;
use super::lengths::LengthScratch;
use crate::lanes::{LANES, Lane, Lane3, Map, ZERO, ZERO3, at, choose, greater, inv_sqrt, put, row_barrier};

/// The factor is reused while no link has rotated further than this relative to the head since it was
/// computed: radians, squared.
const SAME_DIRECTION: f32 = 0.1 * 0.1;

/// A pivot below this fraction of its diagonal is a rounding error.
const LEAST_PIVOT: f32 = 1e-4;

/// The constants of the factor by name, for other devices.
pub(super) const CONSTANTS: [(&str, f64); 2] =
    [("SAME_DIRECTION", SAME_DIRECTION as f64), ("LEAST_PIVOT", LEAST_PIVOT as f64)];

/// The metric of one block. Rows and columns are links.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coupled {
    /// `H` in tiles, in the order in which they are read: for each pair of columns the tiles from the
    /// diagonal down. Entries above the diagonal and beyond the last link are 0.
    response: Vec<Tile>,
    links: usize,
    /// The link directions, in head space, for which the factor was or will be computed. This is the only
    /// state in here.
    pub(crate) directions: Vec<Lane3>,
    factor: Factor,
}

/// The Cholesky factor of `S`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Factor {
    /// Panels of [`ROWS`] rows, column by column, so that sums run over all rows of a panel at once. Entries
    /// on and above the diagonal and of missing rows are 0.
    panels: Vec<Lane>,
    /// Inverse of the factor's diagonal; 0 for missing rows.
    inv_diagonal: Vec<Lane>,
    links: usize,
    /// Whether the factor has been computed.
    is_computed: bool,
}

/// Rows per panel of the factor.
const ROWS: usize = 4;

/// Rows and columns of the factor that are computed together; the tile fits the registers of every vector
/// width.
const TILE: usize = 2;

/// `s - a b^T` over all present columns of two panels, for the tile at row `i` of `a` and row `j` of `b`.
#[inline(always)]
fn minus_products(s: Tile, a: &[Lane], i: usize, b: &[Lane], j: usize) -> Tile {
    // `black_box` forces the values through memory, where the lanes are contiguous. Otherwise the compiler
    // may keep lanes apart and split the whole loop into parts of a register.
    let mut s = std::hint::black_box(s);
    for (a, b) in a.as_chunks::<ROWS>().0.iter().zip(b.as_chunks::<ROWS>().0) {
        for (sums, a) in s.iter_mut().zip(&a[i..i + TILE]) {
            for (sum, b) in sums.iter_mut().zip(&b[j..j + TILE]) {
                *sum = sum.minus_product(*a, *b);
            }
        }
    }
    std::hint::black_box(s)
}

/// Rows, and the columns of each.
type Tile = [[Lane; TILE]; TILE];

const NO_TILE: Tile = [[ZERO; TILE]; TILE];

/// The tile of `S` at row `r` and column `c` for links along `directions`; `response` is the same tile of
/// `H`.
#[inline(always)]
fn products(response: &Tile, r: usize, c: usize, directions: &[Lane3]) -> Tile {
    let mut s = *response;
    for (i, tile_row) in s.iter_mut().enumerate() {
        let r = (r + i).min(directions.len() - 1);
        for (j, product) in tile_row.iter_mut().enumerate() {
            let (n, m) = (&directions[r], &directions[(c + j).min(r)]);
            for k in 0..LANES {
                product[k] *= at(n, k).dot(at(m, k));
            }
            row_barrier();
        }
    }
    s
}

/// Inverse square root of a pivot; `whole` is its diagonal before elimination.
#[inline(always)]
fn inv_root(pivot: Lane, whole: Lane) -> Lane {
    let mut inv = ZERO;
    for k in 0..LANES {
        inv[k] = inv_sqrt(greater(pivot[k], greater(LEAST_PIVOT * whole[k], 1e-9)));
    }
    inv
}

/// Index of the first entry of panel `p`.
#[inline(always)]
fn panel(p: usize) -> usize {
    ROWS * ROWS * p * (p + 1) / 2
}

impl Coupled {
    pub(crate) fn new(points: usize) -> Self {
        Self { directions: vec![ZERO3; points], ..Self::default() }
    }

    /// Discards the factor and its directions.
    pub(crate) fn reset(&mut self) {
        self.directions.fill(ZERO3);
        self.invalidate_factor();
    }

    /// Discards the factor; it is computed again from the stored directions.
    pub(crate) fn invalidate_factor(&mut self) {
        self.factor.is_computed = false;
    }

    /// Computes `H` from newly computed factors of `bending`; `first_free` is the first point that the scalp
    /// does not carry.
    #[inline(always)]
    pub(crate) fn prepare(&mut self, bending: &Bending, first_free: usize, points: usize) {
        let first = first_free.max(1);
        let links = points.saturating_sub(first);
        self.links = links;
        self.invalidate_factor();
        // Number of tiles in a column of tiles, at most.
        let most = links.div_ceil(TILE);
        self.response.clear();
        self.response.resize(most * (most + 1) / 2, NO_TILE);
        bending.response(first_free, |r, c, value| {
            let (row, column) = (r / TILE, c / TILE);
            let before = column * (2 * most + 1 - column) / 2;
            self.response[before + row - column][r % TILE][c % TILE] = value;
        });
    }

    /// Updates the factor if the directions in `scratch` have changed; `to_head` rotates them into head
    /// space. Lanes that have rotated take their new directions. The others keep theirs, which gives them the
    /// same factor again.
    #[inline(always)]
    fn update_factor(&mut self, first: usize, scratch: &LengthScratch, to_head: &Map) {
        let mut furthest = ZERO;
        for (n, was) in scratch.direction[first..].iter().zip(&self.directions[first..]) {
            for k in 0..LANES {
                let turned = (to_head.rotate(at(n, k)) - at(was, k)).length_squared();
                // NaN stays.
                furthest[k] = if turned > furthest[k] || turned.is_nan() { turned } else { furthest[k] };
            }
        }
        let unchanged = furthest.map(|turned| turned <= SAME_DIRECTION);
        if unchanged == [true; LANES] && self.factor.is_computed {
            return;
        }
        for (n, to) in scratch.direction[first..].iter().zip(&mut self.directions[first..]) {
            let mut next = *to;
            for k in 0..LANES {
                let turned = choose(unchanged[k], at(to, k), to_head.rotate(at(n, k)));
                put(&mut next, k, turned);
            }
            *to = next;
        }
        self.factor.factorise(&self.response, self.links, &self.directions[first..]);
    }

    /// One Newton step toward the lengths of the links of `position`. `force` is working memory. With
    /// `to_head`, the rotation into head space, `S` is factorised again where directions have changed;
    /// without it the last factor is reused.
    #[inline(always)]
    pub(crate) fn project(
        &mut self,
        first_free: usize,
        length: &[Lane],
        position: &mut [Lane3],
        bending: &Bending,
        scratch: &mut LengthScratch,
        force: &mut [Lane3],
        to_head: Option<&Map>,
    ) {
        let count = position.len();
        let first = first_free.max(1);
        scratch.errors(first, length, position);
        if let Some(to_head) = to_head {
            self.update_factor(first, scratch, to_head);
        }
        self.factor.solve(first, scratch);
        // Each link pulls its two ends in opposite directions.
        let (mut own, mut one, mut two) = (ZERO3, ZERO3, ZERO3);
        for i in first..count {
            let (n, l) = (&scratch.direction[i], scratch.multiplier[i]);
            let pull = [n[0].times(l), n[1].times(l), n[2].times(l)];
            if i > first_free {
                let both = [own[0].minus(pull[0]), own[1].minus(pull[1]), own[2].minus(pull[2])];
                let left = bending.forward(i - 1, &both, &one, &two);
                force[i - 1] = left;
                (two, one) = (one, left);
            }
            own = pull;
        }
        force[count - 1] = bending.forward(count - 1, &own, &one, &two);
        bending.finish(first_free, force, position);
    }
}

impl Factor {
    /// Factorises `S` for `links` links along `directions`; `response` is `H`.
    #[inline(always)]
    fn factorise(&mut self, response: &[Tile], links: usize, directions: &[Lane3]) {
        if self.links != links {
            self.links = links;
            self.panels.clear();
            self.panels.resize(panel(links.div_ceil(ROWS)), ZERO);
            self.inv_diagonal.clear();
            self.inv_diagonal.resize(ROWS * links.div_ceil(ROWS), ZERO);
        }
        self.is_computed = true;
        // Tiles of two columns by two rows: each loaded value is used twice, and no sum waits for another.
        // Within a pair of columns the tiles below the diagonal are independent of each other.
        let mut responses = response.iter();
        for c in (0..links).step_by(TILE) {
            let Some(response) = responses.next() else { return };
            self.pivots(response, c, directions);
            let corner = self.panels[panel(c / ROWS) + ROWS * c + c % ROWS + 1];
            let inv: [Lane; TILE] = [self.inv_diagonal[c], self.inv_diagonal[c + 1]];
            for (r, response) in (c + TILE..links).step_by(TILE).zip(&mut responses) {
                let (above, own) = self.panels.split_at_mut(panel(r / ROWS));
                let other = if c / ROWS < r / ROWS { &above[panel(c / ROWS)..] } else { &*own };
                let s = products(response, r, c, &directions[..links]);
                let s = minus_products(s, &own[..ROWS * c], r % ROWS, &other[..ROWS * c], c % ROWS);
                for (i, row) in s.iter().enumerate().take(links - r) {
                    let one = row[0].times(inv[0]);
                    let two = row[1].minus_product(one, corner).times(inv[1]);
                    own[ROWS * c + r % ROWS + i] = one;
                    own[ROWS * (c + 1) + r % ROWS + i] = two;
                    row_barrier();
                }
            }
        }
    }

    /// Factorises the tile on the diagonal at row and column `c`.
    #[inline(always)]
    fn pivots(&mut self, response: &Tile, c: usize, directions: &[Lane3]) {
        let own = &mut self.panels[panel(c / ROWS)..];
        let whole = products(response, c, c, &directions[..self.links]);
        let s = minus_products(whole, &own[..ROWS * c], c % ROWS, &own[..ROWS * c], c % ROWS);
        let inv = inv_root(s[0][0], whole[0][0]);
        self.inv_diagonal[c] = inv;
        if c + 1 < self.links {
            let below = s[1][0].times(inv);
            own[ROWS * c + c % ROWS + 1] = below;
            self.inv_diagonal[c + 1] = inv_root(s[1][1].minus_product(below, below), whole[1][1]);
        }
    }

    /// Forward substitution within panel `p`, row by row, so that the values stay in registers.
    #[inline(always)]
    fn forward_corner(&self, p: usize, [a, b, c, d]: [Lane; ROWS]) -> [Lane; ROWS] {
        let (l, inv) = self.corner(p);
        let a = a.times(inv[0]);
        let b = b.minus_product(l[0][1], a).times(inv[1]);
        let c = c.minus_product(l[0][2], a).minus_product(l[1][2], b).times(inv[2]);
        let d = d.minus_product(l[0][3], a).minus_product(l[1][3], b).minus_product(l[2][3], c).times(inv[3]);
        [a, b, c, d]
    }

    /// Back substitution with the transpose within panel `p`.
    #[inline(always)]
    fn backward_corner(&self, p: usize, [a, b, c, d]: [Lane; ROWS]) -> [Lane; ROWS] {
        let (l, inv) = self.corner(p);
        let d = d.times(inv[3]);
        let c = c.minus_product(l[2][3], d).times(inv[2]);
        let b = b.minus_product(l[1][3], d).minus_product(l[1][2], c).times(inv[1]);
        let a = a.minus_product(l[0][3], d).minus_product(l[0][2], c).minus_product(l[0][1], b).times(inv[0]);
        [a, b, c, d]
    }

    /// The columns of panel `p` that cross its diagonal, and the inverse diagonal.
    #[inline(always)]
    fn corner(&self, p: usize) -> (&[[Lane; ROWS]], &[Lane]) {
        (
            &self.panels[panel(p) + ROWS * ROWS * p..].as_chunks().0[..ROWS],
            &self.inv_diagonal[ROWS * p..][..ROWS],
        )
    }

    /// Solves for the multipliers with the current factor, in place of the right-hand side.
    #[inline(always)]
    fn solve(&self, first: usize, scratch: &mut LengthScratch) {
        let links = self.links;
        let x = &mut scratch.multiplier[first..][..links];
        for p in 0..links.div_ceil(ROWS) {
            let (start, factor) = (ROWS * p, &self.panels[panel(p)..]);
            let rows = ROWS.min(links - start);
            let (before, own) = x.split_at_mut(start);
            let mut y: [Lane; ROWS] = std::array::from_fn(|r| if r < rows { own[r] } else { ZERO });
            for (l, x) in factor.as_chunks::<ROWS>().0.iter().zip(&*before) {
                for (y, l) in y.iter_mut().zip(l) {
                    *y = y.minus_product(*l, *x);
                }
            }
            let y = self.forward_corner(p, y);
            own[..rows].copy_from_slice(&y[..rows]);
        }
        for p in (0..links.div_ceil(ROWS)).rev() {
            let (start, factor) = (ROWS * p, &self.panels[panel(p)..]);
            let rows = ROWS.min(links - start);
            let (before, own) = x.split_at_mut(start);
            let y = std::array::from_fn(|r| if r < rows { own[r] } else { ZERO });
            let y = self.backward_corner(p, y);
            for (l, x) in factor.as_chunks::<ROWS>().0.iter().zip(before) {
                let mut sum = *x;
                for (y, l) in y.iter().zip(l).rev() {
                    sum = sum.minus_product(*l, *y);
                }
                *x = sum;
                row_barrier();
            }
            own[..rows].copy_from_slice(&y[..rows]);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::super::bending::BendingKey;
    use super::super::lengths::project_position;
    use super::*;
    use crate::lanes::put;

    const POINTS: usize = 31;
    const LINK: f32 = 0.01;

    fn bending(first_free: usize) -> Bending {
        let mut b = Bending::new(POINTS);
        let key = BendingKey {
            h: 1.0 / 240.0,
            stiffness_root: 14.0,
            stiffness_tip: 5.0,
            stiffness_bias: 0.5,
            damping_secs: 0.03,
            hold: 5.0,
            hold_reach: 2.0,
            weight: 1.0,
            weight_tip: 1.0,
            first_free,
        };
        b.prepare(
            key,
            &Lane::splat(LINK),
            &[Lane::splat(1.0 / LINK); POINTS],
            &[ZERO3; POINTS],
            &[Lane::splat(-1.0); POINTS],
            None,
        );
        b
    }

    fn coupled(b: &Bending, first_free: usize) -> Coupled {
        let mut c = Coupled::new(POINTS);
        c.prepare(b, first_free, POINTS);
        c
    }

    /// A guide folded link by link, `fold` radians to either side of straight down, the same in every lane.
    fn folded(fold: f32) -> Vec<Lane3> {
        let mut rows = vec![ZERO3; POINTS];
        let mut p = Vec3::ZERO;
        for (i, row) in rows.iter_mut().enumerate() {
            if i > 0 {
                let side = if i % 2 == 0 { fold } else { -fold };
                p += LINK * Vec3::new(side.sin(), -side.cos(), 0.0);
            }
            for k in 0..LANES {
                put(row, k, p);
            }
        }
        rows
    }

    fn lengths_after(x: &[Lane3]) -> f32 {
        (1..POINTS)
            .map(|i| ((at(&x[i], 3) - at(&x[i - 1], 3)).length() / LINK - 1.0).abs())
            .fold(0.0, f32::max)
    }

    #[test]
    fn a_newton_step_in_the_metric_of_bends_squares_the_length_error() {
        for first_free in 0..3 {
            let b = bending(first_free);
            let mut x = folded(0.3);
            for (i, row) in x.iter_mut().enumerate().skip(first_free) {
                for k in 0..LANES {
                    let s = i as f32;
                    let p = at(row, k) + 0.0003 * Vec3::new(s.sin(), (3.0 * s).cos(), 0.3 * (2.0 * s).sin());
                    put(row, k, p);
                }
            }
            let (was, before) = (x.clone(), lengths_after(&x));
            let mut force = vec![ZERO3; POINTS];
            let mut c = coupled(&b, first_free);
            c.project(
                first_free,
                &[Lane::splat(LINK); POINTS],
                &mut x,
                &b,
                &mut LengthScratch::new(POINTS),
                &mut force,
                Some(&Map::IDENTITY),
            );
            let after = lengths_after(&x);
            // A step moves folded links sideways by about the size of their errors: measured 3.6 times the
            // square.
            assert!(before > 0.02 && after < 5.0 * before * before, "{before} became {after}");
            assert!((0..first_free).all(|i| x[i] == was[i]), "a carried point was moved");
        }
    }

    /// Iterates bends and lengths without inertia; returns the remaining fraction of the fold.
    fn left_of_fold(
        rounds: usize,
        project: impl Fn(&Bending, &mut [Lane3], &mut LengthScratch, &mut [Lane3]),
    ) -> f32 {
        let (b, mut x, mut scratch) = (bending(2), folded(0.5), LengthScratch::new(POINTS));
        let mut force = vec![ZERO3; POINTS];
        let fold = |x: &[Lane3]| {
            (1..POINTS - 1)
                .map(|i| (at(&x[i - 1], 0) - 2.0 * at(&x[i], 0) + at(&x[i + 1], 0)).length())
                .sum::<f32>()
        };
        let start = fold(&x);
        for _ in 0..rounds {
            let bend = |i: usize| {
                if i == 0 || i + 1 >= POINTS {
                    return Vec3::ZERO;
                }
                (at(&x[i - 1], 0) - 2.0 * at(&x[i], 0) + at(&x[i + 1], 0)) * b.stiffness(i)[0]
            };
            let rows: Vec<Vec3> =
                (0..POINTS).map(|i| 2.0 * bend(i) - bend(i.max(1) - 1) - bend(i + 1)).collect();
            for (row, v) in force.iter_mut().zip(rows) {
                for k in 0..LANES {
                    put(row, k, v);
                }
            }
            b.solve(2, &mut force);
            for i in 2..POINTS {
                for k in 0..LANES {
                    let p = at(&x[i], k) + at(&force[i], k);
                    put(&mut x[i], k, p);
                }
            }
            project(&b, &mut x, &mut scratch, &mut force);
        }
        fold(&x) / start
    }

    #[test]
    fn a_folded_guide_unfolds_at_the_rate_of_its_damping() {
        let length = [Lane::splat(LINK); POINTS];
        let together = left_of_fold(8, |b, x, scratch, force| {
            coupled(b, 2).project(2, &length, x, b, scratch, force, Some(&Map::IDENTITY));
        });
        // Without inertia a stiff bend decays by 1 - 1 / (1 + gamma) per substep: 0.37 after eight, with
        // gamma 7.2.
        assert!((0.3..0.45).contains(&together), "{together} of the fold is left");
        // Control: a length step that ignores bends folds the guide again.
        let apart = left_of_fold(8, |_, x, scratch, _| project_position(2, &length, x, scratch));
        assert!(apart > 0.7, "{apart} of the fold is left where lengths ignore bends");
    }
}
