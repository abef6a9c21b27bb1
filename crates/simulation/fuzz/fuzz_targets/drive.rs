//! Settings, motions and edits in any order: `cargo +nightly fuzz run drive`.
#![no_main]

#[path = "../../tests/common/drive.rs"]
mod drive;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    drive::drive(bytes);
});
