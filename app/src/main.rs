//! Lovelock: interactive hair.

mod cli;
mod window;

use std::io::IsTerminal;
use std::process::ExitCode;

fn main() -> ExitCode {
    // Messages of graphics drivers while adapters are probed, and of readers of sound while a format is guessed, are not errors of this program.
    let quiet = "error,wgpu=off,wgpu_core=off,wgpu_hal=off,naga=off,symphonia=off";
    tracing_subscriber::fmt()
        .with_env_filter(
            tracing_subscriber::EnvFilter::try_from_env("LOVELOCK_LOG")
                .unwrap_or_else(|_| tracing_subscriber::EnvFilter::new(quiet)),
        )
        .with_ansi(std::io::stderr().is_terminal())
        .with_writer(std::io::stderr)
        .init();
    lovelock_session::threads::name_workers();
    cli::run()
}
