//! The scenes that Lovelock has written.

use anyhow::{Context as _, ensure};
use glam::{DVec2, DVec3};
use serde::Deserialize;
use std::fs;
use std::path::Path;

/// `scenes.json`, as far as it is compared.
#[derive(Debug, Deserialize)]
pub(super) struct Scenes {
    /// Pixels.
    pub(super) width: u32,
    /// Pixels.
    pub(super) height: u32,
    #[serde(rename = "scenes")]
    pub(super) list: Vec<Scene>,
}

/// A scene; lengths in millimetres.
#[derive(Debug, Deserialize)]
pub(super) struct Scene {
    pub(super) name: String,
    pub(super) strands: u64,
    pub(super) strands_file: String,
    white_strands_file: Option<String>,
    pub(super) image_file: String,
    camera: Camera,
    light: Light,
    fibre: serde_json::Value,
}

#[derive(Debug, PartialEq, Deserialize)]
struct Camera {
    eye: DVec3,
    target: DVec3,
    up: DVec3,
    fov_y_degrees: f64,
}

#[derive(Debug, PartialEq, Deserialize)]
struct Light {
    direction: DVec3,
    irradiance: DVec3,
}

impl Scenes {
    /// Reads `scenes.json` of a folder.
    pub(super) fn read(folder: &Path) -> anyhow::Result<Self> {
        let path = folder.join("scenes.json");
        let text = fs::read_to_string(&path).with_context(|| format!("could not read {}", path.display()))?;
        Self::parse(&text).with_context(|| path.display().to_string())
    }

    fn parse(text: &str) -> anyhow::Result<Self> {
        let scenes: Self =
            serde_json::from_str(text).context("must be what `lovelock bench reference` writes")?;
        ensure!(!scenes.list.is_empty(), "found no scenes; must have one at least");
        ensure!(
            scenes.width > 0 && scenes.height > 0,
            "found a size of {} x {}; must be 1 x 1 at least",
            scenes.width,
            scenes.height
        );
        Ok(scenes)
    }

    /// Fails if a path tracer would not render the same for both folders: variants may differ in our shading alone.
    pub(super) fn ensure_same(&self, folder: &Path, other: &Self, other_folder: &Path) -> anyhow::Result<()> {
        ensure!(
            (self.width, self.height, self.list.len()) == (other.width, other.height, other.list.len()),
            "another size or other scenes than the first variant"
        );
        for (a, b) in self.list.iter().zip(&other.list) {
            let same = a.name == b.name && a.camera == b.camera && a.light == b.light && a.fibre == b.fibre;
            ensure!(
                same,
                "{}: another camera, light or fibre than the first variant; must be the same",
                b.name
            );
            for (file, other_file) in [
                (Some(&a.strands_file), Some(&b.strands_file)),
                (a.white_strands_file.as_ref(), b.white_strands_file.as_ref()),
            ] {
                let Some(file) = file.filter(|_| file == other_file) else { continue };
                let read = |folder: &Path| {
                    let path = folder.join(file);
                    fs::read(&path).with_context(|| format!("could not read {}", path.display()))
                };
                ensure!(
                    read(folder)? == read(other_folder)?,
                    "{}: other strands than those of the first variant; must be the same",
                    b.name
                );
            }
        }
        Ok(())
    }
}

impl Scene {
    /// The direction toward the light in the image, to the right and up, of length 1; up for light along the camera's axis.
    pub(super) fn toward_light(&self) -> DVec2 {
        let forward = self.camera.target - self.camera.eye;
        let right = forward.cross(self.camera.up).normalize_or(DVec3::X);
        let up = right.cross(forward).normalize_or(DVec3::Y);
        let toward = -self.light.direction;
        DVec2::new(toward.dot(right), toward.dot(up)).normalize_or(DVec2::Y)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use serde_json::json;

    /// A scene with the light from the right.
    pub(in crate::reference) fn scene(name: &str) -> serde_json::Value {
        json!({
            "name": name,
            "strands": 2,
            "strands_file": "smooth.txt",
            "image_file": format!("{name}.f32"),
            "camera": { "eye": [0, 0, 500], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y_degrees": 20 },
            "light": { "direction": [-1, 0, 0], "irradiance": [3, 3, 3] },
            "fibre": { "sigma_a": [1, 1, 1] }
        })
    }

    #[test]
    fn the_light_is_found_in_the_image() {
        let mut value = scene("a");
        let toward = |value: &serde_json::Value| {
            serde_json::from_value::<Scene>(value.clone()).expect("a scene").toward_light()
        };
        assert!(toward(&value).distance(DVec2::X) < 1e-12);
        value["light"]["direction"] = json!([0, 0, -1]);
        assert_eq!(toward(&value), DVec2::Y);
        // From behind, the right is on the left.
        value["camera"]["eye"] = json!([0, 0, -500]);
        value["light"]["direction"] = json!([-1, 0, 0]);
        assert!(toward(&value).distance(-DVec2::X) < 1e-12);
    }

    #[test]
    fn a_bad_file_is_refused_in_a_sentence() {
        let good = json!({ "width": 4, "height": 4, "scenes": [scene("a")] });
        assert!(Scenes::parse(&good.to_string()).is_ok());
        let mut unnamed = good.clone();
        unnamed["scenes"][0]["camera"] = json!({ "eye": [0, 0] });
        for (wrong, named) in [
            ("{".to_owned(), "lovelock bench reference"),
            (json!({ "width": 4, "height": 4, "scenes": [] }).to_string(), "no scenes"),
            (json!({ "width": 0, "height": 4, "scenes": [scene("a")] }).to_string(), "0 x 4"),
            (unnamed.to_string(), "lovelock bench reference"),
        ] {
            let error = format!("{:#}", Scenes::parse(&wrong).unwrap_err());
            assert!(error.contains(named), "{error}");
        }
    }

    #[test]
    fn variants_of_other_fibres_are_refused() {
        let folder = std::env::temp_dir();
        let read = |sigma: f64| {
            let mut one = scene("a");
            one["fibre"]["sigma_a"] = json!([sigma, 1, 1]);
            // Strands that cannot be read are not asked for, because the fibres differ.
            Scenes::parse(&json!({ "width": 4, "height": 4, "scenes": [one] }).to_string()).expect("scenes")
        };
        let error = read(1.0).ensure_same(&folder, &read(2.0), &folder).unwrap_err().to_string();
        assert!(error.contains("fibre"), "{error}");
    }
}
