//! The tree of nodes, flattened into joints with parents first.

use std::collections::BTreeMap;

use glam::{Quat, Vec3};
use lovelock_gltf::document::{Document, Node};

use crate::{Joint, MotionError, Skeleton};

/// The nodes of the scene, ordered with parents first.
pub(super) struct Tree {
    /// Nodes, parents first.
    pub(super) order: Vec<usize>,
    parent: Vec<Option<usize>>,
    /// Whether each node is drawn.
    pub(super) is_visible: Vec<bool>,
}

impl Tree {
    /// Traverses the scene. Links that close a cycle or give a node a second parent are dropped and counted.
    pub(super) fn new(
        file: &str,
        document: &Document,
        dropped: &mut BTreeMap<String, u64>,
        notes: &mut Vec<String>,
    ) -> Result<Self, MotionError> {
        let nodes = &document.nodes;
        let mut claimed = vec![None; nodes.len()];
        for (n, node) in nodes.iter().enumerate() {
            for &child in &node.children {
                if child >= nodes.len() {
                    let problem = format!("child {child} does not exist; the file has {} nodes", nodes.len());
                    return Err(MotionError::malformed(file, format!("node {n}"), problem));
                }
                claimed[child].get_or_insert(n);
            }
        }
        let mut roots = if let Some(scene) = document.scenes.get(document.scene.unwrap_or(0)) {
            scene.nodes.clone()
        } else {
            if let Some(scene) = document.scene {
                notes.push(format!("scene {scene} does not exist; all nodes are used"));
            }
            (0..nodes.len()).filter(|&n| claimed[n].is_none()).collect()
        };
        // Joints outside the scene are included too.
        for skin in &document.skins {
            for &joint in &skin.joints {
                if joint >= nodes.len() {
                    let problem = format!("joint {joint} does not exist; the file has {} nodes", nodes.len());
                    return Err(MotionError::malformed(file, "a skin", problem));
                }
                roots.push(top_of(joint, &claimed));
            }
        }
        let is_visible = nodes.iter().map(Node::is_visible).collect();
        let mut tree = Self { order: Vec::new(), parent: vec![None; nodes.len()], is_visible };
        let mut seen = vec![false; nodes.len()];
        for root in roots {
            if root >= nodes.len() {
                let problem = format!("node {root} does not exist; the file has {}", nodes.len());
                return Err(MotionError::malformed(file, "the scene", problem));
            }
            if !seen[root] {
                tree.walk(root, nodes, &mut seen, dropped);
            }
        }
        Ok(tree)
    }

    fn walk(&mut self, root: usize, nodes: &[Node], seen: &mut [bool], dropped: &mut BTreeMap<String, u64>) {
        seen[root] = true;
        let mut stack = vec![root];
        while let Some(n) = stack.pop() {
            self.order.push(n);
            for &child in nodes[n].children.iter().rev() {
                if std::mem::replace(&mut seen[child], true) {
                    *dropped.entry("node_links".into()).or_default() += 1;
                } else {
                    self.parent[child] = Some(n);
                    self.is_visible[child] &= self.is_visible[n];
                    stack.push(child);
                }
            }
        }
    }

    /// Builds a skeleton of the `wanted` nodes and their ancestors. The second value is the joint of each
    /// node.
    pub(super) fn skeleton(
        &self,
        file: &str,
        document: &Document,
        mut wanted: Vec<bool>,
        dropped: &mut BTreeMap<String, u64>,
    ) -> Result<(Skeleton, Vec<Option<usize>>), MotionError> {
        for &n in self.order.iter().rev() {
            if let (true, Some(parent)) = (wanted[n], self.parent[n]) {
                wanted[parent] = true;
            }
        }
        let mut skeleton = Skeleton::default();
        let mut joint_of_node = vec![None; document.nodes.len()];
        for &n in self.order.iter().filter(|&&n| wanted[n]) {
            let (translation, rotation, scale) = document.nodes[n].local().unwrap_or_else(|| {
                *dropped.entry("node_transforms".into()).or_default() += 1;
                (Vec3::ZERO, Quat::IDENTITY, Vec3::ONE)
            });
            let parent = self.parent[n].and_then(|p| joint_of_node[p]);
            let name = document.nodes[n].name.clone().unwrap_or_else(|| format!("node {n}"));
            joint_of_node[n] = Some(skeleton.joints.len());
            skeleton.joints.push(Joint { name, parent, translation, rotation, scale });
        }
        if skeleton.joints.len() >= usize::from(u16::MAX) {
            let problem = format!("{} joints; must be at most {}", skeleton.joints.len(), u16::MAX);
            return Err(MotionError::malformed(file, "the scene", problem));
        }
        skeleton.update_rest();
        Ok((skeleton, joint_of_node))
    }
}

/// The topmost ancestor of a node, or some node of the cycle that it belongs to.
fn top_of(mut node: usize, parent: &[Option<usize>]) -> usize {
    for _ in 0..parent.len() {
        match parent[node] {
            Some(above) => node = above,
            None => break,
        }
    }
    node
}
