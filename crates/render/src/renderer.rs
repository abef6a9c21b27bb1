//! The renderer, independent of the backend.

use std::sync::Arc;
use std::time::Duration;

use glam::Vec3;
use lovelock_gpu::{Gpu, GpuError};

use crate::map_view::MapStage;
use crate::{
    Backend, ColorScale, CpuRenderer, DeviceImages, Finished, FrameInput, FrameStats, GpuRenderer, Image,
    Interrupt, Layers, MAX_IN_FLIGHT, MapValue, PendingPicture, Picture, RayStructure, RenderError,
};

/// Renders pictures on the chosen backend. Keeps buffers from picture to picture.
#[derive(Debug)]
pub struct Renderer {
    choice: Backend,
    gpu: Option<GpuRenderer>,
    cpu: Option<Box<CpuRenderer>>,
    /// The name of the device.
    adapter: String,
    /// The pixels of images that are copied to another device.
    spare: Picture,
    /// Textures for false colours, if the device is not the window's.
    images: Option<DeviceImages>,
    /// The shadow map that is drawn over images.
    map: MapStage,
}

impl Renderer {
    /// Opens a backend. [`Backend::Auto`] selects the GPU if there is one that is not a software adapter.
    ///
    /// # Errors
    /// There is no adapter for [`Backend::Gpu`], or it cannot be used.
    pub fn open(choice: Backend) -> Result<Self, RenderError> {
        match choice {
            Backend::Cpu => Ok(Self::on_processor(choice)),
            Backend::Gpu => Self::on(&Gpu::open()?, choice),
            // A software adapter is slower than the CPU backend. A GPU that cannot be used counts as absent.
            Backend::Auto => match Gpu::open() {
                Ok(gpu) if !gpu.is_software() => Ok(Self::on(&gpu, choice).unwrap_or_else(|error| {
                    tracing::warn!(%error, "the graphics card cannot be used");
                    Self::on_processor(choice)
                })),
                _ => Ok(Self::on_processor(choice)),
            },
        }
    }

    /// As [`Renderer::open`], on the device of a window if that is a graphics card that `choice` allows: its images are then shown
    /// without a copy. A software adapter of the window is left to the window: it draws on the same cores, and in one queue every click
    /// would wait for an image (measured on two cores: 467 ms from an input to the screen instead of 56).
    ///
    /// # Errors
    /// As there, or the device of the window is lost.
    pub fn open_for(choice: Backend, window: Option<&Arc<Gpu>>) -> Result<Self, RenderError> {
        match (choice, window.filter(|gpu| !gpu.is_software())) {
            (Backend::Gpu, Some(gpu)) => Self::on_window(gpu, choice),
            (Backend::Auto, Some(gpu)) => match Self::on_window(gpu, choice) {
                Err(error) if !gpu.is_lost() => {
                    tracing::warn!(%error, "the graphics card cannot be used");
                    Ok(Self::on_processor(choice))
                }
                opened => opened,
            },
            _ => Self::open(choice),
        }
    }

    /// A renderer on the device of a window, of whatever kind.
    ///
    /// # Errors
    /// A shader that does not compile, by file and line; or the device is lost.
    pub fn on_window(gpu: &Arc<Gpu>, choice: Backend) -> Result<Self, RenderError> {
        if gpu.is_lost() {
            return Err(GpuError::Lost("the window opens it again".to_owned()).into());
        }
        Self::on(gpu, choice)
    }

    /// A renderer on an open device.
    ///
    /// # Errors
    /// A shader that does not compile, by file and line.
    pub fn on_device(gpu: &Arc<Gpu>) -> Result<Self, RenderError> {
        Self::on(gpu, Backend::Gpu)
    }

    fn on(gpu: &Arc<Gpu>, choice: Backend) -> Result<Self, RenderError> {
        let adapter = gpu.info.name.clone();
        Ok(Self {
            choice,
            gpu: Some(GpuRenderer::new(gpu)?),
            cpu: None,
            adapter,
            spare: Picture::default(),
            images: None,
            map: MapStage::default(),
        })
    }

    fn on_processor(choice: Backend) -> Self {
        Self {
            choice,
            gpu: None,
            cpu: Some(Box::default()),
            adapter: CpuRenderer::adapter(),
            spare: Picture::default(),
            images: None,
            map: MapStage::default(),
        }
    }

    /// The backend that was chosen.
    pub fn choice(&self) -> Backend {
        self.choice
    }

    /// The backend in use: GPU or CPU.
    pub fn backend(&self) -> Backend {
        if self.gpu.is_some() { Backend::Gpu } else { Backend::Cpu }
    }

    /// The memory that it keeps from picture to picture, bytes; that of a graphics card is the device's.
    pub fn bytes(&self) -> u64 {
        self.cpu.as_ref().map_or(0, |cpu| cpu.bytes()) + self.spare.bytes()
    }

    /// The name of the device: that of the adapter, or the vector width of the CPU.
    pub fn adapter(&self) -> &str {
        &self.adapter
    }

    /// Whether the CPU renders, by the CPU backend or by a software adapter.
    pub fn is_software(&self) -> bool {
        self.gpu.as_ref().is_none_or(|gpu| gpu.gpu().is_software())
    }

    /// The device in use; `None` on the CPU.
    pub fn gpu(&self) -> Option<&Arc<Gpu>> {
        self.gpu.as_ref().map(GpuRenderer::gpu)
    }

    /// Whether results are kept for the next picture while nothing moves, which is so at first; see [`CpuRenderer::set_keeping`]. The GPU
    /// keeps nothing.
    pub fn set_keeping(&mut self, keeps: bool) {
        if self.gpu.is_none() {
            self.cpu.get_or_insert_default().set_keeping(keeps);
        }
    }

    /// Sets whether the following pictures may show only what has moved; see [`CpuRenderer::set_hurrying`]. The GPU draws all of each.
    pub fn set_hurrying(&mut self, hurries: bool) {
        if self.gpu.is_none() {
            self.cpu.get_or_insert_default().set_hurrying(hurries);
        }
    }

    /// Sets what ends the following pictures early; see [`CpuRenderer::set_interrupt`]. The GPU ends none.
    pub fn set_interrupt(&mut self, interrupt: Option<Interrupt>) {
        if self.gpu.is_none() {
            self.cpu.get_or_insert_default().set_interrupt(interrupt);
        }
    }

    /// Renders `input` at `width` by `height` pixels, with the shadow map over it if [`MapView`](crate::MapView) asks for it.
    ///
    /// # Errors
    /// The size is out of range, the shadow needs too much memory, or the device is lost.
    pub fn picture(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        picture: &mut Picture,
    ) -> Result<FrameStats, RenderError> {
        let stats = match &mut self.gpu {
            Some(gpu) => gpu.picture(input, width, height, picture),
            None => self.cpu.get_or_insert_default().picture(input, width, height, picture),
        }?;
        self.map.draw(input, picture)?;
        Ok(stats)
    }

    /// Starts to render a picture on the GPU without waiting for it; `None` on the CPU, which has nothing to wait for.
    ///
    /// # Errors
    /// As [`Renderer::picture`].
    pub fn begin_picture(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
    ) -> Result<Option<PendingPicture>, RenderError> {
        self.gpu.as_mut().map(|gpu| gpu.begin_picture(input, width, height)).transpose()
    }

    /// Finishes a picture of [`Renderer::begin_picture`] of the same `input`; `None` if it must be rendered again because lists were too
    /// short.
    ///
    /// # Errors
    /// As [`Renderer::picture`].
    pub fn finish_picture(
        &mut self,
        pending: PendingPicture,
        input: &FrameInput,
        picture: &mut Picture,
    ) -> Result<Option<FrameStats>, RenderError> {
        let Some(gpu) = &mut self.gpu else { return Ok(None) };
        let finished = gpu.finish_picture(pending, picture)?;
        if finished.is_some() {
            self.map.draw(input, picture)?;
        }
        Ok(finished)
    }

    /// Renders `input` for a window, whose textures are `window`; into memory without them. On the window's own device nothing is waited
    /// for: the image is finished before later commands of the window see it, and [`Renderer::finished`] tells when. `measured` asks for
    /// the times of passes and the mean transmittance, for which a device is read back.
    ///
    /// # Errors
    /// As [`Renderer::picture`].
    pub fn image(
        &mut self,
        input: &FrameInput,
        [width, height]: [u32; 2],
        measured: bool,
        window: Option<&mut DeviceImages>,
    ) -> Result<(Image, FrameStats), RenderError> {
        // A map is drawn over pixels in memory.
        let shows_map = input.picture.map_view.value != MapValue::None;
        if !shows_map
            && let Some(gpu) = self.on_device_of(window.as_deref())
            && let Some(images) = window
        {
            let (image, stats) = gpu.image(input, [width, height], measured, images)?;
            return Ok((Image::Device(image), stats));
        }
        let mut picture = std::mem::take(&mut self.spare);
        let drawn = self.picture(input, width, height, &mut picture);
        let image = drawn.is_ok().then(|| Image::on(window, &mut picture));
        self.spare = picture;
        Ok((image.unwrap_or_default(), drawn?))
    }

    /// Renders `input` with hair in the colours of `scale` by one value per stored strand: into a texture of `window`, or into memory
    /// without it. Waits for the device.
    ///
    /// # Errors
    /// As [`Renderer::picture`].
    pub fn strand_colors(
        &mut self,
        input: &FrameInput,
        [width, height]: [u32; 2],
        colors: (&[f32], &ColorScale),
        window: Option<&mut DeviceImages>,
    ) -> Result<(Image, FrameStats), RenderError> {
        if let Some(gpu) = self.on_device_of(window.as_deref())
            && let Some(images) = window
        {
            let (image, stats) = gpu.strand_colors(input, [width, height], colors, images)?;
            return Ok((Image::Device(image), stats));
        }
        let mut picture = Picture::default();
        let stats = if let Some(gpu) = &mut self.gpu {
            let own = self.images.get_or_insert_with(|| DeviceImages::new(gpu.gpu()));
            let (image, stats) = gpu.strand_colors(input, [width, height], colors, own)?;
            picture = image.read()?;
            stats
        } else {
            let cpu = self.cpu.get_or_insert_default();
            cpu.strand_colors(input, [width, height], colors, &mut picture)?
        };
        Ok((Image::on(window, &mut picture), stats))
    }

    /// The renderer on the GPU, if it draws into the textures of this window without a copy: if they are on one device.
    pub fn on_device_of(&mut self, window: Option<&DeviceImages>) -> Option<&mut GpuRenderer> {
        let gpu = self.gpu.as_mut()?;
        gpu.gpu().is_same_device(window?.gpu()).then_some(gpu)
    }

    /// Whether as many images of [`Renderer::image`] are in flight as may be.
    pub fn is_full(&self) -> bool {
        // On a software adapter the frames would only wait for each other.
        let most = if self.is_software() { 1 } else { MAX_IN_FLIGHT };
        self.in_flight() >= most
    }

    /// The number of images of [`Renderer::image`] that the device may not have finished.
    pub fn in_flight(&self) -> usize {
        self.gpu.as_ref().map_or(0, GpuRenderer::in_flight)
    }

    /// The oldest image in flight, if it is finished. Does not wait.
    ///
    /// # Errors
    /// The shadow needs too much memory, or the device is lost.
    pub fn finished(&mut self) -> Result<Option<Finished>, RenderError> {
        self.gpu.as_mut().map_or(Ok(None), GpuRenderer::finished)
    }

    /// Waits for the oldest image in flight, but not longer than `most`.
    pub fn wait_for_oldest(&self, most: Duration) {
        if let Some(gpu) = &self.gpu {
            gpu.wait_for_oldest(most);
        }
    }

    /// Renders the layers of an image of `input`, for compositing, transparent backgrounds and motion blur. Costs about twice as much
    /// as a picture. `over_background` draws the background and the ground behind hair and body; without it there is nothing behind
    /// them, and no shadow on the ground.
    ///
    /// # Errors
    /// As [`Renderer::picture`].
    pub fn layers(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        over_background: bool,
        layers: &mut Layers,
    ) -> Result<FrameStats, RenderError> {
        match &mut self.gpu {
            Some(gpu) => gpu.layers(input, width, height, over_background, layers),
            None => self.cpu.get_or_insert_default().layers(input, width, height, over_background, layers),
        }
    }

    /// As [`Renderer::layers`] without depth and transmittance, which stay as they are: for the mean of many images.
    ///
    /// # Errors
    /// As [`Renderer::picture`].
    pub fn light(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        over_background: bool,
        layers: &mut Layers,
    ) -> Result<FrameStats, RenderError> {
        match &mut self.gpu {
            Some(gpu) => gpu.light(input, width, height, over_background, layers),
            None => self.cpu.get_or_insert_default().light(input, width, height, over_background, layers),
        }
    }

    /// The transmittance of light `light` at every strand point of the last picture, 0 to 1, in the order of the points. Lights that
    /// are switched on count from 0. On the GPU it has steps of 1/255.
    ///
    /// # Errors
    /// There is no such light, no image has been rendered or the last one failed, or the device is lost.
    pub fn transmittance(&mut self, light: usize) -> Result<Vec<f32>, RenderError> {
        match &mut self.gpu {
            Some(gpu) => gpu.transmittance(light),
            None => self.cpu.get_or_insert_default().transmittance(light),
        }
    }

    /// Looks up any points (world space, metres) in the map of a light of the last picture: transmittance, 0 to 1, with the precision
    /// and for the lights of [`Renderer::transmittance`]. A point that is not finite gets 1.
    ///
    /// # Errors
    /// As [`Renderer::transmittance`], or more points than fit a buffer of the device.
    pub fn transmittance_at(&mut self, light: usize, points: &[Vec3]) -> Result<Vec<f32>, RenderError> {
        match &mut self.gpu {
            Some(gpu) => gpu.transmittance_at(light, points),
            None => self.cpu.get_or_insert_default().transmittance_at(light, points),
        }
    }

    /// What the map of a light of the last picture holds along the light through `p` (world space, metres). `None` on the GPU, whose
    /// maps are not read back: build the method's [`CpuShadow`](lovelock_shadow::CpuShadow) instead.
    ///
    /// # Errors
    /// On the CPU as [`Renderer::transmittance`].
    pub fn along_ray(&mut self, light: usize, p: Vec3) -> Result<Option<RayStructure>, RenderError> {
        match &self.gpu {
            Some(_) => Ok(None),
            None => self.cpu.get_or_insert_default().along_ray(light, p).map(Some),
        }
    }
}
