//! What a package installs beside the program: completions of shells, and pages of the manual.

use std::fs;
use std::path::Path;

use clap::CommandFactory as _;
use lovelock_project::error::ProjectError;

use super::args::{Arguments, Completions, Man};

/// Prints the completions of a shell.
pub(crate) fn completions(task: &Completions) {
    clap_complete::generate(task.shell, &mut Arguments::command(), "lovelock", &mut std::io::stdout());
}

/// Writes a page for the program and one for each command.
pub(crate) fn man(task: &Man) -> Result<(), ProjectError> {
    let failed = |error: std::io::Error| {
        ProjectError::work(format!("the pages could not be written to {}: {error}", task.folder.display()))
    };
    fs::create_dir_all(&task.folder).map_err(failed)?;
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    write(&program, &task.folder).map_err(failed)
}

fn write(program: &clap::Command, folder: &Path) -> std::io::Result<()> {
    clap_mangen::Man::new(program.clone()).generate_to(folder)?;
    for command in program.get_subcommands().filter(|command| !command.is_hide_set()) {
        let name = format!("lovelock-{}", command.get_name());
        clap_mangen::Man::new(command.clone().display_name(&name)).generate_to(folder)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page_and_completions() {
        let folder = tempfile::tempdir().expect("a folder");
        man(&Man { folder: folder.path().to_owned() }).expect("pages");
        let program = Arguments::command();
        let page = |name: &str| fs::read_to_string(folder.path().join(name)).expect(name);
        assert!(page("lovelock.1").contains("record"));
        for command in program.get_subcommands().filter(|command| !command.is_hide_set()) {
            let text = page(&format!("lovelock-{}.1", command.get_name()));
            assert!(text.contains("SYNOPSIS"), "{}", command.get_name());
        }
        let mut bash = Vec::new();
        clap_complete::generate(clap_complete::Shell::Bash, &mut Arguments::command(), "lovelock", &mut bash);
        assert!(String::from_utf8(bash).expect("text").contains("lovelock__subcmd__record"));
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let file = tempfile::NamedTempFile::new().expect("a file");
        let error = man(&Man { folder: file.path().join("man") }).expect_err("below a file");
        assert!(error.to_string().contains(&file.path().display().to_string()), "{error}");
    }
}
