//! A curve of three points: one at each end, and one in the middle that bends it.

use std::ops::RangeInclusive;

use egui::{Response, Ui};

use super::control::{Axis, Curve, CurveModel};

/// The step of an arrow key, as a fraction of the range of what it changes.
const KEY_STEP: f32 = 0.01;

/// A value that changes from the root of a wisp to its tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RampValue {
    /// At the root.
    pub(crate) root: f32,
    /// At the tip.
    pub(crate) tip: f32,
    /// Which part of the change is reached at the middle.
    pub(crate) bias: f32,
}

/// An editable curve of three points.
pub(crate) struct Ramp<'a> {
    /// The name of the value.
    pub(crate) label: &'static str,
    /// Its description, a sentence.
    pub(crate) hint: &'static str,
    /// Its unit.
    pub(crate) unit: &'static str,
    /// The range of the ends.
    pub(crate) range: RangeInclusive<f32>,
    /// The range of the bias.
    pub(crate) bias: RangeInclusive<f32>,
    /// The value at a fraction of the way from root to tip; monotonic in the bias.
    pub(crate) at: &'a dyn Fn(&RampValue, f32) -> f32,
}

impl Ramp<'_> {
    /// Shows the curve over the available width: see [`Curve::show`].
    pub(crate) fn show(&self, ui: &mut Ui, value: &mut RampValue, default: RampValue) -> Response {
        let curve = Curve {
            label: self.label,
            tip: self.hint,
            unit: (self.unit, 1.0),
            range: [*self.range.start(), *self.range.end()],
            axis: Axis::Root,
        };
        let (mut bent, default) = (Bent { value: *value, ramp: self }, Bent { value: default, ramp: self });
        let response = curve.show(ui, &mut bent, &default);
        *value = bent.value;
        response
    }
}

/// The three points as the editor sees them.
#[derive(Clone)]
struct Bent<'a> {
    value: RampValue,
    ramp: &'a Ramp<'a>,
}

impl PartialEq for Bent<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl Bent<'_> {
    const PLACES: [f32; 3] = [0.0, 0.5, 1.0];

    fn middle_at(&self, bias: f32) -> f32 {
        (self.ramp.at)(&RampValue { bias, ..self.value }, 0.5)
    }

    /// Finds the bias that brings the middle closest to `wanted`; a flat curve cannot be bent.
    fn bend(&mut self, wanted: f32) {
        let (mut low, mut high) = (*self.ramp.bias.start(), *self.ramp.bias.end());
        let range = self.ramp.range.end() - self.ramp.range.start();
        let (at_low, at_high) = (self.middle_at(low), self.middle_at(high));
        if (at_low - at_high).abs() < 1e-4 * range {
            return;
        }
        for _ in 0..24 {
            let middle = 0.5 * (low + high);
            if (self.middle_at(middle) < wanted) == (at_low > at_high) {
                high = middle;
            } else {
                low = middle;
            }
        }
        self.value.bias = 0.5 * (low + high);
    }
}

impl CurveModel for Bent<'_> {
    fn at(&self, place: f32) -> f32 {
        (self.ramp.at)(&self.value, place)
    }

    fn points(&self) -> Vec<[f32; 2]> {
        Self::PLACES.map(|place| [place, self.at(place)]).to_vec()
    }

    fn name(&self, point: usize) -> String {
        ["roots", "middle", "tips"][point.min(2)].to_owned()
    }

    fn set(&mut self, point: usize, [_, value]: [f32; 2]) {
        let within = value.clamp(*self.ramp.range.start(), *self.ramp.range.end());
        match point {
            _ if !value.is_finite() => {}
            0 => self.value.root = within,
            1 => self.bend(within),
            _ => self.value.tip = within,
        }
    }

    fn nudge(&mut self, point: usize, [_, up]: [f32; 2]) {
        let (low, high) = match point {
            1 => (*self.ramp.bias.start(), *self.ramp.bias.end()),
            _ => (*self.ramp.range.start(), *self.ramp.range.end()),
        };
        let by = up * KEY_STEP * (high - low);
        // The up key moves the point up, whichever way the bias bends the curve.
        let falls = self.middle_at(low) > self.middle_at(high);
        match point {
            0 => self.value.root = (self.value.root + by).clamp(low, high),
            1 => self.value.bias = (self.value.bias + if falls { -by } else { by }).clamp(low, high),
            _ => self.value.tip = (self.value.tip + by).clamp(low, high),
        }
    }

    fn restore(&mut self, point: usize, default: &Self) {
        match point {
            0 => self.value.root = default.value.root,
            1 => self.value.bias = default.value.bias,
            _ => self.value.tip = default.value.tip,
        }
    }

    fn is_free(&self) -> bool {
        false
    }

    fn add(&mut self, _at: [f32; 2]) -> Option<usize> {
        None
    }

    fn remove(&mut self, _point: usize) -> bool {
        false
    }

    /// Curves between the present extremes, or from the start of the range where both are the same.
    fn presets(&self) -> Vec<(&'static str, Self)> {
        let ends = [self.value.root, self.value.tip];
        let high = ends[0].max(ends[1]);
        let low = if ends[0] == ends[1] { *self.ramp.range.start() } else { ends[0].min(ends[1]) };
        let bent = |root: f32, tip: f32, share: f32| {
            let mut bent = Self { value: RampValue { root, tip, ..self.value }, ramp: self.ramp };
            bent.bend(root + (tip - root) * share);
            bent
        };
        vec![
            ("Constant", bent(high, high, 0.5)),
            ("Linear", bent(high, low, 0.5)),
            ("Ease", bent(high, low, 0.7)),
            ("Root", bent(high, low, 0.9)),
            ("Tip", bent(low, high, 0.5)),
        ]
    }
}
