//! Thumbnails of a take along its timeline, rendered on a background thread of low priority.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use lovelock_project::Project;
use lovelock_project::error::{Place, ProjectError};
use lovelock_project::files::Access;
use lovelock_render::{CpuRenderer, DeviceImages, Image, Picture};

use crate::latest::{Job, LatestJob};
use crate::scene::SurroundingsLoader;
use crate::take::{CurveInputs, TakePlayer};
use crate::threads::{background_worker, lower_priority};
use crate::window_device::WindowDevice;

/// Which thumbnails to render.
#[derive(Clone, Debug)]
pub struct FilmstripRequest {
    /// A project that plays a take, with the camera and look.
    pub project: Arc<Project>,
    /// The files that it may read.
    pub access: Access,
    /// Times from the start of the take, seconds, in rendering order.
    pub secs: Vec<f64>,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

/// A thumbnail.
#[derive(Clone, Debug)]
pub struct FilmstripPicture {
    /// Its time, seconds.
    pub secs: f64,
    /// The image, in a texture of the window's device if there is one.
    pub image: Image,
    /// The project that it shows.
    pub project: Arc<Project>,
}

/// Renders thumbnails on a thread of its own. A request replaces the previous one, even if that is not finished.
#[derive(Debug)]
pub struct Filmstrip {
    jobs: LatestJob<FilmstripRequest>,
    left: Arc<Mutex<Vec<FilmstripPicture>>>,
    thread: Option<JoinHandle<()>>,
}

impl Filmstrip {
    /// Starts the thread, which calls `on_drawn` after each thumbnail.
    ///
    /// # Errors
    /// If the system cannot create a thread.
    pub fn start(window: WindowDevice, on_drawn: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let jobs = LatestJob::default();
        let left = Arc::new(Mutex::new(Vec::new()));
        let worker = Worker {
            jobs: jobs.clone(),
            left: Arc::clone(&left),
            on_drawn: Box::new(on_drawn),
            open: None,
            surroundings: SurroundingsLoader::default(),
            window,
            textures: None,
        };
        let thread = std::thread::Builder::new().name("filmstrip".to_owned()).spawn(move || worker.run())?;
        Ok(Self { jobs, left, thread: Some(thread) })
    }

    /// Requests thumbnails. Those of an earlier request that are not rendered yet are dropped.
    pub fn request(&self, request: FilmstripRequest) {
        self.jobs.put(request);
    }

    /// Closes the take, and frees what is kept for further requests.
    pub fn rest(&self) {
        self.jobs.rest();
    }

    /// The thumbnails rendered since the last call.
    pub fn pictures(&self) -> Vec<FilmstripPicture> {
        std::mem::take(&mut self.left.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Drop for Filmstrip {
    fn drop(&mut self) {
        self.jobs.close();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// An open take, and how it was opened.
struct Open {
    file: PathBuf,
    access: Access,
    /// Body and motion around curves.
    around: Option<CurveInputs>,
    player: Box<TakePlayer>,
}

/// The thread's own state.
struct Worker {
    jobs: LatestJob<FilmstripRequest>,
    left: Arc<Mutex<Vec<FilmstripPicture>>>,
    on_drawn: Box<dyn Fn() + Send>,
    open: Option<Open>,
    surroundings: SurroundingsLoader,
    window: WindowDevice,
    textures: Option<DeviceImages>,
}

impl Worker {
    fn run(mut self) {
        lower_priority();
        // One thread only, because the window is more important than thumbnails.
        let alone = background_worker("filmstrip");
        let mut renderer = CpuRenderer::default();
        while let Some(job) = self.jobs.next() {
            let Job::Do(request) = job else {
                (self.open, self.textures, renderer) = (None, None, CpuRenderer::default());
                self.surroundings = SurroundingsLoader::default();
                self.left.lock().unwrap_or_else(PoisonError::into_inner).clear();
                self.jobs.done(None);
                continue;
            };
            let mut draw = || {
                // After a panic these thumbnails are missing, which is acceptable.
                catch_unwind(AssertUnwindSafe(|| self.draw(&request, &mut renderer)))
            };
            let drawn = match &alone {
                Some(alone) => alone.install(draw),
                None => draw(),
            };
            match drawn {
                Ok(Ok(())) => {}
                // The window reports problems of the take itself.
                Ok(Err(error)) => {
                    self.open = None;
                    tracing::debug!(%error, "no thumbnails of the take");
                }
                Err(_) => {
                    self.open = None;
                    renderer = CpuRenderer::default();
                }
            }
            self.jobs.done(None);
        }
    }

    fn draw(&mut self, request: &FilmstripRequest, renderer: &mut CpuRenderer) -> Result<(), ProjectError> {
        let Some(file) = &request.project.take.file else { return Ok(()) };
        let around = CurveInputs::of(&file.path, &request.project);
        let same =
            |open: &Open| open.file == file.path && open.access == request.access && open.around == around;
        if !self.open.as_ref().is_some_and(same) {
            let path = request.access.read(Place::Take, file);
            let path = path.map_err(|problem| ProjectError::input(&file.path, problem))?;
            let (player, _) = TakePlayer::open_for(&path, &request.access, &request.project)?;
            let (file, access) = (file.path.clone(), request.access.clone());
            self.open = Some(Open { file, access, around, player: Box::new(player) });
        }
        let Some(Open { player, .. }) = &mut self.open else { return Ok(()) };
        // The window reports problems.
        let picture = self.surroundings.load(&request.project, &request.access, &mut Vec::new());
        player.set_surroundings(picture, Vec::new());
        for &secs in &request.secs {
            if self.jobs.is_closed() || self.jobs.has_newer() {
                return Ok(());
            }
            let snapshot = player.snapshot(secs)?;
            let seen = request.project.seen_at(snapshot.position_secs);
            let camera = snapshot.camera(&seen.camera);
            let mut picture = Picture::default();
            renderer.picture(
                &snapshot.frame_input(&seen, &camera),
                request.size[0],
                request.size[1],
                &mut picture,
            )?;
            let image = Image::on(self.window.images(&mut self.textures), &mut picture);
            let drawn = FilmstripPicture { secs, image, project: Arc::clone(&request.project) };
            self.left.lock().unwrap_or_else(PoisonError::into_inner).push(drawn);
            (self.on_drawn)();
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{recorded, small_project};
    use lovelock_testkit::wait::{wait_for, wait_until};

    /// Asks for one thumbnail and waits for it.
    fn thumbnail(strip: &Filmstrip, project: &Project, access: &Access) -> Picture {
        strip.request(FilmstripRequest {
            project: Arc::new(project.clone()),
            access: access.clone(),
            secs: vec![0.1],
            size: [64, 36],
        });
        let drawn = wait_for("a thumbnail", || strip.pictures().pop());
        Picture::clone(&drawn.image.picture().expect("pixels"))
    }

    #[test]
    fn thumbnails_of_curves_follow_the_body_and_the_motion_of_the_project() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.abc");
        crate::testing::moving_curves(&path, 5);
        let mut access = Access::new();
        access.pick(&path);
        let dancing = crate::take::project_of_cache(&small_project(), &path).expect("a project");
        let mut resting = dancing.clone();
        resting.motion.source = lovelock_project::project::MotionSource::Rest;
        let strip = Filmstrip::start(WindowDevice::default(), || {}).expect("a thread");
        let first = thumbnail(&strip, &dancing, &access);
        assert!(thumbnail(&strip, &dancing, &access) == first, "control: nothing has changed");
        assert!(thumbnail(&strip, &resting, &access) != first, "the body rests now");
    }

    #[test]
    fn thumbnails_of_a_take_show_its_frames() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.take");
        let mut project = small_project();
        recorded(&path, &project, 120, |_, _| {});
        project.set_take(&path);
        let mut access = Access::new();
        access.pick(&path);
        let strip = Filmstrip::start(WindowDevice::default(), || {}).expect("a thread");
        let wanted = [1.5, 0.0, 0.5];
        let project = Arc::new(project);
        let request = FilmstripRequest {
            project: Arc::clone(&project),
            access: access.clone(),
            secs: wanted.to_vec(),
            size: [64, 36],
        };
        // A missing take does not end the thread.
        let mut gone = (*project).clone();
        gone.set_take(folder.path().join("gone.take"));
        strip.request(FilmstripRequest { project: Arc::new(gone), ..request.clone() });
        strip.request(request);
        let mut pictures = Vec::new();
        wait_until("the pictures", || {
            pictures.extend(strip.pictures());
            pictures.len() >= wanted.len()
        });
        let (mut player, _) = TakePlayer::open(&path, &access).expect("a take");
        for (drawn, secs) in pictures.iter().zip(wanted) {
            let snapshot = player.snapshot(secs).expect("a frame");
            let camera = snapshot.camera(&project.camera);
            let mut picture = Picture::default();
            let input = snapshot.frame_input(&project, &camera);
            CpuRenderer::default().picture(&input, 64, 36, &mut picture).expect("a picture");
            assert!(drawn.secs == secs && *drawn.image.picture().expect("pixels") == picture, "{secs}");
        }
        assert!(
            pictures[0].image.picture().expect("pixels") != pictures[1].image.picture().expect("pixels"),
            "the dance goes on"
        );
    }
}
