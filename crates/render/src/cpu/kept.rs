//! What is kept of the frame before: strands and shadows while neither hair nor body nor lights change, as when the camera turns around
//! a paused dance, and the body's depth maps while the body and the lights stay.
//!
//! Inputs are compared by their content, which takes a fraction of a millisecond, so nobody has to say what has changed.

use std::sync::Arc;

use glam::Vec3;
use lovelock_base::memory::list_bytes;
use lovelock_groom::{GuideFrame, Hairstyle, Strands};
use lovelock_motion::Body;

use crate::shadow_look::ShadowLook;
use crate::{FrameInput, HairPose, Light, LightKind};

/// Given strands of more points are not compared: copies of them would cost too much memory beside those of other panes.
const MAX_STRAND_POINTS: usize = 1 << 18;

/// The inputs of the last frame whose results are kept.
#[derive(Debug, Default)]
pub(super) struct KeptInputs {
    hair: Option<HairInputs>,
    guides: Option<GuideFrame>,
    strands: Strands,
    body: BodyInputs,
}

/// What the shadows depend on beside the positions of hair and body.
#[derive(Debug)]
struct HairInputs {
    style: Arc<Hairstyle>,
    look: ShadowLook,
}

/// Where a light comes from: its direction, and of one that stands somewhere its place, radius and cone.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ComesFrom {
    direction: Vec3,
    standing: Option<(LightKind, Vec3, [f32; 2])>,
}

impl ComesFrom {
    fn of(light: &Light) -> Self {
        let place = || (light.kind, light.position, [light.radius, light.outer_angle]);
        Self { direction: light.direction, standing: light.stands().then(place) }
    }
}

#[derive(Debug, Default)]
struct BodyInputs {
    body: Option<Arc<Body>>,
    positions: Vec<Vec3>,
    /// Where the lights that are on come from.
    lights: Vec<ComesFrom>,
    is_known: bool,
}

/// What has not changed since the last frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Unchanged {
    /// Body and lights: their depth maps.
    pub body: bool,
    /// Hair, body and lights, and the settings of shadows: strands, maps and what was looked up in them.
    pub hair: bool,
}

impl KeptInputs {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        let guides = self.guides.as_ref().map(|frame| &frame.guides);
        guides.map_or(0, |guides| [&guides.x, &guides.y, &guides.z].map(list_bytes).into_iter().sum())
            + self.strands.bytes()
            + list_bytes(&self.body.positions)
    }

    /// Compares `input` with that of the last frame and takes its place.
    pub fn follow(&mut self, input: &FrameInput) -> Unchanged {
        let body = self.body.follow(input);
        let same_hair = self.hair.as_ref().is_some_and(|kept| kept.is_of(input));
        let hair = body & same_hair & self.follow_pose(input) & input.known.is_none();
        if input.known.is_some() {
            // Transmittance that was given is not that of the next picture.
            self.hair = None;
        } else if !same_hair {
            self.hair = Some(HairInputs { style: Arc::clone(input.style), look: ShadowLook::of(input) });
        }
        Unchanged { body, hair }
    }

    /// Forgets the last frame, because it was not completed or its results are no longer there.
    pub fn forget(&mut self) {
        (self.hair, self.guides, self.body.is_known) = (None, None, false);
    }

    fn follow_pose(&mut self, input: &FrameInput) -> bool {
        match input.hair {
            HairPose::Guides(guides) => {
                let same = self.guides.as_ref() == Some(guides);
                if !same {
                    match &mut self.guides {
                        Some(kept) => kept.clone_from(guides),
                        none => *none = Some(guides.clone()),
                    }
                }
                same
            }
            HairPose::Strands(strands) if strands.points() > MAX_STRAND_POINTS => {
                (self.guides, self.strands) = (None, Strands::default());
                false
            }
            HairPose::Strands(strands) => {
                let kept = &mut self.strands;
                let same = self.guides.is_none()
                    && (&kept.x, &kept.y, &kept.z, &kept.first_point)
                        == (&strands.x, &strands.y, &strands.z, &strands.first_point);
                if !same {
                    self.guides = None;
                    kept.first_point = Arc::clone(&strands.first_point);
                    for (kept, axis) in
                        [(&mut kept.x, &strands.x), (&mut kept.y, &strands.y), (&mut kept.z, &strands.z)]
                    {
                        kept.clone_from(axis);
                    }
                }
                same
            }
        }
    }
}

impl HairInputs {
    fn is_of(&self, input: &FrameInput) -> bool {
        Arc::ptr_eq(&self.style, input.style) && self.look == ShadowLook::of(input)
    }
}

impl BodyInputs {
    fn follow(&mut self, input: &FrameInput) -> bool {
        let body = input.body.map(|(body, _)| body);
        let positions = input.body.map_or(&[][..], |(_, skin)| &skin.positions);
        let lights = || Light::enabled(input.lights).map(|light| ComesFrom::of(&light));
        let same = self.is_known
            && self.body.as_ref().map(Arc::as_ptr) == body.map(Arc::as_ptr)
            && self.positions == positions
            && self.lights.iter().copied().eq(lights());
        if !same {
            self.body = body.cloned();
            self.positions.clear();
            self.positions.extend_from_slice(positions);
            self.lights.clear();
            self.lights.extend(lights());
            self.is_known = true;
        }
        same
    }
}
