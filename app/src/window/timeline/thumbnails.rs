//! Thumbnails along the timeline: of the parts that have been played, and of all of a take.

use std::sync::Arc;

use egui::{Color32, Context, Rect, TextureId, Ui, pos2, vec2};
use lovelock_base::clock::Stopwatch;
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::files::Access;
use lovelock_render::{Image, Picture, Shrinker};
use lovelock_session::filmstrip::{Filmstrip, FilmstripRequest};
use lovelock_session::render_thread::RenderedImage;
use lovelock_session::window_device::WindowDevice;

use super::Zoom;
use super::scale::Scale;
use crate::window::images::{ShownImage, Textures};
use crate::window::theme;

/// Size of a thumbnail, in pixels and on the screen in points.
const SIZE: [u32; 2] = [64, 36];
/// Height of the lane, points.
pub(super) const HEIGHT: f32 = SIZE[1] as f32 + 4.0;
/// The most thumbnails that are kept.
const MAX: usize = 256;
/// Thumbnails of a take are rendered when nothing has changed for this long, seconds.
const STILL_SECS: f64 = 0.6;

/// A thumbnail and its time.
pub(crate) struct Thumb {
    secs: f64,
    image: ShownImage,
}

/// The inputs of a request for thumbnails of a take.
type Asked = (Arc<Project>, Vec<u64>);

/// All thumbnails.
pub(crate) struct Thumbnails {
    strip: Filmstrip,
    textures: Textures,
    /// Makes thumbnails of images on the window's device.
    shrinker: Option<Shrinker>,
    thumbs: Vec<Thumb>,
    /// The project of the thumbnails: other hair, body, motion or another take makes them outdated.
    of: Option<Arc<Project>>,
    /// The image that was examined last.
    seen: Option<Arc<RenderedImage>>,
    /// The slot that was filled last from an image of the window.
    filled: Option<i64>,
    wanted: Option<(Asked, Stopwatch)>,
    asked: Option<Asked>,
}

impl Thumbnails {
    /// Starts without thumbnails, which will be shown through `textures`. `ctx` is repainted when those of a take are rendered.
    ///
    /// # Errors
    /// The thread cannot be started.
    pub(crate) fn new(
        ctx: &Context,
        device: &WindowDevice,
        textures: &Textures,
    ) -> Result<Self, ProjectError> {
        let wake = ctx.clone();
        let strip = Filmstrip::start(device.clone(), move || crate::window::images::wake(&wake));
        let strip = strip.map_err(|error| {
            ProjectError::work(format!("the thread for thumbnails could not be started: {error}"))
        })?;
        Ok(Self {
            strip,
            textures: textures.clone(),
            shrinker: None,
            thumbs: Vec::new(),
            of: None,
            seen: None,
            filled: None,
            wanted: None,
            asked: None,
        })
    }

    /// The most memory of thumbnails, bytes.
    pub(crate) const MAX_BYTES: u64 = MAX as u64 * Self::BYTES;
    const BYTES: u64 = 4 * SIZE[0] as u64 * SIZE[1] as u64;

    /// The memory of the thumbnails, bytes.
    pub(crate) fn bytes(&self) -> u64 {
        self.thumbs.len() as u64 * Self::BYTES
    }

    /// Forgets all thumbnails, and closes the take that they show.
    pub(crate) fn rest(&mut self) {
        self.forget();
        (self.of, self.seen) = (None, None);
        self.strip.rest();
    }

    /// Forgets all thumbnails, whose device is lost, and asks for those of a take again.
    pub(crate) fn forget(&mut self) {
        self.thumbs.clear();
        (self.shrinker, self.filled, self.asked, self.wanted) = (None, None, None, None);
    }

    /// Collects thumbnails from the window and from the background thread, and requests those that a take still lacks. The lane is
    /// `width` points wide and shows the part `zoom` of `duration_secs`.
    pub(crate) fn update(
        &mut self,
        ctx: &Context,
        (project, access): (&Arc<Project>, &Access),
        painted: Option<&Arc<RenderedImage>>,
        (zoom, duration_secs, width): (Zoom, f64, f32),
    ) {
        let is_other = self.of.as_ref().is_none_or(|of| {
            !Arc::ptr_eq(of, project)
                && (moves(of, project) || (looks(of, project) && !is_drawn_anew(project)))
        });
        if is_other {
            self.thumbs.clear();
            self.filled = None;
            // The current image still shows the project before.
            self.seen = painted.cloned();
        }
        self.of = Some(Arc::clone(project));
        // The next images may show it too, or a mask in false colours.
        let painted = painted.filter(|painted| {
            painted.mask.is_none()
                && (Arc::ptr_eq(project, &painted.project)
                    || has_looks_of_its_own(project)
                    || !looks(project, &painted.project))
        });
        let duration = if duration_secs.is_finite() { duration_secs.max(1e-3) } else { 1e-3 };
        let slots = slots(zoom, duration, width);
        let slot_secs = slot_secs(zoom, duration, width);
        if let Some(painted) = painted
            && !self.seen.as_ref().is_some_and(|seen| Arc::ptr_eq(seen, painted))
        {
            self.seen = Some(Arc::clone(painted));
            let slot = (painted.position_secs / slot_secs).floor() as i64;
            if self.filled != Some(slot) {
                self.filled = Some(slot);
                if let Some(small) = self.shrunk(&painted.image) {
                    self.put(ctx, painted.position_secs, &small, 0.5 * slot_secs);
                }
            }
        }
        for drawn in self.strip.pictures() {
            if self.of.as_ref().is_some_and(|of| !moves(of, &drawn.project)) {
                self.put(ctx, drawn.secs, &drawn.image, 0.25 * slot_secs);
            }
        }
        self.request(ctx, project, access, &slots);
    }

    /// Requests the thumbnails of a take in the visible slots when nothing changes any more.
    fn request(&mut self, ctx: &Context, project: &Arc<Project>, access: &Access, slots: &[f64]) {
        if project.take.file.is_none() {
            if self.asked.take().is_some() {
                self.strip.rest();
            }
            self.wanted = None;
            return;
        }
        let key: Asked = (Arc::clone(project), slots.iter().map(|secs| secs.to_bits()).collect());
        let same = |a: &Asked| Arc::ptr_eq(&a.0, &key.0) && a.1 == key.1;
        if self.asked.as_ref().is_some_and(same) {
            return;
        }
        match &self.wanted {
            Some((wanted, since)) if same(wanted) => {
                if since.secs() >= STILL_SECS {
                    let secs = slots.to_vec();
                    let (project, access) = (Arc::clone(project), access.clone());
                    self.strip.request(FilmstripRequest { project, access, secs, size: SIZE });
                    self.asked = Some(key);
                    self.wanted = None;
                }
            }
            _ => self.wanted = Some((key, Stopwatch::start())),
        }
        ctx.request_repaint_after(std::time::Duration::from_secs_f64(STILL_SECS));
    }

    /// Adds a thumbnail and removes those that are nearer than `near_secs`.
    fn put(&mut self, ctx: &Context, secs: f64, image: &Image, near_secs: f64) {
        let mut shown = ShownImage::default();
        shown.set(ctx, &self.textures, "thumbnail", image, false);
        self.thumbs.retain(|thumb| (thumb.secs - secs).abs() > near_secs);
        if self.thumbs.len() >= MAX {
            self.thumbs.remove(0);
        }
        self.thumbs.push(Thumb { secs, image: shown });
    }

    /// A thumbnail of an image of the window, made where the image is.
    fn shrunk(&mut self, image: &Image) -> Option<Image> {
        match image {
            Image::Memory(picture) => small(picture).map(|small| Image::Memory(Arc::new(small))),
            Image::Device(image) => {
                if self.shrinker.as_ref().is_none_or(|known| !known.gpu().is_same_device(image.gpu())) {
                    self.shrinker = Shrinker::new(image.gpu()).ok();
                }
                Some(Image::Device(self.shrinker.as_mut()?.shrink(image, SIZE)))
            }
        }
    }

    /// Times and textures of all thumbnails.
    pub(crate) fn shown(&self) -> Vec<(f64, TextureId)> {
        self.thumbs.iter().filter_map(|thumb| Some((thumb.secs, thumb.image.texture()?))).collect()
    }
}

/// Whether other hair, another body or another motion is seen.
fn moves(a: &Project, b: &Project) -> bool {
    (&a.hair, &a.body, &a.motion, &a.take) != (&b.hair, &b.body, &b.motion, &b.take)
}

/// Whether the same scene looks different, wherever the camera is.
fn looks(a: &Project, b: &Project) -> bool {
    (&a.look, &a.lights, &a.surroundings, &a.shadow, &a.picture)
        != (&b.look, &b.lights, &b.surroundings, &b.shadow, &b.picture)
        || a.hair != b.hair
}

/// Whether all thumbnails are drawn again after a change, as those of a take are.
fn is_drawn_anew(project: &Project) -> bool {
    project.take.file.is_some()
}

/// Whether what is drawn differs from the project by itself: tracks and a morph change it with the time.
fn has_looks_of_its_own(project: &Project) -> bool {
    project.is_animated() || project.hair.morph.to.is_some()
}

/// Duration of a slot, seconds.
fn slot_secs(zoom: Zoom, duration: f64, width: f32) -> f64 {
    let [from, to] = zoom.shown(duration);
    let count = (width / (SIZE[0] as f32 + 2.0)).floor().clamp(1.0, 64.0);
    ((to - from) / f64::from(count)).max(1e-3)
}

/// Middles of the visible slots, seconds.
fn slots(zoom: Zoom, duration: f64, width: f32) -> Vec<f64> {
    let ([from, to], each) = (zoom.shown(duration), slot_secs(zoom, duration, width));
    let first = (from / each).floor() as i64;
    let count = ((to - from) / each).ceil().clamp(1.0, 65.0) as i64;
    let middles = (first..=first + count).map(|slot| (slot as f64 + 0.5) * each);
    middles.filter(|secs| *secs < to.min(duration)).collect()
}

/// The middle of an image in the aspect ratio of thumbnails, scaled down by averaging.
fn small(picture: &Picture) -> Option<Picture> {
    const SAMPLES: u32 = 4;
    let (width, height) = (picture.width, picture.height);
    if width == 0 || height == 0 || picture.rgba.len() < (width * height * 4) as usize {
        return None;
    }
    let aspect = SIZE[0] as f32 / SIZE[1] as f32;
    let shown = [(height as f32 * aspect).min(width as f32), (width as f32 / aspect).min(height as f32)];
    let corner = [0.5 * (width as f32 - shown[0]), 0.5 * (height as f32 - shown[1])];
    let at = |x: u32, y: u32| {
        let place = |i: u32, axis: usize, most: u32| {
            let part = (i as f32 + 0.5) / (SIZE[axis] * SAMPLES) as f32;
            ((corner[axis] + part * shown[axis]) as u32).min(most - 1)
        };
        let i = ((place(y, 1, height) * width + place(x, 0, width)) * 4) as usize;
        [picture.rgba[i], picture.rgba[i + 1], picture.rgba[i + 2]]
    };
    let mut bytes = Vec::with_capacity((SIZE[0] * SIZE[1] * 4) as usize);
    for y in 0..SIZE[1] {
        for x in 0..SIZE[0] {
            let mut sum = [0_u32; 3];
            for (dx, dy) in (0..SAMPLES).flat_map(|dy| (0..SAMPLES).map(move |dx| (dx, dy))) {
                let pixel = at(x * SAMPLES + dx, y * SAMPLES + dy);
                sum.iter_mut().zip(pixel).for_each(|(sum, v)| *sum += u32::from(v));
            }
            bytes.extend(sum.map(|sum| (sum / (SAMPLES * SAMPLES)) as u8));
            bytes.push(255);
        }
    }
    Some(Picture { width: SIZE[0], height: SIZE[1], rgba: bytes })
}

/// Shows the lane: in each slot the thumbnail that is nearest to its middle.
pub(super) fn lane(
    ui: &Ui,
    lane: Rect,
    scale: Scale,
    zoom: Zoom,
    duration: f64,
    thumbs: &[(f64, TextureId)],
) {
    let painter = ui.painter_at(lane);
    painter.rect_filled(lane, 2.0, theme::page());
    let each = slot_secs(zoom, duration, lane.width());
    for middle in slots(zoom, duration, lane.width()) {
        let off = |thumb: &&(f64, TextureId)| (thumb.0 - middle).abs();
        let near = thumbs.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        let Some((_, texture)) = near.filter(|thumb| off(thumb) <= 0.75 * each) else { continue };
        let size = vec2(SIZE[0] as f32, SIZE[1] as f32);
        let place = Rect::from_center_size(pos2(scale.x(middle), lane.center().y), size);
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(*texture, place, whole, Color32::WHITE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_fill_the_lane_and_stay_inside_the_dance() {
        for (duration, width) in [(9.6, 1200.0), (0.001, 40.0), (36_000.0, 900.0), (2.0, 0.0)] {
            let slots = slots(Zoom::default(), duration, width);
            let each = slot_secs(Zoom::default(), duration, width);
            assert!(!slots.is_empty() && slots.len() <= 65, "{duration} {width}: {}", slots.len());
            assert!(slots.iter().all(|secs| (0.0..duration).contains(secs)));
            assert!(slots.windows(2).all(|pair| (pair[1] - pair[0] - each).abs() < 1e-9 * duration));
        }
    }

    #[test]
    fn a_small_picture_is_the_mean_of_the_middle() {
        // Left half red, right half blue; the upper and lower edge, which are cut, green.
        let (width, height) = (128, 128);
        let pixel = |i: u32| match (i % width, i / width) {
            (_, y) if !(28..100).contains(&y) => [0, 255, 0, 255],
            (x, _) if x < 64 => [200, 0, 0, 255],
            _ => [0, 0, 100, 255],
        };
        let rgba = (0..width * height).flat_map(pixel).collect();
        let image = small(&Picture { width, height, rgba }).expect("a picture");
        assert_eq!([image.width, image.height], [64, 36]);
        assert!(image.rgba.chunks_exact(4).all(|pixel| pixel[1] == 0), "the edges are cut");
        assert_eq!((image.rgba[0], image.rgba[4 * 63 + 2]), (200, 100));
        assert!(small(&Picture::default()).is_none());
    }
}
