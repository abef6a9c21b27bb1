//! Images for a window: drawn into textures, without waiting for the device.
//!
//! Each image is submitted and returned at once; whoever shows it uses it in later commands of the same queue. What the device has to
//! tell about a frame, whether its lists were long enough and how long it took, arrives when it is finished ([`GpuRenderer::finished`]).

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::Duration;

use lovelock_base::clock::Stopwatch;
use lovelock_gpu::{Gpu, GpuError, PassTimer, wgpu};
use lovelock_picture::check_size_for;
use lovelock_shadow::SUM_WORDS;

use super::{GpuRenderer, ListsOfFrame, Output, number_of_bytes};
use crate::gpu::present::{HEAD_BYTES, MAX_LISTS};
use crate::image::{DeviceImage, DeviceImages};
use crate::{FrameInput, FrameStats, RenderError};

/// The most frames that are prepared while the device has not finished them.
pub const MAX_IN_FLIGHT: usize = 2;

/// A frame that the device has finished.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finished {
    /// Its width and height, pixels.
    pub size: [u32; 2],
    /// Its time on the device, milliseconds, from its submission or from the end of the frame before.
    pub ms: f64,
    /// Whether lists were too short, so that the image before it is shown in its place. They have been enlarged: draw it again.
    pub again: bool,
    /// Mean transmittance of the first light over the strands' points, if it was measured.
    pub mean_transmittance: Option<f32>,
    /// Records of its shadow maps that were read in a simpler way; see [`FrameStats::shadow_fallbacks`].
    pub shadow_fallbacks: u64,
}

/// A frame that the device may not have finished.
#[derive(Debug)]
pub(super) struct Flight {
    size: [u32; 2],
    state: Arc<AtomicU8>,
    report: Option<Report>,
    since: Stopwatch,
}

/// What is read back of a frame without waiting: the heads of its lists, and the sum of its transmittances if it is measured.
#[derive(Debug)]
struct Report {
    buffer: wgpu::Buffer,
    lists: ListsOfFrame,
    points: u32,
    measured: bool,
}

const PENDING: u8 = 0;
const DONE: u8 = 1;
const FAILED: u8 = 2;

const HEADS_BYTES: u64 = HEAD_BYTES * MAX_LISTS as u64;
const REPORT_BYTES: u64 = HEADS_BYTES + 4 * SUM_WORDS;

/// The frames that the device has not finished, oldest first, and what they leave for later ones.
#[derive(Debug, Default)]
pub(super) struct Flights {
    frames: std::collections::VecDeque<Flight>,
    /// Buffers of reports that were read.
    spare: Vec<wgpu::Buffer>,
    /// The image that was drawn last.
    last: Option<Arc<DeviceImage>>,
    /// When the last frame was finished.
    ended: Option<Stopwatch>,
}

impl GpuRenderer {
    /// Draws `input` into one of `images`, without waiting. Commands that are submitted to the same device afterwards see the image.
    /// At most [`MAX_IN_FLIGHT`] frames should be in flight: see [`GpuRenderer::in_flight`]. `measured` asks for the times of passes and
    /// the mean transmittance, which costs reading them back.
    ///
    /// # Errors
    /// As [`GpuRenderer::picture`].
    pub fn image(
        &mut self,
        input: &FrameInput,
        size: [u32; 2],
        measured: bool,
        images: &mut DeviceImages,
    ) -> Result<(Arc<DeviceImage>, FrameStats), RenderError> {
        check_size_for(size[0], size[1], self.gpu.max_picture_side())?;
        self.is_whole = false;
        let gpu = Arc::clone(&self.gpu);
        let before = gpu.traffic();
        let shown = images.free(size);
        let last = self.flights.last.take();
        let mut timer = if measured { std::mem::take(&mut self.timer) } else { PassTimer::off() };
        let report = self.flights.spare.pop();
        let output = Output::Texture { shown: &shown, before: last.as_deref(), measured, report };
        let drawn = self.draw(&gpu, timer.begin(&gpu, "frame"), input, size[0], size[1], output);
        let report = match drawn {
            Ok(drawn) => drawn,
            Err(error) => {
                self.timer = PassTimer::new(&gpu)?;
                let _ = gpu.check();
                return Err(error);
            }
        };
        let passes = timer.times(&gpu);
        if measured {
            self.timer = timer;
        }
        gpu.check()?;
        let state = Arc::new(AtomicU8::new(PENDING));
        let told = Arc::clone(&state);
        match &report {
            Some(buffer) => buffer.map_async(wgpu::MapMode::Read, .., move |result| {
                told.store(if result.is_ok() { DONE } else { FAILED }, Ordering::Release);
            }),
            None => gpu.queue.on_submitted_work_done(move || told.store(DONE, Ordering::Release)),
        }
        let report = report.map(|buffer| Report {
            buffer,
            lists: self.lists_of_frame(),
            points: self.hair.drawn().point_count,
            measured,
        });
        if report.is_some() {
            gpu.note_read_back(if measured { REPORT_BYTES } else { HEADS_BYTES });
        }
        self.flights.frames.push_back(Flight { size, state, report, since: Stopwatch::start() });
        self.flights.last = Some(Arc::clone(&shown));
        self.is_whole = true;
        let stats = FrameStats { traffic: gpu.traffic().since(before), ..self.stats(passes) };
        Ok((shown, stats))
    }

    /// The number of frames that the device has not finished, as far as [`GpuRenderer::finished`] knows.
    pub fn in_flight(&self) -> usize {
        self.flights.frames.len()
    }

    /// The oldest frame in flight, if the device has finished it. Does not wait.
    ///
    /// # Errors
    /// The map of a light needs more memory than its limit, or the device is lost.
    pub fn finished(&mut self) -> Result<Option<Finished>, RenderError> {
        let gpu = Arc::clone(&self.gpu);
        let Some(oldest) = self.flights.frames.front() else { return Ok(None) };
        if oldest.state.load(Ordering::Acquire) == PENDING {
            // Callbacks come in here.
            let _ = gpu.device.poll(wgpu::PollType::Poll);
        }
        let state = oldest.state.load(Ordering::Acquire);
        if state == PENDING {
            gpu.check()?;
            return Ok(None);
        }
        let Some(done) = self.flights.frames.pop_front() else { return Ok(None) };
        if state == FAILED {
            let lost = || GpuError::Readback("the report of a frame".to_owned());
            return Err(gpu.check().err().unwrap_or_else(lost).into());
        }
        let ms = match &self.flights.ended {
            Some(ended) => done.since.ms().min(ended.ms()),
            None => done.since.ms(),
        };
        self.flights.ended = Some(Stopwatch::start());
        let mut finished =
            Finished { size: done.size, ms, again: false, mean_transmittance: None, shadow_fallbacks: 0 };
        if let Some(report) = done.report {
            let (heads, sum) = read_report(&report)?;
            finished.mean_transmittance =
                report.measured.then(|| (sum / (255.0 * f64::from(report.points.max(1)))) as f32);
            finished.again = self.settle(&report.lists, &heads)?;
            finished.shadow_fallbacks = self.shadow.fallbacks();
            self.flights.spare.push(report.buffer);
        }
        Ok(Some(finished))
    }

    /// Sleeps until the oldest frame in flight is finished, but not longer than `most`. Other threads may use the device meanwhile.
    pub fn wait_for_oldest(&self, most: Duration) {
        // A wait of wgpu with a timeout panics if another thread polls the device at the same time (wgpu 30.0.1).
        const STEP: Duration = Duration::from_micros(250);
        let since = Stopwatch::start();
        while let Some(oldest) = self.flights.frames.front()
            && oldest.state.load(Ordering::Acquire) == PENDING
            && since.elapsed() < most
        {
            std::thread::sleep(STEP);
            let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        }
    }
}

/// The heads of the lists and the sum of the transmittances.
fn read_report(report: &Report) -> Result<([[u32; 2]; MAX_LISTS], f64), GpuError> {
    let mut heads = [[0; 2]; MAX_LISTS];
    let mut sum = 0.0;
    {
        let bytes =
            report.buffer.get_mapped_range(..).map_err(|error| GpuError::Readback(error.to_string()))?;
        let word =
            |at: usize| bytes[4 * at..].first_chunk().map_or(0, |&bytes: &[u8; 4]| u32::from_le_bytes(bytes));
        for (k, head) in heads.iter_mut().enumerate() {
            *head = [word(4 * k), word(4 * k + 1)];
        }
        if report.measured {
            sum = number_of_bytes(&bytes[HEADS_BYTES as usize..]);
        }
    }
    report.buffer.unmap();
    Ok((heads, sum))
}

/// Encodes copying what a frame reports into `spare` or a new buffer.
pub(super) fn report(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    heads: &wgpu::Buffer,
    sum: Option<&wgpu::Buffer>,
    spare: Option<wgpu::Buffer>,
) -> wgpu::Buffer {
    let buffer = spare.unwrap_or_else(|| {
        gpu.create_buffer(&wgpu::BufferDescriptor {
            label: Some("report of a frame"),
            size: REPORT_BYTES,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    });
    encoder.copy_buffer_to_buffer(heads, 0, &buffer, 0, HEADS_BYTES);
    if let Some(sum) = sum {
        encoder.copy_buffer_to_buffer(sum, 0, &buffer, HEADS_BYTES, 4 * SUM_WORDS);
    }
    buffer
}
