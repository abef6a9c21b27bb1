//! The graphics device and its errors.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use bytemuck::Pod;

use crate::compiled::CompiledKernels;
use crate::constants::ConstantPool;
use crate::traffic::{Counters, Traffic};
use crate::{ShaderSource, check_shader};

/// An error of the graphics device.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter was found.
    #[error("no graphics adapter was found, not even a software one: {0}")]
    NoAdapter(String),
    /// The adapter could not create a device.
    #[error("the graphics adapter `{adapter}` could not create a device: {reason}")]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// The reason that it gave.
        reason: String,
    },
    /// A shader does not compile.
    #[error("{0}")]
    Shader(String),
    /// The scene exceeds a limit of the device or is inconsistent. The device can still be used.
    #[error("the graphics device cannot render this: {0}")]
    Input(String),
    /// The driver rejected a command.
    #[error("the graphics device rejected a command: {0}")]
    Refused(String),
    /// The device was lost: reset, unplugged, or its driver updated. It must be opened again.
    #[error("the graphics device was lost: {0}")]
    Lost(String),
    /// A buffer could not be read back.
    #[error("an image could not be read back from the graphics device: {0}")]
    Readback(String),
}

/// A handle of a graphics device: the device, its queue, a description of its adapter, and what goes through this handle.
/// Several handles may share a device, one for each renderer ([`Gpu::handle`]).
#[derive(Debug)]
pub struct Gpu {
    /// Creates resources.
    pub device: wgpu::Device,
    /// Receives commands.
    pub queue: wgpu::Queue,
    /// Name, type and backend of the adapter.
    pub info: wgpu::AdapterInfo,
    fault: Fault,
    pub(crate) counters: Counters,
    constants: Mutex<ConstantPool>,
    pub(crate) compiled: Arc<CompiledKernels>,
    frame: AtomicU64,
    number: u64,
}

/// The number of handles so far.
static HANDLES: AtomicU64 = AtomicU64::new(0);

/// The errors of a device that have not been reported.
#[derive(Debug, Default)]
struct Faults {
    /// The first rejected command since the last [`Gpu::check`].
    refused: Option<String>,
    /// Why the device was lost. It stays lost.
    lost: Option<String>,
}

type Fault = Arc<Mutex<Faults>>;

fn note(fault: &Fault, change: impl FnOnce(&mut Faults)) {
    change(&mut fault.lock().unwrap_or_else(PoisonError::into_inner));
}

impl Gpu {
    /// Opens the best adapter; a software adapter if there is no other.
    ///
    /// # Errors
    /// There is no adapter, or it cannot create a device.
    pub fn open() -> Result<Arc<Self>, GpuError> {
        Self::open_adapter(false)
    }

    /// Opens a software adapter, which renders on the CPU (Mesa's llvmpipe, where it is installed).
    ///
    /// # Errors
    /// There is no software adapter, or it cannot create a device.
    pub fn open_software() -> Result<Arc<Self>, GpuError> {
        Self::open_adapter(true)
    }

    fn open_adapter(force_fallback_adapter: bool) -> Result<Arc<Self>, GpuError> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        // OpenGL lacks features that the shaders use (a sample mask, storage buffers in vertex shaders), so it is left out.
        descriptor.backends &= wgpu::Backends::PRIMARY;
        let instance = wgpu::Instance::new(descriptor);
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            force_fallback_adapter,
            compatible_surface: None,
            apply_limit_buckets: false,
        }))
        .map_err(|error| GpuError::NoAdapter(error.to_string()))?;
        let info = adapter.get_info();
        let (device, queue) = pollster::block_on(adapter.request_device(&Self::device_descriptor(&adapter)))
            .map_err(|error| GpuError::NoDevice { adapter: info.name.clone(), reason: error.to_string() })?;
        Ok(Self::adopt(device, queue, info))
    }

    /// What a device of `adapter` must offer to render: the highest limits of the adapter where size matters, the defaults elsewhere,
    /// and timestamps if there are any.
    pub fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
        let has = adapter.limits();
        wgpu::DeviceDescriptor {
            label: Some("lovelock"),
            // Timestamps are the only optional feature that is used.
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: wgpu::Limits {
                max_texture_dimension_2d: has.max_texture_dimension_2d,
                max_storage_buffer_binding_size: has.max_storage_buffer_binding_size,
                max_buffer_size: has.max_buffer_size,
                ..wgpu::Limits::default()
            },
            ..Default::default()
        }
    }

    /// Takes a device that other code opened, such as the window, with the features and limits of [`Gpu::device_descriptor`]. Its errors are
    /// reported by [`Gpu::check`] from now on.
    pub fn adopt(device: wgpu::Device, queue: wgpu::Queue, info: wgpu::AdapterInfo) -> Arc<Self> {
        tracing::info!(adapter = %info.name, backend = %info.backend, "graphics device");
        let fault = Fault::default();
        let noted = Arc::clone(&fault);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            tracing::error!(%error, "graphics device");
            note(&noted, |faults| {
                faults.refused.get_or_insert_with(|| error.to_string());
            });
        }));
        let noted = Arc::clone(&fault);
        device.set_device_lost_callback(move |_, reason| {
            tracing::error!(reason, "the graphics device was lost");
            note(&noted, |faults| faults.lost = Some(reason));
        });
        Arc::new(Self {
            device,
            queue,
            info,
            fault,
            counters: Counters::default(),
            constants: Mutex::default(),
            compiled: Arc::default(),
            frame: AtomicU64::new(0),
            number: HANDLES.fetch_add(1, Ordering::Relaxed),
        })
    }

    /// Another handle of the same device, with counters and constants of its own.
    #[must_use]
    pub fn handle(&self) -> Arc<Self> {
        Arc::new(Self {
            device: self.device.clone(),
            queue: self.queue.clone(),
            info: self.info.clone(),
            fault: Arc::clone(&self.fault),
            counters: Counters::default(),
            constants: Mutex::default(),
            compiled: Arc::clone(&self.compiled),
            frame: AtomicU64::new(0),
            number: HANDLES.fetch_add(1, Ordering::Relaxed),
        })
    }

    /// The number of this handle, which no other one has, of whatever device.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Whether both are handles of one device.
    ///
    /// Devices themselves cannot be compared: those of two instances of wgpu have the same numbers, and so have their textures.
    pub fn is_same_device(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.fault, &other.fault)
    }

    /// Returns the error that occurred since the last call of any handle, if any.
    ///
    /// # Errors
    /// The loss of the device, from then on in every call; or the first command that the driver rejected.
    pub fn check(&self) -> Result<(), GpuError> {
        let mut faults = self.fault.lock().unwrap_or_else(PoisonError::into_inner);
        // A lost device rejects every command: the loss is the cause of the other errors.
        let refused = faults.refused.take();
        match &faults.lost {
            Some(reason) => Err(GpuError::Lost(reason.clone())),
            None => refused.map_or(Ok(()), |reason| Err(GpuError::Refused(reason))),
        }
    }

    /// Whether the device was lost. Does not wait.
    pub fn is_lost(&self) -> bool {
        // A loss is reported when the device is polled.
        let _ = self.device.poll(wgpu::PollType::Poll);
        self.fault.lock().unwrap_or_else(PoisonError::into_inner).lost.is_some()
    }

    /// What has gone through this handle so far.
    pub fn traffic(&self) -> Traffic {
        self.counters.totals()
    }

    /// Starts a frame of this handle: its passes get the constant buffers of the last frame again, in order.
    pub(crate) fn begin_frame(&self) {
        self.frame.fetch_add(1, Ordering::Relaxed);
        self.constants.lock().unwrap_or_else(PoisonError::into_inner).begin();
    }

    /// A uniform buffer that holds `bytes` until the next frame begins.
    pub(crate) fn constants(&self, label: &str, bytes: &[u8]) -> wgpu::Buffer {
        let make = || {
            self.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: (bytes.len() as u64).next_multiple_of(16),
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let (buffer, is_new) =
            self.constants.lock().unwrap_or_else(PoisonError::into_inner).take(bytes, make);
        if is_new {
            self.upload(&buffer, 0, bytes);
        }
        buffer
    }

    /// The number of frames of this handle that have begun.
    pub(crate) fn frame(&self) -> u64 {
        self.frame.load(Ordering::Relaxed)
    }

    /// Writes `items` to a buffer, `offset` bytes after its start, before the next submitted commands.
    pub fn upload<T: Pod>(&self, buffer: &wgpu::Buffer, offset: u64, items: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(items);
        if !bytes.is_empty() {
            self.counters.up(bytes.len() as u64);
            self.queue.write_buffer(buffer, offset, bytes);
        }
    }

    /// Writes all rows of a texture of four bytes per pixel, before the next submitted commands.
    pub fn upload_texture(&self, texture: &wgpu::Texture, rgba: &[u8], width: u32) {
        self.counters.up(rgba.len() as u64);
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
        self.queue.write_texture(texture.as_image_copy(), rgba, layout, texture.size());
    }

    /// Writes all rows of a level of a texture of four bytes per pixel, before the next submitted commands.
    pub fn upload_level(&self, texture: &wgpu::Texture, mip_level: u32, rgba: &[u8]) {
        self.counters.up(rgba.len() as u64);
        let [width, height] = [texture.width(), texture.height()].map(|side| (side >> mip_level).max(1));
        let to = wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() };
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        self.queue.write_texture(to, rgba, layout, size);
    }

    /// Counts bytes that come back to memory without [`Readback`](crate::Readback).
    pub fn note_read_back(&self, bytes: u64) {
        self.counters.back(bytes);
    }

    /// Creates a buffer.
    pub fn create_buffer(&self, descriptor: &wgpu::BufferDescriptor) -> wgpu::Buffer {
        self.counters.created();
        self.device.create_buffer(descriptor)
    }

    /// Creates a texture.
    pub fn create_texture(&self, descriptor: &wgpu::TextureDescriptor) -> wgpu::Texture {
        self.counters.created();
        self.device.create_texture(descriptor)
    }

    /// Waits until the device has finished everything that was submitted.
    ///
    /// # Errors
    /// The device is lost.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.counters.wait();
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        polled.map(|_| ()).map_err(|error| self.check().err().unwrap_or(GpuError::Lost(error.to_string())))
    }

    /// Whether the device can measure the duration of passes.
    pub fn has_timestamps(&self) -> bool {
        self.device.features().contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// The size of the largest buffer that a shader can read or write, bytes.
    pub fn most_storage_bytes(&self) -> u64 {
        let limits = self.device.limits();
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    }

    /// Whether the adapter renders on the CPU.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// The longest side that an image can have, pixels.
    pub fn max_picture_side(&self) -> u32 {
        self.device.limits().max_texture_dimension_2d
    }

    /// Creates resources with `make` and returns validation errors of the driver.
    ///
    /// # Errors
    /// The first error that the driver reports.
    pub fn checked<T>(&self, make: impl FnOnce() -> T) -> Result<T, GpuError> {
        self.apart(make).map_err(|error| GpuError::Shader(format!("{}: {error}", self.info.name)))
    }

    /// Runs `make`. What the driver refuses of it is told here, and to no other handle of the device by [`Gpu::check`].
    ///
    /// # Errors
    /// The first command of `make` that the driver rejects.
    pub fn apart<T>(&self, make: impl FnOnce() -> T) -> Result<T, wgpu::Error> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = make();
        pollster::block_on(scope.pop()).map_or(Ok(made), Err)
    }

    /// Compiles a composed shader.
    ///
    /// # Errors
    /// The file, the line and the reason where it does not compile. The device can still be used.
    pub fn shader(&self, label: &str, source: &ShaderSource) -> Result<wgpu::ShaderModule, GpuError> {
        check_shader(source)?;
        Ok(self.module(label, source))
    }

    pub(crate) fn module(&self, label: &str, source: &ShaderSource) -> wgpu::ShaderModule {
        self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(source.text().into()),
        })
    }
}
