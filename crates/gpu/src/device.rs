//! The graphics device and its errors.

use std::sync::{Arc, Mutex, PoisonError};

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
    #[error("a picture could not be read back from the graphics device: {0}")]
    Readback(String),
}

/// A graphics device, its queue and a description of its adapter.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// Creates resources.
    pub device: wgpu::Device,
    /// Receives commands.
    pub queue: wgpu::Queue,
    /// Name, type and backend of the adapter.
    pub info: wgpu::AdapterInfo,
    /// The first error since the last [`Gpu::check`], or the loss of the device.
    fault: Fault,
}

type Fault = Arc<Mutex<Option<GpuError>>>;

fn note(fault: &Fault, error: GpuError) {
    tracing::error!(%error, "graphics device");
    let mut fault = fault.lock().unwrap_or_else(PoisonError::into_inner);
    // A lost device rejects every command: the loss is the cause of the other errors.
    if fault.is_none() || matches!(error, GpuError::Lost(_)) {
        *fault = Some(error);
    }
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
        // The highest limits of the adapter where size matters; the defaults elsewhere.
        let has = adapter.limits();
        let required_limits = wgpu::Limits {
            max_texture_dimension_2d: has.max_texture_dimension_2d,
            max_storage_buffer_binding_size: has.max_storage_buffer_binding_size,
            max_buffer_size: has.max_buffer_size,
            ..wgpu::Limits::default()
        };
        // Timestamps are the only optional feature that is used.
        let required_features = adapter.features() & wgpu::Features::TIMESTAMP_QUERY;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("lovelock"),
            required_features,
            required_limits,
            ..Default::default()
        }))
        .map_err(|error| GpuError::NoDevice { adapter: info.name.clone(), reason: error.to_string() })?;
        tracing::info!(adapter = %info.name, backend = %info.backend, "graphics device");
        let fault = Fault::default();
        let noted = Arc::clone(&fault);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            note(&noted, GpuError::Refused(error.to_string()));
        }));
        let noted = Arc::clone(&fault);
        device.set_device_lost_callback(move |_, reason| note(&noted, GpuError::Lost(reason)));
        Ok(Arc::new(Self { device, queue, info, fault }))
    }

    /// Returns the error that occurred since the last call, if any.
    ///
    /// # Errors
    /// The first command that the driver rejected, or the loss of the device.
    pub fn check(&self) -> Result<(), GpuError> {
        self.fault.lock().unwrap_or_else(PoisonError::into_inner).take().map_or(Ok(()), Err)
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
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = make();
        match pollster::block_on(scope.pop()) {
            None => Ok(made),
            Some(error) => Err(GpuError::Shader(format!("{}: {error}", self.info.name))),
        }
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
