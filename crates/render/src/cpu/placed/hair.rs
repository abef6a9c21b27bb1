//! The hair of a tile.

use super::{PlacedScene, TileScratch};
use crate::Transparency;
use crate::cpu::hair::blend::{BlendTile, blend_segments_simd};
use crate::cpu::hair::list::{ListTile, list_segments_simd};
use crate::cpu::hair::state::BlendState;
use crate::cpu::hair::weigh::{Weighed, add_light_simd, weigh_segments_simd};
use crate::cpu::transparency::resolve_tile;
use crate::cpu::view::View;
use crate::cpu::visible::LateInput;

impl PlacedScene {
    /// Draws strands in a tile.
    pub(super) fn draw_hair(
        &self,
        (view, late): (&View, Option<&LateInput>),
        transparency: Transparency,
        origin: [f32; 2],
        segments: &[u32],
        scratch: &mut TileScratch,
    ) {
        if transparency == Transparency::Sorted {
            match late {
                Some(late) => self.weigh_and_light(late, origin, segments, scratch),
                None => self.blend(view, origin, segments, scratch),
            }
            scratch.blend.write(&mut scratch.hair);
        } else {
            scratch.fragments.clear();
            self.list_strands(view, transparency, origin, segments, scratch);
            resolve_tile(transparency, &mut scratch.fragments, &mut scratch.hair);
        }
    }

    /// Blends segments whose points have colours.
    fn blend(&self, view: &View, origin: [f32; 2], segments: &[u32], scratch: &mut TileScratch) {
        let opacity = view.uniform.opacity;
        let TileScratch { blend, hidden, pieces, .. } = scratch;
        blend.clear();
        self.keys.each_piece(segments, self.segments(), pieces, |order| {
            let input = BlendTile { origin, points: &self.points, order, hidden, opacity };
            blend_segments_simd(self.width.for_eight(), &input, blend);
            !blend.is_full()
        });
    }

    /// Blends segments, and computes the light of their points where that is needed first.
    fn weigh_and_light(
        &self,
        late: &LateInput,
        origin: [f32; 2],
        segments: &[u32],
        scratch: &mut TileScratch,
    ) {
        let opacity = late.opacity();
        let TileScratch { blend, hidden, pieces, weighed, wanted, .. } = scratch;
        blend.clear();
        weighed.clear();
        let mut add = |weighed: &mut Weighed, blend: &mut BlendState| {
            self.late.light(self.width, late, &self.points, weighed, wanted);
            add_light_simd(self.width.for_eight(), weighed, blend);
            weighed.clear();
        };
        self.keys.each_piece(segments, self.segments(), pieces, |order| {
            let mut input = BlendTile { origin, points: &self.points, order, hidden, opacity };
            while !input.order.is_empty() {
                let done = weigh_segments_simd(self.width.for_eight(), &input, blend, weighed);
                input.order = &input.order[done..];
                if weighed.is_full() {
                    add(weighed, blend);
                }
            }
            !blend.is_full()
        });
        if !weighed.is_empty() {
            add(weighed, blend);
        }
    }

    /// Adds the fragments of strands to the list.
    fn list_strands(
        &self,
        view: &View,
        transparency: Transparency,
        origin: [f32; 2],
        segments: &[u32],
        scratch: &mut TileScratch,
    ) {
        let TileScratch { samples, hidden, near_first, opaque, fragments, .. } = scratch;
        // The other modes weight fragments by all of their pixel.
        let is_ordered = matches!(transparency, Transparency::Sorted | Transparency::Exact);
        let segments = if is_ordered {
            opaque.clear();
            near_first.order(segments, self.segments(), &self.points)
        } else {
            segments
        };
        let input = ListTile {
            origin,
            points: &self.points,
            segments,
            first_points: self.segments(),
            samples,
            hidden,
            opacity: view.uniform.opacity,
            takes_samples: transparency == Transparency::Opaque,
        };
        list_segments_simd(self.width.for_eight(), &input, is_ordered.then_some(opaque), fragments);
    }

    /// Draws clusters, and strands among them.
    pub(super) fn draw_mixed(
        &self,
        view: &View,
        transparency: Transparency,
        origin: [f32; 2],
        (tile, segments): (usize, &[u32]),
        scratch: &mut TileScratch,
    ) {
        let TileScratch { samples, hair, order, .. } = scratch;
        if segments.is_empty() && transparency == Transparency::Sorted {
            self.clusters.blend(self.width, origin, tile, samples, order, hair);
            return;
        }
        scratch.fragments.clear();
        if !segments.is_empty() {
            self.list_strands(view, transparency, origin, segments, scratch);
        }
        self.clusters.list(self.width, origin, tile, &scratch.samples, &mut scratch.fragments);
        resolve_tile(transparency, &mut scratch.fragments, &mut scratch.hair);
    }
}
