//! Pictures of one hairstyle on the dancer: at rest from one side, or at an instant of the dance.

use std::ops::ControlFlow;

use glam::Vec3;
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::files::Access;
use lovelock_project::project::{CameraSection, MotionSource};
use lovelock_project::styles::{Style, StyleParts};
use lovelock_render::{Backend, Picture, Renderer};
use lovelock_session::dance::Dance;
use lovelock_session::prepare::open_renderer;
use lovelock_session::progress::Progress;
use lovelock_session::snapshot::FrameSnapshot;

/// What a picture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shot {
    /// The hair at rest, from the camera's direction turned by so much to the dancer's left, radians.
    Rest(f32),
    /// The hair at rest, as large as head and hair down to the chest can be.
    Framed,
    /// The hair at so much of the dance, 0 to 1.
    Dance(f64),
}

/// Draws pictures of hairstyles.
pub struct Portraits {
    renderer: Renderer,
    access: Access,
    size: [u32; 2],
}

/// Pixels that are averaged along each side of a pixel, so that single strands do not flicker from picture to picture.
const SAMPLES: u32 = 2;

/// Frames of the dance per second.
const FPS: f64 = 30.0;

impl Portraits {
    /// Opens a renderer for pictures of `size` pixels.
    ///
    /// # Errors
    /// If there is no adapter for the backend, or the size is out of range.
    pub fn open(backend: Backend, size: [u32; 2]) -> Result<Self, ProjectError> {
        let [width, height] = size.map(|side| side.saturating_mul(SAMPLES));
        lovelock_render::check_size(width, height)?;
        Ok(Self { renderer: open_renderer(backend, None)?, access: Access::new(), size })
    }

    /// Allows files that styles name.
    #[must_use]
    pub fn with_access(self, access: Access) -> Self {
        Self { access, ..self }
    }

    /// The default project with a style, in the frame of a portrait.
    pub fn project_of(style: &Style) -> Project {
        let mut project = Project::default();
        project.apply_style(style, StyleParts::ALL);
        project.camera.azimuth = 0.55;
        project.camera.elevation = 0.04;
        project.camera.distance = 2.05;
        project.camera.follow_offset.y = -0.10;
        project
    }

    /// The pictures of a project, one per shot. Instants of the dance must be in ascending order.
    ///
    /// # Errors
    /// If no hair can be grown, an image cannot be drawn, or [`ProjectError::Cancelled`].
    pub fn draw(
        &mut self,
        project: &Project,
        shots: &[Shot],
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Vec<Picture>, ProjectError> {
        let mut rest = project.clone();
        rest.motion.source = MotionSource::Rest;
        rest.timeline.preroll_secs = 0.0;
        let mut resting: Option<Dance> = None;
        let mut dancing: Option<Dance> = None;
        let mut pictures = Vec::new();
        for shot in shots {
            let (dance, project, frame) = match *shot {
                Shot::Rest(_) | Shot::Framed => {
                    let mut project = rest.clone();
                    if let Shot::Rest(turn) = *shot {
                        project.camera.azimuth += turn;
                    }
                    let dance = if let Some(dance) = &mut resting {
                        dance
                    } else {
                        let mut dance = Dance::open(&rest, &self.access, FPS, progress)?.0;
                        dance.begin(0, 0.0, progress)?;
                        resting.insert(dance)
                    };
                    (dance, project, 0)
                }
                Shot::Dance(part) => {
                    let begun = dancing.is_some();
                    let dance = match &mut dancing {
                        Some(dance) => dance,
                        None => dancing.insert(Dance::open(project, &self.access, FPS, progress)?.0),
                    };
                    let frames = dance.frames();
                    let frame = ((part.clamp(0.0, 1.0) * frames as f64) as u64).min(frames.saturating_sub(1));
                    if !begun {
                        dance.begin(frame, dance.secs_of(frame), progress)?;
                    }
                    (dance, project.clone(), frame)
                }
            };
            let snapshot = dance.snapshot(frame)?;
            let mut project = project.seen_at(snapshot.position_secs).into_owned();
            if *shot == Shot::Framed {
                framed(&mut project.camera, &snapshot, self.size[0] as f32 / self.size[1] as f32);
            }
            let camera = snapshot.camera(&project.camera);
            let [width, height] = self.size.map(|side| side * SAMPLES);
            let mut picture = Picture::default();
            self.renderer.picture(&snapshot.frame_input(&project, &camera), width, height, &mut picture)?;
            pictures.push(averaged(&picture, SAMPLES));
        }
        Ok(pictures)
    }
}

/// Moves the camera so that head and hair fill an image whose width is `aspect` times its height. Hair below the chest is cut off.
fn framed(camera: &mut CameraSection, snapshot: &FrameSnapshot, aspect: f32) {
    /// Above the joint of the head, metres: the chest, the chin and the top of the skull, which are shown in any case.
    const CHEST: f32 = -0.30;
    const CHIN: f32 = -0.07;
    const SKULL: f32 = 0.20;
    /// Half the width of the head, metres.
    const CHEEK: f32 = 0.10;
    let (guides, head) = (&snapshot.guides.guides, snapshot.guides.world_from_head.translation);
    let (mut low, mut high, mut wide) = (CHIN, SKULL, CHEEK);
    for ((&x, &y), &z) in guides.x.iter().zip(&guides.y).zip(&guides.z) {
        let up = y - head.y;
        low = low.min(up.max(CHEST));
        high = high.max(up);
        if up > CHEST {
            wide = wide.max((x - head.x).hypot(z - head.z));
        }
    }
    let half = (0.5 * (high - low)).max(wide / aspect.max(0.1));
    camera.follow_offset = Vec3::new(0.0, 0.5 * (low + high), 0.0);
    camera.distance = (1.12 * half / (0.5 * camera.fov_y).tan().max(0.01) + CHEEK).clamp(0.3, 10.0);
}

/// A picture with the mean of each square of `samples` pixels as a pixel.
fn averaged(picture: &Picture, samples: u32) -> Picture {
    let (width, height) = (picture.width / samples, picture.height / samples);
    let mut rgba = Vec::with_capacity((width * height * 4) as usize);
    for y in 0..height {
        for x in 0..width {
            let mut sum = [0_u32; 4];
            for (dx, dy) in (0..samples).flat_map(|dy| (0..samples).map(move |dx| (dx, dy))) {
                let at = (((y * samples + dy) * picture.width + x * samples + dx) * 4) as usize;
                sum.iter_mut().zip(&picture.rgba[at..at + 4]).for_each(|(sum, v)| *sum += u32::from(*v));
            }
            rgba.extend(sum.map(|sum| ((sum + samples * samples / 2) / (samples * samples)) as u8));
        }
    }
    Picture { width, height, rgba }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_is_the_mean_of_its_square() {
        let rgba = [[0, 0, 0, 255], [100, 4, 0, 255], [100, 0, 8, 255], [200, 0, 0, 255]].concat();
        let mean = averaged(&Picture { width: 2, height: 2, rgba }, 2);
        assert_eq!((mean.width, mean.height, mean.rgba), (1, 1, vec![100, 1, 2, 255]));
    }
}
