//! The graphics device of the window, for the threads that draw for it.

use std::sync::{Arc, Mutex, PoisonError};

use lovelock_render::{DeviceImages, Gpu};

/// The graphics device of the window. Without a window, or if the window's device cannot render, there is none. After a loss the window
/// opens another one, which takes its place here.
#[derive(Clone, Debug, Default)]
pub struct WindowDevice {
    device: Arc<Mutex<Option<Arc<Gpu>>>>,
    /// Whether hair is simulated on it even if it is a software adapter, as in tests.
    simulates_in_software: bool,
}

impl WindowDevice {
    /// The device, if there is one.
    pub fn get(&self) -> Option<Arc<Gpu>> {
        self.device.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Replaces the device.
    pub fn set(&self, gpu: Option<Arc<Gpu>>) {
        *self.device.lock().unwrap_or_else(PoisonError::into_inner) = gpu;
    }

    /// The device for the simulation of hair, so that guides are drawn where they are. None on a software adapter, where a step would wait
    /// for the window's images, and while the device is lost.
    pub(crate) fn for_simulation(&self) -> Option<Arc<Gpu>> {
        self.get().filter(|gpu| !gpu.is_lost() && (self.simulates_in_software || !gpu.is_software()))
    }

    /// `gpu`, on which hair is simulated whatever it is.
    #[cfg(test)]
    pub(crate) fn simulating(gpu: Arc<Gpu>) -> Self {
        Self { device: Arc::new(Mutex::new(Some(gpu))), simulates_in_software: true }
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
