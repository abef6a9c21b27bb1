//! Installs the Debian package into a bare Debian, opens the window there and records a film.

use anyhow::{Context as _, ensure};
use lovelock_xtask::tool;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The release whose libraries are as old as those that the program is built with or older.
const RELEASE: &str = "bookworm";
/// Where its packages are, if this machine's apt knows no mirror.
const MIRROR: &str = "http://deb.debian.org/debian";
/// What the trial needs besides the package: a screen, and a driver for Vulkan that needs no card.
const BESIDE: &str = "xvfb xauth mesa-vulkan-drivers";
/// A picture of the window, which is not one colour, has more bytes than this.
const PICTURE_BYTES: u64 = 20_000;

/// In a container apt may neither change its user nor open a terminal for dpkg.
const APT: &str = "APT::Sandbox::User \"root\";\nDpkg::Use-Pty \"0\";\n";
/// Nothing that a package installs may start services: they would run on this machine.
const NO_SERVICES: &str =
    "printf '#!/bin/sh\\nexit 101\\n' >/usr/sbin/policy-rc.d && chmod 755 /usr/sbin/policy-rc.d";
/// Enters the folder `$0` and runs `$1`, with the devices of this machine.
const WITH_DEVICES: &str = "for folder in dev proc sys; do mount --rbind /$folder \"$0/$folder\"; done; \
     exec chroot \"$0\" /bin/sh -ec \"$1\"";

/// Tries a package.
pub(super) fn run(deb: &Path) -> anyhow::Result<()> {
    let user = tool::output_of("id", &["-u"]).unwrap_or_default();
    ensure!(user.trim() == "0", "--try: found the user {}; must be root (0)", user.trim());
    let bare = Bare::new(tool::target().join("package-trial"))?;
    let root = &bare.root;
    fs::copy(deb, root.join("tmp/lovelock.deb")).context("the package")?;
    bare.run(NO_SERVICES)?;
    bare.run("apt-get update -qq")?;
    // The log says why it failed.
    let install = format!("apt-get install -y -qq --no-install-recommends /tmp/lovelock.deb {BESIDE}");
    bare.run(&format!("{install} >/tmp/install.log || {{ tail -n 40 /tmp/install.log; false; }}"))?;
    for what in [
        "lovelock --version",
        "test -s /usr/share/man/man1/lovelock-record.1",
        "test -s /usr/share/applications/lovelock.desktop",
        "timeout 600 xvfb-run -a -s '-screen 0 1440x900x24' lovelock --screenshot /tmp/window.png --after 3",
        "timeout 600 lovelock record -o /tmp/film.mp4 --frames 0..10 --size 320x180",
        "test -s /tmp/film.mp4",
    ] {
        bare.run(what)?;
        println!("in a bare {RELEASE}: {what}: ok");
    }
    let bytes = fs::metadata(root.join("tmp/window.png")).context("the picture of the window")?.len();
    ensure!(bytes > PICTURE_BYTES, "the picture of the window has {bytes} bytes; it must show something");
    bare.run("apt-get remove -y -qq lovelock >/dev/null && ! command -v lovelock")?;
    fs::remove_dir_all(root).with_context(|| format!("could not remove {}", root.display()))
}

/// A bare system in a folder.
struct Bare {
    root: PathBuf,
    /// Whether folders can be mounted where nobody else sees them. Such mounts end with the program that sees them, so that removing the
    /// folder cannot remove what is mounted there. Containers may forbid it; then the system has only the devices that debootstrap makes.
    mounts: bool,
}

impl Bare {
    /// Makes one.
    fn new(root: PathBuf) -> anyhow::Result<Self> {
        if root.exists() {
            fs::remove_dir_all(&root).with_context(|| format!("could not empty {}", root.display()))?;
        }
        let mut probe = Command::new("unshare");
        probe
            .args(["--mount", "mount", "--bind", "/dev", "/dev"])
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let mounts = probe.status().is_ok_and(|status| status.success());
        let mut command = Command::new(if mounts { "unshare" } else { "debootstrap" });
        if mounts {
            command.args(["--mount", "debootstrap"]);
        }
        let mirror = mirror();
        command.args(["--variant=minbase", RELEASE]).arg(&root).arg(&mirror).stdout(Stdio::null());
        let status = command.status().context("--try: could not start debootstrap")?;
        let log = root.join("debootstrap").join("debootstrap.log");
        ensure!(
            status.success(),
            "--try: debootstrap failed with {mirror} ({status}); its log is {}",
            log.display()
        );
        let dump = tool::output_of("apt-config", &["dump"]).unwrap_or_default();
        let settings = settings_in(&dump);
        let path = root.join("etc/apt/apt.conf.d/90trial");
        fs::write(&path, format!("{APT}{settings}")).with_context(|| path.display().to_string())?;
        // Names and certificates with which this machine reaches the mirror. The bare system has no certificates.
        let certificates = settings.lines().filter(|line| line.to_lowercase().contains("::cainfo "));
        let named = certificates.filter_map(|line| line.split('"').nth(1));
        for file in
            ["/etc/resolv.conf", "/etc/hosts", "/etc/ssl/certs/ca-certificates.crt"].into_iter().chain(named)
        {
            copy_into(&root, Path::new(file));
        }
        Ok(Self { root, mounts })
    }

    /// Runs a script in it.
    fn run(&self, script: &str) -> anyhow::Result<()> {
        let mut command = Command::new(if self.mounts { "unshare" } else { "chroot" });
        if self.mounts {
            command.args(["--mount", "/bin/sh", "-ec", WITH_DEVICES]).arg(&self.root).arg(script);
        } else {
            command.arg(&self.root).args(["/bin/sh", "-ec", script]);
        }
        // Nothing of this machine's: not its screens, folders of temporary files and drivers. Only how it reaches the network.
        let kept = ["http_proxy", "https_proxy", "no_proxy", "HTTP_PROXY", "HTTPS_PROXY", "NO_PROXY"];
        let kept = kept.into_iter().filter_map(|name| Some((name, std::env::var_os(name)?)));
        command.env_clear().envs(kept);
        command.env("PATH", "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin");
        command.env("DEBIAN_FRONTEND", "noninteractive").env("HOME", "/root").env("LC_ALL", "C.UTF-8");
        let status = command.status().context("could not start chroot")?;
        ensure!(status.success(), "in a bare {RELEASE}: `{script}` failed ({status})");
        Ok(())
    }
}

/// The mirror of Debian that this machine's apt uses. Its other sources are not those of a bare system.
fn mirror() -> String {
    let lists = fs::read_dir("/etc/apt/sources.list.d").into_iter().flatten().flatten();
    let lists = lists.map(|entry| entry.path());
    let is_source = |path: &PathBuf| path.extension().is_some_and(|end| end == "list" || end == "sources");
    let mut files = std::iter::once(PathBuf::from("/etc/apt/sources.list")).chain(lists).filter(is_source);
    let found = files.find_map(|file| mirror_in(&fs::read_to_string(file).ok()?));
    found.unwrap_or_else(|| MIRROR.to_owned())
}

/// The first mirror of Debian in a list of sources, in either of their formats.
fn mirror_in(sources: &str) -> Option<String> {
    let lines = sources.lines().filter(|line| !line.trim_start().starts_with('#'));
    let is_mirror = |word: &&str| word.starts_with("http") && word.trim_end_matches('/').ends_with("/debian");
    lines.flat_map(str::split_whitespace).find(is_mirror).map(str::to_owned)
}

/// What this machine's apt is told about the network. Its other settings may name programs that a bare system does not have.
fn settings_in(dump: &str) -> String {
    let is_wanted = |line: &&str| {
        let network = ["Acquire::http", "Acquire::Retries ", "Acquire::Check-"];
        network.iter().any(|start| line.starts_with(start)) && !line.contains("Auto-Detect")
    };
    dump.lines().filter(is_wanted).fold(String::new(), |settings, line| settings + line + "\n")
}

/// Copies a file to the same place below `root`, as far as that is possible.
fn copy_into(root: &Path, file: &Path) {
    let to = root.join(file.strip_prefix("/").unwrap_or(file));
    if let Some(folder) = to.parent().filter(|_| file.is_file()) {
        let _ = fs::create_dir_all(folder).and_then(|()| fs::copy(file, &to));
    }
}

#[cfg(test)]
mod tests {
    use super::{mirror_in, settings_in};

    #[test]
    fn the_mirror_is_found_in_both_formats_and_not_among_other_sources() {
        let found = |sources: &str| mirror_in(sources).unwrap_or_default();
        let new =
            "Types: deb\n# http://old.example/debian\nURIs: http://mirror.example/debian/\nSuites: trixie\n";
        assert_eq!(found(new), "http://mirror.example/debian/");
        assert_eq!(
            found("deb [signed-by=/a] https://m.example/debian trixie main\n"),
            "https://m.example/debian"
        );
        for other in
            ["deb http://archive.ubuntu.com/ubuntu noble main", "URIs: http://m.example/debian-security"]
        {
            assert_eq!(mirror_in(other), None);
        }
    }

    #[test]
    fn only_what_concerns_the_network_is_taken_over() {
        let network = "Acquire::http::Proxy \"http://proxy:3128\";\nAcquire::Check-Date \"false\";\n";
        let other = "DPkg::Pre-Install-Pkgs:: \"/usr/bin/apt-listchanges --apt\";\n\
                     Acquire::http::Proxy-Auto-Detect \"/usr/bin/find-proxy\";\nAcquire::Languages \"\";\n";
        assert_eq!(settings_in(&format!("{other}{network}")), network);
        assert_eq!(settings_in(""), "");
    }
}
