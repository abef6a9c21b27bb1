//! Temporary storage of frames on the disk until all have arrived.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

use glam::Vec3;

use super::expected::Expected;
use super::{CurveFrame, CurveScene};
use crate::RecordError;

/// Frames of equal length in an unnamed file, which the operating system removes when the program ends.
#[derive(Debug)]
pub(super) struct Spool {
    expected: Expected,
    file: BufWriter<File>,
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
        let expected = Expected::of(target, scene, with_body);
        Ok(Self { expected, file: BufWriter::with_capacity(1 << 18, file), frames: 0, row: Vec::new() })
    }

    pub(super) fn push(&mut self, frame: &CurveFrame<'_>) -> Result<(), RecordError> {
        self.expected.check(self.frames, frame)?;
        let [x, y, z] = frame.points;
        let body = frame.body.map_or([&[][..], &[][..]], |body| [body.positions, body.normals]);
        self.row.clear();
        self.row.extend(x.iter().zip(y).zip(z).map(|((&x, &y), &z)| [x, y, z]));
        let mut write = || {
            self.file.write_all(bytemuck::cast_slice(&self.row))?;
            if self.expected.vertices > 0 {
                self.file.write_all(bytemuck::cast_slice::<Vec3, u8>(body[0]))?;
                self.file.write_all(bytemuck::cast_slice::<Vec3, u8>(body[1]))?;
            }
            Ok(())
        };
        let (frame, target) = (self.frames, &self.expected.target);
        write().map_err(|error| RecordError::io(target, format!("write frame {frame}"), error))?;
        self.frames += 1;
        Ok(())
    }

    /// Ends writing and checks that all frames have arrived.
    pub(super) fn close(&mut self) -> Result<(), RecordError> {
        self.expected.complete(self.frames)?;
        let target = &self.expected.target;
        self.file.flush().map_err(|error| RecordError::io(target, "write its frames", error))
    }

    /// Reads vectors of one frame, starting at index `first`: the points of the curves, then the body's positions, then its normals.
    pub(super) fn read(&mut self, frame: u64, first: usize, into: &mut [[f32; 3]]) -> io::Result<()> {
        let length = self.expected.points + 2 * self.expected.vertices;
        let triple = frame * length as u64 + first as u64;
        let file = self.file.get_mut();
        file.seek(SeekFrom::Start(12 * triple))?;
        file.read_exact(bytemuck::cast_slice_mut(into))
    }

    /// Indices of the body's first position and first normal.
    pub(super) fn body_at(&self) -> [usize; 2] {
        [self.expected.points, self.expected.points + self.expected.vertices]
    }

    pub(super) fn vertices(&self) -> usize {
        self.expected.vertices
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
