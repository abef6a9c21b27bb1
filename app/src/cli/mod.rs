//! The command line.

mod args;
mod bar;
mod bench;
mod compare;
mod convert;
mod farm;
mod info;
mod method;
mod output;
mod papers;
mod presets;
mod record;
mod replace;
mod satf;
mod settings;
mod shell;
mod source;
mod style;
mod values;

use std::process::ExitCode;

use clap::Parser;
use lovelock_glyphs::Script;
use lovelock_project::error::ProjectError;

use args::{Arguments, Task};
use output::Output;
use replace::{Holds, Replaced};

/// Runs the command, or opens the window if there is none.
pub(crate) fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) if error.use_stderr() => {
            let json = std::env::args().any(|argument| argument == "--json");
            return Output { json }.refuse(&one_line(&error));
        }
        // Help and version.
        Err(error) => {
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
    };
    let output = Output { json: arguments.json };
    if let (Some(project), Some(_)) = (&arguments.project, &arguments.task) {
        return output.refuse(&format!("{}: found before the command; must be after it", project.display()));
    }
    if let (Some(first), Some(_)) = (arguments.set.first(), &arguments.task) {
        return output.refuse(&format!("--set {}: found before the command; must be after it", first.name));
    }
    let opens_window = arguments.task.is_none();
    let result = match arguments.task {
        None => open_window(arguments),
        Some(Task::Record(task)) => record::run(&task, output),
        Some(Task::Compare(task)) => compare::run(&task, output),
        Some(Task::Bench(task)) => bench::run(&task, output),
        Some(Task::Papers(task)) => papers::run(&task, output),
        Some(Task::Presets(task)) => presets::run(&task, output),
        Some(Task::Settings(task)) => settings::run(&task, output),
        Some(Task::Info(task)) => info::run(&task, output),
        Some(Task::Convert(task)) => convert::run(&task, output),
        Some(Task::Farm(task)) => farm::run(&task, output),
        Some(Task::Assemble(task)) => farm::run_assemble(&task, output),
        Some(Task::Satf(task)) => satf::run(&task, output),
        Some(Task::Style(task)) => style::run(&task, output),
        Some(Task::Method(task)) => method::run(&task, output),
        Some(Task::Completions(task)) => {
            shell::completions(&task);
            Ok(())
        }
        Some(Task::Man(task)) => shell::man(&task),
    };
    // The window has shown it.
    if let Some(note) = lovelock_satf::cache::note().filter(|_| !opens_window) {
        eprintln!("lovelock: {note}");
    }
    if !opens_window
        && let Some(fonts) = lovelock_glyphs::Fonts::listed()
        && let Some(note) = Script::missing_in_images(&fonts.take_missing())
    {
        eprintln!("lovelock: {note}");
    }
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => output.fail(&error),
    }
}

/// Opens the window.
fn open_window(arguments: Arguments) -> Result<(), ProjectError> {
    let image = arguments.screenshot.as_deref();
    let replaced = image.map(|out| replace::check(out, Holds::IMAGE, arguments.force)).transpose()?;
    let screenshot = arguments.screenshot.map(|out| (out, arguments.after));
    let shows =
        crate::window::Shows { panes: arguments.panes, mask: arguments.mask, method: arguments.method };
    crate::window::open(arguments.project.as_deref(), &arguments.set, shows, screenshot)?;
    replaced.iter().for_each(Replaced::tell);
    Ok(())
}

/// The message of clap in one line.
fn one_line(error: &clap::Error) -> String {
    let text = error.to_string();
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let told: Vec<&str> =
        lines.take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more")).collect();
    let line = told.join(" ");
    line.strip_prefix("error: ").unwrap_or(&line).to_owned()
}
