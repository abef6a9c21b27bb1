//! Units: the one of the value, and the one that is shown.

/// A unit of measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// The unit of the value in files and on the command line; empty for a number without unit.
    pub base: &'static str,
    /// What the window writes after the number.
    pub suffix: &'static str,
    /// Shown units per unit of the value.
    pub factor: f64,
    /// Digits after the point that the window shows.
    pub decimals: usize,
}

impl Unit {
    /// No unit.
    pub const NONE: Self = Self::plain("", "", 2);
    /// Metres.
    pub const METRES: Self = Self::plain("m", " m", 2);
    /// Metres, shown as centimetres.
    pub const METRES_AS_CM: Self = Self { base: "m", suffix: " cm", factor: 1e2, decimals: 1 };
    /// Metres, shown as millimetres.
    pub const METRES_AS_MM: Self = Self { base: "m", suffix: " mm", factor: 1e3, decimals: 1 };
    /// Metres, shown as micrometres.
    pub const METRES_AS_UM: Self = Self { base: "m", suffix: " µm", factor: 1e6, decimals: 0 };
    /// Radians, shown as degrees.
    pub const RADIANS: Self = Self { base: "rad", suffix: "°", factor: 57.295_780_181_884_766, decimals: 0 };
    /// Degrees.
    pub const DEGREES: Self = Self::plain("deg", "°", 0);
    /// A fraction, shown in per cent.
    pub const FRACTION: Self = Self { base: "", suffix: " %", factor: 1e2, decimals: 0 };
    /// A multiple.
    pub const TIMES: Self = Self::plain("", " ×", 2);
    /// Seconds.
    pub const SECONDS: Self = Self::plain("s", " s", 1);
    /// Seconds, shown as milliseconds.
    pub const SECONDS_AS_MS: Self = Self { base: "s", suffix: " ms", factor: 1e3, decimals: 0 };
    /// Per second.
    pub const PER_SECOND: Self = Self::plain("1/s", " /s", 1);
    /// Per metre.
    pub const PER_METRE: Self = Self::plain("1/m", " /m", 1);
    /// Metres per second.
    pub const METRES_PER_SECOND: Self = Self::plain("m/s", " m/s", 1);
    /// Metres per second squared.
    pub const METRES_PER_SECOND2: Self = Self::plain("m/s²", " m/s²", 2);
    /// Metres squared per second squared.
    pub const METRES2_PER_SECOND2: Self = Self::plain("m²/s²", " m²/s²", 2);
    /// Stops of exposure.
    pub const STOPS: Self = Self::plain("stops", " stops", 1);
    /// A number of things, shown in thousands.
    pub const THOUSANDS: Self = Self { base: "", suffix: " k", factor: 1e-3, decimals: 0 };
    /// Pixels.
    pub const PIXELS: Self = Self::plain("px", " px", 0);
    /// Frames per second.
    pub const FRAMES_PER_SECOND: Self = Self::plain("frames/s", "", 2);
    /// Texels along each edge of a square map.
    pub const TEXELS: Self = Self::plain("texels", "²", 0);
    /// Cells along each edge of a cubic map.
    pub const CELLS: Self = Self::plain("cells", "³", 0);
    /// Bytes, shown as GiB.
    pub const BYTES_AS_GIB: Self =
        Self { base: "bytes", suffix: " GiB", factor: 1.0 / (1024.0 * 1024.0 * 1024.0), decimals: 2 };

    const fn plain(base: &'static str, suffix: &'static str, decimals: usize) -> Self {
        Self { base, suffix, factor: 1.0, decimals }
    }
}
