//! The lens of the camera: depth of field.

use lovelock_base::field;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};
use serde::{Deserialize, Serialize};

/// What the lens is focused on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FocusOn {
    /// The eye that is nearer to the camera; the front of the head of a figure without eyes.
    #[default]
    Eyes,
    /// What the camera looks at.
    Target,
    /// A distance from the camera.
    Distance,
}

impl Choices for FocusOn {
    const ALL: &'static [Self] = &[Self::Eyes, Self::Target, Self::Distance];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Eyes => ("eyes", "Eyes"),
            Self::Target => ("target", "Camera target"),
            Self::Distance => ("distance", "Distance"),
        }
    }
}

/// The lens of the camera. A frame is 24 mm high, as that of a small-format camera, which relates the field of view to a focal length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LensSettings {
    /// Whether what is out of focus is blurred.
    pub enabled: bool,
    /// Focal length divided by the diameter of the aperture.
    pub f_number: f32,
    /// What it is focused on.
    pub focus: FocusOn,
    /// Distance of the plane in focus along the camera's axis, metres, where that is the choice.
    pub distance: f32,
    /// Places of the aperture that are averaged in films and stills.
    pub samples: u32,
}

impl Default for LensSettings {
    fn default() -> Self {
        Self { enabled: false, f_number: 2.0, focus: FocusOn::default(), distance: 2.0, samples: 48 }
    }
}

impl LensSettings {
    /// Height of a frame, metres.
    pub const FRAME_METRES: f32 = 0.024;

    /// The radius of the aperture of a camera with the vertical field of view `fov_y`, metres.
    pub fn radius(&self, fov_y: f32) -> f32 {
        let focal_length = 0.5 * Self::FRAME_METRES / (0.5 * fov_y.clamp(0.01, 3.0)).tan();
        0.5 * focal_length / self.f_number.max(0.05)
    }
}

impl Settings for LensSettings {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::switch(
            field!(Self, enabled),
            "Depth of field",
            "Blurs what is nearer or farther than the focus. Films and images have all of it; in the window it appears when nothing moves.",
        ),
        Setting::number(
            field!(Self, f_number),
            [0.1, 64.0],
            "Aperture",
            "F-number of the lens: a low number blurs more.",
        )
        .logarithmic()
        .soft([0.7, 16.0]),
        Setting::choice::<FocusOn>(
            field!(Self, focus),
            "Focus",
            "What is sharp: the nearer eye, the camera's target, or a distance.",
        ),
        Setting::number(
            field!(Self, distance),
            [0.05, 100.0],
            "Focus distance",
            "Distance from the camera that is sharp.",
        )
        .unit(Unit::METRES)
        .logarithmic()
        .soft([0.2, 10.0]),
        Setting::count(
            field!(Self, samples),
            [4, 512],
            "Lens samples",
            "Images that are averaged for one of a film. More are smoother and take longer.",
        ),
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_aperture_is_the_focal_length_over_its_number() {
        let fov_y = 2.0 * (12.0_f32 / 85.0).atan();
        let lens = LensSettings { f_number: 2.0, ..LensSettings::default() };
        assert!((lens.radius(fov_y) - 0.5 * 0.085 / 2.0).abs() < 1e-6, "{}", lens.radius(fov_y));
        let open = LensSettings { f_number: 1.4, ..lens };
        assert!(open.radius(fov_y) > lens.radius(fov_y));
    }
}
