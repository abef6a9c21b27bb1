//! Hairstyles made by hand.

use glam::{Mat2, Vec2, Vec3};
use lovelock_base::random::SplitMix64;
use lovelock_groom::{GuideFrame, Guides, Hairstyle, StrandSet, Wisp};

/// Links of the guides.
pub(crate) const LINKS: usize = 12;

/// A strand: its weights, its end in links, and its offsets along normal and binormal at a parameter.
pub(crate) struct Made {
    pub(crate) weights: [f32; 3],
    pub(crate) end: f32,
    pub(crate) offset: fn(f32) -> Vec2,
}

impl Made {
    /// A strand of full length without offsets.
    pub(crate) fn plain(weights: [f32; 3]) -> Self {
        Self { weights, end: LINKS as f32, offset: |_| Vec2::ZERO }
    }
}

/// The guides of a wisp: `offset` gives their places in the plane square to y at a link, around a straight axis.
pub(crate) fn guides(offset: impl Fn(usize) -> [Vec2; 3]) -> [Vec<Vec3>; 3] {
    [0, 1, 2].map(|g| {
        (0..=LINKS)
            .map(|p| {
                let at = offset(p)[g];
                Vec3::new(at.x, -0.02 * p as f32, at.y)
            })
            .collect()
    })
}

/// The corners of a triangle around a circle of `radius`.
pub(crate) fn corners(radius: f32) -> [Vec2; 3] {
    [0.3_f32, 2.4, 4.5].map(|angle| radius * Vec2::from_angle(angle))
}

/// A wisp's guides that turn, are squeezed and bend along their length.
pub(crate) fn lively() -> [Vec<Vec3>; 3] {
    let mut guides = guides(|p| {
        let at = p as f32 / LINKS as f32;
        let squeezed = Mat2::from_diagonal(Vec2::new(1.0 + at, 1.0 - 0.5 * at));
        corners(0.01).map(|q| Mat2::from_angle(2.0 * at) * squeezed * q)
    });
    for guide in &mut guides {
        for (p, point) in guide.iter_mut().enumerate() {
            let at = p as f32 / LINKS as f32;
            *point += Vec3::new(0.06 * at * at, 0.0, 0.03 * (4.0 * at).sin());
        }
    }
    guides
}

/// A hairstyle of wisps, each with its guides and strands.
pub(crate) fn style(wisps: &[([Vec<Vec3>; 3], Vec<Made>)]) -> Hairstyle {
    let mut guides = Guides { points_per_guide: LINKS + 1, ..Guides::default() };
    let mut set = StrandSet { first_point: vec![0], ..StrandSet::default() };
    let mut all = Vec::new();
    for (w, (of_wisp, strands)) in wisps.iter().enumerate() {
        for guide in of_wisp {
            guides.push(guide);
        }
        let first = 3 * w as u32;
        all.push(Wisp {
            guides: [first, first + 1, first + 2],
            first_strand: set.count() as u32,
            strand_count: strands.len() as u32,
        });
        for strand in strands {
            set.wisp.push(w as u32);
            set.weights.push(strand.weights);
            set.shade.push(0.5);
            for i in 0..=48 {
                let param = strand.end * i as f32 / 48.0;
                let offset = (strand.offset)(param);
                set.guide_param.push(param);
                set.offset_normal.push(offset.x);
                set.offset_binormal.push(offset.y);
                set.offset_tangent.push(0.0);
                set.taper.push(1.0);
            }
            set.first_point.push(set.guide_param.len() as u32);
        }
    }
    let style = Hairstyle { wisps: all, guides, strands: set, ..Hairstyle::default() };
    style.check().unwrap();
    style
}

/// Weights spread over the triangle.
pub(crate) fn random_weights(seed: u64, count: usize) -> Vec<[f32; 3]> {
    let mut random = SplitMix64::new(seed);
    (0..count)
        .map(|_| {
            let (a, b) = (random.unit(), random.unit());
            let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
            [a, b, 1.0 - a - b]
        })
        .collect()
}

/// The guides at rest.
pub(crate) fn at_rest(style: &Hairstyle) -> GuideFrame {
    GuideFrame::at_rest(&style.guides, glam::Affine3A::IDENTITY, 0.0)
}
