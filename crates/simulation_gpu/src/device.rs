//! The device that advances guides.

use std::sync::Arc;

use lovelock_gpu::{Gpu, GpuError, Kernel, PassTimer, PooledBuffer, Readback, read_buffer, wgpu};
use lovelock_simulation::Integrator;
use lovelock_simulation::device::{DeviceOutcome, DeviceStep, Reads, SLOTS, SlotContact, Stamp, StepDevice};

use crate::buffers::{Buffers, CONTACT_WORDS, Sizes, cells, grid_words};
use crate::kernels::GuideKernels;
use crate::publish::Publisher;
use crate::uniform::{StepUniform, SubstepUniform, samples};

/// Advances the guides of one simulation on a graphics device.
///
/// It keeps the state of its simulation from step to step and uploads it again only where something else has changed it.
#[derive(Debug)]
pub struct GuideDevice {
    kernels: Arc<GuideKernels>,
    gpu: Arc<Gpu>,
    buffers: Buffers,
    timer: PassTimer,
    readback: Readback,
    bytes: [Vec<u8>; 3],
    outcome: DeviceOutcome,
    /// The whole state, as it was read last.
    state: Vec<f32>,
    publisher: Option<Publisher>,
    /// The state at the end of the step that was begun.
    begun: Option<Stamp>,
    is_lost: bool,
    has_room: bool,
}

impl GuideDevice {
    /// A device without guides.
    pub fn new(kernels: Arc<GuideKernels>) -> Self {
        // Counters and constants of its own.
        let gpu = kernels.gpu.handle();
        Self {
            buffers: Buffers::new(&gpu),
            kernels,
            gpu,
            timer: PassTimer::off(),
            readback: Readback::default(),
            bytes: Default::default(),
            outcome: DeviceOutcome::default(),
            state: Vec::new(),
            publisher: None,
            begun: None,
            is_lost: false,
            has_room: true,
        }
    }

    /// The device with a copy of the guides of each step for renderers on it; see [`GuideDevice::guides`].
    #[must_use]
    pub fn publishing(mut self) -> Self {
        self.publisher = Some(Publisher::new(&self.gpu));
        self
    }

    /// The device, by the handle that its kernels were compiled for.
    pub fn gpu(&self) -> &Gpu {
        self.kernels.gpu()
    }

    /// Whether renderers on the device can draw its guides.
    pub fn publishes(&self) -> bool {
        self.publisher.is_some()
    }

    /// The guides of `state` in world space, metres: all x, then all y, then all z, in the order of the hairstyle. `None` if the last step had
    /// another state, or the device does not publish them.
    pub fn guides(&self, state: Stamp) -> Option<PooledBuffer> {
        self.publisher.as_ref()?.guides(state)
    }

    /// Whether the graphics device was lost. It then advances nothing any more.
    pub fn is_lost(&self) -> bool {
        self.is_lost
    }

    /// Whether the graphics device has room for the guides of the last step. Fewer may fit where it has none.
    pub fn has_room(&self) -> bool {
        self.has_room
    }

    /// Submits a step and copying its outcome to memory.
    fn submit(&mut self, step: &DeviceStep, reads: Reads) -> Result<(), GpuError> {
        let (blocks, points) = (step.blocks() as u64, step.points() as u64);
        let slots = blocks * SLOTS as u64;
        let sizes = Sizes::of(blocks, points, step.first_free() as u64, step.colliders() as u64);
        if let Some(refusal) = sizes.refusal(slots, self.gpu.most_storage_bytes()) {
            return Err(GpuError::Input(refusal));
        }
        let Self { kernels, gpu, buffers, timer, readback, publisher, .. } = self;
        let (kernels, shared): (&GuideKernels, &Arc<Gpu>) = (kernels, gpu);
        let gpu: &Gpu = shared;
        let (offsets, stale) = buffers.fill(gpu, step, sizes);
        let stride = step.lattice().2 as u64;
        let pieces = (points - 1).div_ceil(stride);
        let mut commands = timer.begin(gpu, "simulation");
        let uniform = commands.constants("step", &StepUniform::new(step, &offsets));
        let substeps: Vec<wgpu::Buffer> = (0..step.substeps())
            .map(|s| {
                let substep = SubstepUniform {
                    index: s as u32,
                    checks_factor: u32::from(step.checks_factor(s)),
                    is_last: u32::from(s + 1 == step.substeps()),
                    passed: (s + 1) as f32 / step.substeps() as f32,
                };
                commands.constants("substep", &substep)
            })
            .collect();
        let bound = |kernel: &Kernel, substep: &wgpu::Buffer| {
            let Buffers { state, work, rest, matrix, grid, density, field, body, frame, report, .. } =
                &*buffers;
            kernel.bind(
                gpu,
                &[
                    (0, uniform.as_entire_binding()),
                    (1, substep.as_entire_binding()),
                    (2, state.raw().as_entire_binding()),
                    (3, work.raw().as_entire_binding()),
                    (4, rest.raw().as_entire_binding()),
                    (5, matrix.raw().as_entire_binding()),
                    (6, grid.raw().as_entire_binding()),
                    (7, field.raw().as_entire_binding()),
                    (8, body.raw().as_entire_binding()),
                    (9, frame.raw().as_entire_binding()),
                    (10, report.raw().as_entire_binding()),
                    (11, density.raw().as_entire_binding()),
                ],
            )
        };
        let numbers = slots * points;
        let of_step = [
            (&kernels.clear_grid, grid_words()),
            (&kernels.deposit, slots * pieces),
            (&kernels.gather, cells()),
            (&kernels.sample_grid, slots * samples(points as usize, stride as usize) as u64),
            (&kernels.prepare, numbers),
            (&kernels.forget_planes, numbers),
        ];
        let of_matrices = [(&kernels.factorise, slots), (&kernels.response, slots)];
        // The planes of the field serve nothing without it, and follow-the-leader does not know yet where points will be.
        let prefetches = step.field().is_some() && step.integrator() != Integrator::FollowTheLeader;
        let of_substep = [
            (&kernels.forces, numbers),
            (&kernels.bend, slots),
            (&kernels.hold_together, numbers),
            (&kernels.lengths, slots),
            (&kernels.prefetch, if prefetches { numbers } else { 0 }),
            (&kernels.place_points, slots),
        ];
        commands.compute("simulate", |pass| {
            let Some(first) = substeps.first() else { return };
            for (kernel, threads) in &of_step {
                kernel.run(pass, &bound(kernel, first), *threads);
            }
            if stale {
                for (kernel, threads) in &of_matrices {
                    kernel.run(pass, &bound(kernel, first), *threads);
                }
            }
            for substep in &substeps {
                for (kernel, threads) in &of_substep {
                    kernel.run(pass, &bound(kernel, substep), *threads);
                }
            }
        });
        if let Some(publisher) = publisher {
            publisher.run(shared, kernels, &mut commands, step, buffers.state.raw());
        }
        let parts = [
            (buffers.state.raw(), 4 * numbers * reads.rows() as u64),
            (buffers.report.raw(), 4 * slots * CONTACT_WORDS),
            (buffers.grid.raw(), 8),
        ];
        readback.copy(gpu, commands.encoder(), &parts);
        commands.submit();
        readback.ask(gpu);
        self.begun = Some(step.state_after());
        Ok(())
    }

    /// Waits for the outcome of the step that was submitted.
    fn read_outcome(&mut self) -> Result<(), GpuError> {
        let Self { gpu, buffers, readback, bytes, outcome, .. } = self;
        let Some(after) = self.begun.take() else {
            return Err(GpuError::Input("no step has begun on the graphics device".to_owned()));
        };
        let [state, contacts, totals] = bytes;
        readback.read(gpu, &mut [&mut *state, &mut *contacts, &mut *totals])?;
        buffers.known.state = Some(after);
        outcome.state.resize(state.len() / 4, 0.0);
        bytemuck::cast_slice_mut::<f32, u8>(&mut outcome.state).copy_from_slice(state);
        outcome.contacts.clear();
        outcome.contacts.extend(contacts.chunks_exact(4 * CONTACT_WORDS as usize).map(contact));
        let mut totals = words(totals);
        outcome.over_dense_cells = totals.next().unwrap_or_default();
        outcome.fullness = totals.next().unwrap_or_default();
        Ok(())
    }

    /// The reason of a failure, after noting what it means for later steps.
    fn failed(&mut self, error: &GpuError) -> String {
        self.is_lost |= matches!(error, GpuError::Lost(_)) || self.gpu.is_lost();
        self.begun = None;
        if let Some(publisher) = &mut self.publisher {
            publisher.forget();
        }
        error.to_string()
    }
}

/// The contacts of a slot from its bytes.
fn contact(bytes: &[u8]) -> SlotContact {
    let mut words = words(bytes);
    let mut next = || words.next().unwrap_or_default();
    SlotContact {
        depth_m: f32::from_bits(next()),
        point: next(),
        collider: next(),
        unsure: next(),
        first_unsure: next(),
    }
}

/// The words that bytes of the device contain.
fn words(bytes: &[u8]) -> impl Iterator<Item = u32> {
    bytes.as_chunks().0.iter().map(|bytes| u32::from_ne_bytes(*bytes))
}

impl StepDevice for GuideDevice {
    fn begin(&mut self, step: &DeviceStep, reads: Reads) -> Result<(), String> {
        if self.is_lost {
            return Err("the graphics device was lost".to_owned());
        }
        // On the window's device, others use the queue too.
        let gpu = Arc::clone(&self.gpu);
        let done = gpu.apart(|| self.submit(step, reads)).unwrap_or_else(|error| {
            if gpu.is_lost() {
                gpu.check()?;
            }
            Err(GpuError::Refused(error.to_string()))
        });
        self.has_room = !matches!(done, Err(GpuError::Input(_)));
        done.map_err(|error| self.failed(&error))
    }

    fn finish(&mut self) -> Result<&DeviceOutcome, String> {
        match self.read_outcome() {
            Ok(()) => Ok(&self.outcome),
            Err(error) => Err(self.failed(&error)),
        }
    }

    fn holds(&self, state: Stamp) -> bool {
        !self.is_lost && self.begun.is_none() && self.buffers.known.state == Some(state)
    }

    fn read_state(&mut self) -> Result<&[f32], String> {
        let Some(sizes) = self.buffers.known.sizes.filter(|_| self.buffers.known.state.is_some()) else {
            return Err("the graphics device holds no state".to_owned());
        };
        self.state.resize(sizes.state as usize, 0.0);
        match read_buffer(&self.gpu, self.buffers.state.raw(), &mut self.state) {
            Ok(()) => Ok(&self.state),
            Err(error) => Err(self.failed(&error)),
        }
    }
}
