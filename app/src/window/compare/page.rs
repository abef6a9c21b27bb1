//! The panes on their page: in a grid, or two of them divided by a line.

use egui::{
    Align2, Color32, CursorIcon, FontId, Id, Pos2, Rect, Response, Sense, Stroke, StrokeKind, Ui, UiBuilder,
    Vec2, pos2, vec2,
};
use lovelock_panes::request::LivePane;
use lovelock_project::Project;
use lovelock_render::ShadowMethod;

use super::costs::Way;
use super::{Window, grid, header};
use crate::window::control::HoverTooltip;
use crate::window::viewport::{self, Viewport};
use crate::window::{camera_control, theme};

/// Distance from the line of the wipe within which the pointer grabs it, points.
const REACH: f32 = 9.0;
/// Width of a pane from which on all its figures have room, points. A narrower one shows its error.
const ALL_FIGURES: f32 = 300.0;

/// The fewest pixels that the limit per pane allows, however many panes there are.
const LEAST_PIXELS: f32 = 640.0 * 360.0;

impl Window {
    /// All panes.
    pub(super) fn grid(
        &mut self,
        ui: &mut Ui,
        page: Rect,
        project: &mut Project,
        flicked: bool,
    ) -> Option<header::PaneAction> {
        let count = project.compare.panes.len();
        let mut asked = None;
        for (index, cell) in grid::places(count, page).into_iter().enumerate() {
            self.pages.compare.bar = header::height(cell.width());
            asked = self.header(ui, cell, index, project).or(asked);
            let mut place = cell;
            place.min.y += self.pages.compare.bar;
            if index == 0 {
                self.want(ui, place, count);
            }
            self.select(ui, cell, index);
            let response = self.steer(ui, place, index, project);
            let [first, second] = self.layout.compare.pair_of(count);
            let other = if index == second { first } else { second };
            let shown = if flicked && response.contains_pointer() { other } else { index };
            self.pane(ui, place, shown, project, Align2::LEFT_BOTTOM);
            if shown != index {
                self.name(ui, place, shown, project, Align2::LEFT_TOP);
            }
            let shape = ui.painter();
            let edge = if shown == index { theme::line() } else { theme::PLOT[shown % theme::PLOT.len()] };
            shape.rect_stroke(place, 0.0, Stroke::new(1.0, edge), StrokeKind::Inside);
            if index == self.pages.compare.edited_pane(&self.layout.compare, project) {
                frame(ui, cell);
            }
        }
        asked
    }

    /// Selects the pane in which the pointer is pressed.
    fn select(&mut self, ui: &Ui, cell: Rect, index: usize) {
        let pressed = ui.input(|input| input.pointer.any_pressed().then(|| input.pointer.interact_pos()));
        let pressed = pressed.flatten().filter(|at| cell.contains(*at));
        // Not through a list or a dialog.
        if pressed.is_some_and(|at| ui.ctx().layer_id_at(at) == Some(ui.layer_id())) {
            self.pages.compare.selected = index;
        }
    }

    /// Two panes, divided by a line.
    pub(super) fn wipe(
        &mut self,
        ui: &mut Ui,
        page: Rect,
        project: &mut Project,
        flicked: bool,
    ) -> Option<header::PaneAction> {
        let mut pair = self.layout.compare.pair_of(project.compare.panes.len());
        let half = 0.5 * page.width();
        self.pages.compare.bar = header::height(half);
        let mut asked = None;
        for (side, index) in pair.into_iter().enumerate() {
            let left = page.left() + half * side as f32;
            let line = Rect::from_min_size(pos2(left, page.top()), vec2(half, page.height()));
            asked = self.header(ui, line, index, project).or(asked);
            self.select(ui, line, index);
            if index == self.pages.compare.edited_pane(&self.layout.compare, project) {
                frame(ui, line.with_max_y(line.top() + self.pages.compare.bar));
            }
            if pair[0] == pair[1] {
                break;
            }
        }
        let mut place = page;
        place.min.y += self.pages.compare.bar;
        self.want(ui, place, 2);
        if flicked {
            pair.reverse();
        }
        let zoom = self.pages.compare.zoom;
        let split = self.layout.compare.split.clamp(0.0, 1.0);
        let x = zoom.to_screen(place, pos2(split, 0.5)).x;
        let near = ui.input(|input| input.pointer.hover_pos()).is_some_and(|at| (at.x - x).abs() < REACH);
        // The line is grabbed where the pointer is pressed and released with the pointer.
        let pressed = ui.input(|input| input.pointer.primary_pressed());
        if pressed && near {
            self.pages.compare.splitting = true;
        } else if !ui.input(|input| input.pointer.primary_down()) {
            self.pages.compare.splitting = false;
        }
        let response = if self.pages.compare.splitting || near {
            let response = ui.interact(place, Id::unique("wipe"), Sense::click_and_drag());
            if self.pages.compare.splitting
                && response.dragged()
                && let Some(at) = response.interact_pointer_pos()
            {
                self.layout.compare.split = zoom.at(place, at).x.clamp(0.0, 1.0);
            }
            response.on_hover_cursor(CursorIcon::ResizeHorizontal)
        } else {
            self.steer(ui, place, pair[0], project)
        };
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Wipe"));
        let x = x.clamp(place.left(), place.right());
        let parts = [
            Rect::from_min_max(place.min, pos2(x, place.bottom())),
            Rect::from_min_max(pos2(x, place.top()), place.max),
        ];
        for ((part, index), (top, bottom)) in parts
            .into_iter()
            .zip(pair)
            .zip([(Align2::LEFT_TOP, Align2::LEFT_BOTTOM), (Align2::RIGHT_TOP, Align2::RIGHT_BOTTOM)])
        {
            if !near && !self.pages.compare.splitting {
                self.select(ui, part, index);
            }
            ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
                ui.set_clip_rect(part.intersect(ui.clip_rect()));
                self.pane(ui, place, index, project, bottom);
                self.name(ui, place, index, project, top);
            });
        }
        let painter = ui.painter_at(place.expand(1.0));
        let strong = if near || self.pages.compare.splitting { theme::accent() } else { Color32::WHITE };
        painter.line_segment([pos2(x, place.top()), pos2(x, place.bottom())], Stroke::new(1.5, strong));
        let knob = pos2(x, place.bottom() - 46.0);
        painter.circle(knob, 10.0, theme::page().gamma_multiply(0.8), Stroke::new(1.5, strong));
        for (side, tip) in [(-1.0, 6.0), (1.0, 6.0)] {
            let arrow =
                [knob + vec2(side * 2.5, -3.5), knob + vec2(side * tip, 0.0), knob + vec2(side * 2.5, 3.5)];
            painter.line(arrow.to_vec(), Stroke::new(1.5, strong));
        }
        asked
    }

    /// The title bar of a pane.
    fn header(
        &self,
        ui: &mut Ui,
        cell: Rect,
        index: usize,
        project: &mut Project,
    ) -> Option<header::PaneAction> {
        let panes = project.compare.panes.len();
        let pane = project.compare.panes.get_mut(index)?;
        let line = Rect::from_min_size(cell.min, vec2(cell.width(), self.pages.compare.bar));
        ui.painter().rect_filled(line, 0.0, theme::panel());
        let drawn = self.pages.compare.panes.get(index).and_then(Option::as_deref);
        header::ui(ui, line, (index, panes), pane, drawn)
    }

    /// The size at which panes that are shown at `place` should be rendered.
    fn want(&mut self, ui: &Ui, place: Rect, panes: usize) {
        let shown = self.pages.compare.panes.iter().take(panes).flatten();
        let each = shown
            .map(|pane| viewport::most_pixels(Some(&pane.adapter)))
            .fold(viewport::most_pixels(self.session.painter().adapter().as_deref()), f32::min);
        let most = (each / panes.max(1) as f32).max(LEAST_PIXELS);
        let points = ui.ctx().pixels_per_point();
        self.pages.compare.wanted = viewport::size_for(place.size(), points, most, self.layout.view_scale);
    }

    /// Applies the pointer's input over a pane to the camera, the magnification and the probe.
    fn steer(&mut self, ui: &Ui, place: Rect, index: usize, project: &mut Project) -> Response {
        let response = ui.interact(place, Id::unique(("pane", index)), Sense::CLICK | Sense::DRAG);
        let name = format!("Pane {}", index + 1);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &name));
        if !self.pages.compare.zoom.apply(&response, place) {
            camera_control::steer(&mut project.camera, self.scene_secs(), &response);
        }
        if response.clicked()
            && !self.pages.compare.menu_open
            && let Some(at) = response.interact_pointer_pos()
        {
            let at = self.pages.compare.zoom.at(place, at);
            self.pages.compare.probe_at(at.x, at.y);
            self.layout.compare.probe = true;
        }
        response
    }

    /// The image of a pane with its status in a corner.
    fn pane(&mut self, ui: &Ui, place: Rect, index: usize, project: &Project, corner: Align2) {
        let painter = ui.painter().with_clip_rect(place.intersect(ui.clip_rect()));
        let compare = &mut self.pages.compare;
        let Some(pane) = compare.panes.get(index).cloned().flatten() else {
            let font = FontId::proportional(14.0);
            painter.text(place.center(), Align2::CENTER_CENTER, "Getting ready…", font, theme::quiet());
            return;
        };
        let zoom = compare.zoom;
        let points = ui.ctx().pixels_per_point();
        let magnified = place.width() * points * zoom.factor() / pane.image.size()[0].max(1) as f32;
        compare.textures.take(ui.ctx(), &self.display.textures, index, &pane, magnified);
        // An image with another aspect ratio was rendered before the page changed.
        let whole = compare.textures.size(index).map_or(place, |size| viewport::fit(size, place));
        let near = (whole.size() - place.size()).abs().max_elem() < 3.0;
        let whole = if near { place } else { whole };
        // An older image below a colour scale would be mistaken for an error.
        if pane.shows.colors().is_none() || !pane.image.is_empty() {
            compare.textures.paint(&painter, index, whole, zoom.shown());
        }
        if compare.probed.is_some() {
            self.mark(ui, whole, &pane, project);
        }
        if let Some(problem) = pane.problem.as_ref().or(pane.colors_problem.as_ref()) {
            tell(&painter, place, problem.clone(), Align2::CENTER_CENTER);
        } else if let Some(problem) = problem_of_method(project, index) {
            let text = format!("{problem}\nThe last version that worked is shown.");
            tell(&painter, place, text, Align2::LEFT_TOP);
        }
        if pane.problem.is_some() {
            return;
        }
        let newest = self.session.frame.as_ref().map_or(0.0, |frame| frame.time_secs);
        let ms = self.pages.compare.costs.of(&pane.contender).map_or(pane.times.whole, Way::whole);
        let mut said = pane.figures_label(ms);
        if let Some(age) = age_label(newest - pane.time_secs) {
            said = format!("{said} · {age}");
        }
        let short = pane.error_label().filter(|_| place.width() < ALL_FIGURES);
        let shown = unbroken(short.as_deref().unwrap_or(&said));
        let line = Viewport::caption(ui, place, corner, &shown, theme::bright());
        let response = ui.interact(
            line,
            Id::unique(("figures", index, place.min.x.to_bits(), place.min.y.to_bits())),
            Sense::hover(),
        );
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &said));
        let text = pane.figures_text();
        response.hover_tooltip(if short.is_some() { format!("{said}\n\n{text}") } else { text });
    }

    /// The name of the pane whose image is visible, in a corner.
    fn name(&self, ui: &Ui, place: Rect, index: usize, project: &Project, corner: Align2) {
        let Some(pane) = project.compare.panes.get(index) else { return };
        let drawn = self.pages.compare.panes.get(index).and_then(Option::as_deref);
        let label =
            drawn.filter(|drawn| drawn.contender == *pane).map_or_else(|| pane.label(), LivePane::label);
        let text = format!("{} · {label}", index + 1);
        Viewport::caption(ui, place, corner, &text, theme::PLOT[index % theme::PLOT.len()]);
    }

    /// A ring around the hair whose transmittance is plotted.
    fn mark(&self, ui: &Ui, place: Rect, pane: &LivePane, project: &Project) {
        let probed = self.pages.compare.probed.as_deref().filter(|_| self.layout.compare.probe);
        let Some(hair) = probed.and_then(|probed| probed.hair.as_ref()) else { return };
        let camera = self.session.frame.as_ref().map_or(pane.camera, |frame| frame.camera(&project.camera));
        let aspect = place.width() / place.height().max(1.0);
        let clip = camera.clip_from_world(aspect) * hair.position.extend(1.0);
        if clip.w <= 0.0 {
            return;
        }
        let at = pos2(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
        let at: Pos2 = self.pages.compare.zoom.to_screen(place, at);
        let painter = ui.painter().with_clip_rect(place.intersect(ui.clip_rect()));
        painter.circle_stroke(at, 7.0, Stroke::new(3.0, theme::page().gamma_multiply(0.7)));
        painter.circle_stroke(at, 7.0, Stroke::new(1.5, theme::accent()));
        for side in [Vec2::X, Vec2::Y, -Vec2::X, -Vec2::Y] {
            painter.line_segment([at + side * 7.0, at + side * 11.0], Stroke::new(1.5, theme::accent()));
        }
    }
}

/// What is wrong with the files of a pane's method, if it is one of the user's own.
fn problem_of_method(project: &Project, index: usize) -> Option<String> {
    match project.compare.panes.get(index)?.shadow.method {
        ShadowMethod::User(method) => method.problem(),
        _ => None,
    }
}

/// Writes a problem over a pane.
fn tell(painter: &egui::Painter, place: Rect, text: String, corner: Align2) {
    let room = place.shrink(14.0);
    let galley = painter.layout(text, FontId::proportional(12.5), theme::wrong(), room.width());
    let at = corner.align_size_within_rect(galley.size(), room);
    painter.rect_filled(at.expand(8.0), 5.0, theme::page().gamma_multiply(0.85));
    painter.galley(at.min, galley, theme::wrong());
}

/// The frame of the pane that the panels edit.
fn frame(ui: &Ui, cell: Rect) {
    ui.painter().rect_stroke(cell, 0.0, Stroke::new(2.0, theme::accent()), StrokeKind::Inside);
}

/// A line whose items, between dots, are not broken where it is too long for its pane.
fn unbroken(line: &str) -> String {
    line.replace(' ', "\u{a0}").replace("·\u{a0}", "· ")
}

/// The age of a pane as text.
fn age_label(secs: f64) -> Option<String> {
    match secs {
        // One step of the simulation is not reported.
        secs if secs < 0.025 => None,
        secs if secs < 0.95 => Some(format!("{:.0} ms old", 1e3 * secs)),
        secs => Some(format!("{secs:.1} s old")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_break_at_dots_alone() {
        assert_eq!(unbroken("5.6 ms CPU · 48.3 MiB"), "5.6\u{a0}ms\u{a0}CPU\u{a0}· 48.3\u{a0}MiB");
    }

    #[test]
    fn a_pane_says_its_age_when_it_has_one() {
        let said = [-1.0, 0.0, 0.12, 2.0].map(age_label);
        assert_eq!(said, [None, None, Some("120 ms old".to_owned()), Some("2.0 s old".to_owned())]);
    }
}
