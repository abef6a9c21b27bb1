//! What frames cost, and how the hair is.

use egui::{RichText, Ui};
use egui_plot::{GridMark, Line, Plot, PlotPoints};
use lovelock_studio::{Stage, StageHistory};

use crate::window::theme;

/// One line of facts: what it is, and its value.
pub(crate) type Fact = (&'static str, String);

/// The plot of stage times and the facts below it.
pub(crate) fn ui(ui: &mut Ui, history: &StageHistory, facts: &[Fact]) {
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
        // The names are the key to the plot's colours: a legend over it would hide the newest times.
        let stages: Vec<_> = Stage::ALL.into_iter().zip(theme::PLOT).take(5).collect();
        for pair in stages.chunks(2) {
            for &(stage, color) in pair {
                ui.label(RichText::new(stage.label()).small().color(color));
                ui.label(RichText::new(format!("{:.2} ms", medians.get(stage))).small());
            }
            ui.end_row();
        }
    });
    ui.separator();
    egui::Grid::new("facts").num_columns(2).spacing([10.0, 2.0]).show(ui, |ui| {
        for (name, value) in facts {
            ui.label(RichText::new(*name).small().color(theme::QUIET));
            ui.label(RichText::new(value).small());
            ui.end_row();
        }
    });
}

/// Lines of the grid at 1, 2 or 5 times a power of ten, few enough that each has room for its number.
fn round_steps((low, high): (f64, f64)) -> Vec<GridMark> {
    let step_size = round_step((high - low) / 4.0);
    // Bounds that are no numbers, or too far from zero for the step, have no lines.
    let (first, last) = ((low / step_size).ceil(), (high / step_size).floor());
    if !(first.abs() < 1e9 && last - first < 100.0) {
        return Vec::new();
    }
    (first as i64..=last as i64).map(|i| GridMark { value: i as f64 * step_size, step_size }).collect()
}

/// The smallest of 1, 2 and 5 times a power of ten that is no less than `least`.
fn round_step(least: f64) -> f64 {
    let ten = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|times| times * ten).find(|step| *step >= least).unwrap_or(10.0 * ten)
}

#[cfg(test)]
mod tests {
    use super::*;

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
