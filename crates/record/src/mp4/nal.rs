//! NAL units of H.264: the byte stream of an encoder (Annex B) and the samples of MP4 (a length before each unit).

/// The parameter sets of a stream, which MP4 stores separately from the frames.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct AvcConfig {
    /// Sequence parameter set: one NAL unit without its start code.
    pub(crate) sps: Vec<u8>,
    /// Picture parameter set, in the same form.
    pub(crate) pps: Vec<u8>,
}

impl AvcConfig {
    /// The `avcC` record (ISO/IEC 14496-15, 5.3.3.1) with four-byte lengths and one set of each kind.
    pub(crate) fn record(&self) -> Vec<u8> {
        let byte = |index: usize| self.sps.get(index).copied().unwrap_or(0);
        // Version; profile, compatibility and level of the SPS; lengths of 3 + 1 bytes; one SPS.
        let mut record = vec![1, byte(1), byte(2), byte(3), 0b1111_1100 | 3, 0b1110_0000 | 1];
        record.extend((self.sps.len() as u16).to_be_bytes());
        record.extend(&self.sps);
        record.push(1);
        record.extend((self.pps.len() as u16).to_be_bytes());
        record.extend(&self.pps);
        // The High profiles add the chroma format and the bit depths: 4:2:0, 8 bits, no extension sets.
        if matches!(byte(1), 100 | 110 | 122 | 144) {
            record.extend([0b1111_1100 | 1, 0b1111_1000, 0b1111_1000, 0]);
        }
        record
    }

    /// Reads an `avcC` record with four-byte lengths. Uses the first set of each kind.
    pub(crate) fn from_record(record: &[u8]) -> Option<Self> {
        if *record.first()? != 1 || record.get(4)? & 3 != 3 {
            return None;
        }
        let (sps, rest) = first_set(usize::from(record.get(5)? & 31), record.get(6..)?)?;
        let (&count, rest) = rest.split_first()?;
        let (pps, _) = first_set(usize::from(count), rest)?;
        Some(Self { sps, pps })
    }
}

/// The first of `count` parameter sets, each preceded by a two-byte length, and the bytes after the last one.
fn first_set(count: usize, mut bytes: &[u8]) -> Option<(Vec<u8>, &[u8])> {
    let mut first = None;
    for _ in 0..count {
        let (length, rest) = bytes.split_first_chunk::<2>()?;
        let (set, rest) = rest.split_at_checked(usize::from(u16::from_be_bytes(*length)))?;
        first.get_or_insert_with(|| set.to_vec());
        bytes = rest;
    }
    Some((first?, bytes))
}

/// The type of a NAL unit (H.264 table 7-1): 5 is a slice of a key frame, 7 an SPS, 8 a PPS.
pub(crate) fn nal_kind(unit: &[u8]) -> u8 {
    unit.first().map_or(0, |byte| byte & 31)
}

/// The NAL units of an Annex B byte stream, without start codes and padding zeros.
pub(crate) fn split_annex_b(stream: &[u8]) -> Vec<&[u8]> {
    let mut starts = Vec::new();
    let mut at = 0;
    while at + 3 <= stream.len() {
        if stream[at..at + 3] == [0, 0, 1] {
            starts.push(at);
            at += 3;
        } else {
            at += 1;
        }
    }
    let mut units = Vec::with_capacity(starts.len());
    for (index, &start) in starts.iter().enumerate() {
        let end = starts.get(index + 1).copied().unwrap_or(stream.len());
        let mut unit = &stream[start + 3..end];
        // A unit never ends in a zero byte (7.4.1); zeros at the end belong to the next start code.
        while let [rest @ .., 0] = unit {
            unit = rest;
        }
        if !unit.is_empty() {
            units.push(unit);
        }
    }
    units
}

/// Appends the frame of an Annex B stream to `sample` in the form of MP4, and stores its parameter sets in `config`.
/// Returns whether it is a key frame.
pub(crate) fn append_sample(stream: &[u8], sample: &mut Vec<u8>, config: &mut AvcConfig) -> bool {
    let mut key = false;
    for unit in split_annex_b(stream) {
        match nal_kind(unit) {
            7 => config.sps = unit.to_vec(),
            8 => config.pps = unit.to_vec(),
            kind => {
                key |= kind == 5;
                sample.extend((unit.len() as u32).to_be_bytes());
                sample.extend(unit);
            }
        }
    }
    key
}

#[cfg(test)]
mod tests {
    use super::{AvcConfig, append_sample, split_annex_b};

    #[test]
    fn units_are_split_at_both_start_codes() {
        let stream = [0, 0, 0, 1, 0x67, 1, 2, 0, 0, 0, 1, 0x68, 3, 0, 0, 1, 0x65, 9, 9];
        assert_eq!(split_annex_b(&stream), [&[0x67, 1, 2][..], &[0x68, 3], &[0x65, 9, 9]]);
        assert!(split_annex_b(&[]).is_empty());
        assert!(split_annex_b(&[0, 0, 1]).is_empty());
        assert!(split_annex_b(&[5, 6, 7, 8]).is_empty());
    }

    #[test]
    fn parameter_sets_stay_out_of_the_sample() {
        let stream = [0, 0, 0, 1, 0x67, 66, 0, 31, 0, 0, 0, 1, 0x68, 3, 0, 0, 1, 0x65, 9];
        let (mut sample, mut config) = (Vec::new(), AvcConfig::default());
        assert!(append_sample(&stream, &mut sample, &mut config));
        assert_eq!(sample, [0, 0, 0, 2, 0x65, 9]);
        assert_eq!(config, AvcConfig { sps: vec![0x67, 66, 0, 31], pps: vec![0x68, 3] });
        sample.clear();
        assert!(!append_sample(&[0, 0, 1, 0x61, 7], &mut sample, &mut config));
    }

    #[test]
    fn the_record_comes_back() {
        for profile in [66, 77, 100] {
            let config = AvcConfig { sps: vec![0x67, profile, 0xC0, 31, 5], pps: vec![0x68, 1, 2] };
            let record = config.record();
            assert_eq!(AvcConfig::from_record(&record), Some(config));
            // Negative control: a record that ends inside the sets is rejected.
            for length in 0..16 {
                assert_eq!(AvcConfig::from_record(&record[..length]), None, "{length}");
            }
        }
    }
}
