//! The project's text at the start of a chunk and its changes within the chunk.
//!
//! A change stores only the bytes between the common start and the common end of the old and the new text, so dragging a
//! slider takes some bytes per frame.

use std::ops::Range;

use super::MAX_PROJECT_BYTES;
use super::bytes::Bytes;

/// A change. From `frame` of the chunk on, `middle` replaces everything between the first `prefix` and the last `suffix` bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Edit {
    frame: u32,
    prefix: u32,
    suffix: u32,
    middle: Vec<u8>,
}

/// The texts of a chunk that is being written.
#[derive(Clone, Debug, Default)]
pub(super) struct SettingsLog {
    start: String,
    edits: Vec<Edit>,
    now: String,
    bytes: usize,
}

impl SettingsLog {
    /// A chunk that starts with `project`.
    pub(super) fn new(project: String) -> Self {
        Self { now: project.clone(), bytes: project.len(), start: project, edits: Vec::new() }
    }

    /// Records that the text is `project` from `frame` of the chunk on.
    pub(super) fn change(&mut self, frame: u32, project: &str) {
        if project == self.now {
            return;
        }
        if frame == 0 {
            *self = Self::new(project.to_owned());
            return;
        }
        // A second change at the same frame replaces the first.
        if self.edits.last().is_some_and(|edit| edit.frame == frame) {
            let last = self.edits.pop().map_or(0, |edit| edit.middle.len());
            self.bytes -= last;
            self.now = apply_all(&self.start, &self.edits).unwrap_or_default();
            return self.change(frame, project);
        }
        let (old, new) = (self.now.as_bytes(), project.as_bytes());
        let same = |pairs: &mut dyn Iterator<Item = (&u8, &u8)>| pairs.take_while(|(a, b)| a == b).count();
        let prefix = same(&mut old.iter().zip(new));
        let suffix = same(&mut old[prefix..].iter().rev().zip(new[prefix..].iter().rev()));
        let middle = new[prefix..new.len() - suffix].to_vec();
        self.bytes += middle.len() + 16;
        self.edits.push(Edit { frame, prefix: prefix as u32, suffix: suffix as u32, middle });
        project.clone_into(&mut self.now);
    }

    /// The present text.
    pub(super) fn now(&self) -> &str {
        &self.now
    }

    /// Number of changes so far.
    pub(super) fn changes(&self) -> u32 {
        self.edits.len() as u32
    }

    /// Approximate length of [`SettingsLog::to_bytes`].
    pub(super) fn bytes(&self) -> usize {
        self.bytes
    }

    /// The text part of a chunk.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::with_capacity(self.bytes + 8);
        out.extend((self.start.len() as u32).to_le_bytes());
        out.extend(self.start.as_bytes());
        for edit in &self.edits {
            for word in [edit.frame, edit.prefix, edit.suffix, edit.middle.len() as u32] {
                out.extend(word.to_le_bytes());
            }
            out.extend(&edit.middle);
        }
        out
    }
}

/// The texts of a chunk that has been read.
#[derive(Clone, Debug)]
pub(super) struct Settings {
    start: String,
    edits: Vec<Edit>,
}

impl Settings {
    /// Reads the text part `raw` of a chunk with `changes` changes.
    pub(super) fn parse(raw: &[u8], changes: u32) -> Result<Self, String> {
        let mut bytes = Bytes::new(raw);
        let short = || "a text part that ends too early".to_owned();
        let length = bytes.u32().ok_or_else(short)?;
        let start = bytes.take(length as usize).ok_or_else(short)?.to_vec();
        let start = String::from_utf8(start).map_err(|_| NO_UTF8.to_owned())?;
        let mut edits: Vec<Edit> = Vec::new();
        for _ in 0..changes {
            let mut word = || bytes.u32().ok_or_else(short);
            let [frame, prefix, suffix, length] = [word()?, word()?, word()?, word()?];
            if edits.last().is_some_and(|last| last.frame >= frame) {
                return Err("changes that are out of order".to_owned());
            }
            let middle = bytes.take(length as usize).ok_or_else(short)?.to_vec();
            edits.push(Edit { frame, prefix, suffix, middle });
        }
        if bytes.left() > 0 {
            return Err(format!("{} bytes after the last change", bytes.left()));
        }
        Ok(Self { start, edits })
    }

    /// The text at `frame` of the chunk, and the range of frames for which it stays the same.
    pub(super) fn at(&self, frame: u32) -> Result<(String, Range<u32>), String> {
        let past = self.edits.partition_point(|edit| edit.frame <= frame);
        let from = past.checked_sub(1).map_or(0, |last| self.edits[last].frame);
        let until = self.edits.get(past).map_or(u32::MAX, |next| next.frame);
        Ok((apply_all(&self.start, &self.edits[..past])?, from..until))
    }
}

const NO_UTF8: &str = "a project that is not UTF-8";

fn apply_all(start: &str, edits: &[Edit]) -> Result<String, String> {
    let mut text = start.as_bytes().to_vec();
    for edit in edits {
        let (prefix, suffix) = (edit.prefix as usize, edit.suffix as usize);
        let kept = prefix.checked_add(suffix).filter(|&kept| kept <= text.len());
        let end =
            kept.map(|_| text.len() - suffix).ok_or("a change that keeps more bytes than the text has")?;
        text.splice(prefix..end, edit.middle.iter().copied());
        if text.len() > MAX_PROJECT_BYTES {
            return Err(format!("a project of {} bytes", text.len()));
        }
    }
    String::from_utf8(text).map_err(|_| NO_UTF8.to_owned())
}

#[cfg(test)]
mod tests {
    use super::{Settings, SettingsLog};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn any_texts_come_back(texts in prop::collection::vec((0_u32..3, "[aäb€]{0,6}"), 0..20), start in "[aäb€]{0,6}") {
            let mut log = SettingsLog::new(start.clone());
            let (mut frame, mut wanted) = (0, vec![start]);
            for (later, text) in texts {
                frame += later;
                log.change(frame, &text);
                let before = wanted.last().cloned().unwrap_or_default();
                wanted.resize(frame as usize + 1, before);
                wanted[frame as usize] = text;
            }
            let settings = Settings::parse(&log.to_bytes(), log.changes()).unwrap();
            for (frame, text) in wanted.iter().enumerate() {
                let (found, range) = settings.at(frame as u32).unwrap();
                prop_assert_eq!(&found, text);
                prop_assert!(range.contains(&(frame as u32)));
            }
        }

        #[test]
        fn random_bytes_are_refused_or_read(raw in prop::collection::vec(any::<u8>(), 0..200)) {
            // No bytes may cause a panic.
            if let Ok(settings) = Settings::parse(&raw, 2) {
                let _ = settings.at(1);
            }
        }
    }

    #[test]
    fn a_change_that_keeps_more_than_the_text_is_refused() {
        let mut log = SettingsLog::new("start".to_owned());
        log.change(1, "stare");
        let good = log.to_bytes();
        assert_eq!(Settings::parse(&good, 1).unwrap().at(1).unwrap().0, "stare");
        // The prefix follows the length, the text and the frame.
        let mut bad = good.clone();
        bad[4 + 5 + 4] = 6;
        assert!(Settings::parse(&bad, 1).unwrap().at(1).is_err());
        assert!(Settings::parse(&good, 0).is_err(), "a change that is not in the header");
        assert!(Settings::parse(&good, 2).is_err(), "a change that is missing");
    }
}
