//! Whether a take is whole.

use std::fmt;
use std::ops::Range;

/// Whether all that was recorded can be played.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TakeCondition {
    /// Finished, and nothing is known to be wrong with it.
    Whole,
    /// Not finished: the recording was killed, the machine stopped, the disk was full, or the file was cut. All frames
    /// before `frames` are there.
    Cut {
        /// Frames that can be played, from frame 0.
        frames: u64,
        /// How that is seen.
        why: String,
    },
    /// Parts of the file were changed after they were written.
    Damaged {
        /// The frames that are lost, in order; none where only parts that can be spared are damaged.
        lost: Vec<Range<u64>>,
        /// Whether the take was not finished either.
        cut: bool,
        /// What was found first.
        why: String,
    },
}

impl TakeCondition {
    /// Whether it is finished and nothing is known to be wrong with it.
    pub fn is_whole(&self) -> bool {
        *self == Self::Whole
    }

    /// Frames that are lost though later ones are there.
    pub fn lost_frames(&self) -> u64 {
        match self {
            Self::Damaged { lost, .. } => lost.iter().map(|range| range.end - range.start).sum(),
            Self::Whole | Self::Cut { .. } => 0,
        }
    }
}

impl fmt::Display for TakeCondition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => write!(f, "whole"),
            Self::Cut { frames, why } => write!(f, "cut after frame {}: {why}", frames.saturating_sub(1)),
            Self::Damaged { lost, cut, why } => {
                write!(f, "damaged{}: ", if *cut { " and cut" } else { "" })?;
                match &lost[..] {
                    [] => write!(f, "no frame is lost")?,
                    lost => {
                        write!(f, "lost frames ")?;
                        for (i, range) in lost.iter().take(4).enumerate() {
                            let comma = if i > 0 { ", " } else { "" };
                            write!(f, "{comma}{} to {}", range.start, range.end - 1)?;
                        }
                        if lost.len() > 4 {
                            write!(f, " and {} runs more", lost.len() - 4)?;
                        }
                    }
                }
                write!(f, "; {why}")
            }
        }
    }
}
