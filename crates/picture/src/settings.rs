//! Settings of an image as a whole.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::settings::{Part, PartMut, Setting, Settings, Unit};
use lovelock_satf::ClusterSettings;
use serde::{Deserialize, Serialize};

use crate::{Backend, BackgroundForm, BodyLook, HairDrawing, MapView, PictureFit, StrandCount, Transparency};

/// Settings of the picture as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PictureSettings {
    /// Exposure in stops relative to the default.
    pub exposure_stops: f32,
    /// Brightness of the light from all directions.
    pub ambient: f32,
    /// The angle about the vertical by which a picture of the surroundings is turned, radians.
    pub surroundings_turn: f32,
    /// What is behind the figure.
    pub background: BackgroundForm,
    /// Background at the upper edge, linear sRGB.
    pub background_top: Vec3,
    /// Background at the horizon, linear sRGB.
    pub background_bottom: Vec3,
    /// How a picture behind the figure is laid into the image.
    pub background_fit: PictureFit,
    /// Brightness of a picture behind the figure, stops.
    pub background_stops: f32,
    /// Blur of a picture behind the figure: standard deviation as a fraction of the height of the image.
    pub background_blur: f32,
    /// Whether the ground is drawn, with the shadows on it.
    pub ground: bool,
    /// What hair is drawn as.
    pub draw: HairDrawing,
    /// The height of a head in the image, pixels, below which clusters are drawn where strands and clusters are mixed by size.
    pub cluster_size: f32,
    /// Settings of hair that is drawn as clusters.
    pub clusters: ClusterSettings,
    /// How overlapping strands are put together.
    pub transparency: Transparency,
    /// Opacity of a strand where it covers a pixel completely.
    pub strand_opacity: f32,
    /// How the number of strands is chosen.
    pub strands: StrandCount,
    /// The number of strands that is drawn by their size, as a multiple of what suits the backend.
    pub strand_detail: f32,
    /// The number of strands if it is fixed.
    pub strand_number: f32,
    /// What draws.
    pub backend: Backend,
    /// What simulates the hair.
    pub simulate: Backend,
    /// The shadow map over the image.
    pub map_view: MapView,
    /// The surface of the body.
    pub body_look: BodyLook,
}

impl Default for PictureSettings {
    fn default() -> Self {
        Self {
            exposure_stops: 0.0,
            ambient: 0.6,
            surroundings_turn: 0.0,
            background: BackgroundForm::default(),
            background_top: Vec3::new(0.135, 0.145, 0.163),
            background_bottom: Vec3::new(0.25, 0.262, 0.282),
            background_fit: PictureFit::default(),
            background_stops: 0.0,
            background_blur: 0.0,
            ground: true,
            draw: HairDrawing::default(),
            cluster_size: 60.0,
            clusters: ClusterSettings::default(),
            transparency: Transparency::default(),
            strand_opacity: 0.85,
            strands: StrandCount::default(),
            strand_detail: 1.0,
            strand_number: 25_000.0,
            backend: Backend::default(),
            // Results on a card differ in their last bits, and no step has been timed on one.
            simulate: Backend::Cpu,
            map_view: MapView::default(),
            body_look: BodyLook::default(),
        }
    }
}

impl Settings for PictureSettings {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, exposure_stops),
            [-6.0, 6.0],
            "Exposure",
            "Brightness of the whole image. One stop doubles the light.",
        )
        .unit(Unit::STOPS),
        Setting::number(
            field!(Self, ambient),
            [0.0, 4.0],
            "Ambient light",
            "Brightness of the light from all directions, which also reaches the inside of the \
             hair.",
        ),
        Setting::number(
            field!(Self, surroundings_turn),
            [-std::f64::consts::PI, std::f64::consts::PI],
            "Turn surroundings",
            "Turns the picture of the surroundings around the figure.",
        )
        .unit(Unit::RADIANS),
        Setting::choice::<HairDrawing>(
            field!(Self, draw),
            "Draw hair as",
            "How hair is drawn: as strands, as locks from a database of rendered sectors, or as strands where it is large in the image and locks where it is small.",
        ),
        Setting::number(
            field!(Self, cluster_size),
            [4.0, 4000.0],
            "Clusters below",
            "Height of a head in the image below which locks are drawn instead of strands.",
        )
        .unit(Unit::PIXELS)
        .logarithmic(),
        Setting::choice::<Transparency>(
            field!(Self, transparency),
            "Transparency",
            "How strands that overlap in a pixel are blended: each hiding what is behind it, averaged, weighted by an \
             estimated order, blended segment by segment, or sorted exactly.",
        ),
        Setting::choice::<Backend>(
            field!(Self, backend),
            "Backend",
            "What renders the image: the graphics card or the CPU alone. Automatic uses the graphics \
             card where there is a real one.",
        ),
        Setting::choice::<Backend>(
            field!(Self, simulate),
            "Hair simulation",
            "What simulates the hair: the CPU or the graphics card, whose results differ in their last bits. \
             Automatic uses the graphics card where there is a real one and the hair has at least 2,000 guides.",
        ),
        Setting::number(field!(Self, strand_opacity), [0.05, 1.0], "Strand opacity", "Opacity of a strand.")
            .unit(Unit::FRACTION),
        Setting::choice::<StrandCount>(
            field!(Self, strands),
            "Strands",
            "How many strands are drawn: a number that suits their size on the screen, a fixed number, or those that the hairstyle stores. Shadows are always cast by the stored strands.",
        ),
        Setting::number(
            field!(Self, strand_detail),
            [0.1, 10.0],
            "Strand detail",
            "Number of strands when it follows their size on the screen: twice the detail draws twice \
             as many, half as wide.",
        )
        .logarithmic()
        .soft([0.25, 4.0]),
        Setting::number(
            field!(Self, strand_number),
            [100.0, 120_000.0],
            "Strand number",
            "Number of strands when it is fixed.",
        )
        .unit(Unit::THOUSANDS)
        .logarithmic(),
        Setting::switch(field!(Self, ground), "Ground", "Shows the ground with the dancer's shadow."),
        Setting::choice::<BackgroundForm>(
            field!(Self, background),
            "Background",
            "What is behind the figure: a studio's wall with a pool of light, one colour, two colours from top to bottom or from \
             the corners to the middle, or a picture.",
        ),
        Setting::color(
            field!(Self, background_top),
            "Top colour",
            "Colour of the background at the top, in the corners of a radial gradient, and beside a picture.",
        ),
        Setting::color(
            field!(Self, background_bottom),
            "Bottom colour",
            "Colour of the background at the bottom, and in the middle of a radial gradient.",
        ),
        Setting::choice::<PictureFit>(
            field!(Self, background_fit),
            "Picture fit",
            "How a background picture of another shape is laid into the image: cut off, with borders, or stretched.",
        ),
        Setting::number(
            field!(Self, background_stops),
            [-6.0, 6.0],
            "Picture brightness",
            "Brightness of the background picture. The exposure of the image changes only pictures of measured light (.hdr, .exr).",
        )
        .unit(Unit::STOPS),
        Setting::number(
            field!(Self, background_blur),
            [0.0, 0.2],
            "Picture blur",
            "Blurs the background picture, by this fraction of the height of the image.",
        )
        .unit(Unit::FRACTION)
        .soft([0.0, 0.05]),
    ];

    fn parts(&self) -> Vec<Part<'_>> {
        vec![
            ("clusters".into(), &self.clusters),
            ("map_view".into(), &self.map_view),
            ("body_look".into(), &self.body_look),
        ]
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        vec![
            ("clusters".into(), &mut self.clusters),
            ("map_view".into(), &mut self.map_view),
            ("body_look".into(), &mut self.body_look),
        ]
    }
}
