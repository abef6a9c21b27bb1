//! What a comparison found: the keys of `compare --json` and of `report.json`, and what the page shows.
//!
//! Numbers that could not be measured are null, each with a sentence in [`MethodReport::refused`] or
//! [`CompareReport::notes`] that says why. Files are named relative to the report's folder.

use lovelock_panes::probe::ProbeCurve;
use serde::{Deserialize, Serialize};

use crate::changes::{ChangeReport, StabilityReport};

/// What a comparison found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareReport {
    /// Whether everything that was asked for has been done. False where the run was cancelled: what is here is whole.
    pub complete: bool,
    /// Version of the program.
    pub version: String,
    /// Processor and number of threads.
    pub machine: String,
    /// Frames that were looked at, half open. Errors, pictures and times are of the first one.
    pub frames: [u64; 2],
    /// Those of them in which maps were shifted for [`StabilityReport::swim`]: all, or of many some that lie evenly.
    #[serde(default)]
    pub swim_frames: Vec<u64>,
    /// What was drawn.
    pub scene: SceneFacts,
    /// The truth, and how far it can be trusted.
    pub reference: Reference,
    /// One entry for each method, backend and value of a sweep, in the order in which they were asked for.
    pub methods: Vec<MethodReport>,
    /// Rays of light through chosen points of hair.
    pub probes: Vec<ProbeReport>,
    /// The scales of the error maps.
    pub legends: Vec<Legend>,
    /// What was left out, and other things to know, in sentences.
    pub notes: Vec<String>,
}

/// What was drawn.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneFacts {
    /// The project's file, or `default project`, with what was changed of it.
    pub name: String,
    /// Frames a second of the frames' numbers.
    pub fps: f64,
    /// Width of the pictures, pixels.
    pub width: u32,
    /// Height of the pictures, pixels.
    pub height: u32,
    /// Strands.
    pub strands: u64,
    /// Their points.
    pub points: u64,
    /// Their segments.
    pub segments: u64,
    /// Factor on the optical depth of every strand.
    pub extinction_scale: f32,
    /// Lights that are on. Errors of transmittance are those of the first one.
    pub lights: u32,
    /// Draws that a time is the median of, after a warm-up.
    pub draws: u32,
}

/// The truth that methods are held against.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Whether every truth that errors are measured against converged within its limit.
    pub converged: bool,
    /// Subtexels along the edge of a texel in the last round of the one that needed most.
    pub samples: u32,
    /// The largest change of the last rounds, root mean square of transmittance.
    pub change: f32,
    /// The change below which a truth counts as converged.
    pub limit: f32,
    /// One truth for each footprint: the means of light over the texels of the methods that are named.
    pub footprints: Vec<FootprintTruth>,
    /// The other truths of the same kind: of lights after the first, and of later frames.
    pub others: Vec<NamedTruth>,
    /// Those along the probes' rays. No error is measured against them, and `converged` leaves them out: over the places of one
    /// ray less evens out than over all points.
    pub probes: Vec<NamedTruth>,
    /// The truth at points: transmittance of the exact method on a fine map.
    pub points: Option<PointTruth>,
    /// File of the picture drawn from converged transmittance with exact transparency.
    pub picture: Option<String>,
    /// File of that transmittance in colour.
    pub transmittance: Option<String>,
    /// What could not be had of the truth, with the numbers, in one sentence each.
    pub refused: Vec<String>,
}

/// Converged transmittance for one footprint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FootprintTruth {
    /// [`MethodReport::name`]s of those that are held against it.
    pub methods: Vec<String>,
    /// Whether it converged.
    pub converged: bool,
    /// Subtexels along the edge of a texel in the last round.
    pub samples: u32,
    /// Root mean square change in the last round.
    pub change: f32,
    /// Subtexels and change of every round after the first.
    pub changes: Vec<(u32, f32)>,
    /// Points that it was found at: all of the strands', or every so many of them.
    pub points: u64,
}

/// Converged transmittance of something else than the first light in the first frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NamedTruth {
    /// What it is of: `reference picture, light 2`, `frame 41`.
    pub name: String,
    /// Whether it converged.
    pub converged: bool,
    /// Subtexels along the edge of a texel in the last round.
    pub samples: u32,
    /// Root mean square change in the last round.
    pub change: f32,
}

impl NamedTruth {
    /// The facts of a truth, under a name.
    pub(crate) fn new(name: String, facts: &FootprintTruth) -> Self {
        let FootprintTruth { converged, samples, change, .. } = *facts;
        Self { name, converged, samples, change }
    }
}

impl Reference {
    /// The change of the truth at points where it is above the limit of the others: errors at points that are smaller may be
    /// the truth's own.
    pub fn doubt_at_points(&self) -> Option<f32> {
        let change = self.points.as_ref()?.change;
        (change > self.limit).then_some(change)
    }

    /// Sums up all truths that are known by now, those of probes aside.
    pub(crate) fn settle(&mut self) {
        let footprints = self.footprints.iter().map(|of| (of.converged, of.samples, of.change));
        let others = self.others.iter().map(|of| (of.converged, of.samples, of.change));
        self.converged = !self.footprints.is_empty();
        (self.samples, self.change) = (0, 0.0);
        for (converged, samples, change) in footprints.chain(others) {
            self.converged &= converged;
            self.samples = self.samples.max(samples);
            self.change = self.change.max(change);
        }
    }
}

/// The exact method on a fine map.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointTruth {
    /// Texels along each edge of its map.
    pub resolution: u32,
    /// Memory that it took, bytes.
    pub memory_bytes: u64,
    /// Root mean square difference to the same on a map of half the resolution.
    pub change: f32,
}

/// One method, on one backend, at one value of a sweep.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MethodReport {
    /// Id of the shadow method.
    pub id: String,
    /// What people call the method.
    pub label: String,
    /// Unique among the methods of a report, such as `occupancy-maps resolution=256 cpu`: what differs from the others.
    pub name: String,
    /// Id of the transparency mode.
    pub transparency: String,
    /// `cpu` or `gpu`.
    pub backend: String,
    /// Name of what drew.
    pub adapter: String,
    /// Settings of the method, name and value.
    pub settings: Vec<(String, String)>,
    /// Name and value of what a sweep changed; empty outside a sweep.
    pub sweep: Vec<(String, String)>,
    /// Edge of a texel (of a cell) of its map, metres; null where it has no map. Texels are never narrower than strands.
    pub cell_size_m: Option<f32>,
    /// Texels (cells) that its map has: fewer than its settings ask for where these would be narrower than strands, or where
    /// the box around the hair is no cube.
    pub cells_total: Option<u64>,
    /// Why it, or a part of it, could not be done; one sentence.
    pub refused: Option<String>,
    /// Error of transmittance at strand points against the mean of the light over the method's own texels: what it could
    /// know best.
    pub transmittance: Option<TransmittanceError>,
    /// The same against one truth for all methods: the mean of the light over a texel of `exact` by the project's settings,
    /// from which the reference picture is drawn. Coarse texels count against a method here.
    pub transmittance_common: Option<TransmittanceError>,
    /// The same against the truth at points. Null for the method that is that truth.
    pub transmittance_at_points: Option<TransmittanceError>,
    /// Difference of the picture to the reference picture, as seen (FLIP, 0 to 1).
    pub flip: Option<FlipError>,
    /// Signal to noise of the picture, decibels; null also where the pictures are the same.
    pub psnr_db: Option<f64>,
    /// Structural similarity of the pictures; 1 where they are the same.
    pub ssim: Option<f64>,
    /// Median times of the stages, milliseconds.
    pub ms: Option<StageMs>,
    /// The same with their spread, and the passes of the backend.
    pub times: Vec<TimeSpread>,
    /// Bytes of the shadow maps of all lights.
    pub memory_bytes: Option<u64>,
    /// Bytes that were held for the pixels and the drawn strands.
    pub draw_bytes: Option<u64>,
    /// How still it stands.
    pub stability: Option<StabilityReport>,
    /// What changes while the first light turns by 0.1 degrees a frame and nothing else moves.
    pub light_sweep: Option<ChangeReport>,
    /// What changes deep in a bundle while a single hair moves into it from the light, by the method's definition on the
    /// processor. The truth does not change there.
    pub stray: Option<ChangeReport>,
    /// What slices show in even density.
    pub banding: Option<BandingReport>,
    /// Whether no other of the same backend and transparency is both more accurate and quicker, by [`MethodReport::front_error`].
    pub front_of_time: bool,
    /// Whether no other of the same backend and transparency is both more accurate and smaller.
    pub front_of_memory: bool,
    /// What was written of it.
    pub files: MethodFiles,
}

impl MethodReport {
    /// The error by which methods are ranked: against one truth for all. Where that truth could not be had, against the
    /// method's own texels.
    pub fn front_error(&self) -> Option<f64> {
        self.transmittance_common.or(self.transmittance).map(|error| error.rmse)
    }
}

/// Error of transmittance over points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TransmittanceError {
    /// Points compared.
    pub count: u64,
    /// Root mean square.
    pub rmse: f64,
    /// Mean, signed: above zero where the method is too bright.
    pub bias: f64,
    /// 99th percentile of the magnitude.
    pub p99: f64,
    /// The largest magnitude.
    pub max: f64,
    /// Root mean square over the points with fewer than ten fragments of hair before them: where light enters.
    pub first10_rmse: Option<f64>,
}

/// FLIP of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FlipError {
    /// Mean over all pixels.
    pub mean: f64,
    /// Mean over the pixels that show hair; null where none does. It does not depend on how much of the picture hair fills.
    pub hair_mean: Option<f64>,
    /// 99th percentile over all pixels.
    pub p99: f64,
}

/// Median times, milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StageMs {
    /// To make the shadow maps; null where the device does not time its passes.
    pub build: Option<f64>,
    /// To ask them at every strand point and every vertex of the body; null as above.
    pub query: Option<f64>,
    /// To draw what is left of the picture.
    pub draw: f64,
    /// The whole picture without interpolation.
    pub whole: f64,
}

/// A time over many draws, milliseconds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TimeSpread {
    /// The stage (`build`, `query`, `draw`, `whole`) or the backend's pass (`shadow/…`, `draw/…`).
    pub name: String,
    /// Median.
    pub median: f64,
    /// 10th percentile.
    pub low: f64,
    /// 90th percentile.
    pub high: f64,
    /// Draws.
    pub count: u32,
}

/// What a method's slices show in a slab of even density, where transmittance is an exponential.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BandingReport {
    /// Largest deviation of the second derivative from the exponential's, as a multiple of the exponential's own where
    /// light enters.
    pub residual: f64,
    /// Root mean square error of transmittance in the slab.
    pub rmse: f64,
    /// The largest amplitude of all waves in the error.
    pub amplitude: f64,
    /// Period of that wave, a part of the slab.
    pub period: f64,
    /// Distance of two slices (layers, cells), a part of the slab; null where the method has none of one depth.
    pub slice: Option<f64>,
    /// Amplitude of the wave with the period of the slices.
    pub slice_amplitude: Option<f64>,
    /// Depth as a part of the slab, transmittance of the method: a curve to plot beside the exponential.
    pub curve: Vec<(f32, f32)>,
    /// Extinction over the whole slab: the truth is `exp(-optical_depth * depth)`.
    pub optical_depth: f64,
}

/// Files of one method, relative to the report.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MethodFiles {
    /// The picture.
    pub picture: Option<String>,
    /// Error of transmittance (signed) in colour, with its legend.
    pub transmittance_error: Option<String>,
    /// FLIP of the picture in colour, with its legend.
    pub picture_error: Option<String>,
    /// Swim in colour.
    pub swim: Option<String>,
    /// Pop in colour.
    pub pop: Option<String>,
    /// Flicker in colour.
    pub flicker: Option<String>,
}

/// A ray of light through a point of hair, as each method sees it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ProbeReport {
    /// The pixel that was asked, from the upper left corner.
    pub pixel: [u32; 2],
    /// The strand that is in front there.
    pub strand: u32,
    /// Which of its points, from the root.
    pub point: u32,
    /// Where that point is, world space, metres.
    pub position: [f32; 3],
    /// The step function of the exact method: depth along the light relative to the point, metres, and transmittance
    /// from there on.
    pub steps: Vec<(f32, f32)>,
    /// The mean of light over a texel along the ray: depth, transmittance.
    pub reference: Vec<(f32, f32)>,
    /// What each method says.
    pub methods: Vec<ProbeCurve>,
}

/// The scale of one kind of map.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Legend {
    /// `transmittance`, `transmittance-error`, `picture-error`, `swim`, `pop` or `flicker`.
    pub of: String,
    /// What the numbers are, as a heading.
    pub title: String,
    /// The value of the first colour and of the last one.
    pub range: [f32; 2],
    /// Name of the colour map.
    pub colors: String,
    /// File of the scale alone.
    pub file: Option<String>,
}
