//! Lengths and bends solved as one: the step of the links' lengths, in the metric of the bends.
//!
//! Bends are solved without lengths, and the lengths are then put right by moving points. Where every point moves
//! as easily as any other, that takes back what the bends have done: a lock that is folded link by link can only
//! straighten by pushing all that hangs below it along, which costs more than folding again. So the step of the
//! lengths is taken in the norm of the implicit bends, `A = 1 + hold + (1 + gamma) D2^T c D2`: what would bend
//! the lock costs as much as its stiffness says. It is then the exact solution of one linear system,
//! `[A J^T; J 0]`, as in fast projection (Goldenthal et al. 2007) with bends taken implicitly.
//!
//! The multipliers solve `S l = r` with `S_ij = (n_i . n_j) H_ij`, where `H = D A^-1 D^T` is how the difference
//! across link `i` answers a force along link `j`. `A` does not know directions, so `H` depends on settings and
//! time step alone and is worked out with the factors; `S` is dense, symmetric and positive definite (the Schur
//! product of two such matrices), and is solved by Cholesky's method.

use super::bending::Bending;
use super::lengths::LengthScratch;
use crate::lanes::{LANES, Lane, Lane3, Map, ZERO, ZERO3, at, choose, greater, inv_sqrt, put, row_done};

/// Factors serve as long as no link has turned further than this against the head since they were made: its radians, squared.
const ALIKE: f32 = 0.1 * 0.1;

/// A pivot below this part of its diagonal is rounding.
const LEAST_PIVOT: f32 = 1e-4;

/// The metric of one block. Rows and columns are links.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coupled {
    /// `H` in tiles, as they are asked for: those of two columns from the diagonal down, and then the next two columns'. Above
    /// the diagonal and beyond the last link there is nothing.
    response: Vec<Tile>,
    links: usize,
    /// The directions of the links, in head space, that the factor is of or will be: the only state that there is here.
    pub(crate) directions: Vec<Lane3>,
    factor: Factor,
}

/// Cholesky's factor of `S`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Factor {
    /// In panels of [`ROWS`] rows, each column by column: what is summed up is summed up for all rows of a panel at once.
    /// Entries on and above the diagonal, and of rows that are not there, are 0.
    panels: Vec<Lane>,
    /// One over the factor's diagonal; 0 for rows that are not there.
    inv_diagonal: Vec<Lane>,
    links: usize,
    /// Whether it has been worked out.
    made: bool,
}

/// Rows of a panel of the factor.
const ROWS: usize = 4;

/// Rows and columns of the factor that are worked out together: as many as registers of any width hold.
const TILE: usize = 2;

/// `s - a b^T` over all columns of two panels that are there, from row `i` of the one and `j` of the other on.
#[inline(always)]
fn less_products(s: Tile, a: &[Lane], i: usize, b: &[Lane], j: usize) -> Tile {
    // Through memory, where the lanes lie side by side: otherwise the compiler may keep lanes apart that were worked out
    // apart, and take the whole loop in pieces of a register.
    let mut s = std::hint::black_box(s);
    for (a, b) in a.as_chunks::<ROWS>().0.iter().zip(b.as_chunks::<ROWS>().0) {
        for (sums, a) in s.iter_mut().zip(&a[i..i + TILE]) {
            for (sum, b) in sums.iter_mut().zip(&b[j..j + TILE]) {
                *sum = sum.less_product(*a, *b);
            }
        }
    }
    std::hint::black_box(s)
}

/// Rows, and the columns of each.
type Tile = [[Lane; TILE]; TILE];

const NO_TILE: Tile = [[ZERO; TILE]; TILE];

/// The tile of `S` at row `r` and column `c` for links along `directions`; `response` is that of `H`.
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
            row_done();
        }
    }
    s
}

/// One over the root of a pivot, of whose diagonal `whole` was there before elimination.
#[inline(always)]
fn inv_root(pivot: Lane, whole: Lane) -> Lane {
    let mut inv = ZERO;
    for k in 0..LANES {
        inv[k] = inv_sqrt(greater(pivot[k], greater(LEAST_PIVOT * whole[k], 1e-9)));
    }
    inv
}

/// Where panel `p` of the factor begins.
#[inline(always)]
fn panel(p: usize) -> usize {
    ROWS * ROWS * p * (p + 1) / 2
}

impl Coupled {
    pub(crate) fn new(points: usize) -> Self {
        Self { directions: vec![ZERO3; points], ..Self::default() }
    }

    /// Forgets the factor and what it is of.
    pub(crate) fn forget(&mut self) {
        self.directions.fill(ZERO3);
        self.forget_factor();
    }

    /// Forgets the factor: it is made anew, of the directions that are known.
    pub(crate) fn forget_factor(&mut self) {
        self.factor.made = false;
    }

    /// Works out `H` for factors of `bending` that have just been made; `first_free` is the first point that is not carried.
    #[inline(always)]
    pub(crate) fn prepare(&mut self, bending: &Bending, first_free: usize, points: usize) {
        let first = first_free.max(1);
        let links = points.saturating_sub(first);
        self.links = links;
        self.forget_factor();
        // So many tiles each two columns have.
        let most = links.div_ceil(TILE);
        self.response.clear();
        self.response.resize(most * (most + 1) / 2, NO_TILE);
        bending.response(first_free, |r, c, value| {
            let (row, column) = (r / TILE, c / TILE);
            let before = column * (2 * most + 1 - column) / 2;
            self.response[before + row - column][r % TILE][c % TILE] = value;
        });
    }

    /// Sees to it that the factor is of directions like those in `scratch`; `to_head` turns them into head space. A lane that has
    /// turned takes its new directions, and the others keep theirs: of these they get the same factor again.
    #[inline(always)]
    fn renew(&mut self, first: usize, scratch: &LengthScratch, to_head: &Map) {
        let mut furthest = ZERO;
        for (n, was) in scratch.direction[first..].iter().zip(&self.directions[first..]) {
            for k in 0..LANES {
                let turned = (to_head.rotate(at(n, k)) - at(was, k)).length_squared();
                // What is not a number stays.
                furthest[k] = if turned > furthest[k] || turned.is_nan() { turned } else { furthest[k] };
            }
        }
        let alike = furthest.map(|turned| turned <= ALIKE);
        if alike == [true; LANES] && self.factor.made {
            return;
        }
        for (n, to) in scratch.direction[first..].iter().zip(&mut self.directions[first..]) {
            let mut next = *to;
            for k in 0..LANES {
                let turned = choose(alike[k], at(to, k), to_head.rotate(at(n, k)));
                put(&mut next, k, turned);
            }
            *to = next;
        }
        self.factor.factorise(&self.response, self.links, &self.directions[first..]);
    }

    /// One Newton step that brings the links of `position` to their lengths. `force` is working memory. With `to_head`,
    /// the turn into head space, `S` is factorised anew where directions have changed; without it, the factors are those of
    /// the last call.
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
            self.renew(first, scratch, to_head);
        }
        self.factor.solve(first, scratch);
        // What the links pull a point with: its own the one way, the next the other.
        let (mut own, mut one, mut two) = (ZERO3, ZERO3, ZERO3);
        for i in first..count {
            let (n, l) = (&scratch.direction[i], scratch.multiplier[i]);
            let pull = [n[0].times(l), n[1].times(l), n[2].times(l)];
            if i > first_free {
                let both = [own[0].less(pull[0]), own[1].less(pull[1]), own[2].less(pull[2])];
                let left = bending.down(i - 1, &both, &one, &two);
                force[i - 1] = left;
                (two, one) = (one, left);
            }
            own = pull;
        }
        force[count - 1] = bending.down(count - 1, &own, &one, &two);
        bending.finish(first_free, force, position);
    }
}

impl Factor {
    /// Factorises `S` for `links` links along `directions`, of whose metric `response` is the `H`.
    #[inline(always)]
    fn factorise(&mut self, response: &[Tile], links: usize, directions: &[Lane3]) {
        if self.links != links {
            self.links = links;
            self.panels.clear();
            self.panels.resize(panel(links.div_ceil(ROWS)), ZERO);
            self.inv_diagonal.clear();
            self.inv_diagonal.resize(ROWS * links.div_ceil(ROWS), ZERO);
        }
        self.made = true;
        // Two columns by two rows at a time: what is loaded is used twice, and no sum waits for another. Each two columns from
        // their diagonal down: below it no tile waits for the one before.
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
                let s = less_products(s, &own[..ROWS * c], r % ROWS, &other[..ROWS * c], c % ROWS);
                for (i, row) in s.iter().enumerate().take(links - r) {
                    let one = row[0].times(inv[0]);
                    let two = row[1].less_product(one, corner).times(inv[1]);
                    own[ROWS * c + r % ROWS + i] = one;
                    own[ROWS * (c + 1) + r % ROWS + i] = two;
                    row_done();
                }
            }
        }
    }

    /// The tile on the diagonal at row and column `c`.
    #[inline(always)]
    fn pivots(&mut self, response: &Tile, c: usize, directions: &[Lane3]) {
        let own = &mut self.panels[panel(c / ROWS)..];
        let whole = products(response, c, c, &directions[..self.links]);
        let s = less_products(whole, &own[..ROWS * c], c % ROWS, &own[..ROWS * c], c % ROWS);
        let inv = inv_root(s[0][0], whole[0][0]);
        self.inv_diagonal[c] = inv;
        if c + 1 < self.links {
            let below = s[1][0].times(inv);
            own[ROWS * c + c % ROWS + 1] = below;
            self.inv_diagonal[c + 1] = inv_root(s[1][1].less_product(below, below), whole[1][1]);
        }
    }

    /// Solves for the rows of panel `p` alone, from the first on. Row by row, that they stay in registers.
    #[inline(always)]
    fn down_corner(&self, p: usize, [a, b, c, d]: [Lane; ROWS]) -> [Lane; ROWS] {
        let (l, inv) = self.corner(p);
        let a = a.times(inv[0]);
        let b = b.less_product(l[0][1], a).times(inv[1]);
        let c = c.less_product(l[0][2], a).less_product(l[1][2], b).times(inv[2]);
        let d = d.less_product(l[0][3], a).less_product(l[1][3], b).less_product(l[2][3], c).times(inv[3]);
        [a, b, c, d]
    }

    /// The same with the transpose, from the last on.
    #[inline(always)]
    fn up_corner(&self, p: usize, [a, b, c, d]: [Lane; ROWS]) -> [Lane; ROWS] {
        let (l, inv) = self.corner(p);
        let d = d.times(inv[3]);
        let c = c.less_product(l[2][3], d).times(inv[2]);
        let b = b.less_product(l[1][3], d).less_product(l[1][2], c).times(inv[1]);
        let a = a.less_product(l[0][3], d).less_product(l[0][2], c).less_product(l[0][1], b).times(inv[0]);
        [a, b, c, d]
    }

    /// The columns of panel `p` that have a row of it on the diagonal, and one over what is there.
    #[inline(always)]
    fn corner(&self, p: usize) -> (&[[Lane; ROWS]], &[Lane]) {
        (
            &self.panels[panel(p) + ROWS * ROWS * p..].as_chunks().0[..ROWS],
            &self.inv_diagonal[ROWS * p..][..ROWS],
        )
    }

    /// Solves for the multipliers with the factors that are there, in place of the right side.
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
                    *y = y.less_product(*l, *x);
                }
            }
            let y = self.down_corner(p, y);
            own[..rows].copy_from_slice(&y[..rows]);
        }
        for p in (0..links.div_ceil(ROWS)).rev() {
            let (start, factor) = (ROWS * p, &self.panels[panel(p)..]);
            let rows = ROWS.min(links - start);
            let (before, own) = x.split_at_mut(start);
            let y = std::array::from_fn(|r| if r < rows { own[r] } else { ZERO });
            let y = self.up_corner(p, y);
            for (l, x) in factor.as_chunks::<ROWS>().0.iter().zip(before) {
                let mut sum = *x;
                for (y, l) in y.iter().zip(l).rev() {
                    sum = sum.less_product(*l, *y);
                }
                *x = sum;
                row_done();
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
            first_free,
        };
        b.prepare(
            key,
            &Lane::splat(LINK),
            &[Lane::splat(1.0 / LINK); POINTS],
            &[ZERO3; POINTS],
            &[Lane::splat(-1.0); POINTS],
        );
        b
    }

    fn coupled(b: &Bending, first_free: usize) -> Coupled {
        let mut c = Coupled::new(POINTS);
        c.prepare(b, first_free, POINTS);
        c
    }

    /// A lock folded link by link, `fold` radians to either side of straight down, the same in every lane.
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
    fn a_newton_step_in_the_metric_of_bends_squares_the_error_of_lengths() {
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
            // A step moves folded links by about their errors' size sideways: measured 3.6 times the square.
            assert!(before > 0.02 && after < 5.0 * before * before, "{before} became {after}");
            assert!((0..first_free).all(|i| x[i] == was[i]), "what is carried was moved");
        }
    }

    /// Rounds of bends and lengths without inertia, and how much of the fold is left.
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
    fn a_folded_lock_unfolds_at_the_rate_of_its_damping() {
        let length = [Lane::splat(LINK); POINTS];
        let together = left_of_fold(8, |b, x, scratch, force| {
            coupled(b, 2).project(2, &length, x, b, scratch, force, Some(&Map::IDENTITY));
        });
        // Without inertia a stiff bend dies by 1 - 1 / (1 + gamma) a substep: 0.37 after eight, gamma 7.2.
        assert!((0.3..0.45).contains(&together), "{together} of the fold is left");
        // The control: lengths put right without regard to bends fold the lock again.
        let apart = left_of_fold(8, |_, x, scratch, _| project_position(2, &length, x, scratch));
        assert!(apart > 0.7, "{apart} of the fold is left where lengths do not know of bends");
    }
}
