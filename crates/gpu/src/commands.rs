//! The passes of one frame and their durations.

use bytemuck::Pod;
use wgpu_profiler::{GpuProfiler, GpuProfilerQuery, GpuProfilerSettings, GpuTimerQueryResult};

use lovelock_base::clock::Stopwatch;

use crate::{Gpu, GpuError};

/// The duration of one pass on the device. Passes with the same name are added up.
#[derive(Clone, Debug, PartialEq)]
pub struct PassTime {
    /// The name of the pass.
    pub name: String,
    /// Milliseconds.
    pub ms: f64,
}

/// Measures the duration of passes: with timestamps on a GPU; on a software adapter, which executes passes one after another
/// anyway, by waiting for each. Measures nothing on a GPU without timestamps.
pub struct PassTimer(Clock);

enum Clock {
    Timestamps(Box<GpuProfiler>),
    Wall(Vec<PassTime>),
    Off,
}

impl std::fmt::Debug for PassTimer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PassTimer").finish_non_exhaustive()
    }
}

impl Default for PassTimer {
    /// A timer that waits for each pass.
    fn default() -> Self {
        Self(Clock::Wall(Vec::new()))
    }
}

impl PassTimer {
    /// A timer for the passes of `gpu`.
    ///
    /// # Errors
    /// The device cannot create the queries.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        if gpu.is_software() {
            return Ok(Self::default());
        }
        let settings = GpuProfilerSettings {
            enable_timer_queries: gpu.has_timestamps(),
            enable_debug_groups: false,
            max_num_pending_frames: 4,
        };
        let profiler = GpuProfiler::new(&gpu.device, settings)
            .map_err(|error| GpuError::Refused(format!("timers: {error}")))?;
        Ok(Self(Clock::Timestamps(Box::new(profiler))))
    }

    /// A timer that measures nothing, so that all passes are submitted at once and nothing is waited for or read back.
    pub const fn off() -> Self {
        Self(Clock::Off)
    }

    /// Begins a frame.
    pub fn begin<'a>(&'a mut self, gpu: &'a Gpu, label: &'static str) -> Commands<'a> {
        gpu.begin_frame();
        if let Clock::Wall(times) = &mut self.0 {
            times.clear();
        }
        self.resume(gpu, label)
    }

    /// Adds commands to the frame that was begun last: their constants follow those of its earlier passes and are kept like them.
    pub fn resume<'a>(&'a mut self, gpu: &'a Gpu, label: &'static str) -> Commands<'a> {
        Commands { gpu, label, encoder: encoder(gpu, label), clock: &mut self.0 }
    }

    /// The times of the last finished frame in the order of its passes; empty if none was measured. Wait for the device first.
    pub fn times(&mut self, gpu: &Gpu) -> Vec<PassTime> {
        match &mut self.0 {
            Clock::Off => Vec::new(),
            Clock::Wall(times) => std::mem::take(times),
            Clock::Timestamps(profiler) => {
                let mut newest = Vec::new();
                while let Some(found) = profiler.process_finished_frame(gpu.queue.get_timestamp_period()) {
                    newest = summed(&found);
                }
                newest
            }
        }
    }
}

fn encoder(gpu: &Gpu, label: &str) -> wgpu::CommandEncoder {
    gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
}

/// Adds the duration of a pass to that of earlier passes with the same name.
fn add(times: &mut Vec<PassTime>, name: &str, ms: f64) {
    match times.iter_mut().find(|time| time.name == name) {
        Some(time) => time.ms += ms,
        None => times.push(PassTime { name: name.to_owned(), ms }),
    }
}

fn summed(found: &[GpuTimerQueryResult]) -> Vec<PassTime> {
    let mut times = Vec::new();
    for pass in found {
        if let Some(range) = &pass.time {
            add(&mut times, &pass.label, ((range.end - range.start) * 1e3).max(0.0));
        }
    }
    times
}

/// The commands of one frame.
pub struct Commands<'a> {
    gpu: &'a Gpu,
    label: &'static str,
    encoder: wgpu::CommandEncoder,
    clock: &'a mut Clock,
}

impl std::fmt::Debug for Commands<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Commands").finish_non_exhaustive()
    }
}

impl Commands<'_> {
    /// A compute pass. Kernels in it run one after another.
    pub fn compute(&mut self, name: &str, with: impl FnOnce(&mut wgpu::ComputePass)) {
        self.timed(name, |encoder, query| {
            with(&mut encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(name),
                timestamp_writes: query.and_then(GpuProfilerQuery::compute_pass_timestamp_writes),
            }));
        });
    }

    /// A render pass. Label and timestamps of `descriptor` are replaced.
    pub fn render(
        &mut self,
        name: &str,
        descriptor: &wgpu::RenderPassDescriptor,
        with: impl FnOnce(&mut wgpu::RenderPass),
    ) {
        self.timed(name, |encoder, query| {
            with(&mut encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(name),
                timestamp_writes: query.and_then(GpuProfilerQuery::render_pass_timestamp_writes),
                ..descriptor.clone()
            }));
        });
    }

    fn timed(
        &mut self,
        name: &str,
        encode: impl FnOnce(&mut wgpu::CommandEncoder, Option<&GpuProfilerQuery>),
    ) {
        match &mut *self.clock {
            Clock::Timestamps(profiler) => {
                let query = profiler.begin_pass_query(name, &mut self.encoder);
                encode(&mut self.encoder, Some(&query));
                profiler.end_query(&mut self.encoder, query);
            }
            Clock::Off => encode(&mut self.encoder, None),
            Clock::Wall(times) => {
                let watch = Stopwatch::start();
                encode(&mut self.encoder, None);
                let next = encoder(self.gpu, self.label);
                let done = std::mem::replace(&mut self.encoder, next);
                self.gpu.queue.submit([done.finish()]);
                // The loss of the device is reported when the frame is read back.
                let _ = self.gpu.wait();
                add(times, name, watch.ms());
            }
        }
    }

    /// A uniform buffer that holds `value` in this frame. It is kept for the same pass of the next frame.
    pub fn constants<T: Pod>(&self, label: &str, value: &T) -> wgpu::Buffer {
        self.gpu.constants(label, bytemuck::bytes_of(value))
    }

    /// The encoder, for commands between passes.
    pub fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        &mut self.encoder
    }

    /// Submits all commands to the device.
    pub fn submit(mut self) {
        if let Clock::Timestamps(profiler) = &mut *self.clock {
            profiler.resolve_queries(&mut self.encoder);
        }
        self.gpu.queue.submit([self.encoder.finish()]);
        if let Clock::Timestamps(profiler) = &mut *self.clock {
            // This fails only if a pass was left open, and `timed` closes them all.
            let _ = profiler.end_frame();
        }
    }
}
