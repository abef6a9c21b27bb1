//! Hair files, written: `.hair` and TressFX 4.

use glam::Vec3;

use super::{Facing, HairFile, HairFormat, UpAxis, rotation_to_head_axes};
use crate::ImportSettings;
use crate::import::Orientation;

impl HairFile {
    /// The same strands in metres, Y up, the face toward +Z, by the unit and axes of `settings`, about the file's origin.
    pub fn in_metres(&self, settings: &ImportSettings) -> Self {
        let orientation = Orientation::resolve(self, settings);
        let mut file = self.clone();
        file.bounds = super::Bounds::EMPTY;
        for point in &mut file.points {
            *point = orientation.head_axes_from_file(*point);
            file.bounds.include(*point);
        }
        let scale = orientation.metres_per_unit;
        file.thickness.iter_mut().flatten().for_each(|width| *width *= scale);
        file.default_thickness = file.default_thickness.map(|width| width * scale);
        // What says that its unit and axes are settled.
        file.format = HairFormat::Usd;
        file
    }

    /// This file, which is in metres with Y up, as Cem Yuksel's `.hair`: metres, Z up, the face toward +Y, as usual there.
    ///
    /// # Errors
    /// In words, a strand of more than 65536 points: the format counts with 16 bits.
    pub fn to_yuksel(&self) -> Result<Vec<u8>, String> {
        let turn = rotation_to_head_axes(UpAxis::Z, Facing::PlusY).inverse();
        let flags: u32 = 0b11
            | u32::from(self.thickness.is_some()) << 2
            | u32::from(self.transparency.is_some()) << 3
            | u32::from(self.colours.is_some()) << 4;
        let mut out = b"HAIR".to_vec();
        for word in [self.strands() as u32, self.points.len() as u32, flags, 0] {
            out.extend(word.to_le_bytes());
        }
        let [r, g, b] = self.default_colour.unwrap_or([0.3, 0.2, 0.1]);
        let (thickness, transparency) =
            (self.default_thickness.unwrap_or(1e-4), self.default_transparency.unwrap_or(0.0));
        out.extend([thickness, transparency, r, g, b].into_iter().flat_map(f32::to_le_bytes));
        out.resize(128, 0);
        for [start, end] in self.first_point.array_windows() {
            let segments = u16::try_from(end - start - 1)
                .map_err(|_| format!("a strand of {} points, and .hair counts to 65536", end - start))?;
            out.extend(segments.to_le_bytes());
        }
        out.extend(self.points.iter().flat_map(|&point| triple(turn * point)));
        for values in [&self.thickness, &self.transparency].into_iter().flatten() {
            out.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        }
        out.extend(self.colours.iter().flatten().flat_map(|&colour| triple(colour.into())));
        Ok(out)
    }

    /// This file, which is in metres with Y up, as TressFX 4: centimetres, as its own files.
    ///
    /// # Errors
    /// In words, strands that differ in their number of points: the format has one number for all.
    pub fn to_tressfx(&self) -> Result<Vec<u8>, String> {
        let counts = || self.first_point.array_windows().map(|[start, end]| end - start);
        let (least, most) = (counts().min().unwrap_or(0), counts().max().unwrap_or(0));
        if least != most {
            return Err(format!("strands of {least} to {most} points, and .tfx has one number for all"));
        }
        let mut out = 4.0_f32.to_le_bytes().to_vec();
        for word in [self.strands() as u32, most, 160] {
            out.extend(word.to_le_bytes());
        }
        out.resize(160, 0);
        for (i, &point) in self.points.iter().enumerate() {
            // The inverse mass: roots are held.
            let free = if (i as u32).is_multiple_of(most) { 0.0_f32 } else { 1.0 };
            out.extend(triple(point * 100.0).into_iter().chain(free.to_le_bytes()));
        }
        Ok(out)
    }
}

fn triple(v: Vec3) -> [u8; 12] {
    let mut bytes = [0; 12];
    for (to, value) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(v.to_array()) {
        *to = value.to_le_bytes();
    }
    bytes
}

#[cfg(test)]
mod tests {
    use crate::{Facing, ImportSettings, Unit, UpAxis, load_hair_bytes};

    /// Two strands of three points, metres, Y up.
    fn hair() -> crate::HairFile {
        let text = "#usda 1.0\n(\n metersPerUnit = 1\n upAxis = \"Y\"\n)\ndef BasisCurves \"a\"\n{\n\
            uniform token type = \"linear\"\nint[] curveVertexCounts = [3, 3]\n\
            point3f[] points = [(0, 0.1, 0.01), (0, 0.2, 0), (0, 0.3, 0), (0.1, 0, 0), (0.2, 0, 0.05), (0.3, 0, 0)]\n\
            float[] widths = [1e-4, 2e-4, 3e-4, 4e-4, 5e-4, 6e-4]\n}\n";
        load_hair_bytes("a.usda", text.as_bytes()).expect("hair")
    }

    #[test]
    fn written_files_come_back() {
        let settings = |unit, up, facing| ImportSettings { unit, up, facing, ..ImportSettings::default() };
        let usual = settings(Unit::Auto, UpAxis::Y, Facing::PlusZ);
        let hair = hair().in_metres(&usual);
        for (name, bytes, settings) in [
            ("a.hair", hair.to_yuksel(), settings(Unit::Metre, UpAxis::Z, Facing::PlusY)),
            ("a.tfx", hair.to_tressfx(), settings(Unit::Centimetre, UpAxis::Y, Facing::PlusZ)),
        ] {
            let back = load_hair_bytes(name, &bytes.expect(name)).expect(name).in_metres(&settings);
            assert_eq!(back.first_point, hair.first_point, "{name}");
            let off = back.points.iter().zip(&hair.points).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            assert!(off < 1e-6, "{name}: {off} m");
            if name == "a.hair" {
                assert_eq!(back.thickness, hair.thickness, "{name}");
            }
            // The control: read in another unit it is not the same.
            assert!(back.in_metres(&usual).points[0].distance(hair.points[1]) > 1e-2, "{name}");
        }
    }

    #[test]
    fn strands_that_differ_are_refused_by_tressfx_in_words() {
        let mut hair = hair();
        hair.points.pop();
        hair.first_point[2] = 5;
        assert!(hair.to_tressfx().is_err_and(|why| why.contains("2 to 3 points")));
    }
}
