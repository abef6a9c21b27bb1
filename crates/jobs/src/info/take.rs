//! Description of a take.

use std::collections::BTreeMap;
use std::path::Path;

use lovelock_project::error::ProjectError;
use lovelock_record::TakeReader;
use serde::Serialize;

/// Description of a take.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TakeInfo {
    /// Its format and version.
    pub format: String,
    /// Numbers of lost frames by cause.
    pub dropped: BTreeMap<String, u64>,
    /// Problems, as sentences.
    pub notes: Vec<String>,
    /// `whole`, or a description of the damage.
    pub condition: String,
    /// Whether the take was finished and no damage is known.
    pub complete: bool,
    /// Number of frames, including lost ones.
    pub frames: u64,
    /// Frames per second.
    pub fps: f64,
    /// Number of frames divided by frames per second, seconds.
    pub duration_secs: f64,
    /// Number of guides at the start.
    pub guides: u32,
    /// Points per guide at the start.
    pub points_per_guide: u32,
    /// Later changes of the guides.
    pub regrown: Vec<RegrownInfo>,
    /// Number of strands of the recorded hairstyle.
    pub strands: u32,
    /// The recorded clip; empty if the body was at rest.
    pub clip: String,
    /// The program that recorded it.
    pub program: String,
    /// File size, bytes.
    pub bytes: u64,
    /// Files of the scene.
    pub files: Vec<String>,
}

/// The guides of a take from a frame on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RegrownInfo {
    /// The first frame that has them.
    pub frame: u64,
    /// Number of guides.
    pub guides: u32,
    /// Points per guide.
    pub points_per_guide: u32,
}

impl TakeInfo {
    /// Reads and checks the whole take.
    ///
    /// # Errors
    /// If the file is not a take, is of a newer version, has no frames, or cannot be read.
    pub(super) fn of(path: &Path) -> Result<Self, ProjectError> {
        let mut reader = TakeReader::open(path)?;
        let condition = reader.verify()?;
        let layouts = reader.layouts()?;
        let bytes = std::fs::metadata(path).map_or(0, |data| data.len());
        let header = reader.header();
        let lost = condition.lost_frames();
        Ok(Self {
            format: format!("Lovelock take {}", header.version),
            dropped: if lost > 0 {
                BTreeMap::from([("lost_frames".to_owned(), lost)])
            } else {
                BTreeMap::new()
            },
            notes: if condition.is_whole() { Vec::new() } else { vec![format!("the take is {condition}")] },
            condition: condition.to_string(),
            complete: condition.is_whole(),
            frames: reader.frames(),
            fps: header.frames_per_second.as_f64(),
            duration_secs: reader.duration_secs(),
            guides: header.guides,
            points_per_guide: header.points_per_guide,
            regrown: layouts
                .iter()
                // The first layout is that of the header, unless it is lost.
                .filter(|layout| layout.first_frame > 0)
                .map(|layout| RegrownInfo {
                    frame: layout.first_frame,
                    guides: layout.guides,
                    points_per_guide: layout.points_per_guide,
                })
                .collect(),
            strands: header.strands,
            clip: header.clip.clone(),
            program: header.program.clone(),
            bytes,
            files: header.assets.iter().map(|asset| asset.path.display().to_string()).collect(),
        })
    }
}
