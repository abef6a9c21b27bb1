use glam::Affine3A;
use proptest::prelude::*;

use super::super::layout::{LAYOUT_BYTES, Layout};
use super::{META_BYTES, Meta, decode, encode, read_varint, unzigzag, write_varint, zigzag};
use crate::take::bytes::Bytes;

fn meta(frame: usize) -> Meta {
    Meta {
        time_secs: frame as f64 / 3.0,
        clip_secs: -0.0,
        wall_frame: u64::MAX - frame as u64,
        substeps: frame as u32,
        jumped: frame == 1,
        world_from_head: Affine3A::from_scale(glam::Vec3::splat(frame as f32)),
    }
}

fn round_trip(numbers: &[i32], frames: usize, layout: Layout) -> usize {
    let metas: Vec<Meta> = (0..frames).map(meta).collect();
    let raw = encode(&metas, numbers, layout);
    let back = decode(&raw, frames, None).unwrap();
    assert_eq!(back.metas, metas);
    let mut found = Vec::new();
    for (frame, wanted) in numbers.chunks_exact(layout.numbers()).enumerate() {
        back.numbers(frame, &mut found);
        assert_eq!(found, wanted, "frame {frame}");
    }
    raw.len()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_numbers_come_back_exactly(
        frames in 1_usize..9,
        guides in 1_usize..5,
        points in 2_usize..6,
        seed in any::<u64>(),
        bits in 0_u32..32,
    ) {
        let layout = Layout { guides, points };
        let mut state = seed;
        let numbers: Vec<i32> = (0..frames * layout.numbers())
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                ((state >> 32) as i32) >> bits
            })
            .collect();
        round_trip(&numbers, frames, layout);
    }

    #[test]
    fn random_bytes_are_refused_or_read(raw in prop::collection::vec(any::<u8>(), 0..2000)) {
        // No bytes may cause a panic.
        let layout = Layout { guides: 4, points: 3 };
        let _ = decode(&raw, 3, Some(layout));
        let _ = decode(&raw, 3, None);
    }

    #[test]
    fn varints_and_zigzags_come_back(value in any::<i32>()) {
        prop_assert_eq!(unzigzag(zigzag(value)), value);
        let mut bytes = Vec::new();
        write_varint(value as u32, &mut bytes);
        prop_assert_eq!(read_varint(&mut Bytes::new(&bytes)), Some(value as u32));
    }
}

#[test]
fn the_extremes_come_back_exactly() {
    let layout = Layout { guides: 2, points: 3 };
    let numbers: Vec<i32> =
        (0..5 * layout.numbers()).map(|i| [i32::MIN, i32::MAX, 0, -1, 1 << 27][i % 5]).collect();
    round_trip(&numbers, 5, layout);
}

#[test]
fn smooth_motion_needs_one_byte_per_number() {
    let layout = Layout { guides: 50, points: 8 };
    let wave = |f: usize, i: usize| (2000.0 * (f as f64 * 0.2 + i as f64 * 0.7).sin()) as i32;
    let numbers: Vec<i32> =
        (0..60 * layout.numbers()).map(|i| wave(i / layout.numbers(), i % layout.numbers())).collect();
    let least = LAYOUT_BYTES + 60 * (META_BYTES + layout.numbers()) + layout.points * 12;
    let length = round_trip(&numbers, 60, layout);
    assert!(length < least + 15_000, "{length} bytes; the minimum is {least}");
    // Negative control: the same numbers in random order cannot be predicted.
    let mut mixed = numbers.clone();
    let count = mixed.len();
    (0..count).for_each(|i| mixed.swap(i, i * 7919 % count));
    assert!(round_trip(&mixed, 60, layout) > least + 60_000);
}

#[test]
fn a_part_that_ends_early_or_late_is_refused() {
    let layout = Layout { guides: 3, points: 4 };
    let numbers: Vec<i32> = (0..2 * layout.numbers() as i32).map(|i| i * 1000).collect();
    let raw = encode(&[meta(0), meta(1)], &numbers, layout);
    for length in 0..raw.len() {
        assert!(decode(&raw[..length], 2, None).is_err(), "{length}");
    }
    let longer = [&raw[..], &[0]].concat();
    assert!(decode(&longer, 2, None).is_err());
    assert!(decode(&raw, 2, None).is_ok());
}
