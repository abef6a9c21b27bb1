//! The body and its motion.

use egui::Ui;
use lovelock_base::settings::Choices as _;
use lovelock_motion::{BodySettings, MotionSettings};
use lovelock_project::Project;
use lovelock_project::error::Place;
use lovelock_project::project::{BodySource, MotionSection, MotionSource};

use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{note, row, section, settings};
use crate::window::panel::Panel;
use crate::window::purpose::Purpose;
use crate::window::readings::{LoadedBody, Readings};

/// The body and its motion.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BodyPanel;

impl Panel for BodyPanel {
    fn title(&self) -> &'static str {
        "Body and motion"
    }

    fn opens(&self, project: &Project, _readings: &Readings<'_>) -> bool {
        project.plays_curves()
    }

    fn edits_takes(&self, project: &Project) -> bool {
        project.plays_curves()
    }

    fn places(&self) -> &'static [Place] {
        &[Place::Body, Place::Motion]
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        let asked = controls(ui, project, readings.body);
        super::brows::ui(ui, &mut project.body.brows, readings);
        asked
    }
}

/// The controls of the project's body and motion.
fn controls(ui: &mut Ui, project: &mut Project, loaded: &LoadedBody) -> Option<Command> {
    let mut picked = None;
    ui.horizontal_wrapped(|ui| {
        for (source, _, says) in BodySource::SHIPPED {
            let name = source.names().1;
            let on = project.body.source == source;
            if ui.selectable_label(on, name).hover_tooltip(says).clicked() {
                project.show_shipped_body(source);
            }
        }
        let body = &mut project.body;
        let on = body.source == BodySource::File;
        if ui
            .selectable_label(on, "Character file…")
            .hover_tooltip("Loads a character: .glb, .gltf, .vrm, .fbx, .usd or .usdz.")
            .clicked()
        {
            if body.file.is_some() && !on {
                body.switch(BodySource::File, body.file.clone());
            } else {
                picked = Some(Command::PickFile(Purpose::Body));
            }
        }
    });
    if project.body.source == BodySource::File {
        if let Some(file) = &project.body.file {
            note(ui, file.path.display().to_string());
        }
        settings(
            ui,
            &["unit", "up", "facing", "own_hair", "include_hidden"],
            &mut project.body.settings,
            &BodySettings::default(),
        );
    }
    head_joint(ui, &mut project.body.head_joint, loaded);
    let mut of_motion = None;
    section(ui, "Motion", true, |ui| of_motion = motion(ui, project, loaded));
    for text in &loaded.notes {
        note(ui, text.as_str());
    }
    of_motion.or(picked)
}

/// The choice of the joint that carries the hair. The name of a joint is the end of its path, which the tooltip shows.
fn head_joint(ui: &mut Ui, chosen: &mut Option<String>, loaded: &LoadedBody) {
    let name = |path: &str| path.rsplit('/').next().unwrap_or(path).to_owned();
    let shown = match chosen.as_deref() {
        Some(path) => name(path),
        None if loaded.head.is_empty() => "Guess".to_owned(),
        None => format!("{} (guess)", name(&loaded.head)),
    };
    let path = chosen.clone().unwrap_or_else(|| loaded.head.clone());
    let tip = format!("The joint that carries the hair.\n\n{path}");
    row(ui, "Head joint", &tip, chosen.is_some(), chosen, None, |ui, chosen| {
        egui::ComboBox::from_id_salt("head joint")
            .selected_text(shown)
            .width(ui.available_width() - 4.0)
            .height(320.0)
            .truncate()
            .show_ui(ui, |ui| {
                ui.selectable_value(chosen, None, "Guess");
                for joint in &loaded.joints {
                    ui.selectable_value(chosen, Some(joint.clone()), joint);
                }
            })
            .response
    });
}

fn motion(ui: &mut Ui, project: &mut Project, loaded: &LoadedBody) -> Option<Command> {
    let mut request = None;
    let default = MotionSection::default();
    let motion = &mut project.motion;
    ui.horizontal_wrapped(|ui| {
        for clip in &loaded.clips {
            let plays = if motion.clip.is_empty() { &loaded.clip } else { &motion.clip };
            let on = motion.source == MotionSource::Clip && plays == clip;
            if ui.selectable_label(on, clip).hover_tooltip("Plays this clip of the character.").clicked() {
                motion.source = MotionSource::Clip;
                motion.clip.clone_from(clip);
            }
        }
        let on = motion.source == MotionSource::File;
        if ui
            .selectable_label(on, "Motion file…")
            .hover_tooltip("Loads a motion and retargets it to this body: .bvh or .vrma, or a clip of another character.")
            .clicked()
        {
            if motion.file.is_some() && !on {
                motion.source = MotionSource::File;
            } else {
                request = Some(Command::PickFile(Purpose::Motion));
            }
        }
        if ui
            .selectable_label(motion.source == MotionSource::Rest, "Rest")
            .hover_tooltip("Keeps the body still in its rest pose.")
            .clicked()
        {
            motion.source = MotionSource::Rest;
        }
    });
    if motion.source == MotionSource::File {
        if let Some(file) = &motion.file {
            note(ui, file.path.display().to_string());
        }
        settings(ui, &["unit", "up", "root"], &mut motion.settings, &MotionSettings::default());
    }
    settings(ui, &["speed", "looping"], motion, &default);
    if motion.looping {
        settings(ui, &["loop_blend_secs", "loop_blend"], motion, &default);
    }
    request
}
