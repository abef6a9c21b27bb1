//! The simulation of guides on the graphics card.
//!
//! A [`GuideDevice`] does the part of a step of [`lovelock_simulation::Simulation`] that costs most: it advances all guides
//! from the state of the last step, by the same definition, with all integrators. Everything that all guides share is
//! prepared by the simulator, and after the step the state is in the simulator again, or at least what moves, so that
//! takes, brushes, ties and saved states work as on the CPU.
//!
//! In a window, a device may be that of the renderer: then the guides of a step are drawn from its memory, and a step is begun while the
//! one before it is drawn ([`GuideDevice::publishing`], [`lovelock_simulation::Simulation::begin_on`]).
//!
//! A step is a list of kernels over points, pieces, cells or guides. The constants of the definition come
//! from the simulator by name, as values of the shaders' `override`s.

mod buffers;
mod device;
mod kernels;
mod publish;
mod uniform;

pub use device::GuideDevice;
pub use kernels::{GuideKernels, shaders};

/// The least number of guides for which the choice *automatic* uses a graphics card.
///
/// A guide is one thread, and its thirty links are a serial chain, so few guides leave most of a card idle. A CPU advances 400
/// guides in about a millisecond on two cores, and its time grows with their number. The limit is an estimate: no step has been
/// timed on a card yet. `lovelock bench simulate-1k simulate-10k` with `--simulate cpu` and `gpu` measures both.
pub const MIN_GUIDES: usize = 2000;
