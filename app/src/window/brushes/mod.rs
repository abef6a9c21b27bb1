//! Brushes: tools that comb the displayed hair during playback.

mod bar;
mod circle;
mod keys;
mod mirror;
mod panel;
mod pointer;
mod strokes;

use std::collections::BTreeMap;

use lovelock_base::settings::{Choices as _, Settings as _};
use lovelock_brush::{BrushMirror, BrushSettings, Tool};
use serde::{Deserialize, Serialize};

pub(in crate::window) use bar::beside_bar;

use super::overlay::pick::SeenHair;
use pointer::PointerStroke;
use strokes::Strokes;

/// What of the brushes is stored between runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Kept {
    /// The settings of tools by their ids; those of the others are the defaults.
    settings: BTreeMap<String, BrushSettings>,
    /// What every tool does on the other side of the head.
    mirror: BrushMirror,
}

impl Kept {
    /// The settings of a tool.
    pub(crate) fn of(&self, tool: Tool) -> BrushSettings {
        let settings = self.settings.get(tool.names().0).cloned().unwrap_or_default();
        BrushSettings { mirror: self.mirror, ..settings }.clamped()
    }

    /// Sets the settings of a tool.
    #[cfg(test)]
    pub(crate) fn set_for_tests(&mut self, tool: Tool, settings: BrushSettings) {
        self.set(tool, settings);
    }

    fn set(&mut self, tool: Tool, settings: BrushSettings) {
        self.mirror = settings.mirror;
        self.settings.insert(tool.names().0.to_owned(), settings);
    }
}

/// The brushes of the window.
#[derive(Default)]
pub(crate) struct Brushes {
    /// The settings of the tools.
    pub(crate) kept: Kept,
    /// The tool.
    pub(crate) tool: Tool,
    /// Whether the hair is shown at rest, without its simulation.
    pub(crate) still: bool,
    /// What was last sent of that.
    sent: Option<bool>,
    /// Whether the pointer was handled in this pass.
    pub(crate) handled: bool,
    held: Option<PointerStroke>,
    /// Whether the stroke of the button that is down was taken back, so that the pointer does nothing more.
    spent: bool,
    resize: Option<keys::Resize>,
    /// The hair of the image.
    pub(crate) seen: SeenHair,
    strokes: Strokes,
}

impl Brushes {
    /// Makes the brush larger or smaller.
    pub(crate) fn scale_radius(&mut self, factor: f32) {
        let settings = self.kept.of(self.tool);
        self.kept.set(self.tool, BrushSettings { radius: settings.radius * factor, ..settings }.clamped());
    }

    /// Tells the simulation whether the hair is shown at rest.
    pub(crate) fn send(&mut self, worker: &lovelock_session::worker::Worker) {
        if self.still != self.sent.unwrap_or_default() {
            self.sent = Some(self.still);
            worker.set_still(self.still);
        }
    }

    /// Whether results of strokes are still on their way.
    #[cfg(test)]
    pub(crate) fn has_open_strokes(&self) -> bool {
        self.held.is_some() || self.strokes.has_open()
    }

    /// The stroke that was made last.
    #[cfg(test)]
    pub(crate) fn last_stroke(&self) -> Option<&lovelock_brush::RecordedStroke> {
        self.strokes.recorded.last()
    }

    /// Whether any lock is protected.
    #[cfg(test)]
    pub(crate) fn has_frozen(&self) -> bool {
        self.strokes.frozen.contains(&true)
    }

    /// Forgets which locks are protected.
    pub(crate) fn forget_frozen(&mut self) {
        self.strokes.frozen = std::sync::Arc::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mirror_holds_for_all_tools_and_the_rest_for_one() {
        let mut kept = Kept::default();
        let mirrored = BrushSettings { mirror: BrushMirror::Same, radius: 0.1, ..kept.of(Tool::Comb) };
        kept.set(Tool::Comb, mirrored);
        let smooth = kept.of(Tool::Smooth);
        assert_eq!(smooth.mirror, BrushMirror::Same);
        assert_eq!(smooth.radius, BrushSettings::default().radius);
        assert_eq!(kept.of(Tool::Comb).radius, 0.1);
    }
}
