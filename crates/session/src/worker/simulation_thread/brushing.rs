//! Strokes of brushes on the simulation thread.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use lovelock_base::clock::Stopwatch;
use lovelock_groom::GuideFrame;
use lovelock_project::Project;
use lovelock_style::StyleStack;
use lovelock_style::hand::HandEdits;

use super::super::Event;
use super::super::mailbox::BrushRequest;
use super::SimulationThread;
use crate::engine::{BrushLayers, Engine};
use crate::strokes::{Stroke, StrokeReport, StrokeStart};

/// The most requests that wait for a scene.
const MAX_WAITING: usize = 4096;
/// The longest time for which hair is kept as a stroke has left it until its scene comes, seconds.
const LONGEST_KEPT_SECS: f64 = 20.0;
/// The longest time for which a stroke waits for the scene that has its layer, seconds, and the longest if the project lacks that.
const LONGEST_WAIT_SECS: [f64; 2] = [60.0, 0.25];

/// The strokes of the thread.
#[derive(Debug, Default)]
pub(super) struct Brushing {
    waiting: VecDeque<BrushRequest>,
    /// Since when the first of them waits.
    since: Option<Stopwatch>,
    open: Option<OpenStroke>,
    layers: BrushLayers,
    frozen: Vec<bool>,
    /// The last stroke of each layer, and what it left there.
    left: BTreeMap<u32, (u64, HandEdits)>,
    /// Whether hair fell when the last stroke ended.
    fell: bool,
    /// The last stroke that has ended, until the scene that has all of it is loaded.
    ended: Option<EndedStroke>,
}

/// A stroke that has ended.
#[derive(Debug)]
struct EndedStroke {
    layer: u32,
    stroke: Stroke,
    edits: HandEdits,
    /// Whether the project has had all of it.
    is_known: bool,
    since: Stopwatch,
}

#[derive(Debug)]
struct OpenStroke {
    start: Box<StrokeStart>,
    /// None if the hair cannot be brushed.
    stroke: Option<Stroke>,
}

impl Brushing {
    /// Whether hair is as strokes have left it, and the scene that has all of them is still to come or is this one.
    pub(super) fn awaits(&self) -> bool {
        self.open.is_some() || self.ended.is_some()
    }

    /// Keeps hair where strokes have left it, after a scene was taken. `frame` is the hair before it. Returns whether it stays there; it
    /// does not if the scene lacks what the strokes did, and none that has it is still to come.
    pub(super) fn keep(&mut self, engine: &mut Engine, frame: &GuideFrame) -> bool {
        let stack = &engine.scene().source.stack;
        if let Some(OpenStroke { start, stroke: Some(stroke) }) = &self.open {
            if stack.hand(start.layer) != Some(&stroke.edits()) {
                stroke.hold(engine, frame);
            }
            return true;
        }
        let Some(ended) = &self.ended else { return false };
        let now = stack.hand(ended.layer);
        let has_all = now == Some(&ended.edits);
        if has_all || now.is_none() || ended.since.secs() > LONGEST_KEPT_SECS {
            self.ended = None;
            return has_all;
        }
        ended.stroke.hold(engine, frame);
        true
    }

    /// Takes notice of a project: a stroke that it had and has no longer was undone, and is not waited for.
    pub(super) fn follow(&mut self, project: &Project) {
        if let Some(ended) = &mut self.ended {
            let has_all = project.hair.stack.hand(ended.layer) == Some(&ended.edits);
            ended.is_known |= has_all;
            if ended.is_known && !has_all {
                self.ended = None;
            }
        }
    }

    /// Whether a stroke is being made.
    pub(super) fn is_open(&self) -> bool {
        self.open.is_some()
    }
}

impl SimulationThread {
    /// Applies the requests of brushes, as far as the scene has their layer. Returns whether hair has moved.
    pub(super) fn brush(&mut self, requests: Vec<BrushRequest>) -> bool {
        for request in requests {
            if matches!(request, BrushRequest::Cancel) {
                self.brushing.waiting.retain(|request| matches!(request, BrushRequest::Thaw));
            }
            self.brushing.waiting.push_back(request);
        }
        if self.take.is_some() || self.brushing.waiting.len() > MAX_WAITING {
            self.drop_waiting();
            self.end_open_stroke();
        }
        let mut moved = false;
        while let Some(request) = self.brushing.waiting.pop_front() {
            match request {
                BrushRequest::Begin(start) => {
                    self.end_open_stroke();
                    if self.waits_for(start.layer) {
                        self.brushing.waiting.push_front(BrushRequest::Begin(start));
                        break;
                    }
                    self.brushing.since = None;
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
                    moved |= std::mem::take(&mut self.brushing.fell);
                }
                BrushRequest::Cancel => {
                    moved |= self.take_back_strokes();
                }
                BrushRequest::Thaw => self.brushing.frozen.clear(),
            }
        }
        moved
    }

    /// Whether a stroke has to wait for the scene that has its layer.
    fn waits_for(&mut self, layer: u32) -> bool {
        let Some(engine) = &self.engine else { return false };
        if engine.scene().source.stack.layer(layer).is_some() {
            return false;
        }
        // The project with a new layer comes a little after the stroke.
        let is_there = self.project.as_ref().is_some_and(|of| of.hair.stack.layer(layer).is_some());
        let waited = self.brushing.since.get_or_insert_with(Stopwatch::start).secs();
        waited < LONGEST_WAIT_SECS[usize::from(!is_there)]
    }

    /// Forgets the strokes whose scene has not come, and takes them out of the hair. Returns whether it has changed.
    fn take_back_strokes(&mut self) -> bool {
        let brushing = &mut self.brushing;
        brushing.left.clear();
        brushing.since = None;
        let open = brushing.open.take().and_then(|open| open.stroke);
        let stroke = open.or(brushing.ended.take().map(|ended| ended.stroke));
        let (Some(stroke), Some(engine)) = (stroke, &mut self.engine) else { return false };
        stroke.take_back(engine);
        if !self.playback.is_playing() {
            self.begin_preroll();
        }
        true
    }

    /// Forgets all strokes, after a failure.
    pub(super) fn forget_strokes(&mut self) {
        self.drop_waiting();
        let frozen = std::mem::take(&mut self.brushing.frozen);
        self.brushing = Brushing { frozen, ..Brushing::default() };
    }

    /// Ends all strokes that wait, without what they would have done.
    fn drop_waiting(&mut self) {
        self.brushing.since = None;
        for request in std::mem::take(&mut self.brushing.waiting) {
            if let BrushRequest::Begin(start) = request {
                self.brushing.open = Some(OpenStroke { start, stroke: None });
                self.end_open_stroke();
            }
        }
    }

    /// Whether strokes wait, so that the thread looks again soon.
    pub(super) fn has_waiting_strokes(&self) -> bool {
        !self.brushing.waiting.is_empty()
    }

    fn begin_stroke(&mut self, start: Box<StrokeStart>) {
        let brushing = &mut self.brushing;
        let left = brushing.left.get(&start.layer).filter(|(stroke, _)| start.after == Some(*stroke));
        let edits = left.map_or_else(|| start.edits.clone(), |(_, left)| left.clone());
        brushing.left.insert(start.layer, (start.id, edits.clone()));
        let guides = self.engine.as_ref().map(|engine| engine.scene().style.guides.count());
        if guides != Some(brushing.frozen.len()) {
            // Those of other hair.
            brushing.frozen.clear();
        }
        let stroke = self
            .engine
            .as_ref()
            .and_then(|engine| Stroke::begin(engine, &start, edits, &brushing.frozen, &mut brushing.layers));
        brushing.open = Some(OpenStroke { start, stroke });
    }

    fn end_open_stroke(&mut self) {
        if let Some(open) = &mut self.brushing.open {
            let at_once = self.still || !self.playback.is_playing();
            if let (Some(stroke), Some(engine)) = (&mut open.stroke, &mut self.engine)
                && stroke.let_go(engine, at_once)
            {
                self.brushing.fell = true;
            }
            self.report_stroke(true);
            if let Some(OpenStroke { start, stroke: Some(stroke) }) = self.brushing.open.take() {
                let layer = start.layer;
                let edits = self.brushing.left.get(&layer).map(|(_, left)| left.clone()).unwrap_or_default();
                let has_all = |stack: &StyleStack| stack.hand(layer) == Some(&edits);
                // A stroke beside the hair has done nothing that a scene could bring.
                let is_there =
                    self.engine.as_ref().is_some_and(|engine| has_all(&engine.scene().source.stack));
                let is_known = self.project.as_ref().is_some_and(|project| has_all(&project.hair.stack));
                let since = Stopwatch::start();
                if is_there {
                    self.brushing.ended.take_if(|ended| ended.layer == layer);
                } else {
                    self.brushing.ended = Some(EndedStroke { layer, stroke, edits, is_known, since });
                }
            }
            self.record_change();
        }
    }

    /// Reports what the open stroke has done.
    fn report_stroke(&mut self, ended: bool) {
        let brushing = &mut self.brushing;
        let Some(OpenStroke { start, stroke }) = &brushing.open else { return };
        let mut frozen = None;
        if let Some(stroke) = stroke {
            brushing.left.insert(start.layer, (start.id, stroke.edits()));
            if brushing.frozen != stroke.frozen() {
                brushing.frozen = stroke.frozen().to_vec();
                frozen = Some(Arc::from(brushing.frozen.as_slice()));
            }
        }
        let left = brushing.left.get(&start.layer).filter(|(id, _)| *id == start.id);
        let edits = left.map_or_else(|| start.edits.clone(), |(_, left)| left.clone());
        let brushed = StrokeReport { stroke: start.id, layer: start.layer, edits, frozen, ended };
        self.outbox.send(Event::Brushed(brushed));
    }
}
