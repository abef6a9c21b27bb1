//! A brush that paints the mask of a layer on the head in the image.

use egui::{Color32, CursorIcon, PointerButton, Pos2, Response, Stroke as Line, Ui};
use glam::Vec3;
use lovelock_groom::Hairstyle;
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_style::{BrushMode, HeadBox, Layer, Mask, MaskBrush};

use super::View;
use super::head::Head;
use crate::window::theme;

/// Hair within this distance of the pointer is under it, points.
const NEAR_HAIR: f32 = 10.0;
/// Points of a circle.
const CIRCLE: u8 = 40;

/// A stroke of the brush.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stroke {
    active: Option<Active>,
}

#[derive(Clone, Debug)]
struct Active {
    layer: u32,
    /// Where the brush was put down last, head space; `None` while the pointer is beside the head.
    last: Option<Vec3>,
    /// The mask of the layer as the stroke left it: the stroke ends when something else changes that, such as an undo.
    left: Mask,
    /// What the stroke has painted. The layer gets it once it differs from before anywhere in the hair.
    mask: Mask,
    acts: bool,
    mode: BrushMode,
}

/// What the brush did in a pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Painted {
    /// A stroke began, which is a new undo step.
    pub(crate) begins: bool,
    /// The pointer paints, so it does not move the camera.
    pub(crate) holds: bool,
    /// A stroke has ended that changed nothing: what it was to do.
    pub(crate) in_vain: Option<BrushMode>,
}

/// A place on the head under the pointer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    /// On the surface, or the root of the hair under the pointer; head space.
    pub(crate) place: Vec3,
    normal: Vec3,
    /// Whether it is the root of hair that hangs beside the head.
    of_hair: bool,
}

/// The place on the head under a position on the screen: on its surface, or the root of the hair there.
pub(crate) fn spot(view: View, head: Head<'_>, snapshot: &FrameSnapshot, at: Pos2) -> Option<Spot> {
    if !view.place.contains(at) {
        return None;
    }
    if let Some((place, normal)) = head.hit(view, at) {
        return Some(Spot { place, normal, of_hair: false });
    }
    let guides = &snapshot.guides.guides;
    let mut nearest = (NEAR_HAIR, None);
    for guide in 0..guides.count() {
        let points = (0..guides.points_per_guide).filter_map(|i| view.to_screen(guides.point(guide, i)));
        let mut before: Option<Pos2> = None;
        for point in points {
            let from = before.replace(point).unwrap_or(point);
            let distance = super::colliders::distance_to_segment(at, from, point);
            if distance < nearest.0 {
                nearest = (distance, Some(guide));
            }
        }
    }
    let rest = &snapshot.scene.style.guides;
    let root = rest.point(nearest.1.filter(|guide| *guide < rest.count())?, 0);
    let normal = head.normal_near(root).unwrap_or(Vec3::Y);
    root.is_finite().then_some(Spot { place: root, normal, of_hair: true })
}

impl Stroke {
    /// Shows the circle of the brush and paints the mask of `layer` while the primary button is down. `erases` inverts adding and erasing: it is
    /// the eraser end of a pen that paints.
    pub(crate) fn paint(
        &mut self,
        ui: &Ui,
        (view, response): (View, &Response),
        (head, snapshot): (Head<'_>, &FrameSnapshot),
        (brush, erases): (&MaskBrush, bool),
        layer: &mut Layer,
    ) -> Painted {
        let (pointer, modifiers, pressed, down) = ui.input(|input| {
            let pointer = &input.pointer;
            let pressed = pointer.button_pressed(PointerButton::Primary);
            (pointer.interact_pos(), input.modifiers, pressed, pointer.primary_down())
        });
        let mode = match (modifiers.command != erases, modifiers.shift) {
            (true, _) => BrushMode::Erase,
            (_, true) => BrushMode::Smooth,
            _ => BrushMode::Add,
        };
        let is_over = response.contains_pointer() || response.is_pointer_button_down_on();
        let under = pointer.filter(|_| is_over).and_then(|at| Some((at, spot(view, head, snapshot, at)?)));
        if let Some((at, spot)) = &under {
            ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
            show(ui, view, head, brush, (*at, spot), mode);
        }
        let mut painted = Painted::default();
        if pressed && response.contains_pointer() && under.is_some() {
            let [left, mask] = [layer.mask.clone(), layer.mask.clone()];
            self.active = Some(Active { layer: layer.id, last: None, left, mask, acts: false, mode });
            painted.begins = true;
        }
        if let Some(active) = &mut self.active {
            painted.holds = true;
            let same = active.layer == layer.id && layer.mask == active.left;
            if same && (down || pressed) {
                active.put_down(snapshot, brush, layer, (under.map(|(_, spot)| spot), mode));
            } else if !same {
                // The button is still down, but what it painted is gone.
                active.layer = u32::MAX;
            }
        }
        if !down {
            let ended = self.active.take();
            painted.in_vain = ended.filter(|of| !of.acts && of.layer == layer.id).map(|of| of.mode);
        }
        painted
    }

    /// Ends a stroke.
    pub(crate) fn end(&mut self) {
        self.active = None;
    }
}

impl Active {
    fn put_down(
        &mut self,
        snapshot: &FrameSnapshot,
        brush: &MaskBrush,
        layer: &mut Layer,
        (spot, mode): (Option<Spot>, BrushMode),
    ) {
        let Some(spot) = spot else {
            self.last = None;
            return;
        };
        let style = &snapshot.scene.style;
        let box_of_head = HeadBox::of(&style.scalp);
        let was_everywhere = self.mask.is_everywhere();
        // What is painted raises the mask, also where its part is turned round.
        let lowers = self.mask.painted().is_some_and(|(_, lowers)| lowers);
        let Some(part) = self.mask.painted_mut() else { return };
        if was_everywhere && mode == BrushMode::Erase {
            // Without a mask the layer acts everywhere: what is erased is taken from that.
            part.map.paint(|_, _| 1.0);
        }
        let mode = match (mode, lowers) {
            (BrushMode::Add, true) => BrushMode::Erase,
            (BrushMode::Erase, true) => BrushMode::Add,
            (mode, _) => mode,
        };
        // Roots of hair jump from strand to strand: each is a dab of its own.
        self.last = Some(match self.last.filter(|_| !spot.of_hair) {
            Some(last) => brush.stroke(&mut part.map, &box_of_head, [last, spot.place], mode),
            None if self.last.is_some_and(|last| last.distance(spot.place) < 0.25 * brush.radius) => {
                self.last.unwrap_or(spot.place)
            }
            None => {
                brush.dab(&mut part.map, &box_of_head, spot.place, mode);
                spot.place
            }
        });
        self.acts = self.acts || differ(style, [&self.left, &self.mask], spot.place);
        if self.acts {
            layer.mask = self.mask.clone();
            self.left = self.mask.clone();
        }
    }
}

/// Two values of a mask that differ by less than this look and act the same.
const SAME: f32 = 1e-3;

/// Whether two masks differ anywhere in the hair: at its roots, where the scalp is hairy, or at a place on it.
fn differ(style: &Hairstyle, masks: [&Mask; 2], place: Vec3) -> bool {
    if masks[0] == masks[1] {
        return false;
    }
    let head = HeadBox::of(&style.scalp);
    let at = |p: Vec3| (masks[0].at(&head, p) - masks[1].at(&head, p)).abs() > SAME;
    let hairy = |i: usize| style.scalp.mask.get(i).is_some_and(|mask| *mask > 0.0);
    let scalp = &style.scalp.positions;
    let near = |i: &usize| scalp[*i].distance_squared(place);
    let nearest = (0..scalp.len()).min_by(|a, b| near(a).total_cmp(&near(b)));
    (nearest.is_some_and(hairy) && at(place))
        || (0..scalp.len()).any(|i| hairy(i) && at(scalp[i]))
        || (0..style.guides.count()).any(|guide| at(style.guides.point(guide, 0)))
}

/// Paints the circle of the brush, and that of the other side.
fn show(ui: &Ui, view: View, head: Head<'_>, brush: &MaskBrush, (at, spot): (Pos2, &Spot), mode: BrushMode) {
    let painter = ui.painter_at(view.place);
    let color = match mode {
        BrushMode::Add => theme::accent(),
        BrushMode::Erase => theme::wrong(),
        BrushMode::Smooth => theme::PLOT[1],
    };
    let circle = |place: Vec3, normal: Vec3, radius: f32, color: Color32, width: f32| {
        let across = normal.any_orthonormal_vector();
        let along = normal.cross(across);
        let points = (0..=CIRCLE).filter_map(|i| {
            let (sin, cos) = (std::f32::consts::TAU * f32::from(i) / f32::from(CIRCLE)).sin_cos();
            view.to_screen(head.world(place + (across * cos + along * sin) * radius))
        });
        painter.line(points.collect(), Line::new(width, color));
    };
    let dark = theme::page().gamma_multiply(0.6);
    circle(spot.place, spot.normal, brush.radius, dark, 3.5);
    circle(spot.place, spot.normal, brush.radius, color, 1.5);
    circle(spot.place, spot.normal, brush.radius * (1.0 - brush.falloff), color.gamma_multiply(0.5), 1.0);
    if brush.mirror {
        let flip = |v: Vec3| Vec3::new(-v.x, v.y, v.z);
        let middle = 2.0 * HeadBox::of(head.scalp).middle.x;
        let place = flip(spot.place) + Vec3::X * middle;
        circle(place, flip(spot.normal), brush.radius, color.gamma_multiply(0.5), 1.0);
    }
    if spot.of_hair
        && let Some(root) = view.to_screen(head.world(spot.place))
    {
        painter.line_segment([at, root], Line::new(1.0, color.gamma_multiply(0.7)));
        painter.circle_stroke(at, 5.0, Line::new(1.5, color));
    }
}
