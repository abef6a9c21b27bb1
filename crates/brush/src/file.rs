//! Recorded strokes, as files.

use serde::{Deserialize, Serialize};

use crate::settings::BrushSettings;
use crate::stroke::StrokeSample;
use crate::tool::Tool;

/// A stroke that was recorded.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RecordedStroke {
    /// The tool.
    pub tool: Tool,
    /// Whether the tool does the opposite.
    pub inverted: bool,
    /// How the brush touched hair.
    pub settings: BrushSettings,
    /// The brush at each instant, in the order of time, world space.
    pub samples: Vec<StrokeSample>,
}

/// Strokes in the order in which they were made.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StrokeFile {
    /// The version of the file.
    pub version: u32,
    /// The strokes.
    pub strokes: Vec<RecordedStroke>,
}

impl StrokeFile {
    /// The extension of files.
    pub const EXTENSION: &'static str = "lovelockstrokes";
    /// The version that this program writes.
    pub const VERSION: u32 = 1;
    /// The most strokes.
    pub const MAX_STROKES: usize = 10_000;
    /// The most samples of a stroke.
    pub const MAX_SAMPLES: usize = 100_000;
    /// The longest text, bytes.
    pub const LONGEST: usize = 1 << 30;

    /// A file of these strokes.
    pub fn new(strokes: Vec<RecordedStroke>) -> Self {
        Self { version: Self::VERSION, strokes }
    }

    /// The file as text.
    ///
    /// # Errors
    /// As [`StrokeFile::from_text`].
    pub fn to_text(&self) -> Result<String, String> {
        self.check()?;
        let config = ron::ser::PrettyConfig::new().depth_limit(4);
        ron::ser::to_string_pretty(self, config).map_err(|error| format!("strokes: {error}"))
    }

    /// Reads a file.
    ///
    /// # Errors
    /// What was found and what is valid, in one sentence.
    pub fn from_text(text: &str) -> Result<Self, String> {
        if text.len() > Self::LONGEST {
            return Err(format!("strokes: found {} bytes; must be at most {}", text.len(), Self::LONGEST));
        }
        let read: Self = ron::from_str(text).map_err(|error| format!("strokes: {error}"))?;
        read.check()?;
        Ok(read)
    }

    fn check(&self) -> Result<(), String> {
        if self.version != Self::VERSION {
            return Err(format!("strokes: found version {}; must be {}", self.version, Self::VERSION));
        }
        let count = self.strokes.len();
        if count > Self::MAX_STROKES {
            return Err(format!("strokes: found {count} strokes; must be at most {}", Self::MAX_STROKES));
        }
        for (i, stroke) in self.strokes.iter().enumerate() {
            let count = stroke.samples.len();
            if count > Self::MAX_SAMPLES {
                let most = Self::MAX_SAMPLES;
                return Err(format!("stroke {i}: found {count} samples; must be at most {most}"));
            }
            if let Some(bad) = stroke.samples.iter().position(|sample| !sample.is_finite()) {
                return Err(format!("stroke {i}, sample {bad}: found what is not a finite number"));
            }
            let times = stroke.samples.windows(2);
            if let Some(bad) = times.clone().position(|pair| pair[1].time_secs < pair[0].time_secs) {
                let (before, after) = (stroke.samples[bad].time_secs, stroke.samples[bad + 1].time_secs);
                return Err(format!(
                    "stroke {i}, sample {}: found the time {after} s; must be {before} s or later",
                    bad + 1
                ));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn stroke(count: usize) -> RecordedStroke {
        let sample = |i: usize| StrokeSample {
            position: Vec3::new(0.1, 1.6, 0.001 * i as f32),
            view: Vec3::NEG_Z,
            drag: Vec3::Z * 0.001,
            pressure: 1.0,
            time_secs: i as f64 / 60.0,
        };
        RecordedStroke {
            tool: Tool::Puff,
            samples: (0..count).map(sample).collect(),
            ..RecordedStroke::default()
        }
    }

    #[test]
    fn strokes_survive_text() {
        let file = StrokeFile::new(vec![stroke(3), RecordedStroke::default(), stroke(1)]);
        let text = file.to_text().expect("text");
        let read = StrokeFile::from_text(&text).expect("strokes");
        assert_eq!(read, file);
        assert_eq!(read.to_text().expect("text"), text);
    }

    #[test]
    fn bad_files_are_refused_with_a_sentence() {
        let text = StrokeFile::new(vec![stroke(3)]).to_text().expect("text");
        for (from, to, found) in [
            ("version: 1", "version: 7", "strokes: found version 7; must be 1"),
            ("pressure: 1.0", "pressure: NaN", "stroke 0, sample 0: found what is not a finite number"),
            ("0.001", "inf", "stroke 0, sample 0: found what is not a finite number"),
            ("time_secs: 0.0)", "time_secs: 9.0)", "stroke 0, sample 1: found the time"),
            ("tool: puff", "tool: broom", "strokes: "),
        ] {
            let bad = text.replacen(from, to, 1);
            assert_ne!(bad, text, "{from}");
            let error = StrokeFile::from_text(&bad).expect_err("an error");
            assert!(error.starts_with(found), "{error}");
        }
        let many = StrokeFile::new(vec![stroke(StrokeFile::MAX_SAMPLES + 1)]);
        assert!(many.to_text().expect_err("an error").contains("must be at most 100000"));
        let many = StrokeFile::new(vec![RecordedStroke::default(); StrokeFile::MAX_STROKES + 1]);
        assert!(many.to_text().expect_err("an error").contains("must be at most 10000"));
        assert!(StrokeFile::from_text("").is_err());
    }
}
