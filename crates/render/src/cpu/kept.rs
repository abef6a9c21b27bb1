//! What is kept of the frame before: strands while the hair and the softness of the first light stay, the map of each light while it and
//! these stay, what was looked up
//! in it while the drawn points and the body stay too, and the body's depth map of each light while it and the body stay. All of it is
//! kept while only the camera moves, as around a paused dance.
//!
//! Inputs are compared by their content, which takes a fraction of a millisecond, so nobody has to say what has changed.

use std::sync::Arc;

use glam::Vec3;
use lovelock_base::memory::list_bytes;
use lovelock_groom::{GuideFrame, Hairstyle, Strands};
use lovelock_motion::Body;

use crate::shadow_look::ShadowLook;
use crate::{FrameInput, HairPose, Light, LightKind, MAX_LIGHTS};

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
    /// What softens shadows of hair, but not depth maps: of a light with several samples their number, and its angular radius if it stands nowhere.
    area: Option<(u32, f32)>,
}

impl ComesFrom {
    fn of(light: &Light) -> Self {
        let place = || (light.kind, light.position, [light.radius, light.outer_angle]);
        let area = || (light.shadow_samples, if light.stands() { 0.0 } else { light.angular_radius });
        Self {
            direction: light.direction,
            standing: light.stands().then(place),
            area: (light.shadow_samples > 1).then(area),
        }
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Unchanged {
    /// The body and the positions of its vertices.
    pub surface: bool,
    /// The hair, its look as far as shadows depend on it, their settings, and the head.
    pub strands: bool,
    /// Where each light comes from, and its area. All have changed if their number has.
    pub lights: [bool; MAX_LIGHTS],
    /// Where all of the lights come from, and their number.
    pub all_places: bool,
}

impl Unchanged {
    /// Whether the body's depth maps are those of the last frame.
    pub fn depth(self) -> bool {
        self.surface && self.all_places
    }
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
        let surface = self.body.follow_surface(input);
        let (lights, all_places) = self.body.follow_lights(input);
        let same_hair = self.hair.as_ref().is_some_and(|kept| kept.is_of(input));
        let strands = same_hair & self.follow_pose(input) & input.known.is_none();
        if input.known.is_some() {
            // Transmittance that was given is not that of the next picture.
            self.hair = None;
        } else if !same_hair {
            self.hair = Some(HairInputs { style: Arc::clone(input.style), look: ShadowLook::of(input) });
        }
        self.body.is_known = true;
        Unchanged { surface, strands, lights, all_places }
    }

    /// Forgets the last frame, because it was not completed or its results are no longer there.
    pub fn forget(&mut self) {
        (self.hair, self.guides, self.body.is_known) = (None, None, false);
    }

    fn follow_pose(&mut self, input: &FrameInput) -> bool {
        match input.hair {
            HairPose::Guides(guides) | HairPose::Resident(guides, _) => {
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
    fn follow_surface(&mut self, input: &FrameInput) -> bool {
        let body = input.body.map(|(body, _)| body);
        let positions = input.body.map_or(&[][..], |(_, skin)| &skin.positions);
        let same = self.is_known
            && self.body.as_ref().map(Arc::as_ptr) == body.map(Arc::as_ptr)
            && self.positions == positions;
        if !same {
            self.body = body.cloned();
            self.positions.clear();
            self.positions.extend_from_slice(positions);
        }
        same
    }

    /// Whether each light is as before, and whether all are where they were.
    fn follow_lights(&mut self, input: &FrameInput) -> ([bool; MAX_LIGHTS], bool) {
        let before = std::mem::take(&mut self.lights);
        self.lights.extend(Light::enabled(input.lights).map(|light| ComesFrom::of(&light)));
        let mut same = [false; MAX_LIGHTS];
        let same_count = self.is_known && before.len() == self.lights.len();
        let mut all_places = same_count;
        if same_count {
            for (same, (light, before)) in same.iter_mut().zip(self.lights.iter().zip(&before)) {
                *same = light == before;
                all_places &= *light == ComesFrom { area: light.area, ..*before };
            }
        }
        (same, all_places)
    }
}
