//! The device that pictures are made on.

use std::sync::{Arc, Mutex, PoisonError};

use crate::{ShaderSource, check_shader};

/// What can go wrong with the graphics device.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No adapter was found.
    #[error("no graphics adapter was found, not even a software one: {0}")]
    NoAdapter(String),
    /// The adapter refused to make a device.
    #[error("the graphics adapter `{adapter}` made no device: {reason}")]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// What it said.
        reason: String,
    },
    /// A shader does not compile.
    #[error("{0}")]
    Shader(String),
    /// What is to be drawn does not fit the device, or contradicts itself. The device is as good as before.
    #[error("the graphics device cannot draw this: {0}")]
    Input(String),
    /// The driver takes no more work as it was asked.
    #[error("the graphics device refused: {0}")]
    Refused(String),
    /// The device is gone: reset, unplugged or updated. It must be opened again.
    #[error("the graphics device was lost: {0}")]
    Lost(String),
    /// A buffer could not be read back.
    #[error("a picture could not be read back from the graphics device: {0}")]
    Readback(String),
}

/// A graphics device with its queue, and what it is.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// Makes resources.
    pub device: wgpu::Device,
    /// Takes work.
    pub queue: wgpu::Queue,
    /// What the adapter says of itself.
    pub info: wgpu::AdapterInfo,
    /// The first thing that went wrong and that nobody has heard of yet, or that the device is lost.
    fault: Fault,
}

type Fault = Arc<Mutex<Option<GpuError>>>;

fn note(fault: &Fault, error: GpuError) {
    tracing::error!(%error, "graphics device");
    let mut fault = fault.lock().unwrap_or_else(PoisonError::into_inner);
    // A device that is lost refuses everything: that it is lost says why.
    if fault.is_none() || matches!(error, GpuError::Lost(_)) {
        *fault = Some(error);
    }
}

impl Gpu {
    /// Opens the best adapter that there is, a software one where there is nothing else.
    ///
    /// # Errors
    /// No adapter, or an adapter that makes no device.
    pub fn open() -> Result<Arc<Self>, GpuError> {
        Self::open_adapter(false)
    }

    /// Opens a software adapter, which draws on the processor (Mesa's llvmpipe, where it is installed).
    ///
    /// # Errors
    /// No software adapter, or one that makes no device.
    pub fn open_software() -> Result<Arc<Self>, GpuError> {
        Self::open_adapter(true)
    }

    fn open_adapter(force_fallback_adapter: bool) -> Result<Arc<Self>, GpuError> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        // OpenGL lacks what the shaders use (a mask of samples, storage in vertices): it counts as no adapter.
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
        // Ask for what the adapter has where more is better, and for the defaults elsewhere.
        let has = adapter.limits();
        let required_limits = wgpu::Limits {
            max_texture_dimension_2d: has.max_texture_dimension_2d,
            max_storage_buffer_binding_size: has.max_storage_buffer_binding_size,
            max_buffer_size: has.max_buffer_size,
            ..wgpu::Limits::default()
        };
        // Timers are of use wherever they are; nothing else that is optional is needed.
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

    /// Hears of what went wrong since the last time.
    ///
    /// # Errors
    /// The first thing that the driver refused, or that the device is lost.
    pub fn check(&self) -> Result<(), GpuError> {
        self.fault.lock().unwrap_or_else(PoisonError::into_inner).take().map_or(Ok(()), Err)
    }

    /// Whether the device measures the time of passes.
    pub fn has_timestamps(&self) -> bool {
        self.device.features().contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// The most bytes of one buffer that a shader reads or writes.
    pub fn most_storage_bytes(&self) -> u64 {
        let limits = self.device.limits();
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    }

    /// Whether the adapter runs on the processor.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// Longest side of a picture, pixels.
    pub fn max_picture_side(&self) -> u32 {
        self.device.limits().max_texture_dimension_2d
    }

    /// Makes things on the device, and says why where it refuses.
    ///
    /// # Errors
    /// What the driver says of the first thing that it does not take.
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
    /// The file and line that do not compile, and why. The device is not disturbed.
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
