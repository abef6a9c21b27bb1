//! What Lovelock needs of the system, and what each distribution calls it.

/// One thing that may be missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Need {
    /// What it is, for people.
    pub(crate) what: &'static str,
    /// How to see whether it is there.
    pub(crate) test: Test,
    /// Whether nothing can be built without it. The rest can be missing: the window or the GPU pictures then are.
    pub(crate) to_build: bool,
    /// The package's name, by [`Family`](super::plan::Family): Debian, Fedora, Arch, openSUSE, Alpine.
    pub(crate) packages: [&'static str; 5],
}

/// How to see whether something is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Test {
    /// A C++ compiler that answers.
    CxxCompiler,
    /// A shared library that the dynamic loader knows by this name.
    Library(&'static str),
    /// A Vulkan driver: a software one, or one for a device that is there.
    VulkanDriver,
    /// A Python 3 that can make virtual environments.
    Python,
    /// A program in one of the folders of `PATH`.
    Program(&'static str),
}

/// A library that is opened at run time, when the window opens.
const fn library(what: &'static str, name: &'static str, packages: [&'static str; 5]) -> Need {
    Need { what, test: Test::Library(name), to_build: false, packages }
}

/// What `cargo xtask test --interchange` needs beyond [`NEEDS`].
pub(crate) const INTERCHANGE: [Need; 1] = [Need {
    what: "Python 3 with virtual environments",
    test: Test::Python,
    to_build: true,
    packages: ["python3-venv", "python3", "python", "python3", "python3"],
}];

/// What `cargo xtask test --browser` needs beyond [`NEEDS`].
pub(crate) const BROWSER: [Need; 1] = [Need {
    what: "the browser Chromium",
    test: Test::Program("chromium"),
    to_build: true,
    packages: ["chromium", "chromium", "chromium", "chromium", "chromium"],
}];

/// What `cargo xtask latency` needs beyond [`NEEDS`].
pub(crate) const SCREEN: [Need; 1] = [Need {
    what: "a screen without a monitor (Xvfb)",
    test: Test::Program("Xvfb"),
    to_build: true,
    packages: ["xvfb", "xorg-x11-server-Xvfb", "xorg-server-xvfb", "xorg-x11-server-Xvfb", "xvfb"],
}];

/// What building, testing and the window need. The names of the libraries are those that the crates open: winit by x11-dl (Xlib, Xcursor, Xlib-xcb,
/// Xinput2), xkbcommon-dl and wayland-sys, rfd for its dialogs (D-Bus), wgpu by ash (Vulkan).
pub(crate) const NEEDS: [Need; 11] = [
    Need {
        what: "a C++ compiler (for the H.264 encoder)",
        test: Test::CxxCompiler,
        to_build: true,
        packages: ["g++", "gcc-c++", "gcc", "gcc-c++", "g++"],
    },
    library(
        "the Vulkan loader",
        "libvulkan.so.1",
        ["libvulkan1", "vulkan-loader", "vulkan-icd-loader", "libvulkan1", "vulkan-loader"],
    ),
    Need {
        what: "a software driver for Vulkan",
        test: Test::VulkanDriver,
        to_build: false,
        packages: [
            "mesa-vulkan-drivers",
            "mesa-vulkan-drivers",
            "vulkan-swrast",
            "libvulkan_lvp",
            "mesa-vulkan-swrast",
        ],
    },
    library("Xlib", "libX11.so.6", ["libx11-6", "libX11", "libx11", "libX11-6", "libx11"]),
    library(
        "Xlib for XCB",
        "libX11-xcb.so.1",
        ["libx11-xcb1", "libX11-xcb", "libx11", "libX11-xcb1", "libx11"],
    ),
    library(
        "X cursors",
        "libXcursor.so.1",
        ["libxcursor1", "libXcursor", "libxcursor", "libXcursor1", "libxcursor"],
    ),
    library("X input", "libXi.so.6", ["libxi6", "libXi", "libxi", "libXi6", "libxi"]),
    library(
        "keyboard layouts",
        "libxkbcommon.so.0",
        ["libxkbcommon0", "libxkbcommon", "libxkbcommon", "libxkbcommon0", "libxkbcommon"],
    ),
    library(
        "keyboard layouts for X",
        "libxkbcommon-x11.so.0",
        [
            "libxkbcommon-x11-0",
            "libxkbcommon-x11",
            "libxkbcommon-x11",
            "libxkbcommon-x11-0",
            "libxkbcommon-x11",
        ],
    ),
    library(
        "the Wayland client",
        "libwayland-client.so.0",
        ["libwayland-client0", "libwayland-client", "wayland", "libwayland-client0", "wayland-libs-client"],
    ),
    library(
        "D-Bus (for file dialogs)",
        "libdbus-1.so.3",
        ["libdbus-1-3", "dbus-libs", "dbus", "libdbus-1-3", "dbus-libs"],
    ),
];
