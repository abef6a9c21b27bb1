//! Description of a style file.

use std::collections::BTreeMap;
use std::path::Path;

use lovelock_project::error::{ProblemKind, ProjectError};
use lovelock_project::project::PROJECT_VERSION;
use lovelock_project::styles::Style;
use serde::Serialize;

/// Description of a hairstyle as a document of its own.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StyleInfo {
    /// Its format.
    pub format: String,
    /// Unknown fields with counts.
    pub dropped: BTreeMap<String, u64>,
    /// Problems: values out of range, unknown fields, and layers that this version does not know.
    pub notes: Vec<String>,
    /// What it is called.
    pub name: String,
    /// One sentence that describes it.
    pub text: String,
    /// Words by which it is found.
    pub tags: Vec<String>,
    /// The number of strands; `null` if they come from a hair file.
    pub strands: Option<u64>,
    /// The names of its layers.
    pub layers: Vec<String>,
}

impl StyleInfo {
    /// Describes the file at `path`.
    ///
    /// # Errors
    /// A file that cannot be read or is no style.
    pub fn of(path: &Path) -> Result<Self, ProjectError> {
        let (style, problems) = Style::load(path)?;
        let ignored = problems.iter().filter(|problem| problem.kind == ProblemKind::Ignored).count() as u64;
        let unknown = style.hair.stack.unknown().into_iter().map(|(layer, id)| {
            format!("the layer \"{layer}\" uses `{id}`, which this version does not know")
        });
        Ok(Self {
            format: format!("Lovelock style {PROJECT_VERSION}"),
            dropped: (ignored > 0).then(|| ("unknown_fields".to_owned(), ignored)).into_iter().collect(),
            notes: problems.iter().map(ToString::to_string).chain(unknown).collect(),
            strands: style.strands(),
            layers: style.hair.stack.layers.iter().map(|layer| layer.label().to_owned()).collect(),
            name: style.name,
            text: style.text,
            tags: style.tags,
        })
    }
}
