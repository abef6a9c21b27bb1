//! Installs the Debian package into a bare Debian, opens the window there and records a film.

use anyhow::{Context as _, ensure};
use lovelock_xtask::tool;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// The release whose libraries are as old as those that the program is built with or older.
const RELEASE: &str = "bookworm";
/// What the trial needs besides the package: a screen, and a driver for Vulkan that needs no card.
const BESIDE: &str = "xvfb xauth mesa-vulkan-drivers";
/// A picture of the window, which is not one colour, has more bytes than this.
const PICTURE_BYTES: u64 = 20_000;

/// Tries a package.
pub(super) fn run(deb: &Path) -> anyhow::Result<()> {
    let root = tool::target().join("package-trial");
    if root.exists() {
        fs::remove_dir_all(&root).with_context(|| format!("could not empty {}", root.display()))?;
    }
    let started = Command::new("debootstrap")
        .args(["--variant=minbase", RELEASE])
        .arg(&root)
        .stdout(Stdio::null())
        .status()
        .context("--try: could not start debootstrap")?;
    ensure!(started.success(), "--try: debootstrap failed ({started}); must be run as root");
    // The registry may need what this machine's apt is told. Its sources replace those of debootstrap.
    if fs::read_dir("/etc/apt/sources.list.d").is_ok_and(|mut entries| entries.next().is_some()) {
        let _ = fs::remove_file(root.join("etc/apt/sources.list"));
    }
    for folder in ["etc/apt/apt.conf.d", "etc/apt/sources.list.d"] {
        copy_files(&Path::new("/").join(folder), &root.join(folder));
    }
    let _ = fs::copy("/etc/resolv.conf", root.join("etc/resolv.conf"));
    fs::copy(deb, root.join("tmp/lovelock.deb")).context("the package")?;
    inside(&root, "apt-get update -qq || true")?;
    inside(
        &root,
        &format!(
            "apt-get install -y -qq --no-install-recommends /tmp/lovelock.deb {BESIDE} >/tmp/install.log"
        ),
    )?;
    for what in [
        "lovelock --version",
        "test -s /usr/share/man/man1/lovelock-record.1.gz",
        "test -s /usr/share/applications/lovelock.desktop",
        "xvfb-run -a -s '-screen 0 1440x900x24' lovelock --screenshot /tmp/window.png --after 3",
        "lovelock record -o /tmp/film.mp4 --frames 0..10 --size 320x180",
        "lovelock info /tmp/film.mp4 >/dev/null 2>&1 || test -s /tmp/film.mp4",
    ] {
        inside(&root, what)?;
        println!("in a bare {RELEASE}: {what}: ok");
    }
    let bytes = fs::metadata(root.join("tmp/window.png")).context("the picture of the window")?.len();
    ensure!(bytes > PICTURE_BYTES, "the picture of the window has {bytes} bytes; it must show something");
    inside(&root, "apt-get remove -y -qq lovelock >/dev/null && ! command -v lovelock")?;
    fs::remove_dir_all(&root).with_context(|| format!("could not remove {}", root.display()))
}

fn inside(root: &Path, script: &str) -> anyhow::Result<()> {
    let mut command = Command::new("chroot");
    command.arg(root).args(["/bin/sh", "-ec", script]);
    command.env("DEBIAN_FRONTEND", "noninteractive").env("HOME", "/root").env("LC_ALL", "C.UTF-8");
    let status = command.status().context("could not start chroot")?;
    ensure!(status.success(), "in a bare {RELEASE}: `{script}` failed ({status})");
    Ok(())
}

/// Copies the files of a folder as far as that is possible.
fn copy_files(from: &Path, to: &Path) {
    for entry in fs::read_dir(from).into_iter().flatten().flatten() {
        let _ = fs::copy(entry.path(), to.join(entry.file_name()));
    }
}
