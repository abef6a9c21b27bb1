//! The command palette and the path dialog.

use std::path::{Path, PathBuf};

use super::super::command::{COMMANDS, Command};
use egui::accesskit::Role;
use egui::{Event, Key, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use super::{Shown, double_click, screen_of};
use crate::window::palette::{Found, Palette};
use crate::window::path_dialog::{Answer, PathDialog};
use crate::window::purpose::Purpose;

fn palette() -> Harness<'static, Shown<(Palette, Vec<Command>)>> {
    let mut state = (Palette::default(), Vec::new());
    state.0.toggle();
    screen_of(vec2(800.0, 600.0), state, |ui, (palette, chosen): &mut (Palette, Vec<Command>)| {
        let found = palette.show(ui.ctx(), |command: &Command| *command != Command::Undo);
        chosen.extend(found.and_then(|found| match found {
            Found::Command(info) => Some(info.command.clone()),
            _ => None,
        }));
    })
}

#[test]
fn the_palette_finds_a_command_by_its_words() {
    let mut harness = palette();
    harness.run();
    assert!(harness.query_by_label("Undo").is_none(), "what cannot be done is not offered");
    harness.event(Event::Text("hair fra".to_owned()));
    harness.run();
    assert!(harness.query_by_label(Command::Save.info().expect("in the table").label).is_none());
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(harness.state().state.1, [Command::FrameHair]);
    assert!(
        harness.query_by_label(Command::FrameHair.info().expect("in the table").label).is_none(),
        "it closes"
    );
}

#[test]
fn keys_and_clicks_choose_in_the_palette() {
    let listed: Vec<_> =
        COMMANDS.iter().filter(|info| info.in_palette && info.command != Command::Undo).collect();
    let mut harness = palette();
    harness.run();
    for _ in 0..3 {
        harness.key_press(Key::ArrowDown);
    }
    harness.key_press(Key::ArrowUp);
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(harness.state().state.1, [listed[2].command.clone()]);
    let mut harness = palette();
    harness.run();
    harness.get_by_label(listed[1].label).click();
    harness.run();
    assert_eq!(harness.state().state.1, [listed[1].command.clone()]);
}

#[test]
fn the_palette_closes_without_a_command() {
    let mut harness = palette();
    harness.run();
    harness.event(Event::Text("no such thing".to_owned()));
    harness.key_press(Key::Enter);
    harness.run();
    assert!(
        harness.query_by_label("No command or setting matches.").is_some(),
        "Enter finds nothing and stays"
    );
    harness.key_press(Key::Escape);
    harness.run();
    assert!(harness.query_by_label("No command or setting matches.").is_none());
    assert!(harness.state().state.1.is_empty());
}

fn dialog(purpose: Purpose, suggestion: &Path) -> Harness<'static, Shown<(PathDialog, Option<Answer>)>> {
    let state = (PathDialog::new(purpose, suggestion), None);
    screen_of(vec2(800.0, 600.0), state, |ui, (dialog, answer): &mut (PathDialog, Option<Answer>)| {
        if answer.is_none() {
            let now = dialog.show(ui.ctx());
            *answer = (now != Answer::Pending).then_some(now);
        }
    })
}

/// Replaces the text of the field.
fn retype<S>(harness: &mut Harness<'_, S>, text: &str) {
    harness.get_by_label("Path").click();
    harness.run();
    harness.key_press_modifiers(egui::Modifiers::COMMAND | egui::Modifiers::CTRL, Key::A);
    harness.key_press(Key::Backspace);
    if !text.is_empty() {
        harness.event(Event::Text(text.to_owned()));
    }
    harness.run();
}

#[test]
fn a_typed_path_is_confirmed_by_enter() {
    let mut harness = dialog(Purpose::Film, Path::new("out/dance.mp4"));
    harness.run();
    retype(&mut harness, "a b/ü");
    harness.key_press(Key::Enter);
    harness.run();
    let answer = harness.state().state.1.as_ref();
    let wanted = std::path::absolute("out/a b/ü.mp4").expect("a path");
    assert_eq!(answer, Some(&Answer::Path(Purpose::Film, wanted)));
}

#[test]
fn the_button_confirms_the_suggested_path() {
    let mut harness = dialog(Purpose::SaveProject, Path::new("/somewhere/my hair"));
    harness.run();
    harness.get_by_label("Save file").click();
    harness.run();
    let wanted =
        PathBuf::from(format!("/somewhere/my hair.{}", lovelock_project::project::PROJECT_EXTENSION));
    assert_eq!(harness.state().state.1, Some(Answer::Path(Purpose::SaveProject, wanted)));
}

#[test]
fn dialogs_have_names_for_screen_readers() {
    let mut harness = palette();
    harness.run();
    assert!(harness.query_by_role_and_label(Role::Dialog, "Command palette").is_some());
    let mut harness = dialog(Purpose::Film, Path::new("/out/dance.mp4"));
    harness.run();
    assert!(harness.query_by_role_and_label(Role::Dialog, Purpose::Film.title()).is_some());
}

#[test]
fn a_saved_project_can_be_opened_again() {
    // The extension that the dialog adds is the one that marks a project.
    let path = Path::new("x").with_extension(lovelock_project::project::PROJECT_EXTENSION);
    assert_eq!(
        lovelock_jobs::info::FileKind::by_extension(&path),
        Some(lovelock_jobs::info::FileKind::Project)
    );
}

#[test]
fn a_path_dialog_can_be_cancelled() {
    for escape in [true, false] {
        let mut harness = dialog(Purpose::Open, Path::new("/"));
        harness.run();
        if escape {
            harness.key_press(Key::Escape);
        } else {
            harness.get_by_label("Cancel").click();
        }
        harness.run();
        assert_eq!(harness.state().state.1, Some(Answer::Closed), "escape: {escape}");
    }
}

#[test]
fn typing_replaces_the_name_that_the_dialog_suggests() {
    let mut harness = dialog(Purpose::Film, Path::new("/out/dance.mp4"));
    harness.run();
    harness.event(Event::Text("swing.mp4".to_owned()));
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(harness.state().state.1, Some(Answer::Path(Purpose::Film, PathBuf::from("/out/swing.mp4"))));
}

/// Runs passes until the folder is read, which takes a thread some of them.
fn until_listed(harness: &mut Harness<'_, Shown<(PathDialog, Option<Answer>)>>, name: &str) {
    for _ in 0..10_000 {
        harness.step();
        if harness.query_by_label(name).is_some() {
            return;
        }
        std::thread::yield_now();
    }
    panic!("{name} is not listed");
}

#[test]
fn the_list_is_used_by_the_keyboard() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("hair")).expect("a folder");
    for name in ["hair/curly-1.take", "hair/curly-2.take", "hair/note.txt"] {
        std::fs::write(folder.path().join(name), b"x").expect("a file");
    }
    let mut harness = dialog(Purpose::Beside, &folder.path().join(""));
    until_listed(&mut harness, "hair/");
    // Down to the folder, below the one above; Enter enters it.
    harness.key_press(Key::ArrowDown);
    harness.key_press(Key::ArrowDown);
    harness.key_press(Key::Enter);
    until_listed(&mut harness, "curly-1.take");
    assert!(harness.query_by_label("note.txt").is_none(), "only what can be opened is listed");
    assert_eq!(harness.state().state.1, None);
    // Tab completes what the names share, then chooses; Enter opens.
    harness.event(Event::Text("c".to_owned()));
    harness.run();
    harness.key_press(Key::Tab);
    harness.run();
    harness.event(Event::Text("2".to_owned()));
    harness.run();
    harness.key_press(Key::Tab);
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    let wanted = folder.path().join("hair/curly-2.take");
    assert_eq!(harness.state().state.1, Some(Answer::Path(Purpose::Beside, wanted)));
}

#[test]
fn a_double_click_means_the_row_of_its_first_click() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["a.take", "b.take", "c.take"] {
        std::fs::write(folder.path().join(name), b"x").expect("a file");
    }
    let mut harness = dialog(Purpose::Beside, &folder.path().join(""));
    until_listed(&mut harness, "a.take");
    harness.event(Event::Text("c".to_owned()));
    harness.run();
    assert!(harness.query_by_label("a.take").is_none());
    // The first click fills the field, and then the folder above is the first row.
    let at = harness.get_by_label("c.take").rect().center();
    double_click(&mut harness, at);
    let wanted = folder.path().join("c.take");
    assert_eq!(harness.state().state.1, Some(Answer::Path(Purpose::Beside, wanted)));
}

#[test]
fn a_refused_path_stays_in_the_dialog_with_the_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = dialog(Purpose::Open, &folder.path().join(""));
    harness.run();
    harness.event(Event::Text("missing.take".to_owned()));
    harness.run();
    let before = harness.get_by_label("Open file").rect();
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(harness.state().state.1, None, "it is still open");
    assert!(harness.query_by_label_contains("must be an existing file").is_some());
    assert_eq!(harness.get_by_label("Open file").rect(), before, "the button stays where it was");
    harness.event(Event::Text("2".to_owned()));
    harness.run();
    assert!(harness.query_by_label_contains("must be an existing file").is_none(), "the text is corrected");
}

#[test]
fn another_project_is_replaced_only_after_a_question() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("other.lovelock");
    std::fs::write(&path, b"x").expect("a file");
    let mut harness = dialog(Purpose::SaveProject, &path);
    harness.run();
    assert!(harness.query_by_label_contains("will be replaced").is_some());
    harness.key_press(Key::Enter);
    harness.run();
    assert!(harness.query_by_label_contains("is another project. Replace it?").is_some());
    // Enter takes the safe answer, Escape the question alone.
    harness.key_press(Key::Enter);
    harness.run();
    assert!(harness.query_by_label("Replace").is_none() && harness.state().state.1.is_none());
    harness.get_by_label("Save file").click();
    harness.run();
    harness.key_press(Key::Escape);
    harness.run();
    assert!(harness.query_by_label("Replace").is_none() && harness.state().state.1.is_none());
    harness.get_by_label("Save file").click();
    harness.run();
    harness.get_by_label("Replace").click();
    harness.run();
    assert_eq!(harness.state().state.1, Some(Answer::Path(Purpose::SaveProject, path)));
}

#[test]
fn an_empty_path_is_not_confirmed_and_an_existing_film_is_mentioned() {
    let dir = tempfile::tempdir().expect("a folder");
    let film = dir.path().join("here.mp4");
    std::fs::write(&film, b"x").expect("a file");
    let mut harness = dialog(Purpose::Film, &film);
    harness.run();
    assert!(harness.query_by_label_contains("will be replaced").is_some());
    retype(&mut harness, "");
    assert!(harness.query_by_label_contains("will be replaced").is_none());
    harness.get_by_label("Start recording").click();
    harness.run();
    harness.get_by_label("Path").click();
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(harness.state().state.1, None);
}
