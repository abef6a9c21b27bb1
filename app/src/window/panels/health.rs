//! The health of the simulation.

use egui::{Align, Color32, Layout, Rect, RichText, Sense, Ui, Vec2, WidgetInfo};
use egui_material_icons::icons;
use lovelock_project::Project;
use lovelock_session::health::{Gauge, GaugeKind, HealthLevel};

use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::note;
use crate::window::panel::Panel;
use crate::window::readings::Readings;
use crate::window::theme;

/// The colour of a level.
pub(crate) fn color(level: HealthLevel) -> Color32 {
    match level {
        HealthLevel::Good => theme::good(),
        HealthLevel::Watch => theme::watch(),
        HealthLevel::Wrong => theme::wrong(),
    }
}

/// The health of the simulation.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct HealthPanel;

impl Panel for HealthPanel {
    fn title(&self) -> &'static str {
        "Health"
    }

    fn opens(&self, _project: &Project, _readings: &Readings<'_>) -> bool {
        true
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        let plays_take = project.take.file.is_some();
        let frame = readings.frame.filter(|_| !plays_take);
        let gauges = frame.map_or_else(Vec::new, |frame| frame.health(&project.simulation));
        list(ui, &gauges, plays_take, readings.marked_gauge).map(Command::ShowGauge)
    }
}

/// Shows the gauges, each with a button that marks the place of its value. `shown` is the gauge that is marked in the image.
/// Returns the gauge whose place should be shown. There are no gauges while a take plays, and before the first frame.
pub(crate) fn list(
    ui: &mut Ui,
    gauges: &[Gauge],
    plays_take: bool,
    shown: Option<GaugeKind>,
) -> Option<GaugeKind> {
    if gauges.is_empty() {
        let why = if plays_take {
            "Nothing is simulated while a take plays."
        } else {
            "Nothing is measured before the first step of the simulation."
        };
        note(ui, why);
        return None;
    }
    let worst = gauges.iter().map(|gauge| gauge.level).max().unwrap_or(HealthLevel::Good);
    let words = match worst {
        HealthLevel::Good => "No problems found.",
        HealthLevel::Watch => "Possibly visible:",
        HealthLevel::Wrong => "Problems:",
    };
    ui.label(RichText::new(words).color(color(worst)));
    let mut asked = None;
    for gauge in gauges {
        if row(ui, gauge, shown == Some(gauge.kind)) {
            asked = Some(gauge.kind);
        }
    }
    asked
}

/// Shows one gauge; returns whether its button was clicked.
fn row(ui: &mut Ui, gauge: &Gauge, shown: bool) -> bool {
    let kind = gauge.kind;
    let color = color(gauge.level);
    let mut asked = false;
    ui.horizontal(|ui| {
        ui.label(RichText::new(kind.label()).small()).hover_tooltip(kind.tooltip());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let name = format!("Show: {}", kind.label());
            let icon = RichText::new(icons::ICON_MY_LOCATION.codepoint).small();
            let button = egui::Button::selectable(shown, icon).frame_when_inactive(true);
            let button = ui.add_enabled(gauge.at.is_some(), button);
            button.widget_info(|| {
                WidgetInfo::selected(egui::Role::Button, gauge.at.is_some(), shown, name.as_str())
            });
            let tip = match (shown, gauge.found_secs()) {
                (true, _) => "Removes the mark.",
                (false, Some(_)) => {
                    "Seeks to the time of this value, pauses, and marks the place in the image. The measured values stay."
                }
                (false, None) => "Pauses, marks the place in the image, and moves the camera to it.",
            };
            asked = button.hover_tooltip(tip).disabled_hover_tooltip("This value has no position.").clicked();
            ui.label(RichText::new(kind.in_words(gauge.value)).small().color(color));
            if let Some(when) = gauge.when_in_words() {
                ui.label(RichText::new(when.trim_start()).small().weak())
                    .hover_tooltip("Time of this value on the timeline.");
            }
        });
    });
    let (bar, _) = ui.allocate_exact_size(Vec2::new(ui.available_width(), 3.0), Sense::hover());
    ui.painter().rect_filled(bar, 1.5, theme::line());
    let full = Rect::from_min_size(bar.min, Vec2::new(bar.width() * gauge.fill(), bar.height()));
    ui.painter().rect_filled(full, 1.5, color);
    if let Some(within) = &gauge.within {
        ui.label(RichText::new(format!("in {within}")).small().weak())
            .hover_tooltip("The part of the body that the hair is in.");
    }
    if !gauge.advice.is_empty() {
        ui.label(RichText::new(&gauge.advice).small().color(color));
    }
    asked
}
