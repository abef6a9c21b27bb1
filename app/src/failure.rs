//! What happens when a part of the program fails unexpectedly: a report in the user's folder, which holds no contents of files and is sent nowhere.

use std::backtrace::Backtrace;
use std::collections::VecDeque;
use std::fmt::Write as _;
use std::panic::PanicHookInfo;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use lovelock_project::date;
use lovelock_project::state_folder::state_folder;

/// Commands that a report lists.
const COMMANDS: usize = 30;
/// Reports that are kept.
const KEPT: usize = 20;
/// The longest message, letters.
const LONGEST: usize = 300;

/// Libraries that read files and give up on damaged ones this way. Their callers make a sentence of it.
const READERS: [&str; 3] = ["/openusd-", "/symphonia", "/exr-"];

/// What a report says about the time before.
struct Before {
    adapter: String,
    commands: VecDeque<String>,
    /// Reports that nobody has been told of.
    written: Vec<Report>,
}

static BEFORE: Mutex<Before> =
    Mutex::new(Before { adapter: String::new(), commands: VecDeque::new(), written: Vec::new() });

/// A failure of this run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Report {
    /// What failed, in a few words.
    pub(crate) what: String,
    /// The file that says more, if it could be written.
    pub(crate) file: Option<PathBuf>,
}

fn before<T>(change: impl FnOnce(&mut Before) -> T) -> T {
    change(&mut BEFORE.lock().unwrap_or_else(PoisonError::into_inner))
}

/// The folder of the reports.
pub(crate) fn folder() -> Option<PathBuf> {
    Some(state_folder()?.join("failures"))
}

/// Notes the graphics adapter, for reports.
pub(crate) fn note_adapter(adapter: &str) {
    before(|before| {
        if before.adapter != adapter {
            adapter.clone_into(&mut before.adapter);
        }
    });
}

/// Notes a command, for reports.
pub(crate) fn note_command(id: &str) {
    before(|before| {
        if before.commands.len() == COMMANDS {
            before.commands.pop_front();
        }
        before.commands.push_back(id.to_owned());
    });
}

/// The failures since the last call.
pub(crate) fn take_reports() -> Vec<Report> {
    before(|before| std::mem::take(&mut before.written))
}

/// Writes a report whenever a thread panics, in place of printing it.
pub(crate) fn install() {
    std::panic::set_hook(Box::new(|panic| {
        let at = panic.location().map_or_else(String::new, ToString::to_string);
        if READERS.iter().any(|reader| at.contains(reader)) {
            return;
        }
        let text = text_of(panic, &at);
        let file = folder().and_then(|folder| write(&folder, &text));
        let thread =
            std::thread::current().name().unwrap_or("a").trim_start_matches("lovelock").trim().to_owned();
        match &file {
            Some(file) => eprintln!("lovelock: a part of the program failed; {} says more", file.display()),
            None => eprintln!("lovelock: a part of the program failed\n{text}"),
        }
        before(|before| before.written.push(Report { what: thread, file }));
    }));
}

/// The report on a panic at a place of the source.
fn text_of(panic: &PanicHookInfo, at: &str) -> String {
    let payload = panic.payload();
    let message = payload.downcast_ref::<&str>().copied();
    let message =
        message.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message");
    let (adapter, commands) =
        before(|before| (before.adapter.clone(), Vec::from(before.commands.clone()).join(", ")));
    let mut text = String::new();
    let rows = [
        ("Program", format!("Lovelock {}", env!("LOVELOCK_VERSION"))),
        ("System", format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)),
        ("Adapter", if adapter.is_empty() { "not known".to_owned() } else { adapter }),
        ("Thread", std::thread::current().name().unwrap_or("without a name").to_owned()),
        ("Message", without_text(message)),
        ("Place", at.to_owned()),
        ("Commands", if commands.is_empty() { "none".to_owned() } else { commands }),
    ];
    for (name, value) in rows {
        let _ = writeln!(text, "{name}: {value}");
    }
    let _ = writeln!(text, "\n{}", Backtrace::force_capture());
    text
}

/// A message without what may come from a file: the standard library quotes text that is cut at a wrong place.
fn without_text(message: &str) -> String {
    let line = message.lines().next().unwrap_or_default();
    let end = line.find('`').unwrap_or(line.len());
    line[..end].chars().take(LONGEST).collect()
}

/// The reports in a folder, the newest first.
pub(crate) fn reports_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let mut reports: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with("failure-") && path.extension().is_some_and(|end| end == "txt")
        })
        .collect();
    reports.sort();
    reports.reverse();
    reports
}

fn write(folder: &Path, text: &str) -> Option<PathBuf> {
    std::fs::create_dir_all(folder).ok()?;
    for old in reports_in(folder).iter().skip(KEPT - 1) {
        let _ = std::fs::remove_file(old);
    }
    let ms = date::unix_ms(date::now());
    let path = folder.join(format!("failure-{ms:015}-{}.txt", std::process::id()));
    std::fs::write(&path, text).ok()?;
    Some(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_loses_what_may_come_from_a_file() {
        assert_eq!(without_text("index out of bounds: the len is 3"), "index out of bounds: the len is 3");
        let cut =
            without_text("byte index 1 is not a char boundary; it is inside 'é' of `my private text`\nmore");
        assert!(!cut.contains("private") && !cut.contains("more"), "{cut}");
        assert_eq!(without_text(&"x".repeat(5000)).len(), LONGEST);
    }

    #[test]
    fn the_newest_reports_are_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = folder.path().join("failures");
        std::fs::create_dir(&at).expect("a folder");
        for k in 0..30 {
            std::fs::write(at.join(format!("failure-{k:015}-1.txt")), b"").expect("a file");
        }
        std::fs::write(at.join("other.txt"), b"").expect("a file");
        let new = write(&at, "text").expect("written");
        let reports = reports_in(&at);
        assert_eq!((reports.len(), &reports[0]), (KEPT, &new));
        assert!(at.join("other.txt").exists());
    }
}
