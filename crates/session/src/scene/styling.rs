//! The hairstyle of a scene at a time of the timeline.

use std::sync::Arc;

use lovelock_groom::{Hairstyle, Obstacle};
use lovelock_project::Project;
use lovelock_project::animation::{StyleTracks, StyleValues};
use lovelock_style::{Morph, StyleCache, StyleStack};

use super::Scene;
use super::scalp_part::Enlarged;

/// What the hairstyle of a scene is made of.
pub struct StyleSource {
    /// The hair below the layers: grown or imported, cut and tied.
    pub base: Arc<Hairstyle>,
    /// The layers.
    pub stack: StyleStack,
    /// The body without hair, in the size of the head that the hair is styled on.
    pub obstacle: Arc<dyn Obstacle + Send>,
    /// Size of the head that wears the hair as a multiple of the one that it is styled on.
    pub scale: f32,
    /// What the hair turns into, if it does.
    pub morph: Option<MorphSource>,
}

/// The second style of a morph.
#[derive(Clone)]
pub struct MorphSource {
    /// The style with its layers.
    pub to: Arc<Hairstyle>,
    /// How far the hair has turned into it where no track sets that, 0 to 1.
    pub amount: f32,
}

impl std::fmt::Debug for StyleSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StyleSource").field("stack", &self.stack).finish_non_exhaustive()
    }
}

/// The scene as it was loaded, the numbers of the tracks, and the scene with them.
type Evaluated = (Arc<Scene>, StyleValues, Arc<Scene>);

/// The last morph, and the last hairstyle between its two.
#[derive(Clone, Debug, Default)]
pub(super) struct MorphCache {
    morph: Option<Arc<Morph>>,
    last: Option<(f32, Arc<Hairstyle>)>,
}

impl MorphCache {
    /// The hairstyle between `own` and the second style of `source`: at `amount`, or at that of the source.
    pub(super) fn of(
        &mut self,
        own: &Arc<Hairstyle>,
        source: Option<&MorphSource>,
        amount: Option<f32>,
        obstacle: &dyn Obstacle,
    ) -> Arc<Hairstyle> {
        let Some(source) = source else {
            *self = Self::default();
            return Arc::clone(own);
        };
        let amount = amount.unwrap_or(source.amount);
        let morph = match self.morph.take() {
            Some(morph) if morph.is_of([own, &source.to]) => morph,
            _ => {
                self.last = None;
                Arc::new(Morph::new([Arc::clone(own), Arc::clone(&source.to)]))
            }
        };
        let style = match self.last.take() {
            Some((at, style)) if at.to_bits() == amount.to_bits() => style,
            _ => Arc::new(morph.at(amount, obstacle)),
        };
        self.last = Some((amount, Arc::clone(&style)));
        self.morph = Some(morph);
        style
    }
}

/// Applies the tracks of layers. A scene is the same allocation as long as the numbers of the tracks are, and a changed number evaluates
/// only its layer and those after it.
#[derive(Clone, Debug)]
pub(crate) struct Styling {
    tracks: StyleTracks,
    cache: StyleCache,
    morph: MorphCache,
    enlarged: Enlarged,
    last: Option<Evaluated>,
}

impl Styling {
    /// The styling by the tracks of a project, with what `before` has evaluated; `None` if no track changes the hairstyle.
    pub(crate) fn of(project: &Project, before: Option<Self>) -> Option<Self> {
        let tracks = StyleTracks::of(project)?;
        match before {
            Some(before) if before.tracks == tracks => Some(before),
            before => {
                let (cache, morph, enlarged) =
                    before.map(|of| (of.cache, of.morph, of.enlarged)).unwrap_or_default();
                Some(Self { tracks, cache, morph, enlarged, last: None })
            }
        }
    }

    /// The layers of a scene with their numbers at a time of the timeline, seconds.
    pub(crate) fn stack_at(&self, stack: &StyleStack, secs: f64) -> StyleStack {
        self.tracks.stack_with(stack, &self.tracks.values_at(secs))
    }

    /// `loaded` with its hairstyle at a time of the timeline, seconds.
    pub(crate) fn scene_at(&mut self, loaded: &Arc<Scene>, secs: f64) -> Arc<Scene> {
        let values = self.tracks.values_at(secs);
        if let Some((of, known, scene)) = &self.last
            && Arc::ptr_eq(of, loaded)
            && *known == values
        {
            return Arc::clone(scene);
        }
        let source = &loaded.source;
        let stack = self.tracks.stack_with(&source.stack, &values);
        let style = self.cache.apply(&source.base, &stack, Arc::clone(&source.obstacle)).style;
        let style = self.morph.of(&style, source.morph.as_ref(), values.amount(), &*source.obstacle);
        let style = self.enlarged.of(&style, source.scale);
        let scene = match &self.last {
            // Other numbers of layers that are off.
            Some((of, _, scene)) if Arc::ptr_eq(of, loaded) && Arc::ptr_eq(&scene.style, &style) => {
                Arc::clone(scene)
            }
            _ => Arc::new(Scene { style, ..(**loaded).clone() }),
        };
        self.last = Some((Arc::clone(loaded), values, Arc::clone(&scene)));
        scene
    }
}
