//! Tests of the real machine.

use super::plan::Probe;
use crate::tool::output_of;
use std::collections::BTreeSet;
use std::fs;
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};

/// This machine.
pub(crate) struct ThisMachine {
    libraries: BTreeSet<String>,
}

impl ThisMachine {
    /// Lists the libraries of the dynamic loader once.
    pub(crate) fn new() -> Self {
        // /sbin is often not in the path of users.
        let cache = ["ldconfig", "/sbin/ldconfig", "/usr/sbin/ldconfig"]
            .into_iter()
            .find_map(|program| output_of(program, &["-p"]))
            .unwrap_or_default();
        Self { libraries: libraries_in_cache(&cache, std::env::consts::ARCH) }
    }
}

/// The names of libraries for this CPU architecture in the output of `ldconfig -p`.
fn libraries_in_cache(cache: &str, arch: &str) -> BTreeSet<String> {
    let mark = match arch {
        "x86_64" => "x86-64",
        "aarch64" => "AArch64",
        _ => "",
    };
    let lines = cache.lines().filter_map(|line| line.trim().split_once(" ("));
    lines.filter(|(_, rest)| rest.contains(mark)).map(|(name, _)| name.to_owned()).collect()
}

/// Folders with libraries on systems whose loader has no cache, and folders added by the user.
fn library_folders() -> Vec<PathBuf> {
    let added = std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    let mut folders: Vec<PathBuf> = std::env::split_paths(&added).filter(|path| path.is_absolute()).collect();
    folders.extend(
        ["/lib", "/usr/lib", "/lib64", "/usr/lib64", "/usr/local/lib", "/run/opengl-driver/lib"]
            .map(PathBuf::from),
    );
    folders
}

impl Probe for ThisMachine {
    fn has_cxx_compiler(&self) -> bool {
        // Chosen in the same way as by the build of the encoder. `CXX` may contain arguments after the name.
        let chosen = std::env::var("CXX").unwrap_or_default();
        let compiler = chosen.split_whitespace().next().unwrap_or("c++");
        output_of(compiler, &["--version"]).is_some()
    }

    fn has_library(&self, name: &str) -> bool {
        self.libraries.contains(name) || library_folders().iter().any(|folder| folder.join(name).exists())
    }

    fn has_vulkan_driver(&self) -> bool {
        if ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].iter().any(|name| std::env::var_os(name).is_some()) {
            return true;
        }
        let folders = [
            "/usr/share/vulkan/icd.d",
            "/etc/vulkan/icd.d",
            "/usr/local/share/vulkan/icd.d",
            "/run/opengl-driver/share/vulkan/icd.d",
        ];
        let drivers =
            folders.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten().filter_map(Result::ok);
        let names: Vec<_> = drivers.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        let has_device =
            ["/dev/dri/renderD128", "/dev/nvidia0"].iter().any(|device| Path::new(device).exists());
        has_working_driver(&names, has_device)
    }

    fn has_python(&self) -> bool {
        // Debian omits the module that installs pip in a virtual environment.
        output_of("python3", &["-c", "import venv, ensurepip"]).is_some()
    }

    fn has_program(&self, name: &str) -> bool {
        std::env::var_os("PATH")
            .is_some_and(|path| std::env::split_paths(&path).any(|folder| folder.join(name).is_file()))
    }

    fn distribution(&self) -> Vec<String> {
        let files = ["/etc/os-release", "/usr/lib/os-release"];
        distribution_ids(
            &files.into_iter().find_map(|file| fs::read_to_string(file).ok()).unwrap_or_default(),
        )
    }

    fn is_root(&self) -> bool {
        output_of("id", &["-u"]).is_some_and(|id| id.trim() == "0")
    }

    fn has_free_sudo(&self) -> bool {
        output_of("sudo", &["-n", "true"]).is_some()
    }

    fn can_ask_for_sudo(&self) -> bool {
        std::io::stdin().is_terminal()
            && std::io::stderr().is_terminal()
            && output_of("sudo", &["--version"]).is_some()
    }

    fn has_package_lists(&self) -> bool {
        let lists = fs::read_dir("/var/lib/apt/lists").into_iter().flatten().filter_map(Result::ok);
        lists.into_iter().any(|entry| entry.file_name().to_string_lossy().contains("_Packages"))
    }
}

/// Whether a driver can work: a software driver always can, any other needs its device.
fn has_working_driver(names: &[String], has_device: bool) -> bool {
    let json = |name: &&String| Path::new(name).extension().is_some_and(|extension| extension == "json");
    names.iter().filter(json).any(|name| name.starts_with("lvp_") || has_device)
}

/// `ID` and then `ID_LIKE` of an os-release file.
fn distribution_ids(os_release: &str) -> Vec<String> {
    let value = |key: &str| {
        let mut lines = os_release.lines().filter_map(|line| line.split_once('='));
        lines.find(|(name, _)| *name == key).map_or("", |(_, value)| value.trim_matches(['"', '\'']))
    };
    value("ID").split_whitespace().chain(value("ID_LIKE").split_whitespace()).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::{distribution_ids, has_working_driver, libraries_in_cache};

    #[test]
    fn the_loaders_cache_is_read_for_one_processor() {
        let cache = "2 libs found in cache `/etc/ld.so.cache'\n\
                     \tlibX11.so.6 (libc6,x86-64) => /lib/x86_64-linux-gnu/libX11.so.6\n\
                     \tlibXi.so.6 (libc6) => /lib/i386-linux-gnu/libXi.so.6\n";
        assert!(libraries_in_cache(cache, "x86_64").iter().eq(["libX11.so.6"]));
        assert!(libraries_in_cache(cache, "aarch64").is_empty());
        assert!(libraries_in_cache("", "x86_64").is_empty());
    }

    #[test]
    fn drivers_need_their_device_and_software_none() {
        let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
        assert!(has_working_driver(&names(&["intel_icd.x86_64.json", "lvp_icd.x86_64.json"]), false));
        assert!(!has_working_driver(&names(&["intel_icd.x86_64.json"]), false));
        assert!(has_working_driver(&names(&["nvidia_icd.json"]), true));
        assert!(!has_working_driver(&names(&["README"]), true));
    }

    #[test]
    fn distributions_name_themselves_and_their_kin() {
        let mint = "NAME=\"Linux Mint\"\nID=linuxmint\nID_LIKE=\"ubuntu debian\"\nVERSION_ID=\"22\"\n";
        assert_eq!(distribution_ids(mint), ["linuxmint", "ubuntu", "debian"]);
        assert_eq!(distribution_ids("ID='arch'\n"), ["arch"]);
        assert!(distribution_ids("").is_empty());
    }
}
