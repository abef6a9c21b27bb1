//! The panels to the left and to the right of the image.

use egui::{Panel, ScrollArea, Ui};
use lovelock_project::Project;
use lovelock_project::error::Place;
use lovelock_project::project::RecordingSection;
use lovelock_render::HairDrawing;

use super::control::{enter_pane, leave_pane, section, section_with};
use super::path_dialog::Purpose;
use super::pointer_tool::PointerTool;
use super::{Window, camera_control, panels};

impl Window {
    pub(super) fn left_panel(&mut self, ui: &mut Ui, project: &mut Project) {
        let mut asked = None;
        Panel::left("left").default_size(312.0).size_range(260.0..=460.0).show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                let curves = project.plays_curves();
                if project.take.file.is_some() {
                    let problems = self.problems(&[Place::Take]);
                    // In place of the note, so that nothing below it moves more than it must.
                    let note = if let Some(problem) = problems.first() {
                        problem.as_str()
                    } else if curves {
                        "Curves from a file play instead of the simulation. Leave them (Shift+R) to change the hair."
                    } else {
                        "A take is playing: body and hair move as recorded. Leave the take (Shift+R) to change them."
                    };
                    super::control::note(ui, note);
                    if curves {
                        section(ui, "Curves", true, |ui| {
                            panels::hair::curves(ui, &mut project.hair.import, &self.session.take_notes);
                        });
                        asked = self.body_section(ui, project, true);
                    }
                    ui.disable();
                }
                let problems = self.problems(&[Place::Hair]);
                let (_, clicked) = section_with(ui, "Hairstyle", true, &problems, |ui| {
                    super::styles::ui(ui, project, &mut self.styles, &mut self.layout.styles);
                    let ask = panels::hair::ui(ui, project, &self.session.hair);
                    asked = asked.or(ask.map(|_| Purpose::Open));
                });
                self.tell_again(problems, clicked);
                section(ui, "Layers", self.layers.is_revealed(), |ui| {
                    panels::layers::ui(ui, &mut project.hair.stack, &mut self.layers, &mut self.pointer_tool);
                });
                section(ui, "Brushes", self.pointer_tool == PointerTool::Brush, |ui| {
                    let brushes = (&mut self.brushes, &mut self.pointer_tool);
                    match super::brushes::ui(ui, brushes, &mut self.layout.brushes) {
                        Some(super::brushes::BrushRequest::Thaw) => {
                            self.session.worker().thaw();
                            self.brushes.forget_frozen();
                        }
                        Some(super::brushes::BrushRequest::Save) => asked = Some(Purpose::SaveStrokes),
                        Some(super::brushes::BrushRequest::Paint(id)) => self.paint_map(project, id),
                        None => {}
                    }
                });
                let unfolded = section(ui, "Ties and scissors", false, |ui| {
                    let scalp = self.session.scene.as_ref().map(|scene| &*scene.usual_scalp);
                    panels::ties::ui(ui, &mut project.hair, &mut self.selected_tie, scalp);
                    panels::ties::scissors(ui, &mut project.hair.cut, &mut self.pointer_tool);
                });
                self.ties_shown = unfolded.is_some();
                section(ui, "Simulation", true, |ui| {
                    let axes = camera_control::axes(&project.camera);
                    let Project { simulation, timeline, hair, .. } = project;
                    panels::simulation::ui(ui, simulation, &hair.simulation(), timeline, axes);
                });
                section(ui, "Colliders", false, |ui| {
                    let scene = self.session.scene.as_ref();
                    let edits = &mut project.body.colliders;
                    let fitted = scene.iter().flat_map(|scene| {
                        scene.fitted.iter().map(|of| panels::colliders::Fitted {
                            name: of.name.as_str(),
                            spared: edits.is_replaced(of, scene.field.as_deref()),
                        })
                    });
                    let fitted: Vec<_> = fitted.collect();
                    panels::colliders::ui(ui, edits, &fitted, &mut self.colliders);
                });
                let unfolded = section(ui, "Scalp", false, |ui| {
                    let found = self.session.scene.as_ref().is_none_or(|scene| scene.skull.is_some());
                    let tools = (&mut self.scalp, &mut self.pointer_tool);
                    panels::scalp::ui(ui, &mut project.body.scalp, tools, found);
                });
                if unfolded.is_none() {
                    self.pointer_tool.set(PointerTool::Scalp, false);
                }
                if !curves {
                    asked = asked.or(self.body_section(ui, project, false));
                }
            });
        });
        if let Some(purpose) = asked {
            self.open_path_dialog(purpose);
        }
    }

    /// Body and motion; returns what shall be picked.
    fn body_section(&mut self, ui: &mut Ui, project: &mut Project, open: bool) -> Option<Purpose> {
        let mut asked = None;
        let problems = self.problems(&[Place::Body, Place::Motion]);
        let (_, clicked) = section_with(ui, "Body and motion", open, &problems, |ui| {
            asked = panels::body::ui(ui, project, &self.session.body).map(|ask| match ask {
                panels::body::BodyRequest::PickBody => Purpose::Body,
                panels::body::BodyRequest::PickMotion => Purpose::Motion,
            });
        });
        self.tell_again(problems, clicked);
        asked
    }

    pub(super) fn right_panel(&mut self, ui: &mut Ui, project: &mut Project, ctx: &egui::Context) {
        let (mut recording, mut picks_light, mut picks_sound) = (None, false, false);
        let axes = camera_control::axes(&project.camera);
        let pane = self.begin_pane(project);
        let compares = pane.is_some();
        if let Some(pane) = &pane {
            enter_pane(ctx, pane.pane());
        }
        Panel::right("right").default_size(312.0).size_range(260.0..=460.0).show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                section(ui, "Shadow", true, |ui| {
                    let painted = self.session.painted.as_ref().map(|painted| painted.stats.shadow_bytes);
                    let bytes = match &pane {
                        Some(pane) => self.pane_choice(ui, pane.pane(), project),
                        None => painted,
                    };
                    let default = project.hair.groom.look;
                    let look = (&mut project.look, &default);
                    panels::shadow::ui(ui, &mut project.shadow, look, bytes, compares);
                });
                let problems = self.problems(&[Place::Surroundings]);
                let (_, clicked) = section_with(ui, "Light", true, &problems, |ui| {
                    panels::light::ui(ui, &mut project.lights, &mut self.selected_light, axes);
                    ui.separator();
                    picks_light = panels::surroundings::ui(ui, project, &self.session.surroundings).is_some();
                });
                self.tell_again(problems, clicked);
                section(ui, "Look", false, |ui| {
                    let default = project.hair.groom.look;
                    panels::look::hair(ui, &mut project.look, &default, &mut project.picture, compares);
                });
                section(ui, "Picture", false, |ui| {
                    panels::look::picture(ui, &mut project.picture, compares);
                    if project.picture.draw != HairDrawing::Strands {
                        section(ui, "Record of the database", false, |ui| {
                            panels::records::ui(ui, &mut self.record);
                        });
                    }
                });
                let problems: Vec<String> = self.soundtrack.problem().into_iter().collect();
                let open = project.sound.file.is_some();
                let (_, clicked) = section_with(ui, "Sound", open, &problems, |ui| {
                    let duration = self.session.frame.as_ref().map_or(0.0, |frame| frame.duration_secs);
                    let loaded = self.soundtrack.loaded().map(|loaded| &**loaded);
                    picks_sound = panels::sound::ui(ui, project, loaded, duration).is_some();
                });
                self.tell_again(problems, clicked);
                let unfolded = section(ui, "Recording", false, |ui| {
                    let frames = self.session.frames(project.recording.fps);
                    recording =
                        panels::recording::ui(ui, &mut project.recording, self.recorder.state(), frames);
                });
                let RecordingSection { width, height, .. } = project.recording;
                self.viewport.film = unfolded.map(|()| [width, height]);
                section(ui, "Health", true, |ui| self.health_panel(ui, project));
                // The panes have their own statistics; the single image is not rendered beside them.
                section(ui, "Statistics", true, |ui| {
                    if compares {
                        super::control::note(
                            ui,
                            "Measured on the single image, before the comparison was opened.",
                        );
                    }
                    let session = &self.session;
                    self.session.view.measured = panels::statistics::ui(
                        ui,
                        &session.stages,
                        &session.passes,
                        [&self.facts(), &self.kept_in_memory()],
                    );
                });
            });
        });
        if let Some(pane) = pane {
            leave_pane(ctx);
            pane.end(project);
        }
        if picks_light {
            self.open_path_dialog(Purpose::Surroundings);
        }
        if picks_sound {
            self.open_path_dialog(Purpose::Sound);
        }
        match recording {
            Some(panels::recording::RecordingRequest::Film) => self.open_path_dialog(Purpose::Film),
            Some(panels::recording::RecordingRequest::Sequence) => self.open_path_dialog(Purpose::Sequence),
            Some(panels::recording::RecordingRequest::Preview) => self.open_path_dialog(Purpose::Preview),
            Some(panels::recording::RecordingRequest::Resume) => self.open_path_dialog(Purpose::Resume),
            Some(panels::recording::RecordingRequest::Curves) => self.open_path_dialog(Purpose::Curves),
            Some(panels::recording::RecordingRequest::Cancel) => {
                self.run(crate::window::Command::Record, ctx);
            }
            None => {}
        }
    }
}
