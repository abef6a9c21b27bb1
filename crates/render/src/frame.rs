//! The input of one picture, and its statistics.

use std::sync::Arc;

use glam::Affine3A;
use lovelock_appearance::environment::{BackdropPicture, Panorama};
use lovelock_gpu::{PassTime, Traffic};
use lovelock_groom::{GuideFrame, HairLook, Hairstyle, Strands, interpolate};
use lovelock_motion::{Body, Skin};
use lovelock_satf::ClusterHair;

use crate::{Camera, KnownTransmittance, Light, PictureSettings, ResidentGuides, ShadowSettings};

/// Everything that one picture shows, at one time.
#[derive(Clone, Copy)]
pub struct FrameInput<'a> {
    /// The hairstyle.
    pub style: &'a Arc<Hairstyle>,
    /// The positions of its strands.
    pub hair: HairPose<'a>,
    /// The guides of the same instant, if they are known: light from all directions is computed from them, so that it does not depend
    /// on how strands are given.
    pub guides: Option<&'a GuideFrame>,
    /// Colour and width of the hair.
    pub look: HairLook,
    /// The body and its skinned surface. Without it only hair is drawn.
    pub body: Option<(&'a Arc<Body>, &'a Skin)>,
    /// The transform of the head, which is the anchor of the shadow map's lattice.
    pub world_from_head: Affine3A,
    /// The lights; those beyond [`crate::MAX_LIGHTS`] are ignored.
    pub lights: &'a [Light],
    /// Settings of shadows inside hair.
    pub shadow: &'a ShadowSettings,
    /// The camera.
    pub camera: &'a Camera,
    /// Settings of the picture as a whole.
    pub picture: &'a PictureSettings,
    /// Whether a better image follows soon, as while something moves in a window: then the CPU draws half as many strands by their
    /// size, computes scattering at every second point of them, and builds the shadow maps of much hair from fewer strands if the method
    /// adds them up ([`ShadowMethod::sums_strands`](crate::ShadowMethod::sums_strands)).
    pub is_draft: bool,
    /// A picture of the surroundings that gives light from all directions, in place of sky and ground.
    pub surroundings: Option<&'a Arc<Panorama>>,
    /// The picture behind the figure, which [`BackgroundForm::Picture`](crate::BackgroundForm) shows.
    pub backdrop: Option<&'a Arc<BackdropPicture>>,
    /// Transmittance that replaces the result of the shadow method; supported by the CPU backend only.
    pub known: Option<KnownTransmittance<'a>>,
    /// Hair that the skin carries, beside the hairstyle: it is drawn as strands and shadowed by the hairstyle, but casts no shadow itself
    /// and is part of no statistics. Pictures of given transmittance and of clusters alone are without it.
    pub carried: Option<CarriedHair<'a>>,
}

/// Strands beside the hairstyle, with a look of their own, such as brows.
#[derive(Clone, Copy, Debug)]
pub struct CarriedHair<'a> {
    /// Taper, shade and colours of its strands; its guides are not used.
    pub style: &'a Arc<Hairstyle>,
    /// Its strands, world space.
    pub strands: &'a Strands,
    /// Its colour and width. The fibres are shaded as those of the hairstyle.
    pub look: HairLook,
}

impl<'a> FrameInput<'a> {
    /// The input with the carried hair in place of the hairstyle; `None` without any. `picture` are the settings of its strands.
    pub(crate) fn of_carried(&self, picture: &'a PictureSettings) -> Option<Self> {
        let carried = self.carried.filter(|carried| self.known.is_none() && carried.strands.count() > 0)?;
        Some(FrameInput {
            style: carried.style,
            hair: HairPose::Strands(carried.strands),
            guides: None,
            look: HairLook { shading: self.look.shading, ..carried.look },
            picture,
            carried: None,
            ..*self
        })
    }
}

/// The positions of the strands of a hairstyle at one time, world space.
#[derive(Clone, Copy, Debug)]
pub enum HairPose<'a> {
    /// Given by guides, from which the backend interpolates strands.
    Guides(&'a GuideFrame),
    /// The same where a graphics device has the guides too: a renderer on that device takes them from there, and uploads none.
    Resident(&'a GuideFrame, &'a ResidentGuides),
    /// Given strands, with as many points as the hairstyle.
    Strands(&'a Strands),
}

impl<'a> HairPose<'a> {
    /// The guides, if strands are interpolated from them.
    pub(crate) fn guides(self) -> Option<&'a GuideFrame> {
        match self {
            Self::Guides(guides) | Self::Resident(guides, _) => Some(guides),
            Self::Strands(_) => None,
        }
    }

    /// The strands in memory: the given ones, or strands interpolated into `made`.
    pub(crate) fn strands<'s>(&'s self, style: &Hairstyle, made: &'s mut Strands) -> &'s Strands {
        match self {
            Self::Strands(strands) => strands,
            Self::Guides(guides) | Self::Resident(guides, _) => {
                interpolate(style, guides, made);
                made
            }
        }
    }
}

/// Hair that was drawn as clusters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClusterStats {
    /// Number of clusters, one per wisp.
    pub clusters: u64,
    /// Number of macro-clusters, whose clusters share parameters.
    pub macro_clusters: u64,
    /// Hair shell volumes of all clusters.
    pub volumes: u64,
    /// Bytes of the parameters of all macro-clusters.
    pub bytes: u64,
    /// Bytes that the parameters would need if no clusters shared them.
    pub bytes_unshared: u64,
}

impl ClusterStats {
    /// The numbers of `hair`.
    pub(crate) fn of(hair: &ClusterHair) -> Self {
        let [bytes, bytes_unshared] = hair.bytes();
        Self {
            clusters: hair.clusters() as u64,
            macro_clusters: hair.macro_clusters() as u64,
            volumes: (hair.clusters() * hair.grid.volumes()) as u64,
            bytes,
            bytes_unshared,
        }
    }
}

/// Statistics of one picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// Time to interpolate strands from guides, milliseconds; 0 if the device does not measure passes.
    pub interpolate_ms: f64,
    /// Time to build the shadow maps and look up every strand point, milliseconds; 0 as above.
    pub shadow_ms: f64,
    /// The rest of the time of the picture, milliseconds.
    pub draw_ms: f64,
    /// The times of the passes `shadow/…` and `draw/…` in their order, added up over lights, as far as the backend measures them.
    pub passes: Vec<PassTime>,
    /// The passes that were left out because nothing moved and their results were kept, with the times that they took when they last
    /// ran. A pass that was left out for some lights only stands in both lists.
    pub kept: Vec<PassTime>,
    /// Segments that were drawn.
    pub segments: u64,
    /// Bytes of the shadow maps.
    pub shadow_bytes: u64,
    /// Records of the shadow maps that cannot be read as the method is defined, and are read in a simpler way.
    pub shadow_fallbacks: u64,
    /// Bytes of the shaded strands and of the buffers that blend them per pixel.
    pub draw_bytes: u64,
    /// Mean transmittance of the first light over the strands' points.
    pub mean_transmittance: f32,
    /// The share of the tiles that were drawn, if the picture shows only what has moved, over the one before and with its shadows; `None` of
    /// a whole picture.
    pub redrawn: Option<f32>,
    /// The clusters that were drawn; `None` if there are only strands.
    pub clusters: Option<ClusterStats>,
    /// What the frame moved between memory and the graphics device; nothing on the CPU.
    pub traffic: Traffic,
}

impl FrameStats {
    /// Time to build the shadow maps, milliseconds: all passes `shadow/…` except those of [`FrameStats::query_ms`]; 0 if the device
    /// does not measure passes.
    pub fn build_ms(&self) -> f64 {
        self.sum_ms(|name| name.starts_with("shadow/") && !ASKING.contains(&name))
    }

    /// Time to look up the shadow maps at strand points, at vertices of the body and behind all hair, milliseconds; 0 if the device
    /// does not measure passes.
    pub fn query_ms(&self) -> f64 {
        self.sum_ms(|name| ASKING.contains(&name))
    }

    /// What the picture costs while hair, body and lights move: passes that were left out count with the times that they took when they
    /// last ran.
    #[must_use]
    pub fn made_anew(&self) -> Self {
        let mut anew = self.clone();
        for pass in anew.kept.drain(..) {
            if pass.name == INTERPOLATE {
                anew.interpolate_ms += pass.ms;
                continue;
            }
            let stage =
                if pass.name.starts_with("shadow/") { &mut anew.shadow_ms } else { &mut anew.draw_ms };
            *stage += pass.ms;
            // Some lights may have been kept, and others not.
            match anew.passes.iter_mut().find(|run| run.name == pass.name) {
                Some(run) => run.ms += pass.ms,
                None => anew.passes.push(pass),
            }
        }
        anew
    }

    fn sum_ms(&self, of: impl Fn(&str) -> bool) -> f64 {
        self.passes.iter().filter(|pass| of(&pass.name)).map(|pass| pass.ms).fold(0.0, |sum, ms| sum + ms)
    }
}

/// The name of the interpolation of strands among what is kept. Its time is that of a stage, and no pass of shadows or drawing.
pub(crate) const INTERPOLATE: &str = "interpolate";

/// Passes that look up finished maps.
const ASKING: [&str; 2] = ["shadow/ask", "shadow/columns"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_kept_counts_as_when_it_was_made() {
        let pass = |name: &str, ms: f64| PassTime { name: name.to_owned(), ms };
        let stats = FrameStats {
            draw_ms: 5.0,
            passes: vec![pass("draw/tiles", 5.0)],
            kept: vec![
                pass("shadow/build", 2.0),
                pass("shadow/ask", 1.0),
                pass("draw/body-depth", 0.5),
                pass("draw/tiles", 0.25),
                pass(INTERPOLATE, 4.0),
            ],
            ..FrameStats::default()
        };
        let anew = stats.made_anew();
        assert_eq!((anew.shadow_ms, anew.draw_ms, anew.build_ms(), anew.query_ms()), (3.0, 5.75, 2.0, 1.0));
        assert_eq!(anew.passes[0], pass("draw/tiles", 5.25), "a part of it was kept");
        assert_eq!(anew.interpolate_ms, 4.0);
        assert!(anew.kept.is_empty() && anew.made_anew() == anew);
        assert!(anew.passes.iter().all(|pass| pass.name != INTERPOLATE), "a stage and no pass");
        assert_eq!((stats.build_ms(), stats.query_ms()), (0.0, 0.0), "the picture itself built nothing");
    }

    #[test]
    fn building_and_asking_are_told_apart_by_the_names_of_passes() {
        let names = [
            "interpolate/strands",
            "shadow/fill",
            "shadow/ask",
            "draw/ask",
            "shadow/columns",
            "shadow/asking",
        ];
        let passes = names.iter().zip([1.0, 2.0, 4.0, 8.0, 16.0, 32.0]);
        let passes = passes.map(|(name, ms)| PassTime { name: (*name).to_owned(), ms }).collect();
        let stats = FrameStats { passes, ..FrameStats::default() };
        assert_eq!((stats.build_ms(), stats.query_ms()), (34.0, 20.0));
        let nothing = FrameStats::default();
        assert_eq!((nothing.build_ms(), nothing.query_ms()), (0.0, 0.0));
    }
}
