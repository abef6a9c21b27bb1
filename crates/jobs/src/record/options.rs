//! Settings of a recording, from the request and the project.

use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_record::{FilmQuality, SequenceFormat};

use super::request::RecordRequest;

/// The settings of a recording that its images depend on, besides the project and the size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Options {
    /// Format of the files in a folder.
    pub format: SequenceFormat,
    pub transparent: bool,
    /// Samples per frame, 1 or more.
    pub subframes: u32,
    /// Places of the aperture per frame, 1 or more; at least one for each of `subframes`.
    pub lens_samples: u32,
    /// Shutter angle, 0 to 360 degrees per frame.
    pub shutter_degrees: f32,
    pub label: bool,
    pub quality: FilmQuality,
}

impl Options {
    /// The settings of the request, or otherwise of the project.
    ///
    /// # Errors
    /// If a number is out of range, or a film of panes does not support a setting.
    pub fn new(project: &Project, request: &RecordRequest) -> Result<Self, ProjectError> {
        let of = &project.recording;
        let options = Self {
            format: request.format.unwrap_or(of.format),
            transparent: request.transparent || of.transparent,
            subframes: request.motion_blur.unwrap_or(of.subframes),
            lens_samples: if project.camera.lens.enabled { project.camera.lens.samples.max(1) } else { 1 },
            shutter_degrees: request.shutter_degrees.unwrap_or(of.shutter_degrees),
            label: request.label || of.label,
            quality: request.quality.unwrap_or(of.quality),
        };
        let most = lovelock_project::project::RecordingSection::MAX_SUBFRAMES;
        if !(1..=most).contains(&options.subframes) {
            let asked = options.subframes;
            return Err(ProjectError::option(format!(
                "motion blur of {asked} samples per frame: must be 1 (none) to {most}"
            )));
        }
        if !(0.0..=360.0).contains(&options.shutter_degrees) {
            let asked = options.shutter_degrees;
            return Err(ProjectError::option(format!("a shutter of {asked} degrees: must be 0 to 360")));
        }
        Ok(options)
    }

    /// The sample times of frame `frame`, seconds, ascending: evenly spaced over the open shutter, which is centred on the frame, and
    /// not before the start.
    pub fn instants(&self, frame: u64, fps: f64) -> Vec<f64> {
        let open_secs = f64::from(self.shutter_degrees) / 360.0 / fps;
        let count = f64::from(self.subframes);
        let middle = frame as f64 / fps;
        (0..self.subframes)
            .map(|i| (middle + ((f64::from(i) + 0.5) / count - 0.5) * open_secs).max(0.0))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(subframes: u32, shutter_degrees: f32) -> Options {
        let request = RecordRequest {
            motion_blur: Some(subframes),
            shutter_degrees: Some(shutter_degrees),
            ..RecordRequest::default()
        };
        Options::new(&Project::default(), &request).expect("in range")
    }

    #[test]
    fn a_shutter_opens_round_the_frame_and_frames_do_not_overlap() {
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(near(&options(4, 180.0).instants(10, 25.0), &[0.3925, 0.3975, 0.4025, 0.4075]));
        assert_eq!(options(1, 180.0).instants(10, 25.0), [0.4], "one sample is the frame itself");
        assert_eq!(options(4, 0.0).instants(10, 25.0), [0.4; 4], "a closed shutter does not blur");
        let all: Vec<f64> = (0..5).flat_map(|frame| options(8, 360.0).instants(frame, 30.0)).collect();
        assert!(all.windows(2).all(|w| w[0] <= w[1]) && all[0] == 0.0, "{all:?}");
        assert!(all.windows(2).skip(4).all(|w| (w[1] - w[0] - 1.0 / 240.0).abs() < 1e-12), "evenly");
    }
}
