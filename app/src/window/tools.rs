//! What the pointer does in the picture beside moving the camera: it moves ties, cuts hair, and chooses colliders.

use egui::{PointerButton, Response, Ui};
use lovelock_studio::motion::{
    Collider, ColliderShape, FieldPose, PlacedCollider, collider_lines, place_colliders,
};
use lovelock_studio::{FrameSnapshot, Painted, Project};

use super::overlay::colliders::Wires;
use super::overlay::{self, View};
use super::{Window, notices};

impl Window {
    /// Lets the pointer do what the tools are for, and paints what belongs over the picture. Returns whether the pointer is
    /// free to move the camera.
    pub(super) fn tools(&mut self, ui: &Ui, response: &Response, project: &mut Project) -> bool {
        let painted = self.session.painted.clone();
        let view = painted.as_ref().zip(self.viewport.place(response.rect));
        let Some((painted, view)) =
            view.and_then(|(painted, place)| Some((painted, View::new(painted, place)?)))
        else {
            return true;
        };
        self.colliders_over(ui, response, view, &painted.snapshot);
        self.paint_pointed(ui, view, painted);
        if project.take.file.is_some() {
            return true;
        }
        let held = self.scissors.held;
        if let Some(line) = self.scissors.drag(ui, view, response) {
            self.cut(view, painted, line, project);
        }
        let ties = &mut project.hair.ties;
        if self.ties_shown && !held {
            let world_from_head = painted.snapshot.guides.world_from_head;
            overlay::ties::edit(ui, view, &world_from_head, ties, &mut self.selected_tie);
        }
        !(held && response.dragged_by(PointerButton::Primary))
    }

    /// Cuts the hair beyond a line on the screen, as it is in the picture.
    fn cut(&mut self, view: View, painted: &Painted, line: [egui::Pos2; 2], project: &mut Project) {
        match overlay::scissors::cut(view, &painted.snapshot, line) {
            Some(cut) => project.hair.cut = project.hair.cut.and(&cut),
            None => self.notices.tell(notices::Kind::Warning, "The line meets no hair.".to_owned()),
        }
    }

    /// What hair collides with, as wires; a click chooses the shape that is edited.
    fn colliders_over(&mut self, ui: &Ui, response: &Response, view: View, snapshot: &FrameSnapshot) {
        if !self.colliders.on {
            return;
        }
        let shapes = wires(snapshot);
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
            && let Some(chosen) = overlay::colliders::at(view, &shapes, at)
        {
            self.colliders.selected = chosen;
        }
        overlay::colliders::paint(ui, view, &shapes, Some(self.colliders.selected));
    }
}

/// The wires of all that was fitted to the body, as it stands: what hair meets as it was changed, the rest as it was fitted.
fn wires(snapshot: &FrameSnapshot) -> Vec<Wires> {
    let (scene, pose) = (&snapshot.scene, &snapshot.pose);
    let placed = |colliders: &[Collider]| {
        let mut placed: Vec<PlacedCollider> = Vec::new();
        place_colliders(colliders, &scene.body, pose, &mut placed);
        placed
    };
    let (fitted, met) = (placed(&scene.fitted), placed(&scene.colliders));
    let lines_of = |shape: &ColliderShape| {
        let mut lines = Vec::new();
        collider_lines(shape, &mut lines);
        lines
    };
    let mut shapes: Vec<Wires> = Vec::new();
    if let Some(field) = &scene.field {
        let (mut pose_of_field, mut lines) = (FieldPose::default(), Vec::new());
        field.place(&scene.body, pose, scene.field_lift_m, &mut pose_of_field);
        field.lines(&pose_of_field, &mut lines);
        shapes.push(Wires { index: None, name: "head and shoulders".to_owned(), lines, met: true });
    }
    shapes.extend(scene.fitted.iter().zip(&fitted).enumerate().map(|(i, (collider, as_fitted))| {
        let used = scene.colliders.iter().position(|other| other.name == collider.name);
        let shape = used.and_then(|n| met.get(n)).unwrap_or(as_fitted);
        let (name, lines) = (collider.name.clone(), lines_of(&shape.shape));
        Wires { index: Some(i), name, lines, met: used.is_some() }
    }));
    shapes
}
