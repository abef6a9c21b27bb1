//! Settings of clusters.

use lovelock_base::field;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};
use serde::{Deserialize, Serialize};

use crate::lighting::ClusterLighting;
use crate::ribs::RibGrid;
use crate::shadow::LocalShadow;

/// Length of hair shell volumes that follows waves and curls, metres.
const VOLUME_LENGTH: f32 = 0.014;

/// How the light on a layer is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClusterShading {
    /// As that of strands, so that clusters and strands can be mixed; records add what varies across a lock.
    #[default]
    AsStrands,
    /// Diffuse light and two shifted highlights times the recorded reflectance (Xu et al., equations 8 to 11 and 13).
    Paper,
}

impl Choices for ClusterShading {
    const ALL: &'static [Self] = &[Self::AsStrands, Self::Paper];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::AsStrands => ("as-strands", "As strands"),
            Self::Paper => ("paper", "As published"),
        }
    }
}

/// How records are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RecordLookup {
    /// Between angles, texels and densities.
    #[default]
    Interpolated,
    /// The nearest record, as published.
    Nearest,
}

impl Choices for RecordLookup {
    const ALL: &'static [Self] = &[Self::Interpolated, Self::Nearest];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Interpolated => ("interpolated", "Interpolated"),
            Self::Nearest => ("nearest", "Nearest"),
        }
    }
}

/// What an image of clusters shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClusterView {
    /// Hair.
    #[default]
    Hair,
    /// The record that each hair shell volume uses, as a colour.
    Records,
}

impl Choices for ClusterView {
    const ALL: &'static [Self] = &[Self::Hair, Self::Records];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Hair => ("hair", "Hair"),
            Self::Records => ("records", "Records"),
        }
    }
}

/// Settings of hair that is drawn as clusters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ClusterSettings {
    /// Layers from the core outward.
    pub layers: u32,
    /// Radius of the empty core, as a fraction of the section.
    pub core: f32,
    /// Hair shell volumes around a cluster, at most.
    pub around: u32,
    /// Hair shell volumes along a cluster, at most.
    pub along: u32,
    /// How unlike clusters may be that share parameters.
    pub macro_tolerance: f32,
    /// Whether records are chosen by curls too. Off, all sectors look as if their strands were straight.
    pub curls: bool,
    /// How records are read.
    pub lookup: RecordLookup,
    /// How the light on a layer is computed.
    pub shading: ClusterShading,
    /// How a cluster shadows itself.
    pub local_shadow: LocalShadow,
    /// Strength of the shadow of layers on each other; 1 is that of their opacity.
    pub shadow_strength: f32,
    /// How strongly recorded reflectance varies the light of strands.
    pub detail: f32,
    /// Coefficient of diffuse light.
    pub diffuse: f32,
    /// Coefficient of the primary highlight.
    pub primary: f32,
    /// Coefficient of the secondary highlight.
    pub secondary: f32,
    /// What the image shows.
    pub view: ClusterView,
}

impl Default for ClusterSettings {
    fn default() -> Self {
        Self {
            layers: 4,
            core: 0.35,
            around: 12,
            along: 32,
            macro_tolerance: 0.0,
            curls: true,
            lookup: RecordLookup::default(),
            shading: ClusterShading::default(),
            local_shadow: LocalShadow::default(),
            shadow_strength: 1.0,
            detail: 1.0,
            diffuse: 0.35,
            primary: 0.25,
            secondary: 0.35,
            view: ClusterView::default(),
        }
    }
}

impl Settings for ClusterSettings {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::count(
            field!(Self, layers),
            [1, 15],
            "Layers",
            "Layers of each lock from its core outward. More layers let light through more evenly and take longer.",
        ),
        Setting::number(
            field!(Self, core),
            [0.0, 0.9],
            "Core",
            "Radius of the empty core of a lock, as a fraction of its section.",
        )
        .unit(Unit::FRACTION),
        Setting::count(
            field!(Self, around),
            [4, 32],
            "Volumes around",
            "Hair shell volumes around a lock. Hairstyles of many locks have fewer.",
        ),
        Setting::count(
            field!(Self, along),
            [2, 64],
            "Volumes along",
            "Hair shell volumes from root to tip, at most. Short hair and hairstyles of many locks have fewer.",
        ),
        Setting::number(
            field!(Self, macro_tolerance),
            [0.0, 1.0],
            "Sharing",
            "How much locks that share one set of parameters may differ. At 0 only equal locks share.",
        ),
        Setting::switch(
            field!(Self, curls),
            "Curl records",
            "Makes curled locks smoother, with records of loose and tight curls. Off, all locks use records of straight hair.",
        ),
        Setting::choice::<RecordLookup>(
            field!(Self, lookup),
            "Look-up",
            "How records of the database are read: between neighbouring ones, or the nearest as published.",
        ),
        Setting::choice::<ClusterShading>(
            field!(Self, shading),
            "Shading",
            "How light on a layer is computed: as on strands, or by the published diffuse light and two shifted highlights.",
        ),
        Setting::choice::<LocalShadow>(
            field!(Self, local_shadow),
            "Own shadow",
            "How a lock shadows itself: by the shadow map like strands, or by its layers: the product of what they let through, \
             the published exponential of their sum, or its linear approximation.",
        ),
        Setting::number(
            field!(Self, shadow_strength),
            [0.0, 4.0],
            "Own shadow strength",
            "Strength of the shadow of layers on the layers below.",
        ),
        Setting::number(
            field!(Self, detail),
            [0.0, 2.0],
            "Detail",
            "How strongly single strands stand out when locks are lit as strands.",
        ),
        Setting::number(
            field!(Self, diffuse),
            [0.0, 2.0],
            "Diffuse light",
            "Strength of diffuse light in the published lighting.",
        ),
        Setting::number(
            field!(Self, primary),
            [0.0, 2.0],
            "Primary highlight",
            "Strength of the highlight in the light's colour in the published lighting.",
        ),
        Setting::number(
            field!(Self, secondary),
            [0.0, 2.0],
            "Secondary highlight",
            "Strength of the highlight in the hair's colour in the published lighting.",
        ),
        Setting::choice::<ClusterView>(
            field!(Self, view),
            "Show",
            "Shows hair, or a colour for the record that each hair shell volume uses.",
        ),
    ];
}

impl ClusterSettings {
    /// The published light with these strengths.
    pub fn lighting(&self) -> ClusterLighting {
        let Self { diffuse, primary, secondary, .. } = *self;
        ClusterLighting { diffuse, primary, secondary, ..ClusterLighting::default() }
    }

    /// The settings on which the clusters of a hairstyle depend; the others as by default.
    #[must_use]
    pub fn of_shape(&self) -> Self {
        let Self { layers, core, around, along, macro_tolerance, curls, .. } = *self;
        Self { layers, core, around, along, macro_tolerance, curls, ..Self::default() }
    }

    /// How each of `clusters` clusters is divided so that there are at most `most` hair shell volumes. Hair of this mean `length`, metres,
    /// has no shorter ones than it needs.
    pub fn grid(&self, clusters: usize, length: f32, most: usize) -> RibGrid {
        let mut grid = RibGrid {
            layers: self.layers.clamp(1, 15) as usize,
            around: self.around.clamp(4, 32) as usize,
            along: (self.along.clamp(2, 64) as usize).min((length / VOLUME_LENGTH).max(8.0) as usize).max(2),
        };
        let fits = |grid: RibGrid| grid.volumes().saturating_mul(clusters) <= most;
        while !fits(grid) {
            // Whatever is finest becomes coarser.
            let choices = [(grid.around, 6), (grid.along, 6), (2 * grid.layers, 4)];
            let (finest, _) = choices
                .into_iter()
                .enumerate()
                .filter(|(_, (now, least))| now > least)
                .max_by_key(|(_, (now, least))| now * 100 / least)
                .unwrap_or((3, (0, 0)));
            match finest {
                0 => grid.around -= 2,
                1 => grid.along -= 2,
                2 => grid.layers -= 1,
                _ => break,
            }
        }
        grid
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_clusters_are_divided_as_asked_and_many_stay_within_the_limit() {
        let settings = ClusterSettings { around: 32, along: 32, ..ClusterSettings::default() };
        assert_eq!(settings.grid(40, 0.5, 400_000), RibGrid { layers: 4, around: 32, along: 32 });
        let many = settings.grid(1000, 0.5, 400_000);
        assert!(many.volumes() * 1000 <= 400_000 && many.around >= 6 && many.layers >= 2, "{many:?}");
        // Nothing becomes too coarse to be a lock.
        assert_eq!(settings.grid(10_000_000, 0.5, 400_000), RibGrid { layers: 2, around: 6, along: 6 });
    }
}
