//! The scenes that are rendered beside a path tracer.

use std::fmt;
use std::str::FromStr;

use glam::Vec3;
use lovelock_groom::{HAIR_COLOURS, HairColour, Preset};
use lovelock_project::Project;
use lovelock_project::project::MotionSource;
use lovelock_render::{Light, StrandCount, Transparency};

/// What every id begins with.
const PREFIX: &str = "reference";

/// Irradiance of the light on a surface that faces it. A white diffuse surface then reflects almost 1.
const IRRADIANCE: f32 = 3.0;

/// Strands that are drawn. A strand stands for two hairs: among fewer, wider strands light finds more ways that no strand blocks, and a path
/// tracer shows hair of 12,000 strands up to a fifth brighter.
const STRANDS: f32 = 60_000.0;

/// A hairstyle of one colour in one light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReferenceScene {
    /// The hairstyle.
    pub hair: Preset,
    /// Its colour.
    pub color: ReferenceColor,
    /// Where the light comes from.
    pub light: ReferenceLight,
}

/// A natural colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceColor {
    /// Almost all light that enters a fibre is absorbed.
    Black,
    /// Between black and brown.
    DarkBrown,
    /// The default colour.
    Brown,
    /// Mostly pheomelanin.
    Red,
    /// Light passes dozens of fibres.
    Blonde,
    /// Hardly any absorption, the hardest case for approximations of multiple scattering.
    Platinum,
    /// Dark strands among white ones.
    Grey,
}

impl ReferenceColor {
    /// All of them, from dark to light, and grey.
    pub const ALL: [Self; 7] =
        [Self::Black, Self::DarkBrown, Self::Brown, Self::Red, Self::Blonde, Self::Platinum, Self::Grey];

    /// The stable name.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Black => "black",
            Self::DarkBrown => "dark-brown",
            Self::Brown => "brown",
            Self::Red => "red",
            Self::Blonde => "blonde",
            Self::Platinum => "platinum",
            Self::Grey => "grey",
        }
    }

    /// The natural colour of that name.
    fn colour(self) -> &'static HairColour {
        let name = self.id().replace('-', " ");
        let found = HAIR_COLOURS.iter().find(|colour| colour.name.eq_ignore_ascii_case(&name));
        found.unwrap_or(&HAIR_COLOURS[0])
    }
}

/// Where the light comes from, seen from the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceLight {
    /// From behind the camera and above.
    Front,
    /// From behind the hair and above, which shows light that passes fibres.
    Back,
    /// From the right.
    Side,
}

impl ReferenceLight {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Front, Self::Back, Self::Side];

    /// The stable name.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::Back => "back",
            Self::Side => "side",
        }
    }

    /// Direction toward the light along the camera's axes: right, up, and from the hair to the camera. Not of length 1.
    pub const fn toward(self) -> Vec3 {
        match self {
            Self::Front => Vec3::new(-0.3, 0.5, 1.0),
            Self::Back => Vec3::new(0.3, 0.5, -1.0),
            Self::Side => Vec3::new(1.0, 0.35, 0.15),
        }
    }
}

impl ReferenceScene {
    /// The hairstyles: a straight and a curly one.
    pub const HAIR: [Preset; 2] = [Preset::Smooth, Preset::Curly];

    /// Every hairstyle in every colour and light, by hairstyle, then colour.
    pub fn all() -> Vec<Self> {
        let lights = |hair, color| ReferenceLight::ALL.map(move |light| Self { hair, color, light });
        let colors = |hair| ReferenceColor::ALL.into_iter().flat_map(move |color| lights(hair, color));
        Self::HAIR.into_iter().flat_map(colors).collect()
    }

    /// The scenes of `id`: `reference` names all, `reference-curly` those of a hairstyle, and `reference-curly-red-side` one.
    ///
    /// # Errors
    /// No scene has such an id.
    pub fn named(id: &str) -> Result<Vec<Self>, String> {
        let begins = |scene: &Self| {
            scene.to_string().strip_prefix(id).is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
        };
        let found: Vec<_> = Self::all().into_iter().filter(begins).collect();
        if !found.is_empty() {
            return Ok(found);
        }
        let join = |ids: &[&str]| ids.join(", ");
        Err(format!(
            "unknown scene `{id}`: must be {PREFIX}, or {PREFIX}-HAIR-COLOUR-LIGHT with one of {}; {}; {}",
            join(&Self::HAIR.map(Preset::id)),
            join(&ReferenceColor::ALL.map(ReferenceColor::id)),
            join(&ReferenceLight::ALL.map(ReferenceLight::id)),
        ))
    }

    /// The scene's name in files: its id without the common beginning.
    pub fn name(self) -> String {
        format!("{}-{}-{}", self.hair.id(), self.color.id(), self.light.id())
    }

    /// The project of the scene, except for its light, which depends on the camera.
    ///
    /// Both renderers draw the same fibres: as wide as the hairs that they stand for, opaque, and all of one colour, or white among grey hair. There is
    /// no body in the picture, no other light and no background.
    pub fn project(self) -> Project {
        let mut project = Project::default();
        project.set_preset(self.hair);
        project.motion.source = MotionSource::Rest;
        self.color.colour().apply(&mut project.look);
        (project.look.variation, project.look.tip_lightening, project.look.highlights) = (0.0, 0.0, 0.0);
        project.look.width_scale = 1.0;
        project.lights =
            vec![Light { intensity: IRRADIANCE, specular: 1.0, softness: 0.0, ..Light::default() }];
        let picture = &mut project.picture;
        (picture.ambient, picture.exposure_stops, picture.strand_opacity) = (0.0, 0.0, 1.0);
        picture.ground = false;
        (picture.strands, picture.strand_number) = (StrandCount::Fixed, STRANDS);
        picture.transparency = Transparency::Exact;
        project
    }
}

impl fmt::Display for ReferenceScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&format!("{PREFIX}-{}", self.name()))
    }
}

impl FromStr for ReferenceScene {
    type Err = String;

    fn from_str(id: &str) -> Result<Self, String> {
        match Self::named(id)?.as_slice() {
            [scene] => Ok(*scene),
            more => Err(format!("`{id}` names {} scenes: must be one", more.len())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_names_all_some_or_one() {
        assert_eq!(ReferenceScene::named("reference").map(|scenes| scenes.len()), Ok(42));
        assert_eq!(ReferenceScene::named("reference-curly").map(|scenes| scenes.len()), Ok(21));
        assert_eq!(ReferenceScene::named("reference-smooth-brown").map(|scenes| scenes.len()), Ok(3));
        for scene in ReferenceScene::all() {
            assert_eq!(scene.to_string().parse(), Ok(scene));
        }
        for wrong in ["reference-cur", "reference-", "reference-curly-green", "curly"] {
            let error = ReferenceScene::named(wrong).unwrap_err();
            assert!(error.contains(wrong) && error.contains("dark-brown"), "{error}");
        }
        assert!("reference-curly".parse::<ReferenceScene>().unwrap_err().contains("21 scenes"));
    }

    #[test]
    fn fibres_are_of_one_colour_and_as_wide_as_the_hairs_that_they_stand_for() {
        let scene: ReferenceScene = "reference-curly-red-side".parse().expect("a scene");
        let look = scene.project().look;
        assert_eq!([look.eumelanin, look.pheomelanin, look.grey], [0.3, 0.8, 0.0]);
        assert_eq!([look.variation, look.tip_lightening, look.width_scale], [0.0, 0.0, 1.0]);
    }

    #[test]
    fn colours_are_the_natural_ones_of_their_names() {
        for color in ReferenceColor::ALL {
            let name = color.colour().name.to_lowercase().replace(' ', "-");
            assert_eq!(name, color.id());
        }
    }
}
