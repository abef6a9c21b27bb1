//! What the render thread is asked for, and what it answers.

use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::project::backend_label;
use lovelock_render::{Backend, Camera, FrameStats, Image};

use super::ShownMask;
use crate::snapshot::FrameSnapshot;
use crate::stats::StageTimes;

/// How well an image is rendered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ImageQuality {
    /// Something moves, and an image of full quality follows when it rests.
    Draft,
    /// Completely, once.
    #[default]
    Full,
    /// Nothing moves: after the image, the CPU renders further samples of it until another request arrives.
    Refined,
}

/// What to render.
#[derive(Clone, Debug)]
pub struct RenderRequest {
    /// Settings of the image, lights, look and camera.
    pub project: Arc<Project>,
    /// The instant.
    pub snapshot: Arc<FrameSnapshot>,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// How well to render it.
    pub quality: ImageQuality,
    /// Whether the times of passes and the mean transmittance are wanted, for which a graphics device is read back.
    pub measured: bool,
    /// A mask that is shown on hair and scalp in place of their colours.
    pub mask: Option<Arc<ShownMask>>,
    /// Rises with each input of the user that the image shows, and not with the frames of a dance: see [`Inputs`](super::Inputs). The CPU
    /// gives up an image that has hardly begun if a request with another number waits, and shows first what has moved until an image with
    /// this number is whole.
    pub input: u64,
}

/// A finished image with its cost.
#[derive(Clone, Debug)]
pub struct RenderedImage {
    /// The image. On the window's device it may still be drawn; later commands of the window wait for it there.
    pub image: Image,
    /// The camera that it was rendered with.
    pub camera: Camera,
    /// Statistics of the render.
    pub stats: FrameStats,
    /// Times of all stages of this frame except `encode`. A frame that a device still draws has the time of the one before.
    pub times: StageTimes,
    /// The size of the frame that was finished last, pixels, and its time, milliseconds.
    pub cost: Option<([u32; 2], f64)>,
    /// The instant.
    pub snapshot: Arc<FrameSnapshot>,
    /// [`FrameSnapshot::step`] of the instant.
    pub step: u64,
    /// [`FrameSnapshot::position_secs`] of the instant.
    pub position_secs: f64,
    /// [`RenderRequest::input`] of its request.
    pub input: u64,
    /// The number of samples of each pixel.
    pub samples: u32,
    /// The project that it shows.
    pub project: Arc<Project>,
    /// The mask that it shows in place of the colours of hair.
    pub mask: Option<Arc<ShownMask>>,
}

/// The device that renders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adapter {
    /// Its name, as reported by the driver.
    pub name: String,
    /// Its backend, GPU or CPU.
    pub backend: Backend,
    /// Whether it runs on the CPU.
    pub software: bool,
}

impl Adapter {
    /// The short name of its backend for labels: `CPU` or `GPU`.
    pub const fn backend_label(&self) -> &'static str {
        backend_label(self.backend)
    }
}
