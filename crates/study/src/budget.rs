//! Which method to take for a budget of time and memory, and which ones nobody needs.

use crate::report::{BudgetReport, CompareReport, MethodReport, TimeSpread};

/// Budgets of time, milliseconds to build and look up the maps.
const TIMES: [f64; 10] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, f64::INFINITY];
/// Budgets of memory, bytes of the maps.
const MEMORIES: [u64; 5] = [1 << 20, 10 << 20, 100 << 20, 1 << 30, u64::MAX];
/// Fewer times have no spread that could show whether they differ.
const LEAST_TIMINGS: u32 = 3;

/// What a method costs and how much it errs.
#[derive(Clone, Copy, Debug)]
struct Offer<'a> {
    method: &'a MethodReport,
    ms: f64,
    /// The 10th and the 90th percentile of the time.
    low_ms: f64,
    high_ms: f64,
    /// How often the time was measured.
    timings: u32,
    memory: u64,
    error: f64,
}

impl<'a> Offer<'a> {
    /// `None` if one of the numbers is missing.
    fn of(method: &'a MethodReport) -> Option<Self> {
        let ms = method.ms.and_then(|ms| Some(ms.build? + ms.query?))?;
        let spread = |name: &str| method.times.iter().find(|time| time.name == name);
        let both = spread("build").zip(spread("query"));
        let sum = |of: fn(&TimeSpread) -> f64| both.map_or(ms, |(build, query)| of(build) + of(query));
        Some(Self {
            method,
            ms,
            low_ms: sum(|time| time.low).min(ms),
            high_ms: sum(|time| time.high).max(ms),
            timings: both.map_or(0, |(build, query)| build.count.min(query.count)),
            memory: method.memory_bytes?,
            error: method.front_error()?,
        })
    }

    fn fits(&self, ms: f64, memory: u64) -> bool {
        self.ms <= ms && self.memory <= memory
    }

    fn is_timed(&self) -> bool {
        self.timings >= LEAST_TIMINGS
    }

    /// Whether this one is at least as good as another in error, time and memory, and either its error is smaller by more than `doubt`
    /// or the middle 80 % of the times do not overlap.
    fn beats(&self, other: &Self, doubt: f64) -> bool {
        let as_good = self.ms <= other.ms && self.memory <= other.memory && self.error <= other.error;
        let surely_faster = self.is_timed() && other.is_timed() && self.high_ms < other.low_ms;
        as_good && (other.error - self.error > doubt || surely_faster)
    }
}

/// Errors that differ by less may be equal: the ground truth may be off by its last change, for both.
fn doubt(report: &CompareReport) -> f64 {
    2.0 * f64::from(report.reference.change)
}

/// The methods that can be compared with each other: same backend, device, drawing and transparency.
fn groups(methods: &[MethodReport]) -> Vec<Vec<Offer<'_>>> {
    let key = |method: &MethodReport| {
        let of = |text: &String| text.clone();
        [of(&method.backend), of(&method.adapter), of(&method.draw), of(&method.transparency)]
    };
    let mut keys = Vec::new();
    for key in methods.iter().map(key) {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    let of = |wanted: &[String; 4]| {
        let same = methods.iter().filter(|method| key(method) == *wanted);
        same.filter_map(Offer::of).collect()
    };
    keys.iter().map(of).collect()
}

/// The most accurate method of each group within each budget. A larger budget with the same winner is left out. Budgets without a
/// runner-up are kept: then there is no choice.
pub(crate) fn winners(report: &CompareReport) -> Vec<BudgetReport> {
    let mut all: Vec<BudgetReport> = Vec::new();
    for offers in groups(&report.methods) {
        let first = all.len();
        for (ms, memory) in TIMES.iter().flat_map(|ms| MEMORIES.iter().map(move |memory| (*ms, *memory))) {
            let mut fitting: Vec<_> = offers.iter().filter(|offer| offer.fits(ms, memory)).collect();
            fitting.sort_by(|a, b| a.error.total_cmp(&b.error));
            let Some(best) = fitting.first() else { continue };
            let smaller = |won: &BudgetReport| {
                won.method == best.method.name
                    && won.ms.unwrap_or(f64::INFINITY) <= ms
                    && won.memory_bytes.unwrap_or(u64::MAX) <= memory
            };
            if all[first..].iter().any(smaller) {
                continue;
            }
            let next = fitting.get(1);
            let apart = next.is_none_or(|next| next.error - best.error > doubt(report));
            // Without a limit of time, nothing depends on how often it was measured.
            let timings = next.map_or(best.timings, |next| best.timings.min(next.timings));
            let timed = ms.is_infinite() || timings >= LEAST_TIMINGS;
            all.push(BudgetReport {
                ms: ms.is_finite().then_some(ms),
                memory_bytes: (memory != u64::MAX).then_some(memory),
                method: best.method.name.clone(),
                rmse: best.error,
                next: next.map(|next| next.method.name.clone()),
                next_rmse: next.map(|next| next.error),
                certain: apart && timed && best.high_ms <= ms,
            });
        }
    }
    all
}

/// Names of the methods that another one of their group beats beyond doubt, each with that other one: the most accurate of several.
pub(crate) fn beaten(report: &CompareReport) -> Vec<(String, String)> {
    let (mut all, doubt) = (Vec::new(), doubt(report));
    for offers in groups(&report.methods) {
        for offer in &offers {
            let better = offers.iter().filter(|other| other.beats(offer, doubt));
            if let Some(best) = better.min_by(|a, b| a.error.total_cmp(&b.error)) {
                all.push((offer.method.name.clone(), best.method.name.clone()));
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Reference, StageMs, TransmittanceError};

    fn method(name: &str, ms: f64, memory: u64, rmse: f64) -> MethodReport {
        let time = |name: &str, median: f64| TimeSpread {
            name: name.to_owned(),
            median,
            low: 0.9 * median,
            high: median,
            count: 30,
        };
        MethodReport {
            name: name.to_owned(),
            ms: Some(StageMs { build: Some(ms), query: Some(0.0), ..StageMs::default() }),
            times: vec![time("build", ms), time("query", 0.0)],
            memory_bytes: Some(memory),
            transmittance_common: Some(TransmittanceError { rmse, ..TransmittanceError::default() }),
            ..MethodReport::default()
        }
    }

    fn report() -> CompareReport {
        CompareReport {
            methods: vec![
                method("small", 1.5, 1 << 20, 0.05),
                method("large", 1.5, 50 << 20, 0.02),
                method("slow", 40.0, 2 << 20, 0.0199),
                method("useless", 50.0, 60 << 20, 0.06),
            ],
            reference: Reference { change: 0.0004, ..Reference::default() },
            ..CompareReport::default()
        }
    }

    #[test]
    fn each_budget_has_the_most_accurate_method_that_fits_it() {
        let found = winners(&report());
        let of = |won: &BudgetReport| (won.ms, won.memory_bytes, won.method.clone(), won.certain);
        assert_eq!(
            found.iter().map(of).collect::<Vec<_>>(),
            [
                (Some(2.0), Some(1 << 20), "small".to_owned(), true),
                (Some(2.0), Some(100 << 20), "large".to_owned(), true),
                (Some(50.0), Some(10 << 20), "slow".to_owned(), true),
            ]
        );
        assert_eq!(found[1].next.as_deref(), Some("small"));
        // With 100 MiB, the slow one is hardly better than the large one: not certain. Its smaller budget is listed already.
        let mut close = report();
        close.methods[2].memory_bytes = Some(60 << 20);
        let last = winners(&close).pop().expect("a budget");
        assert_eq!((last.method.as_str(), last.certain), ("slow", false));
    }

    #[test]
    fn who_is_beaten_in_everything_is_named_with_a_better_one() {
        assert_eq!(beaten(&report()), [("useless".to_owned(), "slow".to_owned())]);
        // Control: what nobody has measured beats nobody.
        let mut missing = report();
        missing.methods.iter_mut().for_each(|method| method.memory_bytes = None);
        assert_eq!((beaten(&missing), winners(&missing)), (Vec::new(), Vec::new()));
    }

    #[test]
    fn nobody_is_beaten_within_the_doubt() {
        let mut close = CompareReport {
            methods: vec![method("deep", 147.0, 3 << 20, 0.0359), method("clusters", 126.0, 1 << 20, 0.0357)],
            reference: Reference { change: 0.0015, ..Reference::default() },
            ..CompareReport::default()
        };
        close.methods[0].times[0].low = 123.0;
        close.methods[1].times[0].high = 158.0;
        assert!(beaten(&close).is_empty());
        let deep = [("deep".to_owned(), "clusters".to_owned())];
        let mut accurate = close.clone();
        accurate.reference.change = 0.000_05;
        assert_eq!(beaten(&accurate), deep);
        let mut faster = close.clone();
        faster.methods[0].times[0].low = 130.0;
        faster.methods[1].times[0].high = 129.0;
        assert_eq!(beaten(&faster), deep);
        // Of two times, the percentiles are those times.
        faster.methods[0].times[1].count = 2;
        assert!(beaten(&faster).is_empty());
    }

    #[test]
    fn a_choice_by_fewer_than_three_times_is_not_certain() {
        let mut once = report();
        once.methods[2].times[0].count = 1;
        let certain =
            |report: &CompareReport| -> Vec<bool> { winners(report).iter().map(|won| won.certain).collect() };
        assert_eq!(certain(&once), [true, true, false]);
        // The runner-up's times count too, and those of a method alone.
        once.methods[0].times[0].count = 2;
        assert_eq!(certain(&once), [false, false, false]);
        // Control: without a limit of time, a larger error stays a larger error.
        let mut slow = report();
        slow.methods = vec![method("a", 600.0, 2 << 30, 0.02), method("b", 600.0, 2 << 30, 0.03)];
        slow.methods.iter_mut().for_each(|method| method.times.clear());
        assert_eq!(certain(&slow), [true]);
    }
}
