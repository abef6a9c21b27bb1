//! Pictures that are waited for.

use std::sync::Arc;

use lovelock_base::clock::Stopwatch;
use lovelock_gpu::{GpuError, PassTime, PassTimer, Readback, Traffic};
use lovelock_picture::check_size_for;

use super::{GpuRenderer, ListsOfFrame, MAX_ATTEMPTS, Output, number_of_bytes};
use crate::gpu::present::{HEAD_BYTES, MAX_LISTS};
use crate::{FrameInput, FrameStats, Picture, RenderError};

impl GpuRenderer {
    /// Renders `input` at `width` by `height` pixels and reads the picture back.
    ///
    /// # Errors
    /// The size is out of range, maps do not fit, or the device is lost.
    pub fn picture(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        picture: &mut Picture,
    ) -> Result<FrameStats, RenderError> {
        self.settled(input, [width, height], true, picture)
    }

    /// Renders `input` until its lists are long enough. Reads the pixels back if `back`.
    pub(super) fn settled(
        &mut self,
        input: &FrameInput,
        size: [u32; 2],
        back: bool,
        picture: &mut Picture,
    ) -> Result<FrameStats, RenderError> {
        let before = self.gpu.traffic();
        for _ in 0..=MAX_ATTEMPTS {
            let pending = self.begin(input, size, back)?;
            if let Some(stats) = self.finish_picture(pending, picture)? {
                return Ok(FrameStats { traffic: self.gpu.traffic().since(before), ..stats });
            }
        }
        Err(unsettled())
    }

    /// Starts to render `input` and to read the picture back, without waiting. Pictures are finished in the order in which they began,
    /// each by [`GpuRenderer::finish_picture`], so that the device draws while the caller prepares the next one.
    ///
    /// # Errors
    /// As [`GpuRenderer::picture`].
    pub fn begin_picture(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
    ) -> Result<PendingPicture, RenderError> {
        self.begin(input, [width, height], true)
    }

    /// Starts to render `input` and to read back what the frame reports, with the pixels if `back`.
    fn begin(
        &mut self,
        input: &FrameInput,
        [width, height]: [u32; 2],
        back: bool,
    ) -> Result<PendingPicture, RenderError> {
        check_size_for(width, height, self.gpu.max_picture_side())?;
        self.is_whole = false;
        let gpu = Arc::clone(&self.gpu);
        let (watch, before) = (Stopwatch::start(), gpu.traffic());
        let mut timer = std::mem::take(&mut self.timer);
        let mut readback = self.readbacks.pop().unwrap_or_default();
        let output = Output::Memory { readback: &mut readback, pixels: back };
        let drawn = self.draw(&gpu, timer.begin(&gpu, "frame"), input, width, height, output);
        if let Err(error) = drawn {
            // The incomplete timings are dropped, and errors of the driver belong to this picture.
            self.timer = PassTimer::new(&gpu)?;
            let _ = gpu.check();
            return Err(error);
        }
        self.timer = timer;
        readback.ask(&gpu);
        Ok(PendingPicture {
            readback,
            size: [width, height],
            lists: self.lists_of_frame(),
            points: self.hair.drawn().point_count,
            // A software adapter has measured them already; a card tells them when it has finished.
            passes: if gpu.is_software() { self.timer.times(&gpu) } else { Vec::new() },
            begun_ms: watch.ms(),
            traffic: gpu.traffic().since(before),
        })
    }

    /// Waits for a picture if the device has not finished it. `None` if lists were too short: they have been enlarged, and the picture
    /// must be begun again.
    ///
    /// # Errors
    /// As [`GpuRenderer::picture`].
    pub fn finish_picture(
        &mut self,
        mut pending: PendingPicture,
        picture: &mut Picture,
    ) -> Result<Option<FrameStats>, RenderError> {
        let gpu = Arc::clone(&self.gpu);
        let (watch, before) = (Stopwatch::start(), gpu.traffic());
        pending.readback.read(&gpu, &mut [&mut picture.rgba, &mut self.numbers, &mut self.heads])?;
        self.readbacks.push(pending.readback);
        gpu.check()?;
        let mut heads = [[0_u32; 2]; MAX_LISTS];
        for (head, bytes) in heads.iter_mut().zip(self.heads.chunks_exact(HEAD_BYTES as usize)) {
            let words: [u32; 4] = bytemuck::pod_read_unaligned(bytes);
            *head = [words[0], words[1]];
        }
        if self.settle(&pending.lists, &heads)? {
            return Ok(None);
        }
        [picture.width, picture.height] = pending.size;
        self.is_whole = true;
        let passes = if pending.passes.is_empty() { self.timer.times(&gpu) } else { pending.passes };
        let mut stats = self.stats(passes);
        let whole_ms = pending.begun_ms + watch.ms();
        stats.draw_ms = (whole_ms - stats.interpolate_ms - stats.shadow_ms).max(0.0);
        stats.traffic = pending.traffic.plus(gpu.traffic().since(before));
        if self.shadow.has_light() {
            let points = f64::from(pending.points.max(1));
            stats.mean_transmittance = (number_of_bytes(&self.numbers) / (255.0 * points)) as f32;
        }
        Ok(Some(stats))
    }
}

/// A picture that the device draws: see [`GpuRenderer::begin_picture`].
#[derive(Debug)]
pub struct PendingPicture {
    readback: Readback,
    size: [u32; 2],
    lists: ListsOfFrame,
    /// The number of strand points.
    points: u32,
    passes: Vec<PassTime>,
    begun_ms: f64,
    traffic: Traffic,
}

/// The error for a picture whose lists are never long enough.
pub(super) fn unsettled() -> RenderError {
    GpuError::Input("the lists of fragments did not settle; draw on the CPU".to_owned()).into()
}
