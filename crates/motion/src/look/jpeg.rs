//! Whether a JPEG has its end. Decoders fill what a file cut short lacks with grey and report nothing.

/// Whether the marker of the end of the image (ITU-T T.81, B.2.1) follows its segments and scans.
pub(super) fn has_end(bytes: &[u8]) -> bool {
    const END: u8 = 0xd9;
    let mut at = 2;
    loop {
        let Some(marker) = next_marker(bytes, &mut at) else { return false };
        if marker == END {
            return true;
        }
        // The length counts itself. A segment may hold a whole JPEG as thumbnail, so it is passed over.
        let Some(length) = bytes.get(at..at + 2) else { return false };
        at += usize::from(u16::from_be_bytes([length[0], length[1]])).max(2);
    }
}

/// Moves behind the next marker that is followed by a segment or ends the image. In the data of a scan, 0xff before 0 is a value, and
/// 0xd0 to 0xd7 restart the decoder.
fn next_marker(bytes: &[u8], at: &mut usize) -> Option<u8> {
    loop {
        *at += bytes.get(*at..)?.iter().position(|byte| *byte == 0xff)? + 1;
        while bytes.get(*at) == Some(&0xff) {
            *at += 1;
        }
        let marker = *bytes.get(*at)?;
        *at += 1;
        if !matches!(marker, 0 | 1 | 0xd0..=0xd8) {
            return Some(marker);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::has_end;

    /// Segments and a scan with a stuffed byte and a restart.
    const START: &[u8] = &[
        0xff, 0xd8, 0xff, 0xe1, 0, 6, 0xff, 0xd8, 0xff, 0xd9, 0xff, 0xda, 0, 3, 1, 5, 0xff, 0, 7, 0xff, 0xd3,
        9,
    ];

    #[test]
    fn an_end_counts_outside_of_segments_alone() {
        let whole = [START, &[0xff, 0xff, 0xd9, 8]].concat();
        assert!(has_end(&whole));
        for length in 0..whole.len() - 1 {
            assert!(!has_end(&whole[..length]), "{length}");
        }
        // A second scan after the first, as in progressive files.
        assert!(has_end(&[START, &[0xff, 0xda, 0, 2, 4, 0xff, 0xd9]].concat()));
        assert!(!has_end(&[START, &[0xff, 0xda, 0, 2, 4, 0xff]].concat()));
        assert!(!has_end(&[0xff, 0xd8, 0xff, 0xe1, 0, 0, 0xff, 0xe1, 0xff, 0xff]));
    }
}
