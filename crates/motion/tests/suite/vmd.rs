//! VMD files written by hand, with answers known on paper.

use encoding_rs::SHIFT_JIS;
use glam::{Affine3A, Quat, Vec3};
use lovelock_motion::{
    MotionError, MotionFile, MotionSettings, Pose, Skin, load_character, load_motion_bytes, pose_at,
    retarget, skin,
};
use lovelock_testkit::fuzz::damaged;

/// The straight curve that programs write.
const STRAIGHT: [u8; 4] = [20, 20, 107, 107];

/// A file that is being written.
#[derive(Default)]
struct Vmd {
    bones: Vec<u8>,
    keys: u32,
    switches: Vec<u8>,
    switch_frames: u32,
}

fn padded(name: &str, size: usize) -> Vec<u8> {
    let mut bytes = SHIFT_JIS.encode(name).0.into_owned();
    bytes.resize(size, 0);
    bytes
}

impl Vmd {
    /// A key in the axes of the format: left-handed, the figure looks along -Z.
    fn key(self, bone: &str, frame: u32, position: [f32; 3], rotation: Quat) -> Self {
        self.curved(bone, frame, position, rotation, [STRAIGHT; 4])
    }

    fn curved(
        mut self,
        bone: &str,
        frame: u32,
        position: [f32; 3],
        rotation: Quat,
        curves: [[u8; 4]; 4],
    ) -> Self {
        self.bones.extend(padded(bone, 15));
        self.bones.extend(frame.to_le_bytes());
        self.bones.extend(position.into_iter().chain(rotation.to_array()).flat_map(f32::to_le_bytes));
        let row: Vec<u8> = (0..16).map(|k| curves[k % 4][k / 4]).collect();
        for shift in 0..4 {
            let mut shifted = row[shift..].to_vec();
            shifted.resize(16, u8::from(shift > 0));
            self.bones.extend(shifted);
        }
        self.keys += 1;
        self
    }

    fn switch(mut self, frame: u32, bone: &str, on: bool) -> Self {
        self.switches.extend(frame.to_le_bytes());
        self.switches.push(1);
        self.switches.extend(1_u32.to_le_bytes());
        self.switches.extend(padded(bone, 20));
        self.switches.push(u8::from(on));
        self.switch_frames += 1;
        self
    }

    fn bytes(&self) -> Vec<u8> {
        let mut bytes = b"Vocaloid Motion Data 0002".to_vec();
        bytes.resize(30, 0);
        bytes.extend(padded("初音ミク", 20));
        bytes.extend(self.keys.to_le_bytes());
        bytes.extend(&self.bones);
        // One key of a face; no camera, light or shadow.
        bytes.extend(1_u32.to_le_bytes());
        bytes.extend(padded("まばたき", 15));
        bytes.extend(5_u32.to_le_bytes());
        bytes.extend(0.75_f32.to_le_bytes());
        bytes.extend([0; 12]);
        bytes.extend(self.switch_frames.to_le_bytes());
        bytes.extend(&self.switches);
        bytes
    }

    fn load(&self) -> MotionFile {
        load(&self.bytes()).unwrap_or_else(|error| panic!("{error}"))
    }
}

fn load(bytes: &[u8]) -> Result<MotionFile, MotionError> {
    load_motion_bytes("dance.vmd", bytes, MotionSettings::default())
}

/// Place of a joint in a frame, in units of the format, right-handed.
fn at(motion: &MotionFile, frame: usize, name: &str) -> Vec3 {
    let mut world: Vec<Affine3A> = Vec::new();
    motion.world(frame, &mut world);
    let joint = motion.joints.iter().position(|joint| joint.name == name).expect(name);
    Vec3::from(world[joint].translation) / 0.08
}

fn is_at(motion: &MotionFile, frame: usize, name: &str, wanted: [f32; 3]) {
    let found = at(motion, frame, name);
    assert!(found.distance(Vec3::from(wanted)) < 2e-3, "{name} at frame {frame}: {found} for {wanted:?}");
}

#[test]
fn a_lifted_foot_bends_the_leg_to_an_equilateral_triangle() {
    // Thigh and shin are 4.9 long. With the ankle 4.9 below the hip the triangle is equilateral, its knee in front.
    let motion = Vmd::default()
        .key("左足ＩＫ", 0, [0.0; 3], Quat::IDENTITY)
        .key("左足ＩＫ", 10, [0.0, 4.9, 0.0], Quat::IDENTITY)
        .key("右足ＩＫ", 0, [0.0; 3], Quat::IDENTITY)
        .load();
    assert_eq!((motion.frames, motion.info().format.as_str()), (11, "VMD"));
    is_at(&motion, 0, "LeftFoot", [0.95, 1.2, 0.0]);
    is_at(&motion, 10, "LeftFoot", [0.95, 6.1, 0.0]);
    is_at(&motion, 10, "LeftLeg", [0.95, 11.0 - 2.45, 4.9 * 0.75_f32.sqrt()]);
    is_at(&motion, 10, "LeftToeBase", [0.95, 5.1, 1.3]);
    // The straight curve is at its half in the middle.
    is_at(&motion, 5, "LeftFoot", [0.95, 3.65, 0.0]);
    // The control: the other leg stands.
    is_at(&motion, 10, "RightLeg", [-0.95, 6.1, 0.0]);
    assert_eq!((motion.faces[0].name.as_str(), motion.faces[0].track.at(0.2)), ("まばたき", 0.75));
    assert!((1.5..1.7).contains(&motion.info().height_m));
}

#[test]
fn feet_stay_while_the_body_sinks_and_targets_move_with_their_parent() {
    let motion = Vmd::default()
        .key("センター", 0, [0.0; 3], Quat::IDENTITY)
        .key("センター", 8, [0.0, -4.9, 0.0], Quat::IDENTITY)
        .key("左足ＩＫ", 0, [0.0; 3], Quat::IDENTITY)
        .key("右足ＩＫ", 0, [0.0; 3], Quat::IDENTITY)
        .load();
    for name in ["LeftFoot", "RightFoot"] {
        let side = if name == "LeftFoot" { 0.95 } else { -0.95 };
        is_at(&motion, 8, name, [side, 1.2, 0.0]);
    }
    is_at(&motion, 8, "LeftLeg", [0.95, 1.2 + 2.45, 4.9 * 0.75_f32.sqrt()]);
    // Forward is -Z in the file and +Z here; the parent of all carries body and targets.
    let motion = Vmd::default()
        .key("全ての親", 0, [1.0, 0.0, -2.0], Quat::IDENTITY)
        .key("左足ＩＫ", 0, [0.0, 0.5, -0.5], Quat::IDENTITY)
        .key("左足IK親", 0, [0.0, 0.0, -0.5], Quat::IDENTITY)
        .load();
    is_at(&motion, 0, "Head", [1.0, 17.3, 2.0]);
    is_at(&motion, 0, "LeftFoot", [1.95, 1.7, 3.0]);
}

#[test]
fn toes_follow_their_target_and_rotations_are_mirrored() {
    // The foot's target turns by 90 degrees about Y. Left-handed, a positive angle is one to the figure's left... seen from
    // above, clockwise: the toe points to -X.
    let quarter = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let motion = Vmd::default().key("左足ＩＫ", 0, [0.0; 3], quarter).load();
    is_at(&motion, 0, "LeftToeBase", [0.95 - 1.3, 0.2, 0.0]);
    let motion = Vmd::default().key("左つま先ＩＫ", 0, [0.0, 1.0, 0.0], Quat::IDENTITY).load();
    // The toe is lifted by one toward (1.3 ahead, level with the ankle).
    let toe = at(&motion, 0, "LeftToeBase") - at(&motion, 0, "LeftFoot");
    assert!(toe.normalize_or_zero().distance(Vec3::Z) < 1e-3, "{toe}");
    // Bones without targets: a head turned by 90 degrees about X, in the file toward -Y.
    let motion = Vmd::default()
        .key("首", 0, [0.0; 3], Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2))
        .key("左足", 0, [0.0; 3], Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2))
        .load();
    is_at(&motion, 0, "Head", [0.0, 16.5, 0.8]);
    // Without targets the legs turn as their keys say.
    is_at(&motion, 0, "LeftFoot", [0.95, 11.0, -9.8]);
}

#[test]
fn switches_and_curves_apply_from_their_frame_on() {
    let motion = Vmd::default()
        .key("左足ＩＫ", 0, [0.0, 4.9, 0.0], Quat::IDENTITY)
        .key("左足ＩＫ", 20, [0.0, 4.9, 0.0], Quat::IDENTITY)
        .switch(0, "左足ＩＫ", true)
        .switch(10, "左足ＩＫ", false)
        .load();
    is_at(&motion, 9, "LeftFoot", [0.95, 6.1, 0.0]);
    is_at(&motion, 10, "LeftFoot", [0.95, 1.2, 0.0]);
    // The later key holds the curve to it: x quick at first, y slow at first, z straight.
    let (quick, slow) = ([0, 127, 0, 127], [127, 0, 127, 0]);
    let motion = Vmd::default()
        .key("センター", 0, [0.0; 3], Quat::IDENTITY)
        .curved("センター", 16, [1.0, 1.0, 1.0], Quat::IDENTITY, [quick, slow, STRAIGHT, STRAIGHT])
        .load();
    let moved = at(&motion, 2, "Center") - Vec3::new(0.0, 8.0, 0.0);
    // Quick: x(t) = t^3 = 1/8 at t = 1/2, where y = 3/8 + 3/8 + 1/8. Slow is its mirror image.
    assert!((moved.x - 0.875).abs() < 1e-3, "{moved}");
    assert!(moved.y < 0.01 && (moved.z + 0.125).abs() < 1e-3, "{moved}");
}

#[test]
fn a_dance_begins_with_its_first_key() {
    let from = |first: u32| {
        let vmd = Vmd::default().key("センター", first, [0.0; 3], Quat::IDENTITY);
        vmd.key("センター", first + 30, [3.0, 0.0, 0.0], Quat::IDENTITY).load()
    };
    let (early, late) = (from(0), from(150));
    assert_eq!((late.frames, &late.positions), (31, &early.positions));
    let info = late.info();
    assert!((info.start_secs - 5.0).abs() < 1e-9 && (info.end_secs - 6.0).abs() < 1e-9);
}

#[test]
fn a_dance_stands_on_the_floor_of_the_dancer() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb");
    if !path.is_file() {
        println!("skipped: no assets/dancer.glb");
        return;
    }
    let body = load_character(&path).expect("the dancer").body;
    let mut vmd = Vmd::default();
    for beat in 0..8_u32 {
        let side = if beat % 2 == 0 { 1.0 } else { -1.0 };
        let sway = Quat::from_rotation_z(0.15 * side) * Quat::from_rotation_y(0.3 * side);
        vmd = vmd
            .key("センター", 10 * beat, [0.6 * side, -1.0 - side, 0.0], Quat::IDENTITY)
            .key("上半身", 10 * beat, [0.0; 3], sway)
            .key("頭", 10 * beat, [0.0; 3], sway.inverse())
            .key("左腕", 10 * beat, [0.0; 3], Quat::from_rotation_z(0.5 * side))
            .key("左足ＩＫ", 10 * beat, [0.0, 0.6 * (1.0 + side), 0.0], Quat::IDENTITY)
            .key("右足ＩＫ", 10 * beat, [0.0; 3], Quat::IDENTITY);
    }
    let motion = vmd.load();
    let clip = retarget(&motion, &body).expect("a clip");
    let (mut pose, mut surface) = (Pose::default(), Skin::default());
    let hips = body.skeleton.joints.iter().position(|joint| joint.name == "hips").expect("hips");
    for frame in 0..motion.frames - 1 {
        pose_at(&body, Some(&clip), frame as f64 / 30.0, &mut pose);
        skin(&body, &pose, &mut surface);
        let lowest = surface.positions.iter().map(|p| p.y).fold(f32::MAX, f32::min);
        assert!(lowest.abs() < 0.03, "frame {frame}: {lowest} m");
        let up = pose.world_from_joint[body.head_joint].translation - pose.world_from_joint[hips].translation;
        assert!(up.y > 0.4, "frame {frame}: the head is {} m above the hips", up.y);
    }
}

#[test]
fn files_without_a_dance_are_refused_in_a_sentence() {
    let sound = Vmd::default().key("頭", 3, [0.0; 3], Quat::IDENTITY).bytes();
    for (bytes, found) in [
        (Vmd::default().bytes(), "contains only keys of a camera, a face, or 0 other bones"),
        (Vmd::default().key("スカート", 0, [0.0; 3], Quat::IDENTITY).bytes(), "1 other bones"),
        (sound[..60].to_vec(), "byte 50: 1 keys of bones of 111 bytes in 6 bytes"),
        (sound[..20].to_vec(), "byte 0: 20 bytes left"),
        (
            Vmd::default()
                .key("頭", 7, [0.0; 3], Quat::IDENTITY)
                .key("頭", 4_000_000_000, [0.0; 3], Quat::IDENTITY)
                .bytes(),
            "frame 4000000000",
        ),
    ] {
        let error = load(&bytes).expect_err(found).to_string();
        assert!(
            error.starts_with("dance.vmd: ") && error.contains(found) && !error.contains('\n'),
            "{error}"
        );
    }
    // A file that ends after a list is sound.
    assert!(load(&sound[..50 + 4 + 111]).is_ok());
    // A key of no number is dropped, and of two keys at a frame the last counts.
    let motion = Vmd::default()
        .key("頭", 0, [f32::NAN, 0.0, 0.0], Quat::IDENTITY)
        .key("センター", 0, [1.0, 0.0, 0.0], Quat::IDENTITY)
        .key("センター", 0, [2.0, 0.0, 0.0], Quat::from_xyzw(0.0, 0.0, 0.0, 0.0))
        .load();
    assert_eq!(motion.dropped["keys_of_no_number"], 1);
    is_at(&motion, 0, "Center", [2.0, 8.0, 0.0]);
}

#[test]
fn damaged_motion_vmd() {
    let files = [
        Vmd::default()
            .key("左足ＩＫ", 4, [0.0, 2.0, 0.0], Quat::from_rotation_y(1.0))
            .key("左腕捩", 2, [0.0; 3], Quat::from_rotation_x(1.0))
            .switch(3, "左足ＩＫ", false)
            .bytes(),
        Vmd::default()
            .key("センター", 9, [0.0, 2.0, 0.0], Quat::IDENTITY)
            .key("首", 3, [0.0; 3], Quat::IDENTITY)
            .bytes(),
    ];
    damaged("vmd", &files, 3000, |bytes| {
        let Ok(motion) = load(bytes) else { return false };
        let count = motion.joints.len() * motion.frames;
        assert!(motion.rotations.len() == count && motion.positions.len() == count);
        assert!(
            motion.rotations.iter().all(|q| q.is_finite()) && motion.positions.iter().all(|p| p.is_finite())
        );
        true
    });
}
