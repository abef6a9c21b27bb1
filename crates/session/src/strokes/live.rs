//! A stroke of the pointer on the hair of an engine.

use std::sync::Arc;

use lovelock_brush::{Brush, BrushSettings, StrokeSample, Tool};
use lovelock_groom::GuideFrame;
use lovelock_style::hand::HandEdits;

use crate::engine::{BrushLayers, Engine};

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
    /// What the layer holds.
    pub edits: HandEdits,
    /// The stroke whose result may not be in `edits` yet: if it was the last one, this one goes on from what it left.
    pub after: Option<u64>,
}

/// What a stroke has done so far.
#[derive(Clone, Debug)]
pub struct StrokeReport {
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

/// A stroke on the hair of an engine.
#[derive(Debug)]
pub struct Stroke {
    brush: Brush,
    before: HandEdits,
}

impl Stroke {
    /// Begins a stroke on the hair of an engine. `edits` is what the layer holds, and `frozen` says which guides are protected. `None` if
    /// the engine's scene has no such layer, or its guides are not those of the layer.
    pub fn begin(
        engine: &Engine,
        start: &StrokeStart,
        edits: HandEdits,
        frozen: &[bool],
        layers: &mut BrushLayers,
    ) -> Option<Self> {
        let (tool, hand) = ((start.tool, start.inverted), (start.layer, &edits));
        let brush = engine.begin_stroke_after(layers, tool, &start.settings, hand, frozen)?;
        Some(Self { brush, before: edits })
    }

    /// Moves the brush to a sample, which is in the space of the head, and the hair of the engine with it. Returns whether hair has moved.
    pub fn stroke_to(&mut self, engine: &mut Engine, sample: &StrokeSample) -> bool {
        !engine.comb_in_head(&mut self.brush, sample).is_empty()
    }

    /// Ends the stroke: hair that a comb has left in the air falls, at once or as it is simulated. Returns whether any falls.
    pub fn let_go(&mut self, engine: &mut Engine, at_once: bool) -> bool {
        !engine.let_go(&mut self.brush, at_once).is_empty()
    }

    /// Puts the hair that the stroke has moved back to where it is in `frame`, with the rest shape of the stroke: after a scene that does
    /// not have the whole stroke yet.
    pub fn hold(&self, engine: &mut Engine, frame: &GuideFrame) {
        let touched = self.touched();
        engine.move_hair(frame, self.brush.rest(), &touched);
    }

    /// Takes the rest shape of the stroke away from the hair that it has moved, which goes back to the style of the scene.
    pub fn take_back(&self, engine: &mut Engine) {
        let frame = engine.frame_of_guides();
        let style = Arc::clone(&engine.scene().style);
        engine.move_hair(&frame, &style.guides, &self.touched());
    }

    fn touched(&self) -> Vec<usize> {
        let touched = self.brush.touched().iter().enumerate();
        touched.filter(|(_, touched)| **touched).map(|(guide, _)| guide).collect()
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
