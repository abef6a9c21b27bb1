//! What the window and its threads keep in memory: given back when nobody sees it any more, and listed in *Statistics*.

use lovelock_project::document::Document;
use lovelock_project::history::History;
use lovelock_record::CACHE_BYTES;
use lovelock_session::scene::SceneLoader;

use super::page::Page;
use super::readings::Fact;
use super::session::Session;
use super::timeline::Thumbnails;
use super::{Media, Pages, Window};

impl Window {
    /// Lets the pages that are not shown give back what they hold.
    pub(super) fn rest_hidden_pages(&mut self) {
        let page = self.layout.page;
        let mut left = false;
        if page != Page::Compare {
            left |= self.pages.compare.leave(self.session.live());
        }
        if page != Page::Wall {
            left |= self.pages.wall.leave();
        }
        if page != Page::Image {
            self.session.leave_image();
        }
        if left {
            self.display.textures.sweep();
        }
    }

    /// Frees everything that was kept for the previous project, because another one replaces it.
    pub(super) fn rest_all(&mut self) {
        self.pages.compare.leave(self.session.live());
        self.pages.compare.forget_project();
        self.pages.wall.leave();
        self.pages.wall.forget_rounds();
        self.session.forget_images();
        self.media.thumbnails.rest();
        self.pages.image.forget_image();
        self.tools.shown_mask = None;
        self.display.textures.sweep();
    }
}

/// What is kept in memory, with the most that it may take.
pub(super) fn kept_in_memory(
    session: &Session,
    pages: &Pages,
    media: &Media,
    document: &Document,
) -> Vec<Fact> {
    let mib = |bytes: u64| format!("{:.1}", bytes as f64 / f64::from(1 << 20));
    let at_most = |bytes: u64, most: u64| format!("{} of {} MiB", mib(bytes), most >> 20);
    let worker = session.worker();
    let mut facts = Vec::new();
    let mut fact = |name, tip, value| facts.push(Fact { name, tip, value });
    let pages = [
        (
            "Single image",
            "Renderer and images of the viewport. Freed while panes or the wall are shown, and with the project.",
            session.painter().held_bytes(),
        ),
        (
            "Panes",
            "Renderers, strands and images of the comparison. Freed when it is closed.",
            session.live().held_bytes(),
        ),
        (
            "Wall",
            "Simulations, renderers and images of the variants. Freed when the wall is closed.",
            pages.wall.held_bytes(),
        ),
    ];
    for (name, tip, bytes) in pages {
        fact(name, tip, format!("{} MiB", mib(bytes)));
    }
    let caches = [
        (
            "Layers",
            "Hairstyles kept between layers, so that a change evaluates only the layers after it. Beyond the limit the \
             first are dropped.",
            worker.layer_bytes(),
            SceneLoader::MAX_LAYER_BYTES,
        ),
        (
            "Undo steps",
            "Projects kept for undo and redo. Beyond the limit the oldest steps are dropped.",
            document.history().bytes(),
            History::MAX_BYTES,
        ),
        (
            "Take",
            "Decoded frames of the playing take. Beyond the limit the least recently shown are dropped.",
            worker.take_bytes(),
            CACHE_BYTES as u64,
        ),
        (
            "Thumbnails",
            "Images along the timeline. Beyond the limit the oldest are dropped.",
            media.thumbnails.bytes(),
            Thumbnails::MAX_BYTES,
        ),
    ];
    for (name, tip, bytes, most) in caches {
        fact(name, tip, at_most(bytes, most));
    }
    if let Some(sound) = media.soundtrack.loaded() {
        let tip = "Samples of the sound of the dance.";
        fact("Sound", tip, format!("{} MiB", mib(sound.sound.bytes())));
    }
    if media.reference.bytes() > 0 {
        fact(
            "Reference picture",
            "The picture over the image.",
            format!("{} MiB", mib(media.reference.bytes())),
        );
    }
    if let Some((database, _)) = lovelock_satf::cache::ready() {
        let tip = "Database for hair drawn as clusters. Kept until the program ends.";
        fact("Database of clusters", tip, format!("{} MiB", mib(database.bytes())));
    }
    facts
}
