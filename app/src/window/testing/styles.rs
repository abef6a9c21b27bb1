//! Hairstyles in the whole window.

use egui::accesskit::Role;
use lovelock_project::styles::{OwnStyles, Style, StyleParts, shipped};

use super::control;
use super::whole::{of, project, wait, window};
use crate::window::Window;
use crate::window::styles::Browser;

#[test]
fn a_style_under_the_pointer_is_shown_and_leaves_no_trace() {
    let mut harness = window();
    let before = project(&harness);
    let few = of(&harness).session.hair.counts;
    let at = control(&harness, Role::RadioButton, "Red curls").rect().center();
    harness.hover_at(at);
    let curly = shipped::by_id("curly").expect("shipped").style.strands();
    let is_shown = move |window: &Window| Some(window.session.hair.counts[1] as u64) == curly;
    wait(&mut harness, "the preview", is_shown);
    assert_eq!(project(&harness), before);
    assert_eq!(of(&harness).document.history().undo_len(), 0);
    assert!(!of(&harness).document.is_modified());
    harness.remove_cursor();
    wait(&mut harness, "the project's own hair", move |window| window.session.hair.counts == few);
    assert!(!of(&harness).document.is_preview());
    assert_eq!(of(&harness).document.history().undo_len(), 0);
}

#[test]
fn a_style_file_is_imported_and_applied() {
    let dir = tempfile::tempdir().expect("a folder");
    let own = OwnStyles::new(dir.path().join("styles"));
    let mut harness = window();
    let ctx = harness.ctx.clone();
    let window = harness.state_mut().state.as_mut().expect("a window");
    window.panels.hair.styles = Browser::new(Some(own.clone()), None, &ctx);
    let before = project(&harness);
    let path = dir.path().join("friend ü.lovelockstyle");
    let style = &shipped::by_id("curly").expect("shipped").style;
    Style { name: "A friend's".to_owned(), ..style.clone() }.save(&path).expect("saved");
    harness.state_mut().state.as_mut().expect("a window").open_any(&path);
    wait(&mut harness, "the style", |window| window.files.openings.running().is_none());
    let after = project(&harness);
    let mut wanted = (*before).clone();
    wanted.apply_style(style, StyleParts::ALL);
    assert_eq!((&after.hair.groom, after.look), (&wanted.hair.groom, wanted.look));
    assert_eq!(after.hair.style, "own/A friend's");
    assert_eq!(of(&harness).document.history().undo_len(), 1);
    assert!(own.folder().join("A friend's.lovelockstyle").is_file());
    // A file that is none changes nothing and is told.
    std::fs::write(&path, "(version: 3, hair: (").expect("a file");
    harness.state_mut().state.as_mut().expect("a window").open_any(&path);
    wait(&mut harness, "the style", |window| window.files.openings.running().is_none());
    assert_eq!(project(&harness), after);
    assert_eq!(own.list().len(), 1);
}
