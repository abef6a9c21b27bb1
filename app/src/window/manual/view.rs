//! How the manual is drawn: contents and search at the left, the page at the right.

use egui::{
    Align, FontFamily, FontId, Label, Layout, Rect, RichText, ScrollArea, Sense, TextWrapMode, Ui, vec2,
};

use super::page::{Block, Page, Span};
use super::pages::{self, PAGES};
use super::{Manual, Place};
use crate::window::control::HoverTooltip;
use crate::window::search::{best_first, fit};
use crate::window::theme;

/// Width of the contents, points.
const CONTENTS: f32 = 210.0;
/// Widest lines of text, points.
const WIDEST: f32 = 760.0;
/// Indent of a list, points.
const INDENT: f32 = 18.0;
/// Time for which a place is marked, seconds.
const MARK_SECS: f64 = 2.5;
/// The most matches that are listed.
const MATCHES: usize = 60;

/// A heading and the text below it, for the search.
struct Section {
    place: Place,
    name: String,
    text: String,
}

fn sections() -> &'static [Section] {
    static SECTIONS: std::sync::OnceLock<Vec<Section>> = std::sync::OnceLock::new();
    SECTIONS.get_or_init(|| {
        let mut all = Vec::new();
        for (number, source) in PAGES.iter().enumerate() {
            let page = source.page();
            for (at, block) in page.blocks.iter().enumerate() {
                if matches!(block, Block::Heading { .. }) {
                    let place = Place { page: number, block: at };
                    all.push(Section { place, name: block.text(), text: String::new() });
                } else if let Some(last) = all.last_mut() {
                    last.text.push_str(&block.text());
                    last.text.push(' ');
                }
            }
        }
        all
    })
}

impl Manual {
    pub(super) fn contents(&mut self, ui: &mut Ui) {
        let size = ui.available_size();
        let mut goto = None;
        let mut link = None;
        ui.horizontal_top(|ui| {
            ui.allocate_ui_with_layout(vec2(CONTENTS, size.y), Layout::top_down(Align::Min), |ui| {
                ui.set_width(CONTENTS);
                goto = self.list(ui);
            });
            ui.separator();
            ui.vertical(|ui| link = self.page(ui));
        });
        if let Some(place) = goto {
            self.show_place(place);
        } else if let Some(link) = link {
            self.follow(ui.ctx(), &link);
        }
    }

    /// The search with its matches, or the contents. Returns the place that was chosen.
    fn list(&mut self, ui: &mut Ui) -> Option<Place> {
        let mut goto = None;
        ui.horizontal(|ui| {
            let back = ui.add_enabled(!self.before.is_empty(), egui::Button::new("Back"));
            if back.hover_tooltip("Goes back to the previous place.").clicked() {
                self.back();
            }
        });
        let (field, picked) = self.search.field(ui, "Search the manual", CONTENTS - 8.0, false);
        if std::mem::take(&mut self.is_new) {
            field.request_focus();
        }
        let typed = self.search.typed.clone();
        ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
        ScrollArea::vertical().id_salt("contents").auto_shrink(false).show(ui, |ui| {
            if typed.trim().is_empty() {
                for (number, source) in PAGES.iter().enumerate() {
                    let page = source.page();
                    let is_open = number == self.at.page;
                    if ui.selectable_label(is_open, page.title()).clicked() {
                        goto = Some(Place { page: number, block: 0 });
                    }
                    if is_open {
                        for (block, level, name) in page.headings().filter(|(_, level, _)| *level <= 3) {
                            ui.horizontal(|ui| {
                                ui.add_space(INDENT * (level as f32 - 1.0));
                                let text = RichText::new(name).small();
                                if ui.selectable_label(false, text).clicked() {
                                    goto = Some(Place { page: number, block });
                                }
                            });
                        }
                    }
                }
                return;
            }
            let mut found =
                best_first(&typed, sections(), |typed, section| fit(typed, &section.name, &[&section.text]));
            found.truncate(MATCHES);
            self.search.among(found.len());
            for (i, section) in found.iter().enumerate() {
                let chosen = self.search.is_chosen(i);
                let row = ui.selectable_label(chosen, &section.name);
                let row = row.hover_tooltip(PAGES[section.place.page].page().title());
                self.search.show(i, &row);
                if row.clicked() || (picked.entered && chosen) {
                    goto = Some(section.place);
                }
            }
            if found.is_empty() {
                ui.weak("No page contains this text.");
            }
        });
        goto
    }

    /// The page. Returns the link that was clicked.
    fn page(&mut self, ui: &mut Ui) -> Option<String> {
        let page = PAGES[self.at.page].page();
        let mut link = None;
        let mut area = ScrollArea::vertical().id_salt(("page", self.at.page)).auto_shrink(false);
        if self.goal == Some(0) {
            area = area.vertical_scroll_offset(0.0);
            self.goal = None;
        }
        area.show_viewport(ui, |ui, seen| {
            let width = (ui.available_width() - 14.0).min(WIDEST);
            ui.set_width(width);
            let (number, before, heights) = &self.heights;
            let is_known = *number == self.at.page
                && (*before - width).abs() < 0.5
                && heights.len() == page.blocks.len();
            let top = ui.cursor().top();
            let mut heights = Vec::with_capacity(page.blocks.len());
            for (at, block) in page.blocks.iter().enumerate() {
                let start = ui.cursor().top();
                let known = if is_known { Some(self.heights.2[at]) } else { None };
                let place = Place { page: self.at.page, block: at };
                let is_goal = self.goal == Some(at);
                // What is out of sight is not laid out again.
                let y = start - top;
                if let Some(height) = known
                    && !is_goal
                    && (y + height < seen.top() - 200.0 || y > seen.bottom() + 200.0)
                {
                    ui.add_space(height - ui.spacing().item_spacing.y);
                    ui.allocate_space(vec2(width, 0.0));
                    heights.push(height);
                    continue;
                }
                self.mark(ui, place, known);
                link = self.block(ui, page, block, width).or(link.take());
                let end = ui.cursor().top();
                heights.push(end - start);
                if is_goal {
                    let rect = Rect::from_min_max([ui.min_rect().left(), start].into(), [width, end].into());
                    ui.scroll_to_rect_animation(rect, Some(Align::Min), egui::style::ScrollAnimation::none());
                    if is_known {
                        self.goal = None;
                    }
                    ui.ctx().request_repaint();
                }
            }
            self.heights = (self.at.page, width, heights);
        });
        link
    }

    /// Draws a mark behind a block that was jumped to.
    fn mark(&mut self, ui: &Ui, place: Place, height: Option<f32>) {
        let now = ui.input(|input| input.time);
        let Some((marked, since)) = &mut self.marked else { return };
        let Some(height) = height.filter(|_| *marked == place) else { return };
        let age = now - *since.get_or_insert(now);
        if age > MARK_SECS {
            self.marked = None;
            return;
        }
        let strength = (1.0 - age / MARK_SECS) as f32;
        let rect = Rect::from_min_size(ui.cursor().min, vec2(ui.available_width(), height));
        ui.painter().rect_filled(rect, 3.0, theme::accent().gamma_multiply(0.3 * strength));
        ui.ctx().request_repaint();
    }

    fn block(&mut self, ui: &mut Ui, page: &Page, block: &Block, width: f32) -> Option<String> {
        match block {
            Block::Heading { level, spans, .. } => {
                let size = [20.0, 16.0, 14.0][level.saturating_sub(1).min(2)];
                ui.add_space(if std::ptr::eq(block, &raw const page.blocks[0]) { 0.0 } else { 8.0 });
                line(ui, spans, Some(size))
            }
            Block::Text { depth, marker, spans } => {
                if *depth == 0 {
                    return line(ui, spans, None);
                }
                ui.horizontal_top(|ui| {
                    ui.add_space(INDENT * (*depth as f32 - 1.0));
                    let place = vec2(INDENT, ui.spacing().interact_size.y);
                    ui.allocate_ui_with_layout(place, Layout::right_to_left(Align::Min), |ui| {
                        ui.set_width(INDENT);
                        ui.label(marker.as_deref().unwrap_or(""));
                    });
                    ui.vertical(|ui| line(ui, spans, None)).inner
                })
                .inner
            }
            Block::Code(text) => {
                egui::Frame::new().fill(theme::page()).inner_margin(6.0).corner_radius(3.0).show(ui, |ui| {
                    ui.set_width(width - 14.0);
                    ui.add(Label::new(RichText::new(text).monospace().size(11.5)).wrap());
                });
                None
            }
            Block::Picture { path, text } => {
                self.picture(ui, path, text, width);
                None
            }
            Block::Row { is_head, widths, cells } => row(ui, *is_head, widths, cells, width),
            Block::Rule => {
                ui.separator();
                None
            }
        }
    }

    fn picture(&mut self, ui: &mut Ui, path: &str, text: &str, width: f32) {
        let texture = pages::picture(path).and_then(|file| {
            let key = pages::key(path)?;
            let load = || {
                let pixels = image::load_from_memory(file).ok()?.to_rgba8();
                let size = [pixels.width() as usize, pixels.height() as usize];
                let image = egui::ColorImage::from_rgba_unmultiplied(size, pixels.as_raw());
                Some(ui.ctx().load_texture(path, image, egui::TextureOptions::LINEAR))
            };
            self.pictures.entry(key).or_insert_with(load).clone()
        });
        match texture {
            Some(texture) => {
                let size = texture.size_vec2();
                let scale = (width / size.x).min(1.0);
                let response = ui.add(egui::Image::new((texture.id(), size * scale)));
                response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, text));
                ui.label(RichText::new(text).small().color(theme::quiet()));
            }
            None => {
                ui.label(RichText::new(format!("Picture: {text}")).color(theme::quiet()));
            }
        }
    }
}

/// A row of a table.
fn row(ui: &mut Ui, is_head: bool, widths: &[f32], cells: &[Vec<Span>], width: f32) -> Option<String> {
    let mut link = None;
    let air = 10.0;
    let room = width - air * widths.len() as f32;
    let shown = ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = air;
        for (cell, share) in cells.iter().zip(widths) {
            let place = vec2(room * share, 0.0);
            ui.allocate_ui_with_layout(place, Layout::top_down(Align::Min), |ui| {
                ui.set_width(place.x);
                if is_head {
                    let strong = cell.iter().map(|span| Span { is_strong: true, ..span.clone() });
                    link = line(ui, &strong.collect::<Vec<_>>(), None).or(link.take());
                } else {
                    link = line(ui, cell, None).or(link.take());
                }
            });
        }
    });
    let y = shown.response.rect.bottom() + 1.0;
    ui.painter().hline(shown.response.rect.x_range(), y, egui::Stroke::new(1.0, theme::line()));
    link
}

/// Text that wraps. Returns the link that was clicked.
fn line(ui: &mut Ui, spans: &[Span], size: Option<f32>) -> Option<String> {
    let mut link = None;
    let size = size.unwrap_or(12.5);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(0.0, 2.0);
        let mut job = egui::text::LayoutJob::default();
        let flush = |ui: &mut Ui, job: &mut egui::text::LayoutJob| {
            if !job.is_empty() {
                ui.add(Label::new(std::mem::take(job)).wrap());
            }
        };
        for span in spans {
            if let Some(to) = span.link.as_ref().filter(|link| pages::leads(link)) {
                flush(ui, &mut job);
                let text = RichText::new(&span.text).size(size).color(theme::accent());
                let response = ui.add(Label::new(text).wrap().sense(Sense::click()));
                let name = span.text.clone();
                response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Link, true, &name));
                let response = response.on_hover_cursor(egui::CursorIcon::PointingHand);
                if response.hover_tooltip(to).clicked() {
                    link = Some(to.clone());
                }
            } else {
                let family = if span.is_code { FontFamily::Monospace } else { FontFamily::Proportional };
                let font = FontId::new(if span.is_code { size - 1.0 } else { size }, family);
                let color = if span.is_strong || span.is_emphasis || size > 13.0 {
                    theme::bright()
                } else {
                    ui.visuals().text_color()
                };
                let format =
                    egui::TextFormat { italics: span.is_emphasis, ..egui::TextFormat::simple(font, color) };
                job.append(&span.text, 0.0, format);
            }
        }
        flush(ui, &mut job);
    });
    link
}
