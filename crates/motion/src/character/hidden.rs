//! Meshes that a file hides.

use lovelock_base::words::counted;

use crate::BodySettings;

/// Counts the meshes of a file that are hidden, and decides whether they are read.
#[derive(Default)]
pub(crate) struct HiddenMeshes {
    include: bool,
    invisible: usize,
    stand_ins: usize,
    prototypes: usize,
}

/// Why a mesh is not drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Hidden {
    /// It or something above it is invisible.
    Invisible,
    /// It is a guide, a proxy or a coarser level, which stands for another mesh.
    StandIn,
    /// It is a prototype, of which copies are drawn in other places.
    Prototype,
}

impl HiddenMeshes {
    pub(crate) fn new(settings: BodySettings) -> Self {
        Self { include: settings.include_hidden, ..Self::default() }
    }

    /// Whether a mesh is read that is hidden for a reason, if there is one.
    pub(crate) fn reads(&mut self, why: Option<Hidden>) -> bool {
        match why {
            None => return true,
            Some(Hidden::Invisible) => self.invisible += 1,
            Some(Hidden::StandIn) => self.stand_ins += 1,
            Some(Hidden::Prototype) => self.prototypes += 1,
        }
        self.include
    }

    /// How many there are, if there are any.
    fn counts(&self) -> Option<String> {
        let mut parts = Vec::new();
        if self.stand_ins > 0 {
            parts.push(counted(self.stand_ins, "guide or proxy mesh", "guide and proxy meshes"));
        }
        if self.prototypes > 0 {
            parts.push(counted(self.prototypes, "mesh of a prototype", "meshes of prototypes"));
        }
        if self.invisible > 0 {
            parts.push(counted(self.invisible, "hidden mesh", "hidden meshes"));
        }
        Some(parts.join(" and ")).filter(|counts| !counts.is_empty())
    }

    /// Adds what was done to the remarks.
    pub(crate) fn note(&self, notes: &mut Vec<String>) {
        if let Some(counts) = self.counts() {
            notes.push(if self.include {
                format!("includes {counts} of the file")
            } else {
                let all = self.invisible + self.stand_ins + self.prototypes;
                let them = if all == 1 { "it" } else { "them" };
                format!("left out {counts}; the setting *Include hidden* includes {them}")
            });
        }
    }

    /// What an error about a file without a body adds.
    pub(crate) fn in_error(&self) -> String {
        let counts = self.counts().filter(|_| !self.include);
        let hint = "which the setting *Include hidden* includes";
        counts.map_or_else(String::new, |counts| format!(" besides {counts}, {hint}"))
    }
}
