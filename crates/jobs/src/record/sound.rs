//! The sound of a recording: that of the project, cut to the frames.

use std::ops::{ControlFlow, Range};

use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProblemKind, ProjectError};
use lovelock_project::files::Access;
use lovelock_record::{SOUND_RATE, SoundSource};
use lovelock_session::dance::Dance;
use lovelock_session::progress::{Progress, report_progress};
use lovelock_sound::{Sound, SoundError, read_sound};

/// The project's sound from the first frame of a recording on. When the dance starts again, so does the sound.
#[derive(Debug)]
pub(super) struct FilmSound {
    sound: Sound,
    gain: f32,
    /// Time of the first frame, seconds.
    start_secs: f64,
    /// Time of the timeline at which the sound begins.
    offset_secs: f64,
    /// Time after which the timeline starts again at 0.
    period_secs: Option<f64>,
}

impl FilmSound {
    /// The sound of a project, if it is heard. A sound that cannot be read is a problem, and the recording is silent.
    ///
    /// # Errors
    /// [`ProjectError::Cancelled`].
    pub(super) fn of(
        project: &Project,
        access: &Access,
        dance: &Dance,
        frames: &Range<u64>,
        problems: &mut Vec<Problem>,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Option<Self>, ProjectError> {
        let section = &project.sound;
        let Some(file) = section.file.as_ref().filter(|_| section.is_heard()) else { return Ok(None) };
        report_progress(progress, Progress::Loading { what: "reading the sound".to_owned() })?;
        let read = access.read(Place::Sound, file).and_then(|path| {
            let mut told = 0;
            let mut go_on = |part: f32| {
                // Twenty reports suffice to be cancelled soon.
                if part * 20.0 < f32::from(told + 1_u16) {
                    return ControlFlow::Continue(());
                }
                told += 1;
                progress(Progress::Loading { what: "reading the sound".to_owned() })
            };
            let read = read_sound(&path, &mut go_on);
            read.map_err(|error| match error {
                SoundError::Cancelled => Problem::new(Place::Sound, ProblemKind::Note, "cancelled"),
                error => Problem::not_loaded(Place::Sound, error),
            })
        });
        let (sound, source) = match read {
            Ok(read) => read,
            Err(problem) if !problem.is_failure() => return Err(ProjectError::Cancelled),
            Err(problem) => {
                let problem = problem.with_fallback("the recording is silent");
                report_progress(progress, Progress::Loaded { problems: vec![problem.clone()] })?;
                problems.push(problem);
                return Ok(None);
            }
        };
        let note = |note| Problem::new(Place::Sound, ProblemKind::Note, note);
        problems.extend(source.notes.into_iter().map(note));
        Ok(Some(Self {
            sound,
            gain: section.gain,
            start_secs: dance.secs_of(frames.start),
            offset_secs: section.offset_secs,
            period_secs: dance.period_secs(),
        }))
    }

    /// Left and right at a time after the first frame.
    fn at(&self, secs: f64) -> [f32; 2] {
        let secs = self.start_secs + secs;
        let position = self.period_secs.map_or(secs, |period| secs.rem_euclid(period));
        let sample = ((position - self.offset_secs) * f64::from(SOUND_RATE)).round();
        self.sound.stereo(sample as i64).map(|value| value * self.gain)
    }
}

impl SoundSource for FilmSound {
    fn channels(&self) -> u16 {
        self.sound.channels() as u16
    }

    fn fill(&mut self, first: u64, out: &mut [f32]) {
        let channels = self.sound.channels();
        for (i, instant) in out.chunks_exact_mut(channels).enumerate() {
            let value = self.at((first + i as u64) as f64 / f64::from(SOUND_RATE));
            instant.copy_from_slice(&value[..channels]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sound of ten seconds whose samples count its tenths of seconds.
    fn sound(start_secs: f64, offset_secs: f64, period_secs: Option<f64>) -> FilmSound {
        let samples = (0..480_000).map(|i| (i / 4800 + 1) as i16 * 100).collect();
        FilmSound { sound: Sound::new(samples, 1), gain: 0.5, start_secs, offset_secs, period_secs }
    }

    /// The tenth of a second that is heard after some seconds of the film; 0 is silence.
    fn tenth(film: &mut FilmSound, secs: f64) -> i32 {
        let mut out = [0.0; 10];
        film.fill((secs * 48_000.0).round() as u64 + 20, &mut out);
        (out[0] / 0.5 * 32_768.0 / 100.0).round() as i32
    }

    #[test]
    fn the_sound_follows_start_offset_and_repetitions() {
        let mut plain = sound(2.0, 0.0, None);
        assert_eq!([0.0, 0.1, 7.9, 8.1].map(|secs| tenth(&mut plain, secs)), [21, 22, 100, 0]);
        let mut late = sound(0.0, 1.5, None);
        assert_eq!([0.0, 1.4, 1.5, 2.5].map(|secs| tenth(&mut late, secs)), [0, 0, 1, 11]);
        let mut early = sound(0.0, -1.5, None);
        assert_eq!(tenth(&mut early, 0.0), 16);
        // A dance of 4 s, recorded from second 3 on.
        let mut round = sound(3.0, 0.0, Some(4.0));
        assert_eq!([0.0, 0.9, 1.0, 5.0].map(|secs| tenth(&mut round, secs)), [31, 40, 1, 1]);
    }
}
