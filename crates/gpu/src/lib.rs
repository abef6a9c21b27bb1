//! The wgpu device, shader composition, typed buffers, readback and timers.
