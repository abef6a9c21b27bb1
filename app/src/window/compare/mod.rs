//! Several renderings of the same hair at the same instant, side by side.

mod bar;
mod cost_plot;
mod costs;
mod grid;
mod header;
mod layout;
mod legend;
mod page;
mod probe_plot;
mod report;
mod save;
mod selected;
mod texture;
mod zoom;

pub(crate) use layout::CompareLayout;

use std::sync::Arc;

use costs::Costs;
use egui::{CentralPanel, Frame, Key, Panel, Rect, Ui};
use lovelock_panes::live::Live;
use lovelock_panes::probe::{LiveProbe, ProbePlace};
use lovelock_panes::request::{LivePane, LiveRequest};
use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_project::project::{CompareSection, Contender};
use lovelock_session::snapshot::FrameSnapshot;
use report::Reporting;
use save::Saving;
pub(super) use selected::PaneEdit;
use texture::PaneTextures;
use zoom::Zoom;

use super::Window;
use super::command::Command;
use super::control::is_any_open;
use super::readings::PaneReading;

/// The state of the comparison, and its last request.
#[derive(Default)]
pub(crate) struct Compare {
    panes: [Option<Arc<LivePane>>; CompareSection::MAX_PANES],
    seen: [u64; CompareSection::MAX_PANES],
    seen_notices: u64,
    seen_probe: u64,
    textures: PaneTextures,
    zoom: Zoom,
    costs: Costs,
    /// The hair that was probed, and the result.
    place: Option<ProbePlace>,
    probed: Option<Arc<LiveProbe>>,
    /// Requested size of panes, pixels.
    wanted: [u32; 2],
    /// Size of the page that the panes share, points.
    page: egui::Vec2,
    /// Height of the panes' title bars, points.
    bar: f32,
    /// The pane that the panels edit.
    pub(super) selected: usize,
    /// Whether the line of the wipe is being dragged.
    splitting: bool,
    /// Whether a menu was open when the pointer was pressed: the click then only closes it.
    menu_open: bool,
    saving: Vec<Saving>,
    /// The report that is being written, and the dialog for the next one.
    pub(super) reporting: Reporting,
    sent: Option<LiveRequest>,
}

impl Compare {
    /// Collects the results of the thread. Returns messages for the user.
    pub(crate) fn update(&mut self, live: &Live) -> Vec<String> {
        for (index, (seen, held)) in self.seen.iter_mut().zip(&mut self.panes).enumerate() {
            if let Some(pane) = live.pane(index).and_then(|slot| slot.newer_than(seen)) {
                // An image that the device has not finished yet comes again with its time.
                if pane.times.whole > 0.0 {
                    self.costs.push(&pane);
                }
                *held = Some(pane);
            }
        }
        if let Some(probed) = live.probe().newer_than(&mut self.seen_probe) {
            self.probed = Some(probed);
        }
        live.notices().newer_than(&mut self.seen_notices).map(|said| (*said).clone()).into_iter().collect()
    }

    /// Requests the panes of the newest frame if something has changed.
    pub(crate) fn send(
        &mut self,
        live: &Live,
        (project, access): (&Arc<Project>, &Access),
        frame: Option<&Arc<FrameSnapshot>>,
        layout: &CompareLayout,
        playing: bool,
    ) {
        let [width, height] = self.wanted;
        let Some(frame) = frame.filter(|_| width > 0 && height > 0) else { return };
        let request = LiveRequest {
            project: Arc::clone(project),
            access: access.clone(),
            snapshot: Arc::clone(frame),
            panes: layout.visible(project.compare.panes.len()),
            width,
            height,
            // All panes must show one instant; while time stands still every pane is rendered.
            together: layout.wipe || playing,
            view: layout.view(),
            probe: self.place.filter(|_| layout.probe),
        };
        if !self.sent.as_ref().is_some_and(|sent| is_same(sent, &request)) {
            live.request(request.clone());
            self.sent = Some(request);
        }
    }

    /// The newest image of a pane.
    #[cfg(test)]
    pub(crate) fn pane(&self, index: usize) -> Option<&Arc<LivePane>> {
        self.panes.get(index)?.as_ref()
    }

    /// The hair whose transmittance is plotted.
    #[cfg(test)]
    pub(crate) fn probed_hair(&self) -> Option<&lovelock_panes::probe::ProbedHair> {
        self.probed.as_ref()?.hair.as_ref()
    }

    /// The numbers of the last answered request and of the last request.
    #[cfg(test)]
    pub(crate) fn probed_and_asked(&self) -> [u64; 2] {
        [self.probed.as_ref().map_or(0, |probed| probed.number), self.place.map_or(0, |place| place.number)]
    }

    /// Forgets all images, whose device is lost, and asks for them again.
    pub(crate) fn forget_images(&mut self) {
        self.textures.keep(0);
        self.panes = Default::default();
        self.sent = None;
    }

    /// Asks for all panes again, because what draws them has changed. The last images stay until then.
    pub(crate) fn ask_again(&mut self) {
        self.sent = None;
    }

    /// Forgets the costs and the probe of a project that is closed.
    pub(crate) fn forget_project(&mut self) {
        (self.costs, self.place, self.probed) = (Costs::default(), None, None);
    }

    /// Gives back images, and what the thread keeps, because the panes are not shown. Returns whether there was anything.
    pub(crate) fn leave(&mut self, live: &Live) -> bool {
        if self.sent.is_none() && self.probed.is_none() && self.panes.iter().all(Option::is_none) {
            return false;
        }
        self.forget_images();
        self.probed = None;
        live.rest();
        true
    }

    /// Requested size of panes, pixels.
    pub(crate) fn wanted(&self) -> [u32; 2] {
        self.wanted
    }

    /// Whether any pane has an image.
    pub(crate) fn has_pictures(&self) -> bool {
        self.panes.iter().flatten().any(|pane| !pane.image.is_empty())
    }

    /// Requests a probe of the hair at a position in the images, as fractions from the left and the top.
    fn probe_at(&mut self, x: f32, y: f32) {
        let number = self.place.map_or(1, |place| place.number + 1);
        self.place = Some(ProbePlace { number, x, y });
    }
}

/// Whether two requests are equal.
fn is_same(a: &LiveRequest, b: &LiveRequest) -> bool {
    Arc::ptr_eq(&a.project, &b.project)
        && Arc::ptr_eq(&a.snapshot, &b.snapshot)
        && a.access == b.access
        && (&a.panes, a.width, a.height, a.together, a.view, a.probe)
            == (&b.panes, b.width, b.height, b.together, b.view, b.probe)
}

/// A pane for the next method that no pane shows, or else one with the project's own settings.
fn next_pane(project: &Project) -> Contender {
    let panes = &project.compare.panes;
    let methods = lovelock_render::ShadowMethod::ALL;
    let shown = |method| panes.iter().any(|pane| pane.shadow.method == method);
    let mut next = Contender::of(project);
    if let Some(&method) = methods.iter().find(|&&method| !shown(method)) {
        next.shadow.method = method;
    }
    next
}

impl Compare {
    /// The pane that the panels edit.
    fn edited_pane(&self, layout: &CompareLayout, project: &Project) -> usize {
        selected::of(layout, self.selected, project.compare.panes.len())
    }

    /// What the panels show of the pane that they edit.
    pub(super) fn reading(&self, layout: &CompareLayout, project: &Project) -> PaneReading {
        let pane = self.edited_pane(layout, project);
        let drawn = self.panes.get(pane).and_then(Option::as_ref);
        let maps = drawn
            .filter(|drawn| drawn.problem.is_none())
            .map(|drawn| (drawn.shadow_bytes, drawn.shadow_fallbacks));
        PaneReading { pane, visible: layout.visible(project.compare.panes.len()), maps }
    }
}

impl Window {
    /// Shows the panes in place of the image. Returns what the toolbar asks for.
    pub(super) fn comparison(&mut self, ui: &mut Ui, project: &mut Project) -> Option<Command> {
        let ctx = ui.ctx().clone();
        // Must be read before this pass closes the menu.
        let open = is_any_open(&ctx);
        if ctx.input(|input| input.pointer.any_pressed()) {
            self.pages.compare.menu_open = open;
        }
        self.pages.compare.menu_open |= open;
        let mut command = None;
        CentralPanel::default().frame(Frame::NONE).show(ui, |ui| {
            let layout = &mut self.layout.compare;
            let magnified = self.pages.compare.zoom.factor();
            let asked =
                Panel::top("compare bar").show(ui, |ui| bar::ui(ui, layout, project, magnified)).inner;
            match asked {
                Some(bar::ToolbarAction::Add) => {
                    let next = next_pane(project);
                    project.compare.panes.push(next);
                    project.compare.panes.truncate(CompareSection::MAX_PANES);
                    self.pages.compare.selected = project.compare.panes.len() - 1;
                }
                Some(bar::ToolbarAction::WholePicture) => self.pages.compare.zoom = Zoom::default(),
                Some(bar::ToolbarAction::Run(asked)) => command = Some(asked),
                None => {}
            }
            self.dock(ui, project);
            let layout = &self.layout.compare;
            if layout.shows.colors().is_some() {
                Panel::bottom("compare legend")
                    .show_separator_line(false)
                    .show(ui, |ui| legend::ui(ui, layout.shows, layout.largest));
            }
            let page = ui.available_rect_before_wrap();
            ui.painter().rect_filled(page, 0.0, super::theme::page());
            self.pages.compare.page = page.size();
            self.panes(ui, page, project);
            // Below the title bars of the panes, whose buttons stay clickable.
            self.running(ui, page.with_min_y(page.top() + self.pages.compare.bar));
        });
        command
    }

    /// Shows the plots below the panes.
    fn dock(&mut self, ui: &mut Ui, project: &Project) {
        let layout = &mut self.layout.compare;
        let (probe, costs) = (layout.probe, layout.costs);
        if !probe && !costs {
            return;
        }
        let panes = layout.visible(project.compare.panes.len());
        let compare = &self.pages.compare;
        Panel::bottom("compare dock").resizable(true).default_size(270.0).size_range(170.0..=460.0).show(
            ui,
            |ui| {
                let mut draw = |ui: &mut Ui, is_probe: bool| {
                    if is_probe {
                        let asked = compare.place.is_some();
                        probe_plot::ui(ui, asked, compare.probed.as_deref(), project, &panes);
                    } else {
                        cost_plot::ui(ui, &mut layout.cost_plot, &compare.costs, project, &panes);
                    }
                };
                if probe && costs {
                    ui.columns(2, |columns| {
                        draw(&mut columns[0], true);
                        draw(&mut columns[1], false);
                    });
                } else {
                    draw(ui, probe);
                }
            },
        );
    }

    /// Shows the panes on their page.
    fn panes(&mut self, ui: &mut Ui, page: Rect, project: &mut Project) {
        let count = project.compare.panes.len();
        self.pages.compare.textures.keep(count);
        let typing = ui.ctx().egui_wants_keyboard_input() || crate::window::key_press::are_held(ui.ctx());
        let flicked = !typing && ui.input(|input| input.key_down(Key::V) && input.modifiers.is_none());
        let asked = if self.layout.compare.wipe {
            self.wipe(ui, page, project, flicked)
        } else {
            self.grid(ui, page, project, flicked)
        };
        let panes = &mut project.compare.panes;
        let selected = &mut self.pages.compare.selected;
        match asked {
            Some(header::PaneAction::Use(index)) => {
                if let Some(pane) = panes.get(index).cloned() {
                    let used = pane.applied_to(project);
                    if used == *project {
                        let said = format!("The project already has the settings of pane {}.", index + 1);
                        self.notices.push(super::notices::Kind::Warning, said);
                    }
                    *project = used;
                }
            }
            Some(header::PaneAction::Swap(index)) if index + 1 < panes.len() => {
                panes.swap(index, index + 1);
                // The selection follows its pane.
                if *selected == index {
                    *selected = index + 1;
                } else if *selected == index + 1 {
                    *selected = index;
                }
            }
            Some(header::PaneAction::Remove(index)) if panes.len() > 1 && index < panes.len() => {
                panes.remove(index);
                *selected -= usize::from(*selected > index);
            }
            Some(header::PaneAction::Swap(_) | header::PaneAction::Remove(_)) | None => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use lovelock_render::ShadowMethod;

    use super::*;

    #[test]
    fn a_new_pane_shows_what_none_shows_and_then_the_projects_own() {
        let mut project = Project::default();
        project.compare.panes.clear();
        for &method in ShadowMethod::ALL {
            let next = next_pane(&project);
            assert_eq!(next.shadow.method, method);
            project.compare.panes.push(next);
        }
        assert_eq!(next_pane(&project), Contender::of(&project));
    }
}
