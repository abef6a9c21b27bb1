//! Damages a file in many ways and reads what is left: `cargo run --release -p lovelock-motion --example damage -- SECS FILE...`.
//!
//! Each round flips, replaces, cuts or repeats bytes by a seeded generator, and reads the result as a character and as a motion. Prints
//! how many were read and refused, and the longest time of one. A panic or an abort ends the program with the seed of the round.

use std::collections::BTreeMap;
use std::path::Path;

use lovelock_base::clock::Stopwatch;
use lovelock_base::random::SplitMix64;
use lovelock_motion::{MotionSettings, load_character_bytes, load_motion_bytes};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let secs: f64 = arguments.next().ok_or("wanted SECS FILE...")?.parse()?;
    for file in arguments {
        let whole = std::fs::read(Path::new(&file))?;
        let (clock, mut read, mut refused, mut longest) = (Stopwatch::start(), 0_u64, 0_u64, 0.0_f64);
        let mut reasons: BTreeMap<String, u64> = BTreeMap::new();
        let mut seed = 0;
        while clock.secs() < secs {
            seed += 1;
            let damaged = damage(&whole, seed);
            let of_round = Stopwatch::start();
            let result = std::panic::catch_unwind(|| {
                let _ = load_motion_bytes(&file, &damaged, MotionSettings::default());
                load_character_bytes(&file, &damaged, None).map(|_| ())
            });
            longest = longest.max(of_round.secs());
            match result {
                Ok(Ok(())) => read += 1,
                Ok(Err(error)) => {
                    refused += 1;
                    let text = error.to_string();
                    assert!(!text.contains('\n'), "seed {seed}: {text}");
                    let words: String = text.chars().filter(|c| !c.is_ascii_digit()).take(110).collect();
                    *reasons.entry(words).or_default() += 1;
                }
                Err(_) => return Err(format!("{file}: panic at seed {seed}").into()),
            }
        }
        println!("{file}: {seed} rounds, {read} read, {refused} refused, longest {longest:.2} s");
        let mut reasons: Vec<(u64, String)> = reasons.into_iter().map(|(reason, n)| (n, reason)).collect();
        reasons.sort_unstable_by(|a, b| b.cmp(a));
        for (count, reason) in reasons.iter().take(8) {
            println!("  {count} {reason}");
        }
    }
    Ok(())
}

/// The bytes of a file after one to eight changes.
fn damage(whole: &[u8], seed: u64) -> Vec<u8> {
    let mut random = SplitMix64::new(seed);
    let mut next = move |below: usize| (random.bits() % below.max(1) as u64) as usize;
    let mut bytes = whole.to_vec();
    for _ in 0..=next(8) {
        if bytes.is_empty() {
            break;
        }
        // Half of the changes hit the start, where headers and counts are.
        let reach = if next(2) == 0 { bytes.len().min(4096) } else { bytes.len() };
        let at = next(reach);
        match next(6) {
            0 => bytes[at] ^= 1 << next(8),
            1 => bytes[at] = [0, 1, 0x7f, 0x80, 0xff][next(5)],
            2 => {
                let end = (at + 4).min(bytes.len());
                bytes[at..end].fill([0, 0xff, 0x7f][next(3)]);
            }
            3 if next(4) == 0 => bytes.truncate(at),
            4 => {
                let end = (at + next(64)).min(bytes.len());
                bytes.drain(at..end);
            }
            _ => {
                let end = (at + next(64)).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                let to = next(bytes.len());
                bytes.splice(to..to, piece);
            }
        }
    }
    bytes
}
