//! How the hair is, beside the picture and over it.

use egui::Ui;
use lovelock_studio::{Gauge, GaugeKind, Painted, Project, frame_points};

use super::overlay::{self, View};
use super::{Window, panels};

/// Half the width of what is shown around a place that is gone to, metres.
const AROUND_M: f32 = 0.15;

impl Window {
    /// The gauges of the newest frame; none while a take plays.
    fn gauges(&self, project: &Project) -> Vec<Gauge> {
        match &self.session.frame {
            Some(frame) if project.take.file.is_none() => frame.health(&project.simulation),
            _ => Vec::new(),
        }
    }

    /// The gauges, and the way to their places.
    pub(super) fn health_panel(&mut self, ui: &mut Ui, project: &mut Project) {
        let gauges = self.gauges(project);
        let Some(asked) = panels::health::ui(ui, &gauges, self.pointed) else { return };
        if self.pointed == Some(asked) {
            self.pointed = None;
            return;
        }
        self.pointed = Some(asked);
        // What dances on would leave the picture.
        self.session.set_playing(false);
        self.go_to(&gauges, asked, project);
    }

    /// Moves the camera to the place of a gauge.
    fn go_to(&self, gauges: &[Gauge], kind: GaugeKind, project: &mut Project) {
        let Some(frame) = &self.session.frame else { return };
        let place =
            gauges.iter().find(|gauge| gauge.kind == kind).and_then(|gauge| frame.guide_point(gauge.at?));
        let Some(place) = place else { return };
        let around = [glam::Vec3::splat(-AROUND_M), glam::Vec3::splat(AROUND_M)].map(|d| place + d);
        let [width, height] = self.viewport.wanted;
        let aspect = width as f32 / height.max(1) as f32;
        project.camera =
            frame_points(&project.camera, &frame.scene, frame.time_secs, around.into_iter(), aspect);
    }

    /// The ring around the place of the gauge that is pointed at.
    pub(super) fn paint_pointed(&self, ui: &Ui, view: View, painted: &Painted) {
        let Some(kind) = self.pointed else { return };
        let gauges = self.gauges(self.history.project());
        let Some(gauge) = gauges.iter().find(|gauge| gauge.kind == kind) else { return };
        let Some(at) = gauge.at.and_then(|at| painted.snapshot.guide_point(at)) else { return };
        let text = format!("{}: {}", kind.label(), gauge.in_words());
        overlay::mark::paint(ui, view, at, &text, panels::health::color(gauge.level));
    }

    /// What the statistics say.
    pub(super) fn facts(&self) -> Vec<panels::statistics::Fact> {
        let mut facts = Vec::new();
        let mut fact = |name, tip, value| facts.push(panels::statistics::Fact { name, tip, value });
        if let Some(Painted { picture, stats, .. }) = self.session.painted.as_deref() {
            let mib = |bytes: u64| format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20));
            let size = format!("{} × {}", picture.width, picture.height);
            fact("Picture", "Size of the picture as it is drawn, pixels.", size);
            fact(
                "Segments drawn",
                "Straight pieces of all strands in the picture.",
                stats.segments.to_string(),
            );
            fact(
                "Shadow maps",
                "Memory that the shadow method holds, for all lights together.",
                mib(stats.shadow_bytes),
            );
            fact(
                "Strands and pixels",
                "Memory for the strands as they are drawn, and for each pixel to put them together.",
                mib(stats.draw_bytes),
            );
            fact(
                "Mean transmittance",
                "Share of the first light that reaches a point of the hair through other hair, on average.",
                format!("{:.3}", stats.mean_transmittance),
            );
        }
        if let Some(frame) = &self.session.frame {
            fact(
                "Substeps",
                "Parts in which the last step was simulated: more when hair is fast.",
                frame.report.substeps.to_string(),
            );
        }
        facts
    }
}
