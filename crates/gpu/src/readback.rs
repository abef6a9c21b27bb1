//! Copying buffers and textures from the device to memory.

use std::sync::mpsc::Receiver;

use bytemuck::Pod;

use crate::{Gpu, GpuError};

/// Reads several buffers of a frame back at once. The staging buffer is kept from frame to frame.
#[derive(Debug, Default)]
pub struct Readback {
    buffer: Option<wgpu::Buffer>,
    /// Bytes of each part.
    parts: Vec<u64>,
    /// The answer of the device, once it was asked.
    arrives: Option<Arrival>,
}

impl Readback {
    /// Encodes copying the first bytes of each of the `wanted` buffers; their numbers are multiples of 4,
    /// not all 0.
    pub fn copy(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, wanted: &[(&wgpu::Buffer, u64)]) {
        self.parts.clear();
        self.parts.extend(wanted.iter().map(|(_, bytes)| *bytes));
        let size = self.parts.iter().sum::<u64>();
        let buffer = match self.buffer.take() {
            Some(buffer) if buffer.size() == size => buffer,
            _ => gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("readback"),
                size,
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            }),
        };
        let mut at = 0;
        for &(from, bytes) in wanted.iter().filter(|(_, bytes)| *bytes > 0) {
            encoder.copy_buffer_to_buffer(from, 0, &buffer, at, bytes);
            at += bytes;
        }
        self.buffer = Some(buffer);
    }

    /// Asks for the copy, whose commands have been submitted. [`Readback::read`] waits only if it has not arrived by then.
    pub fn ask(&mut self, gpu: &Gpu) {
        if let Some(buffer) = &self.buffer {
            gpu.counters.back(buffer.size());
            self.arrives = Some(ask(buffer));
        }
    }

    /// Waits for the device if necessary, then writes the bytes of each buffer of [`Readback::copy`] into the vector at the same place.
    ///
    /// # Errors
    /// The device is lost or the buffer cannot be mapped.
    pub fn read(&mut self, gpu: &Gpu, into: &mut [&mut Vec<u8>]) -> Result<(), GpuError> {
        if self.arrives.is_none() {
            self.ask(gpu);
        }
        // Kept only on success: a buffer that stays mapped after an error cannot be used again.
        let (Some(buffer), Some(arrives)) = (self.buffer.take(), self.arrives.take()) else {
            return Err(GpuError::Readback("nothing was copied".to_owned()));
        };
        arrived(gpu, &arrives)?;
        {
            let bytes = buffer.get_mapped_range(..).map_err(|error| failed(gpu, error.to_string()))?;
            let mut rest = &bytes[..];
            for (into, &part) in into.iter_mut().zip(&self.parts) {
                let (here, after) = rest.split_at(part as usize);
                into.clear();
                into.extend_from_slice(here);
                rest = after;
            }
        }
        buffer.unmap();
        self.buffer = Some(buffer);
        Ok(())
    }
}

/// Reads a texture of four bytes per pixel into `out`, row by row from the top without padding.
///
/// # Errors
/// The device is lost or the buffer cannot be mapped.
pub fn read_texture_rgba8(gpu: &Gpu, texture: &wgpu::Texture, out: &mut Vec<u8>) -> Result<(), GpuError> {
    let (width, height) = (texture.width(), texture.height());
    let row = width * 4;
    let padded_row = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: u64::from(padded_row) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded_row),
                rows_per_image: None,
            },
        },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
    map(gpu, &buffer)?;
    out.clear();
    {
        let bytes = buffer.get_mapped_range(..).map_err(|error| GpuError::Readback(error.to_string()))?;
        for line in bytes.chunks_exact(padded_row as usize) {
            out.extend_from_slice(&line[..row as usize]);
        }
    }
    buffer.unmap();
    Ok(())
}

/// Reads the first `out.len()` items of a buffer, whose usage must include `COPY_SRC`.
///
/// # Errors
/// The device is lost or the buffer cannot be mapped.
pub fn read_buffer<T: Pod>(gpu: &Gpu, from: &wgpu::Buffer, out: &mut [T]) -> Result<(), GpuError> {
    let size = size_of_val(out) as u64;
    if size == 0 {
        return Ok(());
    }
    let buffer = gpu.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(from, 0, &buffer, 0, size);
    gpu.queue.submit([encoder.finish()]);
    map(gpu, &buffer)?;
    let bytes = buffer.get_mapped_range(..).map_err(|error| GpuError::Readback(error.to_string()))?;
    bytemuck::cast_slice_mut(out).copy_from_slice(&bytes);
    Ok(())
}

/// Waits until the device has finished, then maps a buffer.
fn map(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<(), GpuError> {
    gpu.counters.back(buffer.size());
    arrived(gpu, &ask(buffer))
}

type Arrival = Receiver<Result<(), wgpu::BufferAsyncError>>;

/// Asks for mapping a buffer.
fn ask(buffer: &wgpu::Buffer) -> Arrival {
    let (sender, receiver) = std::sync::mpsc::sync_channel(1);
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        let _ = sender.send(result);
    });
    receiver
}

/// Waits for a mapping, if the device has not finished already.
fn arrived(gpu: &Gpu, arrives: &Arrival) -> Result<(), GpuError> {
    let _ = gpu.device.poll(wgpu::PollType::Poll);
    let result = if let Ok(result) = arrives.try_recv() {
        result
    } else {
        gpu.wait()?;
        arrives.recv().map_err(|error| failed(gpu, error.to_string()))?
    };
    result.map_err(|error| failed(gpu, error.to_string()))
}

/// The error of a readback that failed. An earlier error of the device explains it better than the failure itself.
fn failed(gpu: &Gpu, reason: String) -> GpuError {
    // The loss of a device is told when it is asked.
    let _ = gpu.device.poll(wgpu::PollType::Poll);
    gpu.check().err().unwrap_or(GpuError::Readback(reason))
}
