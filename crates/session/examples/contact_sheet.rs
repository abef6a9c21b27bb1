//! Every shadow method with every transparency on every backend that this machine has, on one sheet:
//! `cargo run --release -p lovelock-session --example contact_sheet -- OUT.png [WIDTHxHEIGHT] [STEP]`.
//!
//! One row per method, one column per transparency and backend, as the label above each image says. It also prints the mean FLIP
//! of each image against method `exact` with transparency `exact` on the CPU.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_record::write_png;
use lovelock_render::{Backend, Picture, Renderer, ShadowMethod, Transparency};
use lovelock_session::engine::Engine;
use lovelock_session::scene::{LoadControl, SceneLoader};
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_testkit::flip;

/// Pixels per dot of a letter; also scales the label strip of two lines above each image.
const DOT: usize = 2;
const STRIP: usize = 2 * LINE + 2;
const LINE: usize = 6 * DOT;

/// Letters of three by five dots, one number per row: `a` to `z`, then the hyphen.
const LETTERS: [[u8; 5]; 27] = [
    [2, 5, 7, 5, 5],
    [6, 5, 6, 5, 6],
    [3, 4, 4, 4, 3],
    [6, 5, 5, 5, 6],
    [7, 4, 6, 4, 7],
    [7, 4, 6, 4, 4],
    [3, 4, 5, 5, 3],
    [5, 5, 7, 5, 5],
    [7, 2, 2, 2, 7],
    [1, 1, 1, 5, 2],
    [5, 5, 6, 5, 5],
    [4, 4, 4, 4, 7],
    [5, 7, 7, 5, 5],
    [6, 5, 5, 5, 5],
    [2, 5, 5, 5, 2],
    [6, 5, 6, 4, 4],
    [2, 5, 5, 6, 3],
    [6, 5, 6, 5, 5],
    [3, 4, 2, 1, 6],
    [7, 2, 2, 2, 2],
    [5, 5, 5, 5, 7],
    [5, 5, 5, 5, 2],
    [5, 5, 7, 7, 5],
    [5, 5, 2, 5, 5],
    [5, 5, 2, 2, 2],
    [7, 1, 2, 4, 7],
    [0, 0, 7, 0, 0],
];

/// Pixels in rows from the top, sRGB with alpha.
struct Sheet {
    width: usize,
    height: usize,
    rgba: Vec<u8>,
}

impl Sheet {
    fn new(width: usize, height: usize) -> Self {
        Self { width, height, rgba: [20, 20, 20, 255].repeat(width * height) }
    }

    fn write(&mut self, text: &str, left: usize, top: usize) {
        for (i, letter) in text.bytes().enumerate() {
            let at = if letter == b'-' { 26 } else { usize::from(letter.wrapping_sub(b'a')) };
            let rows = LETTERS.get(at).copied().unwrap_or_default();
            for (y, x) in (0..5 * DOT).flat_map(|y| (0..3 * DOT).map(move |x| (y, x))) {
                let (px, py) = (left + 4 * DOT * i + x, top + y);
                if rows[y / DOT] >> (2 - x / DOT) & 1 == 1 && px < self.width && py < self.height {
                    self.rgba[4 * (py * self.width + px)..][..3].fill(220);
                }
            }
        }
    }

    fn paste(&mut self, picture: &Picture, left: usize, top: usize) {
        let row = 4 * picture.width as usize;
        for (y, line) in picture.rgba.chunks_exact(row).enumerate() {
            self.rgba[4 * ((top + y) * self.width + left)..][..row].copy_from_slice(line);
        }
    }
}

fn frame(project: &Project, step: u64) -> Result<Arc<FrameSnapshot>, Box<dyn Error>> {
    let cancelled = AtomicBool::new(false);
    let mut silent = |_: &str, _: f32| {};
    let mut control = LoadControl { cancelled: &cancelled, progress: &mut silent };
    let (scene, _) = SceneLoader::new().load(project, &Access::new(), &mut control)?;
    let mut engine = Engine::new(scene, project.simulation);
    engine.advance_to_step(step);
    Ok(engine.snapshot())
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let out = args.first().ok_or("expected OUT.png [WIDTHxHEIGHT] [STEP]")?;
    let size = args.get(1).map_or("288x240", String::as_str);
    let (width, height) = size.split_once('x').ok_or("expected a size such as 288x240")?;
    let (width, height): (u32, u32) = (width.parse()?, height.parse()?);
    lovelock_render::check_size(width, height)?;
    let step = args.get(2).map_or(Ok(20), |step| step.parse())?;

    let mut project = Project::default();
    // Keep the head in the middle.
    (project.camera.distance, project.camera.follow_secs, project.camera.azimuth) = (0.75, 0.0, 1.7);
    project.camera.follow_offset.y = 0.04;
    let snapshot = frame(&project, step)?;
    let camera = snapshot.camera(&project.camera);
    let mut draw = |renderer: &mut Renderer, method, transparency| -> Result<Picture, Box<dyn Error>> {
        project.shadow.method = method;
        project.picture.transparency = transparency;
        let mut picture = Picture::default();
        renderer.picture(&snapshot.frame_input(&project, &camera), width, height, &mut picture)?;
        Ok(picture)
    };
    let mut renderers = vec![Renderer::open(Backend::Cpu)?];
    match Renderer::open(Backend::Gpu) {
        Ok(renderer) => renderers.push(renderer),
        Err(error) => eprintln!("CPU only: {error}"),
    }
    let truth = draw(&mut renderers[0], ShadowMethod::Exact, Transparency::Exact)?;
    let cell = [width as usize + 4, height as usize + STRIP];
    let backends = renderers.len();
    let mut sheet =
        Sheet::new(cell[0] * backends * Transparency::ALL.len(), cell[1] * ShadowMethod::ALL.len());
    for (row, &method) in ShadowMethod::ALL.iter().enumerate() {
        for (i, transparency) in Transparency::ALL.into_iter().enumerate() {
            for (k, renderer) in renderers.iter_mut().enumerate() {
                let picture = draw(renderer, method, transparency)?;
                let (left, top) = (cell[0] * (backends * i + k), cell[1] * row);
                sheet.write(method.id(), left + 2, top + 1);
                sheet.write(&format!("{transparency} {}", renderer.backend()), left + 2, top + 1 + LINE);
                sheet.paste(&picture, left, top + STRIP);
                let far = flip(&truth.rgba, &picture.rgba, width, height).mean;
                println!("{method:<20} {transparency:<18} {:<4} {far:.4}", renderer.backend());
            }
        }
    }
    write_png(Path::new(out), sheet.width as u32, sheet.height as u32, &sheet.rgba)?;
    Ok(())
}
