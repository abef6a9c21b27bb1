//! The transmittance along the light ray through a hair, as computed by each pane's method.

use egui::{RichText, Ui};
use egui_plot::{GridMark, HoverPosition, Line, LineStyle, MarkerShape, Plot, PlotPoints, Points, VLine};
use lovelock_panes::probe::{LiveProbe, ProbedHair};
use lovelock_project::Project;

use crate::window::control::HoverTooltip;
use crate::window::control::{axis_number, axis_of_short_numbers, note};
use crate::window::theme;

/// Height of a pane's row of marks, as a fraction of the range of transmittance.
const ROW: f64 = 0.075;

/// The name of the exact step function.
const UNFILTERED: &str = "one texel, unfiltered";

const OF_METHOD: &str = "The transmittance that the pane's method returns at the hair. Methods filter between neighbouring \
                         texels or cells according to their setting Filter, so that light does not jump at their edges. So \
                         does Exact.";

const OF_TEXEL: &str = "The thin line: the transmittance behind all fragments of hair in the one texel of Exact that contains the hair, \
                        without filter. Exact itself returns the mean of this and of the neighbouring texels where its filter is linear, \
                        which is why the two numbers differ.";

/// The plot, or a note on what is missing. `asked` says whether a hair was clicked.
pub(super) fn ui(ui: &mut Ui, asked: bool, probed: Option<&LiveProbe>, project: &Project, panes: &[usize]) {
    let hair = match probed {
        None if asked => return note(ui, "Probing the hair…"),
        None => {
            return note(
                ui,
                "Click a hair in a pane to plot the transmittance along its light ray for every pane.",
            );
        }
        Some(probed) => match &probed.hair {
            None => return note(ui, "There is no hair at this point. Click another one."),
            Some(hair) => hair,
        },
    };
    let curves: Vec<_> = hair.curves.iter().filter(|(index, _)| panes.contains(index)).collect();
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 10.0;
        let title = format!("Strand {}, point {}: transmittance there", hair.strand, hair.point);
        ui.label(RichText::new(title).small().color(theme::quiet()));
        for (index, curve) in &curves {
            let method = project.compare.panes.get(*index).map_or("", |pane| pane.shadow.method.label());
            let color = theme::PLOT[index % theme::PLOT.len()];
            ui.label(RichText::new(format!("{method} {:.3}", curve.value)).small().color(color))
                .hover_tooltip(OF_METHOD);
        }
        if let Some(value) = exact_at_the_point(hair) {
            let text = format!("{UNFILTERED} {value:.3}");
            ui.label(RichText::new(text).small().color(theme::bright())).hover_tooltip(OF_TEXEL);
        }
    });
    let rows = curves.iter().filter(|(_, curve)| !curve.marks.is_empty()).count();
    let [low, high] = hair.range.map(|depth| 1e3 * f64::from(depth));
    Plot::new("compare probe")
        // Only the depth axis is panned and zoomed, by dragging and by Ctrl with the wheel; a double-click shows all of it.
        .allow_zoom([true, false])
        .allow_drag([true, false])
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_x(false)
        .show_y(false)
        .include_x(low)
        .include_x(high)
        .include_y(1.02)
        .include_y(-ROW * (rows as f64 + 0.4))
        .set_margin_fraction(egui::vec2(0.01, 0.03))
        .custom_x_axes(vec![axis_of_short_numbers("depth along the light from the hair, mm", axis_number)])
        .y_grid_spacer(|_| (0..=2).map(|i| GridMark { value: 0.5 * f64::from(i), step_size: 0.5 }).collect())
        .y_axis_formatter(|mark, shown| {
            // Below zero are the rows of marks.
            if mark.value < -1e-6 { String::new() } else { axis_number(mark, shown) }
        })
        .label_formatter(|at| match at {
            HoverPosition::NearDataPoint { plot_name, position, .. } if position.y >= 0.0 => {
                Some(format!("{plot_name}\n{:.2} mm, {:.3}", position.x, position.y))
            }
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                Some(format!("{plot_name}\n{:.2} mm", position.x))
            }
            HoverPosition::Elsewhere { .. } => None,
        })
        .show(ui, |plot| {
            plot.vline(
                VLine::new("the hair", 0.0).color(theme::accent().gamma_multiply(0.7)).allow_hover(false),
            );
            let steps = staircase(&hair.steps, hair.range);
            if !steps.is_empty() {
                let line = Line::new(UNFILTERED, steps).color(theme::bright()).width(1.2);
                // Steps are drawn as edges, not as the two sides of a band.
                plot.line(line.style(LineStyle::Solid).allow_band(false));
            }
            let mut row = 0;
            for (index, curve) in &curves {
                let method = project.compare.panes.get(*index).map_or("", |pane| pane.shadow.method.label());
                let name = format!("{} {method}", index + 1);
                let color = theme::PLOT[index % theme::PLOT.len()];
                let points: Vec<[f64; 2]> =
                    curve.curve.iter().map(|&(depth, t)| [1e3 * f64::from(depth), f64::from(t)]).collect();
                plot.line(Line::new(name.clone(), points).color(color).width(1.8).allow_band(false));
                let at = PlotPoints::from([0.0, f64::from(curve.value)]);
                let point = Points::new(name.clone(), at).color(color).radius(4.5);
                plot.points(point.shape(MarkerShape::Circle));
                if curve.marks.is_empty() {
                    continue;
                }
                let middle = -ROW * (f64::from(row) + 0.75);
                row += 1;
                for mark in &curve.marks {
                    let [start, end] = [mark.start, mark.end].map(|depth| 1e3 * f64::from(depth));
                    if end < low || start > high {
                        continue;
                    }
                    let label = format!("{name}: {} {:.3}", mark.kind, mark.weight);
                    let filled = mark.weight > 0.0;
                    let color = if filled { color } else { color.gamma_multiply(0.35) };
                    let half = 0.3 * ROW;
                    if end - start > 1e-6 {
                        let body = vec![[start.max(low), middle], [end.min(high), middle]];
                        plot.line(Line::new(label.clone(), body).color(color.gamma_multiply(0.6)).width(3.0));
                    }
                    for edge in [start, end].into_iter().filter(|edge| (low..=high).contains(edge)) {
                        let tick = vec![[edge, middle - half], [edge, middle + half]];
                        plot.line(
                            Line::new(label.clone(), tick)
                                .color(color)
                                .width(1.0)
                                .allow_hover(false)
                                .allow_band(false),
                        );
                    }
                }
            }
        });
}

/// Transmittance of the step function at the hair, which does not shadow itself.
fn exact_at_the_point(hair: &ProbedHair) -> Option<f32> {
    if hair.steps.is_empty() {
        return None;
    }
    Some(hair.steps.iter().take_while(|step| step.0 < 0.0).last().map_or(1.0, |step| step.1))
}

/// The corners of a function that is constant between steps; depths in millimetres.
fn staircase(steps: &[(f32, f32)], [low, high]: [f32; 2]) -> Vec<[f64; 2]> {
    if steps.is_empty() {
        return Vec::new();
    }
    let mut corners = Vec::with_capacity(2 * steps.len() + 2);
    let mut before = 1.0;
    let mut push = |depth: f32, t: f32| corners.push([1e3 * f64::from(depth.clamp(low, high)), f64::from(t)]);
    push(low, before);
    for &(depth, t) in steps {
        push(depth, before);
        push(depth, t);
        before = t;
    }
    push(high, before);
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_have_corners_and_the_hair_is_behind_those_before_it() {
        let steps = vec![(-0.002, 0.5), (0.001, 0.25)];
        let corners = staircase(&steps, [-0.01, 0.01]);
        let values: Vec<f64> = corners.iter().map(|corner| corner[1]).collect();
        assert_eq!(values, [1.0, 1.0, 0.5, 0.5, 0.25, 0.25]);
        assert!((corners[1][0] + 2.0).abs() < 1e-5 && corners[1][0] == corners[2][0]);
        assert!(staircase(&[], [-1.0, 1.0]).is_empty());
        let hair = |steps| ProbedHair {
            strand: 0,
            point: 0,
            position: glam::Vec3::ZERO,
            range: [-0.01, 0.01],
            steps,
            curves: Vec::new(),
        };
        assert_eq!(exact_at_the_point(&hair(steps)), Some(0.5));
        assert_eq!(exact_at_the_point(&hair(vec![(0.0, 0.1)])), Some(1.0), "no hair shadows itself");
        assert_eq!(exact_at_the_point(&hair(Vec::new())), None);
    }
}
