//! A test figure: a column of trunk, neck and head that four joints bend, with its field and its colliders.
//! It is quick to build and covers everything that a body can do to hair: skin of a single joint, skin
//! between joints, and a shoulder that is raised until the skin folds over itself.

use std::sync::{Arc, LazyLock};

use glam::{Affine3A, Quat, Vec3};
use lovelock_groom::{Obstacle, Scalp};
use lovelock_motion::{
    Body, BodyField, Collider, Joint, Mesh, Pose, RestDistance, Skeleton, fit_colliders, head_mesh,
};

/// Height and half widths from side to side and from front to back, metres, from below.
const OUTLINE: [[f32; 3]; 14] = [
    [0.0, 0.0, 0.0],
    [0.02, 0.15, 0.10],
    [0.70, 0.15, 0.10],
    [1.10, 0.16, 0.10],
    [1.28, 0.20, 0.10],
    [1.33, 0.17, 0.09],
    [1.36, 0.09, 0.07],
    [1.40, 0.055, 0.055],
    [1.46, 0.055, 0.060],
    [1.52, 0.072, 0.085],
    [1.60, 0.080, 0.100],
    [1.66, 0.066, 0.082],
    [1.70, 0.035, 0.042],
    [1.715, 0.0, 0.0],
];
/// Rows of vertices between two heights, and vertices around.
const ROWS: usize = 3;
const AROUND: usize = 24;
/// Joints: chest, neck, head and one shoulder, relative to their parents.
const PLACES: [(Option<usize>, Vec3); 4] = [
    (None, Vec3::new(0.0, 1.2, 0.0)),
    (Some(0), Vec3::new(0.0, 0.18, 0.0)),
    (Some(1), Vec3::new(0.0, 0.09, 0.0)),
    (Some(0), Vec3::new(0.07, 0.08, 0.0)),
];
const HEAD: usize = 2;

/// The figure and everything derived from it once.
pub struct Figure {
    pub body: Body,
    pub field: Arc<BodyField>,
    pub colliders: Vec<Collider>,
    pub scalp: Scalp,
    rest: RestDistance,
}

/// Rotations of its joints.
#[derive(Clone, Copy, Debug)]
pub struct Bends {
    pub neck: Quat,
    pub nod: Quat,
    pub shoulder: Quat,
}

impl Default for Bends {
    fn default() -> Self {
        Self { neck: Quat::IDENTITY, nod: Quat::IDENTITY, shoulder: Quat::IDENTITY }
    }
}

pub static FIGURE: LazyLock<Figure> = LazyLock::new(Figure::new);

impl Figure {
    fn new() -> Self {
        let joint = |(n, (parent, translation)): (usize, &(Option<usize>, Vec3))| Joint {
            name: ["chest", "neck", "head", "shoulder"][n].into(),
            parent: *parent,
            translation: *translation,
            rotation: Quat::IDENTITY,
            scale: Vec3::ONE,
        };
        let joints = PLACES.iter().enumerate().map(joint).collect();
        let mut skeleton = Skeleton { joints, ..Skeleton::default() };
        skeleton.update_rest();
        let body =
            Body { name: "figure".into(), skeleton, mesh: mesh(), head_joint: HEAD, ..Body::default() };
        let rest = RestDistance::new(&body);
        let field = Arc::new(BodyField::new(&body, &rest).expect("a figure has a field"));
        let head = head_mesh(&body);
        let scalp = Scalp {
            positions: head.positions,
            normals: head.normals,
            triangles: head.triangles,
            mask: head.scalp,
        };
        Self { colliders: fit_colliders(&body), body, field, scalp, rest }
    }

    /// The figure with its head at the given transform and its joints bent.
    pub fn pose(world_from_head: Affine3A, bends: &Bends, pose: &mut Pose) {
        let local = |joint: usize, turn: Quat| Affine3A::from_rotation_translation(turn, PLACES[joint].1);
        let neck = world_from_head * local(HEAD, bends.nod).inverse();
        let chest = neck * local(1, bends.neck).inverse();
        pose.world_from_joint.clear();
        pose.world_from_joint.extend([chest, neck, world_from_head, chest * local(3, bends.shoulder)]);
        pose.world_from_head = world_from_head;
    }
}

impl Obstacle for Figure {
    fn distance(&self, p: Vec3) -> (f32, Vec3) {
        self.rest.distance(p)
    }
}

fn mesh() -> Mesh {
    let mut mesh = Mesh::default();
    let rows = (OUTLINE.len() - 1) * ROWS;
    for row in 0..=rows {
        let (part, t) = (row / ROWS, (row % ROWS) as f32 / ROWS as f32);
        let (a, b) = (OUTLINE[part], OUTLINE[(part + 1).min(OUTLINE.len() - 1)]);
        let [y, across, deep] = std::array::from_fn(|k| a[k] + t * (b[k] - a[k]));
        for i in 0..AROUND {
            let (sin, cos) = (std::f32::consts::TAU * i as f32 / AROUND as f32).sin_cos();
            let p = Vec3::new(across * cos, y, deep * sin);
            mesh.positions.push(p);
            let middle = Vec3::Y * y.clamp(0.1, 1.58);
            mesh.normals.push((p - middle).normalize_or(Vec3::Y));
            mesh.colors.push(Vec3::ONE);
            mesh.scalp.push(f32::from(u8::from(y > 1.6 || (y > 1.5 && p.z < 0.02))));
            let ramp = |from: f32, to: f32, at: f32| ((at - from) / (to - from)).clamp(0.0, 1.0);
            let head = ramp(1.43, 1.50, y);
            let neck = ramp(1.34, 1.41, y) * (1.0 - head);
            let trunk = 1.0 - head - neck;
            let arm = trunk * ramp(0.05, 0.14, p.x) * ramp(0.9, 1.1, y);
            let mut all = [(trunk - arm, 0), (neck, 1), (head, HEAD as u16), (arm, 3)];
            all.sort_by(|a, b| b.0.total_cmp(&a.0));
            mesh.joints.push(std::array::from_fn(|k| all.get(k).map_or(0, |w| w.1)));
            mesh.weights.push(std::array::from_fn(|k| all.get(k).map_or(0.0, |w| w.0)));
        }
    }
    let around = AROUND as u32;
    for row in 0..rows as u32 {
        for i in 0..around {
            let (next, a, b) = ((i + 1) % around, row * around, (row + 1) * around);
            mesh.triangles.push([a + i, b + i, a + next]);
            mesh.triangles.push([a + next, b + i, b + next]);
        }
    }
    mesh
}
