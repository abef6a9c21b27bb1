//! The style of hair as a stack of operations.
//!
//! A [`StyleStack`] changes a hairstyle, grown or imported, layer by layer. A [`Layer`] is an [`Operation`] with a weight, a [`Mask`] over the
//! scalp and a [`Ramp`] along the strand. [`StyleCache`] applies a stack, and after a change only what depends on it.
//!
//! A new operation is a file in `operations` and a name in the table of [`operation`].

mod cord;
mod evaluate;
mod guides;
pub mod hand;
mod mask;
mod morph;
mod motion;
mod operate;
pub mod operation;
pub mod operations;
mod ramp;
mod scope;
mod stack;
mod stored;
mod strands;

pub use evaluate::{StyleCache, Styled, apply_layer};
pub use mask::{BrushMode, HeadBox, Mask, MaskBrush, MaskMap, MaskMix, MaskPart, MaskRegion};
pub use morph::Morph;
pub use operate::{AnyOperation, Kind, Operate, RampInfo, Subject};
pub use operation::Operation;
pub use ramp::{Ramp, RampShape};
pub use scope::{Scope, strand_roots};
pub use stack::{Group, Layer, StyleStack};
pub use stored::{Stored, UnknownOperation};
