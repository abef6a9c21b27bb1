//! Sounds of formats that are not read, told by their first bytes for an error.

/// Bytes of a file that tell its format.
pub(super) const START: usize = 40;

/// The name of a format of sound that is not read, if a file begins as one.
pub(super) fn name(start: &[u8]) -> Option<&'static str> {
    let at = |from: usize, magic: &[u8]| start.get(from..).is_some_and(|rest| rest.starts_with(magic));
    Some(match start {
        _ if at(0, b"FORM") && (at(8, b"AIFF") || at(8, b"AIFC")) => "AIFF",
        _ if at(0, b".snd") => "AU",
        _ if at(0, b"caff") => "CAF",
        _ if at(0, b"MThd") => "MIDI",
        _ if at(0, b"RIFF") && at(8, b"RMID") => "MIDI",
        _ if at(4, b"ftyp") => "MP4 (AAC or ALAC)",
        _ if at(0, b"OggS") && at(28, b"OpusHead") => "Opus",
        _ if at(0, b"\x1a\x45\xdf\xa3") => "Matroska or WebM",
        _ if at(0, b"\x30\x26\xb2\x75\x8e\x66\xcf\x11") => "Windows Media (WMA)",
        _ if at(0, b"wvpk") => "WavPack",
        _ if at(0, b"MAC ") => "Monkey's Audio",
        _ if at(0, b"#!AMR") => "AMR",
        _ if at(0, b"riff\x2e\x91\xcf\x11") => "Wave64",
        // The sync word of ADTS: 12 bits, and layer 0.
        [0xFF, second, ..] if second & 0xF6 == 0xF0 => "AAC",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::name;

    #[test]
    fn formats_are_told_by_their_first_bytes() {
        let ogg = |codec: &[u8]| [&b"OggS"[..], &[0; 24], codec].concat();
        for (start, expected) in [
            (b"FORM\0\0\x01\0AIFFCOMM".to_vec(), Some("AIFF")),
            (b"FORM\0\0\x01\0AIFCFVER".to_vec(), Some("AIFF")),
            (b".snd\0\0\0\x18".to_vec(), Some("AU")),
            (b"\0\0\0\x20ftypM4A ".to_vec(), Some("MP4 (AAC or ALAC)")),
            (ogg(b"OpusHead"), Some("Opus")),
            (vec![0xFF, 0xF1, 0x50, 0x80], Some("AAC")),
            // Negative controls: what is read, other files, and MP3, whose sync word is alike.
            (ogg(b"\x01vorbis"), None),
            (b"FORM\0\0\x01\0ILBM".to_vec(), None),
            (b"RIFF\0\0\x01\0WAVE".to_vec(), None),
            (vec![0xFF, 0xFB, 0x90, 0x00], None),
            (Vec::new(), None),
        ] {
            assert_eq!(name(&start), expected, "{start:?}");
        }
    }
}
