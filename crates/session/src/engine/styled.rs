//! The hairstyle of the current step, where tracks change it.

use std::sync::Arc;

use lovelock_style::StyleStack;

use super::Engine;
use crate::scene::Scene;

impl Engine {
    /// Lays the hair of the current step in its rest shape.
    pub(crate) fn lay_at_rest(&mut self) {
        self.reset_to_rest(self.at_step, f64::NEG_INFINITY);
    }

    /// Moves to the next step with the hair at rest.
    pub(crate) fn step_at_rest(&mut self) {
        self.reset_to_rest(self.at_step + 1, f64::NEG_INFINITY);
        self.taken += 1;
    }

    /// The loaded scene with the hairstyle of the current step, or with that of `lead_in_secs` if it is later.
    pub(super) fn styled(&mut self, lead_in_secs: f64) -> Arc<Scene> {
        let secs = self.loaded.position_secs(self.time_secs().max(lead_in_secs));
        match &mut self.styling {
            Some(styling) => styling.scene_at(&self.loaded, secs),
            None => Arc::clone(&self.loaded),
        }
    }

    /// The layers of the current step.
    pub(super) fn stack(&self) -> StyleStack {
        let stack = &self.loaded.source.stack;
        let secs = self.loaded.position_secs(self.time_secs());
        self.styling.as_ref().map_or_else(|| stack.clone(), |styling| styling.stack_at(stack, secs))
    }

    /// Keeps the hairstyle without its tracks.
    #[cfg(test)]
    pub(crate) fn forget_tracks(&mut self) {
        self.styling = None;
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
