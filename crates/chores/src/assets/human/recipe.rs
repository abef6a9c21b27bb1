//! The figures: which targets of shape they mix, how tall they are, and their colours.

use glam::Vec3;

/// The description of one figure.
pub(super) struct Recipe {
    /// Name of the file.
    pub(super) name: &'static str,
    /// Shares of the African, Asian and Caucasian targets.
    pub(super) ancestry: [f32; 3],
    /// 0 is female, 1 male.
    pub(super) male: f32,
    /// 0 is young, 1 old.
    pub(super) old: f32,
    /// 0 is the least, 0.5 average, 1 the most.
    pub(super) muscle: f32,
    /// 0 is the least, 0.5 average, 1 the most.
    pub(super) weight: f32,
    /// How far the proportions are those that figures are drawn with, 0 to 1.
    pub(super) ideal: f32,
    /// Further targets with their weights; `*` stands for both sides, l and r.
    pub(super) details: &'static [(&'static str, f32)],
    /// From the soles to the crown, metres.
    pub(super) height: f32,
    /// Width and depth of the head as multiples of those that the targets give.
    pub(super) head: f32,
    /// The colours.
    pub(super) look: Look,
}

/// Colours, linear sRGB.
#[derive(Clone, Copy)]
pub(super) struct Look {
    /// The skin.
    pub(super) skin: Vec3,
    /// What blood adds to it: cheeks, nose, ears, knuckles.
    pub(super) blush: Vec3,
    /// The lips.
    pub(super) lips: Vec3,
    /// Palms, soles and nails.
    pub(super) pale: Vec3,
    /// How much the tone varies.
    pub(super) variation: f32,
    /// The iris, and its rim.
    pub(super) iris: [Vec3; 2],
    /// Top and leggings.
    pub(super) cloth: [Vec3; 2],
}

const fn rgb(r: f32, g: f32, b: f32) -> Vec3 {
    Vec3::new(r, g, b)
}

/// All figures, the dancer first.
pub(super) const FIGURES: [Recipe; 4] = [
    Recipe {
        name: "dancer",
        ancestry: [0.06, 0.20, 0.74],
        male: 0.0,
        old: 0.0,
        muscle: 0.58,
        weight: 0.40,
        ideal: 0.7,
        details: &[
            ("head/head-oval", 0.50),
            ("head/head-fat-decr", 0.35),
            ("cheek/*-cheek-bones-incr", 0.25),
            ("mouth/mouth-upperlip-volume-incr", 0.35),
            ("mouth/mouth-lowerlip-volume-incr", 0.30),
            ("mouth/mouth-angles-up", 0.25),
            ("nose/nose-scale-horiz-decr", 0.15),
            ("nose/nose-point-up", 0.20),
            ("eyes/*-eye-scale-incr", 0.20),
            ("chin/chin-width-decr", 0.25),
            ("breast/nipple-point-decr", 1.0),
            ("breast/breast-point-decr", 0.6),
        ],
        height: 1.70,
        head: 1.015,
        look: Look {
            skin: rgb(0.560, 0.345, 0.250),
            blush: rgb(0.560, 0.230, 0.180),
            lips: rgb(0.420, 0.150, 0.125),
            pale: rgb(0.600, 0.390, 0.300),
            variation: 1.0,
            iris: [rgb(0.110, 0.135, 0.095), rgb(0.020, 0.028, 0.024)],
            cloth: [rgb(0.052, 0.108, 0.118), rgb(0.040, 0.050, 0.064)],
        },
    },
    Recipe {
        name: "man",
        ancestry: [0.05, 0.10, 0.85],
        male: 1.0,
        old: 0.10,
        muscle: 0.66,
        weight: 0.45,
        ideal: 0.6,
        details: &[("head/head-rectangular", 0.25), ("chin/chin-width-incr", 0.15)],
        height: 1.80,
        head: 1.0,
        look: Look {
            skin: rgb(0.500, 0.300, 0.215),
            blush: rgb(0.500, 0.200, 0.150),
            lips: rgb(0.370, 0.160, 0.130),
            pale: rgb(0.560, 0.360, 0.275),
            variation: 1.3,
            iris: [rgb(0.100, 0.150, 0.190), rgb(0.022, 0.032, 0.044)],
            cloth: [rgb(0.090, 0.092, 0.098), rgb(0.032, 0.034, 0.040)],
        },
    },
    Recipe {
        name: "woman",
        ancestry: [0.95, 0.0, 0.05],
        male: 0.0,
        old: 0.0,
        muscle: 0.60,
        weight: 0.42,
        ideal: 0.7,
        details: &[
            ("cheek/*-cheek-bones-incr", 0.25),
            ("head/head-oval", 0.20),
            ("eyes/*-eye-scale-incr", 0.15),
            ("breast/nipple-point-decr", 1.0),
            ("breast/breast-point-decr", 0.6),
        ],
        height: 1.72,
        head: 1.03,
        look: Look {
            skin: rgb(0.150, 0.070, 0.042),
            blush: rgb(0.165, 0.058, 0.038),
            lips: rgb(0.150, 0.052, 0.045),
            pale: rgb(0.330, 0.180, 0.125),
            variation: 1.1,
            iris: [rgb(0.045, 0.022, 0.012), rgb(0.010, 0.006, 0.004)],
            cloth: [rgb(0.290, 0.150, 0.040), rgb(0.050, 0.035, 0.045)],
        },
    },
    Recipe {
        name: "elder",
        ancestry: [0.0, 0.35, 0.65],
        male: 0.0,
        old: 0.85,
        muscle: 0.46,
        weight: 0.46,
        ideal: 0.4,
        details: &[
            ("head/head-age-incr", 0.25),
            ("mouth/mouth-angles-up", 0.40),
            ("breast/nipple-point-decr", 1.0),
        ],
        height: 1.66,
        head: 1.03,
        look: Look {
            skin: rgb(0.530, 0.335, 0.245),
            blush: rgb(0.530, 0.225, 0.175),
            lips: rgb(0.390, 0.190, 0.165),
            pale: rgb(0.580, 0.390, 0.310),
            variation: 1.2,
            iris: [rgb(0.110, 0.140, 0.160), rgb(0.030, 0.036, 0.042)],
            cloth: [rgb(0.140, 0.060, 0.075), rgb(0.046, 0.046, 0.052)],
        },
    },
];
