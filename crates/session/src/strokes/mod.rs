//! Strokes of brushes on the hair of an engine.

use std::sync::Arc;

use glam::Vec3;
use lovelock_brush::{Brush, BrushSettings, BrushSurroundings, StrokeSample, Tool};
use lovelock_groom::{Hairstyle, Obstacle};
use lovelock_style::hand::HandEdits;
use lovelock_style::{Operation, StyleCache, StyleStack};

use crate::engine::Engine;
use crate::scene::Scene;

/// A stroke that begins.
#[derive(Clone, Debug)]
pub struct StrokeStart {
    /// A number that no earlier stroke has.
    pub id: u64,
    /// The layer of the style that it is written into.
    pub layer: u32,
    /// The tool.
    pub tool: Tool,
    /// Whether the tool does the opposite.
    pub inverted: bool,
    /// How the brush touches hair.
    pub settings: BrushSettings,
    /// What the layer holds; none where it is what the last stroke left there.
    pub edits: Option<HandEdits>,
}

/// What a stroke has done so far.
#[derive(Clone, Debug)]
pub struct Brushed {
    /// The number of the stroke.
    pub stroke: u64,
    /// The layer.
    pub layer: u32,
    /// What the layer holds now.
    pub edits: HandEdits,
    /// Which guides are protected, if that has changed.
    pub frozen: Option<Arc<[bool]>>,
    /// Whether the stroke has ended.
    pub ended: bool,
}

/// The hair below the layers of brushes, kept from stroke to stroke.
#[derive(Clone, Debug, Default)]
pub struct HairBelow {
    cache: StyleCache,
    scaled: Option<(Arc<Hairstyle>, Arc<Hairstyle>)>,
}

impl HairBelow {
    /// The hair that the layer `layer` of a scene gets, in the size of its head; `None` if the scene has no such layer of a brush.
    fn of(&mut self, scene: &Scene, layer: u32) -> Option<Arc<Hairstyle>> {
        let source = &scene.source;
        let at = source.stack.layers.iter().position(|of| of.id == layer)?;
        if !matches!(source.stack.layers[at].operation, Operation::Hand(_)) {
            return None;
        }
        let mut below: StyleStack = source.stack.clone();
        below.layers.truncate(at);
        let style = self.cache.apply(&source.base, &below, Arc::clone(&source.obstacle)).style;
        if source.scale == 1.0 {
            return Some(style);
        }
        match &self.scaled {
            Some((of, scaled)) if Arc::ptr_eq(of, &style) => Some(Arc::clone(scaled)),
            _ => {
                let scaled = Arc::new(style.scaled(source.scale));
                self.scaled = Some((style, Arc::clone(&scaled)));
                Some(scaled)
            }
        }
    }
}

/// A stroke on the hair of an engine.
#[derive(Debug)]
pub struct Stroke {
    brush: Brush,
    before: HandEdits,
}

/// The body in the size of the head that wears the hair.
struct ScaledObstacle<'a> {
    usual: &'a dyn Obstacle,
    scale: f32,
}

impl Obstacle for ScaledObstacle<'_> {
    fn distance(&self, p: Vec3) -> (f32, Vec3) {
        let (distance, normal) = self.usual.distance(p / self.scale);
        (distance * self.scale, normal)
    }
}

impl Stroke {
    /// Begins a stroke on the hair of an engine. `edits` is what the layer holds, and `frozen` says which guides are protected. `None` if
    /// the engine's scene has no such layer, or its guides are not those of the layer.
    pub fn begin(
        engine: &Engine,
        start: &StrokeStart,
        edits: HandEdits,
        frozen: &[bool],
        below: &mut HairBelow,
    ) -> Option<Self> {
        let scene = engine.current_scene();
        let below = below.of(scene, start.layer)?;
        let hair = [&below, &scene.style];
        let brush = Brush::new(start.tool, start.inverted, &start.settings, hair, &edits, frozen)?;
        Some(Self { brush, before: edits })
    }

    /// Moves the brush to a sample, which is in the space of the head, and the hair of the engine with it. Returns whether hair has moved.
    pub fn stroke_to(&mut self, engine: &mut Engine, sample: &StrokeSample) -> bool {
        let source = Arc::clone(&engine.current_scene().source);
        let around = ScaledObstacle { usual: &*source.obstacle, scale: source.scale };
        let brush = &mut self.brush;
        engine.move_hair(|frame| {
            let sample = sample.placed(&frame.world_from_head);
            brush.stroke_to(frame, &BrushSurroundings { obstacle: &around }, &sample)
        })
    }

    /// What the layer holds after the stroke so far.
    pub fn edits(&self) -> HandEdits {
        let mut edits = self.before.clone();
        self.brush.write(&mut edits);
        edits
    }

    /// Which guides are protected.
    pub fn frozen(&self) -> &[bool] {
        self.brush.frozen()
    }
}

#[cfg(test)]
mod tests;
