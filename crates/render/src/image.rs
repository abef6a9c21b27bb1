//! Finished images: in memory, or in a texture of a device, where a window shows them without a copy.

use std::sync::Arc;

use lovelock_gpu::{Gpu, read_texture_rgba8, wgpu};

use crate::{Picture, RenderError};

/// A finished image.
#[derive(Clone, Debug)]
pub enum Image {
    /// In memory.
    Memory(Arc<Picture>),
    /// In a texture of a device.
    Device(Arc<DeviceImage>),
}

impl Image {
    /// A picture in memory, copied to one of `textures` if there are any, and otherwise taken.
    pub fn on(textures: Option<&mut DeviceImages>, picture: &mut Picture) -> Self {
        match textures {
            Some(textures) if !textures.gpu().is_lost() && !picture.rgba.is_empty() => {
                Self::Device(textures.upload(picture))
            }
            _ => Self::Memory(Arc::new(std::mem::take(picture))),
        }
    }

    /// Whether it has no pixels.
    pub fn is_empty(&self) -> bool {
        matches!(self, Self::Memory(picture) if picture.rgba.is_empty())
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        match self {
            Self::Memory(picture) => [picture.width, picture.height],
            Self::Device(image) => image.size(),
        }
    }

    /// The memory of its pixels, bytes, where they are.
    pub fn bytes(&self) -> u64 {
        let [width, height] = self.size();
        4 * u64::from(width) * u64::from(height)
    }

    /// The pixels in memory. Those of a device are read back, which waits for the device.
    ///
    /// # Errors
    /// The device is lost.
    pub fn picture(&self) -> Result<Arc<Picture>, RenderError> {
        match self {
            Self::Memory(picture) => Ok(Arc::clone(picture)),
            Self::Device(image) => image.read().map(Arc::new),
        }
    }

    /// The image as a texture of a device; `None` in memory.
    pub fn on_device(&self) -> Option<&Arc<DeviceImage>> {
        match self {
            Self::Memory(_) => None,
            Self::Device(image) => Some(image),
        }
    }
}

impl Default for Image {
    /// An image without pixels.
    fn default() -> Self {
        Self::Memory(Arc::default())
    }
}

/// An image in a texture of a device, red, green, blue (sRGB-encoded) and alpha. While anybody holds it, it keeps its pixels.
#[derive(Debug)]
pub struct DeviceImage {
    gpu: Arc<Gpu>,
    texture: wgpu::Texture,
    view: wgpu::TextureView,
}

impl DeviceImage {
    fn new(gpu: &Arc<Gpu>, [width, height]: [u32; 2]) -> Self {
        let texture = gpu.create_texture(&wgpu::TextureDescriptor {
            label: Some("image"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { gpu: Arc::clone(gpu), texture, view }
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.texture.width(), self.texture.height()]
    }

    /// The texture for a shader: `rgba8unorm`, sRGB-encoded.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.view
    }

    /// The device of the image.
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// Copies the pixels to memory, which waits for the device.
    ///
    /// # Errors
    /// The device is lost.
    pub fn read(&self) -> Result<Picture, RenderError> {
        let [width, height] = self.size();
        let mut rgba = Vec::new();
        read_texture_rgba8(&self.gpu, &self.texture, &mut rgba)?;
        Ok(Picture { width, height, rgba })
    }
}

/// Textures for a series of images: those that nobody holds any longer are used again.
#[derive(Debug)]
pub struct DeviceImages {
    gpu: Arc<Gpu>,
    made: Vec<Arc<DeviceImage>>,
}

impl DeviceImages {
    /// Textures of this device.
    pub fn new(gpu: &Arc<Gpu>) -> Self {
        Self { gpu: Arc::clone(gpu), made: Vec::new() }
    }

    /// The device of the textures.
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// The memory of the textures, also of those that are shown, bytes.
    pub fn bytes(&self) -> u64 {
        self.made
            .iter()
            .map(|image| image.size().map(u64::from))
            .map(|[width, height]| 4 * width * height)
            .sum()
    }

    /// A texture of this size that nobody holds. Its pixels are those of an earlier image.
    pub(crate) fn free(&mut self, size: [u32; 2]) -> Arc<DeviceImage> {
        let is_free = |image: &Arc<DeviceImage>| Arc::strong_count(image) == 1;
        // Textures of another size are of no use any more.
        self.made.retain(|image| image.size() == size || !is_free(image));
        if let Some(free) = self.made.iter().find(|image| image.size() == size && is_free(image)) {
            return Arc::clone(free);
        }
        let new = Arc::new(DeviceImage::new(&self.gpu, size));
        self.made.push(Arc::clone(&new));
        new
    }

    /// Copies a picture in memory to the device. The device receives it before the next commands of its queue; nothing waits.
    pub fn upload(&mut self, picture: &Picture) -> Arc<DeviceImage> {
        let image = self.free([picture.width, picture.height]);
        self.gpu.upload_texture(&image.texture, &picture.rgba, picture.width);
        image
    }
}
