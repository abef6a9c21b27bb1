//! The system packages that Lovelock needs, with their names in each distribution.

/// A requirement that may be missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Need {
    /// Description for the user.
    pub(crate) what: &'static str,
    /// How to test whether it is installed.
    pub(crate) test: Test,
    /// Whether building needs it. Without the other requirements only the window or GPU rendering does not work.
    pub(crate) to_build: bool,
    /// The package's name, by [`Family`](super::plan::Family): Debian, Fedora, Arch, openSUSE, Alpine.
    pub(crate) packages: [&'static str; 5],
}

/// How to test whether a requirement is installed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Test {
    /// A working C++ compiler.
    CxxCompiler,
    /// A shared library that the dynamic loader finds by this name.
    Library(&'static str),
    /// A Vulkan driver: a software driver, or one whose device exists.
    VulkanDriver,
    /// Python 3 with virtual environments.
    Python,
    /// A program in one of the folders of `PATH`.
    Program(&'static str),
}

/// A library that is loaded at run time, when the window opens.
const fn library(what: &'static str, name: &'static str, packages: [&'static str; 5]) -> Need {
    Need { what, test: Test::Library(name), to_build: false, packages }
}

const X_INPUT: Need = library("X input", "libXi.so.6", ["libxi6", "libXi", "libxi", "libXi6", "libxi"]);

const KEYBOARD: Need = library(
    "keyboard layouts",
    "libxkbcommon.so.0",
    ["libxkbcommon0", "libxkbcommon", "libxkbcommon", "libxkbcommon0", "libxkbcommon"],
);

/// The additional requirements of `cargo xtask test --interchange`: Python, and the libraries that Blender's package loads.
pub(crate) const INTERCHANGE: [Need; 9] = [
    Need {
        what: "Python 3 with virtual environments",
        test: Test::Python,
        to_build: true,
        packages: ["python3-venv", "python3", "python", "python3", "python3"],
    },
    library("EGL", "libEGL.so.1", ["libegl1", "libglvnd-egl", "libglvnd", "Mesa-libEGL1", "mesa-egl"]),
    library("OpenGL", "libGL.so.1", ["libgl1", "libglvnd-glx", "libglvnd", "Mesa-libGL1", "mesa-gl"]),
    library(
        "X rendering",
        "libXrender.so.1",
        ["libxrender1", "libXrender", "libxrender", "libXrender1", "libxrender"],
    ),
    library("X sessions", "libSM.so.6", ["libsm6", "libSM", "libsm", "libSM6", "libsm"]),
    X_INPUT,
    library(
        "X video modes",
        "libXxf86vm.so.1",
        ["libxxf86vm1", "libXxf86vm", "libxxf86vm", "libXxf86vm1", "libxxf86vm"],
    ),
    library("X fixes", "libXfixes.so.3", ["libxfixes3", "libXfixes", "libxfixes", "libXfixes3", "libxfixes"]),
    KEYBOARD,
];

/// The additional requirement of `cargo xtask test --browser`.
pub(crate) const BROWSER: [Need; 1] = [Need {
    what: "the browser Chromium",
    test: Test::Program("chromium"),
    to_build: true,
    packages: ["chromium", "chromium", "chromium", "chromium", "chromium"],
}];

/// The additional requirement of `cargo xtask latency`.
pub(crate) const SCREEN: [Need; 1] = [Need {
    what: "a virtual screen (Xvfb)",
    test: Test::Program("Xvfb"),
    to_build: true,
    packages: ["xvfb", "xorg-x11-server-Xvfb", "xorg-server-xvfb", "xorg-x11-server-Xvfb", "xvfb"],
}];

/// The additional requirement of `cargo xtask pictures` for images out of films.
pub(crate) const FILM: [Need; 1] = [Need {
    what: "ffmpeg",
    test: Test::Program("ffmpeg"),
    to_build: true,
    packages: ["ffmpeg", "ffmpeg-free", "ffmpeg", "ffmpeg", "ffmpeg"],
}];

/// The additional requirement of `cargo xtask package --try`.
pub(crate) const TRIAL: [Need; 1] = [Need {
    what: "debootstrap",
    test: Test::Program("debootstrap"),
    to_build: true,
    packages: ["debootstrap", "debootstrap", "debootstrap", "debootstrap", "debootstrap"],
}];

/// The additional requirement of `cargo xtask count`.
pub(crate) const COUNT: [Need; 1] = [Need {
    what: "valgrind",
    test: Test::Program("valgrind"),
    to_build: true,
    packages: ["valgrind", "valgrind", "valgrind", "valgrind", "valgrind"],
}];

/// The requirements of building, testing and the window. The names of the libraries are those that these crates load: winit
/// through x11-dl (Xlib, Xcursor, Xlib-xcb, Xinput2), xkbcommon-dl and wayland-sys, rfd for its dialogs (D-Bus), wgpu through
/// ash (Vulkan).
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
    X_INPUT,
    KEYBOARD,
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
