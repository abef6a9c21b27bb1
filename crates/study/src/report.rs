//! The results of a comparison: the keys of `compare --json` and of `report.json`, and the data of the page.
//!
//! Numbers that could not be measured are null; a sentence in [`MethodReport::refused`] or [`CompareReport::notes`] says why. Files are named relative to the report's folder.

use lovelock_panes::probe::ProbeCurve;
use serde::{Deserialize, Serialize};

use crate::changes::{ChangeReport, StabilityReport};

/// The results of a comparison.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareReport {
    /// Whether everything requested was done. False if the run was cancelled; the results present are then still valid.
    pub complete: bool,
    /// Version of the program.
    pub version: String,
    /// CPU and number of threads.
    pub machine: String,
    /// Evaluated frames, half open. Errors, images and times are of the first one.
    pub frames: [u64; 2],
    /// The frames in which maps were shifted for [`StabilityReport::swim`]: all, or an evenly spaced selection of many.
    #[serde(default)]
    pub swim_frames: Vec<u64>,
    /// Facts about the rendered scene.
    pub scene: SceneFacts,
    /// The ground truth and its accuracy.
    pub reference: Reference,
    /// One entry per method, backend and value of a sweep, in the requested order.
    pub methods: Vec<MethodReport>,
    /// The most accurate method for budgets of time and memory.
    #[serde(default)]
    pub budgets: Vec<BudgetReport>,
    /// Methods that another one beats, each with the most accurate of those: it is at least as good in error, time and memory, and its
    /// error is smaller by more than twice the last change of the ground truth or the middle 80 % of the times do not overlap.
    #[serde(default)]
    pub beaten: Vec<(String, String)>,
    /// Films of the compared frames.
    #[serde(default)]
    pub films: Vec<FilmFile>,
    /// Rays of light through chosen strand points.
    pub probes: Vec<ProbeReport>,
    /// The scales of the error maps.
    pub legends: Vec<Legend>,
    /// Notes on omissions and accuracy, as sentences.
    pub notes: Vec<String>,
}

/// Facts about the rendered scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneFacts {
    /// The project's file, or `default project`, with the changed settings.
    pub name: String,
    /// Frame rate of the frame numbers.
    pub fps: f64,
    /// Width of the images, pixels.
    pub width: u32,
    /// Height of the images, pixels.
    pub height: u32,
    /// Number of strands.
    pub strands: u64,
    /// Number of strand points.
    pub points: u64,
    /// Number of strand segments.
    pub segments: u64,
    /// Factor on the optical depth of every strand.
    pub extinction_scale: f32,
    /// Number of enabled lights. Errors of transmittance are those of the first one.
    pub lights: u32,
    /// Number of draws per time measurement, after a warm-up.
    pub draws: u32,
}

/// The ground truth that methods are compared with.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Whether every ground truth used for errors converged within its limit.
    pub converged: bool,
    /// Largest number of subtexels along a texel's edge in the last round of any ground truth.
    pub samples: u32,
    /// The largest change in a last round, root mean square of transmittance.
    pub change: f32,
    /// The change below which a ground truth counts as converged.
    pub limit: f32,
    /// One ground truth per footprint: the mean of the light over the texels of the named methods.
    pub footprints: Vec<FootprintTruth>,
    /// Other ground truths of the same kind: for lights after the first, and for later frames.
    pub others: Vec<NamedTruth>,
    /// Ground truths along the probes' rays. They are not used for errors and do not count in `converged`, because the positions on
    /// one ray average out less than all points.
    pub probes: Vec<NamedTruth>,
    /// Ground truth at points: transmittance of the exact method on a fine map.
    pub points: Option<PointTruth>,
    /// File of the reference image, rendered from converged transmittance with exact transparency: that of the first backend.
    pub picture: Option<String>,
    /// The reference image of each backend. Images are compared with that of their own backend.
    #[serde(default)]
    pub pictures: Vec<ReferencePicture>,
    /// Difference of the GPU's reference image from that of the CPU; null if nothing was rendered on the GPU. It is in no method's
    /// numbers.
    #[serde(default)]
    pub gpu_from_cpu: Option<ImageDifference>,
    /// File of that transmittance in colour.
    pub transmittance: Option<String>,
    /// Missing parts of the ground truth, with numbers, one sentence each.
    pub refused: Vec<String>,
}

/// The reference image of one backend.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReferencePicture {
    /// `cpu` or `gpu`.
    pub backend: String,
    /// Its file.
    pub file: String,
}

/// Difference of two images.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ImageDifference {
    /// Perceived difference (FLIP, 0 to 1).
    pub flip: FlipError,
    /// Peak signal-to-noise ratio, decibels; null if the images are equal.
    pub psnr_db: Option<f64>,
    /// Structural similarity, 1 if the images are equal; null if they are smaller than its window.
    pub ssim: Option<f64>,
}

/// Converged transmittance for one footprint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FootprintTruth {
    /// [`MethodReport::name`]s of the methods that are compared with it.
    pub methods: Vec<String>,
    /// Whether it converged.
    pub converged: bool,
    /// Subtexels along the edge of a texel in the last round.
    pub samples: u32,
    /// Root mean square change in the last round.
    pub change: f32,
    /// Subtexels and change of every round after the first.
    pub changes: Vec<(u32, f32)>,
    /// Number of points where it was computed: all strand points, or a regular selection.
    pub points: u64,
}

/// Converged transmittance of something other than the first light in the first frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NamedTruth {
    /// Its subject, such as `reference picture, light 2` or `frame 41`.
    pub name: String,
    /// Whether it converged.
    pub converged: bool,
    /// Subtexels along the edge of a texel in the last round.
    pub samples: u32,
    /// Root mean square change in the last round.
    pub change: f32,
}

impl NamedTruth {
    /// The facts of a ground truth, with a name.
    pub(crate) fn new(name: String, facts: &FootprintTruth) -> Self {
        let FootprintTruth { converged, samples, change, .. } = *facts;
        Self { name, converged, samples, change }
    }
}

impl Reference {
    /// The change of the ground truth at points, if it exceeds the limit of the others. Smaller errors at points may be errors of
    /// the ground truth.
    pub fn doubt_at_points(&self) -> Option<f32> {
        let change = self.points.as_ref()?.change;
        (change > self.limit).then_some(change)
    }

    /// Updates the summary from all known ground truths except those of probes.
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
    /// Its memory, bytes.
    pub memory_bytes: u64,
    /// Root mean square difference to the same on a map of half the resolution.
    pub change: f32,
}

/// One method, on one backend, at one value of a sweep.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MethodReport {
    /// Id of the shadow method.
    pub id: String,
    /// Label of the method.
    pub label: String,
    /// Name that is unique in a report and contains what differs from the others, such as `occupancy-maps resolution=256 cpu`.
    pub name: String,
    /// What hair was drawn as: `strands`, `clusters` or `auto`. Only strands have errors of transmittance and stability.
    pub draw: String,
    /// Id of the transparency mode.
    pub transparency: String,
    /// `cpu` or `gpu`.
    pub backend: String,
    /// Name of the device that rendered.
    pub adapter: String,
    /// Settings of the method, name and value.
    pub settings: Vec<(String, String)>,
    /// Names and values of settings changed by sweeps; empty outside a sweep.
    pub sweep: Vec<(String, String)>,
    /// Edge of a texel (or cell) of its map, metres; null if it has no map. Texels are never narrower than strands.
    pub cell_size_m: Option<f32>,
    /// Number of texels (or cells) of its map. There are fewer than the settings say if texels would be narrower than strands, or if
    /// the box around the hair is not a cube.
    pub cells_total: Option<u64>,
    /// Why it, or a part of it, could not be measured; one sentence.
    pub refused: Option<String>,
    /// Error of transmittance at strand points against the mean of the light over the method's own texels, the best that the map
    /// could represent.
    pub transmittance: Option<TransmittanceError>,
    /// The same against one ground truth for all methods: the mean of the light over a texel of `exact` with the project's settings,
    /// which also shades the reference image. This includes the error of coarse texels.
    pub transmittance_common: Option<TransmittanceError>,
    /// The same against the ground truth at points. Null for the method that is this ground truth.
    pub transmittance_at_points: Option<TransmittanceError>,
    /// Perceived difference from the reference image of the same backend (FLIP, 0 to 1).
    pub flip: Option<FlipError>,
    /// Peak signal-to-noise ratio of the image, decibels; also null if the images are equal.
    pub psnr_db: Option<f64>,
    /// Structural similarity of the images; 1 if they are equal.
    pub ssim: Option<f64>,
    /// Median times of the stages, milliseconds.
    pub ms: Option<StageMs>,
    /// The same with percentiles, and the passes of the backend.
    pub times: Vec<TimeSpread>,
    /// Bytes of the shadow maps of all lights.
    pub memory_bytes: Option<u64>,
    /// Records of the shadow maps that cannot be read as the method is defined, and are read in a simpler way.
    #[serde(default)]
    pub fallbacks: u64,
    /// Bytes of pixel buffers and rendered strands.
    pub draw_bytes: Option<u64>,
    /// Errors of transmittance of every frame against the method's own texels; empty for a single frame.
    #[serde(default)]
    pub frame_errors: Vec<FrameError>,
    /// Temporal stability.
    pub stability: Option<StabilityReport>,
    /// Changes while the first light turns by 0.1 degrees per frame and nothing else moves.
    pub light_sweep: Option<ChangeReport>,
    /// Changes deep in a bundle while a single hair moves into it from the light, by the method's CPU definition. The ground truth
    /// does not change there.
    pub stray: Option<ChangeReport>,
    /// Banding by slices in uniform density.
    pub banding: Option<BandingReport>,
    /// Whether no other method with the same backend, drawing and transparency is both more accurate and faster, by
    /// [`MethodReport::front_error`].
    pub front_of_time: bool,
    /// Whether no other method with the same backend, drawing and transparency is both more accurate and smaller.
    pub front_of_memory: bool,
    /// Its files.
    pub files: MethodFiles,
}

impl MethodReport {
    /// The error by which methods are ranked: against one ground truth for all, or against the method's own texels if that ground
    /// truth is missing.
    pub fn front_error(&self) -> Option<f64> {
        self.transmittance_common.or(self.transmittance).map(|error| error.rmse)
    }
}

/// The most accurate method within a budget, among those with the same backend, drawing and transparency.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BudgetReport {
    /// Milliseconds to build and look up the maps; null if time does not matter.
    pub ms: Option<f64>,
    /// Bytes of the maps; null if memory does not matter.
    pub memory_bytes: Option<u64>,
    /// [`MethodReport::name`] of the method.
    pub method: String,
    /// Its [`MethodReport::front_error`].
    pub rmse: f64,
    /// The runner-up within the budget; null if there is none.
    pub next: Option<String>,
    /// The error of the runner-up.
    pub next_rmse: Option<f64>,
    /// Whether the difference of the errors exceeds twice the last change of the ground truth, 9 of 10 times are within the budget, and
    /// both methods were timed at least three times if time matters.
    pub certain: bool,
}

/// Error of transmittance over points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TransmittanceError {
    /// Number of compared points.
    pub count: u64,
    /// Root mean square.
    pub rmse: f64,
    /// Signed mean; positive if the method is too bright.
    pub bias: f64,
    /// 99th percentile of the magnitude.
    pub p99: f64,
    /// The largest magnitude.
    pub max: f64,
    /// Root mean square over points with fewer than ten hair fragments before them, where light enters.
    pub first10_rmse: Option<f64>,
}

/// Errors of transmittance in one frame of several.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameError {
    /// Root mean square.
    pub rmse: f64,
    /// Signed mean; positive if the method is too bright.
    pub bias: f64,
}

/// A film of panes beside each other, with the errors of every frame below.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FilmFile {
    /// Its file.
    pub file: String,
    /// What the panes show: `picture` or `transmittance-error`.
    pub shows: String,
    /// [`MethodReport::name`]s of the panes, at most nine.
    pub methods: Vec<String>,
}

/// FLIP of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FlipError {
    /// Mean over all pixels.
    pub mean: f64,
    /// Mean over pixels that show hair; null if there are none. It does not depend on the area of the hair in the image.
    pub hair_mean: Option<f64>,
    /// 99th percentile over all pixels.
    pub p99: f64,
}

/// Median times, milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StageMs {
    /// Building the shadow maps; null if the device does not time its passes.
    pub build: Option<f64>,
    /// Looking them up at every strand point and body vertex; null as above.
    pub query: Option<f64>,
    /// Rendering the rest of the image.
    pub draw: f64,
    /// The whole image without interpolation.
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
    /// Number of draws.
    pub count: u32,
}

/// Banding of a method in a slab of uniform density, where transmittance is an exponential.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BandingReport {
    /// Largest deviation of the second derivative from the exponential's, as a multiple of the exponential's own where
    /// light enters.
    pub residual: f64,
    /// Root mean square error of transmittance in the slab.
    pub rmse: f64,
    /// The largest amplitude of all waves in the error.
    pub amplitude: f64,
    /// Period of that wave, as a fraction of the slab.
    pub period: f64,
    /// Distance between slices (layers, cells), as a fraction of the slab; null if the method has no slices of equal depth.
    pub slice: Option<f64>,
    /// Amplitude of the wave with the period of the slices.
    pub slice_amplitude: Option<f64>,
    /// Curve for the plot: depth as a fraction of the slab, and transmittance of the method.
    pub curve: Vec<(f32, f32)>,
    /// Optical depth of the whole slab: the ground truth is `exp(-optical_depth * depth)`.
    pub optical_depth: f64,
}

/// Files of one method, relative to the report.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MethodFiles {
    /// The image.
    pub picture: Option<String>,
    /// Error of transmittance (signed) in colour, with its legend.
    pub transmittance_error: Option<String>,
    /// FLIP of the image in colour, with its legend.
    pub picture_error: Option<String>,
    /// Swim in colour.
    pub swim: Option<String>,
    /// Pop in colour.
    pub pop: Option<String>,
    /// Flicker in colour.
    pub flicker: Option<String>,
    /// Folder with the error of transmittance of every frame in colour, `error.NNNN.png`.
    #[serde(default)]
    pub error_frames: Option<String>,
}

/// The transmittance of each method along a ray of light through a strand point.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ProbeReport {
    /// The chosen pixel, from the upper left corner.
    pub pixel: [u32; 2],
    /// The front strand there.
    pub strand: u32,
    /// Number of the point, from the root.
    pub point: u32,
    /// Position of that point, world space, metres.
    pub position: [f32; 3],
    /// The step function of the exact method: depth along the light relative to the point, metres, and transmittance
    /// from there on.
    pub steps: Vec<(f32, f32)>,
    /// The mean of light over a texel along the ray: depth, transmittance.
    pub reference: Vec<(f32, f32)>,
    /// The curve of each method.
    pub methods: Vec<ProbeCurve>,
}

/// The scale of one kind of map.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Legend {
    /// `transmittance`, `transmittance-error`, `picture-error`, `swim`, `pop` or `flicker`.
    pub of: String,
    /// The quantity, as a heading.
    pub title: String,
    /// The value of the first colour and of the last one.
    pub range: [f32; 2],
    /// Name of the colour map.
    pub colors: String,
    /// File of the scale alone.
    pub file: Option<String>,
}
