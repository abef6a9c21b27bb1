//! Lovelock: hair styled, simulated, shadowed and judged live.

mod cli;
mod window;

use std::io::IsTerminal;
use std::process::ExitCode;

fn main() -> ExitCode {
    // What graphics drivers say while adapters are tried is no error of this program.
    let quiet = "error,wgpu=off,wgpu_core=off,wgpu_hal=off,naga=off";
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
