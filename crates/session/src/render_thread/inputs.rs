//! The number of inputs that an image shows.

use std::sync::{Arc, Weak};

use lovelock_groom::Hairstyle;
use lovelock_project::Project;

/// Counts the inputs of a user that an image shows: settings that it is drawn with, movements of a brush, and other hair. Frames of a dance
/// are none. See [`RenderRequest::input`](super::RenderRequest::input).
#[derive(Clone, Debug, Default)]
pub struct Inputs {
    number: u64,
    /// The hair of the last request.
    hair: Option<Weak<Hairstyle>>,
    /// Whether hair is being loaded that shows what a brush has done.
    awaits_brushed: bool,
}

impl Inputs {
    /// The number so far.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// A brush has moved hair.
    pub fn brushed(&mut self) {
        self.number += 1;
        self.awaits_brushed = true;
    }

    /// The project has changed. Hair that must be loaded first is an input when it is drawn.
    pub fn changed(&mut self, before: &Project, after: &Project) {
        let looks_other = (&before.look, &before.shadow, &before.lights, &before.camera, &before.picture)
            != (&after.look, &after.shadow, &after.lights, &after.camera, &after.picture);
        self.number += u64::from(looks_other);
    }

    /// A frame with this hair is drawn. The hairstyle that a brush leaves looks as the hair that it has moved, and is no input of its own.
    pub fn drawn(&mut self, hair: &Arc<Hairstyle>) {
        if self.hair.as_ref().is_some_and(|before| before.as_ptr() == Arc::as_ptr(hair)) {
            return;
        }
        let is_first = self.hair.replace(Arc::downgrade(hair)).is_none();
        let is_brushed = std::mem::take(&mut self.awaits_brushed);
        self.number += u64::from(!is_first && !is_brushed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brushes_sliders_and_settings_are_inputs_and_frames_are_not() {
        let mut inputs = Inputs::default();
        let hair: [Arc<Hairstyle>; 4] = std::array::from_fn(|_| Arc::default());
        let mut expect = |act: &dyn Fn(&mut Inputs), more: u64, why: &str| {
            let before = inputs.number();
            act(&mut inputs);
            assert_eq!(inputs.number() - before, more, "{why}");
        };
        expect(&|inputs| inputs.drawn(&hair[0]), 0, "the first image");
        expect(&|inputs| inputs.drawn(&hair[0]), 0, "a frame of the dance");
        expect(&|inputs| inputs.drawn(&hair[1]), 1, "the slider of a layer");
        for _ in 0..2 {
            expect(&Inputs::brushed, 1, "a movement of a brush");
        }
        expect(&|inputs| inputs.drawn(&hair[1]), 0, "a frame of the moved hair");
        expect(&|inputs| inputs.drawn(&hair[2]), 0, "its hairstyle");
        expect(&|inputs| inputs.drawn(&hair[3]), 1, "the slider of a layer");
        let project = Project::default();
        let mut changed = project.clone();
        changed.hair.groom.length *= 0.5;
        expect(&|inputs| inputs.changed(&project, &changed), 0, "hair that must be loaded");
        changed.look.roughness *= 0.5;
        expect(&|inputs| inputs.changed(&project, &changed), 1, "a look");
        changed = project.clone();
        changed.lights[0].intensity *= 0.5;
        expect(&|inputs| inputs.changed(&project, &changed), 1, "a light");
    }
}
