//! The number of inputs that an image shows.

use std::sync::{Arc, Weak};

use lovelock_project::Project;
use lovelock_style::hand::HandEdits;

use crate::scene::StyleSource;

/// Counts the inputs of a user that an image shows: settings that it is drawn with, movements of a brush, and scenes that are loaded. Frames
/// of a dance are none. See [`RenderRequest::input`](super::RenderRequest::input).
#[derive(Clone, Debug, Default)]
pub struct Inputs {
    number: u64,
    /// What the hair of the last request is made of: another one for each load.
    hair: Option<Weak<StyleSource>>,
    /// The layer that brushes have changed last and what it holds, until hair with it is drawn.
    brushed: Option<(u32, HandEdits)>,
}

impl Inputs {
    /// The number so far.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// A brush has moved hair, and what it did was written into a layer of the project, which now holds these edits.
    pub fn brushed(&mut self, layer: u32, edits: &HandEdits) {
        self.number += 1;
        self.brushed = Some((layer, edits.clone()));
    }

    /// The project has changed. Hair that must be loaded first is an input when it is drawn, also that without what a brush did.
    pub fn changed(&mut self, before: &Project, after: &Project) {
        let looks_other = (&before.look, &before.shadow, &before.lights, &before.camera, &before.picture)
            != (&after.look, &after.shadow, &after.lights, &after.camera, &after.picture);
        self.number += u64::from(looks_other);
        self.brushed.take_if(|(layer, edits)| after.hair.stack.hand(*layer) != Some(&*edits));
    }

    /// A frame is drawn whose hair is made of this. Tracks, and ties in motion, change its hairstyle from frame to frame without another
    /// load. The hairstyles that are loaded up to the one that a brush leaves look as the hair that it has moved, and are no inputs of
    /// their own.
    pub fn drawn(&mut self, hair: &Arc<StyleSource>) {
        if self.hair.as_ref().is_some_and(|before| before.as_ptr() == Arc::as_ptr(hair)) {
            return;
        }
        let is_first = self.hair.replace(Arc::downgrade(hair)).is_none();
        self.number += u64::from(!is_first && self.brushed.is_none());
        self.brushed.take_if(|(layer, edits)| hair.stack.hand(*layer) == Some(&*edits));
    }
}

#[cfg(test)]
mod tests {
    use lovelock_groom::HairTie;
    use lovelock_project::files::Access;
    use lovelock_style::hand::{HandEdit, HandRoots};
    use lovelock_style::operations::Hand;
    use lovelock_style::{Layer, StyleStack};

    use super::*;
    use crate::scene::{Scene, SceneLoader};
    use crate::testing::{scene, settled, small_project};

    /// The layer of brushes.
    const LAYER: u32 = 1;

    /// Edits of a guide that no other number has.
    fn edits(number: u8) -> HandEdits {
        let mut edits = HandEdits::default();
        let edit = HandEdit { length: 0.5 + 0.1 * f32::from(number), ..HandEdit::default() };
        edits.change(&HandRoots::of(&scene().style), [(0, edit)]);
        edits
    }

    /// What hair with these edits is made of.
    fn made_of(edits: HandEdits) -> Arc<StyleSource> {
        let source = Arc::clone(&scene().source);
        let mut stack = StyleStack::default();
        assert_eq!(stack.push(Layer::of(Hand { edits })), Some(LAYER));
        let (base, obstacle) = (Arc::clone(&source.base), Arc::clone(&source.obstacle));
        Arc::new(StyleSource { base, stack, obstacle, scale: source.scale, morph: None })
    }

    #[test]
    fn brushes_sliders_and_settings_are_inputs_and_frames_are_not() {
        let mut inputs = Inputs::default();
        let hair = [0, 1, 2, 3].map(|number| made_of(edits(number)));
        let mut expect = |act: &dyn Fn(&mut Inputs), more: u64, why: &str| {
            let before = inputs.number();
            act(&mut inputs);
            assert_eq!(inputs.number() - before, more, "{why}");
        };
        expect(&|inputs| inputs.drawn(&hair[0]), 0, "the first image");
        expect(&|inputs| inputs.drawn(&hair[0]), 0, "a frame of the dance");
        expect(&|inputs| inputs.drawn(&hair[1]), 1, "the slider of a layer");
        for number in [2, 3] {
            expect(&|inputs| inputs.brushed(LAYER, &edits(number)), 1, "a movement of a brush");
        }
        expect(&|inputs| inputs.drawn(&hair[1]), 0, "a frame of the moved hair");
        expect(&|inputs| inputs.drawn(&hair[2]), 0, "the hairstyle of the first movement");
        expect(&|inputs| inputs.drawn(&hair[3]), 0, "that of the last");
        expect(&|inputs| inputs.drawn(&hair[0]), 1, "the slider of a layer");
        let project = Project::default();
        let mut brushed = project.clone();
        brushed.hair.stack = hair[1].stack.clone();
        expect(&|inputs| inputs.brushed(LAYER, &edits(1)), 1, "a movement of a brush");
        expect(&|inputs| inputs.changed(&project, &brushed), 0, "what it did");
        expect(&|inputs| inputs.changed(&brushed, &project), 0, "that is undone before it is loaded");
        expect(&|inputs| inputs.drawn(&hair[2]), 1, "the hair without it");
        let mut changed = project.clone();
        changed.hair.groom.length *= 0.5;
        expect(&|inputs| inputs.changed(&project, &changed), 0, "hair that must be loaded");
        changed.look.roughness *= 0.5;
        expect(&|inputs| inputs.changed(&project, &changed), 1, "a look");
        changed = project.clone();
        changed.lights[0].intensity *= 0.5;
        expect(&|inputs| inputs.changed(&project, &changed), 1, "a light");
    }

    #[test]
    fn a_tie_in_motion_is_one_input() {
        let mut loader = SceneLoader::new();
        let mut load = |project: &Project| loader.load_now(project, &Access::new()).expect("a scene").0;
        let mut project = small_project();
        project.hair.groom.length = 0.5;
        let loose = load(&project);
        project.hair.ties = vec![HairTie::default()];
        let tied = load(&project);
        let mut engine = settled(loose, &project);
        let mut inputs = Inputs::default();
        inputs.drawn(&engine.snapshot().scene.source);
        engine.set_scene(tied);
        let mut next = || {
            engine.step();
            let scene = Arc::clone(&engine.snapshot().scene);
            inputs.drawn(&scene.source);
            (inputs.number(), scene)
        };
        let frames = [next(), next(), next()];
        assert_eq!(frames.each_ref().map(|(number, _)| *number), [1; 3]);
        let has_own = |two: &[(u64, Arc<Scene>)]| !Arc::ptr_eq(&two[0].1.style, &two[1].1.style);
        assert!(frames.windows(2).all(has_own), "the control: each frame has a hairstyle of its own");
    }
}
