//! The body and its motion.

use egui::Ui;
use lovelock_motion::{LengthUnit, MotionSettings, RootPosition, UpAxis};
use lovelock_project::Project;
use lovelock_project::project::{BodySource, MotionSection, MotionSource};

use crate::window::control::{Number, choice, note, section, toggle};

/// What the panel shows of the body that is loaded.
#[derive(Clone, Debug, Default)]
pub(crate) struct Loaded {
    /// Names of the clips.
    pub(crate) clips: Vec<String>,
    /// Paths of the joints, such as `hips/spine/neck/head`.
    pub(crate) joints: Vec<String>,
    /// Path of the joint that carries the hair.
    pub(crate) head: String,
    /// What the loaders said.
    pub(crate) notes: Vec<String>,
}

/// What the panel asks for beyond a change of the project.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ask {
    /// A dialog that picks a character.
    PickBody,
    /// A dialog that picks a motion.
    PickMotion,
}

/// The controls of the project's body and motion.
pub(crate) fn ui(ui: &mut Ui, project: &mut Project, loaded: &Loaded) -> Option<Ask> {
    let mut ask = None;
    ui.horizontal_wrapped(|ui| {
        let body = &mut project.body;
        if ui
            .selectable_label(body.source == BodySource::Dancer, "Dancer")
            .on_hover_text("Takes the shipped dancer.")
            .clicked()
        {
            body.source = BodySource::Dancer;
            body.head_joint = None;
        }
        let on = body.source == BodySource::File;
        if ui
            .selectable_label(on, "Character file…")
            .on_hover_text("Takes a glTF 2 character: .glb or .gltf.")
            .clicked()
        {
            if body.file.is_some() && !on {
                body.source = BodySource::File;
            } else {
                ask = Some(Ask::PickBody);
            }
        }
    });
    if project.body.source == BodySource::File {
        if let Some(file) = &project.body.file {
            note(ui, file.path.display().to_string());
        }
        let d = lovelock_motion::BodySettings::default();
        units(ui, &mut project.body.settings.unit, d.unit);
        axes(ui, &mut project.body.settings.up, d.up);
    }
    let chosen = project.body.head_joint.clone().unwrap_or_else(|| format!("{} (guess)", loaded.head));
    ui.horizontal(|ui| {
        let label = ui.label("Head joint").on_hover_text("The joint that carries the hair.");
        egui::ComboBox::from_id_salt("head joint")
            .selected_text(chosen)
            .width(ui.available_width() - 4.0)
            .truncate()
            .show_ui(ui, |ui| {
                ui.selectable_value(&mut project.body.head_joint, None, "Guess");
                for joint in &loaded.joints {
                    ui.selectable_value(&mut project.body.head_joint, Some(joint.clone()), joint);
                }
            })
            .response
            .labelled_by(label.id)
            .on_hover_text("The joint that carries the hair.");
    });
    section(ui, "Motion", true, |ui| ask = motion(ui, project, loaded).or(ask));
    for text in &loaded.notes {
        note(ui, text.as_str());
    }
    ask
}

fn motion(ui: &mut Ui, project: &mut Project, loaded: &Loaded) -> Option<Ask> {
    let mut ask = None;
    let default = MotionSection::default();
    let motion = &mut project.motion;
    ui.horizontal_wrapped(|ui| {
        for clip in &loaded.clips {
            let on = motion.source == MotionSource::Clip && motion.clip == *clip;
            if ui.selectable_label(on, clip).on_hover_text("Takes this clip of the character.").clicked() {
                motion.source = MotionSource::Clip;
                motion.clip.clone_from(clip);
            }
        }
        let on = motion.source == MotionSource::File;
        if ui
            .selectable_label(on, "Motion file…")
            .on_hover_text("Takes a BVH motion, put on this body.")
            .clicked()
        {
            if motion.file.is_some() && !on {
                motion.source = MotionSource::File;
            } else {
                ask = Some(Ask::PickMotion);
            }
        }
        if ui
            .selectable_label(motion.source == MotionSource::Rest, "Rest")
            .on_hover_text("Stands still in the rest pose.")
            .clicked()
        {
            motion.source = MotionSource::Rest;
        }
    });
    if motion.source == MotionSource::File {
        if let Some(file) = &motion.file {
            note(ui, file.path.display().to_string());
        }
        let d = MotionSettings::default();
        units(ui, &mut motion.settings.unit, d.unit);
        axes(ui, &mut motion.settings.up, d.up);
        let roots = [
            (RootPosition::Auto, "Guess"),
            (RootPosition::Absolute, "Absolute"),
            (RootPosition::Added, "Added to the offset"),
        ];
        choice(
            ui,
            "Root position",
            "What the root's position channels mean: change it where the figure floats or sinks.",
            &mut motion.settings.root,
            d.root,
            &roots,
        );
    }
    Number::new("Tempo", 0.1..=4.0, "How fast the dance is; the hair feels it.")
        .unit(" ×", 1.0)
        .logarithmic()
        .show(ui, &mut motion.speed, default.speed);
    toggle(ui, "Loop", "Whether the dance starts again at its end.", &mut motion.looping, default.looping);
    if motion.looping {
        Number::new(
            "Loop blend",
            0.0..=2.0,
            "How long the end of a clip that does not loop by itself is faded into its beginning.",
        )
        .unit(" s", 1.0)
        .show(ui, &mut motion.loop_blend_secs, default.loop_blend_secs);
    }
    ask
}

fn units(ui: &mut Ui, value: &mut LengthUnit, default: LengthUnit) {
    let options = [
        LengthUnit::Auto,
        LengthUnit::Metres,
        LengthUnit::Decimetres,
        LengthUnit::Centimetres,
        LengthUnit::Millimetres,
        LengthUnit::Inches,
        LengthUnit::Cmu,
    ]
    .map(|unit| (unit, unit.label()));
    choice(ui, "Unit", "What one unit of the file is.", value, default, &options);
}

fn axes(ui: &mut Ui, value: &mut UpAxis, default: UpAxis) {
    let options = [(UpAxis::Auto, "Guess"), (UpAxis::Y, "Y"), (UpAxis::Z, "Z")];
    choice(ui, "Up", "The axis of the file that points up.", value, default, &options);
}
