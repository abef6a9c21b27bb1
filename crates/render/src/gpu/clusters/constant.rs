//! What stays while the hairstyle does: the database, the boundary sectors, and how large volumes are at rest.

use std::sync::Arc;

use glam::Affine3A;
use lovelock_gpu::{Gpu, GrowBuffer, wgpu};
use lovelock_groom::{GuideFrame, Strands, interpolate};
use lovelock_satf::cache::shared;
use lovelock_satf::{ClusterHair, RibGrid};

/// The largest sides of a hair shell volume at rest, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Largest {
    pub along: f32,
    pub across: f32,
}

/// Buffers that are written once per device or per hairstyle.
#[derive(Debug)]
pub(super) struct ConstantBuffers {
    of: Option<Arc<ClusterHair>>,
    records: [GrowBuffer<u8>; 2],
    cells: GrowBuffer<u32>,
    pub largest: Largest,
}

impl ConstantBuffers {
    /// Uploads the database, which is made first if this process has not used it.
    pub fn new(gpu: &Gpu) -> Self {
        let storage = wgpu::BufferUsages::STORAGE;
        let (database, _) = shared();
        let mut records = ["opacities of records", "reflectances of records"]
            .map(|label| GrowBuffer::new(gpu, label, storage));
        records[0].write(gpu, database.opacities());
        records[1].write(gpu, database.reflectances());
        let cells = GrowBuffer::new(gpu, "cells of clusters", storage);
        Self { of: None, records, cells, largest: Largest::default() }
    }

    /// Uploads the boundary sectors of a hairstyle that has changed.
    pub fn follow(&mut self, gpu: &Gpu, hair: &Arc<ClusterHair>) {
        if self.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, hair)) {
            return;
        }
        let words: Vec<u32> =
            hair.shapes.iter().copied().chain(hair.cells.iter().map(|cell| cell.0)).collect();
        self.cells.write(gpu, &words);
        self.largest = largest(hair);
        self.of = Some(Arc::clone(hair));
    }

    /// The opacities and the reflectances of the database.
    pub fn records(&self) -> [&wgpu::Buffer; 2] {
        self.records.each_ref().map(GrowBuffer::raw)
    }

    /// The macro-cluster of each cluster, and the boundary sectors of all macro-clusters.
    pub fn cells(&self) -> &wgpu::Buffer {
        self.cells.raw()
    }

    /// Memory in use, bytes.
    pub fn bytes(&self) -> u64 {
        self.records().iter().map(|buffer| buffer.size()).sum::<u64>() + self.cells.raw().size()
    }
}

fn largest(hair: &ClusterHair) -> Largest {
    let RibGrid { around, .. } = hair.grid;
    let points = hair.grid.points();
    let mut ribs = Strands::default();
    let rest = GuideFrame::at_rest(&hair.ribs.guides, Affine3A::IDENTITY, 0.0);
    interpolate(&hair.ribs, &rest, &mut ribs);
    let mut largest = Largest::default();
    for cluster in 0..hair.clusters() {
        for ring in 0..2 {
            let first = (2 * cluster + ring) * around * points;
            let at = |rib: usize, i: usize| ribs.point(first + rib % around * points + i);
            for rib in 0..around {
                for i in 0..points {
                    largest.across = largest.across.max(at(rib, i).distance(at(rib + 1, i)));
                    if i > 0 {
                        largest.along = largest.along.max(at(rib, i).distance(at(rib, i - 1)));
                    }
                }
            }
        }
    }
    largest
}
