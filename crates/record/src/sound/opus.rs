//! Opus (RFC 6716) for films.

use super::{SOUND_RATE, SoundSource};
use opus_rs::{Application, OpusEncoder};

/// Samples per packet: 20 ms.
pub(crate) const PACKET: usize = 960;

/// Samples that a decoder returns before the first one of the sound: the delay of the encoder in the mode that is used here, which
/// encodes everything by frequency (CELT). Measured by a test.
pub(crate) const PRE_SKIP: u16 = 120;

/// The largest packet that the format allows, bytes.
const LARGEST_PACKET: usize = 1275;

/// Encodes a sound packet by packet, as the film gets longer.
pub(crate) struct OpusEncoding {
    source: Box<dyn SoundSource>,
    encoder: OpusEncoder,
    channels: u16,
    /// Samples encoded so far.
    encoded: u64,
    samples: Vec<f32>,
}

impl OpusEncoding {
    /// `bits` is the rate per second and channel.
    pub(crate) fn new(source: Box<dyn SoundSource>, bits: i32) -> Result<Self, &'static str> {
        let channels = source.channels().clamp(1, 2);
        let mut encoder =
            OpusEncoder::new(SOUND_RATE as i32, usize::from(channels), Application::RestrictedLowDelay)?;
        encoder.bitrate_bps = bits * i32::from(channels);
        encoder.complexity = 10;
        Ok(Self { source, encoder, channels, encoded: 0, samples: vec![0.0; PACKET * usize::from(channels)] })
    }

    /// Number of channels, 1 or 2.
    pub(crate) fn channels(&self) -> u16 {
        self.channels
    }

    /// The packets that are missing until `samples` of the sound can be decoded.
    pub(crate) fn packets_until(&mut self, samples: u64) -> Result<Vec<Vec<u8>>, &'static str> {
        let mut packets = Vec::new();
        while self.encoded < samples + u64::from(PRE_SKIP) {
            self.source.fill(self.encoded, &mut self.samples);
            for sample in &mut self.samples {
                *sample = if sample.is_finite() { sample.clamp(-1.0, 1.0) } else { 0.0 };
            }
            let mut packet = vec![0; LARGEST_PACKET];
            let length = self.encoder.encode(&self.samples, PACKET, &mut packet)?;
            packet.truncate(length);
            packets.push(packet);
            self.encoded += PACKET as u64;
        }
        Ok(packets)
    }
}
