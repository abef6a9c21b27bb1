//! The archive for any Linux: a folder with the tree below `usr`, which runs in place or is copied to `/usr/local` or `~/.local`.

use super::manifest::files;
use anyhow::Context as _;
use std::fs::File;
use std::path::{Path, PathBuf};

/// How much zstd tries; higher levels take minutes for a few per cent.
const LEVEL: i32 = 15;

/// Writes the archive into a folder and returns its path.
pub(super) fn write(folder: &Path) -> anyhow::Result<PathBuf> {
    let name = format!("lovelock-{}-{}-linux", env!("CARGO_PKG_VERSION"), std::env::consts::ARCH);
    let path = folder.join(format!("{name}.tar.zst"));
    let context = || path.display().to_string();
    let file = File::create(&path).with_context(context)?;
    let mut archive = tar::Builder::new(zstd::Encoder::new(file, LEVEL)?);
    for packaged in files()? {
        let mut source =
            File::open(&packaged.source).with_context(|| packaged.source.display().to_string())?;
        let length = source.metadata()?.len();
        let mut header = tar::Header::new_gnu();
        header.set_size(length);
        header.set_mode(if packaged.is_program { 0o755 } else { 0o644 });
        header.set_cksum();
        let place = packaged.place.strip_prefix("usr").unwrap_or(&packaged.place);
        archive.append_data(&mut header, Path::new(&name).join(place), &mut source).with_context(context)?;
    }
    archive.into_inner()?.finish().with_context(context)?;
    Ok(path)
}
