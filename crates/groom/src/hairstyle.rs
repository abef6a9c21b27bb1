//! A hairstyle: grown from settings, or imported from a file.

use lovelock_base::memory::list_bytes;
use thiserror::Error;

use crate::{Guides, HairLook, MotionFactors, Scalp, StrandColours, StrandMarks};

/// One wisp: three guide strands, and the consecutive strands that follow them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wisp {
    /// Indices of its guides in [`Guides`].
    pub guides: [u32; 3],
    /// Index of its first strand in [`StrandSet`]; the strands of a wisp are consecutive.
    pub first_strand: u32,
    /// Number of strands; may be 0.
    pub strand_count: u32,
}

/// Guides that a tie gathers, which stay together beyond it.
#[derive(Clone, Debug, PartialEq)]
pub struct Rope {
    /// Each guide with the index of its first point beyond the tie.
    pub guides: Vec<(u32, u32)>,
    /// How far along the rope that first point is, metres, for each guide; 0 for all where empty.
    pub ahead: Vec<f32>,
    /// How firmly they stay together: 0 loose, 1 tight.
    pub tightness: f32,
    /// A rope that is thinner at rest counts as this thick: its guides are free up to this distance from its middle, metres.
    pub least_radius: f32,
}

impl Default for Rope {
    fn default() -> Self {
        Self { guides: Vec::new(), ahead: Vec::new(), tightness: 0.0, least_radius: 0.006 }
    }
}

/// How each rendered strand follows the guides of its wisp. Structure of arrays.
///
/// A point of a strand is `sum_g(weight_g * guide_g(u)) + frame(u) * offset`. The guides are Catmull-Rom curves with
/// the parameter `u` in links (0 at the root, `points_per_guide - 1` at the tip), and `frame(u)` is the
/// rotation-minimising frame along the mean of the wisp's guides. The offsets hold curl, frizz, clumping, strays and
/// the exact shape of imported strands; they are constants of the hairstyle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StrandSet {
    /// The wisp of each strand; strands are sorted by wisp.
    pub wisp: Vec<u32>,
    /// Barycentric weights of the wisp's three guides for each strand; they sum to 1 and may lie outside 0..=1.
    pub weights: Vec<[f32; 3]>,
    /// Index of the first point of each strand, then the total number of points (strands + 1 entries).
    pub first_point: Vec<u32>,
    /// Curve parameter along the guides of each point, in links.
    pub guide_param: Vec<f32>,
    /// Offset of each point along the frame's normal, metres.
    pub offset_normal: Vec<f32>,
    /// Offset of each point along the frame's binormal, metres.
    pub offset_binormal: Vec<f32>,
    /// Offset of each point along the frame's tangent, metres.
    pub offset_tangent: Vec<f32>,
    /// Width of each point as a fraction of the hair's diameter: 1 along most of the strand, less toward the tip.
    pub taper: Vec<f32>,
    /// A shade per strand in 0..=1, by which drawing varies the colour.
    pub shade: Vec<f32>,
    /// What is different from the look in the colour of each strand.
    pub colours: StrandColours,
    /// Groups and roots as the file of an import states them, for files that are written.
    pub marks: StrandMarks,
}

impl StrandSet {
    /// The memory of the strands, bytes.
    pub fn bytes(&self) -> u64 {
        let of_points = [
            &self.guide_param,
            &self.offset_normal,
            &self.offset_binormal,
            &self.offset_tangent,
            &self.taper,
            &self.shade,
        ];
        of_points.into_iter().map(list_bytes).sum::<u64>()
            + list_bytes(&self.wisp)
            + list_bytes(&self.weights)
            + list_bytes(&self.first_point)
            + size_of_val(self.colours.strands()) as u64
            + self.marks.bytes()
    }

    /// Number of strands.
    pub fn count(&self) -> usize {
        self.wisp.len()
    }

    /// Number of points of all strands.
    pub fn points(&self) -> usize {
        self.guide_param.len()
    }

    /// Number of segments of all strands.
    pub fn segments(&self) -> usize {
        self.points() - self.count()
    }

    /// The strands with their first `points` points each, which are all or fewer; a strand of fewer than 2 is left out. `wisps` are those of
    /// the hairstyle, and get the new strands.
    #[must_use]
    pub fn shortened(&self, wisps: &mut [Wisp], points: impl Fn(usize) -> usize) -> Self {
        let mut out = Self { first_point: vec![0], ..Self::default() };
        let mut kept = Vec::new();
        for wisp in wisps {
            let strands = wisp.first_strand as usize..(wisp.first_strand + wisp.strand_count) as usize;
            wisp.first_strand = out.wisp.len() as u32;
            for strand in strands {
                let whole = self.first_point[strand] as usize..self.first_point[strand + 1] as usize;
                let range = whole.start..whole.start + whole.len().min(points(strand));
                if range.len() < 2 {
                    continue;
                }
                kept.push(strand);
                out.guide_param.extend_from_slice(&self.guide_param[range.clone()]);
                out.offset_normal.extend_from_slice(&self.offset_normal[range.clone()]);
                out.offset_binormal.extend_from_slice(&self.offset_binormal[range.clone()]);
                out.offset_tangent.extend_from_slice(&self.offset_tangent[range.clone()]);
                out.taper.extend_from_slice(&self.taper[range]);
                out.first_point.push(out.guide_param.len() as u32);
                out.wisp.push(self.wisp[strand]);
                out.weights.push(self.weights[strand]);
                out.shade.push(self.shade[strand]);
            }
            wisp.strand_count = out.wisp.len() as u32 - wisp.first_strand;
        }
        out.marks = self.marks.selected(kept.iter().copied());
        if !self.colours.is_empty() {
            out.colours = self.colours.selected(kept.into_iter());
        }
        out
    }
}

/// A hairstyle, immutable and shared by `Arc`.
#[derive(Clone, Debug, Default)]
pub struct Hairstyle {
    /// Its name in the interface.
    pub name: String,
    /// The surface on which it grows, in head space.
    pub scalp: Scalp,
    /// The wisps, in the order of their strands.
    pub wisps: Vec<Wisp>,
    /// The guides at rest, in head space.
    pub guides: Guides,
    /// How firmly ties hold each guide point at its rest position in head space, as an angular frequency, 1/s. A
    /// negative value leaves the point to the simulation's own settings. Has the layout of [`Guides`], or is empty
    /// without ties.
    pub held: Vec<f32>,
    /// Hair that ties gather into ropes.
    pub ropes: Vec<Rope>,
    /// The largest radius, metres, that the wisp of a guide has at each of its points: where its guides are further apart,
    /// strands are drawn within a section of that radius. Has the layout of [`Guides`]; empty where nothing limits them.
    pub widest: Vec<f32>,
    /// Factors on how its guides move.
    pub motion: MotionFactors,
    /// The rendered strands, expressed relative to the guides.
    pub strands: StrandSet,
    /// Colour and width that the style suggests; a project may override them.
    pub look: HairLook,
}

/// An inconsistency of a [`Hairstyle`].
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum HairstyleError {
    /// Guides of fewer than 2 points, or arrays that are not a whole number of guides.
    #[error("the guides do not hold whole guides of 2 points or more")]
    Guides,
    /// An array of the strands or of the guides has the wrong length.
    #[error("the hairstyle's array `{0}` has the wrong length")]
    Length(&'static str),
    /// A factor on the motion is not a number, or out of [`MotionFactors::RANGE`].
    #[error("the hairstyle's array `{0}` has a factor that is not from 0 to {most}", most = MotionFactors::RANGE[1])]
    Factor(&'static str),
    /// Strands are out of order, or have fewer than 2 points.
    #[error("strand {0} is out of order or has fewer than 2 points")]
    Strand(usize),
    /// A rope refers to a missing guide.
    #[error("rope {0} names a missing guide")]
    Rope(usize),
    /// A wisp refers to missing guides, or to strands that do not follow those of the wisp before.
    #[error("wisp {0} names a missing guide or strands out of order")]
    Wisp(usize),
}

impl Hairstyle {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        let Self { scalp, guides, motion, .. } = self;
        let rope = |rope: &Rope| list_bytes(&rope.guides) + list_bytes(&rope.ahead);
        self.strands.bytes()
            + [&guides.x, &guides.y, &guides.z, &self.held, &self.widest]
                .map(list_bytes)
                .into_iter()
                .sum::<u64>()
            + [&motion.stiffness, &motion.hold, &motion.damping, &motion.friction]
                .map(list_bytes)
                .into_iter()
                .sum::<u64>()
            + list_bytes(&self.wisps)
            + list_bytes(&self.ropes)
            + self.ropes.iter().map(rope).sum::<u64>()
            + list_bytes(&scalp.positions)
            + list_bytes(&scalp.normals)
            + list_bytes(&scalp.triangles)
            + list_bytes(&scalp.mask)
    }

    /// The hairstyle with at most about `most` of its strands, evenly from all wisps, without the look: to find where hair is.
    #[must_use]
    pub fn thinned(&self, most: usize) -> Self {
        let every = self.strands.count().div_ceil(most.max(1)).max(1);
        let mut wisps = self.wisps.clone();
        let all_or_none = |strand: usize| if strand.is_multiple_of(every) { usize::MAX } else { 0 };
        let strands = self.strands.shortened(&mut wisps, all_or_none);
        let (guides, widest) = (self.guides.clone(), self.widest.clone());
        Self { name: self.name.clone(), wisps, guides, widest, strands, ..Self::default() }
    }

    /// Checks every index and length, so that interpolation can rely on them.
    ///
    /// # Errors
    /// The first inconsistency found.
    pub fn check(&self) -> Result<(), HairstyleError> {
        let guides = &self.guides;
        let n = guides.x.len();
        let whole = guides.points_per_guide >= 2 && n.is_multiple_of(guides.points_per_guide);
        if !whole || guides.y.len() != n || guides.z.len() != n {
            return Err(HairstyleError::Guides);
        }
        if !self.held.is_empty() && self.held.len() != n {
            return Err(HairstyleError::Length("held"));
        }
        if !self.widest.is_empty() && self.widest.len() != n {
            return Err(HairstyleError::Length("widest"));
        }
        let [low, high] = MotionFactors::RANGE;
        for (name, factors) in self.motion.lists() {
            if !factors.is_empty() && factors.len() != n {
                return Err(HairstyleError::Length(name));
            }
            if factors.iter().any(|factor| !(low..=high).contains(factor)) {
                return Err(HairstyleError::Factor(name));
            }
        }
        let missing = |rope: &Rope| rope.guides.iter().any(|(g, _)| *g as usize >= guides.count());
        if let Some(bad) = self.ropes.iter().position(missing) {
            return Err(HairstyleError::Rope(bad));
        }
        let set = &self.strands;
        let (count, points) = (set.count(), set.points());
        for (name, found, wanted) in [
            ("weights", set.weights.len(), count),
            ("first_point", set.first_point.len(), count + 1),
            ("shade", set.shade.len(), count),
            ("offset_normal", set.offset_normal.len(), points),
            ("offset_binormal", set.offset_binormal.len(), points),
            ("offset_tangent", set.offset_tangent.len(), points),
            ("taper", set.taper.len(), points),
        ] {
            if found != wanted {
                return Err(HairstyleError::Length(name));
            }
        }
        if !set.colours.is_empty() && set.colours.strands().len() != count {
            return Err(HairstyleError::Length("colours"));
        }
        if set.first_point[0] != 0 || set.first_point[count] as usize != points {
            return Err(HairstyleError::Length("first_point"));
        }
        if let Some(bad) = set.first_point.windows(2).position(|w| w[1] < w[0].saturating_add(2)) {
            return Err(HairstyleError::Strand(bad));
        }
        let mut next = 0;
        for (w, wisp) in self.wisps.iter().enumerate() {
            let strands = wisp.first_strand as usize..wisp.first_strand as usize + wisp.strand_count as usize;
            let sound = strands.start == next
                && strands.end <= count
                && wisp.guides.iter().all(|&g| (g as usize) < guides.count())
                && set.wisp[strands.clone()].iter().all(|&of| of as usize == w);
            if !sound {
                return Err(HairstyleError::Wisp(w));
            }
            next = strands.end;
        }
        if next == count { Ok(()) } else { Err(HairstyleError::Strand(next)) }
    }
}
