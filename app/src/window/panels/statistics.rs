//! What frames cost, and how the hair is.

use egui::{RichText, Ui};
use egui_plot::{Line, Plot, PlotPoints};
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
