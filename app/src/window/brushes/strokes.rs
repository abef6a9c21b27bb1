//! What strokes did, written into the layer of the style.

use std::path::Path;
use std::sync::Arc;

use glam::Affine3A;
use lovelock_base::settings::Choices as _;
use lovelock_brush::{BrushSettings, RecordedStroke, StrokeFile, StrokeSample, Tool};
use lovelock_project::Project;
use lovelock_project::files::write_whole;
use lovelock_project::history::GestureId;
use lovelock_session::strokes::{StrokeReport, StrokeStart};
use lovelock_style::hand::HandEdits;
use lovelock_style::operations::Hand;
use lovelock_style::{Layer, Operation};

use crate::window::{Window, notices};

/// The most samples of all strokes that can be saved: 100 MB, hours of painting.
const MAX_SAMPLES: usize = 1 << 21;

/// Strokes whose results have not all arrived.
#[derive(Debug, Default)]
pub(super) struct Strokes {
    last: u64,
    open: Vec<OpenStroke>,
    /// The label of the stroke that has added a layer in this pass.
    adds: Option<String>,
    /// Which guides are protected.
    pub(super) frozen: Arc<[bool]>,
    /// The stroke that changed that last.
    freezes: Option<u64>,
    /// The strokes of this run, as they can be saved.
    pub(super) recorded: Vec<RecordedStroke>,
    /// The samples of all of them.
    samples: usize,
}

#[derive(Debug)]
struct OpenStroke {
    id: u64,
    layer: u32,
    /// The undo step of the stroke.
    gesture: GestureId,
    tool: Tool,
    /// The layer as it was before the stroke, and as the stroke left it: the stroke ends when something else changes that, such as an undo.
    before: HandEdits,
    left: HandEdits,
    /// The undo step that added the layer, as long as nothing was written into it.
    added: Option<GestureId>,
}

#[cfg(test)]
impl Strokes {
    /// Whether results are still on their way.
    pub(super) fn has_open(&self) -> bool {
        !self.open.is_empty()
    }
}

/// The layer that brushes write to, and whether it is new: the selected one if it is one of theirs, otherwise the last of them, otherwise a
/// new one at the end of the list. `None` if there are too many layers.
pub(super) fn layer_of(project: &mut Project, selected: Option<u32>) -> Option<(u32, bool)> {
    let stack = &mut project.hair.stack;
    let known = stack.hand_layer(selected).map(|layer| (layer, false));
    known.or_else(|| Some((stack.push(Layer::of(Hand::default()))?, true)))
}

/// The label of a stroke's undo step.
fn label_of(tool: Tool) -> String {
    tool.names().1.to_lowercase()
}

impl Window {
    /// The label of the undo step of this pass, if a stroke has added a layer in it.
    pub(in crate::window) fn take_stroke_label(&mut self) -> Option<String> {
        self.panels.brushes.strokes.adds.take()
    }

    /// Begins a stroke in a layer; returns its number.
    pub(super) fn begin_stroke(
        &mut self,
        project: &Project,
        (layer, is_new): (u32, bool),
        (tool, inverted): (Tool, bool),
        settings: BrushSettings,
    ) -> u64 {
        // Each stroke is an undo step of its own, however soon it follows the last one.
        self.document.end_gesture();
        let strokes = &mut self.panels.brushes.strokes;
        let left = project.hair.stack.hand(layer).cloned().unwrap_or_default();
        // What an earlier stroke did may still be on its way: the simulation has it already.
        let last = strokes.open.iter().rev().find(|open| open.layer == layer);
        let (after, added) = (last.map(|open| open.id), last.and_then(|open| open.added));
        strokes.last += 1;
        let id = strokes.last;
        let (edits, before) = (left.clone(), left.clone());
        let gesture = self.document.gesture();
        let added = if is_new { Some(gesture) } else { added };
        if is_new {
            strokes.adds = Some(label_of(tool));
        }
        if strokes.recorded.len() < StrokeFile::MAX_STROKES && strokes.samples < MAX_SAMPLES {
            let settings = settings.clone();
            strokes.recorded.push(RecordedStroke { tool, inverted, settings, samples: Vec::new() });
        }
        strokes.open.push(OpenStroke { id, layer, gesture, tool, before, left, added });
        self.session.worker().begin_stroke(StrokeStart { id, layer, tool, inverted, settings, edits, after });
        id
    }

    /// Moves the brush of a stroke to samples in the space of the head.
    pub(super) fn go_on_with_stroke(
        &mut self,
        id: u64,
        samples: Vec<StrokeSample>,
        world_from_head: &Affine3A,
    ) {
        let strokes = &mut self.panels.brushes.strokes;
        if let Some(stroke) = strokes.recorded.last_mut() {
            let room = StrokeFile::MAX_SAMPLES.saturating_sub(stroke.samples.len());
            let room = room.min(MAX_SAMPLES.saturating_sub(strokes.samples)).min(samples.len());
            strokes.samples += room;
            for sample in samples.iter().take(room) {
                // The time goes back where the dance starts again, and must not in a file.
                let before = stroke.samples.last().map_or(0.0, |last| last.time_secs);
                let time_secs = sample.time_secs.max(before);
                stroke.samples.push(StrokeSample { time_secs, ..sample.placed(world_from_head) });
            }
        }
        self.session.worker().stroke_to(id, samples);
    }

    /// Saves the strokes of this run.
    pub(in crate::window) fn save_strokes(&mut self, path: &Path) -> Result<(), String> {
        let text = StrokeFile::new(self.panels.brushes.strokes.recorded.clone()).to_text()?;
        write_whole(path, text.as_bytes()).map_err(|error| error.to_string())?;
        self.notices.push(notices::Kind::Done, format!("Saved {}", path.display()));
        Ok(())
    }

    /// Writes what the simulation has made of strokes into the project.
    pub(in crate::window) fn take_brushed(&mut self) {
        for brushed in std::mem::take(&mut self.session.brushed) {
            self.write_brushed(brushed);
        }
    }

    /// Forgets the strokes whose results have not arrived.
    pub(in crate::window) fn cancel_strokes(&mut self) {
        self.session.worker().cancel_strokes();
        self.panels.brushes.strokes.open.clear();
        self.panels.brushes.spent |= self.panels.brushes.held.take().is_some();
    }

    fn write_brushed(&mut self, brushed: StrokeReport) {
        let strokes = &mut self.panels.brushes.strokes;
        if let Some(frozen) = brushed.frozen {
            strokes.frozen = frozen;
            strokes.freezes = Some(brushed.stroke);
        }
        let Some(at) = strokes.open.iter().position(|open| open.id == brushed.stroke) else { return };
        let now = self.document.project().hair.stack.hand(brushed.layer);
        if now != Some(&strokes.open[at].left) {
            // An undo or another edit: what the stroke does from now on is lost with it.
            self.cancel_strokes();
            return;
        }
        let (gesture, label) = (strokes.open[at].gesture, label_of(strokes.open[at].tool));
        let acts = strokes.open[at].before != brushed.edits;
        let is_new = strokes.open[at].left != brushed.edits;
        if is_new {
            self.session.inputs.brushed(brushed.layer, &brushed.edits);
        }
        if brushed.ended && !acts && !is_new {
            let open = strokes.open.remove(at);
            return self.end_without_change(&open);
        }
        for open in strokes.open.iter_mut().filter(|open| open.layer == brushed.layer) {
            open.left = brushed.edits.clone();
            open.added = open.added.filter(|_| !acts);
            if open.id != brushed.stroke {
                // A later stroke begins with it.
                open.before = brushed.edits.clone();
            }
        }
        if brushed.ended {
            strokes.open.remove(at);
        }
        let mut project = (**self.document.project()).clone();
        if let Some(layer) = project.hair.stack.layer_mut(brushed.layer) {
            layer.operation = Operation::Hand(Hand { edits: brushed.edits });
        }
        self.document.edit_in(gesture, &label, project);
    }

    /// Ends a stroke that has written nothing: it makes no undo step, and a layer that was added for it is removed.
    fn end_without_change(&mut self, stroke: &OpenStroke) {
        let strokes = &self.panels.brushes.strokes;
        let is_last = strokes.open.iter().all(|open| open.layer != stroke.layer);
        if let Some(added) = stroke.added.filter(|_| is_last) {
            self.document.take_back_gesture(added);
        }
        if stroke.tool == Tool::Freeze && self.panels.brushes.strokes.freezes == Some(stroke.id) {
            return;
        }
        let held = if self.panels.brushes.strokes.frozen.contains(&true) && stroke.tool != Tool::Freeze {
            " Frozen locks stay as they are."
        } else {
            ""
        };
        let what =
            if stroke.tool == Tool::Freeze { "freezes or unfreezes no lock" } else { "changes no hair" };
        self.notices.push(notices::Kind::Warning, format!("The stroke {what}.{held}"));
    }
}
