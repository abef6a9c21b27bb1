//! Prediction of the numbers of a chunk from the numbers before them, so that only small residuals are stored.
//!
//! The predicted numbers are links: the difference of each point and the one before it on its guide; the first point is a link
//! itself. A link is predicted from its values in the three frames before and from the motion of the two links above it in
//! this frame and the last. The coefficients are fitted for every row of points by least squares and stored. Integer
//! arithmetic makes decoding exact on every machine.

use super::layout::Layout;

/// Number of values that a prediction combines.
pub(super) const TAPS: usize = 6;

/// Weights of the taps in units of 1/4096.
pub(super) type Coefficients = [i16; TAPS];

/// Fraction bits of a coefficient.
const PLACES: u32 = 12;

/// Coefficients for the first three frames of a chunk: only the motion of the link above; the link's last value plus that
/// motion; then the same with the link's velocity.
const EARLY: [Coefficients; 3] =
    [[0, 0, 4096, 0, 0, 0], [4096, 0, 4096, 0, 0, 0], [8192, -4096, 4096, -4096, 0, 0]];

/// The least number of guides that the coefficients are fitted to. Not all are needed, because neighbours move alike.
const FITTED: usize = 96;

/// The numbers of a chunk, ordered by point, then by frame, by axis and by guide.
#[derive(Debug)]
pub(super) struct Rows {
    numbers: Vec<i32>,
    /// A row of zeros, used before the first frame and above the root.
    zeros: Vec<i32>,
    frames: usize,
    guides: usize,
}

impl Rows {
    pub(super) fn new(frames: usize, layout: Layout) -> Self {
        Self {
            numbers: vec![0; frames * layout.numbers()],
            zeros: vec![0; layout.guides],
            frames,
            guides: layout.guides,
        }
    }

    /// The links of consecutive frames, each in the order of [`Layout::numbers`].
    pub(super) fn links_of(numbers: &[i32], frames: usize, layout: Layout) -> Self {
        let Layout { guides, points } = layout;
        let mut rows = Self::new(frames, layout);
        for (frame, numbers) in numbers.chunks_exact(layout.numbers()).enumerate() {
            for axis in 0..3 {
                let plane = &numbers[axis * points * guides..][..points * guides];
                rows.row_mut(0, frame, axis).copy_from_slice(&plane[..guides]);
                for point in 1..points {
                    let (above, here) = plane[(point - 1) * guides..][..2 * guides].split_at(guides);
                    for ((to, &a), &b) in rows.row_mut(point, frame, axis).iter_mut().zip(above).zip(here) {
                        *to = b.wrapping_sub(a);
                    }
                }
            }
        }
        rows
    }

    /// Converts links back to points.
    pub(super) fn add_up(&mut self) {
        let point = self.frames * 3 * self.guides;
        for at in point..self.numbers.len() {
            self.numbers[at] = self.numbers[at].wrapping_add(self.numbers[at - point]);
        }
    }

    /// Bytes that the numbers take in memory.
    pub(super) fn bytes(&self) -> usize {
        (self.numbers.len() + self.zeros.len()) * size_of::<i32>()
    }

    fn start(&self, point: usize, frame: usize, axis: usize) -> usize {
        ((point * self.frames + frame) * 3 + axis) * self.guides
    }

    /// One number per guide.
    pub(super) fn row(&self, point: usize, frame: usize, axis: usize) -> &[i32] {
        &self.numbers[self.start(point, frame, axis)..][..self.guides]
    }

    pub(super) fn row_mut(&mut self, point: usize, frame: usize, axis: usize) -> &mut [i32] {
        let start = self.start(point, frame, axis);
        &mut self.numbers[start..][..self.guides]
    }

    /// The row `up` points above and `back` frames before; zeros if there is none.
    fn near(&self, [point, frame, axis]: [usize; 3], up: usize, back: usize) -> &[i32] {
        match (point.checked_sub(up), frame.checked_sub(back)) {
            (Some(point), Some(frame)) => self.row(point, frame, axis),
            _ => &self.zeros,
        }
    }

    /// The rows from which the taps of a row are computed.
    fn taps(&self, at: [usize; 3]) -> [&[i32]; 8] {
        [(0, 1), (0, 2), (0, 3), (1, 0), (1, 1), (1, 2), (2, 0), (2, 1)]
            .map(|(up, back)| self.near(at, up, back))
    }

    /// Predicts a row from rows before it. `own` are the coefficients of its point.
    pub(super) fn predict(
        &self,
        point: usize,
        frame: usize,
        axis: usize,
        own: &Coefficients,
        out: &mut [i32],
    ) {
        let weights = EARLY.get(frame).unwrap_or(own).map(i32::from);
        // Slices of equal length, so that the compiler vectorises the loop.
        let out = &mut out[..self.guides];
        let [a, b, c, d, e, f, g, h] = self.taps([point, frame, axis]).map(|row| &row[..out.len()]);
        for (k, guess) in out.iter_mut().enumerate() {
            let values = tap_values([a[k], b[k], c[k], d[k], e[k], f[k], g[k], h[k]]);
            let mut sum = 1_i32 << (PLACES - 1);
            for tap in 0..TAPS {
                sum = sum.wrapping_add(weights[tap].wrapping_mul(values[tap]));
            }
            *guess = sum >> PLACES;
        }
    }
}

/// The taps, computed from the numbers of [`Rows::taps`].
#[inline]
fn tap_values([back1, back2, back3, up, up_back1, up_back2, upper, upper_back1]: [i32; 8]) -> [i32; TAPS] {
    [
        back1,
        back2,
        up.wrapping_sub(up_back1),
        up_back1.wrapping_sub(up_back2),
        back3,
        upper.wrapping_sub(upper_back1),
    ]
}

/// The coefficients that predict the rows of `point` best, by least squares.
pub(super) fn fit(links: &Rows, point: usize) -> Coefficients {
    let mut normal = [[0.0; TAPS]; TAPS];
    let mut right = [0.0; TAPS];
    let step = (links.guides / FITTED).max(1);
    for frame in EARLY.len()..links.frames {
        for axis in 0..3 {
            let taps = links.taps([point, frame, axis]);
            let row = links.row(point, frame, axis);
            for k in (0..links.guides).step_by(step) {
                let values = tap_values(taps.map(|row| row[k])).map(f64::from);
                let wanted = f64::from(row[k]);
                for i in 0..TAPS {
                    right[i] += values[i] * wanted;
                    for j in 0..=i {
                        normal[i][j] += values[i] * values[j];
                    }
                }
            }
        }
    }
    solve(normal, right).map(|value| {
        let scaled = (value * f64::from(1 << PLACES)).round();
        scaled.clamp(f64::from(i16::MIN), f64::from(i16::MAX)) as i16
    })
}

/// Solves a symmetric system, given by its lower half, by Cholesky decomposition. Undetermined unknowns become 0.
fn solve(mut normal: [[f64; TAPS]; TAPS], mut right: [f64; TAPS]) -> [f64; TAPS] {
    for i in 0..TAPS {
        // Regularisation: rows at rest have taps that are all zero or linearly dependent.
        normal[i][i] += normal[i][i] * 1e-6 + 1.0;
        for j in 0..i {
            let known: f64 = (0..j).map(|k| normal[i][k] * normal[j][k]).sum();
            normal[i][j] = (normal[i][j] - known) / normal[j][j];
        }
        let known: f64 = (0..i).map(|k| normal[i][k] * normal[i][k]).sum();
        normal[i][i] = (normal[i][i] - known).max(1e-3).sqrt();
    }
    for i in 0..TAPS {
        let known: f64 = (0..i).map(|k| normal[i][k] * right[k]).sum();
        right[i] = (right[i] - known) / normal[i][i];
    }
    for i in (0..TAPS).rev() {
        let known: f64 = (i + 1..TAPS).map(|k| normal[k][i] * right[k]).sum();
        right[i] = (right[i] - known) / normal[i][i];
    }
    right
}
