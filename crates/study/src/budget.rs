//! Which method to take for a budget of time and memory, and which ones nobody needs.

use crate::report::{BudgetReport, CompareReport, MethodReport};

/// Budgets of time, milliseconds to build and look up the maps.
const TIMES: [f64; 9] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 500.0, f64::INFINITY];
/// Budgets of memory, bytes of the maps.
const MEMORIES: [u64; 5] = [1 << 20, 10 << 20, 100 << 20, 1 << 30, u64::MAX];

/// What a method costs and how much it errs.
#[derive(Clone, Copy, Debug)]
struct Offer<'a> {
    method: &'a MethodReport,
    ms: f64,
    /// The 90th percentile of the time.
    high_ms: f64,
    memory: u64,
    error: f64,
}

impl<'a> Offer<'a> {
    /// `None` if one of the numbers is missing.
    fn of(method: &'a MethodReport) -> Option<Self> {
        let ms = method.ms.and_then(|ms| Some(ms.build? + ms.query?))?;
        let high = |name: &str| method.times.iter().find(|time| time.name == name).map(|time| time.high);
        let high_ms = high("build").zip(high("query")).map_or(ms, |(build, query)| build + query).max(ms);
        Some(Self { method, ms, high_ms, memory: method.memory_bytes?, error: method.front_error()? })
    }

    fn fits(&self, ms: f64, memory: u64) -> bool {
        self.ms <= ms && self.memory <= memory
    }

    /// Whether this one is at least as good as another in time, memory and error, and better in one.
    fn beats(&self, other: &Self) -> bool {
        let as_good = self.ms <= other.ms && self.memory <= other.memory && self.error <= other.error;
        as_good && (self.ms < other.ms || self.memory < other.memory || self.error < other.error)
    }
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
            // The ground truth may be off by its last change, for both.
            let doubt = 2.0 * f64::from(report.reference.change);
            let apart = next.is_none_or(|next| next.error - best.error > doubt);
            all.push(BudgetReport {
                ms: ms.is_finite().then_some(ms),
                memory_bytes: (memory != u64::MAX).then_some(memory),
                method: best.method.name.clone(),
                rmse: best.error,
                next: next.map(|next| next.method.name.clone()),
                next_rmse: next.map(|next| next.error),
                certain: apart && best.high_ms <= ms,
            });
        }
    }
    all
}

/// Names of the methods that another one of their group beats or equals in time, memory and error, each with that other one: the most
/// accurate of several.
pub(crate) fn beaten(report: &CompareReport) -> Vec<(String, String)> {
    let mut all = Vec::new();
    for offers in groups(&report.methods) {
        for offer in &offers {
            let better = offers.iter().filter(|other| other.beats(offer));
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
        MethodReport {
            name: name.to_owned(),
            ms: Some(StageMs { build: Some(ms), query: Some(0.0), ..StageMs::default() }),
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
}
