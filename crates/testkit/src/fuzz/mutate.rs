//! Mutations of bytes.

use lovelock_base::random::SplitMix64;

/// Numbers at which readers of binary files break.
const WORDS: [u32; 12] = [
    0,
    1,
    2,
    3,
    0xFF,
    0xFFFF,
    0x7FFF_FFFF,
    0x8000_0000,
    0xFFFF_FFFF,
    0x0100_0000,
    // Infinity and a number that is none.
    0x7F80_0000,
    0x7FC0_0000,
];
/// Numbers at which readers of text break.
const NUMBERS: [&str; 14] = [
    "0",
    "-1",
    "1",
    "2",
    "65536",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551616",
    "1e39",
    "-1e-45",
    "nan",
    "inf",
    "1e400",
];
/// The longest run of bytes that is moved.
const LONGEST_RUN: usize = 64;
/// The longest input.
const LONGEST: usize = 1 << 20;

/// Makes damaged copies of files.
#[derive(Clone, Copy, Debug)]
pub struct Mutator {
    random: SplitMix64,
}

impl Mutator {
    /// A mutator whose output follows from the generator.
    pub fn new(random: SplitMix64) -> Self {
        Self { random }
    }

    fn below(&mut self, end: usize) -> usize {
        (self.random.bits() % end.max(1) as u64) as usize
    }

    /// A damaged copy of one of the files.
    pub fn damaged(&mut self, sound: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = sound[self.below(sound.len())].clone();
        // Half of the damage is near the start, where a bit matters most.
        let in_head = self.below(2) == 0;
        for _ in 0..=self.below(6) {
            if bytes.is_empty() {
                return bytes;
            }
            let reach = if in_head { bytes.len().min(256) } else { bytes.len() };
            let at = self.below(reach);
            self.mutate(&mut bytes, at, sound);
            bytes.truncate(LONGEST);
        }
        bytes
    }

    fn mutate(&mut self, bytes: &mut Vec<u8>, at: usize, sound: &[Vec<u8>]) {
        let run = at..(at + 1 + self.below(LONGEST_RUN)).min(bytes.len());
        match self.below(10) {
            0 | 1 => bytes[at] ^= 1 << self.below(8),
            2 => bytes[at] = self.random.bits() as u8,
            3 => {
                // A word, aligned as often as not.
                let at = if self.below(2) == 0 { at & !3 } else { at };
                let word = WORDS[self.below(WORDS.len())].to_le_bytes();
                for (to, from) in bytes[at..].iter_mut().zip(word) {
                    *to = from;
                }
            }
            4 => {
                // The number in the text at or after this place.
                let digit = |byte: &u8| byte.is_ascii_digit();
                if let Some(start) = bytes[at..].iter().position(digit).map(|found| at + found) {
                    let end = bytes[start..]
                        .iter()
                        .position(|byte| !digit(byte))
                        .map_or(bytes.len(), |n| start + n);
                    let number = NUMBERS[self.below(NUMBERS.len())];
                    bytes.splice(start..end, number.bytes());
                }
            }
            5 => drop(bytes.drain(run)),
            6 => {
                let copy = bytes[run.clone()].to_vec();
                let times = 1 + self.below(8);
                bytes.splice(run.start..run.start, copy.repeat(times));
            }
            7 => {
                // A run of another file, or of another place.
                let other = &sound[self.below(sound.len())];
                if !other.is_empty() {
                    let from = self.below(other.len());
                    let copy = other[from..(from + run.len()).min(other.len())].to_vec();
                    bytes.splice(run, copy);
                }
            }
            8 => bytes.truncate(at),
            _ => {
                let value = self.random.bits() as u8;
                bytes[run].fill(value);
            }
        }
    }
}
