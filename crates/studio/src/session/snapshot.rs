//! One instant of the scene, for drawing.

use std::sync::Arc;

use lovelock_groom::{GuideFrame, Strands, interpolate};
use lovelock_motion::{Pose, Skin};
use lovelock_render::{Camera, FrameInput, HairPose};
use lovelock_simulation::{InsidePoint, StepReport};

use super::{Scene, Totals, camera_at};
use crate::{CameraSection, Project, StageTimes};

/// One instant of the scene: all that drawing needs, and how it came about.
#[derive(Clone, Debug)]
pub struct FrameSnapshot {
    /// The scene that it is an instant of.
    pub scene: Arc<Scene>,
    /// Steps since the engine started: rises from snapshot to snapshot while time passes.
    pub step: u64,
    /// Time of the scene, seconds; goes on rising where the clip loops.
    pub time_secs: f64,
    /// Where the timeline stands, seconds from the start of the clip, or of the take that plays.
    pub position_secs: f64,
    /// Length of the timeline, seconds; 0 where the body rests.
    pub duration_secs: f64,
    /// Where the joints are.
    pub pose: Pose,
    /// The surface of the body.
    pub skin: Skin,
    /// The guides, world space.
    pub guides: GuideFrame,
    /// Measured in the last step.
    pub report: StepReport,
    /// Where the style at rest lies deepest inside the body; none where it does not.
    pub rest_inside: Option<InsidePoint>,
    /// Measured since the hair was last settled.
    pub totals: Totals,
    /// Times of `motion` and `simulate` for this instant; the other stages are the drawer's.
    pub times: StageTimes,
}

impl FrameSnapshot {
    /// Makes the strands on the processor; drawing needs none of it.
    pub fn interpolate(&self, strands: &mut Strands) {
        interpolate(&self.scene.style, &self.guides, strands);
    }

    /// The camera at this instant.
    pub fn camera(&self, section: &CameraSection) -> Camera {
        camera_at(section, &self.scene, self.time_secs)
    }

    /// Everything that the picture of this instant shows, by the settings of `project`.
    pub fn frame_input<'a>(&'a self, project: &'a Project, camera: &'a Camera) -> FrameInput<'a> {
        FrameInput {
            style: &self.scene.style,
            hair: HairPose::Guides(&self.guides),
            look: &project.look,
            body: Some((&self.scene.body, &self.skin)),
            world_from_head: self.guides.world_from_head,
            lights: &project.lights,
            shadow: &project.shadow,
            camera,
            picture: &project.picture,
            known: None,
        }
    }
}

/// Snapshots that nobody looks at any more, so that frames do not allocate.
#[derive(Debug, Default)]
pub(crate) struct SnapshotPool {
    given_out: Vec<Arc<FrameSnapshot>>,
}

impl SnapshotPool {
    /// As many as are looked at together: one in the slot, one or two on their way to the screen.
    const MOST: usize = 6;

    /// Fills a snapshot that is free, or a new one, and hands it out.
    pub(crate) fn make(
        &mut self,
        new: impl FnOnce() -> FrameSnapshot,
        fill: impl FnOnce(&mut FrameSnapshot),
    ) -> Arc<FrameSnapshot> {
        let free = self.given_out.iter_mut().position(|held| Arc::get_mut(held).is_some());
        let mut snapshot = match free {
            Some(i) => self.given_out.swap_remove(i),
            None => Arc::new(new()),
        };
        match Arc::get_mut(&mut snapshot) {
            Some(inner) => fill(inner),
            None => unreachable!("a snapshot that is new or that nobody else holds"),
        }
        if self.given_out.len() < Self::MOST {
            self.given_out.push(Arc::clone(&snapshot));
        }
        snapshot
    }
}
