//! Factors on how single guides of a hairstyle move.

/// Factors on the settings of the simulation at each guide point. Each list has the layout of [`crate::Guides`], or is empty where all
/// factors are 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotionFactors {
    /// Factor on the bending stiffness, as an angular frequency.
    pub stiffness: Vec<f32>,
    /// Factor on the pull toward the style, as an angular frequency. Points that ties hold keep that of the tie.
    pub hold: Vec<f32>,
    /// Factor on the damping of bending and on the rate at which hair settles on the head.
    pub damping: Vec<f32>,
    /// Factor on the friction with the body.
    pub friction: Vec<f32>,
}

impl MotionFactors {
    /// The range of factors.
    pub const RANGE: [f32; 2] = [0.0, 64.0];

    /// Whether all factors are 1.
    pub fn is_empty(&self) -> bool {
        self.lists().iter().all(|(_, list)| list.is_empty())
    }

    /// The lists with their names.
    pub fn lists(&self) -> [(&'static str, &[f32]); 4] {
        [
            ("motion.stiffness", &self.stiffness),
            ("motion.hold", &self.hold),
            ("motion.damping", &self.damping),
            ("motion.friction", &self.friction),
        ]
    }

    /// The same lists, to be changed.
    pub fn lists_mut(&mut self) -> [&mut Vec<f32>; 4] {
        [&mut self.stiffness, &mut self.hold, &mut self.damping, &mut self.friction]
    }
}
