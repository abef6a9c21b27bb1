//! Temporal stability of methods.

use super::names::{Group, Names};
use super::tables;
use super::words::grouped;
use crate::changes::ChangeReport;
use crate::report::{CompareReport, MethodReport};

/// Temporal stability of every method, with a description of each test. Empty if no test was done.
pub(super) fn section(report: &CompareReport, groups: &[Group<'_>], names: &Names) -> String {
    let tables: String = groups.iter().map(|group| tables::stability(group, names)).collect();
    if tables.is_empty() {
        return tables;
    }
    let [first, end] = report.frames;
    let frames = if end > first + 1 {
        format!(
            "the film of frames {first} to {}; flicker is the part that the reference does not show.",
            end - 1
        )
    } else {
        "several frames; here there is one (see <code>--frames</code>).".into()
    };
    let steps = |of: fn(&MethodReport) -> Option<ChangeReport>| report.methods.iter().find_map(of);
    let mut items = Vec::new();
    // A quick comparison shifts no map.
    if !report.swim_frames.is_empty() {
        items.push(format!(
            "<b>Map shifted</b> (swim): the map is shifted by less than a texel, six times, {}",
            shifted(report)
        ));
    }
    items.push(format!(
        "<b>Frame to frame</b> (pop, flicker): the change from one frame to the next of {frames}"
    ));
    if let Some(ChangeReport { steps, points, .. }) = steps(|method| method.light_sweep) {
        items.push(format!(
            "<b>Light turned</b>: the first light turns sideways by 0.1° per step, {steps} times, and nothing else moves; \
             {} points are measured. The truth changes a little; <i>Excess</i> and <i>Jitter</i> are the change that a \
             method adds.",
            grouped(points)
        ));
    }
    if let Some(ChangeReport { steps, points, .. }) = steps(|method| method.stray) {
        items.push(format!(
            "<b>Stray hair</b>: a bundle made for this test, the same in every report, into which a single hair moves from \
             the light, {steps} steps of 1 mm. At the {} points behind it the truth does not change at all, so every change \
             is an error of the method. Measured with the method's definition on the CPU, on rows of the GPU too.",
            grouped(points)
        ));
    }
    format!(
        "<p>Changes of transmittance that should not happen. Lower is better, and 0 is none.</p><ul \
         class=\"tests\"><li>{}</li></ul>{tables}<p class=\"note\">Maps of swim, pop and flicker are among the pictures \
         above.</p>",
        items.join("</li><li>")
    )
}

/// The frames in which maps were shifted, as the end of a sentence.
fn shifted(report: &CompareReport) -> String {
    let [first, end] = report.frames;
    let shifted = &report.swim_frames;
    let named = || shifted.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    match shifted.len() as u64 {
        1 => format!("in frame {} alone.", named()),
        count if count == end - first => format!("in each of the {count} frames."),
        count => format!("in {count} of the {} frames, evenly spaced: {}.", end - first, named()),
    }
}
