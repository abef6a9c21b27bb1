//! The body and its motion.

use egui::Ui;
use lovelock_motion::{BodySettings, MotionSettings};
use lovelock_project::Project;
use lovelock_project::project::{BodySource, MotionSection, MotionSource};

use crate::window::control::HoverTooltip;
use crate::window::control::{note, row, section, settings};

/// What the panel shows of the body that is loaded.
#[derive(Clone, Debug, Default)]
pub(crate) struct LoadedBody {
    /// Names of the clips.
    pub(crate) clips: Vec<String>,
    /// The name of the clip that plays; empty where none does.
    pub(crate) clip: String,
    /// Paths of the joints, such as `hips/spine/neck/head`.
    pub(crate) joints: Vec<String>,
    /// Path of the joint that carries the hair.
    pub(crate) head: String,
    /// Notes of the loaders.
    pub(crate) notes: Vec<String>,
}

/// What the panel requests beyond a change of the project.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BodyRequest {
    /// A dialog that picks a character.
    PickBody,
    /// A dialog that picks a motion.
    PickMotion,
}

/// The controls of the project's body and motion.
pub(crate) fn ui(ui: &mut Ui, project: &mut Project, loaded: &LoadedBody) -> Option<BodyRequest> {
    let mut request = None;
    ui.horizontal_wrapped(|ui| {
        let body = &mut project.body;
        if ui
            .selectable_label(body.source == BodySource::Dancer, "Dancer")
            .hover_tooltip("Loads the shipped dancer.")
            .clicked()
        {
            body.switch(None);
        }
        let on = body.source == BodySource::File;
        if ui
            .selectable_label(on, "Character file…")
            .hover_tooltip("Loads a character: .glb, .gltf, .vrm, .fbx, .usd or .usdz.")
            .clicked()
        {
            if body.file.is_some() && !on {
                body.switch(body.file.clone());
            } else {
                request = Some(BodyRequest::PickBody);
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
    section(ui, "Motion", true, |ui| request = motion(ui, project, loaded).or(request));
    for text in &loaded.notes {
        note(ui, text.as_str());
    }
    request
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

fn motion(ui: &mut Ui, project: &mut Project, loaded: &LoadedBody) -> Option<BodyRequest> {
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
                request = Some(BodyRequest::PickMotion);
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
