//! What screen readers say besides the names of controls: values with their units, ranges, and the names of parts of the window.

use egui::accesskit::Role;
use egui::{Id, Response, Ui};

/// How many of the newest widgets may hold the number field of a slider that was just shown.
const NEWEST: usize = 8;

/// Names the part of the window that `ui` shows.
pub(crate) fn spoken_part(ui: &Ui, title: &str) {
    ui.ctx().accesskit_node_builder(ui.unique_id(), |node| {
        node.set_role(Role::Group);
        node.set_label(title);
    });
}

/// Gives a control that is painted here, such as a lane, the value of a slider.
pub(crate) fn spoken_value(response: &Response, value: f64, range: [f64; 2], text: impl FnOnce() -> String) {
    response.ctx.accesskit_node_builder(response.id, |node| {
        node.set_numeric_value(value);
        node.set_min_numeric_value(range[0]);
        node.set_max_numeric_value(range[1]);
        node.set_value(text());
    });
}

/// Gives the number field of a slider that was just shown the `range` of what can be typed, which egui leaves open, and its rail the text
/// with the unit.
pub(super) fn spoken_slider(ui: &Ui, slider: &Response, range: [f64; 2], text: impl FnOnce() -> String) {
    let Some(field) = field_of(ui, slider) else { return };
    ui.ctx().accesskit_node_builder(field, |node| {
        node.set_min_numeric_value(range[0]);
        node.set_max_numeric_value(range[1]);
    });
    // The response is that of the field while that has the focus.
    if field != slider.id {
        ui.ctx().accesskit_node_builder(slider.id, |node| node.set_value(text()));
    }
}

/// The number field beside the rail of a slider; `None` while no screen reader listens.
fn field_of(ui: &Ui, slider: &Response) -> Option<Id> {
    ui.ctx().viewport(|viewport| {
        let nodes = &viewport.this_pass.accesskit_state.as_ref()?.nodes;
        let (_, widgets) =
            viewport.this_pass.widgets.layers().find(|(layer, _)| **layer == slider.layer_id)?;
        let belongs = |id: &Id| {
            nodes.get(id).is_some_and(|node| {
                let is_its = *id == slider.id || node.labelled_by().contains(&slider.id.accesskit_id());
                node.role() == Role::SpinButton && is_its
            })
        };
        widgets.iter().rev().take(NEWEST).map(|widget| widget.id).find(belongs)
    })
}
