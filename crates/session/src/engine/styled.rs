//! The hairstyle of the current step, where tracks change it.

use std::sync::Arc;

use super::Engine;
use crate::scene::Scene;

impl Engine {
    /// The loaded scene with the hairstyle of the current step, or with that of `lead_in_secs` if it is later.
    pub(super) fn styled(&mut self, lead_in_secs: f64) -> Arc<Scene> {
        let secs = self.loaded.position_secs(self.time_secs().max(lead_in_secs));
        match &mut self.styling {
            Some(styling) => styling.scene_at(&self.loaded, secs),
            None => Arc::clone(&self.loaded),
        }
    }

    /// Takes the hairstyle of the current step; see [`Engine::styled`]. The hair keeps moving.
    pub(super) fn restyle(&mut self, lead_in_secs: f64) {
        let scene = self.styled(lead_in_secs);
        if Arc::ptr_eq(&scene, &self.scene) {
            return;
        }
        let before = std::mem::replace(&mut self.scene, scene);
        let (old, new) = (&before.style, &self.scene.style);
        if Arc::ptr_eq(old, new) {
            return;
        }
        // A transition of other strands ends here.
        self.combing.take_if(|_| old.strands.first_point != new.strands.first_point);
        self.rest_is_new |= old.guides != new.guides;
        self.simulation.set_style(Arc::clone(new));
    }
}
