//! Reading textures back.

use bytemuck::Pod;

use crate::{Gpu, GpuError};

/// Brings a finished picture and a few numbers back; its memory is kept from frame to frame.
#[derive(Debug, Default)]
pub struct Readback {
    buffer: Option<wgpu::Buffer>,
    /// Bytes of a row in the buffer, of a row of the picture, rows, and words after them.
    layout: [u64; 4],
}

impl Readback {
    /// Encodes copying a texture of four bytes a pixel, and the first `words` words of `numbers`.
    pub fn copy(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        texture: &wgpu::Texture,
        (numbers, words): (&wgpu::Buffer, u64),
    ) {
        let (width, height) = (texture.width(), texture.height());
        let padded_row = (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let rows = u64::from(padded_row) * u64::from(height);
        let size = rows + 4 * words;
        self.layout = [u64::from(padded_row), u64::from(width) * 4, u64::from(height), words];
        let buffer = match self.buffer.take() {
            Some(buffer) if buffer.size() == size => buffer,
            _ => gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("readback"),
                size,
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            }),
        };
        let buffer = self.buffer.insert(buffer);
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded_row),
                    rows_per_image: None,
                },
            },
            texture.size(),
        );
        encoder.copy_buffer_to_buffer(numbers, 0, buffer, rows, 4 * words);
    }

    /// Waits for the device and takes what was copied: rows from the top, tightly packed, and the numbers.
    ///
    /// # Errors
    /// The device is lost or the buffer cannot be mapped.
    pub fn read(&mut self, gpu: &Gpu, picture: &mut Vec<u8>, numbers: &mut Vec<u32>) -> Result<(), GpuError> {
        let Some(buffer) = &self.buffer else {
            return Err(GpuError::Readback("nothing was copied".to_owned()));
        };
        let [padded_row, row, height, _] = self.layout.map(|size| size as usize);
        map(gpu, buffer)?;
        picture.clear();
        {
            let bytes = buffer.get_mapped_range(..).map_err(|error| GpuError::Readback(error.to_string()))?;
            let (rows, words) = bytes.split_at(padded_row * height);
            for line in rows.chunks_exact(padded_row.max(1)) {
                picture.extend_from_slice(&line[..row]);
            }
            numbers.clear();
            numbers.extend(
                words.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])),
            );
        }
        buffer.unmap();
        Ok(())
    }
}

/// Reads a texture of four bytes a pixel back; rows from the top, tightly packed, into `out`.
///
/// # Errors
/// The device is lost or the buffer cannot be mapped.
pub fn read_texture_rgba8(gpu: &Gpu, texture: &wgpu::Texture, out: &mut Vec<u8>) -> Result<(), GpuError> {
    let (width, height) = (texture.width(), texture.height());
    let row = width * 4;
    let padded_row = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
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

/// Reads the first `out.len()` items of a buffer back, which must be usable as the source of a copy.
///
/// # Errors
/// The device is lost or the buffer cannot be mapped.
pub fn read_buffer<T: Pod>(gpu: &Gpu, from: &wgpu::Buffer, out: &mut [T]) -> Result<(), GpuError> {
    let size = size_of_val(out) as u64;
    if size == 0 {
        return Ok(());
    }
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
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

/// Waits until the device is done, and maps a buffer.
fn map(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<(), GpuError> {
    let failed = |reason: String| GpuError::Readback(reason);
    let (sender, receiver) = std::sync::mpsc::sync_channel(1);
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        let _ = sender.send(result);
    });
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(error.to_string()))?;
    receiver.recv().map_err(|error| failed(error.to_string()))?.map_err(|error| failed(error.to_string()))
}
