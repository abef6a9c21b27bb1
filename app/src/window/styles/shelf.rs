//! The user's own styles, read and drawn on a thread of low priority.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use lovelock_jobs::presets::{Portraits, thumbnail};
use lovelock_project::files::Access;
use lovelock_project::styles::{OwnStyle, OwnStyles, Style};
use lovelock_render::Backend;
use lovelock_session::latest::LatestJob;
use lovelock_session::threads::{background_worker, lower_priority};

/// What the thread has found.
pub(super) enum Found {
    /// Every file of the folder.
    Styles(Vec<OwnStyle>),
    /// The picture of a style, rows of four bytes per pixel from the top.
    Picture { id: String, size: [usize; 2], rgba: Vec<u8> },
}

/// The thread, and what it has found.
pub(super) struct Shelf {
    jobs: LatestJob<()>,
    found: Arc<Mutex<Vec<Found>>>,
    thread: Option<JoinHandle<()>>,
}

impl Shelf {
    /// Starts the thread, which reads the folder at once, draws the pictures that are not in the folder `cache`, and calls `on_found`
    /// for each result.
    pub(super) fn start(
        own: OwnStyles,
        cache: Option<PathBuf>,
        on_found: impl Fn() + Send + Sync + 'static,
    ) -> std::io::Result<Self> {
        let jobs = LatestJob::default();
        let found = Arc::new(Mutex::new(Vec::new()));
        let worker = Worker {
            own,
            cache,
            jobs: jobs.clone(),
            found: Arc::clone(&found),
            on_found: Box::new(on_found),
        };
        let thread = std::thread::Builder::new().name("own styles".to_owned()).spawn(move || worker.run())?;
        jobs.put(());
        Ok(Self { jobs, found, thread: Some(thread) })
    }

    /// Reads the folder again.
    pub(super) fn look(&self) {
        self.jobs.put(());
    }

    /// What was found since the last call.
    pub(super) fn found(&self) -> Vec<Found> {
        std::mem::take(&mut self.found.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Drop for Shelf {
    fn drop(&mut self) {
        self.jobs.close();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

struct Worker {
    own: OwnStyles,
    cache: Option<PathBuf>,
    jobs: LatestJob<()>,
    found: Arc<Mutex<Vec<Found>>>,
    on_found: Box<dyn Fn() + Send + Sync>,
}

impl Worker {
    fn run(self) {
        lower_priority();
        // One thread only, because the window is more important than pictures of styles.
        let alone = background_worker("own styles");
        while self.jobs.next().is_some() {
            // After a panic these pictures are missing, which is acceptable.
            let look = || drop(catch_unwind(AssertUnwindSafe(|| self.look())));
            match &alone {
                Some(alone) => alone.install(look),
                None => look(),
            }
            self.jobs.done(None);
        }
    }

    fn look(&self) {
        let listed = self.own.list();
        self.tell(Found::Styles(listed.clone()));
        let mut portraits = None;
        for own in &listed {
            let Ok(style) = &own.style else { continue };
            if self.is_done() {
                return;
            }
            let Some(file) = self.kept(style).or_else(|| self.draw(&mut portraits, style)) else { continue };
            let [width, height] = thumbnail::SIZE;
            if let Some((width, height, rgba)) = lovelock_record::read_jpeg(&file, width.max(height)) {
                let size = [width as usize, height as usize];
                self.tell(Found::Picture { id: own.id(), size, rgba });
            }
        }
    }

    fn is_done(&self) -> bool {
        self.jobs.is_closed() || self.jobs.has_newer()
    }

    /// The picture that was drawn before.
    fn kept(&self, style: &Style) -> Option<Vec<u8>> {
        use std::io::Read as _;
        let path = thumbnail::path_in(self.cache.as_ref()?, style);
        let mut file = Vec::new();
        std::fs::File::open(path).ok()?.take(1 << 20).read_to_end(&mut file).ok()?;
        Some(file)
    }

    fn draw(&self, portraits: &mut Option<Portraits>, style: &Style) -> Option<Vec<u8>> {
        if portraits.is_none() {
            *portraits = Portraits::open(Backend::Cpu, thumbnail::SIZE).ok();
        }
        let mut access = Access::new();
        if let Some(file) = &style.hair.file {
            access.pick(&file.path);
        }
        let mut open = portraits.take()?.with_access(access);
        let drawn = thumbnail::draw(&mut open, style, &mut |_| {
            if self.is_done() {
                std::ops::ControlFlow::Break(())
            } else {
                std::ops::ControlFlow::Continue(())
            }
        });
        *portraits = Some(open);
        let file = drawn.map_err(|error| tracing::debug!(%error, "no picture of a style")).ok()?;
        if let Some(cache) = &self.cache
            && let Err(error) = thumbnail::keep(&thumbnail::path_in(cache, style), &file)
        {
            tracing::debug!(%error, "the picture of a style is not kept");
        }
        Some(file)
    }

    fn tell(&self, found: Found) {
        self.found.lock().unwrap_or_else(PoisonError::into_inner).push(found);
        (self.on_found)();
    }
}
