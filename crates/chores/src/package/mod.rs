//! `cargo xtask package`: packages for Debian, for Fedora and openSUSE, and an archive for any Linux.
//!
//! What is installed besides the program is listed in `app/Cargo.toml`, where cargo-deb and cargo-generate-rpm read it.

mod archive;
mod icon;
mod manifest;
mod trial;

use anyhow::{Context as _, ensure};
use clap::Args;
use lovelock_xtask::{system, tool};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Options of the chore.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The folder for the packages
    #[arg(short, long, value_name = "DIR", default_value = "target/package")]
    out: PathBuf,
    /// Also install the package into a bare Debian, open the window there and record a film (as root)
    #[arg(long = "try")]
    tries: bool,
    /// Only write the icon for Windows, packaging/windows/lovelock.ico, from the images in packaging/icons
    #[arg(long, conflicts_with = "tries")]
    icon: bool,
}

/// A program that makes packages, with the version that is known to work.
struct Packager {
    name: &'static str,
    version: &'static str,
}

const DEB: Packager = Packager { name: "cargo-deb", version: "3.8.0" };
const RPM: Packager = Packager { name: "cargo-generate-rpm", version: "0.21.1" };

/// Makes the packages and prints their paths.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if arguments.icon {
        return icon::write();
    }
    system::prepare()?;
    if arguments.tries {
        system::prepare_trial()?;
    }
    let out = tool::root().join(&arguments.out);
    fs::create_dir_all(&out).with_context(|| format!("--out {}: could not be created", out.display()))?;
    write_pages(&tool::target().join("release").join("pages"))?;
    let [deb, rpm] = [DEB.installed()?, RPM.installed()?];
    let archive = archive::write(&out)?;
    let deb_file = made(&out, "deb", |folder| {
        let arguments = ["--package", "lovelock", "--no-build", "--output"];
        tool::run(Command::new(deb).args(arguments).arg(folder).current_dir(tool::root()))
    })?;
    let rpm_file = made(&out, "rpm", |folder| {
        let arguments = ["--package", "app", "--payload-compress", "zstd", "--target-dir"];
        let mut command = Command::new(rpm);
        command.args(arguments).arg(tool::target()).arg("--output").arg(folder);
        tool::run(command.current_dir(tool::root()))
    })?;
    for file in [&archive, &deb_file, &rpm_file] {
        let bytes = fs::metadata(file).with_context(|| file.display().to_string())?.len();
        println!("{}: {:.1} MB", file.display(), bytes as f64 / 1e6);
    }
    if arguments.tries { trial::run(&deb_file) } else { Ok(()) }
}

/// Writes the pages for `man` and the completions of shells, as the program prints them.
fn write_pages(folder: &Path) -> anyhow::Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("could not empty {}", folder.display()))?;
    }
    fs::create_dir_all(folder).with_context(|| format!("could not create {}", folder.display()))?;
    tool::run(Command::new(tool::program()).arg("man").arg(folder))?;
    for (shell, file) in [("bash", "lovelock.bash"), ("zsh", "_lovelock"), ("fish", "lovelock.fish")] {
        let output = Command::new(tool::program()).args(["completions", shell]).output()?;
        ensure!(output.status.success(), "`lovelock completions {shell}` failed ({})", output.status);
        fs::write(folder.join(file), output.stdout).with_context(|| file.to_owned())?;
    }
    Ok(())
}

/// Runs a packager that writes one file into an empty folder, and moves the file to `out`.
fn made(
    out: &Path,
    extension: &str,
    make: impl FnOnce(&Path) -> anyhow::Result<()>,
) -> anyhow::Result<PathBuf> {
    let folder = tool::target().join("release").join("pages").join(extension);
    fs::create_dir_all(&folder)?;
    make(&folder)?;
    let entry = fs::read_dir(&folder)?.next().with_context(|| format!("no .{extension} was made"))??;
    let file = out.join(entry.file_name());
    fs::rename(entry.path(), &file).or_else(|_| fs::copy(entry.path(), &file).map(drop))?;
    Ok(file)
}

impl Packager {
    /// The program, which is built below the folder of builds if it is missing.
    fn installed(&self) -> anyhow::Result<PathBuf> {
        let root = tool::target().join("tools");
        let program = root.join("bin").join(self.name);
        let is_there = Command::new(&program).arg("--version").stdout(Stdio::null()).status().is_ok();
        if !is_there {
            println!("installing {} {} into {}", self.name, self.version, root.display());
            let mut command = tool::cargo(&["install", self.name, "--locked", "--version", self.version]);
            tool::run(command.arg("--root").arg(&root))?;
        }
        Ok(program)
    }
}
