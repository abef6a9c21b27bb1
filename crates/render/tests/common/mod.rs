//! Tiny scenes, and the renderers that the tests share.
#![allow(dead_code)] // A module of each test, which uses its part.

use std::sync::{Arc, Mutex, OnceLock};

use glam::{Affine3A, Vec3};
use lovelock_appearance::environment::{BackdropPicture, Panorama};
use lovelock_gpu::Gpu;
use lovelock_groom::{
    GroomSettings, GuideFrame, HairLook, HairShading, Hairstyle, PlainHead, StrandSet, Strands, grow,
    interpolate,
};
use lovelock_motion::{Body, Mesh, Skin};
use lovelock_render::{
    Backend, Camera, DeviceImages, FrameInput, GpuRenderer, HairPose, Light, Picture, PictureSettings,
    RenderError, Renderer, ShadowMethod, ShadowSettings, StrandCount,
};

/// The renderer that all tests of a binary share: creating one takes seconds with a software adapter.
fn renderer(backend: Backend) -> Option<&'static Mutex<Renderer>> {
    static RENDERERS: [OnceLock<Option<Mutex<Renderer>>>; 2] = [OnceLock::new(), OnceLock::new()];
    RENDERERS[usize::from(backend == Backend::Cpu)]
        .get_or_init(|| match Renderer::open(backend) {
            Ok(renderer) => Some(Mutex::new(renderer)),
            Err(error) => {
                lovelock_testkit::skip_without_adapter(&error);
                None
            }
        })
        .as_ref()
}

/// A renderer on a device, and images of that device; `None` without an adapter.
pub fn on_device() -> Option<(GpuRenderer, DeviceImages)> {
    let gpu = match Gpu::open() {
        Ok(gpu) => gpu,
        Err(error) => {
            lovelock_testkit::skip_without_adapter(&error);
            return None;
        }
    };
    Some((GpuRenderer::new(&gpu).expect("shaders compile"), DeviceImages::new(&gpu)))
}

/// A scene of strands in front of a camera that looks at the origin from one metre along +Z.
pub struct Scene {
    pub style: Arc<Hairstyle>,
    pub strands: Strands,
    /// The guides that place the hair, in place of `strands`.
    pub guides: Option<GuideFrame>,
    pub look: HairLook,
    pub body: Option<(Arc<Body>, Skin)>,
    pub lights: Vec<Light>,
    pub shadow: ShadowSettings,
    pub camera: Camera,
    pub picture: PictureSettings,
    pub surroundings: Option<Arc<Panorama>>,
    /// The picture behind the scene.
    pub backdrop: Option<Arc<BackdropPicture>>,
}

impl Scene {
    /// Renders it with `backend`.
    pub fn draw_by(&self, backend: Backend, width: u32, height: u32) -> Option<Picture> {
        Some(self.try_draw(backend, width, height)?.expect("a picture"))
    }

    /// Renders it with `backend`, or returns the error.
    pub fn try_draw(
        &self,
        backend: Backend,
        width: u32,
        height: u32,
    ) -> Option<Result<Picture, RenderError>> {
        self.with_renderer(backend, |renderer, input| {
            let mut picture = Picture::default();
            renderer.picture(input, width, height, &mut picture).map(|_| picture)
        })
    }

    /// Calls `draw` with the shared renderer of `backend`; `None` without an adapter.
    pub fn with_renderer<T>(
        &self,
        backend: Backend,
        draw: impl FnOnce(&mut Renderer, &FrameInput) -> T,
    ) -> Option<T> {
        let mut renderer = renderer(backend)?.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        // The axes of a light's map follow the light from image to image. An image without light forgets those of the tests before, which
        // have other lights and not all draw by both backends. If it fails, so does the image that is asked for.
        let dark = FrameInput { lights: &[], ..self.input() };
        let _ = renderer.picture(&dark, 16, 16, &mut Picture::default());
        Some(draw(&mut renderer, &self.input()))
    }

    /// The input of the renderer.
    pub fn input(&self) -> FrameInput<'_> {
        FrameInput {
            style: &self.style,
            hair: self.guides.as_ref().map_or(HairPose::Strands(&self.strands), HairPose::Guides),
            guides: None,
            look: self.look,
            body: self.body.as_ref().map(|(body, skin)| (body, skin)),
            world_from_head: Affine3A::IDENTITY,
            lights: &self.lights,
            shadow: &self.shadow,
            camera: &self.camera,
            picture: &self.picture,
            is_draft: false,
            surroundings: self.surroundings.as_ref(),
            backdrop: self.backdrop.as_ref(),
            known: None,
            carried: None,
        }
    }
}

/// A picture of surroundings with the radiance `of` a row and a column, in 32 rows of 64 columns.
pub fn panorama(of: impl Fn(usize, usize) -> Vec3) -> Arc<Panorama> {
    let pixels: Vec<Vec3> = (0..32 * 64).map(|i| of(i / 64, i % 64)).collect();
    Arc::new(Panorama::from_pixels(64, 32, &pixels).expect("a picture"))
}

/// A head of short hair of 2,000 strands, without the head.
pub fn wig() -> Scene {
    let settings = GroomSettings { wisps: 100, strands_per_wisp: 20, ..GroomSettings::default() };
    let style: Arc<Hairstyle> = Arc::new(grow(&settings, &PlainHead.scalp(48), &PlainHead).expect("hair"));
    let mut strands = Strands::default();
    interpolate(&style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0), &mut strands);
    let mut scene = scene(&[]);
    (scene.style, scene.strands, scene.look) = (style, strands, settings.look);
    scene.shadow.method = ShadowMethod::VoxelMap;
    scene.lights = Light::default_rig();
    scene.camera.target = Vec3::new(0.0, 0.08, 0.0);
    scene.camera.eye = scene.camera.target + Vec3::new(-0.3, 0.15, -0.9);
    scene.picture.strands = StrandCount::Fixed;
    scene
}

/// Fine strands that scatter as fibres, in soft light, in front of a body that receives their shadow.
pub fn soft_wig() -> Scene {
    let mut scene = wig();
    scene.body = Some(grid(-0.16, 0.3, 24, Vec3::splat(0.6)));
    scene.camera.eye = scene.camera.target + Vec3::new(-0.5, 0.15, 0.6);
    scene.lights[0].direction = Vec3::new(0.25, -0.1, -1.0);
    scene.picture.strand_number = 3_000.0;
    scene
}

/// The share of pixels in which some channel differs by more than each of `steps`.
pub fn shares_over<const N: usize>(a: &Picture, b: &Picture, steps: [u8; N]) -> [f32; N] {
    let largest = |(a, b): (&[u8; 4], &[u8; 4])| (0..3).map(|c| a[c].abs_diff(b[c])).max().unwrap_or(0);
    let [a, b] = [a, b].map(|picture| picture.rgba.as_chunks::<4>().0);
    let differences: Vec<u8> = a.iter().zip(b).map(largest).collect();
    steps.map(|step| differences.iter().filter(|&&d| d > step).count() as f32 / a.len() as f32)
}

/// A hairstyle for strands given as points, with default properties.
pub fn scene(lines: &[Vec<Vec3>]) -> Scene {
    let mut first_point = vec![0];
    let mut strands = Strands::default();
    for line in lines {
        for p in line {
            strands.x.push(p.x);
            strands.y.push(p.y);
            strands.z.push(p.z);
        }
        first_point.push(strands.x.len() as u32);
    }
    strands.first_point = first_point.as_slice().into();
    let points = strands.x.len();
    let set = StrandSet {
        wisp: vec![0; lines.len()],
        weights: vec![[1.0, 0.0, 0.0]; lines.len()],
        first_point,
        guide_param: vec![0.0; points],
        offset_normal: vec![0.0; points],
        offset_binormal: vec![0.0; points],
        offset_tangent: vec![0.0; points],
        taper: vec![1.0; points],
        shade: vec![0.5; lines.len()],
        ..StrandSet::default()
    };
    Scene {
        style: Arc::new(Hairstyle { strands: set, ..Hairstyle::default() }),
        strands,
        guides: None,
        look: HairLook {
            real_hairs: lines.len() as f32,
            variation: 0.0,
            shading: HairShading::TwoHighlights,
            roughness: 0.3,
            ..HairLook::default()
        },
        body: None,
        lights: vec![Light { direction: Vec3::new(0.0, -0.6, -0.8), ..Light::default() }],
        shadow: ShadowSettings { method: ShadowMethod::None, ..ShadowSettings::default() },
        camera: Camera { eye: Vec3::Z, target: Vec3::ZERO, fov_y: 0.5, shear: glam::Vec2::ZERO },
        picture: PictureSettings {
            background_top: Vec3::ZERO,
            background_bottom: Vec3::ZERO,
            ground: false,
            strand_opacity: 1.0,
            strands: StrandCount::Stored,
            ambient: 0.5,
            ..PictureSettings::default()
        },
        surroundings: None,
        backdrop: None,
    }
}

/// A square in the plane `z`, `half` metres to each side, facing +Z.
pub fn quad(z: f32, half: f32, color: Vec3) -> (Arc<Body>, Skin) {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let positions: Vec<Vec3> = corners.iter().map(|&(x, y)| Vec3::new(x * half, y * half, z)).collect();
    let normals = vec![Vec3::Z; 4];
    let mesh = Mesh {
        positions: positions.clone(),
        normals: normals.clone(),
        colors: vec![color; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let mut skin = Skin::default();
    skin.positions = positions;
    skin.normals = normals;
    (Arc::new(Body { mesh, ..Body::default() }), skin)
}

/// As [`quad`], divided into `cells` by `cells` squares.
pub fn grid(z: f32, half: f32, cells: u32, color: Vec3) -> (Arc<Body>, Skin) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for row in 0..=cells {
        for column in 0..=cells {
            let at = |i: u32| (i as f32 / cells as f32 * 2.0 - 1.0) * half;
            positions.push(Vec3::new(at(column), at(row), z));
            if row < cells && column < cells {
                let i = row * (cells + 1) + column;
                triangles.extend([[i, i + 1, i + cells + 2], [i, i + cells + 2, i + cells + 1]]);
            }
        }
    }
    let normals = vec![Vec3::Z; positions.len()];
    let mesh = Mesh {
        positions: positions.clone(),
        normals: normals.clone(),
        colors: vec![color; positions.len()],
        triangles,
        ..Mesh::default()
    };
    let mut skin = Skin::default();
    (skin.positions, skin.normals) = (positions, normals);
    (Arc::new(Body { mesh, ..Body::default() }), skin)
}

/// The bytes of the pixel at `x`, `y` from the top left.
pub fn pixel(picture: &Picture, x: u32, y: u32) -> [u8; 4] {
    let i = ((y * picture.width + x) * 4) as usize;
    picture.rgba[i..i + 4].try_into().expect("four bytes")
}

/// A hanging, curled tuft in front of the origin: `strands` of 40 segments, always the same.
pub fn tuft(strands: u32) -> Vec<Vec<Vec3>> {
    (0..strands)
        .map(|i| {
            let (turn, out) = (i as f32 * 2.399_963, 0.03 * ((i as f32 + 0.5) / strands as f32).sqrt());
            let root = Vec3::new(out * turn.cos(), 0.12, out * turn.sin());
            (0..41)
                .map(|j| {
                    let t = j as f32 / 40.0;
                    let curl = 0.006 * t * Vec3::new((18.0 * t + turn).cos(), 0.0, (18.0 * t + turn).sin());
                    root * Vec3::new(1.0 + t, 1.0, 1.0 + t) + Vec3::new(0.0, -0.22 * t, 0.0) + curl
                })
                .collect()
        })
        .collect()
}

/// One hanging, bent strand in front of the origin.
pub fn one_strand() -> Vec<Vec<Vec3>> {
    let at = |j: u32| {
        let t = j as f32 / 20.0;
        Vec3::new(0.05 * t * t, 0.1 - 0.2 * t, 0.02 * t)
    };
    vec![(0..=20).map(at).collect()]
}

/// A board of hanging strands: `across` side by side times `deep` behind each other.
pub fn slab(across: u32, deep: u32) -> Vec<Vec<Vec3>> {
    (0..across * deep)
        .map(|i| {
            let (x, z) = ((i % across) as f32 / across as f32 - 0.5, (i / across) as f32 / deep as f32 - 0.5);
            // Between the rows of the layer in front.
            let x = x + 0.618_034 * (i / across) as f32 / across as f32 % (1.0 / across as f32);
            (0..=8).map(|j| Vec3::new(0.2 * x, 0.1 - 0.025 * j as f32, 0.08 * z)).collect()
        })
        .collect()
}

/// A tuft in front of a wall that receives its shadow, with the lights of the default scene.
pub fn tuft_scene(strands: u32) -> Scene {
    before_wall(&tuft(strands))
}

/// Strands in front of a wall that receives their shadow, with the lights of the default scene.
pub fn before_wall(lines: &[Vec<Vec3>]) -> Scene {
    let mut s = scene(lines);
    s.body = Some(grid(-0.08, 0.3, 48, Vec3::new(0.35, 0.25, 0.2)));
    s.look = HairLook {
        shading: HairShading::TwoHighlights,
        roughness: 0.3,
        real_hairs: 8000.0,
        ..HairLook::default()
    };
    s.lights = Light::default_rig();
    s.shadow = ShadowSettings::default();
    s.picture = PictureSettings { strands: StrandCount::Stored, ambient: 0.5, ..PictureSettings::default() };
    s
}

/// A closed box of 16 cm that faces outward, or inward.
pub fn closed_box(outward: bool) -> (Arc<Body>, Skin) {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 0.16 - 0.08;
    let positions: Vec<Vec3> = (0..8).map(corner).collect();
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let mut triangles: Vec<[u32; 3]> =
        sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    if !outward {
        for triangle in &mut triangles {
            triangle.swap(1, 2);
        }
    }
    let normals: Vec<Vec3> = positions.iter().map(|p| p.normalize_or_zero()).collect();
    let mesh = Mesh {
        positions: positions.clone(),
        normals: normals.clone(),
        colors: (0..8).map(|i| 0.2 + 0.6 * (corner(i) + 0.08) / 0.16).collect(),
        triangles,
        ..Mesh::default()
    };
    let mut skin = Skin::default();
    (skin.positions, skin.normals) = (positions, normals);
    (Arc::new(Body { mesh, ..Body::default() }), skin)
}
