//! The track of sound: Opus by *Encapsulation of Opus in ISO Base Media File Format*, version 0.6.8 (Xiph.Org).

use super::boxes::{chunk_offsets, full, identity_matrix, leaf, nest, numbers, same_file};

/// Clock ticks per second of the track: samples.
const RATE: u32 = 48_000;

/// Time that a decoder needs after a jump until its sound is right, ticks: 80 ms.
const PRE_ROLL: u32 = 3840;

/// A track of packets of equal duration.
pub(crate) struct SoundTrack {
    channels: u16,
    /// Samples that are decoded before the first one that is heard.
    pre_skip: u16,
    /// Samples per packet.
    packet: u32,
    sizes: Vec<u32>,
    /// Offset of each chunk and the number of its packets.
    chunks: Vec<(u64, u32)>,
}

/// What a track takes from its film.
#[derive(Clone, Copy)]
pub(super) struct TrackTimes {
    /// Ticks per second of the film.
    pub(super) ticks_per_second: u32,
    /// Duration of the film in these ticks.
    pub(super) duration: u64,
    /// Whether offsets need 64 bits.
    pub(super) large: bool,
}

impl SoundTrack {
    pub(crate) fn new(channels: u16, pre_skip: u16, packet: u32) -> Self {
        Self { channels, pre_skip, packet, sizes: Vec::new(), chunks: Vec::new() }
    }

    /// Adds packets that are written at `offset`. Returns their size in bytes.
    pub(super) fn add_chunk(&mut self, offset: u64, packets: &[Vec<u8>]) -> u64 {
        if !packets.is_empty() {
            self.chunks.push((offset, packets.len() as u32));
        }
        self.sizes.extend(packets.iter().map(|packet| packet.len() as u32));
        packets.iter().map(|packet| packet.len() as u64).sum()
    }

    pub(super) fn trak(&self, film: TrackTimes) -> Vec<u8> {
        let media = self.media_ticks(film);
        // Flags: enabled, in the movie and in the preview.
        let tkhd = full(*b"tkhd", 1, 7, |b| {
            b.extend([0; 16]);
            b.extend(2_u32.to_be_bytes());
            b.extend([0; 4]);
            b.extend(film.duration.to_be_bytes());
            b.extend([0; 12]);
            b.extend([1, 0, 0, 0]); // Full volume.
            b.extend(identity_matrix());
            b.extend([0; 8]);
        });
        // The film plays the sound from the first sample that is heard, for as long as there are images.
        let elst = full(*b"elst", 1, 0, |b| {
            b.extend(1_u32.to_be_bytes());
            b.extend(film.duration.to_be_bytes());
            b.extend(u64::from(self.pre_skip).to_be_bytes());
            b.extend([0, 1, 0, 0]); // Normal rate.
        });
        let mdhd = full(*b"mdhd", 1, 0, |b| {
            b.extend([0; 16]);
            b.extend(RATE.to_be_bytes());
            b.extend(media.to_be_bytes());
            b.extend([0x55, 0xC4, 0, 0]); // Language: undetermined.
        });
        let hdlr = full(*b"hdlr", 0, 0, |b| {
            b.extend([0; 4]);
            b.extend(b"soun");
            b.extend([0; 12]);
            b.extend(b"Lovelock\0");
        });
        let smhd = full(*b"smhd", 0, 0, |b| b.extend([0; 4]));
        let minf = nest(*b"minf", &[smhd, same_file(), self.stbl(film, media)]);
        let mdia = nest(*b"mdia", &[mdhd, hdlr, minf]);
        nest(*b"trak", &[tkhd, nest(*b"edts", &[elst]), mdia])
    }

    /// Ticks from the first packet to the end of the sound: what the last packet has beyond the film is not counted.
    fn media_ticks(&self, film: TrackTimes) -> u64 {
        let packets = self.sizes.len() as u64 * u64::from(self.packet);
        let heard =
            (u128::from(film.duration) * u128::from(RATE)).div_ceil(u128::from(film.ticks_per_second.max(1)));
        packets.min(heard as u64 + u64::from(self.pre_skip))
    }

    fn stbl(&self, film: TrackTimes, media: u64) -> Vec<u8> {
        let opus = leaf(*b"Opus", |b| {
            b.extend([0, 0, 0, 0, 0, 0, 0, 1]);
            b.extend([0; 8]);
            b.extend(self.channels.to_be_bytes());
            b.extend(16_u16.to_be_bytes()); // Bits per sample, by definition.
            b.extend([0; 4]);
            b.extend((RATE << 16).to_be_bytes());
            b.extend(leaf(*b"dOps", |b| {
                b.push(0); // Version.
                b.push(self.channels as u8);
                b.extend(self.pre_skip.to_be_bytes());
                b.extend(RATE.to_be_bytes());
                b.extend([0; 2]); // No gain.
                b.push(0); // One stream: mono or stereo.
            }));
        });
        let stsd = full(*b"stsd", 0, 0, |b| {
            b.extend(1_u32.to_be_bytes());
            b.extend(opus);
        });
        let count = self.sizes.len() as u32;
        let whole = u64::from(count.saturating_sub(1)) * u64::from(self.packet);
        let last = media.saturating_sub(whole).min(u64::from(self.packet)) as u32;
        let mut durations = Vec::new();
        if count > 1 {
            durations.push([count - 1, self.packet]);
        }
        if count > 0 {
            durations.push([1, last]);
        }
        let stts = full(*b"stts", 0, 0, |b| numbers(b, durations.len(), durations.concat()));
        let mut runs: Vec<[u32; 3]> = Vec::new();
        for (i, &(_, packets)) in self.chunks.iter().enumerate() {
            if runs.last().is_none_or(|run| run[1] != packets) {
                runs.push([i as u32 + 1, packets, 1]);
            }
        }
        let stsc = full(*b"stsc", 0, 0, |b| numbers(b, runs.len(), runs.concat()));
        let stsz = full(*b"stsz", 0, 0, |b| {
            b.extend([0; 4]);
            numbers(b, self.sizes.len(), self.sizes.iter().copied());
        });
        let offsets: Vec<u64> = self.chunks.iter().map(|&(at, _)| at).collect();
        let offsets = chunk_offsets(&offsets, film.large);
        // All packets need the decoder to start this many packets before.
        let sgpd = full(*b"sgpd", 1, 0, |b| {
            b.extend(b"roll");
            b.extend(2_u32.to_be_bytes());
            b.extend(1_u32.to_be_bytes());
            b.extend((-((PRE_ROLL / self.packet.max(1)) as i16)).to_be_bytes());
        });
        let sbgp = full(*b"sbgp", 0, 0, |b| {
            b.extend(b"roll");
            numbers(b, 1, [count, 1]);
        });
        nest(*b"stbl", &[stsd, stts, stsc, stsz, offsets, sgpd, sbgp])
    }
}
