//! The shape of clusters where guides say little of it, and after a haircut.

use std::sync::Arc;

use glam::{Affine3A, Vec2, Vec3};
use lovelock_groom::{
    Blade, GroomSettings, GuideFrame, Haircut, Hairstyle, PlainHead, Strands, WispCurve, grow, interpolate,
    trimmed,
};
use lovelock_satf::{ClusterHair, ClusterSettings};

use super::hair::{LINKS, Made, at_rest, corners, guides, random_weights, style};

/// The width of a strand, metres.
const WIDTH: f32 = 80e-6;

fn points_of(style: &Hairstyle) -> Strands {
    let mut strands = Strands::default();
    interpolate(style, &at_rest(style), &mut strands);
    strands
}

/// The ribs of the clusters of a hairstyle, and points per rib.
fn ribs_of(style: &Arc<Hairstyle>) -> (ClusterHair, Strands) {
    let hair = ClusterHair::new(style, &ClusterSettings::default(), WIDTH);
    let ribs = points_of(&hair.ribs);
    (hair, ribs)
}

/// A straight lock that is equally wide everywhere, whose guides meet on a line near its middle.
fn lock_whose_guides_meet_on_a_line() -> Hairstyle {
    let wide = |p: usize| if (5..=6).contains(&p) { 0.01 } else { 1.0 };
    let meeting = guides(|p| corners(0.01).map(|q| q * Vec2::new(wide(p), 1.0)));
    let whole = guides(|_| corners(0.01));
    let strands = random_weights(1, 300).into_iter().map(Made::plain).collect();
    let mut style = style(&[(meeting, strands)]);
    let curve = WispCurve::at_rest(&style.guides, &style.wisps[0]);
    let set = &mut style.strands;
    for (strand, ends) in set.first_point.windows(2).enumerate() {
        let weights = set.weights[strand];
        for i in ends[0] as usize..ends[1] as usize {
            let u = set.guide_param[i];
            let at = (0..3).map(|g| whole[g][0] * weights[g]).sum::<Vec3>() - Vec3::Y * (0.02 * u);
            let offset = curve.offset_to(weights, u, at);
            (set.offset_normal[i], set.offset_binormal[i], set.offset_tangent[i]) = offset.into();
        }
    }
    style
}

#[test]
fn a_lock_stays_as_wide_as_its_strands_where_its_guides_meet() {
    let style = Arc::new(lock_whose_guides_meet_on_a_line());
    let (hair, ribs) = ribs_of(&style);
    let (around, points) = (hair.grid.around, hair.grid.points());
    let strands = points_of(&style);
    for i in 0..points {
        let rim: Vec<Vec3> = (0..around).map(|rib| ribs.point((around + rib) * points + i)).collect();
        // How far ribs and strands reach along both axes of the section.
        for axis in [Vec3::X, Vec3::Z] {
            let widest =
                |of: &mut dyn Iterator<Item = Vec3>| of.map(|p| p.dot(axis).abs()).fold(0.0, f32::max);
            let ribs = widest(&mut rim.iter().copied());
            let strands = widest(&mut (0..strands.points()).map(|i| strands.point(i)));
            assert!(
                (0.6..1.15).contains(&(ribs / strands)),
                "section {i} of {LINKS} links: {ribs} of {strands}"
            );
        }
    }
}

#[test]
fn clusters_of_cut_hair_end_where_its_strands_end() {
    let head = PlainHead;
    let whole = grow(&GroomSettings::default(), &head.scalp(48), &head).expect("a hairstyle");
    let lowest_of_hair = points_of(&whole).y.iter().copied().fold(f32::MAX, f32::min);
    let blade = Blade::Plane { point: Vec3::Y * (lowest_of_hair + 0.1), normal: Vec3::NEG_Y };
    let frame = GuideFrame::at_rest(&whole.guides, Affine3A::IDENTITY, 0.0);
    let cut = Haircut::of(&whole, &frame, &blade).expect("the blade meets hair");
    let kept = Arc::new(trimmed(&whole, &cut));
    let shortened = |wisp: usize| whole.wisps[wisp].guides.iter().any(|&g| cut.kept[g as usize] < 1.0);

    let strands = points_of(&kept);
    let (hair, ribs) = ribs_of(&kept);
    let (_, uncut) = ribs_of(&Arc::new(whole.clone()));
    let per_wisp = 2 * hair.grid.around;
    let (mut compared, mut longer, mut further) = (0, 0, 0.0);
    for (w, wisp) in kept.wisps.iter().enumerate().filter(|(w, _)| shortened(*w)) {
        let lowest = |of: &Strands, first: usize, count: usize| {
            let points = of.first_point[first] as usize..of.first_point[first + count] as usize;
            of.y[points].iter().copied().fold(f32::MAX, f32::min)
        };
        let own = lowest(&strands, wisp.first_strand as usize, wisp.strand_count as usize);
        let cluster = lowest(&ribs, w * per_wisp, per_wisp);
        // At most 14 mm further, 5 mm in the mean: where few strands are left, their section stays about as wide as before.
        assert!(
            (-0.016..0.008).contains(&(cluster - own)),
            "cluster {w} ends at {cluster}, its strands at {own}"
        );
        compared += 1;
        further += own - cluster;
        longer += usize::from(lowest(&uncut, w * per_wisp, per_wisp) < own - 0.03);
    }
    assert!(compared > 5, "{compared}");
    assert!(further < 0.007 * compared as f32, "{} m in the mean", further / compared as f32);
    assert!(longer > compared / 2, "the control: {longer} of {compared} are longer without the cut");
}
