//! Hair that is drawn as clusters: which clusters, and how much of the image they are beside strands.

use std::sync::Arc;

use glam::{Vec3, Vec3A};
use lovelock_groom::{GuideFrame, Hairstyle};
use lovelock_satf::{ClusterHair, ClusterSettings, nominal_width};

use crate::{FrameInput, HairDrawing, HairPose, Light, MAX_LIGHTS, PictureSettings, StrandCount};

/// The height of a head, metres: what sizes on the screen are measured by.
const HEAD: f32 = 0.25;
/// Strands and clusters are mixed from the size at which hair is drawn as clusters up to this multiple of it.
const MIXED: f32 = 1.5;

/// The part of the hair's optical depth that clusters have, 0 to 1, in an image `height` pixels high. The rest is that of strands.
pub(crate) fn cluster_share(input: &FrameInput, height: u32) -> f32 {
    // Clusters follow guides; transmittance can be given for strands only.
    if guides_of(input).is_none() || input.known.is_some() {
        return 0.0;
    }
    match input.picture.draw {
        HairDrawing::Strands => 0.0,
        HairDrawing::Clusters => 1.0,
        HairDrawing::Auto => {
            let head = input.world_from_head.transform_point3a(Vec3A::Y * (0.4 * HEAD));
            let distance = Vec3A::from(input.camera.eye).distance(head).max(0.1);
            let pixels = HEAD * input.camera.pixels_per_metre_at_one_metre(height) / distance;
            let near = pixels / input.picture.cluster_size.max(1.0);
            // NaN gives strands.
            if near < MIXED { 1.0 - ((near - 1.0) / (MIXED - 1.0)).clamp(0.0, 1.0) } else { 0.0 }
        }
    }
}

/// The guides that clusters follow.
pub(crate) fn guides_of<'a>(input: &FrameInput<'a>) -> Option<&'a GuideFrame> {
    input.hair.guides().or(input.guides)
}

/// The pose of hair that follows the guides of `input`, if it has any.
pub(crate) fn pose_by_guides<'a>(input: &FrameInput<'a>) -> HairPose<'a> {
    match (input.hair, input.guides) {
        (HairPose::Strands(_), Some(guides)) => HairPose::Guides(guides),
        (pose, _) => pose,
    }
}

/// The directions toward the lights that are on, at the head.
pub(crate) fn to_lights(input: &FrameInput) -> Vec<Vec3> {
    let head = Vec3::from(input.world_from_head.translation);
    Light::enabled(input.lights).take(MAX_LIGHTS).map(|light| -light.way_to(head)).collect()
}

/// The picture's settings where only clusters are drawn: strands, which cast shadows only, are as they are stored.
pub(crate) fn without_strands(picture: &PictureSettings) -> PictureSettings {
    PictureSettings { strands: StrandCount::Stored, ..*picture }
}

/// `input` where only the clusters of `hair` are drawn: its casters in place of the hairstyle.
pub(crate) fn of_casters<'a>(
    input: &FrameInput<'a>,
    hair: &'a ClusterHair,
    picture: &'a PictureSettings,
) -> FrameInput<'a> {
    FrameInput { style: &hair.casters, hair: pose_by_guides(input), picture, ..*input }
}

/// The clusters of the last hairstyle, kept until it or their division changes.
#[derive(Debug, Default)]
pub(crate) struct ClusterStage {
    of: Option<(Arc<Hairstyle>, ClusterSettings, f32)>,
    hair: Option<Arc<ClusterHair>>,
}

impl ClusterStage {
    /// The clusters of the hairstyle of `input`.
    pub fn follow(&mut self, input: &FrameInput) -> Arc<ClusterHair> {
        let settings = input.picture.clusters.of_shape();
        let width = nominal_width(&input.look, input.style.strands.count());
        let same = self.of.as_ref().is_some_and(|(style, of, wide)| {
            Arc::ptr_eq(style, input.style) && *of == settings && *wide == width
        });
        if !same {
            self.hair = None;
            self.of = Some((Arc::clone(input.style), settings, width));
        }
        let hair = self.hair.get_or_insert_with(|| Arc::new(ClusterHair::new(input.style, &settings, width)));
        Arc::clone(hair)
    }
}
