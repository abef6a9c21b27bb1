//! Histories as the bytes of a journal.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::Arc;

use crate::date;

use super::owner::Owner;
use super::patch::pack;
use super::record::{Kind, MAGIC, append};
use super::shape::{Change, Shape, Step};
use crate::Project;
use crate::history::HistoryMark;
use crate::project::text_in_memory;

/// The most bytes of the steps in a new journal: beyond that, it leaves out the oldest ones.
const MOST_BYTES: usize = 64 << 20;

/// What the file of a journal holds so far.
pub(super) struct Encoder {
    /// The states in the file, by their addresses. They are held, so that no other project gets the address of one.
    known: BTreeMap<usize, (Arc<Project>, u64)>,
    /// The text of the last state in the file, from which the next one differs.
    text: Vec<u8>,
    next: u64,
    shape: Shape,
}

impl Encoder {
    /// A new journal with the history of `mark`, and its bytes.
    ///
    /// # Errors
    /// If a path in the project is not Unicode.
    pub(super) fn begin(
        owner: &Owner,
        mark: &HistoryMark,
        path: Option<&Path>,
    ) -> io::Result<(Self, Vec<u8>)> {
        let mut mark = mark.clone();
        loop {
            let mut encoder =
                Self { known: BTreeMap::new(), text: Vec::new(), next: 0, shape: Shape::default() };
            let mut out = MAGIC.to_vec();
            append(&mut out, Kind::Owner, &[&serde_json::to_vec(owner)?]);
            encoder.append(&mark, path, &mut out)?;
            if out.len() <= MOST_BYTES || mark.past.is_empty() {
                return Ok((encoder, out));
            }
            mark.past.drain(..mark.past.len().div_ceil(2));
        }
    }

    /// Appends to `out` what has changed.
    ///
    /// # Errors
    /// As [`Encoder::begin`]. The encoder cannot be used any more.
    pub(super) fn append(
        &mut self,
        mark: &HistoryMark,
        path: Option<&Path>,
        out: &mut Vec<u8>,
    ) -> io::Result<()> {
        let saved = self.number(&mark.saved, out)?;
        let past = self.steps(&mark.past, out)?;
        let present = self.number(&mark.present, out)?;
        let future = self.steps(&mark.future, out)?;
        let after = Shape { past, present, future, saved };
        let mut change = Change::between(&self.shape, &after);
        change.time_ms = date::unix_ms(date::now());
        change.modified = saved != present && mark.saved != mark.present;
        change.project = path.map(Path::to_owned);
        append(out, Kind::Change, &[&serde_json::to_vec(&change)?]);
        let used: std::collections::BTreeSet<u64> = after.states().collect();
        self.known.retain(|_, (_, number)| used.contains(number));
        self.shape = after;
        Ok(())
    }

    fn steps(&mut self, steps: &[(String, Arc<Project>)], out: &mut Vec<u8>) -> io::Result<Vec<Step>> {
        steps.iter().map(|(label, project)| Ok((label.clone(), self.number(project, out)?))).collect()
    }

    /// The number of a state. Appends it to `out` if it is new.
    fn number(&mut self, project: &Arc<Project>, out: &mut Vec<u8>) -> io::Result<u64> {
        let address = Arc::as_ptr(project).addr();
        if let Some((_, number)) = self.known.get(&address) {
            return Ok(*number);
        }
        let text = text_in_memory(project).map_err(io::Error::other)?.into_bytes();
        let number = self.next;
        append(out, Kind::State, &[&number.to_le_bytes(), &pack(&text, &self.text)?]);
        self.known.insert(address, (Arc::clone(project), number));
        (self.text, self.next) = (text, number + 1);
        Ok(number)
    }
}
