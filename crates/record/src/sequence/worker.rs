//! The threads that encode frames and write them.

use std::io::Write;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, SyncSender};
use std::sync::{Arc, Mutex, PoisonError};

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::exr::{self, FrameInfo, Planes};
use super::{SequenceFormat, frame_name, lock};
use crate::film::give_back;
use crate::manifest::ManifestFrame;
use crate::partial::{Opener, PartialFile};
use crate::{FrameRate, RecordError};

use super::Progress;

/// A frame in the queue.
pub(super) struct Job {
    pub number: u64,
    pub pixels: Pixels,
}

/// The pixels of a frame.
pub(super) enum Pixels {
    Rgba(Vec<u8>),
    Layers(Box<Planes>),
}

/// One thread that encodes frames.
pub(super) struct Worker {
    pub folder: PathBuf,
    pub width: u32,
    pub height: u32,
    pub rate: FrameRate,
    pub format: SequenceFormat,
    pub alpha: bool,
    pub comments: String,
    pub opener: Arc<Opener>,
    pub shared: Arc<Mutex<Progress>>,
}

impl Worker {
    pub fn run(&self, todo: &Mutex<Receiver<Job>>, done: &SyncSender<Vec<u8>>) {
        let (mut opaque, mut file) = (Vec::new(), Vec::new());
        loop {
            let job = todo.lock().unwrap_or_else(PoisonError::into_inner).recv();
            let Ok(Job { number, pixels }) = job else { return };
            let spent = match pixels {
                _ if lock(&self.shared).error.is_some() => None,
                Pixels::Rgba(rgba) => {
                    let coded = self.encode_png(&rgba, &mut opaque, &mut file);
                    self.write(number, coded, &file);
                    Some(rgba)
                }
                Pixels::Layers(planes) => {
                    let info = FrameInfo { rate: self.rate, number, comments: self.comments.clone() };
                    let coded = exr::encode(*planes, [self.width, self.height], &info, &mut file);
                    self.write(number, coded.map_err(std::io::Error::other), &file);
                    None
                }
            };
            if let Some(spent) = spent {
                give_back(done, spent);
            }
        }
    }

    fn encode_png(&self, rgba: &[u8], opaque: &mut Vec<u8>, file: &mut Vec<u8>) -> std::io::Result<()> {
        let (pixels, kind) = if self.alpha {
            (rgba, ExtendedColorType::Rgba8)
        } else {
            opaque.clear();
            opaque.extend(rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]));
            (&opaque[..], ExtendedColorType::Rgb8)
        };
        file.clear();
        PngEncoder::new_with_quality(file, CompressionType::Fast, FilterType::Adaptive)
            .write_image(pixels, self.width, self.height, kind)
            .map_err(std::io::Error::other)
    }

    /// Writes an encoded frame, adds it to the journal and gives it its final name.
    fn write(&self, number: u64, coded: std::io::Result<()>, file: &[u8]) {
        let name = frame_name(number, self.format);
        let path = self.folder.join(&name);
        let crc32 = format!("{:08x}", crc32fast::hash(file));
        let frame = ManifestFrame { number, file: name, bytes: file.len() as u64, crc32 };
        let write = || {
            coded?;
            let mut partial = PartialFile::create(&path, &*self.opener)?;
            partial.write_all(file)?;
            // Before it has its name: then every image that a killed program leaves is in the journal. Entries without one are ignored.
            if let Some(journal) = &mut lock(&self.shared).journal {
                journal.add(&frame)?;
            }
            partial.commit(false)
        };
        let written = write();
        let mut shared = lock(&self.shared);
        match written {
            Ok(()) => drop(shared.frames.insert(number, frame)),
            Err(error) => {
                let error = RecordError::io(&path, format!("write frame {number}"), error);
                shared.error.get_or_insert(error);
            }
        }
    }
}
