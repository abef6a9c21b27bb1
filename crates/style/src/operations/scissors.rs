//! What was cut off with scissors while hair moved.

use glam::Vec3;
use lovelock_base::settings::{Setting, Settings};
use lovelock_groom::{Haircut, Hairstyle, trimmed};

use crate::Scope;
use crate::operate::{Kind, Operate, Subject};

/// A cut by the shape of a blade at one instant: the part that remains of each guide.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scissors {
    /// The part that remains.
    pub cut: Haircut,
}

impl Settings for Scissors {
    const TABLE: &'static [Setting<Self>] = &[];

    fn reconcile(&mut self) {
        self.cut = self.cut.clamped();
    }
}

impl Operate for Scissors {
    const KIND: Kind = Kind {
        id: "scissors",
        label: "Scissors",
        text: "Cuts made with the scissors in the image.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let strengths = scope.guides(style);
        let mut cut = self.cut.clone();
        for (kept, strength) in cut.kept.iter_mut().zip(strengths) {
            if strength != 1.0 {
                *kept = (1.0 + (*kept - 1.0) * strength).clamp(0.0, 1.0);
            }
        }
        *style = trimmed(style, &cut);
    }

    fn fits(&self, style: &Hairstyle) -> bool {
        self.cut.is_empty() || self.cut.fits(&style.guides)
    }

    fn lists(&self) -> Vec<(&'static str, Vec<f32>)> {
        vec![("first_root", self.cut.first_root.to_array().to_vec()), ("kept", self.cut.kept.clone())]
    }

    fn set_list(&mut self, name: &str, numbers: Vec<f32>) {
        match (name, numbers.as_slice()) {
            ("first_root", &[x, y, z]) => self.cut.first_root = Vec3::new(x, y, z),
            ("kept", _) => self.cut.kept = numbers,
            _ => {}
        }
    }
}
