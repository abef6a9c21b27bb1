//! How finely clusters are divided.

use lovelock_base::numbers::within;
use serde::{Deserialize, Serialize};

/// How the clusters of a hairstyle are divided.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ClusterSettings {
    /// Layers of each cluster, 1 to 32: 15 for a few near clusters, 5, or 3 for far ones. Symbol: `s_v`.
    pub layers: u32,
    /// Radius of the empty core as a part of the disk's, 0 to 0.9. Symbol: `v_core`.
    pub core: f32,
    /// Sectors around each layer, 4 to 64, for up to 64 clusters; more clusters have fewer. Symbol: `s_u`.
    pub sectors: u32,
    /// Hair shell volumes along each cluster, 2 to 128. Symbol: `s_t`.
    pub along: u32,
    /// The most hair shell volumes of all clusters: where there would be more, they have fewer along their length.
    pub most_volumes: u32,
    /// Clusters that differ by no more than this part of their hair share one set of features, 0 to 1.
    pub macro_tolerance: f32,
    /// The diameter of a strand, metres: the least semi-axis of a disk through the guides.
    pub strand_diameter: f32,
}

impl Default for ClusterSettings {
    fn default() -> Self {
        Self {
            layers: 5,
            core: 0.35,
            sectors: 32,
            along: 32,
            most_volumes: 2_000_000,
            macro_tolerance: 0.02,
            strand_diameter: 80e-6,
        }
    }
}

impl ClusterSettings {
    /// The division of `clusters` clusters whose guides have `links` links. Settings outside their ranges are clamped.
    pub fn grid(&self, clusters: usize, links: usize) -> Grid {
        let layers = self.layers.clamp(1, 32) as usize;
        let crowd = (64.0 / clusters.max(64) as f32).cbrt();
        let sectors = self.sectors.clamp(4, 64) as f32;
        let sectors = (sectors * crowd).round().max(sectors.min(8.0)) as usize;
        // More than two volumes on a link show nothing that the curve of the guides has.
        let wanted = (self.along.clamp(2, 128) as usize).min(2 * links.max(1));
        let room = self.most_volumes as usize / (layers * sectors * clusters.max(1));
        Grid { layers, sectors, along: wanted.min(room).max(2), core: within(self.core, 0.0, 0.9, 0.35) }
    }
}

/// The division of every cluster of a hairstyle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grid {
    /// Layers, from the core to the outside.
    pub layers: usize,
    /// Sectors around each layer.
    pub sectors: usize,
    /// Hair shell volumes along each cluster; it has one more cross-section.
    pub along: usize,
    /// Radius of the empty core.
    pub core: f32,
}

impl Grid {
    /// Cross-sections of a cluster.
    pub fn samples(&self) -> usize {
        self.along + 1
    }

    /// Sectors of all cross-sections of a cluster.
    pub fn faces(&self) -> usize {
        self.samples() * self.layers * self.sectors
    }

    /// Index of a sector among the faces of a cluster: `[sample][layer][sector]`.
    pub fn face(&self, sample: usize, layer: usize, sector: usize) -> usize {
        (sample * self.layers + layer) * self.sectors + sector
    }

    /// Radius of the middle of `layer`, as a part of the disk's.
    pub fn radius(&self, layer: usize) -> f32 {
        self.core + (1.0 - self.core) * (layer as f32 + 0.5) / self.layers as f32
    }

    /// The layer at the radius `v`, and the place within it, 0 at its inner edge to 1. The core belongs to the innermost
    /// layer, and what is outside the disk to the outermost.
    pub fn layer_at(&self, v: f32) -> (usize, f32) {
        locate((v - self.core) / (1.0 - self.core) * self.layers as f32, self.layers)
    }

    /// The sector at the angle `u` in radians, and the place within it, 0 to 1.
    pub fn sector_at(&self, u: f32) -> (usize, f32) {
        let turn = u / std::f32::consts::TAU;
        locate((turn - turn.floor()) * self.sectors as f32, self.sectors)
    }
}

/// The cell of `count` at `position`, and the place within it.
fn locate(position: f32, count: usize) -> (usize, f32) {
    let position = position.clamp(0.0, count as f32);
    let cell = (position as usize).min(count - 1);
    (cell, within(position - cell as f32, 0.0, 1.0, 0.5))
}
