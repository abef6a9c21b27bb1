//! Images on the screen: textures of the window's own device, which are shown where they are, and images in memory.

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::{Arc, Weak};

use egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions, Vec2};
use egui_wgpu::RenderState;
use lovelock_render::{DeviceImage, Gpu, Image, Picture, wgpu};

/// The images that are registered with the window's painter; none without a device of the window.
#[derive(Clone, Default)]
pub(crate) struct Textures(Rc<RefCell<Known>>);

#[derive(Default)]
struct Known {
    painter: Option<(RenderState, Arc<Gpu>)>,
    entries: Vec<Entry>,
}

/// A texture that is registered with the painter. The textures of a series are used in turn, so few have to be registered.
struct Entry {
    image: Weak<DeviceImage>,
    sharp: bool,
    id: TextureId,
}

impl Textures {
    /// Uses the painter of the window and its device from now on, and forgets everything about the one before.
    pub(crate) fn attach(&self, painter: Option<(RenderState, Arc<Gpu>)>) {
        *self.0.borrow_mut() = Known { painter, entries: Vec::new() };
    }

    /// Frees the textures of images that nobody holds any longer.
    pub(crate) fn sweep(&self) {
        let mut known = self.0.borrow_mut();
        let Known { painter: Some((painter, _)), entries } = &mut *known else { return };
        let mut renderer = painter.renderer.write();
        entries.retain(|entry| {
            let lives = entry.image.strong_count() > 0;
            if !lives {
                renderer.free_texture(&entry.id);
            }
            lives
        });
    }

    /// The texture of an image; `None` if it is on another device. `sharp` shows pixels without interpolation.
    fn of(&self, image: &Arc<DeviceImage>, sharp: bool) -> Option<TextureId> {
        let is_it = |entry: &&Entry| entry.sharp == sharp && entry.image.as_ptr() == Arc::as_ptr(image);
        let known = {
            let Known { painter, entries } = &*self.0.borrow();
            if !image.gpu().is_same_device(&painter.as_ref()?.1) {
                return None;
            }
            entries.iter().find(is_it).map(|entry| entry.id)
        };
        if known.is_some() {
            return known;
        }
        self.sweep();
        let Known { painter, entries } = &mut *self.0.borrow_mut();
        let (painter, _) = painter.as_ref()?;
        let mut renderer = painter.renderer.write();
        let filter = if sharp { wgpu::FilterMode::Nearest } else { wgpu::FilterMode::Linear };
        let id = renderer.register_native_texture(&painter.device, image.view(), filter);
        entries.push(Entry { image: Arc::downgrade(image), sharp, id });
        Some(id)
    }
}

/// The device of a painter, if it can render: not OpenGL, which lacks features that the shaders use.
pub(crate) fn device_of(painter: &RenderState) -> Option<Arc<Gpu>> {
    let info = painter.adapter.get_info();
    (info.backend != wgpu::Backend::Gl)
        .then(|| Gpu::adopt(painter.device.clone(), painter.queue.clone(), info))
}

/// How the window opens its device: as the renderer needs it where the adapter can render, otherwise as the painter needs it.
pub(crate) fn device_setup() -> egui_wgpu::WgpuSetup {
    let mut setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    let plain = Arc::clone(&setup.device_descriptor);
    setup.device_descriptor = Arc::new(move |adapter| {
        if adapter.get_info().backend == wgpu::Backend::Gl {
            plain(adapter)
        } else {
            Gpu::device_descriptor(adapter)
        }
    });
    setup.into()
}

/// An image that is shown.
#[derive(Default)]
pub(crate) struct ShownImage(Option<Held>);

enum Held {
    /// A copy in a texture of egui.
    Copied { of: Arc<Picture>, texture: TextureHandle, sharp: bool },
    /// The image itself.
    There { image: Arc<DeviceImage>, texture: TextureId },
}

impl ShownImage {
    /// Shows `image` from now on. An image without pixels or of a lost device leaves the one before.
    pub(crate) fn set(&mut self, ctx: &Context, textures: &Textures, name: &str, image: &Image, sharp: bool) {
        match image {
            Image::Device(image) => {
                if let Some(texture) = textures.of(image, sharp) {
                    self.0 = Some(Held::There { image: Arc::clone(image), texture });
                }
            }
            Image::Memory(picture) => self.copy(ctx, name, picture, sharp),
        }
    }

    fn copy(&mut self, ctx: &Context, name: &str, picture: &Arc<Picture>, sharp: bool) {
        let is_shown = |held: &Held| matches!(held, Held::Copied { of, sharp: shown, .. } if Arc::ptr_eq(of, picture) && *shown == sharp);
        if picture.rgba.is_empty() || self.0.as_ref().is_some_and(is_shown) {
            return;
        }
        // Images are opaque, so premultiplication leaves the bytes unchanged.
        let size = [picture.width as usize, picture.height as usize];
        let pixels = ColorImage::from_rgba_premultiplied(size, &picture.rgba);
        let options = if sharp { TextureOptions::NEAREST } else { TextureOptions::LINEAR };
        let texture = match self.0.take() {
            Some(Held::Copied { mut texture, .. }) => {
                texture.set(pixels, options);
                texture
            }
            _ => ctx.load_texture(name, pixels, options),
        };
        self.0 = Some(Held::Copied { of: Arc::clone(picture), texture, sharp });
    }

    /// Its texture, if an image is shown.
    pub(crate) fn texture(&self) -> Option<TextureId> {
        Some(match self.0.as_ref()? {
            Held::Copied { texture, .. } => texture.id(),
            Held::There { texture, .. } => *texture,
        })
    }

    /// Its size, pixels.
    pub(crate) fn size(&self) -> Option<Vec2> {
        let [width, height] = match self.0.as_ref()? {
            Held::Copied { of, .. } => [of.width, of.height],
            Held::There { image, .. } => image.size(),
        };
        Some(Vec2::new(width as f32, height as f32))
    }

    /// Forgets the image: its texture belongs to a device that is lost.
    pub(crate) fn forget(&mut self) {
        self.0 = None;
    }
}

/// Asks for one pass of the window, for threads with a new result. egui answers a plain request with two passes, each of which paints
/// the whole window: without a graphics card that costs as much as an image.
pub(crate) fn wake(ctx: &Context) {
    ctx.request_repaint_after(std::time::Duration::from_micros(1));
}
