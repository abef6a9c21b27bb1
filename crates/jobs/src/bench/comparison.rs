//! The result of a comparison with an earlier run.

use serde::Serialize;

use super::yardstick::Yardstick;

/// A stage counts as slower from this factor on its multiple.
pub(super) const SLOWER: f64 = 1.1;

/// The result of a comparison.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The machine of the earlier run.
    pub machine: String,
    /// The yardstick of the earlier run.
    pub yardstick: Yardstick,
    /// Number of stages that both runs have.
    pub compared: usize,
    /// Number of stages of this run that the earlier one lacks.
    pub new: usize,
    /// The stages that slowed by more than a tenth, the slowest first.
    pub slower: Vec<SlowerStage>,
}

/// A stage whose multiple rose by more than a tenth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SlowerStage {
    /// Id of the scene.
    pub scene: String,
    /// `cpu` or `gpu`.
    pub backend: String,
    /// Name of the stage.
    pub stage: String,
    /// Its multiple in the earlier run.
    pub before: f64,
    /// Its multiple now.
    pub now: f64,
}

impl Comparison {
    /// The lines of the text report.
    pub(super) fn lines(&self) -> Vec<String> {
        let Self { machine, yardstick, compared, new, slower } = self;
        let mut lines = vec![format!("compared with {machine}: {yardstick}")];
        let others = if *new > 0 { format!(", {new} not in the earlier run") } else { String::new() };
        lines.push(format!(
            "{} of {compared} stages slowed by more than {:.0} %{others}",
            slower.len(),
            100.0 * (SLOWER - 1.0)
        ));
        lines.extend(slower.iter().map(|of| {
            let percent = 100.0 * (of.now / of.before - 1.0);
            format!(
                "slower: {} on {}, {}: {:.4} to {:.4} (+{percent:.0} %)",
                of.scene, of.backend, of.stage, of.before, of.now
            )
        }));
        lines
    }
}
