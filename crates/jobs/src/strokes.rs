//! A film of strokes that are played on the hair: what is seen while somebody brushes.

use std::path::Path;

use glam::{Vec2, Vec3};
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_record::{FilmReport, FilmSettings, FilmWriter, OutputKind, RecordError};
use lovelock_render::{Camera, Picture, Renderer};
use lovelock_session::engine::Engine;
use lovelock_session::prepare::open_renderer;
use lovelock_session::strokes::PlayedBrush;

/// The colour of the brush's circle.
const CIRCLE: [u8; 3] = [240, 170, 80];
/// Width of its line, pixels.
const LINE: f32 = 2.0;

/// A film that is written while strokes are played, with the size, rate and quality of the project's recordings. The brush is a circle.
pub struct StrokeFilm {
    renderer: Renderer,
    writer: FilmWriter,
    size: [u32; 2],
    fps: f64,
    /// Steps that were seen, and frames that were written.
    steps: u64,
    frames: u64,
    picture: Picture,
}

impl StrokeFilm {
    /// Starts a film under a temporary name.
    ///
    /// # Errors
    /// A name that does not end in `.mp4`, a size or rate out of range, no adapter for the project's backend, or a file that cannot be created.
    pub fn create(out: &Path, project: &Project) -> Result<Self, ProjectError> {
        let refused = |error: RecordError| refused(out, &error);
        if OutputKind::of(out).map_err(refused)? != OutputKind::Film {
            let message = format!("{}: strokes are recorded as a film (.mp4)", out.display());
            return Err(ProjectError::Request { file: Some(out.to_owned()), message });
        }
        let recording = &project.recording;
        let (width, height, fps) = (recording.width, recording.height, recording.fps);
        lovelock_render::check_size(width, height)?;
        let settings = FilmSettings { width, height, fps, quality: recording.quality };
        settings.check().map_err(refused)?;
        let renderer = open_renderer(project.picture.backend, None)?;
        let writer = FilmWriter::create(out, settings).map_err(refused)?.leaving_nothing();
        Ok(Self {
            renderer,
            writer,
            size: [width, height],
            fps,
            steps: 0,
            frames: 0,
            picture: Picture::default(),
        })
    }

    /// Sees the hair after another step, and writes the frames that are due.
    ///
    /// # Errors
    /// The device is lost, or the disk is full.
    pub fn see(
        &mut self,
        engine: &mut Engine,
        project: &Project,
        brush: Option<PlayedBrush>,
    ) -> Result<(), ProjectError> {
        self.steps += 1;
        let secs = self.steps as f64 * engine.step_secs();
        if secs * self.fps < self.frames as f64 + 1.0 - 1e-6 {
            return Ok(());
        }
        let snapshot = engine.snapshot();
        let project = project.seen_at(snapshot.position_secs);
        let camera = snapshot.camera(&project.camera);
        let [width, height] = self.size;
        self.renderer.picture(&snapshot.frame_input(&project, &camera), width, height, &mut self.picture)?;
        if let Some(brush) = brush {
            draw_circle(&mut self.picture, &camera, brush);
        }
        while secs * self.fps >= self.frames as f64 + 1.0 - 1e-6 {
            self.writer.push(&self.picture.rgba).map_err(|error| refused(Path::new(""), &error))?;
            self.frames += 1;
        }
        Ok(())
    }

    /// Completes the film.
    ///
    /// # Errors
    /// If the disk is full.
    pub fn finish(self) -> Result<FilmReport, ProjectError> {
        self.writer.finish().map_err(|error| refused(Path::new(""), &error))
    }
}

fn refused(out: &Path, error: &RecordError) -> ProjectError {
    let file = error.path().or((!out.as_os_str().is_empty()).then_some(out)).map(Path::to_owned);
    let message = error.to_string();
    if error.is_request() {
        ProjectError::Request { file, message }
    } else {
        ProjectError::Work { file, message }
    }
}

/// Draws the circle of the brush, which faces the camera.
fn draw_circle(picture: &mut Picture, camera: &Camera, brush: PlayedBrush) {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let Some(centre) = pixel_of(camera, brush.position, [picture.width, picture.height]) else { return };
    let scale = camera.pixels_per_metre_at_one_metre(picture.height);
    let radius = brush.radius * scale / camera.eye.distance(brush.position).max(1e-3);
    let reach = radius + LINE;
    let range = |c: f32, end: usize| {
        ((c - reach).max(0.0) as usize)..((c + reach + 1.0).clamp(0.0, end as f32) as usize)
    };
    for y in range(centre.y, height) {
        for x in range(centre.x, width) {
            let off = (Vec2::new(x as f32 + 0.5, y as f32 + 0.5).distance(centre) - radius).abs();
            let part = (1.0 + 0.5 * LINE - off).clamp(0.0, 1.0);
            if part > 0.0 {
                let pixel = &mut picture.rgba[(y * width + x) * 4..][..3];
                for (now, wanted) in pixel.iter_mut().zip(CIRCLE) {
                    *now = (f32::from(*now) + (f32::from(wanted) - f32::from(*now)) * part).round() as u8;
                }
            }
        }
    }
}

/// Where a point of the world is in an image, pixels from the upper left corner; `None` behind the camera.
fn pixel_of(camera: &Camera, at: Vec3, [width, height]: [u32; 2]) -> Option<Vec2> {
    let clip = camera.clip_from_world(width as f32 / height as f32) * at.extend(1.0);
    let size = Vec2::new(width as f32, height as f32);
    (clip.w > 0.0).then(|| (Vec2::new(clip.x, -clip.y) / clip.w * 0.5 + 0.5) * size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_circle_lies_around_the_brush() {
        let camera =
            Camera { eye: Vec3::new(0.0, 1.0, 2.0), target: Vec3::Y, fov_y: 0.5, shear: glam::Vec2::ZERO };
        let mut picture = Picture { width: 200, height: 100, rgba: vec![0; 200 * 100 * 4] };
        draw_circle(&mut picture, &camera, PlayedBrush { position: Vec3::Y, radius: 0.1 });
        // A tenth of a metre at two metres: 0.05 of the 195.8 pixels per metre at one metre.
        let radius = 0.05 * 50.0 / 0.25_f32.tan();
        let lit = |x: f32, y: f32| picture.rgba[(y as usize * 200 + x as usize) * 4] > 200;
        for (x, y) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            assert!(lit(100.0 + x * radius - 0.5, 50.0 + y * radius - 0.5), "{x}, {y}");
        }
        assert!(!lit(100.0, 50.0) && !lit(100.0 + radius + 4.0, 50.0));
        // Behind the camera, at it and with a radius of 0 or without bound, nothing fails.
        for (position, radius) in [(Vec3::Z * 9.0, 0.1), (camera.eye, 0.1), (Vec3::Y, 0.0), (Vec3::Y, 1e30)] {
            draw_circle(&mut picture, &camera, PlayedBrush { position, radius });
        }
    }
}
