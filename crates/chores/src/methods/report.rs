//! What the page needs of the report of a comparison.

use anyhow::Context as _;
use serde::Deserialize;
use std::fs;
use std::path::Path;

/// The part of `report.json` that is shown.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Report {
    /// Whether the comparison ran to its end.
    pub(super) complete: bool,
    pub(super) machine: String,
    pub(super) scene: Scene,
    pub(super) reference: Reference,
    pub(super) methods: Vec<Method>,
}

#[derive(Clone, Debug, Deserialize)]
pub(super) struct Scene {
    pub(super) strands: u64,
    pub(super) segments: u64,
}

#[derive(Clone, Debug, Deserialize)]
pub(super) struct Reference {
    pub(super) converged: bool,
    pub(super) change: f64,
}

#[derive(Clone, Debug, Default, Deserialize)]
pub(super) struct Method {
    pub(super) id: String,
    pub(super) refused: Option<String>,
    pub(super) transmittance_common: Option<Error>,
    pub(super) flip: Option<Flip>,
    pub(super) ms: Option<StageMs>,
    pub(super) memory_bytes: Option<u64>,
    pub(super) stability: Option<Stability>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
pub(super) struct Error {
    pub(super) rmse: f64,
    pub(super) bias: f64,
    pub(super) p99: f64,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
pub(super) struct Flip {
    pub(super) mean: f64,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
pub(super) struct StageMs {
    pub(super) build: Option<f64>,
    pub(super) query: Option<f64>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
pub(super) struct Stability {
    pub(super) flicker: Option<f64>,
}

impl Report {
    /// Reads `report.json`.
    pub(super) fn read(path: &Path) -> anyhow::Result<Self> {
        let text = fs::read(path).with_context(|| format!("could not read {}", path.display()))?;
        serde_json::from_slice(&text).with_context(|| path.display().to_string())
    }

    pub(super) fn method(&self, id: &str) -> Option<&Method> {
        self.methods.iter().find(|method| method.id == id)
    }
}

impl Method {
    /// Milliseconds to build and to look up.
    pub(super) fn cost(&self) -> Option<(f64, f64)> {
        self.ms.and_then(|ms| Some((ms.build?, ms.query?)))
    }

    /// Root mean square error against the one ground truth of all methods.
    pub(super) fn rmse(&self) -> Option<f64> {
        self.transmittance_common.map(|error| error.rmse)
    }
}
