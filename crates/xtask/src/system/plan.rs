//! Decides how to install what is missing, from the results of a [`Probe`]. Nothing is changed here.

use super::needs::{Need, Test};

/// Tests of the machine.
pub(crate) trait Probe {
    /// Whether a C++ compiler works.
    fn has_cxx_compiler(&self) -> bool;
    /// Whether the dynamic loader finds a library.
    fn has_library(&self, name: &str) -> bool;
    /// Whether there is a usable Vulkan driver: a software driver, or one whose device exists.
    fn has_vulkan_driver(&self) -> bool;
    /// Whether Python 3 can make virtual environments.
    fn has_python(&self) -> bool;
    /// Whether a program is in one of the folders of `PATH`.
    fn has_program(&self, name: &str) -> bool;
    /// `ID` and `ID_LIKE` of os-release, in that order.
    fn distribution(&self) -> Vec<String>;
    /// Whether the user is the superuser.
    fn is_root(&self) -> bool;
    /// Whether sudo works without a password.
    fn has_free_sudo(&self) -> bool;
    /// Whether sudo is installed and a user can enter the password.
    fn can_ask_for_sudo(&self) -> bool;
    /// Whether apt-get has lists of packages.
    fn has_package_lists(&self) -> bool;
}

/// Distributions that share names of packages, in the order of [`Need::packages`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Family {
    Debian,
    Fedora,
    Arch,
    Suse,
    Alpine,
}

impl Family {
    fn of(ids: &[String]) -> Option<Self> {
        ids.iter().find_map(|id| match id.as_str() {
            "debian" | "ubuntu" => Some(Self::Debian),
            "fedora" | "rhel" | "centos" => Some(Self::Fedora),
            "arch" => Some(Self::Arch),
            "suse" | "opensuse" => Some(Self::Suse),
            "alpine" => Some(Self::Alpine),
            _ => None,
        })
    }

    /// The command for installing, without the packages.
    fn install(self) -> &'static [&'static str] {
        match self {
            Self::Debian => &["apt-get", "install", "-y", "--no-install-recommends"],
            Self::Fedora => &["dnf", "install", "-y"],
            Self::Arch => &["pacman", "-S", "--needed"],
            Self::Suse => &["zypper", "install"],
            Self::Alpine => &["apk", "add"],
        }
    }
}

/// How to become the superuser.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rights {
    /// The user is the superuser already.
    Root,
    /// `sudo -n`, without a password.
    FreeSudo,
    /// `sudo`, which prompts for a password.
    AskingSudo,
}

/// What to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Step {
    /// Install these packages, on Debian and related distributions.
    Install { rights: Rights, update_first: bool, packages: Vec<&'static str> },
    /// Print this command for the user.
    Say { command: String },
    /// Print what is missing, because the names of the packages are not known for this distribution.
    Name,
}

/// What is missing, and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Plan {
    pub(crate) missing: Vec<Need>,
    pub(crate) step: Step,
}

impl Plan {
    /// Whether building is not possible without the missing packages.
    pub(crate) fn stops_the_build(&self) -> bool {
        self.missing.iter().any(|need| need.to_build)
    }
}

/// Tests everything on the list. `None` if nothing is missing.
pub(crate) fn plan(probe: &dyn Probe, needs: &[Need]) -> Option<Plan> {
    let there = |need: &Need| match need.test {
        Test::CxxCompiler => probe.has_cxx_compiler(),
        Test::Library(name) => probe.has_library(name),
        Test::VulkanDriver => probe.has_vulkan_driver(),
        Test::Python => probe.has_python(),
        Test::Program(name) => probe.has_program(name),
    };
    let missing: Vec<Need> = needs.iter().copied().filter(|need| !there(need)).collect();
    if missing.is_empty() {
        return None;
    }
    let Some(family) = Family::of(&probe.distribution()) else {
        return Some(Plan { missing, step: Step::Name });
    };
    let mut packages = Vec::new();
    for need in &missing {
        let package = need.packages[family as usize];
        if !packages.contains(&package) {
            packages.push(package);
        }
    }
    let rights = if probe.is_root() {
        Some(Rights::Root)
    } else if family == Family::Debian && probe.has_free_sudo() {
        Some(Rights::FreeSudo)
    } else if family == Family::Debian && probe.can_ask_for_sudo() {
        Some(Rights::AskingSudo)
    } else {
        None
    };
    let step = if let (Family::Debian, Some(rights)) = (family, rights) {
        let update_first = !probe.has_package_lists();
        Step::Install { rights, update_first, packages }
    } else {
        let sudo = if probe.is_root() { "" } else { "sudo " };
        let update = if family == Family::Debian && !probe.has_package_lists() {
            format!("{sudo}apt-get update && ")
        } else {
            String::new()
        };
        let command = [family.install(), &packages].concat().join(" ");
        Step::Say { command: format!("{update}{sudo}{command}") }
    };
    Some(Plan { missing, step })
}

#[cfg(test)]
mod tests {
    use super::super::needs::{BROWSER, COUNT, INTERCHANGE, NEEDS};
    use super::{Family, Plan, Probe, Rights, Step, Test};

    /// A simulated machine.
    #[expect(clippy::struct_excessive_bools, reason = "each is the result of one test of the probe")]
    struct Machine {
        compiler: bool,
        driver: bool,
        libraries: bool,
        without: &'static str,
        ids: &'static [&'static str],
        root: bool,
        free_sudo: bool,
        asking_sudo: bool,
        lists: bool,
    }

    const WHOLE: Machine = Machine {
        compiler: true,
        driver: true,
        libraries: true,
        without: "",
        ids: &["debian"],
        root: false,
        free_sudo: false,
        asking_sudo: false,
        lists: true,
    };

    impl Probe for Machine {
        fn has_cxx_compiler(&self) -> bool {
            self.compiler
        }
        fn has_library(&self, name: &str) -> bool {
            self.libraries && name != self.without
        }
        fn has_vulkan_driver(&self) -> bool {
            self.driver
        }
        fn has_python(&self) -> bool {
            self.compiler
        }
        fn has_program(&self, _name: &str) -> bool {
            self.compiler
        }
        fn distribution(&self) -> Vec<String> {
            self.ids.iter().map(|&id| id.to_owned()).collect()
        }
        fn is_root(&self) -> bool {
            self.root
        }
        fn has_free_sudo(&self) -> bool {
            self.free_sudo
        }
        fn can_ask_for_sudo(&self) -> bool {
            self.asking_sudo
        }
        fn has_package_lists(&self) -> bool {
            self.lists
        }
    }

    fn plan(probe: &dyn Probe) -> Option<Plan> {
        super::plan(probe, &NEEDS)
    }

    #[test]
    fn a_whole_machine_needs_nothing() {
        assert_eq!(plan(&WHOLE), None);
        assert_eq!(plan(&Machine { ids: &[], ..WHOLE }), None);
    }

    #[test]
    fn a_bare_debian_gets_everything_as_root() {
        let bare =
            Machine { compiler: false, driver: false, libraries: false, root: true, lists: false, ..WHOLE };
        let plan = plan(&bare).unwrap();
        assert!(plan.stops_the_build());
        assert_eq!(plan.missing.len(), NEEDS.len());
        let packages = NEEDS.map(|need| need.packages[Family::Debian as usize]).to_vec();
        assert_eq!(plan.step, Step::Install { rights: Rights::Root, update_first: true, packages });
    }

    #[test]
    fn ubuntu_and_its_kin_are_debian_and_sudo_is_used_as_far_as_it_goes() {
        let machine =
            Machine { without: "libXcursor.so.1", ids: &["linuxmint", "ubuntu", "debian"], ..WHOLE };
        let install = |rights| Step::Install { rights, update_first: false, packages: vec!["libxcursor1"] };
        let with = |free_sudo, asking_sudo| plan(&Machine { free_sudo, asking_sudo, ..machine }).unwrap();
        assert_eq!(with(true, true).step, install(Rights::FreeSudo));
        assert_eq!(with(false, true).step, install(Rights::AskingSudo));
        let command = "sudo apt-get install -y --no-install-recommends libxcursor1".to_owned();
        assert_eq!(with(false, false).step, Step::Say { command });
        assert!(!with(false, false).stops_the_build(), "a library of the window does not prevent building");
    }

    #[test]
    fn elsewhere_the_exact_command_is_said() {
        let say = |ids, root| {
            let machine = Machine { compiler: false, libraries: false, ids, root, free_sudo: true, ..WHOLE };
            match plan(&machine) {
                Some(Plan { step: Step::Say { command }, .. }) => command,
                other => panic!("{other:?}"),
            }
        };
        let fedora = say(&["nobara", "fedora"], false);
        assert!(fedora.starts_with("sudo dnf install -y gcc-c++ vulkan-loader libX11 "), "{fedora}");
        let arch = say(&["arch"], true);
        assert!(arch.starts_with("pacman -S --needed gcc vulkan-icd-loader libx11 libxcursor "), "{arch}");
        assert_eq!(arch.matches(" libx11").count(), 1, "each package is listed once");
        assert!(
            say(&["opensuse-leap", "suse", "opensuse"], false)
                .starts_with("sudo zypper install gcc-c++ libvulkan1 ")
        );
        assert!(say(&["alpine"], true).starts_with("apk add g++ vulkan-loader libx11 "));
    }

    #[test]
    fn an_unknown_system_is_told_what_is_missing() {
        let plan = plan(&Machine { driver: false, ids: &["plan9"], root: true, ..WHOLE }).unwrap();
        assert_eq!(plan.step, Step::Name);
        assert_eq!(plan.missing.iter().map(|need| need.test).collect::<Vec<_>>(), [Test::VulkanDriver]);
    }

    #[test]
    fn a_chore_asks_for_what_it_needs_alone() {
        let bare = Machine { compiler: false, libraries: false, root: true, ..WHOLE };
        let packages = |needs| match super::plan(&bare, needs) {
            Some(Plan { step: Step::Install { packages, .. }, .. }) => packages,
            other => panic!("{other:?}"),
        };
        let wanted = [
            "python3-venv",
            "libegl1",
            "libgl1",
            "libxrender1",
            "libsm6",
            "libxi6",
            "libxxf86vm1",
            "libxfixes3",
            "libxkbcommon0",
        ];
        assert_eq!(packages(&INTERCHANGE), wanted);
        assert_eq!(packages(&BROWSER), ["chromium"]);
        assert_eq!(packages(&COUNT), ["valgrind"]);
        assert_eq!(super::plan(&WHOLE, &INTERCHANGE), None);
    }

    #[test]
    fn missing_lists_are_fetched_first_and_said_so() {
        let machine = Machine { compiler: false, lists: false, ..WHOLE };
        let command = "sudo apt-get update && sudo apt-get install -y --no-install-recommends g++".to_owned();
        assert_eq!(plan(&machine).unwrap().step, Step::Say { command });
    }
}
