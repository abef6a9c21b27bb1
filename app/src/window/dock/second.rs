//! The second window, whose panels stand side by side and in tabs.

use egui::{
    Context, Rect, ScrollArea, Ui, UiBuilder, ViewportBuilder, ViewportClass, ViewportId, WidgetText,
};
use egui_tiles::{Behavior, SimplificationOptions, Tile, TileId, Tiles, UiResponse};

use super::Arrangement;
use crate::window::command::Command;
use crate::window::control;
use crate::window::gesture::Gestures;
use crate::window::shelf::Shelf;

/// Whether and where a window was opened.
#[derive(Clone, Copy, Default)]
enum Opened {
    #[default]
    No,
    /// Where the desktop put it.
    Anywhere,
    At(Rect),
}

/// What the second window remembers while it is open.
#[derive(Default)]
pub(crate) struct SecondWindow {
    gestures: Gestures,
    /// Whether a drag or typing in it continues.
    pub(crate) continues: bool,
    /// Whether one of its controls is held.
    pub(crate) is_held: bool,
    /// Where it was opened, which must not change while it is open: moving it would be a command to the desktop.
    opened: Opened,
}

/// The second window.
fn viewport() -> ViewportId {
    ViewportId::from_hash_of("second window of panels")
}

/// Shows the second window, if any panel is in it. Returns the commands whose keys were pressed there.
pub(crate) fn second_window(
    ctx: &Context,
    window: &mut SecondWindow,
    arrangement: &mut Arrangement,
    shelf: &mut Shelf<'_>,
    keys: &dyn Fn(&Context) -> Vec<Command>,
) -> Vec<Command> {
    if arrangement.second().is_none() {
        *window = SecondWindow::default();
        return Vec::new();
    }
    if matches!(window.opened, Opened::No) {
        window.opened = arrangement.second_place().map_or(Opened::Anywhere, Opened::At);
    }
    let place = if let Opened::At(place) = window.opened { Some(place) } else { None };
    let mut builder = ViewportBuilder::default()
        .with_title("Panels · Lovelock")
        .with_app_id("lovelock")
        .with_inner_size(place.map_or(egui::vec2(680.0, 760.0), |place| place.size()));
    if let Some(place) = place {
        builder = builder.with_position(place.min);
    }
    let mut commands = Vec::new();
    let closes = ctx.show_viewport_immediate(viewport(), builder, |ui, class| {
        let ctx = ui.ctx().clone();
        let mut closes = false;
        if class != ViewportClass::EmbeddedWindow {
            // Only the first window is cleared to the panels' colour.
            ui.painter().rect_filled(ctx.viewport_rect(), 0.0, ui.visuals().window_fill);
            window.continues = window.gestures.continues(&ctx, false);
            window.is_held = ctx.input(|input| input.pointer.any_down());
            commands = keys(&ctx);
            let (outer, inner) =
                ctx.input(|input| (input.viewport().outer_rect, input.viewport().inner_rect));
            closes = ctx.input(|input| input.viewport().close_requested());
            if let (Some(outer), Some(inner)) = (outer, inner) {
                arrangement.set_second_place(Rect::from_min_size(outer.min, inner.size()));
            }
        }
        if let Some(tree) = arrangement.second() {
            bring_to_front(&ctx, tree);
            let mut panes = Panes { shelf: &mut *shelf };
            tree.ui(&mut panes, ui);
            for title in behind(tree) {
                if control::is_looking(&ctx) {
                    look_through(ui, &title, &mut panes);
                } else {
                    panes.shelf.hide(&title);
                }
            }
        }
        closes
    });
    if closes {
        arrangement.close_second();
    }
    // A tab may have been closed.
    arrangement.forget_empty_second();
    commands
}

/// Shows the tab of the panel that holds the control to be shown.
fn bring_to_front(ctx: &Context, tree: &mut egui_tiles::Tree<String>) {
    if let Some(title) = control::revealed_section(ctx) {
        tree.make_active(|_, tile| matches!(tile, Tile::Pane(of) if *of == title));
    }
}

/// The panels behind other tabs.
fn behind(tree: &egui_tiles::Tree<String>) -> Vec<String> {
    let active = tree.active_tiles();
    let behind = tree.tiles.iter().filter(|(id, _)| !active.contains(id));
    let title = |tile: &Tile<String>| if let Tile::Pane(title) = tile { Some(title.clone()) } else { None };
    behind.filter_map(|(_, tile)| title(tile)).collect()
}

/// Lets a control be found that is behind another tab.
fn look_through(ui: &mut Ui, title: &str, panes: &mut Panes<'_, '_>) {
    let beside = Rect::from_min_size(ui.max_rect().right_bottom(), egui::vec2(300.0, 600.0));
    let mut hidden = ui.new_child(UiBuilder::new().max_rect(beside).invisible());
    panes.show(&mut hidden, title);
}

/// The panels of the window as tiles.
struct Panes<'a, 'b> {
    shelf: &'a mut Shelf<'b>,
}

impl Panes<'_, '_> {
    fn show(&mut self, ui: &mut Ui, title: &str) {
        if !self.shelf.is_shown(title) {
            return;
        }
        if self.shelf.is_disabled(title) {
            self.shelf.note(ui);
            ui.disable();
        }
        self.shelf.untitled(ui, title);
    }
}

impl Behavior<String> for Panes<'_, '_> {
    fn pane_ui(&mut self, ui: &mut Ui, tile: TileId, title: &mut String) -> UiResponse {
        egui::Frame::NONE.inner_margin(6.0).show(ui, |ui| {
            ScrollArea::vertical().id_salt(tile).auto_shrink(false).show(ui, |ui| self.show(ui, title));
        });
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, title: &String) -> WidgetText {
        title.as_str().into()
    }

    fn is_tab_closable(&self, _tiles: &Tiles<String>, _tile: TileId) -> bool {
        true
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { all_panes_must_have_tabs: true, ..SimplificationOptions::default() }
    }

    fn min_size(&self) -> f32 {
        120.0
    }
}
