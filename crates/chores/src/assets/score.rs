//! The choreography: key poses on beats. [`super::dance`] turns them into motion.
//!
//! Angles in degrees, lengths in metres; arms in lengths of the arm from the shoulder, as (out, up, front) in the
//! frame of the chest, the same numbers on either side.

use glam::Vec3;

/// Keys of one curve: beat and value.
pub(super) type Keys<const N: usize> = Vec<(f32, [f32; N])>;

/// A pose of one arm.
#[derive(Clone, Copy)]
pub(super) struct ArmPose {
    /// Position of the wrist.
    pub(super) wrist: [f32; 3],
    /// Direction of the elbow.
    pub(super) pole: [f32; 3],
    /// Direction of the palm.
    pub(super) palm: [f32; 3],
}

const fn arm(wrist: [f32; 3], pole: [f32; 3], palm: [f32; 3]) -> ArmPose {
    ArmPose { wrist, pole, palm }
}

/// Low and rounded before the hips.
const LOW: ArmPose = arm([0.16, -0.87, 0.30], [0.85, -0.10, -0.50], [-0.70, 0.10, -0.70]);
/// Hanging at the side.
const HANG: ArmPose = arm([0.24, -0.92, 0.10], [0.45, 0.0, -0.90], [-0.95, 0.00, -0.30]);
/// First position: rounded before the breast.
const FIRST: ArmPose = arm([-0.06, -0.30, 0.76], [0.95, -0.30, -0.10], [-0.70, 0.00, -0.70]);
/// Second position: open to the side.
const SECOND: ArmPose = arm([0.86, -0.06, 0.34], [0.25, -0.45, -0.90], [-0.30, -0.45, 0.85]);
/// Second position stretched and a little behind.
const WING: ArmPose = arm([0.90, 0.02, -0.06], [0.20, -0.60, -0.80], [-0.10, -0.90, 0.40]);
/// Fifth position: rounded overhead.
const FIFTH: ArmPose = arm([0.06, 0.88, 0.26], [0.95, 0.10, -0.15], [-0.55, -0.80, -0.20]);
/// A wide V above the head.
const HIGH: ArmPose = arm([0.52, 0.78, 0.10], [0.70, -0.20, -0.70], [-0.45, -0.25, 0.85]);
/// Swept behind the body.
const BEHIND: ArmPose = arm([0.52, -0.66, -0.38], [0.60, 0.10, -0.80], [-0.40, -0.30, -0.85]);
/// Let down to the floor out of a forward bend.
const GATHER: ArmPose = arm([0.02, -0.42, 0.84], [0.95, 0.10, -0.20], [-0.50, 0.30, -0.80]);
/// Open to the front and side.
const OPEN: ArmPose = arm([0.48, -0.20, 0.78], [0.70, -0.55, -0.30], [-0.60, -0.10, -0.60]);
/// Across the body to the other side.
const ACROSS: ArmPose = arm([-0.42, -0.24, 0.62], [0.80, -0.45, 0.20], [-0.60, 0.20, -0.75]);

/// A step of one foot to a new position. Between steps the ball of the foot does not move.
#[derive(Clone, Copy)]
pub(super) struct Step {
    /// Time when the foot leaves the ground, in beats.
    pub(super) lift: f32,
    /// Time when it is on the ground again, in beats.
    pub(super) land: f32,
    /// New position of the ball of the foot: x and z in metres.
    pub(super) to: [f32; 2],
    /// How high the foot rises.
    pub(super) height: f32,
    /// Position of the ball while the foot is held in the air, in the frame of the turning body relative to the point below the
    /// hips; `None` for a plain step.
    pub(super) held: Option<Vec3>,
}

/// A turn of the whole body.
#[derive(Clone, Copy)]
pub(super) struct Turn {
    /// First and last beat.
    pub(super) beats: [f32; 2],
    /// Full turns, positive to the left.
    pub(super) turns: f32,
}

/// The composition of a clip.
#[derive(Clone)]
pub(super) struct Score {
    /// Its name in the file.
    pub(super) name: &'static str,
    /// Its length in beats. The end leads into the beginning.
    pub(super) beats: f32,
    /// Duration of a beat.
    pub(super) beat_secs: f32,
    /// Hips: x, height above the rest pose, z.
    pub(super) hips: Keys<3>,
    /// Hips: forward, sideways toward the left, turn.
    pub(super) tilt: Keys<3>,
    /// Back from pelvis to ribs: forward, sideways toward the left, turn to the left.
    pub(super) back: Keys<3>,
    /// Neck and head together: forward, sideways toward the left, turn to the left.
    pub(super) head: Keys<3>,
    /// Left and right arm.
    pub(super) arms: [Vec<(f32, ArmPose)>; 2],
    /// How far the heels are raised, left and right, as an angle of the foot.
    pub(super) heels: Keys<2>,
    /// Positions of the balls of the feet at beat 0: x and z, left and right.
    pub(super) stance: [[f32; 2]; 2],
    /// How far the feet are turned out, beyond the rest pose.
    pub(super) turnout: f32,
    /// Steps of the left and of the right foot, in order.
    pub(super) steps: [Vec<Step>; 2],
    /// Turns of the body, in order.
    pub(super) turns: Vec<Turn>,
    /// Times at which the eyes blink, in beats.
    pub(super) blinks: Vec<f32>,
    /// Height of the balls of standing feet, metres.
    pub(super) ball_y: f32,
}

/// Standing and breathing, four seconds.
pub(super) fn idle() -> Score {
    let loose = ArmPose { wrist: [0.26, -0.915, 0.12], ..HANG };
    Score {
        name: "idle",
        beats: 4.0,
        beat_secs: 1.0,
        hips: vec![(0.0, [0.008, -0.020, 0.002]), (2.0, [-0.008, -0.020, -0.002])],
        tilt: vec![(0.0, [0.0, 0.6, 0.0]), (2.0, [0.0, -0.6, 0.0])],
        back: vec![
            (0.0, [0.0, -0.6, 1.0]),
            (1.2, [-2.0, 0.0, 0.0]),
            (2.0, [-0.6, 0.6, -1.0]),
            (3.2, [-2.0, 0.0, 0.0]),
        ],
        head: vec![
            (0.0, [0.0, 0.5, -1.5]),
            (1.4, [1.5, 0.0, 0.0]),
            (2.2, [0.5, -0.5, 1.5]),
            (3.4, [1.0, 0.0, 0.0]),
        ],
        arms: std::array::from_fn(|_| vec![(0.0, HANG), (1.2, loose), (2.0, HANG), (3.2, loose)]),
        heels: vec![(0.0, [0.0, 0.0])],
        stance: [[0.105, 0.080], [-0.105, 0.080]],
        turnout: 6.0,
        steps: [vec![], vec![]],
        turns: vec![],
        blinks: vec![1.3, 3.2],
        ball_y: 0.018,
    }
}

/// The dance: sixteen beats at 100 per minute, 9.6 seconds. It opens with a breath and a sway, turns once to the right
/// on the left leg, lands low, folds to the floor, throws the head back, and turns to the left into the beginning.
pub(super) fn dance() -> Score {
    let retire = Vec3::new(-0.020, 0.430, 0.105);
    let coupe = Vec3::new(0.035, 0.150, 0.020);
    Score {
        name: "dance",
        beats: 16.0,
        beat_secs: 0.6,
        hips: vec![
            (0.0, [0.000, -0.030, 0.000]),
            (1.1, [-0.065, -0.045, 0.000]),
            (2.3, [0.075, -0.028, 0.000]),
            (3.4, [0.060, -0.050, -0.020]),
            (4.3, [0.030, -0.160, -0.050]),
            (5.0, [0.098, 0.012, 0.030]),
            (6.2, [0.104, 0.020, 0.034]),
            (6.9, [0.070, -0.020, 0.020]),
            (7.6, [-0.090, -0.190, -0.010]),
            (8.5, [-0.085, -0.270, -0.060]),
            (9.0, [-0.090, -0.255, -0.050]),
            (9.7, [-0.085, -0.090, 0.020]),
            (10.3, [-0.060, -0.075, 0.030]),
            (11.1, [0.050, -0.075, 0.010]),
            (11.9, [0.010, -0.120, 0.010]),
            (12.7, [-0.096, 0.010, 0.028]),
            (13.8, [-0.100, 0.014, 0.030]),
            (14.6, [-0.040, -0.080, 0.015]),
            (15.2, [0.010, -0.060, 0.000]),
        ],
        tilt: vec![
            (0.0, [0.0, 0.0, 0.0]),
            (1.1, [0.0, -4.0, 6.0]),
            (2.3, [-2.0, 4.0, -8.0]),
            (3.6, [3.0, 0.0, -6.0]),
            (4.3, [8.0, 0.0, 14.0]),
            (5.2, [-2.0, -2.0, 0.0]),
            (6.4, [-2.0, -2.0, 0.0]),
            (7.6, [10.0, -6.0, -6.0]),
            (8.5, [34.0, -2.0, 0.0]),
            (8.95, [30.0, 0.0, 0.0]),
            (9.65, [-8.0, 0.0, 0.0]),
            (10.3, [-10.0, 2.0, 4.0]),
            (11.2, [0.0, 5.0, -8.0]),
            (11.9, [5.0, 0.0, -16.0]),
            (12.9, [-2.0, 2.0, 0.0]),
            (13.8, [-2.0, 2.0, 0.0]),
            (14.8, [4.0, 0.0, 6.0]),
        ],
        back: vec![
            (0.0, [2.0, 2.0, 0.0]),
            (1.1, [-4.0, -12.0, 10.0]),
            (2.4, [-10.0, 20.0, -10.0]),
            (3.5, [2.0, 4.0, -12.0]),
            (4.3, [6.0, 2.0, 26.0]),
            (5.1, [-4.0, 0.0, -8.0]),
            (6.3, [-6.0, 0.0, -4.0]),
            (7.5, [14.0, -16.0, -14.0]),
            (8.5, [52.0, -6.0, 0.0]),
            (9.0, [46.0, 0.0, 4.0]),
            (9.65, [-18.0, 2.0, 4.0]),
            (10.3, [-26.0, 4.0, 8.0]),
            (11.1, [-8.0, 24.0, -12.0]),
            (11.9, [4.0, 4.0, -28.0]),
            (12.8, [-6.0, -2.0, 8.0]),
            (13.9, [-6.0, -2.0, 4.0]),
            (14.8, [10.0, -4.0, 10.0]),
        ],
        head: vec![
            (0.0, [6.0, 4.0, 6.0]),
            (1.1, [4.0, -16.0, 18.0]),
            (2.4, [-12.0, 20.0, -22.0]),
            (3.3, [4.0, 8.0, -12.0]),
            (4.3, [8.0, 0.0, -24.0]),
            (5.0, [-4.0, 2.0, -18.0]),
            (5.7, [-6.0, -4.0, 10.0]),
            (6.6, [-6.0, 2.0, 22.0]),
            (7.6, [14.0, -22.0, -8.0]),
            (8.5, [30.0, -8.0, -6.0]),
            (9.05, [40.0, 4.0, 4.0]),
            (9.7, [-40.0, 2.0, 0.0]),
            (10.4, [-26.0, 12.0, 10.0]),
            (11.2, [6.0, 28.0, -8.0]),
            (11.9, [16.0, 0.0, 22.0]),
            (12.6, [-4.0, -4.0, 20.0]),
            (13.4, [-6.0, 4.0, -10.0]),
            (14.2, [-2.0, -2.0, -20.0]),
            (14.9, [16.0, -10.0, 4.0]),
        ],
        arms: [
            vec![
                (0.0, LOW),
                (1.0, FIRST),
                (2.3, SECOND),
                (3.3, WING),
                (4.3, SECOND),
                (5.1, FIRST),
                (6.0, FIFTH),
                (6.8, HIGH),
                (7.6, WING),
                (8.6, GATHER),
                (9.35, FIRST),
                (10.0, HIGH),
                (11.2, SECOND),
                (12.0, WING),
                (12.9, SECOND),
                (13.9, FIRST),
                (14.8, LOW),
            ],
            vec![
                (0.0, LOW),
                (1.0, FIRST),
                (2.3, FIFTH),
                (3.3, SECOND),
                (4.3, FIRST),
                (5.1, FIRST),
                (6.0, FIFTH),
                (6.8, SECOND),
                (7.6, BEHIND),
                (8.6, GATHER),
                (9.35, FIRST),
                (10.0, HIGH),
                (11.2, FIFTH),
                (11.9, ACROSS),
                (12.45, OPEN),
                (13.05, WING),
                (13.9, FIRST),
                (14.8, LOW),
            ],
        ],
        heels: vec![
            (0.0, [0.0, 0.0]),
            (3.6, [0.0, 0.0]),
            (3.9, [0.0, 12.0]),
            (4.4, [0.0, 16.0]),
            (5.0, [34.0, 40.0]),
            (6.3, [34.0, 40.0]),
            (7.1, [0.0, 20.0]),
            (7.5, [0.0, 0.0]),
            (9.0, [0.0, 0.0]),
            (11.0, [0.0, 6.0]),
            (11.9, [10.0, 0.0]),
            (12.8, [40.0, 32.0]),
            (13.8, [40.0, 32.0]),
            (14.5, [14.0, 0.0]),
            (14.9, [0.0, 0.0]),
        ],
        stance: [[0.110, 0.080], [-0.110, 0.080]],
        turnout: 14.0,
        steps: [
            vec![Step { lift: 12.25, land: 14.5, to: [0.110, 0.080], height: 0.0, held: Some(coupe) }],
            vec![
                Step { lift: 3.0, land: 3.8, to: [-0.085, -0.190], height: 0.04, held: None },
                Step { lift: 4.6, land: 7.2, to: [-0.300, 0.030], height: 0.0, held: Some(retire) },
                Step { lift: 10.7, land: 11.6, to: [-0.110, 0.080], height: 0.05, held: None },
            ],
        ],
        turns: vec![Turn { beats: [4.45, 7.05], turns: -1.0 }, Turn { beats: [12.05, 14.55], turns: 1.0 }],
        blinks: vec![1.9, 4.6, 8.7, 12.3, 15.3],
        ball_y: 0.018,
    }
}
