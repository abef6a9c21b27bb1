//! The panels in one list, and what shows them wherever they are.

use std::sync::LazyLock;

use egui::{Response, Ui};
use lovelock_project::Project;
use lovelock_project::error::Place;

use super::brushes::Brushes;
use super::command::Command;
use super::compare::PaneEdit;
use super::control::{Headed, enter_pane, leave_pane, note, section_with, spoken_part, untitled_section};
use super::panel::Panel;
use super::panels::body::BodyPanel;
use super::panels::body_look::BodyLookPanel;
use super::panels::camera::CameraPanel;
use super::panels::colliders::CollidersPanel;
use super::panels::face::FacePanel;
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
use super::readings::{PaneReading, Readings};

/// A column beside the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Left,
    Right,
}

impl Side {
    pub(crate) const ALL: [Self; 2] = [Self::Left, Self::Right];
}

/// The titles of the columns, from top to bottom.
pub(crate) type Columns = [Vec<&'static str>; 2];

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
    pub(crate) face: FacePanel,
    pub(crate) shadow: ShadowPanel,
    pub(crate) light: LightPanel,
    pub(crate) camera: CameraPanel,
    pub(crate) look: LookPanel,
    pub(crate) body_look: BodyLookPanel,
    pub(crate) picture: PicturePanel,
    pub(crate) sound: SoundPanel,
    pub(crate) recording: RecordingPanel,
    pub(crate) health: HealthPanel,
    pub(crate) statistics: StatisticsPanel,
}

impl Panels {
    /// The panels to the left, from top to bottom.
    pub(crate) fn left(&mut self) -> [&mut dyn Panel; 10] {
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
            &mut self.face,
        ]
    }

    /// The panels to the right, from top to bottom.
    pub(crate) fn right(&mut self) -> [&mut dyn Panel; 10] {
        [
            &mut self.shadow,
            &mut self.light,
            &mut self.camera,
            &mut self.look,
            &mut self.body_look,
            &mut self.picture,
            &mut self.sound,
            &mut self.recording,
            &mut self.health,
            &mut self.statistics,
        ]
    }

    /// The panel of that title, and the column that it has by default.
    pub(crate) fn by_title(&mut self, title: &str) -> Option<(Side, &mut dyn Panel)> {
        let of_title = |panels: &[&mut dyn Panel]| panels.iter().position(|panel| panel.title() == title);
        if let Some(at) = of_title(&self.left()) {
            return self.left().into_iter().nth(at).map(|panel| (Side::Left, panel));
        }
        let at = of_title(&self.right())?;
        self.right().into_iter().nth(at).map(|panel| (Side::Right, panel))
    }

    /// The titles of the columns as they are by default.
    pub(crate) fn usual() -> &'static Columns {
        static USUAL: LazyLock<Columns> = LazyLock::new(|| {
            let mut panels = Panels::default();
            let left = panels.left().map(|panel| panel.title()).to_vec();
            [left, panels.right().map(|panel| panel.title()).to_vec()]
        });
        &USUAL
    }
}

/// The panels in one pass, with what they edit and read.
pub(crate) struct Shelf<'a> {
    panels: &'a mut Panels,
    project: &'a mut Project,
    readings: Readings<'a>,
    /// The pane of the comparison that panels of the right column edit.
    pane: Option<PaneReading>,
    /// Whether a take plays.
    takes: bool,
    /// What the controls ask the window to do.
    commands: Vec<Command>,
}

impl<'a> Shelf<'a> {
    /// The panels of a pass that edit `project`. Those of the right column edit the `pane` of the comparison, if there is one.
    pub(crate) fn new(
        panels: &'a mut Panels,
        project: &'a mut Project,
        readings: Readings<'a>,
        pane: Option<PaneReading>,
    ) -> Self {
        let takes = project.take.file.is_some();
        Self { panels, project, readings, pane, takes, commands: Vec::new() }
    }

    /// What the controls have asked the window to do.
    pub(crate) fn commands(self) -> Vec<Command> {
        self.commands
    }

    /// Whether a panel is listed at present.
    pub(crate) fn is_shown(&mut self, title: &str) -> bool {
        self.panels.by_title(title).is_some_and(|(_, panel)| panel.is_shown(self.project))
    }

    /// Whether a panel is disabled because a take plays.
    pub(crate) fn is_disabled(&mut self, title: &str) -> bool {
        let Some((side, panel)) = self.panels.by_title(title).filter(|_| self.takes) else { return false };
        side == Side::Left && !panel.edits_takes(self.project)
    }

    /// Whether a take changes what a panel can do.
    pub(crate) fn is_of_takes(&mut self, title: &str) -> bool {
        self.takes && self.panels.by_title(title).is_some_and(|(side, _)| side == Side::Left)
    }

    /// Says why panels are disabled while a take plays.
    pub(crate) fn note(&self, ui: &mut Ui) {
        note(ui, take_note(self.project, &self.readings));
    }

    /// Shows a panel below its header, which folds it and is returned.
    pub(crate) fn headed(&mut self, ui: &mut Ui, title: &str) -> Option<Response> {
        self.show(ui, title, true)
    }

    /// Shows a panel whose title stands elsewhere.
    pub(crate) fn untitled(&mut self, ui: &mut Ui, title: &str) {
        self.show(ui, title, false);
    }

    /// Notes that the controls of a panel are not visible.
    pub(crate) fn hide(&mut self, title: &str) {
        if let Some((_, panel)) = self.panels.by_title(title) {
            panel.end_pass(false);
        }
    }

    fn show(&mut self, ui: &mut Ui, title: &str, has_header: bool) -> Option<Response> {
        let Self { panels, project, readings, pane, commands, .. } = self;
        let (side, panel) = panels.by_title(title)?;
        let pane = pane.clone().filter(|_| side == Side::Right);
        let edit = pane.as_ref().and_then(|pane| PaneEdit::begin(project, pane.pane));
        readings.pane = pane.filter(|_| edit.is_some());
        if let Some(pane) = &readings.pane {
            enter_pane(ui.ctx(), pane.pane);
        }
        let (problems, opens) = (panel.problems(readings), panel.opens(project, readings));
        let title = panel.title();
        let contents = |ui: &mut Ui| {
            // In a column, floating or in a tab, screen readers tell which panel a control belongs to.
            spoken_part(ui, title);
            panel.ui(ui, project, readings)
        };
        let shown = if has_header {
            section_with(ui, title, opens, &problems, contents)
        } else {
            for problem in &problems {
                ui.colored_label(ui.visuals().error_fg_color, problem);
            }
            let inner = untitled_section(ui, title, contents);
            Headed { inner: Some(inner), header: None, is_mark_clicked: false }
        };
        panel.end_pass(shown.inner.is_some());
        if let Some(edit) = edit {
            leave_pane(ui.ctx());
            edit.end(project);
        }
        readings.pane = None;
        let told = problems.into_iter().filter(|_| shown.is_mark_clicked).map(Command::Fail);
        commands.extend(shown.inner.flatten().into_iter().chain(told));
        shown.header
    }
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
