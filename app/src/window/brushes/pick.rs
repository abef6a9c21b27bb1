//! The hair under the pointer.

use egui::Pos2;
use glam::Vec3;
use lovelock_groom::Guides;
use lovelock_session::snapshot::FrameSnapshot;

use crate::window::overlay::View;
use crate::window::overlay::head::Head;

/// Hair within this distance of the pointer is under it, points.
const NEAR: f32 = 9.0;
/// A hit this far before another one hides it, metres.
const BEFORE: f32 = 0.01;

/// The place of the nearest hair under a point of the screen, at the instant of the image: on a guide, or on the head where that is
/// nearer. World space; `None` beside the hair.
pub(super) fn hair_at(view: View, head: Head<'_>, snapshot: &FrameSnapshot, at: Pos2) -> Option<Vec3> {
    if !view.place.contains(at) {
        return None;
    }
    let on_head = head.hit(view, at).map(|(place, _)| head.world_from_head.transform_point3(place));
    let on_hair = on_guides(view, &snapshot.guides.guides, at);
    let depth = |place: Vec3| place.distance(view.eye);
    match (on_hair, on_head) {
        (Some(hair), Some(skin)) if depth(skin) < depth(hair) - BEFORE => Some(skin),
        (hair, skin) => hair.or(skin),
    }
}

/// The point of a guide under a point of the screen that is nearest to the camera.
fn on_guides(view: View, guides: &Guides, at: Pos2) -> Option<Vec3> {
    let mut nearest: Option<(f32, Vec3)> = None;
    for guide in 0..guides.count() {
        let mut before: Option<(Pos2, Vec3)> = None;
        for i in 0..guides.points_per_guide {
            let place = guides.point(guide, i);
            let Some(point) = view.to_screen(place) else {
                before = None;
                continue;
            };
            let (from, start) = before.replace((point, place)).unwrap_or((point, place));
            let along = point - from;
            let part = ((at - from).dot(along) / along.length_sq().max(1e-6)).clamp(0.0, 1.0);
            if (from + along * part).distance(at) > NEAR {
                continue;
            }
            let found = start.lerp(place, part);
            let depth = found.distance(view.eye);
            if nearest.is_none_or(|(least, _)| depth < least) {
                nearest = Some((depth, found));
            }
        }
    }
    // Under the pointer itself, at the depth of that hair.
    nearest.map(|(_, found)| view.at_depth_of(at, found))
}
