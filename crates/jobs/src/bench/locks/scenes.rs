//! The measured hairstyles.

use std::fmt;
use std::str::FromStr;

use lovelock_groom::Preset;
use lovelock_project::Project;

/// A hairstyle whose locks are measured, in the shipped dance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LockScene {
    /// A shipped hairstyle, with its tie if it has one.
    Shipped(Preset),
    /// The long one, of another length in centimetres.
    Long(u32),
}

impl LockScene {
    /// All of them: the shipped ones, and lengths that the slider offers.
    pub const ALL: [Self; 11] = [
        Self::Shipped(Preset::Smooth),
        Self::Shipped(Preset::Curly),
        Self::Shipped(Preset::Long),
        Self::Shipped(Preset::Ponytail),
        Self::Shipped(Preset::Bun),
        Self::Long(10),
        Self::Long(20),
        Self::Long(40),
        Self::Long(60),
        Self::Long(80),
        Self::Long(90),
    ];

    /// The stable name for the command line and reports.
    pub fn id(self) -> String {
        match self {
            Self::Shipped(preset) => format!("locks-{}", preset.id()),
            Self::Long(cm) => format!("locks-{cm}cm"),
        }
    }

    /// The measured project.
    pub fn project(self) -> Project {
        let mut project = Project::default();
        match self {
            Self::Shipped(preset) => project.set_preset(preset),
            Self::Long(cm) => {
                project.set_preset(Preset::Long);
                project.hair.groom.length = cm as f32 / 100.0;
            }
        }
        project
    }
}

impl fmt::Display for LockScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.id())
    }
}

impl FromStr for LockScene {
    type Err = String;

    fn from_str(id: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|scene| scene.id() == id).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|scene| scene.id()).collect();
            format!("unknown scene `{id}`: must be one of {}", known.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_back_and_others_are_refused() {
        for scene in LockScene::ALL {
            assert_eq!(scene.id().parse(), Ok(scene));
        }
        assert!("locks-wig".parse::<LockScene>().unwrap_err().contains("locks-80cm"));
        assert_eq!(LockScene::Long(40).project().hair.groom.length, 0.4);
        assert!(!LockScene::Shipped(Preset::Ponytail).project().hair.ties.is_empty());
    }
}
