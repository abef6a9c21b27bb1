//! Plots as SVG.

mod axis;
mod labels;

pub use axis::Axis;

use super::words::escaped;
pub use labels::Label;
use labels::Labels;
use std::fmt::Write as _;

/// Maximum number of corners of a line; longer lines are thinned.
const CORNERS: usize = 2000;

/// Margins around the field, pixels: left, top, right, bottom.
const MARGINS: [f64; 4] = [70.0, 12.0, 16.0, 46.0];

/// A plot under construction.
pub struct Plot {
    width: f64,
    height: f64,
    x: Axis,
    y: Axis,
    /// Additional height below the field, for lanes.
    below: f64,
    body: String,
    labels: Labels,
}

/// The style of a line.
#[derive(Clone, Copy, Debug)]
pub struct Stroke<'a> {
    /// A CSS colour.
    pub color: &'a str,
    /// Pixels.
    pub width: f64,
    /// Whether it is dashed.
    pub dashed: bool,
}

/// The style of a dot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dot {
    /// On the front.
    Full,
    /// Not on the front.
    Hollow,
}

impl Plot {
    /// An empty plot; the size is that of the field between the axes, pixels.
    pub fn new(width: f64, height: f64, x: Axis, y: Axis) -> Self {
        let (body, labels) = (String::new(), Labels::new(width, height));
        let mut plot = Self { width, height, x, y, below: 0.0, body, labels };
        plot.grid();
        plot
    }

    fn grid(&mut self) {
        let (width, height) = (self.width, self.height);
        for (value, word) in self.x.marks((width / 75.0) as usize) {
            let at = self.left(value);
            let _ = write!(
                self.body,
                "<path class=\"grid\" d=\"M{at:.1} 0V{height:.0}\"/><text class=\"tick\" x=\"{at:.1}\" y=\"{:.0}\" \
                 text-anchor=\"middle\">{word}</text>",
                height + 17.0
            );
        }
        for (value, word) in self.y.marks((height / 32.0) as usize) {
            let at = self.top(value);
            let _ = write!(
                self.body,
                "<path class=\"grid\" d=\"M0 {at:.1}H{width:.0}\"/><text class=\"tick\" x=\"-8\" y=\"{:.1}\" \
                 text-anchor=\"end\">{word}</text>",
                at + 4.0
            );
        }
    }

    fn left(&self, value: f64) -> f64 {
        self.x.place(value) * self.width
    }

    fn top(&self, value: f64) -> f64 {
        (1.0 - self.y.place(value)) * self.height
    }

    /// Whether a point lies inside the field.
    pub(super) fn holds(&self, x: f64, y: f64) -> bool {
        self.x.holds(x) && self.y.holds(y)
    }

    /// Positions of the finite points whose x lies inside the field.
    fn places(&self, points: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let every = points.len().div_ceil(CORNERS).max(1);
        let last = points.len().saturating_sub(1);
        let kept = points.iter().enumerate().filter(|(i, _)| i.is_multiple_of(every) || *i == last);
        let inside = kept.filter(|(_, (x, y))| self.x.holds(*x) && y.is_finite());
        inside.map(|(_, &(x, y))| (self.left(x), self.top(y))).collect()
    }

    fn path(&mut self, d: &str, stroke: Stroke<'_>, of: Option<usize>) {
        let dashes = if stroke.dashed { " stroke-dasharray=\"5 4\"" } else { "" };
        let of = of.map(|index| format!(" data-m=\"{index}\"")).unwrap_or_default();
        let (color, width) = (escaped(stroke.color), stroke.width);
        let _ = write!(
            self.body,
            "<path class=\"line\" d=\"{d}\" stroke=\"{color}\" stroke-width=\"{width}\"{dashes}{of}/>"
        );
    }

    /// A line through points; `of` is the number of the method that it belongs to.
    pub fn line(&mut self, points: &[(f64, f64)], stroke: Stroke<'_>, of: Option<usize>) {
        let mut d = String::new();
        for (index, (x, y)) in self.places(points).into_iter().enumerate() {
            let _ = write!(d, "{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' });
        }
        if !d.is_empty() {
            self.path(&d, stroke, of);
        }
    }

    /// Makes labels avoid a line through points if possible.
    pub(super) fn keep_free(&mut self, points: &[(f64, f64)]) {
        let places = self.places(points);
        places.windows(2).for_each(|pair| self.labels.keep_free(pair[0], pair[1]));
    }

    /// A step function: each value holds from its x to the next one's, the last to the end of the field.
    pub fn steps(&mut self, points: &[(f64, f64)], stroke: Stroke<'_>) {
        let mut d = String::new();
        for (index, (x, y)) in self.places(points).into_iter().enumerate() {
            let _ = if index == 0 { write!(d, "M{x:.1} {y:.1}") } else { write!(d, "H{x:.1}V{y:.1}") };
        }
        if !d.is_empty() {
            let _ = write!(d, "H{:.1}", self.width);
            self.path(&d, stroke, None);
        }
    }

    /// A horizontal line with a label above its right end.
    pub fn level(&mut self, y: f64, word: &str) {
        let (at, width) = (self.top(y), self.width);
        let _ = write!(
            self.body,
            "<path class=\"level\" d=\"M0 {at:.1}H{width:.0}\"/><text class=\"note\" x=\"{:.0}\" y=\"{:.1}\" \
             text-anchor=\"end\">{}</text>",
            width - 4.0,
            at - 5.0,
            escaped(word)
        );
    }

    /// A vertical line with a label at its bottom.
    pub fn upright(&mut self, x: f64, word: &str) {
        let (at, height) = (self.left(x), self.height);
        let _ = write!(
            self.body,
            "<path class=\"level\" d=\"M{at:.1} 0V{height:.0}\"/><text class=\"note\" x=\"{:.1}\" y=\"{:.0}\">{}</text>",
            at + 5.0,
            12.0,
            escaped(word)
        );
    }

    /// A dot, if its numbers are finite. `title` is its tooltip; the label is placed when all dots are known.
    pub fn dot(&mut self, (x, y): (f64, f64), dot: Dot, color: &str, label: Label, title: &str) {
        if !(x.is_finite() && y.is_finite()) {
            return;
        }
        let (x, y) = (self.left(x), self.top(y));
        let color = escaped(color);
        let fill = if dot == Dot::Full { &color } else { "#fff" };
        let _ = write!(
            self.body,
            "<circle class=\"dot\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" stroke=\"{color}\" fill=\"{fill}\"><title>{}</title>\
             </circle>",
            escaped(title)
        );
        self.labels.add(x, y, label);
    }

    /// A lane below the field on the same x: its name to the left, and spans from start to end with a weight of 0 to 1.
    pub fn lane(
        &mut self,
        name: &str,
        color: &str,
        spans: impl IntoIterator<Item = (f64, f64, f64)>,
        of: usize,
    ) {
        const HEIGHT: f64 = 20.0;
        let top = self.height + 48.0 + self.below;
        self.below += HEIGHT;
        let (color, name) = (escaped(color), escaped(name));
        let _ = write!(
            self.body,
            "<g class=\"lane\" data-m=\"{of}\"><rect class=\"bed\" x=\"0\" y=\"{top:.0}\" width=\"{:.0}\" height=\"14\"/>\
             <text class=\"name\" x=\"-10\" y=\"{:.0}\" text-anchor=\"end\" fill=\"{color}\">{name}</text>",
            self.width,
            top + 11.5
        );
        for (start, end, weight) in spans.into_iter().take(CORNERS) {
            if !self.x.meets(start, end) {
                continue;
            }
            let (from, to) = (self.left(start), self.left(end));
            let _ = write!(
                self.body,
                "<rect x=\"{from:.1}\" y=\"{top:.0}\" width=\"{:.1}\" height=\"14\" fill=\"{color}\" opacity=\"{:.2}\"/>",
                (to - from).max(1.2),
                0.15 + 0.75 * if weight > 0.0 { weight.min(1.0) } else { 0.0 }
            );
        }
        self.body += "</g>";
    }

    /// The whole figure. `says` is its description for screen readers; `wide` is additional width on the left.
    pub fn svg(mut self, says: &str, wide: f64) -> String {
        self.body += &self.labels.svg();
        let [left, top, right, bottom] = MARGINS;
        let left = left + wide;
        let extra = if self.below > 0.0 { self.below + 14.0 } else { 0.0 };
        let (width, height) = (left + self.width + right, top + self.height + bottom + extra);
        let middle = self.height / 2.0;
        let away = -54.0;
        format!(
            "<svg class=\"plot\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {width:.0} {height:.0}\" \
             width=\"{width:.0}\" height=\"{height:.0}\"><g transform=\"translate({left:.0} {top:.0})\">{}\
             <path class=\"frame\" d=\"M0 0V{:.0}H{:.0}\"/>\
             <text class=\"axis\" x=\"{:.0}\" y=\"{:.0}\" text-anchor=\"middle\">{}</text>\
             <text class=\"axis\" transform=\"translate({away:.0} {middle:.0}) rotate(-90)\" text-anchor=\"middle\">{}</text>\
             </g></svg>",
            escaped(says),
            self.body,
            self.height,
            self.width,
            self.width / 2.0,
            self.height + 35.0,
            escaped(&self.x.label),
            escaped(&self.y.label),
        )
    }
}

#[cfg(test)]
mod tests;
