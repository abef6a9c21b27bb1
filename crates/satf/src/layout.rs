//! The layout of the database: how many sectors, angles and texels it holds, and where they are in its arrays.
//!
//! The arrays hold one byte per value, opacity or reflectance times 255. A shader that has these constants reads them with
//! the arithmetic of [`crate::Database::sample`].

/// Texels of a record along the outer arc of its sector.
pub const TEXELS: usize = 32;
/// Levels of detail of a record: 32, 16, 8, 4, 2 and 1 texels.
pub const MIPS: usize = 6;
/// First texel of each level within a record.
pub const MIP_START: [usize; MIPS] = [0, 32, 48, 56, 60, 62];
/// Texels of a record with all its levels: 63, and one unused.
pub const RECORD: usize = 64;
/// Azimuths of view and of light, equally spaced over 2π; the first is the outward normal.
pub const ANGLES: usize = 16;

/// Bins of the radial optical depth.
pub const DEPTHS: usize = 16;
/// Bins of the tangential centroid.
pub const S_CENTROIDS: usize = 4;
/// Stored bins of the tangential centroid: the others are their mirror images.
pub const STORED_S_CENTROIDS: usize = S_CENTROIDS / 2;
/// Bins of the radial centroid.
pub const T_CENTROIDS: usize = 4;
/// Classes of curl.
pub const CURLS: usize = 3;
/// Patterns of strands: a sector per pattern and depth.
pub const PATTERNS: usize = STORED_S_CENTROIDS * T_CENTROIDS * CURLS;
/// Sectors of the database.
pub const SECTORS: usize = PATTERNS * DEPTHS;

/// Bytes of all opacities: `[sector][view][texel]`.
pub const OPACITIES: usize = SECTORS * ANGLES * RECORD;
/// Bytes of all reflectances: `[sector][view][light][texel]`.
pub const REFLECTANCES: usize = SECTORS * ANGLES * ANGLES * RECORD;

/// Texels of level `mip`.
pub const fn texels_of(mip: usize) -> usize {
    TEXELS >> mip
}

/// First byte of the opacities of a sector seen from azimuth number `view`.
pub const fn opacity_start(sector: usize, view: usize) -> usize {
    (sector * ANGLES + view) * RECORD
}

/// First byte of the reflectances of a sector seen from azimuth number `view`, lit from azimuth number `light`.
pub const fn reflectance_start(sector: usize, view: usize, light: usize) -> usize {
    ((sector * ANGLES + view) * ANGLES + light) * RECORD
}
