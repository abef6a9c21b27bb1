//! `lovelock bench reference`: scenes of hair for a path tracer, beside our own images of them.
//!
//! A folder gets everything that a path tracer needs to render the same fibres, camera and light, and what Lovelock makes of them:
//! `scenes.json`, the strands of each hairstyle as text, and per scene an image as linear light and one for people.

mod scenes;
mod strands;
mod view;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::{HairLook, Preset, UNPIGMENTED};
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::files::write_whole;
use lovelock_record::write_png;
use lovelock_render::{Backend, Camera, FrameInput, Layers, Picture, Renderer, StrandCount};
use lovelock_session::clock::STEP_SECS;
use lovelock_session::engine::Engine;
use lovelock_session::snapshot::FrameSnapshot;
use serde::Serialize;

pub use scenes::{ReferenceColor, ReferenceLight, ReferenceScene};
use strands::{StrandTexts, drawn_strands};

use crate::bench::load;

/// Millimetres in a metre. Files are in millimetres: rays start anew about 1e-4 units off a surface, which in metres is wider
/// than a hair.
const MM: f32 = 1e3;

/// What to write.
#[derive(Clone, Debug)]
pub struct ReferenceRequest {
    /// The scenes, in order.
    pub scenes: Vec<ReferenceScene>,
    /// The folder, new or not.
    pub out: PathBuf,
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// The number of strands that are drawn, 100 to 120,000, instead of the scene's own. The fewer, the wider they are.
    pub strands: Option<usize>,
    /// What draws.
    pub backend: Backend,
}

/// The contents of `scenes.json`. Lengths in millimetres, in head space: the axes of the head with its joint at the origin.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReferenceReport {
    /// Width of the images, pixels.
    pub width: u32,
    /// Height of the images, pixels.
    pub height: u32,
    /// The device that drew our images.
    pub adapter: String,
    /// The scenes.
    pub scenes: Vec<ReferenceEntry>,
}

/// One scene. Files are relative to the folder.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReferenceEntry {
    /// `HAIR-COLOUR-LIGHT`.
    pub name: String,
    /// Text of control points of cubic B-splines, root first: `x y z radius` per line, an empty line between strands.
    pub strands_file: String,
    /// The same for the strands without pigment, of grey hair; `strands_file` then holds the others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub white_strands_file: Option<String>,
    /// Number of strands.
    pub strands: usize,
    /// Camera.
    pub camera: ReferenceCamera,
    /// Light, the only one.
    pub light: ReferenceIrradiance,
    /// Fibre.
    pub fibre: ReferenceFibre,
    /// Our image as linear light in the primaries of sRGB, before tone mapping: red, green, blue and coverage per pixel as `f32`,
    /// little-endian, rows from the top. Colour is multiplied by coverage.
    pub image_file: String,
    /// Our image as the window would show it.
    pub picture_file: String,
}

/// A pinhole camera with square pixels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReferenceCamera {
    /// Its position.
    pub eye: Vec3,
    /// What it looks at.
    pub target: Vec3,
    /// The direction that is up in the image.
    pub up: Vec3,
    /// Vertical field of view, degrees.
    pub fov_y_degrees: f32,
}

/// A directional light.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReferenceIrradiance {
    /// The direction in which it travels, of length 1.
    pub direction: Vec3,
    /// Irradiance of a surface that faces it, linear sRGB. A diffuse surface of albedo a reflects a / π of it.
    pub irradiance: Vec3,
}

/// The scattering of a fibre: Chiang et al. 2016, "A practical and controllable hair and fur model".
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReferenceFibre {
    /// Absorption per radius, linear sRGB.
    pub sigma_a: Vec3,
    /// That of strands without pigment, of grey hair.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub white_sigma_a: Option<Vec3>,
    /// Roughness along the fibre. Symbol: `beta_m`.
    pub longitudinal_roughness: f32,
    /// Roughness around the fibre. Symbol: `beta_n`.
    pub azimuthal_roughness: f32,
    /// Tilt of the scales in degrees. Negative: they open toward the tip, while the curves run from the root.
    pub scale_tilt_degrees: f32,
    /// Index of refraction.
    pub index: f32,
}

impl ReferenceFibre {
    /// The fibre that the settings of a project describe.
    fn of(look: &HairLook) -> Self {
        Self {
            sigma_a: look.absorption(),
            white_sigma_a: (look.grey > 0.0).then(|| look.absorption() * UNPIGMENTED),
            longitudinal_roughness: look.roughness,
            azimuthal_roughness: look.roughness_around,
            scale_tilt_degrees: -look.scale_tilt.to_degrees(),
            index: look.refraction,
        }
    }
}

/// Renders the scenes, and writes them with everything that a path tracer needs. `change` is applied to the project of each scene.
/// `progress` is called with each scene before it is rendered, and may cancel.
///
/// Strands are those of the settled hair of a body in its rest pose; there is no body in the picture.
///
/// # Errors
/// If the size is out of range, the folder cannot be written, hair cannot be grown, the backend does not exist, those of `change`, or
/// [`ProjectError::Cancelled`].
pub fn write_reference(
    request: &ReferenceRequest,
    change: &dyn Fn(&mut Project) -> Result<(), ProjectError>,
    progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
) -> Result<ReferenceReport, ProjectError> {
    let (width, height) = request.size;
    lovelock_render::check_size(width, height)?;
    std::fs::create_dir_all(&request.out)
        .map_err(|error| ProjectError::output(&request.out, format!("{}: {error}", request.out.display())))?;
    let mut renderer = Renderer::open(request.backend)?;
    let mut entries = Vec::new();
    // Scenes are sorted by hairstyle, which is settled once.
    let mut settled: Option<(Preset, Hair)> = None;
    for &scene in &request.scenes {
        if progress(&scene.to_string()).is_break() {
            return Err(ProjectError::Cancelled);
        }
        let mut project = scene.project();
        if let Some(strands) = request.strands {
            project.picture.strand_number = strands as f32;
        }
        change(&mut project)?;
        if project.picture.strands == StrandCount::BySize {
            let message = "picture.strands: found by-size; must be fixed or stored for a path tracer";
            return Err(ProjectError::option(message));
        }
        let mut hair = match settled.take() {
            Some((preset, hair)) if preset == scene.hair => hair,
            _ => Hair::settle(scene.hair, &project)?,
        };
        entries.push(hair.write(scene, &mut project, &mut renderer, request)?);
        settled = Some((scene.hair, hair));
    }
    let report = ReferenceReport { width, height, adapter: renderer.adapter().to_owned(), scenes: entries };
    let json = serde_json::to_vec_pretty(&report).map_err(ProjectError::work)?;
    write_whole(&request.out.join("scenes.json"), &json)?;
    Ok(report)
}

/// A settled hairstyle.
struct Hair {
    snapshot: Arc<FrameSnapshot>,
    camera: Camera,
    /// The name of the hairstyle.
    id: &'static str,
    /// Its strands in the coordinates of the files. Kept, because making text takes longer than writing it, and grey hair needs it again.
    texts: StrandTexts,
    /// The share of grey strands for which files were written last, and their names: all images of a hairstyle share the files.
    written: Option<(f32, StrandFiles)>,
}

/// The names of the files of strands: all or those with pigment, and those without.
type StrandFiles = (String, Option<String>);

impl Hair {
    /// Settles the hair.
    fn settle(preset: Preset, project: &Project) -> Result<Self, ProjectError> {
        let mut engine = Engine::at_rest(load(project)?, project.simulation, STEP_SECS);
        engine.follow(project);
        engine.settle();
        let snapshot = engine.snapshot();
        let any = Camera { eye: Vec3::Z, target: Vec3::ZERO, fov_y: 1.0, shear: glam::Vec2::ZERO };
        let input = without_body(&snapshot, project, &any);
        let drawn = drawn_strands(&input);
        let camera = view::camera_for(&drawn.points, &input.world_from_head);
        let head_from_world = input.world_from_head.inverse();
        let in_mm = drawn.map(|p| head_from_world.transform_point3(p) * MM, MM);
        Ok(Self { camera, id: preset.id(), texts: in_mm.texts(), snapshot, written: None })
    }

    /// Writes the strands, in two files if some are grey, unless they were written last. Returns the names of the files.
    fn write_strands(&mut self, grey: f32, folder: &Path) -> Result<StrandFiles, ProjectError> {
        if let Some((of_grey, files)) = &self.written
            && of_grey.to_bits() == grey.to_bits()
        {
            return Ok(files.clone());
        }
        let write =
            |name: String, text: &str| write_whole(&folder.join(&name), text.as_bytes()).map(|()| name);
        let files = if grey > 0.0 {
            let [pigmented, white] = self.texts.parted_files(grey);
            let white = write(format!("{}-white.txt", self.id), &white)?;
            (write(format!("{}-pigmented.txt", self.id), &pigmented)?, Some(white))
        } else {
            (write(format!("{}.txt", self.id), &self.texts.file())?, None)
        };
        self.written = Some((grey, files.clone()));
        Ok(files)
    }

    /// Renders a scene with this hair and writes its images.
    fn write(
        &mut self,
        scene: ReferenceScene,
        project: &mut Project,
        renderer: &mut Renderer,
        request: &ReferenceRequest,
    ) -> Result<ReferenceEntry, ProjectError> {
        let (width, height) = request.size;
        let [right, up, back] = view::axes(&self.camera);
        let toward = scene.light.toward();
        let direction = -(right * toward.x + up * toward.y + back * toward.z).normalize_or(Vec3::Y);
        for light in &mut project.lights {
            light.direction = direction;
        }
        let input = without_body(&self.snapshot, project, &self.camera);
        let mut layers = Layers::default();
        renderer.layers(&input, width, height, false, &mut layers)?;
        let image_file = format!("{}.f32", scene.name());
        let bytes: Vec<u8> = layers.light.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        write_whole(&request.out.join(&image_file), &bytes)?;
        let mut picture = Picture::default();
        layers.tone_map(&mut picture);
        let picture_file = format!("{}.png", scene.name());
        write_picture(&request.out.join(&picture_file), &picture)?;
        let head_from_world = input.world_from_head.inverse();
        let point = |p: Vec3| head_from_world.transform_point3(p) * MM;
        let vector = |v: Vec3| head_from_world.transform_vector3(v);
        let (strands_file, white_strands_file) = self.write_strands(project.look.grey, &request.out)?;
        let irradiance = project.lights.iter().filter(|light| light.enabled);
        Ok(ReferenceEntry {
            name: scene.name(),
            strands_file,
            white_strands_file,
            strands: self.texts.count(),
            camera: ReferenceCamera {
                eye: point(self.camera.eye),
                target: point(self.camera.target),
                up: vector(up),
                fov_y_degrees: self.camera.fov_y.to_degrees(),
            },
            light: ReferenceIrradiance {
                direction: vector(direction),
                irradiance: irradiance.map(|light| light.color * light.intensity).sum(),
            },
            fibre: ReferenceFibre::of(&project.look),
            image_file,
            picture_file,
        })
    }
}

/// The input of a renderer, with hair alone.
fn without_body<'a>(snapshot: &'a FrameSnapshot, project: &'a Project, camera: &'a Camera) -> FrameInput<'a> {
    FrameInput { body: None, ..snapshot.measured_input(project, camera) }
}

fn write_picture(path: &Path, picture: &Picture) -> Result<(), ProjectError> {
    write_png(path, picture.width, picture.height, &picture.rgba)
        .map_err(|error| ProjectError::output(path, error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_written_with_all_that_a_path_tracer_needs() {
        let folder = tempfile::tempdir().expect("a folder");
        let request = ReferenceRequest {
            scenes: vec!["reference-smooth-red-back".parse().expect("a scene")],
            out: folder.path().join("scenes"),
            size: (24, 24),
            strands: Some(300),
            backend: Backend::Cpu,
        };
        let mut seen = Vec::new();
        let report = write_reference(&request, &|_| Ok(()), &mut |what| {
            seen.push(what.to_owned());
            ControlFlow::Continue(())
        });
        let report = report.expect("written");
        assert_eq!(seen, ["reference-smooth-red-back"]);
        let [entry] = report.scenes.as_slice() else { panic!("{report:?}") };
        let read = |file: &str| std::fs::read(request.out.join(file)).expect("a file");
        let text = String::from_utf8(read(&entry.strands_file)).expect("text");
        assert_eq!(text.split("\n\n").count(), entry.strands);
        assert_eq!(entry.strands, 300);
        // 100,000 hairs of 80 µm in 300 strands, in millimetres.
        let widest =
            text.lines().filter_map(|line| line.split(' ').nth(3)?.parse::<f32>().ok()).fold(0.0, f32::max);
        assert!((widest * 2.0 - 80e-3 * 100_000.0 / entry.strands as f32).abs() < 0.01, "{widest}");
        let image: Vec<f32> = read(&entry.image_file)
            .chunks_exact(4)
            .map(|bytes| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
            .collect();
        assert_eq!(image.len(), 24 * 24 * 4);
        let covered = image.chunks_exact(4).filter(|pixel| pixel[3] > 0.5).count();
        assert!((100..560).contains(&covered), "{covered} pixels");
        assert!((entry.light.direction.length() - 1.0).abs() < 1e-4);
        assert_eq!(entry.light.irradiance, Vec3::splat(3.0));
        // Light from behind travels toward the camera.
        assert!(entry.light.direction.dot(entry.camera.eye - entry.camera.target) > 0.0);
        let json: serde_json::Value = serde_json::from_slice(&read("scenes.json")).expect("JSON");
        assert_eq!(json["scenes"][0]["name"], "smooth-red-back");
        assert_eq!(json["scenes"][0]["fibre"]["sigma_a"].as_array().map(Vec::len), Some(3));
        assert!(entry.white_strands_file.is_none() && json["scenes"][0]["fibre"]["white_sigma_a"].is_null());
    }

    #[test]
    fn grey_hair_is_written_as_strands_with_and_without_pigment() {
        let folder = tempfile::tempdir().expect("a folder");
        let request = ReferenceRequest {
            scenes: vec!["reference-smooth-grey-front".parse().expect("a scene")],
            out: folder.path().to_owned(),
            size: (24, 24),
            strands: Some(1000),
            backend: Backend::Cpu,
        };
        let report =
            write_reference(&request, &|_| Ok(()), &mut |_| ControlFlow::Continue(())).expect("written");
        let [entry] = report.scenes.as_slice() else { panic!("{report:?}") };
        let count = |file: &str| {
            std::fs::read_to_string(folder.path().join(file)).expect("a file").split("\n\n").count()
        };
        let white_file = entry.white_strands_file.as_ref().expect("white strands");
        let (pigmented, white) = (count(&entry.strands_file), count(white_file));
        println!("{white} of {} strands are white", entry.strands);
        assert_eq!(pigmented + white, entry.strands);
        assert!((540..660).contains(&white), "{white} of 1000, where 60 % are asked for");
        let (dark, light) = (entry.fibre.sigma_a, entry.fibre.white_sigma_a.expect("an absorption"));
        assert!(light.max_element() < 0.1 * dark.max_element(), "{light} {dark}");
    }
}
