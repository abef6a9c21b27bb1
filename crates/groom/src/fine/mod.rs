//! Fine strands: as many as an image needs, made anew for each frame from the stored ones.
//!
//! A hairstyle stores a few thousand strands. An image from near needs ten times as many, and one from afar fewer. [`FineStrands`] is a
//! list of strands in the order in which they are drawn, so that any number of them is a prefix of the list: first the stored strands,
//! evenly from every part of the head, then children. A child lies between three neighbouring stored strands of its wisp, close to the
//! first of them and closer at its tip. It is 24 bytes, and its points are computed from those of its parents by [`grow_fine`] on the
//! CPU and by a kernel on the GPU.
//!
//! [`Portion`] is the number of strands in one image: the last ones fade, so that none appears or disappears at once, and the widths of
//! all keep their sum.

mod children;
mod grow;
mod hairline;
mod locks;
mod nearest;
mod order;
mod portion;
mod strand;
#[cfg(test)]
mod tests;

pub use children::FineStrands;
pub use grow::{ParentPoints, grow_fine, moved_apart};
pub use locks::{LOCK_NUMBERS, lock_numbers, locks_of_wisps};
pub use portion::Portion;
pub use strand::FineStrand;
