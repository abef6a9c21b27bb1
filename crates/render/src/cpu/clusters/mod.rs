//! Hair as clusters on the CPU: the definition of what `gpu/clusters` draws.

mod columns;
mod entries;
mod pixels;
mod published;
mod records;
mod sink;
mod vertices;

use std::sync::Arc;

use lovelock_base::memory::list_bytes;
use lovelock_base::simd::Width;
use lovelock_groom::{Hairstyle, Strands, interpolate};
use lovelock_satf::cache::shared;
use lovelock_satf::{ClusterHair, ClusterSettings, ClusterShading, LocalShadow};

use super::bins::Bins;
use super::hair::list::Fragments;
use super::strand_points::{LitParts, PointsIn, ShadedPoint, shade_all_parts};
use super::surface::raster::SurfaceSamples;
use super::tile::{Grid, HairPlanes};
use super::view::View;
use crate::clusters::{ClusterStage, cluster_share, guides_of, to_lights};
use crate::cpu::shadow::ShadowStage;
use crate::strand_details::StrandDetails;
use crate::{FrameInput, MAX_LIGHTS};
use columns::Columns;
use pixels::Covered;
use sink::Blend;
use vertices::Vertex;

/// The clusters of a frame; kept from frame to frame.
#[derive(Debug, Default)]
pub(super) struct PlacedClusters {
    stage: ClusterStage,
    hair: Option<Arc<ClusterHair>>,
    /// Points of the ribs.
    ribs: Strands,
    /// Where each light of those points enters their cluster, if layers shadow each other.
    entries: [Strands; MAX_LIGHTS],
    details: StrandDetails,
    transmittance: Vec<u32>,
    /// Transmittances of the ribs by light, before they are packed.
    answers: [Vec<f32>; MAX_LIGHTS],
    shaded: Vec<ShadedPoint>,
    lit: Vec<LitParts>,
    vertices: Vec<Vertex>,
    bins: Bins,
    settings: ClusterSettings,
    /// Lights that are on.
    lights: usize,
    is_hidden: bool,
    /// The part of the optical depth that clusters have.
    share: f32,
    /// Optical depth of a strand times the length of the arc that it lies in, metres.
    depth: f32,
}

impl PlacedClusters {
    /// Its memory without the list of clusters, bytes.
    pub fn bytes(&self) -> u64 {
        self.ribs.bytes()
            + self.entries.iter().map(Strands::bytes).sum::<u64>()
            + self.details.bytes()
            + list_bytes(&self.transmittance)
            + self.answers.iter().map(list_bytes).sum::<u64>()
            + list_bytes(&self.shaded)
            + list_bytes(&self.lit)
            + list_bytes(&self.vertices)
            + self.bins.bytes()
    }

    /// Follows the hair of `input`. Returns the part of its optical depth that clusters have.
    pub fn follow(&mut self, input: &FrameInput, height: u32) -> f32 {
        self.is_hidden = false;
        self.share = cluster_share(input, height);
        if self.share > 0.0
            && let Some(guides) = guides_of(input)
        {
            let hair = self.stage.follow(input);
            interpolate(&hair.ribs, guides, &mut self.ribs);
            self.details.follow(&hair.ribs);
            self.hair = Some(hair);
            self.settings = input.picture.clusters;
        } else {
            self.hair = None;
        }
        self.share
    }

    /// The clusters of the frame, if there are any.
    pub fn hair(&self) -> Option<Arc<ClusterHair>> {
        self.hair.clone()
    }

    /// The hairstyle of the ribs, if there are any.
    pub fn ribs(&self) -> Option<&Arc<Hairstyle>> {
        self.hair.as_ref().map(|hair| &hair.ribs)
    }

    /// Lights and projects the ribs, and sorts the columns between them into tiles. `view` is that of the ribs.
    pub fn place(
        &mut self,
        width: Width,
        input: &FrameInput,
        view: &View,
        shadow: &ShadowStage,
        grid: &Grid,
    ) {
        let Some(hair) = &self.hair else { return };
        let to_lights = to_lights(input);
        let enters = input.picture.clusters.local_shadow != LocalShadow::Map;
        if enters {
            for (entries, to_light) in self.entries.iter_mut().zip(&to_lights) {
                entries::place(hair, &self.ribs, *to_light, entries);
            }
        }
        let (ribs, entries) = (&self.ribs, &self.entries);
        let asked = |light: usize| if enters && light < to_lights.len() { &entries[light] } else { ribs };
        shadow.look_up_more(asked, &mut self.answers, &mut self.transmittance);
        let from = PointsIn {
            strands: &self.ribs,
            details: &self.details.words,
            transmittance: &self.transmittance,
            colours: self.details.colours(),
        };
        shade_all_parts(width, view, &from, &mut self.shaded, &mut self.lit);
        self.lights = to_lights.len();
        let shaded = (&self.shaded[..], &self.lit[..]);
        vertices::place(hair, &self.ribs, shaded, (input.camera.eye, &to_lights), &mut self.vertices);
        if input.picture.clusters.shading == ClusterShading::Paper {
            published::light(hair, view, (&self.ribs, &self.transmittance), input, &mut self.vertices);
        }
        let opacity = input.picture.strand_opacity;
        self.depth = self.share * opacity * lovelock_satf::strand_width(&input.look, hair.strands);
        let columns = hair.clusters() * hair.grid.around * hair.grid.along;
        let (vertices, of) = (&self.vertices, hair.grid);
        self.bins.fill(columns, grid.columns, grid.rows, |column| {
            vertices::bounds(vertices, of, column).and_then(|bounds| grid.range(bounds))
        });
    }

    /// Draws none for the rest of the frame: values other than light are those of strands.
    pub fn hide(&mut self) {
        self.is_hidden = true;
    }

    /// Whether a tile has no cluster.
    pub fn is_empty(&self, tile: usize) -> bool {
        self.hair.is_none() || self.is_hidden || self.bins.of(tile).is_empty()
    }

    /// Blends the clusters of a tile from near to far, layer by layer.
    pub fn blend(
        &self,
        width: Width,
        origin: [f32; 2],
        tile: usize,
        samples: &SurfaceSamples,
        order: &mut Vec<u64>,
        out: &mut HairPlanes,
    ) {
        let Some(columns) = self.columns(width, origin, samples) else { return };
        columns.sort(self.bins.of(tile), order);
        let mut sink = Blend::new(out);
        let layers = columns.hair.grid.layers;
        let mut covered = Covered::default();
        for &entry in order.iter() {
            let quad = entry as u32 as usize;
            columns.draw(quad / layers, quad % layers, &mut covered, &mut sink);
        }
    }

    /// Adds the fragments of a tile to the list.
    pub fn list(
        &self,
        width: Width,
        origin: [f32; 2],
        tile: usize,
        samples: &SurfaceSamples,
        out: &mut Fragments,
    ) {
        let Some(columns) = self.columns(width, origin, samples) else { return };
        let mut covered = Covered::default();
        for &column in self.bins.of(tile) {
            for layer in 0..columns.hair.grid.layers {
                columns.draw(column as usize, layer, &mut covered, out);
            }
        }
    }

    fn columns<'a>(
        &'a self,
        width: Width,
        origin: [f32; 2],
        samples: &'a SurfaceSamples,
    ) -> Option<Columns<'a>> {
        Some(Columns {
            width,
            hair: self.hair.as_ref()?,
            database: &shared().0,
            vertices: &self.vertices,
            settings: &self.settings,
            lights: self.lights,
            depth: self.depth,
            origin,
            samples,
        })
    }
}
