//! Where the headers of panels are, in the pass that shows them.

use egui::Rect;

/// Where a column and the headers of its panels are.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    /// Not positive if the column is closed.
    pub(crate) rect: Rect,
    pub(crate) headers: Vec<(&'static str, Rect)>,
    /// The end of the last panel.
    pub(crate) end_y: Option<f32>,
}

impl Default for Column {
    fn default() -> Self {
        Self { rect: Rect::NOTHING, headers: Vec::new(), end_y: None }
    }
}
