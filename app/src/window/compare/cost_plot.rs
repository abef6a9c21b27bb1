//! The cost of the panes: over the last seconds, and against their error.

use egui::{Align, Layout, RichText, Ui, vec2};
use egui_plot::{
    GridMark, HoverPosition, Line, LineStyle, MarkerShape, Plot, PlotPoint, PlotPoints, Points, Text,
};
use lovelock_panes::label::bytes_label;
use lovelock_panes::request::{LiveError, LiveTimes};
use lovelock_project::Project;

use super::costs::{Costs, PLOTTED_SECS, Way};
use super::layout::CostPlot;
use crate::window::control::HoverTooltip;
use crate::window::control::{axis_of_short_numbers, note};
use crate::window::panels::statistics::round_steps;
use crate::window::theme;

/// Width of the table of medians, points.
const TABLE_WIDTH: f32 = 476.0;
/// Width of its column of names, points.
const NAME_WIDTH: f32 = 148.0;

/// The choice of plot, the plot, and the medians beside it if there is room.
pub(super) fn ui(ui: &mut Ui, plot: &mut CostPlot, costs: &Costs, project: &Project, panes: &[usize]) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for which in CostPlot::ALL {
            let text = RichText::new(which.label()).small();
            if ui.selectable_label(*plot == which, text).hover_tooltip(which.tip()).clicked() {
                *plot = which;
            }
        }
    });
    let room = ui.available_size();
    let beside = room.x > TABLE_WIDTH + 260.0;
    let draw = |ui: &mut Ui| match *plot {
        CostPlot::ErrorTime | CostPlot::ErrorMemory => scatter(ui, *plot, costs, project, panes),
        CostPlot::Whole | CostPlot::Build | CostPlot::Ask | CostPlot::Draw => {
            over_time(ui, *plot, costs, project, panes);
        }
    };
    if beside {
        ui.horizontal_top(|ui| {
            let size = vec2(room.x - TABLE_WIDTH - 8.0, room.y);
            ui.allocate_ui_with_layout(size, Layout::top_down(Align::LEFT), draw);
            ui.vertical(|ui| table(ui, costs, project, panes));
        });
    } else {
        draw(ui);
    }
}

/// One stage over time.
fn stage(plot: CostPlot) -> impl Fn(&LiveTimes) -> Option<f64> + Copy {
    move |times| match plot {
        CostPlot::Build => times.build,
        CostPlot::Ask => times.ask,
        CostPlot::Draw => times.draw,
        CostPlot::Whole | CostPlot::ErrorTime | CostPlot::ErrorMemory => Some(times.whole),
    }
}

/// The variants that are on the screen, with their colours.
fn shown<'a>(
    costs: &'a Costs,
    project: &'a Project,
    panes: &'a [usize],
) -> impl Iterator<Item = (usize, &'a Way)> {
    panes.iter().filter_map(|&index| {
        let pane = project.compare.panes.get(index)?;
        Some((index, costs.of(pane)?))
    })
}

fn over_time(ui: &mut Ui, which: CostPlot, costs: &Costs, project: &Project, panes: &[usize]) {
    // Seconds before the newest image: while nothing is rendered, no time passes.
    let newest = |way: &Way| way.samples.back().map_or(0.0, |sample| sample.at_secs);
    let now = shown(costs, project, panes).map(|(_, way)| newest(way)).fold(0.0, f64::max);
    let lines: Vec<_> = shown(costs, project, panes)
        .map(|(index, way)| {
            let since = |at: f64| at - now;
            let recent = way.samples.iter().filter(|sample| since(sample.at_secs) > -PLOTTED_SECS);
            let points: Vec<[f64; 2]> = recent
                .filter_map(|sample| Some([since(sample.at_secs), stage(which)(&sample.times)?]))
                .collect();
            (index, way.label(), points)
        })
        .collect();
    plain("compare times")
        .include_x(-PLOTTED_SECS)
        .include_x(0.0)
        .include_y(0.0)
        .y_axis_label("ms")
        .custom_x_axes(vec![axis_of_short_numbers("seconds ago", |mark, _| {
            format!("{:.0}", mark.value.abs())
        })])
        .x_grid_spacer(|_| (0..=6).map(|i| GridMark { value: -2.0 * f64::from(i), step_size: 2.0 }).collect())
        .y_grid_spacer(|input| round_steps(input.bounds))
        .label_formatter(|at| match at {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}\n{:.1} ms", position.y))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
        .show(ui, |plot| {
            for (index, name, points) in lines {
                let color = theme::PLOT[index % theme::PLOT.len()];
                plot.line(
                    Line::new(format!("{} {name}", index + 1), points)
                        .color(color)
                        .width(1.8)
                        .allow_band(false),
                );
            }
        });
}

/// Error and cost of one variant, as powers of ten; `None` if either is missing or zero.
fn place(way: &Way, which: CostPlot) -> Option<[f64; 2]> {
    let error = way.error.rmse()?;
    let cost = match which {
        CostPlot::ErrorMemory => way.shadow_bytes as f64 / f64::from(1 << 20),
        _ => way.whole(),
    };
    (error > 0.0 && cost > 0.0).then(|| [cost.log10(), error.log10()])
}

fn scatter(ui: &mut Ui, which: CostPlot, costs: &Costs, project: &Project, panes: &[usize]) {
    let ways: Vec<_> = shown(costs, project, panes)
        .map(|(index, way)| {
            let trail = costs.trail(way.series());
            let trail: Vec<[f64; 2]> = trail.filter_map(|way| place(way, which)).collect();
            (index, way, trail)
        })
        .collect();
    let left_out: Vec<String> = ways
        .iter()
        .filter(|(_, way, _)| place(way, which).is_none())
        .map(|(_, way, _)| way.label())
        .collect();
    let unit = if which == CostPlot::ErrorMemory { "MiB" } else { "ms" };
    if ways.iter().all(|(_, way, _)| way.error == LiveError::NotMeasured) {
        note(ui, "Errors are not measured. Click the ruler above the panes.");
    } else if !left_out.is_empty() {
        note(ui, format!("Not on these axes: {}.", left_out.join(", ")));
    }
    let power = |mark: GridMark, _: &std::ops::RangeInclusive<f64>| short(10_f64.powf(mark.value));
    plain("compare scatter")
        .set_margin_fraction(vec2(0.16, 0.16))
        .x_axis_label(unit)
        .y_axis_label("error")
        .x_grid_spacer(|input| decades(input.bounds))
        .y_grid_spacer(|input| decades(input.bounds))
        .x_axis_formatter(power)
        .y_axis_formatter(power)
        .label_formatter(move |at| match at {
            HoverPosition::NearDataPoint { plot_name, position, .. } => Some(format!(
                "{plot_name}\n{} {unit}, error {}",
                short(10_f64.powf(position.x)),
                short(10_f64.powf(position.y))
            )),
            HoverPosition::Elsewhere { .. } => None,
        })
        .show(ui, |plot| {
            for (index, way, trail) in ways {
                let color = theme::PLOT[index % theme::PLOT.len()];
                let name = format!("{} {}", index + 1, way.label());
                if trail.len() > 1 {
                    let faint = color.gamma_multiply(0.5);
                    let line = Line::new(name.clone(), trail.clone()).color(faint).width(1.2);
                    plot.line(line.style(LineStyle::Solid).allow_hover(false));
                    plot.points(Points::new(name.clone(), trail).color(faint).radius(2.5));
                }
                let Some(at) = place(way, which) else { continue };
                let point = Points::new(name, PlotPoints::from(at)).color(color).radius(5.0);
                plot.points(point.shape(MarkerShape::Circle));
                // Room for the point before the name.
                let text = format!("    {}", way.label());
                let text = RichText::new(text).small().color(color);
                let text = Text::new("", PlotPoint::new(at[0], at[1]), text);
                plot.text(text.anchor(egui::Align2::LEFT_CENTER));
            }
        });
}

/// A plot that cannot be panned or zoomed.
fn plain(id: &str) -> Plot<'_> {
    Plot::new(id.to_owned())
        .allow_zoom(false)
        .allow_drag(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_double_click_reset(false)
        .show_x(false)
        .show_y(false)
}

/// Grid lines at 1, 2 and 5 times the powers of ten; coordinates are the exponents.
fn decades((low, high): (f64, f64)) -> Vec<GridMark> {
    if !(low.abs() < 30.0 && high.abs() < 30.0) {
        return Vec::new();
    }
    // If many powers are visible, only lines at powers.
    let parts: &[f64] = if high - low > 2.2 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let powers = low.floor() as i32..=high.ceil() as i32;
    let mark = |value: f64| GridMark { value, step_size: 0.5 };
    let marks: Vec<GridMark> = powers
        .flat_map(|power| parts.iter().map(move |part| f64::from(power) + part.log10()))
        .filter(|value| (low..=high).contains(value))
        .map(mark)
        .collect();
    if marks.len() > 1 {
        return marks;
    }
    // If less than one power is visible, even steps of the number itself.
    let even = round_steps((10_f64.powf(low), 10_f64.powf(high)));
    let even = even.into_iter().map(|step| step.value.log10());
    even.filter(|value| (low..=high).contains(value)).map(mark).collect()
}

/// A number with two significant digits.
fn short(value: f64) -> String {
    let digits = (1 - value.abs().max(1e-9).log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Widths of the columns of numbers, points: four times, memory and error.
const COLUMNS: [f32; 6] = [42.0, 42.0, 42.0, 48.0, 62.0, 58.0];

/// Medians of all stages, memory and error.
fn table(ui: &mut Ui, costs: &Costs, project: &Project, panes: &[usize]) {
    let row = |ui: &mut Ui, (name, tip): (RichText, &str), cells: [RichText; 6]| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let cell = |ui: &mut Ui, width: f32, layout: Layout, text: RichText| {
                ui.allocate_ui_with_layout(vec2(width, 15.0), layout, |ui| {
                    ui.set_min_width(width);
                    ui.add(egui::Label::new(text.small()).truncate())
                })
                .inner
            };
            cell(ui, NAME_WIDTH, Layout::left_to_right(Align::Center), name).hover_tooltip(tip);
            for (width, text) in COLUMNS.into_iter().zip(cells) {
                cell(ui, width, Layout::right_to_left(Align::Center), text);
            }
        });
    };
    ui.spacing_mut().item_spacing.y = 2.0;
    let titles = ["build", "query", "draw", "whole", "memory", "error"];
    row(
        ui,
        (RichText::new("ms").color(theme::quiet()), "Milliseconds on the device named in each line."),
        titles.map(|title| RichText::new(title).color(theme::quiet())),
    );
    for (index, way) in shown(costs, project, panes) {
        let color = theme::PLOT[index % theme::PLOT.len()];
        let ms = |stage: fn(&LiveTimes) -> Option<f64>| {
            RichText::new(way.median(stage).map_or_else(|| "–".to_owned(), |ms| format!("{ms:.1}")))
        };
        let error = match &way.error {
            LiveError::Measured { rmse, .. } => format!("{rmse:.4}"),
            LiveError::Reference => "reference".to_owned(),
            LiveError::NotMeasured | LiveError::Refused(_) => "–".to_owned(),
        };
        let name = RichText::new(way.label()).color(color);
        row(
            ui,
            (name, way.adapter.name.as_str()),
            [
                ms(|times| times.build),
                ms(|times| times.ask),
                ms(|times| times.draw),
                ms(|times| Some(times.whole)),
                RichText::new(bytes_label(way.shadow_bytes)),
                RichText::new(error),
            ],
        );
    }
    note(
        ui,
        "Medians of the last images, measured while everything else runs. Maps reused while nothing moves count with the \
         time of their last build. Error: RMSE of transmittance against Exact.",
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_lines_few() {
        assert_eq!(
            [0.0123, 0.5, 1.0, 7.25, 42.4, 1234.0].map(short),
            ["0.012", "0.5", "1", "7.2", "42", "1234"]
        );
        for bounds in [(-1.0, 1.0), (-2.5, 3.0), (0.1, 0.2), (f64::NAN, 1.0), (-1e300, 1e300)] {
            let marks = decades(bounds);
            assert!(marks.len() < 12, "{bounds:?}: {}", marks.len());
            assert!(marks.iter().all(|mark| mark.value >= bounds.0 && mark.value <= bounds.1));
        }
        assert_eq!(decades((-0.1, 1.1)).len(), 4, "1, 2, 5 and 10");
        // Between 560 and 800 there is none of them.
        let near: Vec<i64> =
            decades((2.75, 2.9)).iter().map(|mark| 10_f64.powf(mark.value).round() as i64).collect();
        assert!(near.len() >= 2 && near.iter().all(|value| value % 50 == 0), "{near:?}");
    }

    #[test]
    fn what_has_no_error_or_no_cost_is_not_on_the_axes() {
        let mut costs = Costs::default();
        let pane = super::super::costs::tests::pane(64, 9.0, 0.01);
        costs.push(&pane);
        let way = |costs: &Costs| costs.of(&pane.contender).cloned().expect("a way");
        let at = place(&way(&costs), CostPlot::ErrorTime).expect("a place");
        assert!((at[0] - 1.0).abs() < 1e-12 && (at[1] + 2.0).abs() < 1e-12, "{at:?}");
        let mut reference = way(&costs);
        reference.error = LiveError::Reference;
        assert_eq!(place(&reference, CostPlot::ErrorTime), None);
        let mut free = way(&costs);
        free.shadow_bytes = 0;
        assert_eq!(place(&free, CostPlot::ErrorMemory), None);
    }
}
