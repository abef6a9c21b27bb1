use glam::Vec3;

use super::*;

const HEAD: HeadBox = HeadBox { middle: Vec3::new(0.0, 0.1, 0.0), half: Vec3::new(0.08, 0.1, 0.1) };

fn part(region: MaskRegion) -> MaskPart {
    MaskPart { softness: 0.0, ..MaskPart::region(region) }
}

#[test]
fn regions_lie_where_their_names_say() {
    let at = |region, x, y, z| part(region).at(Vec3::new(x, y, z));
    for (region, inside, outside) in [
        (MaskRegion::Left, [0.5, 0.0, 0.0], [-0.5, 0.0, 0.0]),
        (MaskRegion::Right, [-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]),
        (MaskRegion::Front, [0.0, 0.0, 0.5], [0.0, 0.0, -0.5]),
        (MaskRegion::Back, [0.0, 0.0, -0.5], [0.0, 0.0, 0.5]),
        (MaskRegion::Top, [0.0, 0.9, 0.0], [0.0, -0.5, 0.0]),
        (MaskRegion::Bottom, [0.0, -0.5, 0.0], [0.0, 0.9, 0.0]),
        (MaskRegion::Crown, [0.0, 0.9, -0.4], [0.0, 0.5, 0.9]),
        (MaskRegion::Nape, [0.0, -0.8, -0.6], [0.0, 0.9, 0.0]),
        (MaskRegion::Temples, [0.9, 0.0, 0.4], [0.0, 1.0, 0.0]),
        (MaskRegion::Middle, [0.0, 1.0, 0.0], [0.6, 0.6, 0.0]),
        (MaskRegion::Patch, [0.0, 0.8, 0.5], [0.0, 0.8, -0.5]),
    ] {
        let [[x, y, z], [a, b, c]] = [inside, outside];
        assert_eq!((at(region.clone(), x, y, z), at(region.clone(), a, b, c)), (1.0, 0.0), "{region:?}");
    }
    assert_eq!(at(MaskRegion::All, 0.3, 0.2, 0.1), 1.0);
    assert_eq!(at(MaskRegion::Unknown("ear-tips".to_owned()), 0.3, 0.2, 0.1), 0.0);
    assert_eq!(MaskPart { softness: 0.4, ..part(MaskRegion::Left) }.at(Vec3::ZERO), 0.5, "on a soft border");
}

#[test]
fn parts_are_combined_in_their_order() {
    let left = part(MaskRegion::Left);
    let front = |mix| MaskPart { mix, ..part(MaskRegion::Front) };
    let places = [[0.05, 0.1, 0.05], [0.05, 0.1, -0.05], [-0.05, 0.1, 0.05], [-0.05, 0.1, -0.05]];
    for (mix, expected) in [
        (MaskMix::Multiply, [1.0, 0.0, 0.0, 0.0]),
        (MaskMix::Add, [1.0, 1.0, 1.0, 0.0]),
        (MaskMix::Subtract, [0.0, 1.0, 0.0, 0.0]),
    ] {
        let mask = Mask { parts: vec![left.clone(), front(mix)], inverted: false };
        assert_eq!(places.map(|p| mask.at(&HEAD, Vec3::from(p))), expected, "{mix:?}");
        let turned = Mask { inverted: true, ..mask };
        assert_eq!(places.map(|p| turned.at(&HEAD, Vec3::from(p))), expected.map(|v| 1.0 - v), "{mix:?}");
    }
    assert_eq!(Mask::default().at(&HEAD, Vec3::ONE), 1.0);
    assert!(Mask::default().is_everywhere() && !Mask::of(left).is_everywhere());
}

#[test]
fn what_is_painted_is_found_in_every_direction() {
    let toward = Vec3::new(0.3, 0.8, -0.5).normalize_or(Vec3::Y);
    let mut map = MaskMap::default();
    assert!(map.is_empty() && map.at(toward) == 0.0);
    map.paint(|direction, old| old.max(f32::from(direction.dot(toward) > 0.9)));
    for i in 0..2000 {
        // Directions spread over the sphere.
        let (y, turn) = (1.0 - (i as f32 + 0.5) / 1000.0, i as f32 * 2.4);
        let across = (1.0 - y * y).max(0.0).sqrt();
        let direction = Vec3::new(across * turn.cos(), y, across * turn.sin());
        let cosine = direction.dot(toward);
        // Away from the border by more than a texel, 1/128 of the square or about 3 degrees.
        if !(0.86..0.94).contains(&cosine) {
            assert_eq!(map.at(direction * 0.7), f32::from(cosine > 0.9), "{direction}");
        }
    }
    assert_eq!(
        map.at(Vec3::ZERO).to_bits(),
        map.at(Vec3::ZERO).to_bits(),
        "a place without a direction has a value"
    );
}

#[test]
fn the_map_goes_on_over_the_edges_of_its_square() {
    let mut map = MaskMap::default();
    map.paint(|direction, _| 0.5 + 0.5 * direction.x);
    // Around the lower hemisphere, across the diagonal edges and the corners.
    let mut before = None;
    for i in 0..=720 {
        let turn = i as f32 * std::f32::consts::PI / 360.0;
        let direction = Vec3::new(0.3 * turn.cos(), -0.954, 0.3 * turn.sin());
        let value = map.at(direction);
        assert!((value - 0.5 - 0.5 * direction.x / direction.length()).abs() < 0.02, "{direction}: {value}");
        assert!(before.is_none_or(|before: f32| (before - value).abs() < 0.01));
        before = Some(value);
    }
}

#[test]
fn masks_survive_text_and_unknown_regions_are_kept() {
    let mut painted = part(MaskRegion::Painted);
    painted.map.paint(|direction, _| f32::from(direction.y > 0.5));
    let mask = Mask {
        parts: vec![painted, part(MaskRegion::Crown), part(MaskRegion::Unknown("ear-tips".to_owned()))],
        inverted: true,
    };
    let text = ron::to_string(&mask).expect("text");
    assert!(text.len() < 4000, "{} bytes", text.len());
    assert_eq!(ron::from_str::<Mask>(&text).expect("a mask"), mask);
    assert_eq!(mask.unknown().collect::<Vec<_>>(), ["ear-tips"]);
    for bad in ["(parts:[(map:\"!\")])", "(parts:[(map:\"AAAA\")])"] {
        let error = ron::from_str::<Mask>(bad).expect_err("no mask").to_string();
        assert!(error.contains("painted mask"), "{error}");
    }
}

#[test]
fn numbers_far_outside_are_brought_into_range() {
    let wild = MaskPart { border: f32::NAN, softness: -9.0, radius: f32::INFINITY, ..MaskPart::default() };
    let tame = wild.clamped();
    assert_eq!((tame.border, tame.softness, tame.radius), (0.0, 0.0, 3.0));
    let many = Mask { parts: vec![MaskPart::default(); 100], inverted: false };
    assert_eq!(many.clamped().parts.len(), Mask::MAX_PARTS);
}
