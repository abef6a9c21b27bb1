//! Tools of the pointer in the image: moving ties, cutting hair, selecting and editing colliders.

use egui::{PointerButton, Response, Shape, Ui};
use glam::{Affine3A, Vec3};
use lovelock_motion::{Collider, ColliderEdits, FieldPose, PlacedCollider, collider_lines, place_colliders};
use lovelock_project::Project;
use lovelock_session::render_thread::{RenderedImage, ShownMask};
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_style::BrushMode;

use super::keymap::Keymap;
use super::overlay::colliders::Wires;
use super::overlay::scissors::Scissors;
use super::overlay::{self, View};
use super::pointer_tool::PointerTool;
use super::{Window, notices, theme};

impl Window {
    /// Runs the tools and paints their overlays. Returns whether the pointer is free to move the camera.
    pub(super) fn tools(&mut self, ui: &Ui, response: &Response, project: &mut Project) -> bool {
        // Decided when the button goes down: keys may change during a drag.
        let (pressed, down, held) = ui
            .input(|input| (input.pointer.primary_pressed(), input.pointer.primary_down(), input.modifiers));
        if pressed {
            self.tools.navigates = Keymap::of(ui.ctx()).preset().keeps_from_tools(held);
        } else if !down {
            self.tools.navigates = false;
        }
        let navigates = self.tools.navigates;
        let painted = self.session.painted.clone();
        let view = painted.as_ref().zip(self.pages.image.place(response.rect));
        let Some((painted, view)) =
            view.and_then(|(painted, place)| Some((painted, View::new(painted, place)?)))
        else {
            return true;
        };
        self.colliders_over(ui, response, view, &painted.snapshot, project);
        if self.panels.light.unfolded && self.tools.active == PointerTool::Camera {
            overlay::lights::edit(ui, view, &mut project.lights, &mut self.panels.light.selected);
        }
        self.paint_marked_gauge(ui, view, painted);
        if project.take.file.is_some() {
            self.end_stroke();
            return true;
        }
        let tool = self.tools.active;
        if tool == PointerTool::Brush && self.brush_hair(ui, response, (view, painted), project) {
            return false;
        }
        // Below the circle of the brush.
        let painter = ui.painter_at(view.place);
        let colors = painter.add(Shape::Noop);
        let paints_mask = self.paint_mask(ui, (view, response), &painted.snapshot, project);
        if let Some(mask) =
            self.panels.layers.shown_mask(&project.hair.stack).filter(|_| tool == PointerTool::Mask)
        {
            let shown = ShownMask { mask: mask.clone(), scale: theme::mask_colors() };
            let snapshot = &painted.snapshot;
            let head = overlay::head::Head {
                world_from_head: &snapshot.guides.world_from_head,
                scalp: &snapshot.scene.style.scalp,
            };
            let new = overlay::mask::changed(view, head, &mut self.panels.brushes.seen, painted, &shown);
            painter.set(colors, Shape::Vec(new));
        }
        let cuts = tool == PointerTool::Scissors && !navigates;
        if !cuts {
            self.tools.scissors = Scissors::default();
        } else if let Some(line) = self.tools.scissors.drag(ui, view, response) {
            self.cut(view, painted, line, project);
        }
        let snapshot = &painted.snapshot;
        let world_from_head = &snapshot.guides.world_from_head;
        let ties = &mut project.hair.ties;
        if self.panels.ties.unfolded && !matches!(tool, PointerTool::Scissors | PointerTool::Mask) {
            // Ties are placed on a head of the usual size.
            let scale = Affine3A::from_scale(Vec3::splat(snapshot.scene.hair_scale));
            let world_from_usual = *world_from_head * scale;
            let head = overlay::head::Head {
                world_from_head: &world_from_usual,
                scalp: &snapshot.scene.usual_scalp,
            };
            overlay::ties::edit(ui, view, head, ties, &mut self.panels.ties.selected);
        }
        let mut free = !((cuts || paints_mask) && response.dragged_by(PointerButton::Primary));
        if self.panels.scalp.tool.shown
            && !matches!(tool, PointerTool::Scissors | PointerTool::Mask)
            && let Some(skull) = &snapshot.scene.skull
        {
            let head = overlay::head::Head { world_from_head, scalp: &snapshot.scene.style.scalp };
            let paints = tool == PointerTool::Scalp && !navigates;
            let edited = (self.panels.scalp.tool, paints, &mut project.body.scalp);
            free &= !overlay::scalp::edit(ui, response, view, head, skull, edited);
        }
        free
    }

    /// Paints the mask of the selected layer with the pointer. Returns whether the pointer paints.
    fn paint_mask(
        &mut self,
        ui: &Ui,
        place: (View, &Response),
        snapshot: &FrameSnapshot,
        project: &mut Project,
    ) -> bool {
        let layer = self.panels.layers.selected.and_then(|id| project.hair.stack.layer_mut(id));
        let paints = self.tools.active == PointerTool::Mask && !self.tools.navigates;
        let Some(layer) = layer.filter(|_| paints) else {
            self.tools.mask_stroke.end();
            return false;
        };
        let head = overlay::head::Head {
            world_from_head: &snapshot.guides.world_from_head,
            scalp: &snapshot.scene.style.scalp,
        };
        let brush = (&self.panels.layers.brush, self.tools.pen.erases());
        let done = self.tools.mask_stroke.paint(ui, place, (head, snapshot), brush, layer);
        if done.begins {
            // Each stroke is an undo step of its own, however soon it follows the last one.
            self.document.end_gesture();
        }
        if let Some(mode) = done.in_vain {
            let why = match mode {
                BrushMode::Add => "The mask is full here, or no hair grows here: the stroke paints nothing.",
                BrushMode::Erase => "The mask is empty here: the stroke erases nothing.",
                BrushMode::Smooth => "The mask is even here: the stroke smooths nothing.",
            };
            self.notices.push(notices::Kind::Warning, why.to_owned());
        }
        done.holds
    }

    /// Cuts the hair beyond a line on the screen, as it is in the image.
    fn cut(&mut self, view: View, painted: &RenderedImage, line: [egui::Pos2; 2], project: &mut Project) {
        if project.hair.morph.to.is_some() {
            let why = "Scissors cannot cut during a morph. End it, or choose Become.";
            return self.notices.push(notices::Kind::Warning, why.to_owned());
        }
        if overlay::scissors::is_too_short(line) {
            let why = "The line is too short to cut. Drag it across the hair.";
            return self.notices.push(notices::Kind::Warning, why.to_owned());
        }
        let before = &project.hair.cut;
        let cut = overlay::scissors::cut(view, &painted.snapshot, line).map(|cut| before.and(&cut));
        match cut.filter(|cut| cut != before) {
            Some(cut) => project.hair.cut = cut,
            None => self.notices.push(notices::Kind::Warning, "The line crosses no hair.".to_owned()),
        }
    }

    /// Shows the colliders as wireframes. A click selects a shape, and its handles edit it.
    fn colliders_over(
        &mut self,
        ui: &Ui,
        response: &Response,
        view: View,
        snapshot: &FrameSnapshot,
        project: &mut Project,
    ) {
        if !self.panels.colliders.on {
            return;
        }
        let edits = &mut project.body.colliders;
        let shapes = wires(snapshot, edits);
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
            && let Some(chosen) = overlay::colliders::at(view, &shapes, at)
        {
            self.panels.colliders.selected = chosen;
        }
        overlay::colliders::paint(ui, view, &shapes, Some(self.panels.colliders.selected));
        let Some(fitted) = snapshot.scene.fitted.get(self.panels.colliders.selected) else { return };
        if project.take.file.is_some() || self.tools.active == PointerTool::Scissors {
            return;
        }
        let edit = edits.of(&fitted.name);
        let changed = Collider { shape_at_rest: edit.apply(&fitted.shape_at_rest), ..fitted.clone() };
        if let [placed] = placed(snapshot, &[changed])[..] {
            let mut chosen = overlay::colliders::Chosen { placed, edit };
            overlay::colliders::edit(ui, view, &mut chosen);
            if chosen.edit != edit {
                edits.set(&fitted.name, chosen.edit);
            }
        }
    }
}

fn placed(snapshot: &FrameSnapshot, colliders: &[Collider]) -> Vec<PlacedCollider> {
    let mut placed = Vec::new();
    place_colliders(colliders, &snapshot.scene.body, &snapshot.pose, &mut placed);
    placed
}

/// The wireframes of all fitted colliders in the current pose, with the user's changes.
fn wires(snapshot: &FrameSnapshot, edits: &ColliderEdits) -> Vec<Wires> {
    let (scene, pose) = (&snapshot.scene, &snapshot.pose);
    let changed: Vec<Collider> = scene
        .fitted
        .iter()
        .map(|of| Collider { shape_at_rest: edits.of(&of.name).apply(&of.shape_at_rest), ..of.clone() })
        .collect();
    let mut shapes: Vec<Wires> = Vec::new();
    if let Some(field) = &scene.field {
        let (mut pose_of_field, mut lines) = (FieldPose::default(), Vec::new());
        field.place(&scene.body, pose, scene.field_lift_m, &mut pose_of_field);
        field.lines(&pose_of_field, &mut lines);
        shapes.push(Wires { index: None, name: "head and shoulders".to_owned(), lines, met: true });
    }
    shapes.extend(scene.fitted.iter().zip(placed(snapshot, &changed)).enumerate().map(
        |(i, (fitted, at))| {
            let mut lines = Vec::new();
            collider_lines(&at.shape, &mut lines);
            let met = edits.of(&fitted.name).enabled && !edits.is_replaced(fitted, scene.field.as_deref());
            Wires { index: Some(i), name: fitted.name.clone(), lines, met }
        },
    ));
    shapes
}
