//! Greedy compression of a curve. Twin of compress.wgsl.

use super::super::texels::curve::{MAX_NODES, Nodes};

/// A curve that is being compressed.
struct Greedy {
    nodes: Nodes,
    most: usize,
    tolerance: f32,
    /// The last step that the line from the last node passes within the tolerance.
    reached: f32,
    /// The least and the largest slope with which it does.
    slopes: [f32; 2],
}

impl Greedy {
    /// The last node.
    fn origin(&self) -> (f32, f32) {
        let last = self.nodes.count.clamp(1, MAX_NODES) - 1;
        (self.nodes.depths[last], self.nodes.lights[last])
    }

    /// Adds a node, from which a new line starts. Counts nodes that have no room.
    fn begin(&mut self, depth: f32, light: f32) {
        if self.nodes.count < self.most {
            (self.nodes.depths[self.nodes.count], self.nodes.lights[self.nodes.count]) = (depth, light);
        }
        self.nodes.count += 1;
        self.reached = depth;
        self.slopes = [f32::MIN, f32::MAX];
    }

    /// Whether there was room for all nodes.
    fn fits(&self) -> bool {
        self.nodes.count <= self.most
    }

    /// The transmittance at `depth` of the line whose slope is in the middle. It does not rise.
    fn line_at(&self, depth: f32) -> f32 {
        let (start, light) = self.origin();
        light + (0.5 * self.slopes[0] + 0.5 * self.slopes[1]).min(0.0) * (depth - start)
    }

    /// The slopes left of a line that passes a place within the tolerance, below `high` and above `low`.
    fn slopes_past(&self, depth: f32, high: f32, low: f32) -> [f32; 2] {
        let (start, light) = self.origin();
        let per_depth = 1.0 / (depth - start);
        // In this order, light that stays the same has slopes of the same size up and down.
        let least = (((high - light) - self.tolerance) * per_depth).min(0.0);
        let most = ((low - light) + self.tolerance) * per_depth;
        [self.slopes[0].max(least), self.slopes[1].min(most)]
    }

    /// Takes the step from `before` to `behind` at `depth`.
    fn step(&mut self, depth: f32, before: f32, behind: f32) {
        if depth > self.origin().0 {
            let both = self.slopes_past(depth, before, behind);
            if both[0] <= both[1] {
                (self.slopes, self.reached) = (both, depth);
                return;
            }
            // To the step, if its near end can be reached.
            let near = self.slopes_past(depth, before, before);
            if near[0] > near[1] && self.reached > self.origin().0 {
                self.begin(self.reached, self.line_at(self.reached));
                if !self.fits() {
                    return;
                }
                let both = self.slopes_past(depth, before, behind);
                if both[0] <= both[1] {
                    (self.slopes, self.reached) = (both, depth);
                    return;
                }
            }
            self.slopes = self.slopes_past(depth, before, before);
            let near = self.line_at(depth);
            self.begin(depth, near);
            if behind < near {
                self.begin(depth, behind);
            }
            return;
        }
        if self.origin().1 - behind > self.tolerance {
            self.begin(depth, behind);
        }
    }

    /// Ends the last line.
    fn end(&mut self) {
        if self.reached > self.origin().0 {
            self.begin(self.reached, self.line_at(self.reached));
        }
    }
}

/// The curve through `steps` (depths, and transmittances behind them) with at most `most` nodes. No node of the input errs by more than
/// `tolerance`, or by twice, four times … as much where nodes would not suffice.
pub(super) fn compressed(
    steps: &(impl Iterator<Item = (f32, f32)> + Clone),
    tolerance: f32,
    most: usize,
) -> Nodes {
    let mut tolerance = tolerance;
    loop {
        let mut made =
            Greedy { nodes: Nodes::NONE, most, tolerance, reached: 0.0, slopes: [f32::MIN, f32::MAX] };
        let mut before = 1.0;
        for (depth, behind) in steps.clone() {
            if made.nodes.count == 0 {
                made.begin(depth, 1.0);
            }
            made.step(depth, before, behind);
            before = behind;
            if !made.fits() {
                break;
            }
        }
        made.end();
        // All light lies between 0 and 1: from a tolerance of 1 on, one line is enough.
        if made.fits() || tolerance > 1.0 {
            made.nodes.count = made.nodes.count.min(most);
            return made.nodes;
        }
        tolerance *= 2.0;
    }
}
