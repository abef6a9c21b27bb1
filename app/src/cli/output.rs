//! Results on standard output, errors on standard error.

use std::process::ExitCode;

use lovelock_project::error::ProjectError;
use serde::Serialize;

/// How results and errors are printed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Output {
    /// One JSON object on standard output, and nothing else there.
    pub(crate) json: bool,
}

impl Output {
    /// Prints a result, as JSON or as `text`.
    pub(crate) fn result<T: Serialize>(
        self,
        value: &T,
        text: impl FnOnce() -> String,
    ) -> Result<(), ProjectError> {
        use std::io::Write;
        let text =
            if self.json { serde_json::to_string_pretty(value).map_err(ProjectError::work)? } else { text() };
        // A reader may close the pipe early.
        let _ = writeln!(std::io::stdout(), "{}", text.trim_end());
        Ok(())
    }

    /// Prints an error and returns its exit status.
    pub(crate) fn fail(self, error: &ProjectError) -> ExitCode {
        eprintln!("lovelock: {error}");
        if self.json {
            println!("{}", error.to_json());
        }
        ExitCode::from(error.exit_code())
    }

    /// Prints an error in the command line and returns its exit status.
    pub(crate) fn refuse(self, message: &str) -> ExitCode {
        self.fail(&ProjectError::option(message))
    }
}
