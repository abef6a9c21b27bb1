//! Strokes of the pointer over the image.

use egui::{CursorIcon, Event, Pos2, Response, TouchPhase, Ui};
use glam::{Affine3A, Vec3};
use lovelock_brush::{BrushSettings, StrokeSample, Tool};
use lovelock_project::Project;
use lovelock_session::render_thread::RenderedImage;
use lovelock_session::snapshot::FrameSnapshot;

use super::circle::{self, Look};
use super::strokes;
use crate::window::overlay::View;
use crate::window::overlay::head::Head;
use crate::window::{Window, notices, theme};

/// The most samples that a pass sends.
const MAX_SAMPLES: usize = 512;

/// A stroke of the pointer.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointerStroke {
    id: u64,
    /// The last place on the hair, head space.
    place: Vec3,
    /// The last place of the pointer.
    at: Pos2,
    tool: Tool,
    inverted: bool,
}

impl Window {
    /// Shows the brush and brushes the hair with the pointer. Returns whether the pointer brushes, so that it does not move the camera.
    pub(in crate::window) fn brush_hair(
        &mut self,
        ui: &Ui,
        response: &Response,
        (view, painted): (View, &RenderedImage),
        project: &mut Project,
    ) -> bool {
        self.panels.brushes.handled = true;
        self.panels.brushes.bar(ui, view.place);
        self.panels.brushes.menu(response);
        let snapshot = &*painted.snapshot;
        let head =
            Head { world_from_head: &snapshot.guides.world_from_head, scalp: &snapshot.scene.style.scalp };
        let resizing = self.panels.brushes.resize(ui);
        let (modifiers, pointer, pressed, down) = ui.input(|input| {
            let pointer = &input.pointer;
            (input.modifiers, pointer.interact_pos(), pointer.primary_pressed(), pointer.primary_down())
        });
        let tool =
            if modifiers.shift && resizing.is_none() { Tool::Smooth } else { self.panels.brushes.tool };
        let inverted = (modifiers.command != self.tools.pen.erases()) && tool.inverse_text().is_some();
        let settings = self.panels.brushes.kept.of(self.panels.brushes.tool);
        let over = response.contains_pointer() || self.panels.brushes.held.is_some();
        let at = resizing.or_else(|| pointer.filter(|_| over));
        let under = at.and_then(|at| self.panels.brushes.seen.at(view, head, snapshot, at));
        let place = under.or_else(|| {
            let held = self.panels.brushes.held?;
            Some(view.at_depth_of(at?, head.world_from_head.transform_point3(held.place)))
        });
        if let Some(place) = place {
            ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
            let (tool, inverted) =
                self.panels.brushes.held.map_or((tool, inverted), |held| (held.tool, held.inverted));
            let look = Look { color: color_of(tool, inverted), lit: self.panels.brushes.held.is_none() };
            circle::paint(ui, view, snapshot, &settings, place, look);
        }
        let begins = pressed
            && !self.tools.navigates
            && response.contains_pointer()
            && resizing.is_none()
            && self.panels.brushes.held.is_none();
        if let Some((place, at)) = under.zip(at).filter(|_| begins) {
            self.press(project, (tool, inverted), &settings, (snapshot, place, at));
        }
        let holds = self.panels.brushes.held.is_some() || self.panels.brushes.spent || resizing.is_some();
        if self.panels.brushes.held.is_some() {
            self.drag(ui, (view, head), snapshot, begins);
        }
        if !down {
            self.end_stroke();
            self.panels.brushes.spent = false;
        }
        holds
    }

    fn press(
        &mut self,
        project: &mut Project,
        (tool, inverted): (Tool, bool),
        settings: &BrushSettings,
        (snapshot, place, at): (&FrameSnapshot, Vec3, Pos2),
    ) {
        if project.hair.morph.to.is_some() {
            let why = "Brushes cannot work during a morph. End it, or choose Become.";
            return self.notices.push(notices::Kind::Warning, why.to_owned());
        }
        let Some(layer) = strokes::layer_of(project, self.panels.layers.selected) else {
            let why = "The layer limit is reached. Remove a layer first.";
            return self.notices.push(notices::Kind::Warning, why.to_owned());
        };
        let place = snapshot.guides.world_from_head.inverse().transform_point3(place);
        let id = self.begin_stroke(project, layer, (tool, inverted), settings.clone());
        self.panels.brushes.held = Some(PointerStroke { id, place, at, tool, inverted });
    }

    /// Sends the way of the pointer since the last pass.
    fn drag(&mut self, ui: &Ui, (view, head): (View, Head<'_>), snapshot: &FrameSnapshot, begins: bool) {
        let Some(held) = &mut self.panels.brushes.held else { return };
        let (way, finger) = ui.input(|input| (way_of(&input.events), pressure_of(&input.events)));
        let (pen, places) = (self.tools.pen.touch(), way.len().min(MAX_SAMPLES));
        let pressure = |at: usize| pen.map_or(finger, |touch| touch.pressure(at, places));
        let radius = self.panels.brushes.kept.of(self.panels.brushes.tool).radius;
        let head_from_world: Affine3A = head.world_from_head.inverse();
        let mut samples = Vec::new();
        if begins {
            samples.push(sample(held.place, Vec3::ZERO, &head_from_world, view, pressure(0), snapshot));
        }
        for (number, at) in way.into_iter().take(MAX_SAMPLES).enumerate() {
            let before = head.world_from_head.transform_point3(held.place);
            let moved = view.at_depth_of(at, before);
            // Only what the pointer has moved: hair that dances past it is not combed by that.
            let from = view.at_depth_of(held.at, before);
            // The brush follows the hair in depth, but does not fall from a lock onto what is far behind it.
            let found = self.panels.brushes.seen.at(view, head, snapshot, at);
            let now = found.filter(|found| found.distance(moved) < radius).unwrap_or(moved);
            if !now.is_finite() {
                continue;
            }
            let drag = head_from_world.transform_vector3(moved - from);
            held.at = at;
            held.place = head_from_world.transform_point3(now);
            samples.push(sample(held.place, drag, &head_from_world, view, pressure(number), snapshot));
        }
        let id = held.id;
        if !samples.is_empty() {
            self.go_on_with_stroke(id, samples, head.world_from_head);
        }
    }

    /// Ends the stroke of the pointer, if there is one.
    pub(in crate::window) fn end_stroke(&mut self) {
        if let Some(held) = self.panels.brushes.held.take() {
            self.session.worker().end_stroke(held.id);
        }
    }
}

/// One sample in head space.
fn sample(
    place: Vec3,
    drag: Vec3,
    head_from_world: &Affine3A,
    view: View,
    pressure: f32,
    snapshot: &FrameSnapshot,
) -> StrokeSample {
    let eye = head_from_world.transform_point3(view.eye);
    StrokeSample {
        position: place,
        view: (place - eye).normalize_or(Vec3::NEG_Z),
        drag,
        pressure,
        time_secs: snapshot.time_secs,
    }
}

/// The places of the pointer since the last pass.
fn way_of(events: &[Event]) -> Vec<Pos2> {
    let moved = |event: &Event| match event {
        Event::PointerMoved(at) => Some(*at),
        _ => None,
    };
    events.iter().filter_map(moved).filter(|at| at.is_finite()).collect()
}

/// The pressure of a finger, or of a pen where the windowing library reports it; 1 for a mouse.
fn pressure_of(events: &[Event]) -> f32 {
    let pressed = |event: &Event| match event {
        Event::Touch { force: Some(force), phase: TouchPhase::Start | TouchPhase::Move, .. } => Some(*force),
        _ => None,
    };
    events.iter().rev().find_map(pressed).map_or(1.0, |force| force.clamp(0.0, 1.0))
}

fn color_of(tool: Tool, inverted: bool) -> egui::Color32 {
    match tool {
        Tool::Cut | Tool::Remove => theme::wrong(),
        Tool::Smooth => theme::PLOT[1],
        Tool::Freeze => theme::PLOT[0],
        _ if inverted => theme::watch(),
        _ => theme::accent(),
    }
}
