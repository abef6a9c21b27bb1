//! Temporary storage of frames on the disk until all have arrived.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::{CurveFrame, CurveScene};
use crate::RecordError;

/// Frames of equal length in an unnamed file, which the operating system removes when the program ends.
#[derive(Debug)]
pub(super) struct Spool {
    target: PathBuf,
    file: BufWriter<File>,
    points: usize,
    /// Number of vertices of the body; 0 if the body is not stored.
    vertices: usize,
    wanted: u64,
    pub(super) frames: u64,
    row: Vec<[f32; 3]>,
}

impl Spool {
    /// Creates the file in the folder of `target`. With `with_body` the body's positions and normals are stored too.
    pub(super) fn create(target: &Path, scene: &CurveScene, with_body: bool) -> Result<Self, RecordError> {
        let folder = match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let file = tempfile::tempfile_in(folder)
            .map_err(|error| RecordError::io(target, "create a file for its frames", error))?;
        let body = scene.body.as_ref().filter(|_| with_body);
        Ok(Self {
            target: target.to_owned(),
            file: BufWriter::with_capacity(1 << 18, file),
            points: scene.points(),
            vertices: body.map_or(0, |body| body.bind_positions.len()),
            wanted: scene.frames,
            frames: 0,
            row: Vec::new(),
        })
    }

    pub(super) fn push(&mut self, frame: &CurveFrame<'_>) -> Result<(), RecordError> {
        let refuse = |what: String| Err(RecordError::request(format!("{}: {what}", self.target.display())));
        if self.frames == self.wanted {
            return refuse(format!("more frames than the {} of its settings", self.wanted));
        }
        let [x, y, z] = frame.points;
        if [x, y, z].iter().any(|axis| axis.len() != self.points) {
            return refuse(format!("a frame of {} points; must have {}", x.len(), self.points));
        }
        let body = frame.body.map_or([&[][..], &[][..]], |body| [body.positions, body.normals]);
        if self.vertices > 0 && body.iter().any(|array| array.len() != self.vertices) {
            return refuse(format!("a body of {} vertices; must have {}", body[0].len(), self.vertices));
        }
        self.row.clear();
        self.row.extend(x.iter().zip(y).zip(z).map(|((&x, &y), &z)| [x, y, z]));
        let mut write = || {
            self.file.write_all(bytemuck::cast_slice(&self.row))?;
            if self.vertices > 0 {
                self.file.write_all(bytemuck::cast_slice::<Vec3, u8>(body[0]))?;
                self.file.write_all(bytemuck::cast_slice::<Vec3, u8>(body[1]))?;
            }
            Ok(())
        };
        let frame = self.frames;
        write().map_err(|error| RecordError::io(&self.target, format!("write frame {frame}"), error))?;
        self.frames += 1;
        Ok(())
    }

    /// Ends writing and checks that all frames have arrived.
    pub(super) fn close(&mut self) -> Result<(), RecordError> {
        if self.frames != self.wanted {
            return Err(RecordError::request(format!(
                "{}: {} frames; must be the {} of its settings",
                self.target.display(),
                self.frames,
                self.wanted
            )));
        }
        self.file.flush().map_err(|error| RecordError::io(&self.target, "write its frames", error))
    }

    /// Reads vectors of one frame, starting at index `first`: the points of the curves, then the body's positions, then its normals.
    pub(super) fn read(&mut self, frame: u64, first: usize, into: &mut [[f32; 3]]) -> io::Result<()> {
        let length = self.points + 2 * self.vertices;
        let triple = frame * length as u64 + first as u64;
        let file = self.file.get_mut();
        file.seek(SeekFrom::Start(12 * triple))?;
        file.read_exact(bytemuck::cast_slice_mut(into))
    }

    /// Indices of the body's first position and first normal.
    pub(super) fn body_at(&self) -> [usize; 2] {
        [self.points, self.points + self.vertices]
    }

    pub(super) fn vertices(&self) -> usize {
        self.vertices
    }
}

/// Bounding box of points, by its two corners.
pub(super) fn bounds(points: impl Iterator<Item = [f32; 3]>) -> [[f32; 3]; 2] {
    points.fold([[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]], |[mut low, mut high], point| {
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
        [low, high]
    })
}
