//! The device that pictures are made on.

use std::sync::Arc;

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
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("lovelock"),
            required_features: wgpu::Features::empty(),
            required_limits,
            ..Default::default()
        }))
        .map_err(|error| GpuError::NoDevice { adapter: info.name.clone(), reason: error.to_string() })?;
        tracing::info!(adapter = %info.name, backend = %info.backend, "graphics device");
        Ok(Arc::new(Self { device, queue, info }))
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
        Ok(self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(source.text().into()),
        }))
    }
}

use crate::{ShaderSource, check_shader};
