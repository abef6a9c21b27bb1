use egui::accesskit::Role;
use egui::{Modifiers, PointerButton};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use lovelock_project::Project;
use lovelock_project::document::Document;
use lovelock_project::styles::{OwnStyles, Style, StyleParts, shipped};
use lovelock_testkit::wait::wait_until;

use super::{Browser, Kept};
use crate::window::command::Command;
use crate::window::gesture::Gestures;
use crate::window::testing::{Shown, click, control, screen, tooltip_at};

/// The browser with the window's handling of edits.
struct Edited {
    document: Document,
    gestures: Gestures,
    browser: Browser,
    requests: Vec<Command>,
}

type Shelf = Harness<'static, Shown<Edited>>;

fn shelf(own: Option<(OwnStyles, std::path::PathBuf)>) -> Shelf {
    let state = Edited {
        document: Document::new(Project::default(), None),
        gestures: Gestures::default(),
        browser: Browser::default(),
        requests: Vec::new(),
    };
    let mut own = own;
    screen(state, move |ui, edited: &mut Edited| {
        if let Some((own, cache)) = own.take() {
            edited.browser = Browser::new(Some(own), Some(cache), ui.ctx());
        }
        if !edited.gestures.continues(ui.ctx(), false) {
            edited.document.end_gesture();
        }
        let mut project = (**edited.document.project()).clone();
        let asked = super::ui(ui, &mut project, &mut edited.browser);
        edited.requests.extend(asked);
        edited.document.edit("style", project);
    })
}

fn names(harness: &Shelf) -> Vec<String> {
    let tiles = crate::window::testing::controls(harness, Role::RadioButton);
    tiles.into_iter().map(|(name, _)| name).collect()
}

fn tile(harness: &Shelf, name: &str) -> egui::Pos2 {
    control(harness, Role::RadioButton, name).rect().center()
}

fn project(harness: &Shelf) -> Project {
    (**harness.state().state.document.project()).clone()
}

#[test]
fn a_style_is_found_and_applied_by_keys_alone() {
    let mut harness = shelf(None);
    control(&harness, Role::TextInput, "Search styles").click();
    harness.run();
    harness.event(egui::Event::Text("bob".to_owned()));
    harness.run();
    let first = names(&harness)[0].clone();
    assert!(first.to_lowercase().contains("bob"), "{:?}", names(&harness));
    harness.key_press(egui::Key::Enter);
    harness.run();
    let wanted = shipped().iter().find(|style| style.style.name == first).expect("a shipped style").id;
    assert_eq!(super::current(&project(&harness)), Some(wanted));
    // Escape clears the search; the pictures are reached and moved through by the arrow keys, which scroll to them.
    harness.key_press(egui::Key::Escape);
    harness.run();
    let all = names(&harness);
    assert_eq!(all.len(), shipped().len());
    control(&harness, Role::TextInput, "Search styles").click();
    harness.run();
    harness.key_press(egui::Key::ArrowDown);
    harness.run();
    for _ in 0..6 {
        harness.key_press(egui::Key::ArrowDown);
        harness.run_steps(4);
    }
    harness.key_press(egui::Key::ArrowRight);
    harness.run_steps(30);
    let wanted = &all[3 * 6 + 1];
    let node = control(&harness, Role::RadioButton, wanted);
    assert!(node.is_focused(), "{wanted}");
    let (rect, search) = (node.rect(), control(&harness, Role::TextInput, "Search styles").rect());
    assert!(rect.top() > search.bottom() && rect.bottom() < search.bottom() + 560.0, "{rect}");
    harness.key_press(egui::Key::Enter);
    harness.run();
    assert_eq!(&shipped()[3 * 6 + 1].style.name, wanted);
    assert_eq!(super::current(&project(&harness)), Some(shipped()[3 * 6 + 1].id));
}

#[test]
fn the_search_and_the_filters_find_styles() {
    let mut harness = shelf(None);
    assert_eq!(names(&harness).len(), shipped().len());
    control(&harness, Role::TextInput, "Search styles").click();
    harness.run();
    harness.event(egui::Event::Text("red cur".to_owned()));
    harness.run();
    assert_eq!(names(&harness), ["Red curls"]);
    harness.state_mut().state.browser.search.typed = "no such style".to_owned();
    harness.run();
    assert!(names(&harness).is_empty());
    assert!(harness.query_by_label_contains("Clear the search").is_some());
    harness.state_mut().state.browser.search.clear();
    harness.run();
    control(&harness, Role::Button, "tied").click();
    harness.run();
    let tied = names(&harness);
    assert!(tied.contains(&"Ponytail".to_owned()) && !tied.contains(&"Red curls".to_owned()), "{tied:?}");
    control(&harness, Role::Button, "tied").click();
    harness.run();
    assert_eq!(names(&harness).len(), shipped().len());
}

#[test]
fn a_click_applies_a_style_in_one_undo_step() {
    let mut harness = shelf(None);
    let before = project(&harness);
    let at = tile(&harness, "Red curls");
    click(&mut harness, at);
    harness.remove_cursor();
    harness.run();
    let style = &shipped::by_id("curly").expect("shipped").style;
    let mut wanted = before.clone();
    wanted.apply_style(style, StyleParts::ALL);
    assert_eq!(project(&harness), wanted);
    let document = &mut harness.state_mut().state.document;
    assert_eq!(document.history().undo_len(), 1);
    document.undo();
    assert_eq!(project(&harness), before);
}

#[test]
fn colour_alone_leaves_the_shape() {
    let mut harness = shelf(None);
    let before = project(&harness);
    for part in ["Shape", "Motion"] {
        control(&harness, Role::Button, part).click();
        harness.run();
    }
    let at = tile(&harness, "Red curls");
    click(&mut harness, at);
    let after = project(&harness);
    assert_eq!((&after.hair, after.simulation), (&before.hair, before.simulation));
    assert_ne!(after.look, before.look);
    // The menu of a tile applies a part whatever the toggles are.
    let event = |pressed| egui::Event::PointerButton {
        pos: at,
        button: PointerButton::Secondary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.event(event(true));
    harness.event(event(false));
    harness.run();
    control(&harness, Role::Button, "Apply motion").click();
    harness.run();
    let moved = project(&harness);
    assert_eq!(moved.hair, before.hair);
    assert_ne!(moved.simulation, before.simulation);
}

#[test]
fn a_style_is_previewed_after_a_rest_of_the_pointer() {
    let mut harness = shelf(None);
    let before = project(&harness);
    let preview = |harness: &Shelf| harness.state().state.browser.preview.clone();
    let at = tile(&harness, "Red curls");
    harness.hover_at(at);
    harness.step();
    assert_eq!(preview(&harness), None, "not while the pointer passes over");
    harness.run_steps(20);
    assert_eq!(preview(&harness).as_deref(), Some("curly"));
    assert_eq!((project(&harness), harness.state().state.document.history().undo_len()), (before, 0));
    click(&mut harness, at);
    harness.run_steps(20);
    assert_eq!(preview(&harness), None, "it is applied");
    harness.remove_cursor();
    harness.run_steps(4);
    harness.hover_at(at);
    harness.run_steps(20);
    assert_eq!(preview(&harness).as_deref(), Some("curly"), "again");
    harness.remove_cursor();
    harness.run_steps(4);
    assert_eq!(preview(&harness), None);
}

#[test]
fn favourites_are_kept_and_shown_alone() {
    let mut harness = shelf(None);
    let at = tile(&harness, "Red curls");
    harness.hover_at(at);
    harness.run_steps(2);
    let star = control(&harness, Role::CheckBox, "Favourite Red curls").rect().center();
    click(&mut harness, star);
    assert_eq!(harness.state().state.document.history().undo_len(), 0, "a star applies nothing");
    control(&harness, Role::Button, "Favourites only").click();
    harness.run();
    assert_eq!(names(&harness), ["Red curls"]);
    let kept = harness.state().state.browser.kept.clone();
    let text = serde_json::to_string(&kept).expect("text");
    assert_eq!(serde_json::from_str::<Kept>(&text).expect("what is kept"), kept);
    assert_eq!(serde_json::from_str::<Kept>("{}").expect("nothing"), Kept::default());
}

/// Runs passes until a condition holds.
fn wait(harness: &mut Shelf, what: &str, is_so: impl Fn(&Shelf) -> bool) {
    wait_until(what, || {
        harness.step();
        is_so(harness)
    });
    harness.run_steps(2);
}

#[test]
fn own_styles_are_saved_renamed_and_deleted() {
    let dir = tempfile::tempdir().expect("a folder");
    let own = OwnStyles::new(dir.path().join("styles"));
    std::fs::create_dir(own.folder()).expect("a folder");
    std::fs::write(own.folder().join("cut.lovelockstyle"), "(version: 3, hair: (").expect("a file");
    let mut harness = shelf(Some((own.clone(), dir.path().join("cache"))));
    wait(&mut harness, "the broken file", |harness| !harness.state().state.browser.broken.is_empty());
    assert!(harness.query_by_label_contains("cut.lovelockstyle: line 1").is_some());
    let mut project = Project::default();
    (project.hair.groom.wisps, project.hair.groom.strands_per_wisp) = (20, 3);
    harness.state_mut().state.document.change("few", |now| *now = project.clone());
    harness.run_steps(2);
    control(&harness, Role::Button, "Save as style…").click();
    harness.run_steps(3);
    harness.event(egui::Event::Text("Few hairs".to_owned()));
    harness.run_steps(2);
    control(&harness, Role::Button, "Save style").click();
    harness.run_steps(3);
    let requests = std::mem::take(&mut harness.state_mut().state.requests);
    assert!(matches!(&requests[..], [Command::Report(_)]), "{requests:?}");
    wait(&mut harness, "the style", |harness| names(harness).contains(&"Few hairs".to_owned()));
    assert_eq!(self::project(&harness).hair.style, "own/Few hairs", "the hair has the style from now on");
    let path = own.folder().join("Few hairs.lovelockstyle");
    let style = Style::load(&path).expect("a style").0;
    assert_eq!(style, Style { name: "Few hairs".to_owned(), ..Style::of_project(&project) });
    // Its picture is drawn and kept.
    wait(&mut harness, "the picture", |harness| {
        harness.state().state.browser.pictures.contains_key("own/Few hairs")
    });
    assert_eq!(std::fs::read_dir(dir.path().join("cache")).expect("a folder").count(), 1);
    harness.state_mut().state.browser.dialog =
        Some(super::Dialog::Delete { path: path.clone(), name: "Few hairs".to_owned() });
    harness.run_steps(3);
    control(&harness, Role::Button, "Cancel").click();
    harness.run_steps(3);
    assert!(path.exists(), "it asks first");
    harness.state_mut().state.browser.dialog =
        Some(super::Dialog::Rename { path: path.clone(), name: "Bald".to_owned() });
    harness.run_steps(3);
    control(&harness, Role::Button, "Rename style").click();
    wait(&mut harness, "the new name", |harness| names(harness).contains(&"Bald".to_owned()));
    let path = own.folder().join("Bald.lovelockstyle");
    harness.state_mut().state.browser.dialog =
        Some(super::Dialog::Delete { path: path.clone(), name: "Bald".to_owned() });
    harness.run_steps(3);
    control(&harness, Role::Button, "Delete style").click();
    wait(&mut harness, "the end of it", |harness| !names(harness).contains(&"Bald".to_owned()));
    assert!(!path.exists());
}

#[test]
fn tiles_say_what_they_are() {
    let mut harness = shelf(None);
    let at = tile(&harness, "Red curls");
    let said = tooltip_at(&mut harness, at).expect("a tooltip");
    assert!(said.contains("Red curls to the shoulders."), "{said}");
}

#[test]
fn the_menu_starts_a_morph_whose_slider_mixes_and_whose_buttons_end_it() {
    let mut harness = shelf(None);
    let before = project(&harness);
    let start = |harness: &mut Shelf| {
        let at = tile(harness, "Red curls");
        harness.hover_at(at);
        harness.run();
        for pressed in [true, false] {
            harness.event(egui::Event::PointerButton {
                pos: at,
                button: PointerButton::Secondary,
                pressed,
                modifiers: Modifiers::NONE,
            });
            harness.run();
        }
        control(harness, Role::Button, "Morph to this style").click();
        harness.run();
        harness.remove_cursor();
        harness.run();
    };
    start(&mut harness);
    let mut wanted = before.clone();
    wanted.start_morph(&shipped::by_id("curly").expect("shipped").style);
    assert_eq!(project(&harness), wanted);
    assert!(harness.query_by_label_contains("Turns into Red curls").is_some());
    let slider = control(&harness, Role::Slider, "Morph").rect();
    click(&mut harness, slider.left_center() + egui::vec2(0.5 * slider.width(), 0.0));
    let amount = project(&harness).hair.morph.amount;
    assert!((0.3..0.7).contains(&amount), "{amount}");
    control(&harness, Role::Button, "End morph").click();
    harness.run();
    assert_eq!(project(&harness), before);
    start(&mut harness);
    control(&harness, Role::Button, "Become Red curls").click();
    harness.run();
    wanted = before;
    wanted.apply_style(&shipped::by_id("curly").expect("shipped").style, StyleParts::ALL);
    assert_eq!(project(&harness), wanted);
}

/// A browser with a folder for own styles, and the name of a style that has just been saved in it.
fn saved(dir: &std::path::Path, name: &str) -> (Shelf, OwnStyles) {
    let own = OwnStyles::new(dir.join("styles"));
    let mut harness = shelf(Some((own.clone(), dir.join("cache"))));
    let mut project = Project::default();
    (project.hair.groom.wisps, project.hair.groom.strands_per_wisp) = (20, 3);
    project.hair.groom.length *= 0.7;
    harness.state_mut().state.document.change("few", |now| *now = project);
    harness.run_steps(2);
    save_as(&mut harness, name);
    wait(&mut harness, "the style", |harness| names(harness).iter().any(|listed| listed == name));
    (harness, own)
}

fn save_as(harness: &mut Shelf, name: &str) {
    control(harness, Role::Button, "Save as style…").click();
    harness.run_steps(3);
    harness.event(egui::Event::Text(name.to_owned()));
    harness.run_steps(2);
    control(harness, Role::Button, "Save style").click();
    harness.run_steps(3);
}

#[test]
fn a_saved_style_is_selected_in_sight_and_nothing_of_it_is_marked() {
    let dir = tempfile::tempdir().expect("a folder");
    let tags = shelf(None).state().state.browser.all_tags();
    let (mut harness, _) = saved(dir.path(), "Zest");
    harness.run_steps(30);
    let tile = control(&harness, Role::RadioButton, "Zest");
    assert!(crate::window::testing::is_on(&tile));
    let place = tile.rect();
    let search = control(&harness, Role::TextInput, "Search styles").rect();
    assert!(place.top() > search.bottom() && place.bottom() < search.bottom() + 460.0, "{place:?}");
    let project = project(&harness);
    assert_eq!(project.hair.shipped_groom(), project.hair.groom);
    assert_eq!(project.hair.simulation(), Style::of_project(&project).simulation);
    // The control: with the preset alone, the length would be marked.
    assert_ne!(lovelock_groom::GroomSettings::preset(project.hair.preset), project.hair.groom);
    let now = harness.state().state.browser.all_tags();
    assert_eq!(now[..tags.len()], tags[..], "no tag changes its place");
    assert_eq!(now[tags.len()..], ["own"]);
}

#[test]
fn a_style_is_updated_and_a_name_in_use_is_asked_for() {
    let dir = tempfile::tempdir().expect("a folder");
    let (mut harness, own) = saved(dir.path(), "Mine");
    let path = own.folder().join("Mine.lovelockstyle");
    let longer = |harness: &mut Shelf| {
        let mut project = project(harness);
        project.hair.groom.length *= 1.1;
        harness.state_mut().state.document.change("longer", |now| *now = project.clone());
        harness.run_steps(2);
        project.hair.groom.length
    };
    let stored = || Style::load(&path).expect("a style").0.hair.groom.length;
    // Update, from the button.
    let length = longer(&mut harness);
    control(&harness, Role::Button, "Update…").click();
    harness.run_steps(3);
    assert!(stored() < length, "it asks first");
    control(&harness, Role::Button, "Update style").click();
    harness.run_steps(3);
    assert!((stored() - length).abs() < 1e-6);
    assert_eq!(Style::load(&path).expect("a style").0.name, "Mine");
    // A name in use: Cancel returns to the name, Replace replaces.
    let length = longer(&mut harness);
    save_as(&mut harness, "Mine");
    let question = "You already have a style Mine. Replace it?";
    assert!(harness.query_by_role_and_label(Role::Dialog, question).is_some());
    control(&harness, Role::Button, "Cancel").click();
    harness.run_steps(3);
    assert!(stored() < length);
    control(&harness, Role::Button, "Save style").click();
    harness.run_steps(3);
    control(&harness, Role::Button, "Replace").click();
    harness.run_steps(3);
    assert!((stored() - length).abs() < 1e-6);
    assert_eq!(own.list().len(), 1, "no second one of the same caption");
}

#[test]
fn layers_of_the_user_stay_when_a_style_is_applied() {
    use lovelock_style::{Layer, operations::Wave};
    let mut harness = shelf(None);
    let mut before = project(&harness);
    before.hair.stack.push(Layer::of(Wave::default()));
    let id = before.hair.stack.layers[0].id;
    harness.state_mut().state.document.change("layer", |now| *now = before.clone());
    harness.run_steps(2);
    let at = tile(&harness, "Red curls");
    click(&mut harness, at);
    harness.remove_cursor();
    harness.run();
    let after = project(&harness);
    assert_eq!(after.hair.preset, lovelock_groom::Preset::Curly);
    assert!(after.hair.stack.layer(id).is_some(), "it stays, under its number");
    let requests = std::mem::take(&mut harness.state_mut().state.requests);
    assert!(matches!(&requests[..], [Command::Report(said)] if said.contains("Red curls")), "{requests:?}");
    let document = &mut harness.state_mut().state.document;
    document.undo();
    assert_eq!(**document.project(), before, "one step brings all back");
}
