//! The wall: nine variants around the hairstyle, all of which dance. A click adopts one, Shift+click on two makes a child of both.

mod bar;
mod rounds;

use std::sync::Arc;

use egui::{
    Align2, CentralPanel, Color32, FontId, Frame, Panel, Rect, Sense, Stroke, StrokeKind, Ui, UiBuilder, pos2,
};
use lovelock_project::Project;
use lovelock_project::variants::{Locks, adopt, breed};
use lovelock_session::wall::{Wall, WallCell, WallRequest};
use rounds::Rounds;
use serde::{Deserialize, Serialize};

use super::images::ShownImage;
use super::page::Page;
use super::{Window, camera_control, images, theme, viewport};
use crate::window::command::Command;

/// The cell of the present hairstyle, in the middle.
const PRESENT: usize = Wall::CELLS / 2;
/// Cells in a row.
const COLUMNS: usize = 3;
/// Room between cells, points.
const GAP: f32 = 3.0;
/// The most pixels of all cells together where the processor renders.
const MAX_PIXELS: f32 = 640.0 * 480.0;

/// What is stored between runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct WallLayout {
    /// How far variants are from the present hairstyle, 0 to 1.
    pub(crate) amount: f32,
    /// What stays.
    pub(crate) locks: Locks,
}

impl Default for WallLayout {
    fn default() -> Self {
        Self { amount: 0.5, locks: Locks::default() }
    }
}

/// The variants and their images.
#[derive(Default)]
pub(crate) struct WallPage {
    wall: Option<Wall>,
    rounds: Rounds,
    cells: [Option<Arc<WallCell>>; Wall::CELLS],
    seen: [u64; Wall::CELLS],
    images: [ShownImage; Wall::CELLS],
    /// The first of two parents.
    marked: Option<usize>,
    wanted: [u32; 2],
    sent: Option<WallRequest>,
}

/// What a click on a cell asks for.
enum Choice {
    Adopt(usize),
    Parent(usize),
}

impl WallPage {
    /// Takes the newest images.
    fn update(&mut self) {
        let Some(wall) = &self.wall else { return };
        for (index, (seen, held)) in self.seen.iter_mut().zip(&mut self.cells).enumerate() {
            if let Some(cell) = wall.cell(index).and_then(|slot| slot.newer_than(seen)) {
                *held = Some(cell);
            }
        }
    }

    /// Forgets all images, whose device is lost, and asks for them again.
    pub(crate) fn forget_images(&mut self) {
        self.images.iter_mut().for_each(ShownImage::forget);
        self.cells = Default::default();
        self.sent = None;
    }

    /// Gives back images, and what the thread keeps, because the wall is not shown. Returns whether there was anything.
    pub(crate) fn leave(&mut self) -> bool {
        if self.sent.is_none() && self.cells.iter().all(Option::is_none) {
            return false;
        }
        self.forget_images();
        self.marked = None;
        if let Some(wall) = &self.wall {
            wall.rest();
        }
        true
    }

    /// Forgets the variants of a project that is closed.
    pub(crate) fn forget_rounds(&mut self) {
        self.rounds = Rounds::default();
    }

    /// The memory that the thread keeps, bytes.
    pub(crate) fn held_bytes(&self) -> u64 {
        self.wall.as_ref().map_or(0, Wall::held_bytes)
    }

    /// Whether every cell has an image.
    pub(crate) fn has_pictures(&self) -> bool {
        self.cells.iter().all(Option::is_some)
    }

    /// The variants that are shown.
    #[cfg(test)]
    pub(crate) fn variants(&self) -> &[Arc<Project>] {
        self.rounds.variants()
    }
}

impl Window {
    /// Shows the variants in place of the image. Returns what the toolbar asks for.
    pub(super) fn wall_page(&mut self, ui: &mut Ui, project: &mut Project) -> Option<Command> {
        let ctx = ui.ctx().clone();
        let mut command = None;
        if self.pages.wall.wall.is_none() {
            self.start_wall(&ctx);
        }
        self.pages.wall.update();
        self.pages.wall.rounds.follow(self.document.project(), &self.layout.wall);
        CentralPanel::default().frame(Frame::NONE).show(ui, |ui| {
            let rounds = self.pages.wall.wall.as_ref().and_then(|wall| wall.rounds().latest());
            let asked = Panel::top("wall bar")
                .show(ui, |ui| {
                    bar::ui(
                        ui,
                        &mut self.layout.wall,
                        project,
                        &self.pages.wall.rounds,
                        rounds.as_deref().copied(),
                    )
                })
                .inner;
            match asked {
                Some(bar::Action::Again) => self.pages.wall.rounds.again(&self.layout.wall),
                Some(bar::Action::Back) => self.pages.wall.rounds.back(),
                Some(bar::Action::Close) => command = Some(Command::Show(Page::Wall)),
                None => {}
            }
            let page = ui.available_rect_before_wrap();
            ui.painter().rect_filled(page, 0.0, theme::page());
            let choice = self.cells(ui, page, project);
            self.choose(choice.as_ref(), project);
            self.running(ui, page);
        });
        command
    }

    fn start_wall(&mut self, ctx: &egui::Context) {
        let wake = ctx.clone();
        match Wall::start(self.display.device().clone(), move || images::wake(&wake)) {
            Ok(wall) => self.pages.wall.wall = Some(wall),
            Err(error) => {
                self.layout.page = Page::Image;
                self.fail(format!("the thread of the wall could not be started: {error}"));
            }
        }
    }

    /// Shows the cells and applies the pointer's input over them.
    fn cells(&mut self, ui: &mut Ui, page: Rect, project: &mut Project) -> Option<Choice> {
        let mut choice = None;
        for index in 0..Wall::CELLS {
            let place = place_of(index, page);
            if index == 0 {
                let points = ui.ctx().pixels_per_point();
                let adapter = self.session.painter().adapter();
                let most = viewport::most_pixels(adapter.as_deref()).min(MAX_PIXELS.max(page.area()));
                let each = most.min(MAX_PIXELS * if is_card(adapter.as_deref()) { 8.0 } else { 1.0 })
                    / Wall::CELLS as f32;
                self.pages.wall.wanted =
                    viewport::size_for(place.size(), points, each, self.layout.view_scale);
            }
            let name =
                if index == PRESENT { "Present style".to_owned() } else { format!("Variant {}", index + 1) };
            let response =
                ui.interact(place, egui::Id::unique(("wall cell", index)), Sense::click_and_drag());
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
            camera_control::steer(&mut project.camera, self.scene_secs(), &response);
            self.cell(ui, place, index, &response);
            if response.clicked() {
                let shift = ui.input(|input| input.modifiers.shift);
                choice = Some(if shift { Choice::Parent(index) } else { Choice::Adopt(index) });
            }
        }
        choice
    }

    fn cell(&mut self, ui: &Ui, place: Rect, index: usize, response: &egui::Response) {
        let painter = ui.painter().with_clip_rect(place.intersect(ui.clip_rect()));
        let font = FontId::proportional(13.0);
        let wall = &mut self.pages.wall;
        let wanted = wall.rounds.variants().get(index);
        match wall.cells[index].as_ref() {
            Some(cell) => {
                wall.images[index].set(
                    ui.ctx(),
                    &self.display.textures,
                    &format!("wall {index}"),
                    &cell.image,
                    false,
                );
                let whole = wall.images[index].size().map_or(place, |size| viewport::fit(size, place));
                let near = (whole.size() - place.size()).abs().max_elem() < 3.0;
                // The image of the variant before is shown dimmer until its own comes.
                let is_own = wanted.is_some_and(|wanted| Arc::ptr_eq(wanted, &cell.variant));
                let tint = if is_own { Color32::WHITE } else { Color32::from_gray(110) };
                if let Some(texture) = wall.images[index].texture() {
                    let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                    painter.image(texture, if near { place } else { whole }, uv, tint);
                }
                if let Some(why) = &cell.problem {
                    let mut ui = Ui::new(
                        ui.ctx().clone(),
                        egui::Id::unique(("wall problem", index)),
                        UiBuilder::new().max_rect(place.shrink(10.0)),
                    );
                    ui.colored_label(theme::wrong(), why);
                }
            }
            None => {
                painter.text(
                    place.center(),
                    Align2::CENTER_CENTER,
                    "Getting ready…",
                    font.clone(),
                    theme::quiet(),
                );
            }
        }
        if index == PRESENT {
            let at = place.left_bottom() + egui::vec2(8.0, -6.0);
            painter.text(at, Align2::LEFT_BOTTOM, "Present", font.clone(), theme::quiet());
        }
        let marked = wall.marked == Some(index);
        if marked {
            let at = place.right_bottom() + egui::vec2(-8.0, -6.0);
            painter.text(at, Align2::RIGHT_BOTTOM, "Parent: Shift+click another", font, theme::accent());
        }
        let edge = match (marked || response.hovered(), index == PRESENT) {
            (true, _) => Stroke::new(2.0, theme::accent()),
            (false, true) => Stroke::new(1.0, theme::quiet()),
            (false, false) => Stroke::new(1.0, theme::line()),
        };
        painter.rect_stroke(place, 0.0, edge, StrokeKind::Inside);
    }

    /// Adopts a variant, or makes a child of two.
    fn choose(&mut self, choice: Option<&Choice>, project: &mut Project) {
        let variant = |page: &WallPage, index: usize| page.rounds.variants().get(index).cloned();
        match choice {
            Some(&Choice::Adopt(index)) => {
                self.pages.wall.marked = None;
                if let Some(variant) = variant(&self.pages.wall, index).filter(|_| index != PRESENT) {
                    adopt(project, &variant);
                }
            }
            Some(&Choice::Parent(index)) => match self.pages.wall.marked.take() {
                Some(first) if first == index => {}
                Some(first) => {
                    if let (Some(a), Some(b)) =
                        (variant(&self.pages.wall, first), variant(&self.pages.wall, index))
                    {
                        adopt(project, &breed(&a, &b, self.pages.wall.rounds.next_seed()));
                    }
                }
                None => self.pages.wall.marked = Some(index),
            },
            None => {}
        }
    }

    /// Requests the images of the newest instant if something has changed.
    pub(super) fn send_wall(&mut self) {
        let seen = self.seen();
        let access = self.session.access().clone();
        let playing = self.session.playing;
        let page = &mut self.pages.wall;
        let (Some(wall), Some(frame)) = (&page.wall, self.session.frame.as_ref()) else { return };
        if page.wanted[0] == 0 || page.wanted[1] == 0 {
            return;
        }
        let request = WallRequest {
            project: seen,
            variants: page.rounds.variants().to_vec(),
            access,
            time_secs: frame.time_secs,
            playing,
            size: page.wanted,
        };
        if !page.sent.as_ref().is_some_and(|sent| is_same(sent, &request)) {
            wall.request(request.clone());
            page.sent = Some(request);
        }
    }
}

fn is_same(a: &WallRequest, b: &WallRequest) -> bool {
    Arc::ptr_eq(&a.project, &b.project)
        && a.variants.len() == b.variants.len()
        && a.variants.iter().zip(&b.variants).all(|(a, b)| Arc::ptr_eq(a, b))
        && a.time_secs.to_bits() == b.time_secs.to_bits()
        && (a.playing, a.size) == (b.playing, b.size)
        && a.access == b.access
}

fn is_card(adapter: Option<&lovelock_session::render_thread::Adapter>) -> bool {
    adapter.is_some_and(|adapter| adapter.backend == lovelock_render::Backend::Gpu && !adapter.software)
}

/// The place of a cell on the page.
fn place_of(index: usize, page: Rect) -> Rect {
    let rows = Wall::CELLS / COLUMNS;
    // Whole points keep images sharp.
    let edge =
        |i: usize, of: usize, from: f32, length: f32| (from + (length + GAP) * i as f32 / of as f32).round();
    let (row, column) = (index / COLUMNS, index % COLUMNS);
    let x = |i| edge(i, COLUMNS, page.left(), page.width());
    let y = |i| edge(i, rows, page.top(), page.height());
    Rect::from_min_max(pos2(x(column), y(row)), pos2(x(column + 1) - GAP, y(row + 1) - GAP))
}
