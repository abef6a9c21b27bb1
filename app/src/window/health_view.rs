//! The health of the hair, in a panel and as marks over the image.

use egui::Ui;
use lovelock_project::Project;
use lovelock_render::{Backend, ClusterStats, Traffic};
use lovelock_session::clock::STEP_SECS;
use lovelock_session::health::Gauge;
use lovelock_session::render_thread::RenderedImage;
use lovelock_session::scene::frame_points;

use super::overlay::{self, View};
use super::{Window, panels};

/// Half the width of the view around a place to which the camera moves, metres.
const AROUND_M: f32 = 0.15;

impl Window {
    /// The gauges of the newest frame; `None` while a take plays.
    fn gauges(&self, project: &Project) -> Vec<Gauge> {
        match &self.session.frame {
            Some(frame) if project.take.file.is_none() => frame.health(&project.simulation),
            _ => Vec::new(),
        }
    }

    /// The gauges, with buttons that go to their places.
    pub(super) fn health_panel(&mut self, ui: &mut Ui, project: &mut Project) {
        let gauges = self.gauges(project);
        let shown = self.marked_gauge.as_ref().map(|gauge| gauge.kind);
        let Some(asked) = panels::health::ui(ui, &gauges, project.take.file.is_some(), shown) else { return };
        if shown == Some(asked) {
            self.marked_gauge = None;
            return;
        }
        // The place would leave the image if the dance went on.
        self.session.set_playing(false);
        self.marked_gauge = gauges.into_iter().find(|gauge| gauge.kind == asked);
        if let Some(gauge) = &self.marked_gauge {
            self.go_to(gauge, project);
        }
    }

    /// Seeks to the time of a gauge's value and moves the camera to its place.
    fn go_to(&self, gauge: &Gauge, project: &mut Project) {
        let Some(frame) = &self.session.frame else { return };
        let secs = gauge.found_secs();
        if let Some(secs) = secs {
            // The hair settles there again and is nearly the same; the ring is where the point was found.
            self.session.worker().look_back(secs);
        }
        let Some(place) = frame.place_of(gauge) else { return };
        let around = [glam::Vec3::splat(-AROUND_M), glam::Vec3::splat(AROUND_M)].map(|d| place + d);
        let [width, height] = self.viewport.wanted;
        let aspect = width as f32 / height.max(1) as f32;
        let secs = secs.unwrap_or(frame.time_secs);
        project.camera = frame_points(&project.camera, &frame.scene, secs, around.into_iter(), aspect);
    }

    /// The ring around the place of the selected gauge.
    pub(super) fn paint_marked_gauge(&self, ui: &Ui, view: View, painted: &RenderedImage) {
        let Some(asked) = &self.marked_gauge else { return };
        let gauges = self.gauges(self.document.project());
        let Some(now) = gauges.iter().find(|gauge| gauge.kind == asked.kind) else { return };
        // The selected value stays, also if a worse one follows.
        let gauge = if asked.found.is_some() { asked } else { now };
        let Some(at) = painted.snapshot.place_of(gauge) else { return };
        let text = format!("{}: {}", gauge.kind.label(), gauge.in_words());
        let color = panels::health::color(gauge.level);
        // At another time the body is elsewhere: the ring stays where it was and fades.
        let elsewhere = gauge
            .found_secs()
            .is_some_and(|secs| (painted.snapshot.position_secs - secs).abs() > 1.5 * STEP_SECS);
        overlay::mark::paint(ui, view, at, &text, if elsewhere { color.gamma_multiply(0.45) } else { color });
    }

    /// The facts of the statistics.
    pub(super) fn facts(&self) -> Vec<panels::statistics::Fact> {
        let mut facts = Vec::new();
        let mut fact = |name, tip, value| facts.push(panels::statistics::Fact { name, tip, value });
        if let Some(RenderedImage { image, stats, .. }) = self.session.painted.as_deref() {
            let mib = |bytes: u64| format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20));
            let [width, height] = image.size();
            let size = format!("{width} × {height}");
            fact("Picture", "Size of the rendered image in pixels.", size);
            fact("Segments drawn", "Segments of all strands in the image.", stats.segments.to_string());
            if let Some(clusters) = stats.clusters {
                let ClusterStats { clusters, macro_clusters, volumes, bytes, bytes_unshared } = clusters;
                fact(
                    "Clusters, macro",
                    "Locks drawn as clusters, and macro-clusters: sets of parameters that several clusters may share.",
                    format!("{clusters}, {macro_clusters}"),
                );
                fact(
                    "Hair shell volumes",
                    "Parts of all clusters between two sections, two ribs and two layers, each with two records of the database.",
                    volumes.to_string(),
                );
                fact(
                    "Cluster memory",
                    "Memory for the parameters of clusters, and what it would be without sharing.",
                    format!("{} of {}", mib(bytes), mib(bytes_unshared)),
                );
            }
            fact("Shadow maps", "Memory of the shadow maps of all lights.", mib(stats.shadow_bytes));
            fact(
                "Strands and pixels",
                "Memory for the interpolated strands and for blending them in each pixel.",
                mib(stats.draw_bytes),
            );
            let by_card =
                self.session.painter().adapter().is_some_and(|adapter| adapter.backend == Backend::Gpu);
            if !by_card || self.session.view.measured {
                fact(
                    "Mean transmittance",
                    "Mean fraction of the first light that reaches a point of the hair through other hair.",
                    format!("{:.3}", stats.mean_transmittance),
                );
            }
            if by_card {
                let Traffic { bytes_up, bytes_back, waits, created } = stats.traffic;
                let kib = |bytes: u64| format!("{:.1} KiB", bytes as f64 / 1024.0);
                fact(
                    "To the card",
                    "Copied from memory to the graphics device for the last image: guides, body and constants.",
                    kib(bytes_up),
                );
                fact(
                    "From the card",
                    "Copied back to memory for the last image: list lengths, and the measured times of passes.",
                    kib(bytes_back),
                );
                fact(
                    "Waits, new buffers",
                    "How often the last image waited for the graphics device, and how many buffers it created there.",
                    format!("{waits}, {created}"),
                );
            }
        }
        if let Some(frame) = &self.session.frame {
            fact(
                "Substeps",
                "Substeps of the last simulated step. Fast hair needs more.",
                frame.report.substeps.to_string(),
            );
        }
        facts
    }
}
