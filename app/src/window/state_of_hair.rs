//! How the hair is, beside the picture and over it.

use egui::Ui;
use lovelock_project::Project;
use lovelock_session::clock::STEP_SECS;
use lovelock_session::health::Gauge;
use lovelock_session::render_thread::RenderedImage;
use lovelock_session::scene::frame_points;

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
        let shown = self.pointed.as_ref().map(|gauge| gauge.kind);
        let Some(asked) = panels::health::ui(ui, &gauges, shown) else { return };
        if shown == Some(asked) {
            self.pointed = None;
            return;
        }
        // What dances on would leave the picture.
        self.session.set_playing(false);
        self.pointed = gauges.into_iter().find(|gauge| gauge.kind == asked);
        if let Some(gauge) = &self.pointed {
            self.go_to(gauge, project);
        }
    }

    /// Goes to when a gauge's value was found, and moves the camera to its place.
    fn go_to(&self, gauge: &Gauge, project: &mut Project) {
        let Some(frame) = &self.session.frame else { return };
        let secs = gauge.found_secs();
        if let Some(secs) = secs {
            // The hair settles there anew, and is nearly as it was; the ring is where the point was found.
            self.session.worker().look_back(secs);
        }
        let Some(place) = frame.place_of(gauge) else { return };
        let around = [glam::Vec3::splat(-AROUND_M), glam::Vec3::splat(AROUND_M)].map(|d| place + d);
        let [width, height] = self.viewport.wanted;
        let aspect = width as f32 / height.max(1) as f32;
        let secs = secs.unwrap_or(frame.time_secs);
        project.camera = frame_points(&project.camera, &frame.scene, secs, around.into_iter(), aspect);
    }

    /// The ring around the place of the gauge that is pointed at.
    pub(super) fn paint_pointed(&self, ui: &Ui, view: View, painted: &RenderedImage) {
        let Some(asked) = &self.pointed else { return };
        let gauges = self.gauges(self.history.project());
        let Some(now) = gauges.iter().find(|gauge| gauge.kind == asked.kind) else { return };
        // What was gone to stays, though worse may come.
        let gauge = if asked.found.is_some() { asked } else { now };
        let Some(at) = painted.snapshot.place_of(gauge) else { return };
        let text = format!("{}: {}", gauge.kind.label(), gauge.in_words());
        let color = panels::health::color(gauge.level);
        // At another time the body is elsewhere: the ring is where it was, and pales.
        let elsewhere = gauge
            .found_secs()
            .is_some_and(|secs| (painted.snapshot.position_secs - secs).abs() > 1.5 * STEP_SECS);
        overlay::mark::paint(ui, view, at, &text, if elsewhere { color.gamma_multiply(0.45) } else { color });
    }

    /// What the statistics say.
    pub(super) fn facts(&self) -> Vec<panels::statistics::Fact> {
        let mut facts = Vec::new();
        let mut fact = |name, tip, value| facts.push(panels::statistics::Fact { name, tip, value });
        if let Some(RenderedImage { picture, stats, .. }) = self.session.painted.as_deref() {
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
