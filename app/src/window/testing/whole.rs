//! The whole window, with simulation and rendering. It needs neither a display nor a graphics card.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, ViewportCommand, ViewportEvent, ViewportId, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use lovelock_groom::Preset;
use lovelock_project::Project;
use lovelock_project::error::Place;
use lovelock_project::project::{PROJECT_EXTENSION, load_project};
use lovelock_render::{Backend, StrandCount};
use lovelock_testkit::wait::wait_until;

use super::super::command::Command;
use super::keyboard::entry;
use super::{Shown, control, controls, drag, screen_of};
use crate::window::begin::Opened;
use crate::window::page::Page;
use crate::window::pointer_tool::PointerTool;
use crate::window::{Layout, Window};

/// The window on an off-screen display.
pub(super) type Whole = Harness<'static, Shown<Option<Window>>>;

pub(super) const CTRL: Modifiers = Modifiers { ctrl: true, command: true, ..Modifiers::NONE };

/// The window with a project of few strands, after its scene is loaded, paused at the start of the dance. The processor draws small images:
/// what the window does with an image does not depend on its size, and software drivers of a graphics card take seconds to start.
pub(super) fn window() -> Whole {
    window_of(Backend::Cpu, false)
}

/// [`window`] while the dance plays.
pub(super) fn playing_window() -> Whole {
    window_of(Backend::Cpu, true)
}

/// [`window`] with images of another backend, which plays or is paused.
fn window_of(backend: Backend, playing: bool) -> Whole {
    let mut project = Project::default();
    project.picture.backend = backend;
    project.picture.strands = StrandCount::Stored;
    project.timeline.preroll_secs = 0.1;
    project.hair.groom.wisps = 16;
    project.hair.groom.strands_per_wisp = 8;
    project.shadow.voxel_map.resolution = 32;
    project.shadow.opacity_maps.resolution = 64;
    project.shadow.deep_opacity_maps.resolution = 64;
    project.shadow.density_clustering.resolution = 64;
    project.shadow.occupancy_maps.resolution = 64;
    project.shadow.exact.resolution = 64;
    let mut opened = Some(Opened { project, ..Opened::default() });
    let mut harness = screen_of(vec2(1200.0, 900.0), None, move |ui, window: &mut Option<Window>| {
        let window = window.get_or_insert_with(|| {
            let layout = Layout { view_scale: 0.25, ..Layout::default() };
            let opened = opened.take().unwrap_or_default();
            let mut window = Window::start(ui.ctx(), layout, opened).expect("the threads start");
            window.session.set_playing(playing);
            window
        });
        window.pass(ui);
    });
    wait(&mut harness, "the scene", |window| window.session.scene.is_some());
    harness
}

pub(super) fn of<'h>(harness: &'h Harness<'_, Shown<Option<Window>>>) -> &'h Window {
    harness.state().state.as_ref().expect("a window")
}

pub(super) fn project(harness: &Harness<'_, Shown<Option<Window>>>) -> Arc<Project> {
    Arc::clone(of(harness).document.project())
}

/// Runs passes until a condition holds.
pub(super) fn wait(
    harness: &mut Harness<'_, Shown<Option<Window>>>,
    what: &str,
    is_so: impl Fn(&Window) -> bool,
) {
    if !is_so(of(harness)) {
        wait_until(what, || {
            harness.step();
            is_so(of(harness))
        });
    }
    harness.run_steps(2);
}

/// Runs a few passes, because the window never comes to rest during playback.
pub(super) fn go(harness: &mut Harness<'_, Shown<Option<Window>>>) {
    harness.run_steps(6);
}

pub(super) fn key(harness: &mut Harness<'_, Shown<Option<Window>>>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    go(harness);
}

pub(super) fn press_button(harness: &mut Harness<'_, Shown<Option<Window>>>, name: &str) {
    control(harness, Role::Button, name).click();
    go(harness);
}

/// Chooses a command from its menu.
fn menu(harness: &mut Harness<'_, Shown<Option<Window>>>, command: &Command) {
    let info = command.info().expect("in the table");
    press_button(harness, info.group.label());
    entry(harness, info).click();
    go(harness);
}

/// Fills in the path dialog and confirms it.
pub(super) fn answer(harness: &mut Harness<'_, Shown<Option<Window>>>, path: &Path) {
    harness.get_by_label("Path").click();
    go(harness);
    harness.key_press_modifiers(CTRL, Key::A);
    harness.event(Event::Text(path.display().to_string()));
    harness.key_press(Key::Enter);
    go(harness);
}

/// Drops a file on the window.
#[derive(Debug)]
pub(super) struct Dropped(pub(super) PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("the window reads by path".to_owned())
    }
}

#[test]
fn changes_by_menu_and_key_can_be_undone() {
    let mut harness = window();
    harness.check_accessibility();
    let before = project(&harness);
    menu(&mut harness, &Command::Load(Preset::Curly));
    assert_eq!(project(&harness).hair.preset, Preset::Curly, "the menu's change stays");
    assert_eq!(of(&harness).document.history().undo_len(), 1);
    menu(&mut harness, &Command::Undo);
    assert_eq!(project(&harness), before);
    assert_eq!(of(&harness).document.history().redo_len(), 1, "what was undone can be done again");
    key(&mut harness, CTRL | Modifiers::SHIFT, Key::Z);
    assert_eq!(project(&harness).hair.preset, Preset::Curly);
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), before);

    // A drag on a slider of a panel in the whole window.
    let rail = control(&harness, Role::Slider, "Length").rect();
    drag(&mut harness, rail.left_center(), rail.right_center());
    go(&mut harness);
    assert_ne!(project(&harness).hair, before.hair);
    assert_eq!(of(&harness).document.history().undo_len(), 1);
    assert_eq!(of(&harness).document.history().undo_label(), Some("hairstyle"));
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), before);

    // The palette runs the same command as the menu.
    key(&mut harness, CTRL, Key::K);
    harness.event(Event::Text("golden waves".to_owned()));
    harness.key_press(Key::Enter);
    go(&mut harness);
    assert_eq!(project(&harness).hair.preset, Preset::Long);
    go(&mut harness);
    assert_eq!(of(&harness).document.history().undo_len(), 1, "passes alone change nothing");
}

#[test]
fn keys_pause_playback_and_hide_the_panels() {
    let mut harness = playing_window();
    let names = |harness: &Harness<'_, _>| controls(harness, Role::Slider).len();
    assert!(of(&harness).session.playing && names(&harness) > 10);
    key(&mut harness, Modifiers::NONE, Key::Tab);
    let left: Vec<_> = controls(&harness, Role::Slider).into_iter().map(|(name, _)| name).collect();
    assert_eq!(left, ["Time", "In point", "Out point"], "only the timeline is left");
    key(&mut harness, Modifiers::NONE, Key::Space);
    assert!(!of(&harness).session.playing, "Space pauses with the panels hidden");
    key(&mut harness, Modifiers::NONE, Key::Tab);
    assert!(names(&harness) > 10);
    let step = of(&harness).session.frame.as_ref().map(|frame| frame.position_secs);
    key(&mut harness, Modifiers::NONE, Key::ArrowRight);
    wait(&mut harness, "the next frame", |window| {
        window.session.frame.as_ref().map(|frame| frame.position_secs) > step
    });
    key(&mut harness, Modifiers::SHIFT, Key::Questionmark);
    assert!(harness.query_by_label_contains("Open the menu of a control").is_some());
    key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.query_by_label_contains("Open the menu of a control").is_none());
    key(&mut harness, Modifiers::SHIFT, Key::Questionmark);
    press_button(&mut harness, "Close");
    assert!(harness.query_by_label_contains("Open the menu of a control").is_none());
    let looping = project(&harness).motion.looping;
    press_button(&mut harness, Command::PlayPause.info().expect("in the table").label);
    assert!(of(&harness).session.playing);
    key(&mut harness, Modifiers::NONE, Key::L);
    assert_eq!(project(&harness).motion.looping, !looping);
}

#[test]
fn the_image_follows_the_timeline_and_the_hair_while_paused() {
    let mut harness = window_of(Backend::default(), false);
    let position = |window: &Window| window.session.frame.as_ref().map_or(-1.0, |frame| frame.position_secs);
    let drawn = |window: &Window| match (&window.session.drawn, &window.session.frame) {
        (Some(drawn), Some(frame)) => Arc::ptr_eq(&drawn.snapshot, frame),
        _ => false,
    };
    wait(&mut harness, "an image", drawn);
    let step = |window: &Window| window.session.frame.as_ref().map(|frame| frame.step);
    let before = step(of(&harness));
    for to in [Key::End, Key::ArrowLeft, Key::Home] {
        let there = position(of(&harness));
        key(&mut harness, Modifiers::NONE, to);
        wait(&mut harness, "the jump", |window| position(window).to_bits() != there.to_bits());
        assert!(drawn(of(&harness)), "{to:?}: the picture is of another time than the timeline");
    }
    assert_eq!(step(of(&harness)), before, "none of these lets time pass");
    let style = of(&harness).session.frame.as_ref().map(|frame| Arc::as_ptr(&frame.scene));
    key(&mut harness, Modifiers::ALT, Key::Num2);
    wait(&mut harness, "other hair", |window| {
        window.session.frame.as_ref().map(|frame| Arc::as_ptr(&frame.scene)) != style
    });
    assert!(drawn(of(&harness)), "the picture has the hair of before");
}

#[test]
fn projects_are_saved_and_opened_and_unsaved_changes_are_kept() {
    let mut harness = window();
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("mein Projekt ü").with_extension(PROJECT_EXTENSION);
    key(&mut harness, Modifiers::ALT, Key::Num2);
    assert!(of(&harness).document.is_modified());
    key(&mut harness, CTRL, Key::S);
    answer(&mut harness, &path.with_extension(""));
    assert!(path.is_file(), "the ending was added");
    assert!(!of(&harness).document.is_modified());
    assert_eq!(of(&harness).layout.recent, std::slice::from_ref(&path));
    let (saved, problems) = load_project(&path).expect("a project");
    assert!(problems.is_empty() && saved == *project(&harness), "{problems:?}");

    key(&mut harness, Modifiers::ALT, Key::Num3);
    let changed = project(&harness);
    key(&mut harness, CTRL, Key::N);
    press_button(&mut harness, "Cancel");
    assert_eq!(project(&harness), changed);
    // Closing the window asks as well.
    let viewport = harness.input_mut().viewports.entry(ViewportId::ROOT).or_default();
    viewport.events.push(ViewportEvent::Close);
    harness.step();
    let commands = &harness.output().viewport_output[&ViewportId::ROOT].commands;
    assert!(commands.contains(&ViewportCommand::CancelClose), "{commands:?}");
    harness.input_mut().viewports.entry(ViewportId::ROOT).or_default().events.clear();
    go(&mut harness);
    press_button(&mut harness, "Cancel");
    key(&mut harness, CTRL, Key::N);
    press_button(&mut harness, "Discard changes");
    assert_eq!(*project(&harness), Project::default());

    key(&mut harness, CTRL, Key::O);
    answer(&mut harness, &path);
    wait(&mut harness, "the project", |window| window.files.openings.running().is_none());
    assert_eq!(*project(&harness), saved);
    assert_eq!(of(&harness).document.path(), Some(path.as_path()));
    assert_eq!(of(&harness).document.history().undo_len(), 0);
}

#[test]
fn a_broken_hair_file_is_reported_and_the_scene_stays() {
    let mut harness = window();
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("cut.hair");
    std::fs::write(&path, b"HAIR and nothing of it").expect("a file");
    let strands = of(&harness).session.scene.as_ref().map(|scene| scene.style.strands.count());
    let before = project(&harness);
    harness.input_mut().dropped_files.push(Arc::new(Dropped(path.clone())));
    go(&mut harness);
    wait(&mut harness, "the error", |window| !window.notices.errors().is_empty());
    let error = of(&harness).notices.errors()[0].to_owned();
    assert!(error.contains("cut.hair"), "{error}");
    go(&mut harness);
    assert!(harness.query_by_label(&error).is_some(), "it is seen whatever is open");
    assert_eq!(project(&harness), before, "the file is not in the project");
    wait(&mut harness, "the project before", |window| window.session.problems.is_empty());
    assert_eq!(of(&harness).session.scene.as_ref().map(|scene| scene.style.strands.count()), strands);

    // A project keeps the file that it names; the section marks it.
    let window = harness.state_mut().state.as_mut().expect("a window");
    window.session.pick(&path);
    window.change("hair", |project| project.set_hair_file(&path));
    wait(&mut harness, "the problem", |window| !window.session.problems.is_empty());
    let problem = of(&harness).session.problems[0].clone();
    assert_eq!(problem.place, Place::Hair);
    go(&mut harness);
    assert!(harness.query_by_label(&format!("Problem: {}", problem.message)).is_some());
    assert!(project(&harness).hair.file.is_some());
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), before);
    wait(&mut harness, "the end of the error", |window| window.session.problems.is_empty());

    // An unknown file changes nothing.
    let note = dir.path().join("notes.txt");
    std::fs::write(&note, b"words").expect("a file");
    for path in [note, dir.path().join("no such.hair"), dir.path().to_owned()] {
        harness.input_mut().dropped_files.push(Arc::new(Dropped(path)));
        go(&mut harness);
        wait(&mut harness, "the refusal", |window| window.files.openings.running().is_none());
        assert_eq!(project(&harness), before);
    }
}

#[test]
fn a_dropped_sound_plays_beside_the_dance_and_one_that_is_none_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("clicks ü.wav");
    lovelock_testkit::click_track(&path, 4);
    let mut harness = window();
    let open = |harness: &mut Harness<'_, Shown<Option<Window>>>, path: &Path| {
        harness.state_mut().state.as_mut().expect("a window").open_any(path);
    };
    open(&mut harness, &path);
    wait(&mut harness, "the sound", |window| window.media.soundtrack.loaded().is_some());
    let loaded = Arc::clone(of(&harness).media.soundtrack.loaded().expect("a sound"));
    assert!((loaded.beats.tempo.expect("a tempo") - 120.0).abs() < 1.0, "{:?}", loaded.beats);
    assert_eq!(project(&harness).sound.file.as_ref().expect("a file").path, path);
    assert!(harness.query_by_role_and_label(Role::Slider, "Sound on the timeline").is_some());
    // Undo returns to silence, redo to the sound, without asking for the file again.
    harness.key_press_modifiers(CTRL, Key::Z);
    harness.run_steps(3);
    assert!(project(&harness).sound.file.is_none() && of(&harness).media.soundtrack.loaded().is_none());

    let bad = folder.path().join("bad.wav");
    std::fs::write(&bad, b"RIFF\0\0\0\0WAVE and nothing more").expect("a file");
    open(&mut harness, &bad);
    let told = |window: &Window| window.notices.errors().iter().any(|error| error.contains("bad.wav"));
    wait(&mut harness, "the problem", told);
    let errors = of(&harness).notices.errors();
    assert!(errors[0].contains("the dance is silent") && errors[0].lines().count() == 1, "{errors:?}");
    assert!(project(&harness).sound.file.is_none(), "it leaves the project");
}

#[test]
fn a_dialog_holds_the_keyboard_until_it_is_answered() {
    let mut harness = playing_window();
    let state = |harness: &Harness<'_, Shown<Option<Window>>>| {
        let window = of(harness);
        (window.layout.page, window.tools.active, window.document.overdub().is_armed())
    };
    let before = state(&harness);
    // The keys come in the same pass as the one that opens the dialog, and after its text is refused.
    harness.key_press_modifiers(CTRL, Key::O);
    let letters = [Key::N, Key::C, Key::X, Key::W, Key::R, Key::H, Key::Space];
    for letter in letters {
        harness.key_press(letter);
    }
    go(&mut harness);
    harness.event(Event::Text("/no such folder/nxwr.take".to_owned()));
    harness.key_press(Key::Enter);
    go(&mut harness);
    assert!(harness.query_by_label_contains("must be an existing file").is_some());
    for letter in letters {
        harness.key_press(letter);
    }
    go(&mut harness);
    assert!(of(&harness).files.dialog.is_some() && of(&harness).session.playing);
    assert_eq!(state(&harness), before);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(of(&harness).files.dialog.is_none());
    // The control: without a dialog the same key works.
    key(&mut harness, Modifiers::NONE, Key::X);
    assert_eq!(of(&harness).tools.active, PointerTool::Scissors);

    // The list of keys and the palette hold it too, and close by the key that opened them.
    for (modifiers, opens) in [(Modifiers::SHIFT, Key::Questionmark), (CTRL, Key::K)] {
        let is_open = |harness: &Harness<'_, Shown<Option<Window>>>| {
            of(harness).help.keys_shown || of(harness).keyboard.palette.is_open()
        };
        key(&mut harness, modifiers, opens);
        assert!(is_open(&harness));
        key(&mut harness, CTRL, Key::N);
        key(&mut harness, Modifiers::NONE, Key::N);
        assert!(
            is_open(&harness)
                && of(&harness).files.pending.is_none()
                && of(&harness).layout.page == Page::Image
        );
        key(&mut harness, modifiers, opens);
        assert!(!is_open(&harness));
    }
}

#[test]
fn enter_answers_the_question_on_unsaved_changes_and_what_waited_goes_on() {
    let mut harness = window();
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("hair").with_extension(PROJECT_EXTENSION);
    key(&mut harness, Modifiers::ALT, Key::Num2);
    key(&mut harness, CTRL, Key::N);
    key(&mut harness, Modifiers::NONE, Key::Enter);
    assert!(of(&harness).files.pending.is_none() && of(&harness).files.dialog.is_some(), "it saves");
    answer(&mut harness, &path);
    assert!(path.is_file());
    assert_eq!(*project(&harness), Project::default(), "the new project follows");
}
