//! The question for the up axis of a hair file, in the whole window.

use std::path::Path;

use egui::Key;
use egui::accesskit::Role;
use lovelock_groom::UpAxis;
use lovelock_project::project::HairSource;

use super::control;
use super::whole::{CTRL, go, key, of, project, wait, window};

/// Strands of 2 cm all around a ball, or hanging from it by `fall`, Y up.
fn write_ball(path: &Path, fall: f32) {
    let mut bytes = 300_i32.to_le_bytes().to_vec();
    for strand in 0..300 {
        let height = 1.0 - 2.0 * (strand as f32 + 0.5) / 300.0;
        let across = (1.0 - height * height).sqrt();
        let (sin, cos) = (2.4 * strand as f32).sin_cos();
        let out = glam::Vec3::new(across * cos, height, across * sin);
        bytes.extend(3_i32.to_le_bytes());
        for k in 0..3 {
            let point = out * (0.1 + 0.01 * k as f32) - glam::Vec3::Y * fall * k as f32;
            bytes.extend(point.to_array().into_iter().flat_map(f32::to_le_bytes));
        }
    }
    std::fs::write(path, bytes).expect("a file");
}

#[test]
fn hair_in_doubt_is_asked_about_and_the_answer_is_one_step_with_its_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let (ball, hangs) = (folder.path().join("ball.data"), folder.path().join("hangs.data"));
    write_ball(&ball, 0.0);
    write_ball(&hangs, 0.1);
    let mut harness = window();
    let before = project(&harness);
    for by_mouse in [false, true] {
        harness.state_mut().state.as_mut().expect("a window").open_any(&ball);
        wait(&mut harness, "the question", |window| window.files.up_question.is_open());
        assert_eq!(of(&harness).document.history().undo_len(), 1);
        assert_eq!(project(&harness).hair.import.up, UpAxis::Auto);
        let wanted = if by_mouse {
            control(&harness, Role::Button, "-X up").click();
            go(&mut harness);
            UpAxis::MinusX
        } else {
            // The guess has the focus: Enter confirms it.
            key(&mut harness, egui::Modifiers::NONE, Key::Enter);
            UpAxis::Y
        };
        assert!(!of(&harness).files.up_question.is_open());
        assert_eq!(project(&harness).hair.import.up, wanted);
        assert_eq!(of(&harness).document.history().undo_len(), 1, "the file and its axis are one step");
        key(&mut harness, CTRL, Key::Z);
        assert_eq!(project(&harness), before);
    }
    // Escape keeps the guess, and the axis stays automatic.
    harness.state_mut().state.as_mut().expect("a window").open_any(&ball);
    wait(&mut harness, "the question", |window| window.files.up_question.is_open());
    key(&mut harness, egui::Modifiers::NONE, Key::Escape);
    assert!(!of(&harness).files.up_question.is_open());
    assert_eq!(project(&harness).hair.import.up, UpAxis::Auto);

    // The control: hair that hangs is not asked about.
    harness.state_mut().state.as_mut().expect("a window").open_any(&hangs);
    wait(&mut harness, "the hair", |window| {
        let file = window.document.project().hair.file.as_ref();
        file.is_some_and(|file| file.path.ends_with("hangs.data")) && !window.files.up_question.looks()
    });
    assert_eq!(project(&harness).hair.source, HairSource::File);
    assert!(!of(&harness).files.up_question.is_open());
}
