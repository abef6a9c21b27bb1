//! Strokes of brushes on the simulation thread.

use std::collections::VecDeque;
use std::sync::Arc;

use lovelock_style::Operation;
use lovelock_style::hand::HandEdits;

use super::super::Event;
use super::super::mailbox::BrushRequest;
use super::SimulationThread;
use crate::engine::BrushLayers;
use crate::scene::Scene;
use crate::strokes::{Brushed, Stroke, StrokeStart};

/// The most requests that wait for a scene.
const MOST_WAITING: usize = 4096;

/// The strokes of the thread.
#[derive(Debug, Default)]
pub(super) struct Brushing {
    waiting: VecDeque<BrushRequest>,
    open: Option<Open>,
    layers: BrushLayers,
    frozen: Vec<bool>,
    /// What the last stroke left in its layer.
    left: Option<(u32, HandEdits)>,
}

#[derive(Debug)]
struct Open {
    start: Box<StrokeStart>,
    /// None if the hair cannot be brushed.
    stroke: Option<Stroke>,
}

impl Brushing {
    /// Whether the hair of a scene is in the state in which strokes left it, so that it must not be settled.
    pub(super) fn made(&self, scene: &Scene) -> bool {
        let stack = &scene.source.stack;
        self.open.is_some()
            || self.left.as_ref().is_some_and(|(layer, left)| match stack.layer(*layer) {
                Some(layer) => matches!(&layer.operation, Operation::Hand(hand) if hand.edits == *left),
                None => false,
            })
    }

    /// Whether a stroke is being made.
    pub(super) fn is_open(&self) -> bool {
        self.open.is_some()
    }
}

impl SimulationThread {
    /// Does what brushes have been asked to do, as far as the scene has their layer. Returns whether hair has moved.
    pub(super) fn brush(&mut self, requests: Vec<BrushRequest>) -> bool {
        self.brushing.waiting.extend(requests);
        if self.take.is_some() || self.brushing.waiting.len() > MOST_WAITING {
            self.brushing.waiting.clear();
            self.end_open_stroke();
        }
        let mut moved = false;
        while let Some(request) = self.brushing.waiting.pop_front() {
            match request {
                BrushRequest::Begin(start) => {
                    self.end_open_stroke();
                    if !self.has_layer(start.layer) {
                        self.brushing.waiting.push_front(BrushRequest::Begin(start));
                        break;
                    }
                    self.begin_stroke(start);
                }
                BrushRequest::To(id, samples) => {
                    let (Some(open), Some(engine)) = (&mut self.brushing.open, &mut self.engine) else {
                        continue;
                    };
                    let Some(stroke) = open.stroke.as_mut().filter(|_| open.start.id == id) else { continue };
                    let mut acts = false;
                    for sample in &samples {
                        acts |= stroke.stroke_to(engine, sample);
                    }
                    if acts {
                        moved = true;
                        // Hair that is brushed is not settled under the brush.
                        (self.preroll, self.settling_pending, self.settings_changed) = (None, false, None);
                        self.report_stroke(false);
                    }
                }
                BrushRequest::End(id) => {
                    if self.brushing.open.as_ref().is_some_and(|open| open.start.id == id) {
                        self.end_open_stroke();
                    }
                }
                BrushRequest::Cancel => {
                    self.brushing.waiting.retain(|request| matches!(request, BrushRequest::Thaw));
                    (self.brushing.open, self.brushing.left) = (None, None);
                }
                BrushRequest::Thaw => self.brushing.frozen.clear(),
            }
        }
        moved
    }

    fn has_layer(&self, layer: u32) -> bool {
        let Some(engine) = &self.engine else { return false };
        engine.scene().source.stack.layer(layer).is_some()
    }

    fn begin_stroke(&mut self, start: Box<StrokeStart>) {
        let Some(engine) = &self.engine else { return };
        let brushing = &mut self.brushing;
        let left = brushing.left.take().filter(|(layer, _)| *layer == start.layer).map(|(_, left)| left);
        let edits = start.edits.clone().or(left).unwrap_or_default();
        brushing.left = Some((start.layer, edits.clone()));
        let stroke = Stroke::begin(engine, &start, edits, &brushing.frozen, &mut brushing.layers);
        brushing.open = Some(Open { start, stroke });
    }

    fn end_open_stroke(&mut self) {
        if self.brushing.open.is_some() {
            self.report_stroke(true);
            self.brushing.open = None;
        }
    }

    /// Tells what the open stroke has done.
    fn report_stroke(&mut self, ended: bool) {
        let brushing = &mut self.brushing;
        let Some(Open { start, stroke }) = &brushing.open else { return };
        let mut frozen = None;
        if let Some(stroke) = stroke {
            brushing.left = Some((start.layer, stroke.edits()));
            if brushing.frozen != stroke.frozen() {
                brushing.frozen = stroke.frozen().to_vec();
                frozen = Some(Arc::from(brushing.frozen.as_slice()));
            }
        }
        let edits = brushing.left.as_ref().map(|(_, left)| left.clone()).unwrap_or_default();
        let brushed = Brushed { stroke: start.id, layer: start.layer, edits, frozen, ended };
        self.outbox.send(Event::Brushed(brushed));
    }
}
