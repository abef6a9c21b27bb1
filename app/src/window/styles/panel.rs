//! The browser in the panel of the hairstyle.

use egui::{Button, Key, Modifiers, ScrollArea, Ui, vec2};
use egui_material_icons::icons::ICON_STAR;
use lovelock_project::Project;
use lovelock_project::styles::{Style, StyleParts};

use super::dialogs::{self, Dialog};
use super::tile::{GAP, Tile, height, tile};
use super::{Browser, Entry, Hover, current};
use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::note;
use crate::window::picker::Picked;
use crate::window::{key_press, theme};

/// Time for which the pointer rests on a tile before the hair is shown in that style, seconds.
const REST_SECS: f64 = 0.3;
/// Tiles side by side.
const COLUMNS: usize = 3;
/// Height of the grid, points.
const TALL: f32 = 330.0;

/// What is done to a style from its tile.
enum Action {
    Apply(StyleParts),
    Morph,
    Favourite,
    Export,
    Update,
    Rename,
    Delete,
}

/// The browser: what is applied to `project`, and the user's own styles. Returns what it asks the window to do.
pub(crate) fn ui(ui: &mut Ui, project: &mut Project, browser: &mut Browser) -> Option<Command> {
    browser.update(ui.ctx());
    let picked = ui.horizontal(|ui| {
        let width = ui.available_width() - 104.0;
        let (field, picked) = browser.search.field(ui, "Search styles", width, false);
        if field.lost_focus() && ui.input(|input| input.key_pressed(Key::Escape)) {
            browser.search.clear();
        }
        let tip = "Shows styles with these words in their name, description or tags. Enter applies the first; Down moves to \
                   the pictures.";
        field.hover_tooltip(tip);
        let save = ui.add_enabled(browser.own.is_some(), Button::new("Save as style…"));
        let tip = "Saves this hairstyle with its colours and motion as one of your styles.";
        if save.hover_tooltip(tip).disabled_hover_tooltip("The system has no folder for your data.").clicked()
        {
            let style = Style::of_project(project);
            browser.dialog = Some(Dialog::Save { style: Box::new(style), name: String::new() });
            browser.dialog_error = None;
        }
        picked
    });
    super::morph::ui(ui, project);
    parts(ui, project, browser);
    chips(ui, browser);
    grid(ui, project, browser, picked.inner);
    dialogs::show(ui.ctx(), project, browser);
    browser.requests.pop_front()
}

/// The three parts that a click applies, and the button that keeps changes of a style of the user's own.
fn parts(ui: &mut Ui, project: &Project, browser: &mut Browser) {
    let own = current(project).and_then(|id| browser.entries.iter().find(|entry| entry.id == id));
    let own = own.filter(|entry| entry.file.is_some()).cloned();
    let parts = &mut browser.parts;
    let mut updates = false;
    ui.horizontal(|ui| {
        ui.label("Apply");
        let toggles = [
            (
                &mut parts.shape,
                "Shape",
                "Clicking a style applies its cut, its form and the layers that change them.",
            ),
            (&mut parts.colour, "Colour", "Clicking a style applies its colours."),
            (&mut parts.motion, "Motion", "Clicking a style applies how its hair moves."),
        ];
        for (on, name, tip) in toggles {
            if ui.selectable_label(*on, name).hover_tooltip(tip).clicked() {
                *on = !*on;
            }
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let differs = own.as_ref().is_some_and(|entry| differs(&entry.style, project));
            let button = ui.add_enabled(differs, Button::new("Update…"));
            let why_not = match &own {
                Some(_) => "The hair already matches your style.",
                None => "The hair does not use one of your styles.",
            };
            let tip = "Replaces the contents of your style with the current hair.";
            updates = button.hover_tooltip(tip).disabled_hover_tooltip(why_not).clicked();
        });
    });
    if let Some(entry) = own.filter(|_| updates) {
        browser.dialog = Some(Dialog::update(&entry, project));
    }
}

/// Whether the hair differs from a style.
fn differs(style: &Style, project: &Project) -> bool {
    let now = Style::of_project(project);
    let mut hair = style.hair.clone();
    (hair.style, hair.groom.look) = (String::new(), now.hair.groom.look);
    (&now.hair, now.look, now.simulation) != (&hair, style.look, style.simulation)
}

/// Filters: favourites, and tags.
fn chips(ui: &mut Ui, browser: &mut Browser) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(3.0, 3.0);
        let star = ui.selectable_label(browser.only_favourites, ICON_STAR);
        star.widget_info(|| {
            egui::WidgetInfo::selected(egui::Role::Button, true, browser.only_favourites, "Favourites only")
        });
        if star.hover_tooltip("Shows favourites only.").clicked() {
            browser.only_favourites = !browser.only_favourites;
        }
        for tag in browser.all_tags() {
            let on = browser.tags.contains(&tag);
            let text = egui::RichText::new(&tag).small();
            let tip = format!("Shows only styles with the tag “{tag}”.");
            let chip = ui.selectable_label(on, text).hover_tooltip(tip);
            if chip.clicked() && !browser.tags.remove(&tag) {
                browser.tags.insert(tag);
            }
        }
        // A tag that no style has any more would hide everything.
        let known = browser.all_tags();
        browser.tags.retain(|tag| known.contains(tag));
    });
}

fn grid(ui: &mut Ui, project: &mut Project, browser: &mut Browser, picked: Picked) {
    let shown = browser.shown();
    arrows(ui, browser, picked);
    let entered = picked.entered && !browser.search.typed.trim().is_empty();
    if shown.is_empty() {
        note(ui, "No style matches. Clear the search and the filters to see every style.");
    }
    let first = shown.first().filter(|_| entered);
    let mut action = first.map(|entry| (entry.clone(), Action::Apply(browser.parts)));
    let mut hovered = None;
    browser.tiles.clear();
    let area = ScrollArea::vertical().id_salt("styles").max_height(TALL).auto_shrink([false, true]);
    area.show(ui, |ui| {
        let wide = ui.available_width() - ui.spacing().scroll.allocated_width();
        let width = ((wide - GAP * (COLUMNS - 1) as f32) / COLUMNS as f32).floor().max(16.0);
        ui.spacing_mut().item_spacing = vec2(GAP, GAP);
        for row in shown.chunks(COLUMNS) {
            ui.horizontal(|ui| {
                for entry in row {
                    let (asked, over) = one(ui, width, entry, project, browser);
                    action = action.take().or(asked.map(|asked| (entry.clone(), asked)));
                    if over {
                        hovered = Some(entry.id.clone());
                    }
                }
            });
        }
        // Within the grid, because they are found later than it is shown and must not move what is below.
        for why in &browser.broken {
            ui.add(egui::Label::new(egui::RichText::new(why).small().color(theme::wrong())).wrap());
        }
    });
    preview(ui, browser, hovered);
    if let Some((entry, action)) = action {
        act(&entry, &action, project, browser);
    }
}

/// Moves the focus through the pictures by the arrow keys, and to them from the search field.
fn arrows(ui: &Ui, browser: &mut Browser, picked: Picked) {
    let focused = ui.memory(egui::Memory::focused);
    let at = browser.tiles.iter().position(|id| Some(*id) == focused);
    let next = match at {
        None if picked.down => Some(0),
        None => None,
        Some(at) => {
            let pressed = |key| key_press::consume(ui.ctx(), Modifiers::NONE, key);
            let last = browser.tiles.len() - 1;
            if pressed(Key::ArrowRight) {
                Some((at + 1).min(last))
            } else if pressed(Key::ArrowLeft) {
                Some(at.saturating_sub(1))
            } else if pressed(Key::ArrowDown) {
                Some(if at + COLUMNS <= last { at + COLUMNS } else { at })
            } else if pressed(Key::ArrowUp) {
                Some(at.checked_sub(COLUMNS).unwrap_or(at))
            } else {
                None
            }
        }
    };
    if let Some(id) = next.and_then(|next| browser.tiles.get(next)) {
        ui.memory_mut(|memory| memory.request_focus(*id));
    }
}

/// One tile; what is done to its style, and whether the pointer is over it.
fn one(
    ui: &mut Ui,
    width: f32,
    entry: &Entry,
    project: &Project,
    browser: &mut Browser,
) -> (Option<Action>, bool) {
    let style = &entry.style;
    let favourite = browser.kept.favourites.contains(&entry.id);
    let place = egui::Rect::from_min_size(ui.cursor().min, vec2(width, height(width)));
    // Pictures are read when their tiles are first seen.
    let picture = if ui.is_rect_visible(place) { browser.picture(ui.ctx(), &entry.id) } else { None };
    let look = Tile {
        name: &style.name,
        text: if style.text.is_empty() { style.name.clone() } else { style.text.clone() },
        picture,
        current: current(project) == Some(entry.id.as_str()),
        favourite,
    };
    let (response, starred) = tile(ui, width, &look);
    let mut action = None;
    if starred {
        action = Some(Action::Favourite);
    } else if response.clicked() {
        action = Some(Action::Apply(browser.parts));
    }
    browser.tiles.push(response.id);
    if response.gained_focus() {
        response.scroll_to_me(None);
    }
    // Resting on it with the keyboard shows it too.
    let over = response.hovered() || response.has_focus();
    if browser.reveal.take_if(|id| *id == entry.id).is_some() {
        response.scroll_to_me(Some(egui::Align::Center));
    }
    let tip = format!("{}\n\nClick to apply it, right-click for more.", look.text);
    response.hover_tooltip(tip).context_menu(|ui| {
        let name = if favourite { "No favourite" } else { "Favourite" };
        let mut entries = vec![
            ("Apply shape", Action::Apply(StyleParts::SHAPE)),
            ("Apply colour", Action::Apply(StyleParts::COLOUR)),
            ("Apply motion", Action::Apply(StyleParts::MOTION)),
            ("Morph to this style", Action::Morph),
            (name, Action::Favourite),
            ("Export…", Action::Export),
        ];
        if entry.file.is_some() {
            entries.push(("Update this style…", Action::Update));
            entries.push(("Rename…", Action::Rename));
            entries.push(("Delete…", Action::Delete));
        }
        for (label, wanted) in entries {
            if ui.button(label).clicked() {
                action = Some(wanted);
                ui.close();
            }
        }
        if let Some(own) = &browser.own
            && ui.button("Show folder").hover_tooltip(own.folder().display().to_string()).clicked()
        {
            if let Err(why) = show_folder(own.folder()) {
                browser.requests.push_back(Command::Fail(why));
            }
            ui.close();
        }
    });
    (action, over)
}

/// Decides which style is shown without being applied: the one on whose tile the pointer rests.
fn preview(ui: &Ui, browser: &mut Browser, hovered: Option<String>) {
    if browser.clicked.is_some() && browser.clicked != hovered {
        browser.clicked = None;
    }
    let menu_or_drag = ui.ctx().any_popup_open() || ui.input(|input| input.pointer.any_down());
    let hovered = hovered.filter(|id| !menu_or_drag && browser.clicked.as_ref() != Some(id));
    let Some(id) = hovered else {
        (browser.hover, browser.preview) = (None, None);
        return;
    };
    let now = ui.input(|input| input.time);
    if browser.hover.as_ref().is_none_or(|hover| hover.id != id) {
        browser.hover = Some(Hover { id: id.clone(), since_secs: now });
    }
    let rested = browser.hover.as_ref().map_or(0.0, |hover| now - hover.since_secs);
    if rested >= REST_SECS {
        browser.preview = Some(id);
    } else {
        browser.preview = None;
        ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(REST_SECS - rested));
    }
}

fn act(entry: &Entry, action: &Action, project: &mut Project, browser: &mut Browser) {
    let file = || entry.file.clone().unwrap_or_default();
    match *action {
        Action::Apply(parts) => {
            let kept = project.apply_style_below_layers(&entry.style, parts);
            if kept > 0 {
                let layers = if kept == 1 { "One of your layers is kept" } else { "Your layers are kept" };
                let said = format!(
                    "{layers} on top of {}. Remove what you do not want in Layers.",
                    entry.style.name
                );
                browser.requests.push_back(Command::Report(said));
            }
            browser.clicked = Some(entry.id.clone());
            browser.preview = None;
        }
        Action::Morph => {
            project.start_morph(&entry.style);
            browser.clicked = Some(entry.id.clone());
            browser.preview = None;
        }
        Action::Favourite => {
            let favourites = &mut browser.kept.favourites;
            if !favourites.remove(&entry.id) {
                favourites.insert(entry.id.clone());
            }
        }
        Action::Export => browser.requests.push_back(Command::ExportStyle(Box::new((*entry.style).clone()))),
        Action::Update => browser.dialog = Some(Dialog::update(entry, project)),
        Action::Rename => {
            browser.dialog = Some(Dialog::Rename { path: file(), name: entry.style.name.clone() });
        }
        Action::Delete => {
            browser.dialog = Some(Dialog::Delete { path: file(), name: entry.style.name.clone() });
        }
    }
}

/// Shows a folder in the system's program for files.
fn show_folder(folder: &std::path::Path) -> Result<(), String> {
    let program = match std::env::consts::OS {
        "macos" => "open",
        "windows" => "explorer",
        _ => "xdg-open",
    };
    // It need not be there before the first style is saved.
    let made = std::fs::create_dir_all(folder);
    made.and_then(|()| std::process::Command::new(program).arg(folder).spawn()).map(drop).map_err(|error| {
        format!("The folder of your styles, {}, could not be shown: {error}", folder.display())
    })
}
