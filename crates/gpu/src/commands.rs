//! The passes of one frame, timed where the device can.

use wgpu_profiler::{GpuProfiler, GpuProfilerSettings, GpuTimerQueryResult};

use crate::{Gpu, GpuError};

/// What one pass took on the device. Passes of one name are summed.
#[derive(Clone, Debug, PartialEq)]
pub struct PassTime {
    /// The pass.
    pub name: String,
    /// Milliseconds.
    pub ms: f64,
}

/// Measures passes by the timestamps of the device; measures nothing where it has none.
pub struct PassTimer(GpuProfiler);

impl std::fmt::Debug for PassTimer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PassTimer").finish_non_exhaustive()
    }
}

impl PassTimer {
    /// A timer of the device's passes.
    ///
    /// # Errors
    /// The device refuses.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let settings = GpuProfilerSettings {
            enable_timer_queries: gpu.has_timestamps(),
            enable_debug_groups: false,
            max_num_pending_frames: 4,
        };
        let profiler = GpuProfiler::new(&gpu.device, settings);
        profiler.map(Self).map_err(|error| GpuError::Refused(format!("timers: {error}")))
    }

    /// Begins a frame.
    pub fn begin(&self, gpu: &Gpu, label: &str) -> Commands<'_> {
        let encoder =
            gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) });
        Commands { encoder, profiler: &self.0 }
    }

    /// Ends what [`PassTimer::begin`] began and hands it to the device.
    pub fn submit(&mut self, gpu: &Gpu, mut encoder: wgpu::CommandEncoder) {
        self.0.resolve_queries(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        // Fails where a pass was left open, which `Commands` does not allow.
        let _ = self.0.end_frame();
    }

    /// Times of the last frame that is finished, in the order of its passes; empty where none was measured. Wait for the
    /// device before.
    pub fn times(&mut self, gpu: &Gpu) -> Vec<PassTime> {
        let mut newest = Vec::new();
        while let Some(found) = self.0.process_finished_frame(gpu.queue.get_timestamp_period()) {
            newest = summed(&found);
        }
        newest
    }
}

fn summed(found: &[GpuTimerQueryResult]) -> Vec<PassTime> {
    let mut times: Vec<PassTime> = Vec::new();
    for pass in found {
        let Some(range) = &pass.time else { continue };
        let ms = ((range.end - range.start) * 1e3).max(0.0);
        match times.iter_mut().find(|time| time.name == pass.label) {
            Some(time) => time.ms += ms,
            None => times.push(PassTime { name: pass.label.clone(), ms }),
        }
    }
    times
}

/// The commands of one frame.
pub struct Commands<'a> {
    encoder: wgpu::CommandEncoder,
    profiler: &'a GpuProfiler,
}

impl std::fmt::Debug for Commands<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Commands").finish_non_exhaustive()
    }
}

impl Commands<'_> {
    /// A compute pass. Kernels in it run one after another.
    pub fn compute(&mut self, name: &str, with: impl FnOnce(&mut wgpu::ComputePass)) {
        let query = self.profiler.begin_pass_query(name, &mut self.encoder);
        with(&mut self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(name),
            timestamp_writes: query.compute_pass_timestamp_writes(),
        }));
        self.profiler.end_query(&mut self.encoder, query);
    }

    /// A render pass of what `descriptor` says but for its label and timestamps.
    pub fn render(
        &mut self,
        name: &str,
        descriptor: &wgpu::RenderPassDescriptor,
        with: impl FnOnce(&mut wgpu::RenderPass),
    ) {
        let query = self.profiler.begin_pass_query(name, &mut self.encoder);
        with(&mut self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            timestamp_writes: query.render_pass_timestamp_writes(),
            ..descriptor.clone()
        }));
        self.profiler.end_query(&mut self.encoder, query);
    }

    /// Everything else that goes to the device, between passes.
    pub fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        &mut self.encoder
    }

    /// The whole, for [`PassTimer::submit`].
    pub fn finish(self) -> wgpu::CommandEncoder {
        self.encoder
    }
}
