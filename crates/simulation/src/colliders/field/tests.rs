use std::sync::LazyLock;

use lovelock_motion::{Body, Clip, Pose, RestDistance, Skin, load_character, pose_at, skin};

use super::*;
use crate::lanes::{LANES, ZERO3, put, splat3};
use crate::motion::substep;

type Dancer = (Arc<Body>, Arc<Clip>, Arc<BodyField>);

/// The shipped dancer, loaded once.
fn dancer() -> Dancer {
    static DANCER: LazyLock<Dancer> = LazyLock::new(|| {
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb");
        let character = load_character(&file).expect("the shipped dancer loads");
        let dance = character.clips.iter().find(|c| c.name == "dance").expect("she dances");
        let field = BodyField::new(&character.body, &RestDistance::new(&character.body)).expect("a field");
        (Arc::clone(&character.body), Arc::clone(dance), Arc::new(field))
    });
    DANCER.clone()
}

/// The dancer at one time, and her field there after a step.
struct Moment {
    head: HeadPose,
    pose: Pose,
    placed: FieldPose,
}

fn moment(body: &Body, dance: &Clip, field: &BodyField, time_secs: f64) -> Moment {
    let (mut pose, mut placed) = (Pose::default(), FieldPose::default());
    pose_at(body, Some(dance), time_secs, &mut pose);
    field.place(body, &pose, 0.0, &mut placed);
    Moment { head: HeadPose::new(&pose.world_from_head).expect("a head"), pose, placed }
}

/// The dancer's field in a step of the dance, and points on her skin in the working space of the step.
fn in_the_dance(time: f64, every: usize) -> (MovingField, crate::motion::Substep, Vec<Vec3>) {
    let (body, dance, field) = dancer();
    let (was, now) = (moment(&body, &dance, &field, time - 1.0 / 60.0), moment(&body, &dance, &field, time));
    let mut moving = MovingField::new(&field, 0.0, 0.012);
    moving.reset(&was.head, &was.placed);
    moving.advance(&now.head, &now.placed, 0.012, 1.0 / 60.0, true);
    let origin = now.head.place;
    let mut surface = Skin::default();
    skin(&body, &now.pose, &mut surface);
    let near = (0..body.mesh.positions.len()).filter(|&v| {
        let q = body.mesh.positions[v] - field.rest_from_head();
        q.y > -0.3 && q.x.abs() < 0.2
    });
    let places = near.step_by(every).map(|v| surface.positions[v] - origin).collect();
    (moving, substep(&was.head, &now.head, origin, 1.0 / 60.0), places)
}

/// Distances of points `out` metres above the vertices of head, neck and shoulders, at the end of a step of
/// the dance.
fn distances(culling: bool, moved: bool, out: f32) -> Vec<f32> {
    let (body, dance, field) = dancer();
    let mut all = Vec::new();
    for time in [0.7, 2.3, 3.9, 5.2, 7.7] {
        let (was, now) =
            (moment(&body, &dance, &field, time - 1.0 / 60.0), moment(&body, &dance, &field, time));
        let mut moving = MovingField::new(&field, 0.0, 0.012);
        moving.reset(&was.head, &was.placed);
        if moved {
            moving.advance(&now.head, &now.placed, 0.012, 1.0 / 60.0, culling);
        } else {
            moving.advance(&was.head, &was.placed, 0.012, 1.0 / 60.0, culling);
        }
        let origin = now.head.place;
        let step = substep(&was.head, &now.head, origin, 1.0 / 60.0);
        let mut surface = Skin::default();
        skin(&body, &now.pose, &mut surface);
        for (v, rest) in body.mesh.positions.iter().enumerate().step_by(7) {
            let q = *rest - field.rest_from_head();
            let inner = q.y > -0.3 && q.x.abs() < 0.2;
            // The lashes and the inside of the mouth are not skin.
            let skin = field.sample(q).is_some_and(|(d, _)| d.abs() < 2e-4);
            if inner && skin {
                let p = surface.positions[v] + surface.normals[v] * out - origin;
                let row = splat3(p);
                let mut planes = PlaneRow::unknown(PlaneRow::NO_SKIN);
                let distance =
                    moving.row(&row, &step, 1.0, 0.012, &mut planes).map_or(f32::MAX, |r| r.distance[3]);
                all.push(distance);
            }
        }
    }
    all.sort_by(f32::total_cmp);
    all
}

#[test]
fn the_field_matches_the_skin_during_a_dance() {
    let d = distances(true, true, 0.0);
    let (low, high) = (d[d.len() / 200], d[d.len() - 1 - d.len() / 200]);
    println!("{} vertices: {} to {}, 99 % from {low} to {high}", d.len(), d[0], d[d.len() - 1]);
    assert!(d.len() > 3000);
    assert!(low > -1.5e-3 && high < 1.5e-3, "99 % from {low} to {high}");
    assert_eq!(d, distances(false, true, 0.0), "tests with culling off change nothing");
    // Control: the field one frame earlier.
    let late = distances(true, false, 0.0);
    assert!(late[late.len() / 200] < -2e-3, "one frame earlier it was {}", late[late.len() / 200]);
}

#[test]
fn distances_grow_above_the_skin() {
    let d = distances(true, true, 0.006);
    let middle = d[d.len() / 2];
    assert!((middle - 0.006).abs() < 3e-4, "{middle} at 6 mm");
}

#[test]
fn a_point_does_not_depend_on_the_others_of_its_row() {
    let (moving, step, near) = in_the_dance(3.9, 37);
    // Every second point is far away, so that measured and unmeasured lanes lie side by side.
    let places: Vec<Vec3> = near.into_iter().flat_map(|p| [p, p + Vec3::Z]).collect();
    let measure = |row: &Lane3| {
        let mut planes = PlaneRow::unknown(PlaneRow::NO_SKIN);
        // Twice, so that the second search starts where the first one ended.
        let _ = moving.row(row, &step, 0.5, 0.012, &mut planes);
        let mut planes = PlaneRow::unknown(planes.rest);
        let found = moving.row(row, &step, 1.0, 0.012, &mut planes);
        (found.map(|r| (r.distance, r.normal, r.head, r.guess)), planes.rest)
    };
    let (mut touched, mut taken_back) = (0, 0);
    for group in places.as_chunks::<LANES>().0 {
        let mut row = ZERO3;
        for (k, &p) in group.iter().enumerate() {
            put(&mut row, k, p);
        }
        let (together, rest) = measure(&row);
        for (k, &p) in group.iter().enumerate() {
            let (alone, rest_alone) = measure(&splat3(p));
            let of =
                |found: &(Lane, Lane3, Lane, Lane)| (found.0[k], at(&found.1, k), found.2[k], found.3[k]);
            let near = |found: &Option<_>| found.as_ref().map(of).filter(|found| found.0 < 1.0);
            assert_eq!(near(&together), near(&alone), "{p}");
            assert_eq!(at(&rest, k), at(&rest_alone, k), "{p}");
            touched += usize::from(near(&alone).is_some());
            taken_back += usize::from(rest[0][k] < f32::MAX);
        }
    }
    println!("{touched} of {} points at skin, {taken_back} mapped to rest", places.len());
    assert!(
        touched > places.len() / 4 && taken_back > places.len() / 20,
        "control: the field is near enough points"
    );
}

#[test]
fn prefetched_planes_equal_those_of_single_rows() {
    let (moving, step, places) = in_the_dance(3.9, 5);
    let rows: Vec<Lane3> = places
        .as_chunks::<LANES>()
        .0
        .iter()
        .map(|row| std::array::from_fn(|a| Lane(row.map(|p| p[a]))))
        .collect();
    let mut foreseen = vec![PlaneRow::unknown(PlaneRow::NO_SKIN); rows.len()];
    let (mut found, mut searches) = (0, Vec::new());
    // The second search starts where the first one ended.
    for t in [0.5, 1.0] {
        for planes in &mut foreseen {
            *planes = PlaneRow::unknown(planes.rest);
        }
        let known: Vec<Lane3> = foreseen.iter().map(|planes| planes.rest).collect();
        moving.prefetch_planes(&rows, &step, t, 0.012, &mut foreseen, &mut searches);
        for ((row, planes), rest) in rows.iter().zip(&mut foreseen).zip(known) {
            let mut by_itself = PlaneRow::unknown(rest);
            let alone = moving.row(row, &step, t, 0.012, &mut by_itself);
            let together = moving.row(row, &step, t, 0.012, planes);
            let of = |r: &FieldRow| (r.distance, r.normal, r.head, r.guess);
            assert_eq!(together.as_ref().map(of), alone.as_ref().map(of));
            assert_eq!(planes.rest, by_itself.rest);
            found += usize::from(by_itself.rest[0].iter().any(|&x| x < f32::MAX));
        }
    }
    assert!(found > 20 && searches.len() > 20, "control: {found} rows have skin to find");
}

#[test]
fn all_vector_widths_occupy_the_same_cells() {
    let (moving, ..) = in_the_dance(3.9, 1000);
    let at_rest = Joints::default();
    let of = |width: Width| {
        let mut cells = moving.occupancy.clone();
        cells.update(width, 0.013, [&at_rest, &moving.joints], true);
        let mut back = Vec::new();
        moving.weightings.inverse_maps(width, &moving.joints, &mut back);
        (cells.nearest.clone(), back)
    };
    let everyone = of(Width::Baseline);
    for &width in Width::ALL.iter().filter(|width| width.is_available()) {
        let own = of(width);
        assert!(own.0 == everyone.0, "{width:?}: other cells");
        assert!(own.1 == everyone.1, "{width:?}: other inverse maps");
    }
    let known = everyone.0.iter().filter(|&&nearest| nearest != u32::MAX).count();
    assert!(known > 500, "control: {known} cells hold skin");
    assert_ne!(everyone.1, moving.before, "control: the joints have moved");
}

#[test]
fn non_finite_and_singular_skin_stays_at_rest() {
    let (moving, ..) = in_the_dance(3.9, 1000);
    let mut joints = *moving.joints.all();
    let rest = |joints: &Joints| {
        let mut back = Vec::new();
        moving.weightings.inverse_maps(Width::widest(), joints, &mut back);
        back.iter().filter(|back| back.apply(Vec3::ONE).truncate() == Vec3::ONE).count()
    };
    let at_rest = rest(&moving.joints);
    joints[1].translation.x = f32::NAN;
    let lost = rest(&Joints::new(joints));
    joints[1] = Affine3A::from_scale(Vec3::new(1.0, 1e-6, 1.0));
    // A mixture with other joints may still be invertible.
    let flat = rest(&Joints::new(joints));
    assert!(at_rest < lost && at_rest < flat, "{at_rest} at rest, {lost} where one is lost, {flat} flat");
}
