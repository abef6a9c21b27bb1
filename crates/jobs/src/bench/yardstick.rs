//! Three figures of the machine. Times are given in multiples of them, so that results of different machines compare.

use std::fmt;
use std::hint::black_box;

use lovelock_base::clock::Stopwatch;
use lovelock_base::simd::Width;
use lovelock_base::speed::{CHAINS, LINKS, chains, scatter};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How fast this machine is at three basic operations, with all threads of the pool.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Yardstick {
    /// Memory copied, 10⁹ bytes per second. Each byte is read once and written once.
    pub copy_gb_per_s: f64,
    /// Multiply-adds of `f32`, 10⁹ per second, in 64 chains per thread. Each chain waits for its previous result. A multiply-add
    /// is a product and a sum with two roundings.
    pub multiply_adds_g_per_s: f64,
    /// Additions of integers at random places of a table that is larger than the cache, 10⁶ per second.
    pub scattered_adds_m_per_s: f64,
}

/// The figure of the yardstick that bounds a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Bound {
    /// Reading and writing memory in order.
    Copy,
    /// Arithmetic.
    MultiplyAdds,
    /// Reading and writing memory at places that data choose.
    ScatteredAdds,
}

/// Seconds for which each figure is measured, after a pass that is not counted. The figure is that of the fastest pass.
const SECS: f64 = 0.25;
/// The largest factor between the figures at the beginning and at the end of a run on a steady machine.
const STEADY: f64 = 1.25;
/// Bytes that one pass copies.
const COPIED: usize = 128 << 20;
/// Bytes of all tables of the scattered sum together.
const TABLE: usize = 256 << 20;
/// Scattered additions per pass.
const ADDITIONS: usize = 1 << 21;

impl Yardstick {
    /// Measures this machine in about a second. Uses at most 256 MiB.
    pub fn measure() -> Self {
        let threads = rayon::current_num_threads();
        let copied_secs = {
            let from = vec![1_u8; COPIED];
            let mut into = vec![0_u8; COPIED];
            let piece = COPIED.div_ceil(threads);
            fastest(|| {
                let pieces = into.par_chunks_mut(piece).zip(from.par_chunks(piece));
                pieces.for_each(|(into, from)| into.copy_from_slice(from));
                black_box(&mut into);
            })
        };
        let width = Width::widest();
        let chained_secs = fastest(|| {
            let ends: f32 = (0..threads)
                .into_par_iter()
                .with_max_len(1)
                .map(|_| chains(width, black_box(0.5), black_box(1.0)))
                .sum();
            black_box(ends);
        });
        let scattered_secs = {
            // A power of two per thread, so that a place is a few bits of a random number.
            let entries = 1 << (TABLE / size_of::<u32>() / threads).max(1 << 10).ilog2();
            let mut tables = vec![vec![0_u32; entries]; threads];
            fastest(|| {
                tables.par_iter_mut().enumerate().with_max_len(1).for_each(|(thread, table)| {
                    scatter(table, thread as u64, ADDITIONS / threads);
                });
                black_box(&mut tables);
            })
        };
        Self {
            copy_gb_per_s: COPIED as f64 / copied_secs / 1e9,
            multiply_adds_g_per_s: (CHAINS * LINKS * threads) as f64 / chained_secs / 1e9,
            scattered_adds_m_per_s: (ADDITIONS / threads * threads) as f64 / scattered_secs / 1e6,
        }
    }

    /// The time of one unit of work, nanoseconds: a byte copied, a multiply-add or a scattered addition, with all threads at work.
    pub fn unit_ns(&self, bound: Bound) -> f64 {
        match bound {
            Bound::Copy => 1.0 / self.copy_gb_per_s,
            Bound::MultiplyAdds => 1.0 / self.multiply_adds_g_per_s,
            Bound::ScatteredAdds => 1e3 / self.scattered_adds_m_per_s,
        }
    }

    /// A sentence if this machine was faster or slower at the end of a run, `after`, than at its beginning.
    pub(super) fn change_note(&self, after: &Self) -> Option<String> {
        let bounds = [Bound::Copy, Bound::MultiplyAdds, Bound::ScatteredAdds];
        let changed = bounds.into_iter().any(|bound| {
            let ratio = self.unit_ns(bound) / after.unit_ns(bound);
            !(1.0 / STEADY..=STEADY).contains(&ratio)
        });
        changed.then(|| {
            format!(
                "the speed of the machine changed during the run, so multiples are rough; at the end, {after}"
            )
        })
    }

    /// Whether all figures can divide a time.
    pub(super) fn is_usable(&self) -> bool {
        let Self { copy_gb_per_s, multiply_adds_g_per_s, scattered_adds_m_per_s } = *self;
        [copy_gb_per_s, multiply_adds_g_per_s, scattered_adds_m_per_s]
            .into_iter()
            .all(|figure| figure.is_finite() && figure > 0.0)
    }
}

impl fmt::Display for Yardstick {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "yardstick: {:.1} GB/s copied, {:.1} G multiply-adds/s in {CHAINS} chains per thread, {:.0} M scattered additions/s",
            self.copy_gb_per_s, self.multiply_adds_g_per_s, self.scattered_adds_m_per_s
        )
    }
}

/// Seconds of the fastest of several passes.
fn fastest(mut pass: impl FnMut()) -> f64 {
    pass();
    let (whole, mut least) = (Stopwatch::start(), f64::INFINITY);
    while whole.secs() < SECS {
        let watch = Stopwatch::start();
        pass();
        least = least.min(watch.secs());
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_the_inverse_of_rates() {
        let yardstick =
            Yardstick { copy_gb_per_s: 10.0, multiply_adds_g_per_s: 50.0, scattered_adds_m_per_s: 200.0 };
        assert_eq!(yardstick.unit_ns(Bound::Copy), 0.1);
        assert_eq!(yardstick.unit_ns(Bound::MultiplyAdds), 0.02);
        assert_eq!(yardstick.unit_ns(Bound::ScatteredAdds), 5.0);
        assert!(yardstick.is_usable());
        for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(!Yardstick { copy_gb_per_s: wrong, ..yardstick }.is_usable());
        }
    }

    #[test]
    fn a_machine_that_changes_its_speed_is_reported() {
        let yardstick =
            Yardstick { copy_gb_per_s: 10.0, multiply_adds_g_per_s: 50.0, scattered_adds_m_per_s: 200.0 };
        assert_eq!(yardstick.change_note(&yardstick), None);
        assert_eq!(yardstick.change_note(&Yardstick { copy_gb_per_s: 12.0, ..yardstick }), None);
        for multiply_adds_g_per_s in [25.0, 100.0] {
            let note =
                yardstick.change_note(&Yardstick { multiply_adds_g_per_s, ..yardstick }).expect("a note");
            assert!(note.contains("at the end, yardstick: 10.0 GB/s copied"), "{note}");
        }
    }

    #[test]
    fn multiply_adds_are_counted_in_vectors() {
        if cfg!(debug_assertions) {
            return;
        }
        let pass = || {
            black_box(chains(Width::widest(), black_box(0.5), black_box(1.0)));
        };
        let ms = (0..5).map(|_| lovelock_testkit::clock::alone_ms(pass)).fold(f64::MAX, f64::min);
        let g_per_s = (CHAINS * LINKS) as f64 / ms / 1e6;
        // Measured: 38 per thread in vectors of 512 bits; 0.4 where the loop was compiled without them.
        assert!(g_per_s > 4.0, "{g_per_s:.1} G multiply-adds/s");
    }
}
