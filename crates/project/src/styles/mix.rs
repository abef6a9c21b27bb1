//! The layers of a project and of a style, mixed by what they change.

use lovelock_base::settings::Settings;
use lovelock_style::{Group, Layer, Operation, StyleStack, Subject};

/// What of a style is applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StyleParts {
    /// How the hair grows, its cut, its ties, and layers that change guides and strands.
    pub shape: bool,
    /// Its colours, and layers that change colours.
    pub colour: bool,
    /// How it moves, and layers that change that.
    pub motion: bool,
}

impl Default for StyleParts {
    fn default() -> Self {
        Self::ALL
    }
}

impl StyleParts {
    /// The whole style.
    pub const ALL: Self = Self { shape: true, colour: true, motion: true };
    /// Only its shape.
    pub const SHAPE: Self = Self { shape: true, colour: false, motion: false };
    /// Only its colours.
    pub const COLOUR: Self = Self { shape: false, colour: true, motion: false };
    /// Only how it moves.
    pub const MOTION: Self = Self { shape: false, colour: false, motion: true };

    /// Whether layers of that operation belong to these parts. Operations of other versions belong to the shape.
    fn has(self, operation: &Operation) -> bool {
        match operation.known().map(|operation| operation.kind().subject) {
            Some(Subject::Colour) => self.colour,
            Some(Subject::Motion) => self.motion,
            Some(Subject::Shape | Subject::Strands) | None => self.shape,
        }
    }
}

/// The stack `now` with the layers that belong to `parts` replaced by those of `style`, but for those that `stays` names. Layers that stay
/// keep their numbers, so that tracks still find them, and act after those of the style. Also the numbers of the layers that are a style's,
/// where `styled` were so before, and how many layers stay that belong to `parts`.
pub(super) fn mixed(
    now: &StyleStack,
    style: &StyleStack,
    parts: StyleParts,
    styled: &[u32],
    stays: &dyn Fn(&Layer) -> bool,
) -> (StyleStack, Vec<u32>, usize) {
    let of_user = |layer: &&Layer| parts.has(&layer.operation) && stays(layer);
    let users = now.layers.iter().filter(of_user).count();
    if parts == StyleParts::ALL && users == 0 {
        return (style.clone(), style.layers.iter().map(|layer| layer.id).collect(), 0);
    }
    let kept: Vec<&Layer> =
        now.layers.iter().filter(|layer| !parts.has(&layer.operation) || stays(layer)).collect();
    let taken = || style.layers.iter().filter(|layer| parts.has(&layer.operation));
    let kept_groups = || now.groups.iter().filter(|g| kept.iter().any(|layer| layer.group == Some(g.id)));
    // Groups of the style get numbers above those that stay.
    let above = kept_groups().map(|group| group.id).max().unwrap_or(0);
    let moved = |group: u32| group.saturating_add(above);
    let mut free = kept.iter().copied().chain(taken()).map(|layer| layer.id).max().unwrap_or(0);
    let mut out = StyleStack::default();
    for layer in taken() {
        let mut layer = layer.clone();
        if kept.iter().any(|kept| kept.id == layer.id) {
            free = free.saturating_add(1);
            layer.id = free;
        }
        layer.group = layer.group.map(moved);
        out.layers.push(layer);
    }
    let groups = style.groups.iter().map(|group| Group { id: moved(group.id), ..group.clone() });
    out.groups = groups.filter(|g| out.layers.iter().any(|layer| layer.group == Some(g.id))).collect();
    out.groups.extend(kept_groups().cloned());
    let before = styled.iter().filter(|id| kept.iter().any(|layer| layer.id == **id));
    let from_style = out.layers.iter().map(|layer| layer.id).chain(before.copied()).collect();
    out.layers.extend(kept.iter().map(|layer| (*layer).clone()));
    out.solo = now.solo.filter(|id| kept.iter().any(|layer| layer.id == *id));
    (out.clamped(), from_style, users)
}
