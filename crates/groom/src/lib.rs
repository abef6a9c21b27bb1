//! Hairstyles: scalp, wisps, guides, strands; growing, styling, interpolation and hair files.
//!
//! A [`Hairstyle`] is immutable and shared by `Arc`. It lives in *head space*: metres, the axes of the
//! world in the body's rest pose (right-handed, Y up, the face toward +Z), the origin at the head joint.
//! The simulator moves its [`Guides`] and leaves a [`GuideFrame`] in world space; `interpolate` makes the
//! [`Strands`] that are shadowed and drawn.

mod frame;
mod guides;
mod hairstyle;
mod interpolate;
mod look;
mod scalp;
mod strands;

pub use frame::WispCurve;
pub use guides::{GuideFrame, Guides};
pub use hairstyle::{Hairstyle, HairstyleError, StrandSet, Wisp};
pub use interpolate::interpolate;
pub use look::HairLook;
pub use scalp::Scalp;
pub use strands::Strands;
