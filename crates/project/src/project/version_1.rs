//! Project files of version 1, which stored the extinction scale of the hair in the section `shadow`.

use serde::Deserialize;

use super::Project;

/// The track of the extinction scale in version 1.
const OLD_TARGET: &str = "shadow/extinction_scale";
/// The same track now.
const NEW_TARGET: &str = "look/extinction_scale";

/// The values of version 1 that have another place now.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Version1 {
    shadow: Shadow,
}

#[derive(Debug, Deserialize)]
#[serde(default)]
struct Shadow {
    extinction_scale: f32,
}

impl Default for Shadow {
    fn default() -> Self {
        Self { extinction_scale: 0.15 }
    }
}

impl Version1 {
    /// Writes the values to their places in `project`, which was read from the same text, and renames tracks.
    pub(super) fn migrate(self, project: &mut Project) {
        project.look.extinction_scale = self.shadow.extinction_scale;
        for track in &mut project.timeline.tracks {
            if track.target == OLD_TARGET {
                NEW_TARGET.clone_into(&mut track.target);
            }
        }
    }

    /// Whether version 1 has a field that is not unknown although projects do not store it any more. Panes stored the extinction
    /// scale too, but used that of the project.
    pub(super) fn knows(field: &str) -> bool {
        field == "shadow.extinction_scale"
            || field
                .strip_prefix("compare.panes[")
                .is_some_and(|pane| pane.ends_with("].shadow.extinction_scale"))
    }
}
