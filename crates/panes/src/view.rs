//! What panes show.

use lovelock_metrics::ColorMap;
use serde::{Deserialize, Serialize};

/// What panes show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LiveShows {
    /// The rendered image.
    #[default]
    Picture,
    /// Absolute error of the transmittance against the exact method, in colour.
    TransmittanceError,
    /// Signed error: where a pane is too dark and where too bright.
    TransmittanceBias,
    /// Perceived difference (FLIP) from an image with exact shadows and transparency, in colour.
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
            Self::PictureError => "Image difference",
        }
    }

    /// The tooltip.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Picture => "The hair as each pane renders it.",
            Self::TransmittanceError => {
                "The absolute error of the light that reaches the hair, compared with the exact method."
            }
            Self::TransmittanceBias => {
                "The signed error: orange is too dark, violet too bright, white is correct."
            }
            Self::PictureError => {
                "How different the image looks from the exact one to an observer who flips between them (FLIP)."
            }
        }
    }

    /// The quantity of the colour scale.
    pub const fn quantity(self) -> &'static str {
        match self {
            Self::Picture => "",
            Self::TransmittanceError => "|transmittance - exact|",
            Self::TransmittanceBias => "transmittance - exact",
            Self::PictureError => "FLIP",
        }
    }

    /// The colour map; `None` for the rendered image.
    pub const fn colors(self) -> Option<ColorMap> {
        match self {
            Self::Picture => None,
            Self::TransmittanceError => Some(ColorMap::Viridis),
            Self::TransmittanceBias => Some(ColorMap::Diverging),
            Self::PictureError => Some(ColorMap::Magma),
        }
    }
}

/// What all panes show and measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiveView {
    /// What they show.
    pub shows: LiveShows,
    /// The value of the last colour of the scale, above 0.
    pub largest: f32,
    /// Whether errors against the exact method are measured, which false colours need too.
    pub measures: bool,
    /// The light whose transmittance is measured, counted from 0 among the enabled lights.
    pub light: usize,
}

impl Default for LiveView {
    fn default() -> Self {
        Self { shows: LiveShows::Picture, largest: 0.25, measures: true, light: 0 }
    }
}
