//! Light rigs: the lights of a portrait studio, to choose from.

use std::fmt;
use std::str::FromStr;

use glam::Vec3;
use lovelock_base::settings::Choices;
use serde::{Deserialize, Serialize};

use crate::{BackgroundForm, Light, PictureSettings};

/// A choice of lights, with the ambient light, the exposure and the background that suit them.
///
/// The lights stand around a figure that faces +Z, at all distances alike, so a figure may dance through them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LightRig {
    /// Large soft sources before and above the face.
    SoftBeauty,
    /// A key light, a fill light and a back light.
    ThreePoint,
    /// Two lights from behind in a dark room.
    RimAtNight,
    /// Even light that hides nothing, for judging shape and colour.
    Flat,
}

/// A light of a rig.
struct Lamp {
    name: &'static str,
    /// Where the light comes from: angle about the vertical from the front toward the figure's left, and above the horizon, degrees.
    from: [f32; 2],
    color: [f32; 3],
    intensity: f32,
    specular: f32,
    /// Metres, see [`Light::softness`].
    softness: f32,
}

/// What a rig sets.
struct Rig {
    lamps: &'static [Lamp],
    ambient: f32,
    exposure_stops: f32,
    background: BackgroundForm,
    top: [f32; 3],
    bottom: [f32; 3],
}

const WHITE: [f32; 3] = [1.0; 3];

/// A light with its intensity, its specular part and its softness.
const fn lamp(
    name: &'static str,
    from: [f32; 2],
    color: [f32; 3],
    [intensity, specular, softness]: [f32; 3],
) -> Lamp {
    Lamp { name, from, color, intensity, specular, softness }
}

const SOFT_BEAUTY: Rig = Rig {
    lamps: &[
        lamp("Beauty dish", [8.0, 38.0], [1.0, 0.965, 0.92], [2.5, 0.55, 0.1]),
        lamp("Reflector", [-12.0, -22.0], [1.0, 0.97, 0.94], [0.35, 0.1, 0.1]),
        lamp("Hair light", [-155.0, 52.0], [1.0, 0.98, 0.95], [2.0, 0.8, 0.02]),
        lamp("Side", [82.0, 18.0], [0.94, 0.97, 1.0], [0.8, 0.35, 0.1]),
    ],
    ambient: 1.0,
    exposure_stops: 0.3,
    background: BackgroundForm::Radial,
    top: [0.23, 0.22, 0.215],
    bottom: [0.52, 0.5, 0.48],
};

const THREE_POINT: Rig = Rig {
    lamps: &[
        lamp("Key", [42.0, 34.0], [1.0, 0.94, 0.85], [3.4, 0.9, 0.02]),
        lamp("Fill", [-48.0, 12.0], [0.8, 0.88, 1.0], [0.9, 0.2, 0.06]),
        lamp("Back", [-148.0, 40.0], [0.92, 0.96, 1.0], [3.2, 0.85, 0.015]),
    ],
    ambient: 0.45,
    exposure_stops: 0.0,
    background: BackgroundForm::Studio,
    top: [0.1, 0.108, 0.122],
    bottom: [0.19, 0.2, 0.218],
};

const RIM_AT_NIGHT: Rig = Rig {
    lamps: &[
        lamp("Moon", [142.0, 28.0], [0.6, 0.78, 1.0], [5.5, 1.0, 0.01]),
        lamp("Street lamp", [-138.0, 22.0], [1.0, 0.72, 0.42], [4.5, 1.0, 0.01]),
        lamp("Glow", [24.0, 16.0], [0.62, 0.72, 1.0], [0.55, 0.3, 0.06]),
    ],
    ambient: 0.05,
    exposure_stops: 0.0,
    background: BackgroundForm::Radial,
    top: [0.003, 0.004, 0.007],
    bottom: [0.012, 0.016, 0.028],
};

const FLAT: Rig = Rig {
    lamps: &[
        lamp("Front", [0.0, 24.0], WHITE, [1.2, 0.3, 0.1]),
        lamp("Left", [72.0, 14.0], WHITE, [0.8, 0.2, 0.1]),
        lamp("Right", [-72.0, 14.0], WHITE, [0.8, 0.2, 0.1]),
        lamp("Behind", [180.0, 30.0], WHITE, [0.8, 0.2, 0.1]),
    ],
    ambient: 1.4,
    exposure_stops: 0.0,
    background: BackgroundForm::Plain,
    top: [0.18, 0.18, 0.18],
    bottom: [0.18, 0.18, 0.18],
};

impl LightRig {
    /// All rigs, in the order of the panel.
    pub const ALL: [Self; 4] = [Self::SoftBeauty, Self::ThreePoint, Self::RimAtNight, Self::Flat];

    fn rig(self) -> &'static Rig {
        match self {
            Self::SoftBeauty => &SOFT_BEAUTY,
            Self::ThreePoint => &THREE_POINT,
            Self::RimAtNight => &RIM_AT_NIGHT,
            Self::Flat => &FLAT,
        }
    }

    /// The stable name of the command line.
    pub fn id(self) -> &'static str {
        self.names().0
    }

    /// The name in menus.
    pub fn label(self) -> &'static str {
        self.names().1
    }

    /// One sentence: how a picture looks in its light.
    pub fn description(self) -> &'static str {
        match self {
            Self::SoftBeauty => "Large soft sources before and above the face: smooth skin, bright hair.",
            Self::ThreePoint => "A warm key light, a cool fill light, and a back light that edges the hair.",
            Self::RimAtNight => "Two lights from behind in a dark room: bright edges, dark face.",
            Self::Flat => "Even white light from all sides, to judge shape and colour.",
        }
    }

    /// The lights, at most [`crate::MAX_LIGHTS`].
    pub fn lights(self) -> Vec<Light> {
        let light = |lamp: &Lamp| {
            let [azimuth, elevation] = lamp.from.map(f32::to_radians);
            let from =
                Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
            Light {
                name: lamp.name.to_owned(),
                direction: -from,
                color: Vec3::from_array(lamp.color),
                intensity: lamp.intensity,
                specular: lamp.specular,
                softness: lamp.softness,
                ..Light::default()
            }
        };
        self.rig().lamps.iter().map(light).collect()
    }

    /// Replaces the lights, the ambient light, the exposure, and the background unless that is a picture.
    pub fn apply(self, lights: &mut Vec<Light>, picture: &mut PictureSettings) {
        *lights = self.lights();
        let rig = self.rig();
        picture.ambient = rig.ambient;
        picture.exposure_stops = rig.exposure_stops;
        picture.background_top = Vec3::from_array(rig.top);
        picture.background_bottom = Vec3::from_array(rig.bottom);
        if picture.background != BackgroundForm::Picture {
            picture.background = rig.background;
        }
    }

    /// The rig whose lights these are, unchanged.
    pub fn of(lights: &[Light], picture: &PictureSettings) -> Option<Self> {
        Self::ALL.into_iter().find(|rig| rig.rig().ambient == picture.ambient && rig.lights() == lights)
    }
}

impl Choices for LightRig {
    const ALL: &'static [Self] = &Self::ALL;

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::SoftBeauty => ("soft-beauty", "Soft beauty"),
            Self::ThreePoint => ("three-point", "Three-point"),
            Self::RimAtNight => ("rim-at-night", "Rim at night"),
            Self::Flat => ("flat", "Flat"),
        }
    }
}

impl fmt::Display for LightRig {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.id())
    }
}

impl FromStr for LightRig {
    type Err = String;

    fn from_str(id: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|rig| rig.id() == id).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|rig| rig.id()).collect();
            format!("unknown light rig `{id}`: must be one of {}", known.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use lovelock_base::settings::Settings;

    use super::*;
    use crate::MAX_LIGHTS;

    #[test]
    fn rigs_keep_to_the_ranges_of_lights_and_are_told_apart() {
        for rig in LightRig::ALL {
            let (mut lights, mut picture) = (Vec::new(), PictureSettings::default());
            rig.apply(&mut lights, &mut picture);
            assert!((1..=MAX_LIGHTS).contains(&lights.len()), "{rig}");
            assert!(lights.iter().all(|light| light.clamped() == *light), "{rig}");
            assert_eq!(picture.clamped(), picture, "{rig}");
            assert_eq!(LightRig::of(&lights, &picture), Some(rig));
            assert_eq!(rig.id().parse(), Ok(rig));
            lights[0].intensity += 0.1;
            assert_eq!(LightRig::of(&lights, &picture), None, "the control: a changed light");
        }
        assert_eq!(LightRig::of(&Light::default_rig(), &PictureSettings::default()), None);
        assert!("noon".parse::<LightRig>().unwrap_err().contains("rim-at-night"));
    }

    #[test]
    fn a_picture_behind_the_figure_stays_when_the_light_changes() {
        let mut picture = PictureSettings { background: BackgroundForm::Picture, ..Default::default() };
        LightRig::Flat.apply(&mut Vec::new(), &mut picture);
        assert_eq!(picture.background, BackgroundForm::Picture);
    }

    #[test]
    fn the_night_comes_from_behind_and_the_key_from_the_front() {
        let brightest = |rig: LightRig| {
            let lights = rig.lights();
            lights.into_iter().max_by(|a, b| a.intensity.total_cmp(&b.intensity)).expect("a light").direction
        };
        assert!(brightest(LightRig::RimAtNight).z > 0.3);
        assert!(brightest(LightRig::SoftBeauty).z < -0.3 && brightest(LightRig::ThreePoint).z < -0.3);
    }
}
