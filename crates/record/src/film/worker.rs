//! The thread that encodes frames and writes them.

use super::encoder::FrameEncoder;
use super::tables::{Before, TablesFile};
use super::{FilmReport, FilmSettings, give_back};
use crate::dither::Dither;
use crate::mp4::{Mp4Writer, SoundTrack, Track};
use crate::partial::{Opener, PartialFile};
use crate::sound::{OpusEncoding, PACKET, PRE_SKIP, SoundSource, samples_of};
use crate::{FrameRate, RecordError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender};

/// A message to the worker.
pub(super) enum Job {
    /// The sound of the film, before the first image.
    Sound(Box<dyn SoundSource>),
    /// The next image.
    Frame(Vec<u8>),
    /// From now on nothing is left of a recording that fails.
    LeaveNothing,
    /// There are no more frames.
    Finish,
    /// The recording failed elsewhere. If the channel closes without this message or the one before, it has been cancelled.
    Leave,
}

/// The unfinished film. When it is dropped, its file stays if the recording failed and there are tables with which it plays.
pub(super) struct Film {
    path: PathBuf,
    settings: FilmSettings,
    rate: FrameRate,
    writer: Mp4Writer<PartialFile>,
    tables: TablesFile,
    sound: Option<OpusEncoding>,
    frames: u64,
    /// Whether what plays stays if the recording fails.
    leaves: bool,
    /// Dropped last, after the files of this recording.
    before: Before,
}

impl Film {
    pub(super) fn new(
        path: &Path,
        settings: FilmSettings,
        rate: FrameRate,
        opener: &Opener,
    ) -> io::Result<Self> {
        let (ticks_per_second, ticks_per_frame) = rate.clock();
        let track = Track {
            width: settings.width as u16,
            height: settings.height as u16,
            ticks_per_second,
            ticks_per_frame,
        };
        let before = Before::set_aside(path)?;
        let writer = Mp4Writer::new(PartialFile::create(path, opener)?, track)?;
        let tables = TablesFile::new(path);
        let path = path.to_owned();
        Ok(Self { path, settings, rate, writer, tables, sound: None, frames: 0, leaves: true, before })
    }

    /// Works until [`Job::Finish`] (returns the report), until [`Job::Leave`] or the channel closes (returns `None`), or until an
    /// error.
    pub(super) fn run(
        mut self,
        todo: &Receiver<Job>,
        done: &SyncSender<Vec<u8>>,
    ) -> Result<Option<FilmReport>, RecordError> {
        let dither = Dither::for_quantiser(self.settings.quality.quantiser());
        let mut encoder = FrameEncoder::new(self.settings, self.rate, dither)
            .map_err(|error| self.encoder_error(&error.to_string()))?;
        while let Ok(job) = todo.recv() {
            match job {
                Job::Sound(sound) => self.begin_sound(sound)?,
                Job::Frame(rgba) => {
                    self.add(&mut encoder, &rgba)?;
                    give_back(done, rgba);
                }
                Job::LeaveNothing => {
                    self.leaves = false;
                    self.writer.medium().set_stays(false);
                }
                Job::Finish => return self.finish(&encoder).map(Some),
                Job::Leave => return Ok(None),
            }
        }
        self.writer.medium().set_stays(false);
        Ok(None)
    }

    fn add(&mut self, encoder: &mut FrameEncoder, rgba: &[u8]) -> Result<(), RecordError> {
        let (sample, key) = encoder.encode(rgba).map_err(|error| self.encoder_error(&error.to_string()))?;
        if sample.is_empty() {
            return Err(self.encoder_error("it skipped the frame"));
        }
        self.writer
            .write_frame(sample, key)
            .map_err(|error| RecordError::io(&self.path, format!("write frame {}", self.frames), error))?;
        self.frames += 1;
        if !self.writer.is_between_chunks() {
            return Ok(());
        }
        self.add_sound()?;
        if self.tables.is_due() {
            let tables = self.writer.tables_so_far(encoder.config());
            // The film itself does not need them. With them, a full disk costs only the images behind them.
            if tables.and_then(|tables| self.tables.write(&tables)).is_ok() {
                self.writer.medium().set_stays(self.leaves);
            }
        }
        Ok(())
    }

    fn begin_sound(&mut self, sound: Box<dyn SoundSource>) -> Result<(), RecordError> {
        let encoding = OpusEncoding::new(sound, self.settings.quality.sound_bits())
            .map_err(|error| sound_error(&self.path, error))?;
        self.writer.add_sound(SoundTrack::new(encoding.channels(), PRE_SKIP, PACKET as u32));
        self.sound = Some(encoding);
        Ok(())
    }

    /// Writes the sound of the frames so far.
    fn add_sound(&mut self) -> Result<(), RecordError> {
        let Some(sound) = &mut self.sound else { return Ok(()) };
        let packets = sound
            .packets_until(samples_of(self.frames, self.rate))
            .map_err(|error| sound_error(&self.path, error))?;
        self.writer
            .write_sound(&packets)
            .map_err(|error| RecordError::io(&self.path, "write the sound", error))
    }

    fn finish(mut self, encoder: &FrameEncoder) -> Result<FilmReport, RecordError> {
        self.add_sound()?;
        // In this order: what was set aside is dropped after the files of this recording.
        let Self { before, tables: _tables, path, rate, writer, frames, .. } = self;
        if frames == 0 {
            return Err(RecordError::request(format!("{}: a film needs at least one frame", path.display())));
        }
        let (file, bytes) = writer
            .finish(encoder.config())
            .map_err(|error| RecordError::io(&path, "finish the film", error))?;
        file.commit(true).map_err(|error| RecordError::io(&path, "finish the film", error))?;
        before.done();
        Ok(FilmReport { path, frames, bytes, duration_secs: frames as f64 / rate.as_f64() })
    }

    fn encoder_error(&self, reason: &str) -> RecordError {
        RecordError::Encoder { path: self.path.clone(), frame: self.frames, reason: reason.to_owned() }
    }
}

fn sound_error(path: &Path, reason: &'static str) -> RecordError {
    RecordError::io(path, "encode the sound", io::Error::other(reason))
}
