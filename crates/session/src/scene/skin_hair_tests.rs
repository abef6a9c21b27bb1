use std::sync::Arc;

use glam::Vec3;
use lovelock_base::triangle::closest_barycentric;
use lovelock_groom::carried::BROWS;
use lovelock_motion::Body;
use lovelock_project::Project;
use lovelock_simulation::SimulationSettings;

use super::Scene;
use super::skin_hair_part::SkinHairPart;
use crate::engine::Engine;
use crate::snapshot::FrameSnapshot;
use crate::testing::{scene, small_project};

/// The small project's body with a mask of brows on the skin that looks ahead at the top of the figure, or with none.
fn body(has_brows: bool) -> Arc<Body> {
    let mut body = (*scene().body).clone();
    body.mesh.masks.clear();
    if has_brows {
        let least = body.mesh.positions.iter().map(|p| p.y).fold(0.0, f32::max) - 0.12;
        let ahead = body.mesh.positions.iter().zip(&body.mesh.normals);
        let mask = ahead.map(|(p, n)| if p.y > least && n.z > 0.6 { 1.0 } else { 0.0 }).collect();
        body.mesh.masks.insert("_BROW".to_owned(), mask);
    }
    Arc::new(body)
}

fn with_brows(project: &Project) -> Arc<Scene> {
    let body = body(true);
    let skin_hair = SkinHairPart::default().of(&body, project.body.brows.grooms(), 1.0);
    assert_eq!(skin_hair.as_ref().map(|hair| hair.count()), Some(BROWS.strands as usize));
    Arc::new(Scene { body, skin_hair, ..(*scene()).clone() })
}

#[test]
fn brows_are_on_the_skin_of_every_snapshot_and_of_its_copies() {
    let project = small_project();
    let mut engine = Engine::new(with_brows(&project), SimulationSettings::default());
    for step in [0, 7] {
        engine.advance_to_step(step);
        let snapshot = engine.snapshot();
        let strands = &snapshot.skin_strands;
        assert_eq!(strands.count(), BROWS.strands as usize);
        let positions = &snapshot.skin.positions;
        for strand in (0..strands.count()).step_by(25) {
            let root = strands.point(strands.first_point[strand] as usize);
            let away = |triangle: &[u32; 3]| {
                let corners = triangle.map(|i| positions[i as usize]);
                let weights = closest_barycentric(root, &corners);
                (0..3).map(|k| corners[k] * weights[k]).sum::<Vec3>().distance(root)
            };
            let nearest = snapshot.scene.body.mesh.triangles.iter().map(away).fold(f32::INFINITY, f32::min);
            // Positions of 1.7 m have a precision of 1.2e-7 m.
            assert!(nearest < 1e-6, "{nearest}");
        }
        let copy = FrameSnapshot::clone(&snapshot);
        let camera = copy.camera(&project.camera);
        let input = copy.frame_input(&project, &camera);
        assert_eq!(input.carried.expect("brows").strands.x, strands.x);
        assert!(copy.measured_input(&project, &camera).carried.is_none());
    }
}

#[test]
fn brows_go_with_their_scene() {
    let project = small_project();
    let scene = with_brows(&project);
    let hair = Arc::downgrade(scene.skin_hair.as_ref().expect("brows"));
    let mut engine = Engine::new(Arc::clone(&scene), SimulationSettings::default());
    engine.advance_to_step(2);
    assert!(engine.snapshot().skin_strands.count() > 0);
    let bare = Arc::new(Scene { skin_hair: None, ..(*scene).clone() });
    drop(scene);
    engine.set_scene(bare);
    let snapshot = engine.snapshot();
    assert_eq!((snapshot.skin_strands.count(), snapshot.skin_strands.x.capacity()), (0, 0));
    assert!(hair.upgrade().is_none(), "nothing keeps them");
}

#[test]
fn bodies_without_masks_and_projects_without_brows_have_none() {
    let mut project = small_project();
    let mut part = SkinHairPart::default();
    assert!(part.of(&body(false), project.body.brows.grooms(), 1.0).is_none());
    let body = body(true);
    let once = part.of(&body, project.body.brows.grooms(), 1.0).expect("brows");
    let again = part.of(&body, project.body.brows.grooms(), 1.0).expect("brows");
    assert!(Arc::ptr_eq(&once, &again), "the same for the same");
    project.body.brows.brows = 0.5;
    let few = part.of(&body, project.body.brows.grooms(), 1.0).expect("brows");
    assert_eq!(few.count(), BROWS.strands as usize / 2);
    project.body.brows.brows = 0.0;
    assert!(part.of(&body, project.body.brows.grooms(), 1.0).is_none());
}
