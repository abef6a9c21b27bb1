//! The graphics device of the window, for the threads that draw for it.

use std::sync::{Arc, Mutex, PoisonError};

use lovelock_render::{DeviceImages, Gpu};

/// The graphics device of the window. Without a window, or if the window's device cannot render, there is none. After a loss the window
/// opens another one, which takes its place here.
#[derive(Clone, Debug, Default)]
pub struct WindowDevice(Arc<Mutex<Option<Arc<Gpu>>>>);

impl WindowDevice {
    /// The device, if there is one.
    pub fn get(&self) -> Option<Arc<Gpu>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Replaces the device.
    pub fn set(&self, gpu: Option<Arc<Gpu>>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = gpu;
    }

    /// The textures of a series of images on the device: those in `images` while the device is the same, otherwise new ones; none
    /// while it is lost.
    pub fn images<'a>(&self, images: &'a mut Option<DeviceImages>) -> Option<&'a mut DeviceImages> {
        let gpu = self.get().filter(|gpu| !gpu.is_lost());
        let same = |images: &DeviceImages| gpu.as_ref().is_some_and(|gpu| gpu.is_same_device(images.gpu()));
        if !images.as_ref().is_some_and(same) {
            *images = gpu.as_ref().map(DeviceImages::new);
        }
        images.as_mut()
    }
}
