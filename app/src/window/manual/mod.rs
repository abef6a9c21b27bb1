//! The manual: the pages of the documentation, in a window of the program.

mod page;
mod pages;
mod view;
pub(crate) mod what;

use std::collections::BTreeMap;

use egui::{Align2, Context, Key, Modifiers, TextureHandle, Vec2, vec2};

use super::key_press;
use super::picker::Picker;
use pages::PAGES;

/// A place in the manual: the numbers of a page and of a block of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Place {
    page: usize,
    block: usize,
}

/// The open manual.
#[derive(Default)]
pub(crate) struct Manual {
    is_open: bool,
    at: Place,
    /// The places before this one, the latest last.
    before: Vec<Place>,
    /// The block that is scrolled to, until it is shown.
    goal: Option<usize>,
    /// A block that is marked, and since when, seconds.
    marked: Option<(Place, Option<f64>)>,
    search: Picker,
    /// Whether the search gets the focus, because the manual was just opened.
    is_new: bool,
    /// The width of the text in the last pass, and the heights of the blocks at it.
    heights: (usize, f32, Vec<f32>),
    pictures: BTreeMap<&'static str, Option<TextureHandle>>,
}

/// Places that *Back* returns to.
const MAX_BEFORE: usize = 100;
/// Size of the window when it is first opened, points.
const SIZE: Vec2 = vec2(820.0, 560.0);

impl Manual {
    /// Opens or closes the manual.
    pub(crate) fn toggle(&mut self) {
        self.is_open = !self.is_open;
        self.is_new = self.is_open;
    }

    /// Opens the manual at a place, which is marked for a moment if it is not the beginning of a page.
    pub(crate) fn show_place(&mut self, place: Place) {
        if self.at != place {
            self.before.push(self.at);
            if self.before.len() > MAX_BEFORE {
                self.before.remove(0);
            }
        }
        self.is_open = true;
        self.at = place;
        self.goal = Some(place.block);
        self.marked = (place.block > 0).then_some((place, None));
    }

    /// Whether it is open.
    #[cfg(test)]
    pub(crate) fn is_open(&self) -> bool {
        self.is_open
    }

    /// The text of the block where it is.
    #[cfg(test)]
    pub(crate) fn text_here(&self) -> String {
        PAGES[self.at.page].page().blocks[self.at.block].text()
    }

    fn back(&mut self) {
        if let Some(place) = self.before.pop() {
            self.at = place;
            self.goal = Some(place.block);
            self.marked = None;
        }
    }

    /// Follows a link of the page that is shown.
    fn follow(&mut self, ctx: &Context, link: &str) {
        if link.starts_with("http") {
            ctx.open_url(egui::OpenUrl::new_tab(link));
            return;
        }
        let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
        let page = if file.is_empty() { Some(self.at.page) } else { pages::number_of(file) };
        if let Some(page) = page {
            let block = PAGES[page].page().block_at(anchor).unwrap_or(0);
            self.show_place(Place { page, block });
        }
    }

    /// Shows the manual if it is open.
    pub(crate) fn show(&mut self, ctx: &Context) {
        if !self.is_open {
            return;
        }
        let mut is_open = true;
        let room = ctx.content_rect().size() - vec2(40.0, 60.0);
        egui::Window::new("Manual")
            .id(egui::Id::unique("manual"))
            .open(&mut is_open)
            .pivot(Align2::CENTER_CENTER)
            .default_pos(ctx.content_rect().center())
            .default_size(SIZE.min(room))
            .min_size([420.0, 240.0])
            .max_size(room)
            .collapsible(false)
            .show(ctx, |ui| self.contents(ui));
        let is_free = ctx.memory(|memory| memory.top_modal_layer().is_none()) && !ctx.any_popup_open();
        if is_free && key_press::consume(ctx, Modifiers::NONE, Key::Escape) {
            is_open = false;
        }
        self.is_open = is_open;
    }
}

/// The place that describes the setting at a path of the project, such as `simulation.wind.speed`.
pub(crate) fn place_of_setting(path: &str) -> Option<Place> {
    let page = pages::number_of("settings.md")?;
    Some(Place { page, block: PAGES[page].page().row_of(path)? })
}

/// The place that writes most about a control of that name.
pub(crate) fn place_of_control(name: &str) -> Option<Place> {
    let name = name.trim().trim_end_matches('…').trim();
    if name.is_empty() {
        return None;
    }
    let found = PAGES.iter().enumerate().filter_map(|(page, source)| {
        let (fit, block) = source.page().mention(name)?;
        Some((fit, Place { page, block }))
    });
    // The first page is the user's guide, and the ones for reference follow.
    found.min_by_key(|(fit, place)| (*fit, place.page)).map(|(_, place)| place)
}
