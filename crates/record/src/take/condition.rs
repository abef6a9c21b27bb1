//! The condition of a take: whole, cut or damaged.

use std::fmt;
use std::ops::Range;

/// Whether everything that was recorded can be played.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TakeCondition {
    /// The take is finished, and no damage is known.
    Whole,
    /// The take was not finished, because the program was killed, the machine stopped or the disk was full, or its file was cut
    /// later. All frames before `frames` can be played.
    Cut {
        /// Number of frames that can be played, from frame 0.
        frames: u64,
        /// How this was detected.
        why: String,
    },
    /// Parts of the file were changed after they were written.
    Damaged {
        /// The lost frames, in order. Empty if only redundant parts are damaged.
        lost: Vec<Range<u64>>,
        /// Whether the take is also unfinished.
        cut: bool,
        /// The damage that was found first.
        why: String,
    },
}

impl TakeCondition {
    /// Whether the take is finished and no damage is known.
    pub fn is_whole(&self) -> bool {
        *self == Self::Whole
    }

    /// Number of lost frames between frames that can be played.
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
                            write!(f, " and {} more ranges", lost.len() - 4)?;
                        }
                    }
                }
                write!(f, "; {why}")
            }
        }
    }
}
