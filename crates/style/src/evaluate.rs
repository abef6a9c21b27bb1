//! Applies a stack, again only from the first change on.

use std::sync::Arc;

use lovelock_groom::{Hairstyle, Obstacle};

use crate::{HeadBox, Layer, Operation, Scope, StyleStack};

/// Applies stacks and keeps the hairstyle after each layer, so that a change of one layer recomputes only that one and those after it.
///
/// Hairstyles that together take more than [`StyleCache::MAX_BYTES`] are not all kept: those after the first layers are dropped first.
#[derive(Clone)]
pub struct StyleCache {
    start: Option<(Arc<Hairstyle>, Arc<dyn Obstacle + Send>)>,
    steps: Vec<Step>,
    most_bytes: u64,
}

impl Default for StyleCache {
    fn default() -> Self {
        Self { start: None, steps: Vec::new(), most_bytes: Self::MAX_BYTES }
    }
}

/// A layer and the hairstyle after it.
#[derive(Clone)]
struct Step {
    layer: Layer,
    factor: f32,
    /// `None` if it is not kept.
    style: Option<Arc<Hairstyle>>,
    /// The memory of the hairstyle; 0 for the base.
    bytes: u64,
    fits: bool,
    /// Whether it is a tie that acts and gathers nothing.
    gathers_nothing: bool,
}

/// The result of a stack.
#[derive(Debug)]
pub struct Styled {
    /// The hairstyle after all layers; the base itself if none has an effect.
    pub style: Arc<Hairstyle>,
    /// The names of the layers that were skipped because they were made for another hairstyle.
    pub skipped: Vec<String>,
    /// The positions in the stack of ties that act and gather no hair.
    pub idle_ties: Vec<usize>,
}

/// The hairstyle after one layer; `None` if the layer changes nothing.
///
/// `factor` is [`StyleStack::factor`] of the layer, and `obstacle` the body without hair.
pub fn apply_layer(
    layer: &Layer,
    factor: f32,
    style: &Hairstyle,
    obstacle: &dyn Obstacle,
) -> Option<Hairstyle> {
    let operation = layer.operation.known()?;
    let idle = !layer.on || factor * layer.weight == 0.0 || layer.ramp.is_zero();
    if idle || !operation.fits(style) {
        return None;
    }
    let scope = Scope {
        obstacle,
        head: HeadBox::of(&style.scalp),
        weight: layer.weight * factor,
        mask: &layer.mask,
        ramp: &layer.ramp,
        seed: layer.seed,
    };
    let acts = |guide: usize| scope.at(style.guides.point(guide, 0)) != 0.0;
    if !(0..style.guides.count()).any(acts) {
        return None;
    }
    let mut out = style.clone();
    operation.apply(&mut out, &scope);
    Some(out)
}

impl StyleCache {
    /// The most memory of the hairstyles after layers, bytes: those of seven layers of 100,000 strands of 30 points.
    pub const MAX_BYTES: u64 = 512 << 20;

    /// The memory of the hairstyles that are kept after layers, bytes. A layer that changes nothing has that of the layer before.
    pub fn bytes(&self) -> u64 {
        let mut last = None;
        let own = |(style, bytes): (&Arc<Hairstyle>, u64)| {
            let is_other = last.replace(Arc::as_ptr(style)) != Some(Arc::as_ptr(style));
            if is_other { bytes } else { 0 }
        };
        self.steps.iter().filter_map(|step| Some((step.style.as_ref()?, step.bytes))).map(own).sum()
    }

    /// Forgets hairstyles until the rest takes no more than it may. The last one is the result, which is kept.
    fn trim(&mut self) {
        for k in 0..self.steps.len().saturating_sub(1) {
            if self.bytes() <= self.most_bytes {
                return;
            }
            self.steps[k].style = None;
        }
    }

    /// Applies the layers of `stack` to `base` in their order. Results are reused for the first layers that act as in the last call, if
    /// that one had the same `base` and `obstacle` (the same allocations).
    pub fn apply(
        &mut self,
        base: &Arc<Hairstyle>,
        stack: &StyleStack,
        obstacle: Arc<dyn Obstacle + Send>,
    ) -> Styled {
        let body = Arc::clone(&obstacle);
        self.fold(base, stack, obstacle, |layer, factor, style| apply_layer(layer, factor, style, &*body))
    }

    fn fold(
        &mut self,
        base: &Arc<Hairstyle>,
        stack: &StyleStack,
        obstacle: Arc<dyn Obstacle + Send>,
        mut compute: impl FnMut(&Layer, f32, &Hairstyle) -> Option<Hairstyle>,
    ) -> Styled {
        let same_start = self.start.as_ref().is_some_and(|(style, body)| {
            Arc::ptr_eq(style, base) && std::ptr::addr_eq(Arc::as_ptr(body), Arc::as_ptr(&obstacle))
        });
        let same = |(step, layer): &(&Step, &Layer)| {
            step.layer.acts_like(layer) && step.factor.to_bits() == stack.factor(layer).to_bits()
        };
        let same = if same_start { self.steps.iter().zip(&stack.layers).take_while(same).count() } else { 0 };
        let kept =
            self.steps[..same].iter().rposition(|step| step.style.is_some()).map_or(0, |last| last + 1);
        self.start = Some((Arc::clone(base), obstacle));
        self.steps.truncate(kept);
        for layer in &stack.layers[kept..] {
            let before = self.steps.last().and_then(|step| step.style.as_ref()).unwrap_or(base);
            let factor = stack.factor(layer);
            let fits = layer.operation.known().is_none_or(|operation| operation.fits(before));
            let after = if fits { compute(layer, factor, before) } else { None };
            let unchanged = self.steps.last().map_or(0, |step| step.bytes);
            let bytes = after.as_ref().map_or(unchanged, Hairstyle::bytes);
            let gathers_nothing = matches!(layer.operation, Operation::HairTie(_))
                && after.as_ref().is_some_and(|after| held_points(after) == held_points(before));
            let style = Some(after.map_or_else(|| Arc::clone(before), Arc::new));
            self.steps.push(Step { layer: layer.clone(), factor, style, bytes, fits, gathers_nothing });
            self.trim();
        }
        let idle_ties = (0..self.steps.len()).filter(|step| self.steps[*step].gathers_nothing).collect();
        let skipped = self.steps.iter().filter(|step| !step.fits && step.layer.on);
        Styled {
            style: Arc::clone(self.steps.last().and_then(|step| step.style.as_ref()).unwrap_or(base)),
            skipped: skipped.map(|step| step.layer.label().to_owned()).collect(),
            idle_ties,
        }
    }
}

/// How many guide points ties hold.
fn held_points(style: &Hairstyle) -> usize {
    style.held.iter().filter(|hold| **hold >= 0.0).count()
}

impl std::fmt::Debug for StyleCache {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.steps.iter().map(|step| &step.layer.operation)).finish()
    }
}

#[cfg(test)]
mod tests;
