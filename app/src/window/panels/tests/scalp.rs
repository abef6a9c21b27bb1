//! The panel of the scalp.

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use lovelock_motion::ScalpFit;
use lovelock_project::Project;

use super::panel;
use crate::window::pointer_tool::PointerTool;
use crate::window::testing::{control, type_at};

#[test]
fn the_scalp_is_shown_corrected_and_fitted_again() {
    let mut harness = panel("Scalp", Project::default());
    assert!(!harness.state().state.panels.scalp.tool.shown);
    control(&harness, Role::CheckBox, "Paint scalp").click();
    harness.run();
    let bench = &harness.state().state;
    assert!(bench.panels.scalp.tool.shown && bench.tool == PointerTool::Scalp, "what is painted is shown");
    assert!(harness.query_all_by_label("Brush").next().is_some());
    control(&harness, Role::CheckBox, "Show scalp").click();
    harness.run();
    let bench = &harness.state().state;
    assert!(!bench.panels.scalp.tool.shown && bench.tool == PointerTool::Camera, "{:?}", bench.tool);
    let at = control(&harness, Role::SpinButton, "Temples").rect().center();
    type_at(&mut harness, at, "10");
    let fit = harness.state().state.project.body.scalp.clone();
    assert!((fit.raise.temple - 10.0_f32.to_radians()).abs() < 1e-4, "{fit:?}");
    control(&harness, Role::Button, "Fit again").click();
    harness.run();
    assert_eq!(harness.state().state.project.body.scalp, ScalpFit::default());
}
