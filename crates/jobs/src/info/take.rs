//! What a take holds.

use std::collections::BTreeMap;
use std::path::Path;

use lovelock_project::error::StudioError;
use lovelock_record::TakeReader;
use serde::Serialize;

/// A take in words.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TakeInfo {
    /// Its format and version.
    pub format: String,
    /// Frames that are lost, by what befell them.
    pub dropped: BTreeMap<String, u64>,
    /// What is wrong with it, in sentences.
    pub notes: Vec<String>,
    /// `whole`, or what is wrong with it.
    pub condition: String,
    /// Frames, with those that are lost.
    pub frames: u64,
    /// Frames a second.
    pub fps: f64,
    /// Frames by frames a second, seconds.
    pub duration_secs: f64,
    /// Guides, as the take begins.
    pub guides: u32,
    /// Points of a guide, as the take begins.
    pub points_per_guide: u32,
    /// Where on the way the hair gets other guides.
    pub regrown: Vec<RegrownInfo>,
    /// Strands of the hairstyle that it was recorded with.
    pub strands: u32,
    /// The clip that was danced; empty where the body rested.
    pub clip: String,
    /// What recorded it.
    pub program: String,
    /// Length of the file, bytes.
    pub bytes: u64,
    /// Files that the scene was made from.
    pub files: Vec<String>,
}

/// The guides of a take from a frame on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RegrownInfo {
    /// The first frame that has them.
    pub frame: u64,
    /// Guides.
    pub guides: u32,
    /// Points of a guide.
    pub points_per_guide: u32,
}

impl TakeInfo {
    /// Reads all of the take and checks it.
    ///
    /// # Errors
    /// No take, one of a newer version or without frames, or a disk that cannot read it.
    pub(super) fn of(path: &Path) -> Result<Self, StudioError> {
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
            frames: reader.frames(),
            fps: header.frames_per_second.as_f64(),
            duration_secs: reader.duration_secs(),
            guides: header.guides,
            points_per_guide: header.points_per_guide,
            regrown: layouts
                .iter()
                // The first is the header's, unless it is lost.
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
