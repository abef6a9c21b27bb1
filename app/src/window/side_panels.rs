//! The columns of panels to the left and to the right of the image.

use egui::{Panel as Column, ScrollArea, Ui};
use lovelock_motion::ColliderEdits;
use lovelock_project::Project;
use lovelock_project::error::Place;

use super::Window;
use super::brushes::Brushes;
use super::command::Command;
use super::compare::PaneEdit;
use super::control::{enter_pane, leave_pane, note, section_with};
use super::focus::{Area, Focus};
use super::health_view::facts;
use super::memory::kept_in_memory;
use super::page::Page;
use super::panel::Panel;
use super::panels::body::BodyPanel;
use super::panels::colliders::CollidersPanel;
use super::panels::hair::{CurvesPanel, HairPanel};
use super::panels::health::HealthPanel;
use super::panels::layers::LayersView;
use super::panels::light::LightPanel;
use super::panels::look::{LookPanel, PicturePanel};
use super::panels::recording::RecordingPanel;
use super::panels::scalp::ScalpPanel;
use super::panels::shadow::ShadowPanel;
use super::panels::simulation::SimulationPanel;
use super::panels::sound::SoundPanel;
use super::panels::statistics::StatisticsPanel;
use super::panels::ties::TiesPanel;
use super::pointer_tool::PointerTool;
use super::readings::Readings;

/// The panels, with what is selected and unfolded in them.
#[derive(Default)]
pub(crate) struct Panels {
    pub(crate) curves: CurvesPanel,
    pub(crate) hair: HairPanel,
    pub(crate) layers: LayersView,
    pub(crate) brushes: Brushes,
    pub(crate) ties: TiesPanel,
    pub(crate) simulation: SimulationPanel,
    pub(crate) colliders: CollidersPanel,
    pub(crate) scalp: ScalpPanel,
    pub(crate) body: BodyPanel,
    pub(crate) shadow: ShadowPanel,
    pub(crate) light: LightPanel,
    pub(crate) look: LookPanel,
    pub(crate) picture: PicturePanel,
    pub(crate) sound: SoundPanel,
    pub(crate) recording: RecordingPanel,
    pub(crate) health: HealthPanel,
    pub(crate) statistics: StatisticsPanel,
}

impl Panels {
    /// The panels to the left, from top to bottom.
    pub(crate) fn left(&mut self) -> [&mut dyn Panel; 9] {
        [
            &mut self.curves,
            &mut self.hair,
            &mut self.layers,
            &mut self.brushes,
            &mut self.ties,
            &mut self.simulation,
            &mut self.colliders,
            &mut self.scalp,
            &mut self.body,
        ]
    }

    /// The panels to the right, from top to bottom.
    pub(crate) fn right(&mut self) -> [&mut dyn Panel; 8] {
        [
            &mut self.shadow,
            &mut self.light,
            &mut self.look,
            &mut self.picture,
            &mut self.sound,
            &mut self.recording,
            &mut self.health,
            &mut self.statistics,
        ]
    }

    /// The panel of that title.
    #[cfg(test)]
    pub(crate) fn by_title(&mut self, title: &str) -> Option<&mut dyn Panel> {
        let of_title = |panels: &[&mut dyn Panel]| panels.iter().position(|panel| panel.title() == title);
        if let Some(at) = of_title(&self.left()) {
            return self.left().into_iter().nth(at);
        }
        let at = of_title(&self.right())?;
        self.right().into_iter().nth(at)
    }
}

/// Shows one panel. Returns what its controls ask the window to do.
fn show(ui: &mut Ui, panel: &mut dyn Panel, project: &mut Project, readings: &Readings<'_>) -> Vec<Command> {
    let (problems, opens) = (panel.problems(readings), panel.opens(project, readings));
    let (asked, clicked) =
        section_with(ui, panel.title(), opens, &problems, |ui| panel.ui(ui, project, readings));
    panel.end_pass(asked.is_some());
    let told = problems.into_iter().filter(|_| clicked).map(Command::Fail);
    asked.flatten().into_iter().chain(told).collect()
}

/// Why the controls to the left are disabled while a take plays.
fn take_note(project: &Project, readings: &Readings<'_>) -> String {
    // In place of the note, so that nothing below it moves more than it must.
    let problem = readings.problems.iter().find(|problem| problem.place == Place::Take);
    let note = if let Some(problem) = problem {
        problem.message.as_str()
    } else if project.plays_curves() {
        "Curves from a file play instead of the simulation. Leave them (Shift+R) to change the hair."
    } else {
        "A take is playing: body and hair move as recorded. Leave the take (Shift+R) to change them."
    };
    note.to_owned()
}

/// Shows panels one below the other: while a take plays, those that cannot be used with one are
/// disabled below the others.
fn column<const N: usize>(
    ui: &mut Ui,
    mut panels: [&mut dyn Panel; N],
    project: &mut Project,
    readings: &Readings<'_>,
    takes: bool,
) -> Vec<Command> {
    panels.sort_by_key(|panel| !panel.edits_takes(project));
    let (mut enabled, mut commands) = (true, Vec::new());
    for panel in panels {
        if !panel.is_shown(project) {
            continue;
        }
        if enabled && takes && !panel.edits_takes(project) {
            ui.disable();
            enabled = false;
        }
        commands.extend(show(ui, panel, project, readings));
    }
    commands
}

impl Window {
    /// Shows the panels at both sides of the image. Returns what their controls ask for.
    pub(super) fn side_panels(&mut self, ui: &mut Ui, project: &mut Project) -> Vec<Command> {
        let ctx = ui.ctx().clone();
        let Self { document, session, layout, pages, tools, panels, media, keyboard, .. } = self;
        let (document, pages_now, media, session_now) = (&*document, &*pages, &*media, &*session);
        let scene = session_now.scene.as_deref();
        let is_replaced = |edits: &ColliderEdits, at: usize| {
            let known = scene.and_then(|scene| Some((scene.fitted.get(at)?, scene)));
            known.is_some_and(|(fitted, scene)| edits.is_replaced(fitted, scene.field.as_deref()))
        };
        let facts = || [facts(session_now), kept_in_memory(session_now, pages_now, media, document)];
        let mut readings = Readings {
            tool: tools.active,
            problems: &session_now.problems,
            hair: &session_now.hair,
            body: &session_now.body,
            surroundings: &session_now.surroundings,
            take_notes: &session_now.take_notes,
            scalp: scene.map(|scene| &*scene.usual_scalp),
            has_skull: scene.is_none_or(|scene| scene.skull.is_some()),
            colliders: scene
                .iter()
                .flat_map(|scene| scene.fitted.iter().map(|of| of.name.as_str()))
                .collect(),
            is_replaced: &is_replaced,
            frame: session_now.frame.as_deref(),
            shadow_bytes: session_now.painted.as_ref().map(|painted| painted.stats.shadow_bytes),
            stages: &session_now.stages,
            passes: &session_now.passes,
            facts: &facts,
            pane: None,
            marked_gauge: tools.marked_gauge.as_ref().map(|gauge| gauge.kind),
            sound: media.soundtrack.loaded().map(|loaded| &**loaded),
            sound_problem: media.soundtrack.problem(),
            duration_secs: session_now.frame.as_ref().map_or(0.0, |frame| frame.duration_secs),
            recording: media.recorder.state(),
            film_frames: session_now.frames(project.recording.fps),
        };
        let mut commands = Vec::new();
        let begin = Focus::begin_area(ui);
        side(Column::left("left"), ui, |ui| {
            let takes = project.take.file.is_some();
            if takes {
                note(ui, take_note(project, &readings));
            }
            commands.extend(column(ui, panels.left(), project, &readings, takes));
        });
        keyboard.focus.end_area(ui, Area::Left, begin);
        let begin = Focus::begin_area(ui);
        let reading =
            (layout.page == Page::Compare).then(|| pages_now.compare.reading(&layout.compare, project));
        let edit = reading.as_ref().and_then(|reading| PaneEdit::begin(project, reading.pane));
        readings.pane = reading.filter(|_| edit.is_some());
        if let Some(pane) = &readings.pane {
            enter_pane(&ctx, pane.pane);
        }
        side(Column::right("right"), ui, |ui| {
            commands.extend(column(ui, panels.right(), project, &readings, false));
        });
        if let Some(edit) = edit {
            leave_pane(&ctx);
            edit.end(project);
        }
        keyboard.focus.end_area(ui, Area::Right, begin);
        let Panels { scalp, recording, statistics, .. } = panels;
        if !scalp.unfolded {
            tools.active.set(PointerTool::Scalp, false);
        }
        let film = &project.recording;
        pages.image.film = recording.unfolded.then_some([film.width, film.height]);
        session.view.measured = statistics.shows_passes;
        commands
    }
}

/// Shows a column of the window, which scrolls.
fn side(column: Column, ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    column.default_size(312.0).size_range(260.0..=460.0).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, add);
    });
}
