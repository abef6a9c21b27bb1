//! Colliders and the rest distance, on real characters.

use crate::common;

use glam::Vec3;
use lovelock_motion::{RestDistance, fit_colliders, head_mesh, load_character, signed_distance};

#[test]
fn colliders_fit_head_neck_and_shoulders() {
    let Some(data) = common::data_dir() else { return };
    check_fit(&data.join("characters/mh_body.glb"));
}

#[test]
fn colliders_fit_the_dancer() {
    let dancer = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb");
    if dancer.is_file() {
        check_fit(&dancer);
    } else {
        println!("skipped: no assets/dancer.glb");
    }
}

#[test]
fn the_head_of_a_figure_without_joints_is_not_inside_of_its_body() {
    let Some(data) = common::data_dir() else { return };
    let body = load_character(&data.join("reports/whole_body_without_joints.glb")).unwrap().body;
    let colliders = fit_colliders(&body);
    let of_head = |joint: usize| joint == body.head_joint;
    let deepest = |points: &[Vec3], heads: bool| {
        let shapes = colliders.iter().filter(|collider| of_head(collider.joint) == heads);
        let shapes: Vec<_> = shapes.map(|collider| &collider.shape_at_rest).collect();
        let depth =
            |p: &Vec3| shapes.iter().map(|shape| -signed_distance(shape, *p)).fold(f32::MIN, f32::max);
        points.iter().map(depth).fold(f32::MIN, f32::max)
    };
    let neck = body.skeleton.rest_position(body.head_joint).y;
    let points = |above: bool| -> Vec<Vec3> {
        let all = body.mesh.positions.iter().copied().enumerate();
        let own = all.filter(|(v, p)| of_head(body.dominant_joint(*v)) == above && (p.y > neck) == above);
        own.map(|(_, p)| p).collect()
    };
    let (head, rest) = (points(true), points(false));
    let found = deepest(&head, false);
    assert!(found < 0.003, "the head is {found} m deep in the body");
    // The control: the shapes of the body are there, and lie where its skin is.
    let near = rest.iter().filter(|p| deepest(std::slice::from_ref(p), false) > -0.03).count();
    println!("{} shapes, head {found} m deep, {near} of {} points near", colliders.len(), rest.len());
    assert!(colliders.len() > 4 && 2 * near > rest.len(), "{near} of {}", rest.len());
}

fn check_fit(path: &std::path::Path) {
    let body = load_character(path).unwrap().body;
    println!("{} {:?}", body.name, body.skeleton.joints[body.head_joint].name);
    let colliders = fit_colliders(&body);
    let union =
        |p: Vec3| colliders.iter().map(|c| signed_distance(&c.shape_at_rest, p)).fold(f32::MAX, f32::min);
    let head = body.skeleton.rest_position(body.head_joint);
    let mesh = head_mesh(&body);
    let stats = |name: &str, points: &[Vec3]| {
        let mut d: Vec<f32> = points.iter().map(|&p| union(p)).collect();
        d.sort_by(f32::total_cmp);
        let mean = d.iter().sum::<f32>() / d.len() as f32;
        println!(
            "{name}: {} points, mean {:.1} mm, 5% {:.1}, 50% {:.1}, 95% {:.1}",
            d.len(),
            mean * 1e3,
            d[d.len() / 20] * 1e3,
            d[d.len() / 2] * 1e3,
            d[d.len() * 19 / 20] * 1e3
        );
        mean
    };
    let scalp: Vec<Vec3> =
        mesh.positions.iter().zip(&mesh.scalp).filter(|(_, s)| **s > 0.5).map(|(p, _)| *p + head).collect();
    let all: Vec<Vec3> = mesh.positions.iter().map(|p| *p + head).collect();
    let chest: Vec<Vec3> =
        body.mesh.positions.iter().copied().filter(|p| p.y > head.y - 0.35 && p.x.abs() < 0.25).collect();
    let shoulders: Vec<Vec3> = body
        .mesh
        .positions
        .iter()
        .zip(&body.mesh.normals)
        .filter(|(p, n)| {
            n.y > 0.4 && (0.05..0.2).contains(&p.x.abs()) && (head.y - 0.25..head.y - 0.05).contains(&p.y)
        })
        .map(|(p, _)| *p)
        .collect();
    assert!(stats("tops of shoulders", &shoulders).abs() < 0.006);
    assert!((stats("scalp", &scalp) - 0.002).abs() < 0.004);
    assert!(stats("head and neck", &all).abs() < 0.005);
    assert!(stats("head to chest", &chest).abs() < 0.005);
}

#[test]
fn distance_of_the_resting_body() {
    let Some(data) = common::data_dir() else { return };
    let body = load_character(&data.join("characters/mh_body.glb")).unwrap().body;
    let distance = RestDistance::new(&body);
    let mesh = head_mesh(&body);
    println!("head mesh {} vertices {} triangles", mesh.positions.len(), mesh.triangles.len());
    let mut count = 0;
    let mut askew = 0;
    let scalp = mesh.positions.iter().zip(&mesh.normals).zip(&mesh.scalp).filter(|(_, s)| **s > 0.5);
    for ((p, n), _) in scalp {
        for (offset, sign) in [(0.01, 1.0), (-0.01, -1.0)] {
            let (d, normal) = distance.distance(*p + *n * offset);
            // A point is never farther from the surface than from its vertex, except for interpolation errors
            // of up to 0.5 mm where facets meet.
            assert!(d.abs() <= 0.01 + 5e-4, "{d}");
            askew += usize::from(d * sign < 0.005 || normal.dot(*n) < 0.7);
            count += 1;
        }
    }
    // Where ears are thinner than 2 cm the other side is closer.
    assert!(askew * 20 < count, "{askew} of {count}");
}
