//! Reads journals.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::Path;
use std::sync::Arc;

use super::owner::Owner;
use super::patch::unpack;
use super::record::{Kind, Records, append, is_newer};
use super::shape::{Change, Shape, Step};
use crate::error::ProjectError;
use crate::history::{History, HistoryMark};
use crate::project::project_in_memory;

/// The longest journal that is read, bytes.
const LONGEST: u64 = 512 << 20;

/// The longest record of an owner that is read, bytes.
const LONGEST_OWNER: u64 = 4096;

/// Who writes a journal: its first record. `None` if it is no journal.
///
/// # Errors
/// If it cannot be read.
pub(super) fn owner_in(journal: impl Read) -> io::Result<Option<Owner>> {
    let mut bytes = Vec::new();
    journal.take(LONGEST_OWNER).read_to_end(&mut bytes)?;
    let first = Records::of(&bytes).and_then(|mut records| records.next());
    let owner = first.filter(|(kind, _)| *kind == Kind::Owner);
    Ok(owner.and_then(|(_, contents)| serde_json::from_slice(contents).ok()))
}

/// What a journal holds.
pub(super) struct Contents {
    bytes: Vec<u8>,
    /// Where the last change that is whole ends.
    end: usize,
    /// Who wrote it.
    pub owner: Owner,
    /// The last change that is whole.
    pub last: Change,
    shape: Shape,
}

impl Contents {
    /// Reads a journal up to the last change that is whole; `None` if there is none.
    ///
    /// # Errors
    /// [`io::ErrorKind::Unsupported`] if it is one of a newer version; others if the file cannot be read.
    pub(super) fn read(file: &mut File) -> io::Result<Option<Self>> {
        let mut bytes = Vec::new();
        file.rewind()?;
        file.take(LONGEST).read_to_end(&mut bytes)?;
        if is_newer(&bytes) {
            return Err(io::Error::new(io::ErrorKind::Unsupported, "a newer version has written it"));
        }
        Ok(Self::of(bytes))
    }

    fn of(bytes: Vec<u8>) -> Option<Self> {
        let (mut owner, mut last, mut shape) = (Owner::default(), None, Shape::default());
        let (mut states, mut end) = (0, 0);
        let mut records = Records::of(&bytes)?;
        while let Some((kind, contents)) = records.next() {
            match kind {
                Kind::Owner => owner = serde_json::from_slice(contents).ok()?,
                Kind::State => states += 1,
                Kind::Change => {
                    let change: Option<Change> = serde_json::from_slice(contents).ok();
                    let Some((change, after)) =
                        change.and_then(|change| Some((change.clone(), change.apply(&shape)?)))
                    else {
                        break;
                    };
                    // States are numbered in their order.
                    if after.states().any(|number| number >= states) {
                        break;
                    }
                    (last, shape, end) = (Some(change), after, bytes.len() - records.left());
                }
            }
        }
        Some(Self { owner, last: last?, shape, end, bytes })
    }

    /// The bytes of the journal. Some systems let no other handle read a locked file.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The bytes of a journal that holds the same and names another project.
    ///
    /// # Errors
    /// If the path is not Unicode.
    pub(super) fn of_project(&self, project: &Path) -> io::Result<Vec<u8>> {
        let mut change = Change::between(&self.shape, &self.shape);
        (change.time_ms, change.modified) = (self.last.time_ms, self.last.modified);
        change.project = Some(project.to_owned());
        // What follows the last whole change would hide a record behind it.
        let mut bytes = self.bytes[..self.end].to_vec();
        append(&mut bytes, Kind::Change, &[&serde_json::to_vec(&change)?]);
        Ok(bytes)
    }

    /// The number of steps that can be undone.
    pub(super) fn steps(&self) -> usize {
        self.shape.past.len()
    }

    /// The history. `path` is used for messages.
    ///
    /// # Errors
    /// If a project in it cannot be read.
    pub(super) fn history(&self, path: &Path) -> Result<History, ProjectError> {
        let damaged = |why: String| ProjectError::input(path, format!("{}: {why}", path.display()));
        let used: std::collections::BTreeSet<u64> = self.shape.states().collect();
        let mut projects = BTreeMap::new();
        let (mut text, mut number) = (Vec::new(), 0);
        for (kind, contents) in Records::of(&self.bytes).into_iter().flatten() {
            if kind != Kind::State {
                continue;
            }
            let Some((_, packed)) = contents.split_first_chunk::<8>() else { break };
            text = unpack(packed, &text).map_err(|error| damaged(format!("state {number}: {error}")))?;
            if used.contains(&number) {
                let text = std::str::from_utf8(&text).map_err(|error| damaged(error.to_string()))?;
                projects.insert(number, Arc::new(project_in_memory(path, text)?));
            }
            number += 1;
        }
        let project = |number: u64| {
            projects.get(&number).cloned().ok_or_else(|| damaged(format!("state {number} is missing")))
        };
        let steps = |steps: &[Step]| {
            steps
                .iter()
                .map(|(label, number)| Ok((label.clone(), project(*number)?)))
                .collect::<Result<Vec<_>, ProjectError>>()
        };
        Ok(History::of_mark(HistoryMark {
            past: steps(&self.shape.past)?,
            present: project(self.shape.present)?,
            future: steps(&self.shape.future)?,
            saved: project(self.shape.saved)?,
        }))
    }
}
