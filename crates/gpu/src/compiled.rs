//! Compiled kernels of a device. Its handles share them, so a second renderer or pane waits for no compiler.

use std::collections::{BTreeSet, VecDeque};
use std::sync::{Mutex, PoisonError};

use xxhash_rust::xxh3::xxh3_128;

/// The most that are kept: several times as many as the shadow methods and a renderer have. Versions of a shader that is being edited push
/// out what was not used for longest.
pub(crate) const MOST: usize = 512;

/// What a kernel is compiled from.
#[derive(Debug, Eq, PartialEq)]
pub(crate) struct Origin {
    /// The hash of the text.
    text: u128,
    entry: String,
    /// Names and bits of the values.
    constants: Vec<(&'static str, u64)>,
}

impl Origin {
    /// An entry point of a shader's text with values for its `override`s.
    pub(crate) fn new(text: &str, entry: &str, constants: &[(&'static str, f64)]) -> Self {
        // Passes of a method get the constants of all. One whose name a shader does not contain changes nothing there.
        let used = constants.iter().filter(|(name, _)| text.contains(name));
        Self {
            text: xxh3_128(text.as_bytes()),
            entry: entry.to_owned(),
            constants: used.map(|(name, value)| (*name, value.to_bits())).collect(),
        }
    }
}

/// A compute pipeline, the layout of its bindings in group 0, and the numbers of those that it uses.
#[derive(Clone, Debug)]
pub(crate) struct Compiled {
    pub(crate) pipeline: wgpu::ComputePipeline,
    pub(crate) layout: wgpu::BindGroupLayout,
    pub(crate) used: BTreeSet<u32>,
}

/// The kernels of a device, in the order of their last use.
#[derive(Debug, Default)]
pub(crate) struct CompiledKernels(Mutex<VecDeque<(Origin, Compiled)>>);

impl CompiledKernels {
    /// The kernel of that origin, from before or made now. What cannot be made is not kept.
    pub(crate) fn get<E>(
        &self,
        origin: Origin,
        compile: impl FnOnce() -> Result<Compiled, E>,
    ) -> Result<Compiled, E> {
        if let Some(known) = self.find(&origin) {
            return Ok(known);
        }
        // Others are not kept waiting meanwhile: two that compile the same both succeed.
        let compiled = compile()?;
        self.keep(origin, compiled.clone());
        Ok(compiled)
    }

    fn find(&self, origin: &Origin) -> Option<Compiled> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let at = kept.iter().position(|(known, _)| known == origin)?;
        let found = kept.remove(at)?;
        let compiled = found.1.clone();
        kept.push_back(found);
        Some(compiled)
    }

    pub(crate) fn keep(&self, origin: Origin, compiled: Compiled) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.retain(|(known, _)| *known != origin);
        if kept.len() >= MOST {
            kept.pop_front();
        }
        kept.push_back((origin, compiled));
    }

    #[cfg(test)]
    pub(crate) fn len(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).len()
    }
}
