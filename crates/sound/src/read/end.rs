//! Where a sound ends, if its header states another length than the file has.
//!
//! MP3 and Ogg files state how many samples they have, so that the silence which fills the last packet can be left out. If the header is
//! wrong, this would leave out whatever follows.

use std::collections::VecDeque;

use symphonia::core::errors::Error;
use symphonia::core::formats::{FormatReader, TrackType};
use symphonia::core::packet::Packet;
use symphonia::core::units::Duration;

/// The most samples by which an encoder lengthens a sound: 4095 by LAME, up to two blocks of 8192 by Vorbis.
const LONGEST_FILL: u64 = 16_384;

/// What comes next in a file.
pub(super) enum Next {
    /// To be decoded.
    Packet(Packet),
    /// A packet of another track, or one whose length depends on those after it.
    Waiting,
    /// The end of the file.
    End,
}

/// Holds packets that are said to lie beyond the end, until it is known whether they do.
pub(super) struct End {
    /// Whether the file says how much of its last packets is silence that was added. Otherwise nothing is left out.
    states_fill: bool,
    held: VecDeque<Packet>,
    held_fill: u64,
    /// Whether the file went on after its stated end.
    is_wrong: bool,
    /// What comes after what is held, once the reader has nothing more.
    last: Option<Result<Next, Error>>,
    /// Whether a packet was decoded.
    has_sound: bool,
}

impl End {
    pub(super) fn of(reader: &dyn FormatReader) -> Self {
        // Only a tag of LAME states it in MP3; without one, the length is that of whole packets or an estimate.
        let padding = reader.default_track(TrackType::Audio).and_then(|track| track.padding);
        let states_fill = reader.format_info().short_name == "ogg" || padding.is_some();
        Self {
            states_fill,
            held: VecDeque::new(),
            held_fill: 0,
            is_wrong: false,
            last: None,
            has_sound: false,
        }
    }

    /// Whether the file goes on after the end that its header states.
    pub(super) fn is_wrong(&self) -> bool {
        self.is_wrong
    }

    /// The next packet of a track.
    pub(super) fn next(&mut self, reader: &mut dyn FormatReader, track: u32) -> Result<Next, Error> {
        if self.last.is_some() || self.is_wrong {
            // A sound that is said to have no samples has those that are there.
            let is_silent = !self.has_sound && !self.held.is_empty();
            self.is_wrong |= is_silent && self.held.iter().all(|packet| packet.dur == Duration::ZERO);
            if let Some(packet) = self.held.pop_front() {
                return Ok(Next::Packet(self.trimmed(packet)));
            }
            if let Some(last) = &mut self.last {
                return std::mem::replace(last, Ok(Next::End));
            }
        }
        let packet = match reader.next_packet() {
            Ok(Some(packet)) if packet.track_id == track => packet,
            Ok(Some(_)) => return Ok(Next::Waiting),
            Ok(None) => {
                self.last = Some(Ok(Next::End));
                return Ok(Next::Waiting);
            }
            Err(error) => {
                self.last = Some(Err(error));
                return Ok(Next::Waiting);
            }
        };
        let fill = packet.trim_end.get();
        if !self.states_fill || self.is_wrong || (fill == 0 && self.held.is_empty()) {
            return Ok(Next::Packet(self.trimmed(packet)));
        }
        self.held_fill += fill;
        self.is_wrong = fill == 0 || self.held_fill > LONGEST_FILL;
        self.held.push_back(packet);
        Ok(Next::Waiting)
    }

    fn trimmed(&mut self, mut packet: Packet) -> Packet {
        self.has_sound = true;
        if !self.states_fill || self.is_wrong {
            packet.trim_end = Duration::ZERO;
        }
        packet
    }
}
