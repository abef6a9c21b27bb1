//! Description of recorded strokes.

use std::collections::BTreeMap;
use std::path::Path;

use lovelock_base::settings::Choices as _;
use lovelock_project::error::ProjectError;
use lovelock_session::strokes::read_strokes;
use serde::Serialize;

/// Description of recorded strokes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StrokesInfo {
    /// Its format and version.
    pub format: String,
    /// Always empty: a file with a broken stroke is refused as a whole.
    pub dropped: BTreeMap<String, u64>,
    /// Always empty, as `dropped`.
    pub notes: Vec<String>,
    /// Number of strokes.
    pub strokes: usize,
    /// Number of samples of all strokes.
    pub samples: usize,
    /// The ids of their tools, each once.
    pub tools: Vec<&'static str>,
    /// Time of the dance of the first sample, seconds; `null` if there are no samples.
    pub start_secs: Option<f64>,
    /// Time of the dance of the last sample, seconds; `null` if there are no samples.
    pub end_secs: Option<f64>,
}

impl StrokesInfo {
    /// Reads the strokes at `path`.
    ///
    /// # Errors
    /// A file that cannot be read or holds something else.
    pub(super) fn of(path: &Path) -> Result<Self, ProjectError> {
        let file = read_strokes(path)?;
        let mut tools = Vec::new();
        for stroke in &file.strokes {
            let (id, _) = stroke.tool.names();
            if !tools.contains(&id) {
                tools.push(id);
            }
        }
        let times = || file.strokes.iter().flat_map(|stroke| &stroke.samples).map(|sample| sample.time_secs);
        Ok(Self {
            format: format!("Lovelock strokes {}", file.version),
            dropped: BTreeMap::new(),
            notes: Vec::new(),
            strokes: file.strokes.len(),
            samples: file.strokes.iter().map(|stroke| stroke.samples.len()).sum(),
            tools,
            start_secs: times().min_by(f64::total_cmp),
            end_secs: times().max_by(f64::total_cmp),
        })
    }
}
