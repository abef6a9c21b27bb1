//! Which method to take for which budget, in words.

use std::fmt::Write as _;

use super::names::Names;
use super::words::{bytes, escaped, fixed};
use crate::report::{BudgetReport, CompareReport, MethodReport};

/// The sentences; empty if fewer than two methods have all numbers.
pub(super) fn section(report: &CompareReport, names: &Names) -> String {
    let choices = &report.budgets;
    let mut out = String::new();
    // One method alone is no choice.
    if choices.iter().any(|budget| budget.next.is_some() || budget.method != choices[0].method) {
        out += "<h3>Which method for which budget</h3><ul class=\"tests\">";
        for budget in choices {
            let _ = write!(out, "<li>{}</li>", sentence(budget, report, names));
        }
        out += "</ul>";
    }
    if !report.beaten.is_empty() {
        out += "<p>On this hair, by error of transmittance at its points, nobody needs: ";
        let of = |(method, better): &(String, String)| {
            format!(
                "<b>{}</b> (no better than {} in error, time or memory{})",
                named(method, report, names),
                named(better, report, names),
                times_the_error(method, better, report)
            )
        };
        let all: Vec<_> = report.beaten.iter().map(of).collect();
        let _ = write!(out, "{}.</p>", all.join(", "));
    }
    if !out.is_empty() {
        out += "<p class=\"note\">Computed from the tables. <i>Clear</i>: the error differs from that of the runner-up by more than twice the \
                last change of the reference, 9 of 10 measured times are within the budget, and both were timed at least three times. \
                <i>Nobody needs</i> a method if another one is at least as good in error, time and memory, and its error is smaller by more \
                than that, or the middle 80 % of the times do not overlap.</p>";
    }
    out
}

fn sentence(budget: &BudgetReport, report: &CompareReport, names: &Names) -> String {
    let limits: Vec<String> =
        [budget.ms.map(|ms| format!("{ms} ms")), budget.memory_bytes.map(|memory| bytes(Some(memory)))]
            .into_iter()
            .flatten()
            .collect();
    let limits = if limits.is_empty() {
        "Whatever it costs".to_owned()
    } else {
        format!("Up to {}", limits.join(" and "))
    };
    let before = |next| format!(", before {} ({})", named(next, report, names), fixed(budget.next_rmse, 4));
    let next = budget.next.as_deref().map_or_else(|| ", the only one that fits".to_owned(), before);
    let verdict = match (&budget.next, budget.certain) {
        // One method alone is no choice.
        (None, _) => "",
        (Some(_), true) => " Clear.",
        (Some(_), false) => " Not clear.",
    };
    format!(
        "{limits}: <b>{}</b>, RMSE {}{next}.{verdict}",
        named(&budget.method, report, names),
        fixed(Some(budget.rmse), 4)
    )
}

/// How many times as large the error of a method is as that of a better one, as the end of a phrase; empty below twice.
fn times_the_error(method: &str, better: &str, report: &CompareReport) -> String {
    let error = |name: &str| {
        report.methods.iter().find(|method| method.name == name).and_then(MethodReport::front_error)
    };
    let factor = error(method).zip(error(better)).map_or(1.0, |(error, least)| error / least.max(1e-9));
    if factor >= 2.0 { format!(", with {factor:.1} times its error") } else { String::new() }
}

/// The name on the page of a method.
fn named(name: &str, report: &CompareReport, names: &Names) -> String {
    let method = report.methods.iter().find(|method| method.name == name);
    escaped(&method.map_or_else(|| name.to_owned(), |method| names.full(method)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::TransmittanceError;

    #[test]
    fn twice_the_error_is_said() {
        let method = |name: &str, rmse| MethodReport {
            name: name.to_owned(),
            transmittance_common: Some(TransmittanceError { rmse, ..TransmittanceError::default() }),
            ..MethodReport::default()
        };
        let report = CompareReport {
            methods: vec![method("a", 0.05), method("b", 0.02), method("c", 0.03)],
            ..CompareReport::default()
        };
        assert_eq!(times_the_error("a", "b", &report), ", with 2.5 times its error");
        assert_eq!(times_the_error("c", "b", &report), "");
        assert_eq!(times_the_error("missing", "b", &report), "");
    }

    #[test]
    fn one_method_alone_is_not_called_clear() {
        let report = CompareReport::default();
        let names = Names::of(&report);
        let mut budget = BudgetReport {
            ms: Some(10.0),
            method: "Moments".to_owned(),
            rmse: 0.02,
            certain: true,
            ..BudgetReport::default()
        };
        let alone = "Up to 10 ms: <b>Moments</b>, RMSE 0.0200, the only one that fits.";
        assert_eq!(sentence(&budget, &report, &names), alone);
        (budget.next, budget.next_rmse) = (Some("Exact".to_owned()), Some(0.03));
        let before = "Up to 10 ms: <b>Moments</b>, RMSE 0.0200, before Exact (0.0300).";
        assert_eq!(sentence(&budget, &report, &names), format!("{before} Clear."));
        budget.certain = false;
        assert_eq!(sentence(&budget, &report, &names), format!("{before} Not clear."));
    }

    #[test]
    fn what_nobody_needs_has_no_verb_that_could_not_fit_its_name() {
        let report = CompareReport {
            beaten: vec![("Occupancy maps".to_owned(), "Opacity maps".to_owned())],
            ..CompareReport::default()
        };
        let text = section(&report, &Names::of(&report));
        let says = "<b>Occupancy maps</b> (no better than Opacity maps in error, time or memory).";
        assert!(text.contains(says), "{text}");
    }
}
