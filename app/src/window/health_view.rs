//! The health of the hair as marks over the image, and the numbers of the statistics.

use egui::Ui;
use lovelock_project::Project;
use lovelock_project::project::CameraSection;
use lovelock_render::{Backend, ClusterStats, Traffic};
use lovelock_session::clock::STEP_SECS;
use lovelock_session::health::{Gauge, GaugeKind};
use lovelock_session::render_thread::RenderedImage;
use lovelock_session::scene::frame_points;

use super::overlay::{self, View};
use super::readings::Fact;
use super::session::Session;
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

    /// Marks the place of a gauge in the image and moves the camera there, or removes the mark.
    pub(super) fn show_gauge(&mut self, kind: GaugeKind, ctx: &egui::Context) {
        if self.tools.marked_gauge.take().is_some_and(|gauge| gauge.kind == kind) {
            return;
        }
        // The place would leave the image if the dance went on.
        self.session.set_playing(false);
        let project = self.seen();
        let gauge = self.gauges(&project).into_iter().find(|gauge| gauge.kind == kind);
        let camera = gauge.as_ref().and_then(|gauge| self.go_to(gauge, &project.camera));
        self.tools.marked_gauge = gauge;
        if let Some(camera) = camera {
            self.change_seen(ctx, |project| project.camera = camera);
        }
    }

    /// Seeks to the time of a gauge's value. Returns the camera that shows its place.
    fn go_to(&self, gauge: &Gauge, camera: &CameraSection) -> Option<CameraSection> {
        let frame = self.session.frame.as_ref()?;
        let secs = gauge.found_secs();
        if let Some(secs) = secs {
            // The hair settles there again and is nearly the same; the ring is where the point was found.
            self.session.worker().look_back(secs);
        }
        let place = frame.place_of(gauge)?;
        let around = [glam::Vec3::splat(-AROUND_M), glam::Vec3::splat(AROUND_M)].map(|d| place + d);
        let [width, height] = self.pages.image.wanted;
        let aspect = width as f32 / height.max(1) as f32;
        let secs = secs.unwrap_or(frame.time_secs);
        Some(frame_points(camera, &frame.scene, secs, around.into_iter(), aspect))
    }

    /// The ring around the place of the selected gauge.
    pub(super) fn paint_marked_gauge(&self, ui: &Ui, view: View, painted: &RenderedImage) {
        let Some(asked) = &self.tools.marked_gauge else { return };
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
}

/// The facts of the statistics.
pub(super) fn facts(session: &Session) -> Vec<Fact> {
    let mut facts = Vec::new();
    let mut fact = |name, tip, value| facts.push(Fact { name, tip, value });
    if let Some(frame) = &session.frame {
        let by = if frame.on_device { "graphics card" } else { "CPU" };
        let why = frame.device_refusal.as_ref().map_or_else(String::new, |reason| format!(": {reason}"));
        fact("Simulated by", "What simulated the last step of the hair.", format!("{by}{why}"));
    }
    if let Some(RenderedImage { image, stats, .. }) = session.painted.as_deref() {
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
        let by_card = session.painter().adapter().is_some_and(|adapter| adapter.backend == Backend::Gpu);
        if !by_card || session.view.measured {
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
    if let Some(frame) = &session.frame {
        fact(
            "Substeps",
            "Substeps of the last simulated step. Fast hair needs more.",
            frame.report.substeps.to_string(),
        );
    }
    facts
}
