//! Lovelock: interactive hair.

mod cli;
mod failure;
mod window;

use std::io::IsTerminal;
use std::process::ExitCode;

use tracing_subscriber::filter::Targets;
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::util::SubscriberInitExt as _;

/// Gives freed memory back. The allocator of the system keeps it in one arena for each of many threads, and a window that is used for hours
/// would grow.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    without_display_messages();
    // Messages of graphics drivers while adapters are probed, and of readers of sound while a format is guessed, are not errors of this program.
    let quiet = "error,wgpu=off,wgpu_core=off,wgpu_hal=off,naga=off,symphonia=off";
    let asked = std::env::var("LOVELOCK_LOG").ok().and_then(|asked| asked.parse::<Targets>().ok());
    tracing_subscriber::registry()
        .with(
            tracing_subscriber::fmt::layer()
                .with_ansi(std::io::stderr().is_terminal())
                .with_writer(std::io::stderr),
        )
        .with(asked.unwrap_or_else(|| quiet.parse().expect("the levels are written above")))
        .init();
    failure::install();
    lovelock_session::threads::name_workers();
    cli::run()
}

/// Starts the program again with Mesa's choice of devices by display switched off, if there is no display. Otherwise that layer prints
/// `error: XDG_RUNTIME_DIR is invalid or not set in the environment.` whenever adapters are listed, although nothing fails.
///
/// The variable must be set before the driver is loaded, and setting it in the running process is unsafe.
#[cfg(target_os = "linux")]
fn without_display_messages() {
    use std::os::unix::process::CommandExt as _;

    const SWITCHED_OFF: &str = "NODEVICE_SELECT";
    let displays = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET", "XDG_RUNTIME_DIR", SWITCHED_OFF];
    if displays.iter().any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty())) {
        return;
    }
    if let Ok(program) = std::env::current_exe() {
        // Returns only if it fails; then the program goes on as it is.
        let _ = std::process::Command::new(program)
            .args(std::env::args_os().skip(1))
            .env(SWITCHED_OFF, "1")
            .exec();
    }
}

#[cfg(not(target_os = "linux"))]
fn without_display_messages() {}
