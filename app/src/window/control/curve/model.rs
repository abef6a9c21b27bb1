//! What the editor of curves edits.

use egui::Ui;
use lovelock_style::{Ramp, RampShape};

/// A curve from the root of hair to its tip with points that can be moved.
pub(crate) trait CurveModel: Clone + PartialEq {
    /// The value at a place: 0 is the root, 1 the tip.
    fn at(&self, place: f32) -> f32;
    /// Place and value of each point, from the root to the tip.
    fn points(&self) -> Vec<[f32; 2]>;
    /// The name of a point.
    fn name(&self, point: usize) -> String;
    /// Moves a point as near to a place and a value as it may be.
    fn set(&mut self, point: usize, to: [f32; 2]);
    /// Moves a point by steps of a key, up and to the right positive.
    fn nudge(&mut self, point: usize, steps: [f32; 2]);
    /// Gives a point what it has in `default`.
    fn restore(&mut self, point: usize, default: &Self);
    /// Whether points have places that can be changed, and can be added and removed.
    fn is_free(&self) -> bool;
    /// Adds a point; returns its index.
    fn add(&mut self, at: [f32; 2]) -> Option<usize>;
    /// Removes a point, unless it is needed. Returns whether it did.
    fn remove(&mut self, point: usize) -> bool;
    /// Curves that are often needed, with their names.
    fn presets(&self) -> Vec<(&'static str, Self)>;
    /// Further entries of the menu.
    fn more(&mut self, _ui: &mut Ui) {}
}

impl CurveModel for Ramp {
    fn at(&self, place: f32) -> f32 {
        Self::at(self, place)
    }

    fn points(&self) -> Vec<[f32; 2]> {
        self.points.clone()
    }

    fn name(&self, point: usize) -> String {
        format!("point {}", point + 1)
    }

    fn set(&mut self, point: usize, [place, value]: [f32; 2]) {
        if point >= self.points.len() || !(place.is_finite() && value.is_finite()) {
            return;
        }
        // A point stays between its neighbours.
        let low = point.checked_sub(1).map_or(0.0, |before| self.points[before][0] + 0.01);
        let high = self.points.get(point + 1).map_or(1.0, |after| after[0] - 0.01);
        let [least, most] = Self::RANGE;
        self.points[point] = [place.clamp(low.min(high), high.max(low)), value.clamp(least, most)];
    }

    fn nudge(&mut self, point: usize, [right, up]: [f32; 2]) {
        if let Some(&[place, value]) = self.points.get(point) {
            self.set(point, [place + 0.01 * right, value + 0.02 * up]);
        }
    }

    fn restore(&mut self, _point: usize, default: &Self) {
        self.clone_from(default);
    }

    fn is_free(&self) -> bool {
        true
    }

    fn add(&mut self, at: [f32; 2]) -> Option<usize> {
        if self.points.len() >= Self::MAX_POINTS {
            return None;
        }
        // Not on top of another point.
        if self.points.iter().any(|point| (point[0] - at[0]).abs() < 0.01) {
            return None;
        }
        self.points.push(at);
        *self = self.clamped();
        self.points.iter().position(|point| (point[0] - at[0].clamp(0.0, 1.0)).abs() < 1e-6)
    }

    fn remove(&mut self, point: usize) -> bool {
        if self.points.len() < 2 || point >= self.points.len() {
            return false;
        }
        self.points.remove(point);
        true
    }

    fn presets(&self) -> Vec<(&'static str, Self)> {
        Self::presets().to_vec()
    }

    fn more(&mut self, ui: &mut Ui) {
        for (shape, name) in
            [(RampShape::Smooth, "Smooth"), (RampShape::Linear, "Lines"), (RampShape::Steps, "Steps")]
        {
            if ui.radio(self.shape == shape, name).clicked() {
                self.shape = shape;
                ui.close();
            }
        }
    }
}
