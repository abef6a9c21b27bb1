//! The figures of the page.

use std::collections::BTreeMap;

use lovelock_metrics::Spread;

use super::names::{Group, Names, color};
use super::plot::{Axis, Dot, Label, Plot, Stroke};
use super::words::{bytes, fixed, ms};
use crate::report::{CompareReport, FootprintTruth, MethodReport, ProbeReport};

/// The colour of the ground truth.
const TRUTH: &str = "#202124";

fn thin(color: &str) -> Stroke<'_> {
    Stroke { color, width: 1.75, dashed: false }
}

fn widened(points: &[(f32, f32)]) -> Vec<(f64, f64)> {
    points.iter().map(|&(x, y)| (f64::from(x), f64::from(y))).collect()
}

/// The kind of cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cost {
    /// Milliseconds to build and look up the maps.
    Time,
    /// Bytes of the maps.
    Memory,
}

impl Cost {
    fn of(self, method: &MethodReport) -> Option<f64> {
        match self {
            Self::Time => method.ms.and_then(|ms| Some(ms.build? + ms.query?)),
            Self::Memory => method.memory_bytes.map(|bytes| bytes as f64 / f64::from(1 << 20)),
        }
    }

    fn front(self, method: &MethodReport) -> bool {
        match self {
            Self::Time => method.front_of_time,
            Self::Memory => method.front_of_memory,
        }
    }
}

/// Error of transmittance against cost: one dot per method, filled on the front, with a line through the settings of a sweep.
/// `None` if fewer than two methods have both numbers.
pub(super) fn cost(group: &Group<'_>, names: &Names, cost: Cost) -> Option<String> {
    let points: Vec<(f64, f64, &MethodReport)> = (group.methods.iter())
        .filter_map(|(_, method)| Some((cost.of(method)?, method.front_error()?, *method)))
        .collect();
    if points.len() < 2 {
        return None;
    }
    let label = match cost {
        Cost::Time => format!("build and query, ms on the {}", group.backend),
        Cost::Memory => "shadow maps, MiB".into(),
    };
    // A method without cost has a large error; it is drawn on the edge, so that the others can be distinguished.
    let usual: Vec<f64> = points.iter().map(|point| point.0).filter(|cost| *cost > 0.0).collect();
    let usual = Spread::of(&usual).map_or(0.0, |spread| spread.median);
    let least = points.iter().map(|point| point.1).filter(|error| *error > 0.0).fold(f64::MAX, f64::min);
    let costs = points.iter().map(|point| point.0).filter(|cost| *cost >= usual / 30.0);
    let x = Axis::logarithmic(&label, costs);
    let errors = points.iter().map(|point| point.1).filter(|error| *error <= least * 10.0);
    let y = Axis::logarithmic("RMSE of transmittance", errors);
    let mut plot = Plot::new(470.0, 320.0, x, y);
    let on_front = points.iter().filter(|(x, y, method)| cost.front(method) && plot.holds(*x, *y));
    let mut front: Vec<(f64, f64)> = on_front.map(|&(x, y, _)| (x, y)).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    plot.line(&front, Stroke { color: "#b4bcc6", width: 5.0, dashed: false }, None);
    plot.keep_free(&front);
    let mut trails: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
    for (x, y, method) in points.iter().filter(|(.., method)| !method.sweep.is_empty()) {
        trails.entry(&method.id).or_default().push((*x, *y));
    }
    for (id, trail) in &trails {
        let of =
            points.iter().find(|(.., method)| method.id == *id).map_or(TRUTH, |(.., method)| color(method));
        plot.line(trail, Stroke { color: of, width: 1.0, dashed: true }, None);
    }
    for &(x, y, method) in &points {
        let name = names.within_group(method);
        let price = match cost {
            Cost::Time => format!("{} ms", ms(Some(x))),
            Cost::Memory => bytes(method.memory_bytes),
        };
        let title = format!("{name}: {price}, RMSE {}", fixed(Some(y), 4));
        let dot = if cost.front(method) { Dot::Full } else { Dot::Hollow };
        // In a sweep, only the first dot has the name, and all have their values; the colour identifies the method.
        let values: Vec<&str> = method.sweep.iter().map(|(_, value)| value.as_str()).collect();
        let values = values.join(", ");
        let first = points.iter().find(|(.., other)| other.id == method.id).map(|(.., other)| &other.name);
        let label = if first == Some(&method.name) {
            Label::Always(format!("{} {values}", method.label).trim().to_owned())
        } else if values.is_empty() {
            Label::Always(name)
        } else {
            Label::WhereFree(values)
        };
        plot.dot((x, y), dot, color(method), label, &title);
    }
    let says = format!("Error of transmittance against {label} of {} methods", points.len());
    Some(plot.svg(&says, 0.0))
}

/// Errors of every frame, a curve per method. `None` for a single frame.
pub(super) fn frames(group: &Group<'_>, names: &Names, [first, end]: [u64; 2]) -> Option<String> {
    let curves: Vec<_> = group.methods.iter().filter(|(_, method)| !method.frame_errors.is_empty()).collect();
    let all = || curves.iter().flat_map(|(_, method)| &method.frame_errors).map(|error| error.rmse);
    // A method without shadow errs so much that the others could not be distinguished.
    let least = all().fold(f64::MAX, f64::min).max(1e-4);
    let largest = all().filter(|error| *error <= 12.0 * least).fold(least, f64::max);
    if curves.is_empty() || end < first + 2 {
        return None;
    }
    let x = Axis::even("frame", first as f64, (end - 1) as f64);
    let mut plot = Plot::new(820.0, 300.0, x, Axis::even("RMSE of transmittance", 0.0, 1.1 * largest));
    for (index, method) in &curves {
        let of =
            |(frame, error): (usize, &crate::report::FrameError)| (first as f64 + frame as f64, error.rmse);
        let points: Vec<_> = method.frame_errors.iter().enumerate().map(of).collect();
        plot.line(&points, thin(color(method)), Some(*index));
        if let Some(&last) = points.last() {
            let title = format!("{}: RMSE {}", names.within_group(method), fixed(Some(last.1), 4));
            plot.dot(last, Dot::Full, color(method), Label::WhereFree(names.within_group(method)), &title);
        }
    }
    Some(plot.svg(&format!("Error of transmittance in every frame of {} methods", curves.len()), 0.0))
}

/// Transmittance along the ray of light through a point, and below it what each method stores there.
pub(super) fn probe(report: &CompareReport, names: &Names, probe: &ProbeReport) -> String {
    let mm = |points: &[(f32, f32)]| -> Vec<(f64, f64)> {
        widened(points).into_iter().map(|(x, y)| (x * 1000.0, y)).collect()
    };
    let curves: Vec<(usize, &MethodReport, _)> = (probe.methods.iter())
        .filter_map(|curve| {
            let index = report.methods.iter().position(|method| method.name == curve.method)?;
            Some((index, &report.methods[index], curve))
        })
        .collect();
    let depths = (curves.iter().flat_map(|(.., curve)| &curve.curve))
        .chain(&probe.reference)
        .map(|(depth, _)| f64::from(*depth) * 1000.0)
        .filter(|depth| depth.is_finite());
    let (low, high) =
        depths.fold((f64::MAX, f64::MIN), |(low, high), depth| (low.min(depth), high.max(depth)));
    let (low, high) = if low < high { (low, high) } else { (-1.0, 1.0) };
    let x = Axis::even("depth along the light, from the point, mm", low, high);
    let mut plot = Plot::new(820.0, 330.0, x, Axis::even("transmittance", 0.0, 1.0));
    plot.upright(0.0, "the point");
    let mut steps = mm(&probe.steps);
    // Before the first fragment all light arrives; the last step extends to the edge.
    let before = steps.iter().rev().find(|(depth, _)| *depth <= low).map_or(1.0, |step| step.1);
    steps.retain(|(depth, _)| *depth > low);
    steps.insert(0, (low, before));
    if !probe.steps.is_empty() {
        plot.steps(&steps, Stroke { color: TRUTH, width: 1.0, dashed: false });
    }
    plot.line(&mm(&probe.reference), Stroke { color: TRUTH, width: 2.0, dashed: true }, None);
    for (index, method, curve) in &curves {
        plot.line(&mm(&curve.curve), thin(color(method)), Some(*index));
    }
    for (index, method, curve) in &curves {
        let most = curve.marks.iter().map(|mark| mark.weight).fold(0.0, f32::max).max(1e-30);
        let spans = curve.marks.iter().map(|mark| {
            (f64::from(mark.start) * 1e3, f64::from(mark.end) * 1e3, f64::from(mark.weight / most))
        });
        plot.lane(&names.full(method), color(method), spans, *index);
    }
    let widest = curves.iter().map(|(_, method, _)| names.full(method).chars().count()).max().unwrap_or(0);
    let says = format!("Transmittance along the light through pixel {} {}", probe.pixel[0], probe.pixel[1]);
    plot.svg(&says, (widest as f64 * 6.6 - 40.0).clamp(0.0, 260.0))
}

/// The error of a method's transmittance in a slab of uniform density. The scale is the smallest round number that contains it, at
/// least 0.01, so that negligible errors look flat.
pub(super) fn banding(method: &MethodReport) -> Option<String> {
    let found = method.banding.as_ref().filter(|found| found.curve.len() > 1)?;
    let truth = |depth: f64| (-found.optical_depth * depth).exp();
    let errors: Vec<(f64, f64)> =
        widened(&found.curve).into_iter().map(|(depth, value)| (depth, value - truth(depth))).collect();
    let finite = errors.iter().map(|(_, error)| error.abs()).filter(|error| error.is_finite());
    let largest = finite.fold(0.0, f64::max);
    let round = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5];
    let scale = round.into_iter().find(|&scale| scale >= largest).unwrap_or(1.0);
    let y = Axis::even("error", -scale, scale);
    let mut plot = Plot::new(272.0, 120.0, Axis::even("depth, fraction of the slab", 0.0, 1.0), y);
    plot.level(0.0, "");
    plot.line(&errors, thin(color(method)), None);
    Some(plot.svg(&format!("Error of {} in a slab of even density", method.label), 0.0))
}

/// The colour of a ground truth: that of the first method compared with it.
pub(super) fn of_truth(report: &CompareReport, truth: &FootprintTruth) -> &'static str {
    report.methods.iter().find(|method| truth.methods.contains(&method.name)).map_or(TRUTH, color)
}

/// Convergence of each ground truth: the change of every round against its subtexels.
pub(super) fn convergence(report: &CompareReport) -> Option<String> {
    let reference = &report.reference;
    let rounds = || reference.footprints.iter().flat_map(|truth| &truth.changes);
    rounds().next()?;
    let limit = f64::from(reference.limit);
    let x =
        Axis::logarithmic("subtexels along the edge of a texel", rounds().map(|round| f64::from(round.0)));
    let changes = rounds().map(|round| f64::from(round.1)).chain([limit]);
    let mut plot = Plot::new(430.0, 240.0, x, Axis::logarithmic("change of the round, RMS", changes));
    if limit > 0.0 {
        plot.level(limit, "limit");
    }
    for truth in &reference.footprints {
        let of = report.methods.iter().find(|method| truth.methods.contains(&method.name));
        let color = of_truth(report, truth);
        let points: Vec<(f64, f64)> =
            truth.changes.iter().map(|&(samples, change)| (f64::from(samples), f64::from(change))).collect();
        plot.line(&points, thin(color), None);
        for (index, &(samples, change)) in points.iter().enumerate().take(64) {
            let dot = if change <= limit { Dot::Full } else { Dot::Hollow };
            let title = format!("{}: {samples} subtexels, {change:.5}", truth.methods.join(", "));
            let last = index + 1 == points.len();
            // The table lists the converged ones.
            let label = of.filter(|_| last && !truth.converged).map(|method| method.label.clone());
            plot.dot((samples, change), dot, color, Label::Always(label.unwrap_or_default()), &title);
        }
    }
    Some(plot.svg("Change of the reference with every round", 0.0))
}
