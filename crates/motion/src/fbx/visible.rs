//! Which nodes are drawn: `Visibility` and `Show` of nodes, display layers, and levels of detail.

use std::collections::BTreeSet;

use ufbx::{ElementType, LodDisplay, Node, Scene};

use super::DEPTH_LIMIT;
use crate::character::Hidden;

/// The visibility of the nodes of a scene at the start of its first clip.
pub(super) struct Visibility<'a> {
    scene: &'a Scene,
    start_secs: f64,
    /// Nodes in display layers that are switched off, by their numbers.
    in_hidden_layers: BTreeSet<u32>,
}

impl<'a> Visibility<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        let hidden = scene.display_layers.iter().filter(|layer| !layer.visible);
        let nodes = hidden.flat_map(|layer| &layer.nodes).map(|node| node.element.typed_id).collect();
        let start_secs = scene.anim_stacks.iter().next().map_or(0.0, |stack| stack.time_begin);
        Self { scene, start_secs, in_hidden_layers: nodes }
    }

    /// Why a node is not drawn, if it is not. A node takes over what hides its parent, unless its `Visibility Inheritance` is off.
    pub(super) fn hidden(&self, node: &Node) -> Option<Hidden> {
        let mut why = None;
        let (mut at, mut inherits) = (Some(node), true);
        for _ in 0..=DEPTH_LIMIT {
            let Some(node) = at else { break };
            let is_shown = self.is_on(node, "Show")
                && self.is_on(node, "Visibility")
                && !self.in_hidden_layers.contains(&node.element.typed_id);
            if inherits && !is_shown {
                return Some(Hidden::Invisible);
            }
            inherits &= self.is_on(node, "Visibility Inheritance");
            if is_coarser_level(node) {
                why = Some(Hidden::StandIn);
            }
            at = node.parent.as_deref();
        }
        why
    }

    /// Whether a property of a node is not 0 at the start. Properties that a file does not state are on.
    fn is_on(&self, node: &Node, name: &str) -> bool {
        if node.element.props.find_prop(name).is_none() {
            return true;
        }
        let found = ufbx::evaluate_prop(&self.scene.anim, &node.element, name, self.start_secs);
        found.value_vec4.x > 0.0
    }
}

/// Whether a node is another level of detail than the first one of its group, which is the finest.
fn is_coarser_level(node: &Node) -> bool {
    let Some(parent) = node.parent.as_deref().filter(|parent| parent.attrib_type == ElementType::LodGroup)
    else {
        return false;
    };
    let place = parent.children.iter().position(|child| child.element.typed_id == node.element.typed_id);
    let group = parent.attrib.as_deref().and_then(ufbx::as_lod_group);
    let display = place.and_then(|place| group?.lod_levels.get(place)).map(|level| level.display);
    place.is_some_and(|place| place > 0) && display != Some(LodDisplay::Show)
}
