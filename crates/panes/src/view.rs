//! What panes show.

use lovelock_metrics::ColorMap;
use serde::{Deserialize, Serialize};

/// What panes show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LiveShows {
    /// The picture itself.
    #[default]
    Picture,
    /// How far the transmittance of the hair is from the exact method's, in colour.
    TransmittanceError,
    /// The same with its sign: where a pane is too dark and where too bright.
    TransmittanceBias,
    /// How different the picture looks from one with exact shadows and transparency (FLIP), in colour.
    PictureError,
}

impl LiveShows {
    /// All of them, in the order of menus.
    pub const ALL: [Self; 4] =
        [Self::Picture, Self::TransmittanceError, Self::TransmittanceBias, Self::PictureError];

    /// The name in menus.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Picture => "Picture",
            Self::TransmittanceError => "Error of transmittance",
            Self::TransmittanceBias => "Too dark, too bright",
            Self::PictureError => "Difference of picture",
        }
    }

    /// One sentence: what it is.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Picture => "The hair as each pane draws it.",
            Self::TransmittanceError => {
                "How far the light that reaches a hair is from the exact method's, without its sign."
            }
            Self::TransmittanceBias => {
                "The same with its sign: orange is too dark, violet too bright, white is right."
            }
            Self::PictureError => {
                "How different the picture looks from the exact one to an observer who flips between them (FLIP)."
            }
        }
    }

    /// What the numbers of the scale are.
    pub const fn quantity(self) -> &'static str {
        match self {
            Self::Picture => "",
            Self::TransmittanceError => "|transmittance - exact|",
            Self::TransmittanceBias => "transmittance - exact",
            Self::PictureError => "FLIP",
        }
    }

    /// Its colours; none for the picture itself.
    pub const fn colors(self) -> Option<ColorMap> {
        match self {
            Self::Picture => None,
            Self::TransmittanceError => Some(ColorMap::Viridis),
            Self::TransmittanceBias => Some(ColorMap::Diverging),
            Self::PictureError => Some(ColorMap::Magma),
        }
    }
}

/// What all panes show, and what is measured of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiveView {
    /// What they show.
    pub shows: LiveShows,
    /// What the last colour of the scale stands for, above 0.
    pub largest: f32,
    /// Whether errors against the exact method are measured. Colours need it too.
    pub measures: bool,
    /// The light of which transmittance is measured, counted from 0 among those that are on.
    pub light: usize,
}

impl Default for LiveView {
    fn default() -> Self {
        Self { shows: LiveShows::Picture, largest: 0.25, measures: true, light: 0 }
    }
}
