//! Colliders as edited by a project.

use std::sync::Arc;

use lovelock_motion::ColliderEdit;
use lovelock_project::files::Access;

use super::*;
use crate::testing::{settled, small_project};

#[test]
fn edited_colliders_take_effect_and_the_hair_keeps_moving() {
    let (access, mut loader) = (Access::new(), SceneLoader::new());
    let mut project = small_project();
    let first = loader.load_now(&project, &access).expect("a scene").0;
    assert!(first.field.is_some() && first.colliders.len() < first.fitted.len());
    let mut engine = settled(Arc::clone(&first), &project);
    engine.advance_to_step(60);
    let mut kept = settled(Arc::clone(&first), &project);
    kept.advance_to_step(60);

    // Without the skin field, hair collides with all shapes that it replaces.
    project.body.colliders.field.enabled = false;
    let round = loader.load_now(&project, &access).expect("a scene").0;
    assert!(round.field.is_none() && round.colliders.len() == round.fitted.len());
    assert!(Arc::ptr_eq(&first.style, &round.style) && Arc::ptr_eq(&first.body, &round.body));
    assert!(!engine.set_scene(Arc::clone(&round)), "the hair keeps moving");
    // The same number of shapes, one of them far too large.
    let name = round.fitted[0].name.clone();
    project.body.colliders.shapes.insert(name, ColliderEdit { scale: 1.5, ..ColliderEdit::default() });
    let large = loader.load_now(&project, &access).expect("a scene").0;
    assert_eq!(large.colliders.len(), round.colliders.len());
    assert_ne!(large.colliders[0], round.colliders[0]);
    assert!(!engine.set_scene(large));
    for _ in 0..20 {
        engine.step();
        kept.step();
        let report = engine.snapshot().report;
        assert!(report.max_stretch < 1e-3 && report.max_speed < 30.0, "{report:?}");
    }
    assert_ne!(engine.state_hash(), kept.state_hash(), "the control: other shapes, other hair");
}

#[test]
fn edits_out_of_range_are_clamped() {
    let mut project = small_project();
    let wild =
        ColliderEdit { scale: f32::NAN, offset: [9.0, -0.1, f32::INFINITY], ..ColliderEdit::default() };
    project.body.colliders.shapes.insert("neck".to_owned(), wild);
    project.body.colliders.shapes.insert("x".repeat(10_000), wild);
    project.body.colliders.field.lift = -3.0;
    let (sane, _) = project.sanitised();
    let edits = &sane.body.colliders;
    assert_eq!(edits.shapes.len(), 1);
    assert_eq!(edits.shapes["neck"], ColliderEdit { offset: [0.5, -0.1, 0.5], ..ColliderEdit::default() });
    assert_eq!(edits.field.lift, -0.02);
}
