//! Rendering times and facts about the scene.

use egui::{RichText, Ui};
use egui_plot::{GridMark, Line, Plot, PlotPoints};
use lovelock_base::words::counted;
use lovelock_project::Project;
use lovelock_render::PassTime;
use lovelock_session::stats::{PassHistory, Stage, StageHistory};

use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{axis_number, note};
use crate::window::panel::Panel;
use crate::window::readings::{Fact, Readings};
use crate::window::theme;

/// Groups of passes: the prefix of their names, a title, and a description.
const GROUPS: [(&str, &str, &str); 2] = [
    ("shadow/", "Shadow", "Builds the maps of all lights and looks up how much light reaches the strands."),
    ("draw/", "Draw", "Shades the strands and composites them with the body and the background."),
];

/// Rendering times and facts about the scene.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StatisticsPanel {
    /// Whether the passes are unfolded; only then they must be measured.
    pub(crate) shows_passes: bool,
}

impl Panel for StatisticsPanel {
    fn title(&self) -> &'static str {
        "Statistics"
    }

    fn opens(&self, _project: &Project, _readings: &Readings<'_>) -> bool {
        true
    }

    fn ui(&mut self, ui: &mut Ui, _project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        // The panes have their own statistics; the single image is not rendered beside them.
        if readings.pane.is_some() {
            note(ui, "Measured on the single image, before the comparison was opened.");
        }
        let [facts, kept] = (readings.facts)();
        self.shows_passes = times(ui, readings.stages, readings.passes, [&facts, &kept]);
        None
    }
}

/// Shows the plot of stage times, the passes, the facts, and what is kept in memory.
/// Returns whether the passes are unfolded.
fn times(ui: &mut Ui, history: &StageHistory, passes: &PassHistory, [facts, kept]: [&[Fact]; 2]) -> bool {
    Plot::new("stage times")
        .height(112.0)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_x(false)
        .include_y(0.0)
        .y_axis_label("ms")
        .show_axes([false, true])
        .y_grid_spacer(|input| round_steps(input.bounds))
        .y_axis_formatter(axis_number)
        .show(ui, |plot| {
            for (stage, color) in Stage::ALL.into_iter().zip(theme::PLOT) {
                if stage == Stage::Encode {
                    continue;
                }
                let points: PlotPoints =
                    history.series(stage).enumerate().map(|(i, ms)| [i as f64, ms]).collect();
                plot.line(Line::new(stage.label(), points).color(color));
            }
        });
    let medians = history.medians();
    egui::Grid::new("stages").num_columns(4).spacing([10.0, 2.0]).show(ui, |ui| {
        // The names serve as the legend: one over the plot would hide the newest times.
        let stages: Vec<_> = Stage::ALL.into_iter().zip(theme::PLOT).take(5).collect();
        for pair in stages.chunks(2) {
            for &(stage, color) in pair {
                ui.label(RichText::new(stage.label()).small().color(color));
                ui.label(RichText::new(format!("{:.2} ms", medians.get(stage))).small());
            }
            ui.end_row();
        }
    });
    let unfolded = egui::CollapsingHeader::new(RichText::new("Passes").small()).show(ui, |ui| {
        let medians = passes.medians();
        if !medians.is_empty() {
            passes_ui(ui, &medians);
        } else if history.newest().is_some() {
            note(ui, "This device does not measure its passes.");
        }
    });
    let measured = unfolded.body_response.is_some();
    ui.separator();
    list(ui, "facts", facts);
    egui::CollapsingHeader::new(RichText::new("Memory").small()).show(ui, |ui| list(ui, "kept", kept));
    measured
}

fn list(ui: &mut Ui, id: &str, facts: &[Fact]) {
    egui::Grid::new(id).num_columns(2).spacing([10.0, 2.0]).show(ui, |ui| {
        for Fact { name, tip, value } in facts {
            ui.label(RichText::new(*name).small().color(theme::quiet())).hover_tooltip(*tip);
            ui.label(RichText::new(value).small());
            ui.end_row();
        }
    });
}

/// Medians of the passes, grouped, with a sum per group.
fn passes_ui(ui: &mut Ui, medians: &[PassTime]) {
    egui::Grid::new("passes").num_columns(2).spacing([10.0, 2.0]).show(ui, |ui| {
        for (group, title, tip) in GROUPS {
            let of_group: Vec<_> =
                medians.iter().filter_map(|pass| Some((pass.name.strip_prefix(group)?, pass.ms))).collect();
            if of_group.is_empty() {
                continue;
            }
            let sum: f64 = of_group.iter().map(|(_, ms)| ms).sum();
            ui.label(
                RichText::new(format!("{title}, {}", counted(of_group.len(), "pass", "passes")))
                    .small()
                    .strong(),
            )
            .hover_tooltip(tip);
            ui.label(RichText::new(format!("{sum:.2} ms")).small().strong());
            ui.end_row();
            for (name, ms) in of_group {
                ui.label(RichText::new(in_words(name)).small().color(theme::quiet()));
                ui.label(RichText::new(format!("{ms:.2} ms")).small());
                ui.end_row();
            }
        }
    });
}

/// `body-depth` as *Body depth*.
fn in_words(name: &str) -> String {
    let mut letters = name.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.chain(letters.map(|letter| if letter == '-' { ' ' } else { letter })).collect()
}

/// Grid lines at 1, 2 or 5 times a power of ten, far enough apart for their numbers.
pub(crate) fn round_steps((low, high): (f64, f64)) -> Vec<GridMark> {
    let step_size = round_step((high - low) / 4.0);
    // No lines for bounds that are not finite or too large for the step.
    let (first, last) = ((low / step_size).ceil(), (high / step_size).floor());
    if !(first.abs() < 1e9 && last - first < 100.0) {
        return Vec::new();
    }
    (first as i64..=last as i64).map(|i| GridMark { value: i as f64 * step_size, step_size }).collect()
}

/// The smallest 1, 2 or 5 times a power of ten that is at least `least`.
fn round_step(least: f64) -> f64 {
    let ten = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|times| times * ten).find(|step| *step >= least).unwrap_or(10.0 * ten)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_are_named_in_words() {
        assert_eq!(in_words("sort-and-blend"), "Sort and blend");
        assert_eq!(in_words(""), "");
    }

    #[test]
    fn grid_lines_are_few_and_round() {
        for (least, step) in [(0.9, 1.0), (1.0, 1.0), (1.1, 2.0), (4.0, 5.0), (75.0, 100.0), (700.0, 1000.0)]
        {
            // A power of ten is rounded once or twice.
            assert!((round_step(least) / step - 1.0).abs() < 1e-12, "{least}");
        }
        for bounds in
            [(-5.0, 310.0), (0.0, 0.004), (0.0, 9e5), (f64::NAN, 1.0), (0.0, f64::INFINITY), (1.0, 1.0)]
        {
            let marks = round_steps(bounds);
            assert!(marks.len() <= 6, "{bounds:?}: {}", marks.len());
        }
        assert_eq!(round_steps((-5.0, 310.0)).len(), 4);
    }
}
