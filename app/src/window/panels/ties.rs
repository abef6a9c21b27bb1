//! Hair ties: ponytails and buns.

use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::RangeInclusive;

use egui::Ui;
use glam::Vec3;
use lovelock_base::settings::Unit;
use lovelock_groom::{HairTie, Haircut, Scalp, TieKind, TieReach};
use lovelock_project::Project;
use lovelock_project::project::HairSection;

use crate::window::aim::Aim;
use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{Number, choice, entry, note, setting, settings};
use crate::window::panel::Panel;
use crate::window::pointer_tool::PointerTool;
use crate::window::readings::Readings;

const FULL: &str = "The tie limit is reached. Remove a tie first.";

/// Range of the positions of ties, metres.
const REACH: RangeInclusive<f64> = -0.6..=0.6;

/// Ties, and the scissors.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TiesPanel {
    /// The tie that is edited, by its place in the list.
    pub(crate) selected: usize,
    /// Whether it is unfolded; only then the handles of ties are shown.
    pub(crate) unfolded: bool,
}

impl Panel for TiesPanel {
    fn title(&self) -> &'static str {
        "Ties and scissors"
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        list(ui, &mut project.hair, &mut self.selected, readings.scalp);
        scissors(ui, &mut project.hair.cut, readings.tool)
    }

    fn end_pass(&mut self, unfolded: bool) {
        self.unfolded = unfolded;
    }
}

/// The controls of the ties of `hair`. `selected` is the one that is edited and whose handle is shown in the image; a new one is
/// placed on `scalp`.
pub(super) fn list(ui: &mut Ui, hair: &mut HairSection, selected: &mut usize, scalp: Option<&Scalp>) {
    let shipped = hair.shipped_ties();
    let ties = &mut hair.ties;
    *selected = (*selected).min(ties.len().saturating_sub(1));
    ui.horizontal_wrapped(|ui| {
        for (i, tie) in ties.iter().enumerate() {
            let name = format!("{} {}", label(tie.kind), i + 1);
            ui.selectable_value(selected, i, name)
                .hover_tooltip("Shows the controls of this tie, and its handle.");
        }
    });
    ui.horizontal_wrapped(|ui| {
        let full = ties.len() >= HairTie::MAX;
        for (kind, words) in [
            (TieKind::Ponytail, "Gathers the hair at the back of the head and lets it hang."),
            (TieKind::Bun, "Gathers the hair on top of the head and winds it into a bun."),
        ] {
            let button = ui.add_enabled(!full, egui::Button::new(format!("+ {}", label(kind))));
            if button.hover_tooltip(words).disabled_hover_tooltip(FULL).clicked() {
                *selected = ties.len();
                ties.push(new_tie(kind, scalp));
            }
        }
        if let Some(tie) = ties.get(*selected) {
            let is_aside = tie.at.x.abs() > ASIDE;
            let why_not = if full { FULL } else { "Move the tie to one side of the head first." };
            let button = ui.add_enabled(!full && is_aside, egui::Button::new("Mirror"));
            let words = "Adds a matching tie on the other side of the head, for pigtails.";
            if button.hover_tooltip(words).disabled_hover_tooltip(why_not).clicked() {
                mirror(ties, selected);
            }
            if ui.button("Remove").hover_tooltip("Removes this tie and lets its hair fall.").clicked() {
                ties.remove(*selected);
                *selected = selected.saturating_sub(1);
            }
        }
    });
    let Some(tie) = ties.get_mut(*selected) else {
        note(ui, "No ties: the hair falls freely.");
        return;
    };
    let shipped = shipped.get(*selected).copied().unwrap_or_else(|| known_tie(ui, tie.kind, scalp));
    let d = HairTie { kind: tie.kind, ..shipped };
    controls(ui, tie, &d);
}

/// The scissors, and the button that undoes their cuts.
fn scissors(ui: &mut Ui, cut: &mut Haircut, tool: PointerTool) -> Option<Command> {
    let mut clicked = false;
    ui.separator();
    ui.horizontal_wrapped(|ui| {
        let button = ui.selectable_label(tool == PointerTool::Scissors, "Scissors").hover_tooltip(
            "Drag a line across the hair in the image to cut off what is beyond it, seen from the head. Works while the hair moves. \
             Shortcut: X.",
        );
        clicked = button.clicked();
        let grow = ui.add_enabled(!cut.is_empty(), egui::Button::new("Grow back"));
        let grow = grow.hover_tooltip("Undoes all cuts.").disabled_hover_tooltip("There are no cuts.");
        if grow.clicked() {
            *cut = Haircut::default();
        }
    });
    clicked.then_some(Command::Use(PointerTool::Scissors))
}

fn label(kind: TieKind) -> &'static str {
    match kind {
        TieKind::Ponytail => "Ponytail",
        TieKind::Bun => "Bun",
    }
}

fn new_tie(kind: TieKind, scalp: Option<&Scalp>) -> HairTie {
    let toward = match kind {
        TieKind::Ponytail => Vec3::new(0.0, 0.35, -1.0),
        TieKind::Bun => Vec3::new(0.0, 1.0, -0.6),
    };
    scalp.map_or_else(|| HairTie { kind, ..HairTie::default() }, |scalp| HairTie::on(scalp, toward, kind))
}

/// As [`new_tie`], the defaults of a tie that the user has added. Kept for the scalp, because the search for its place takes too long for
/// every pass.
fn known_tie(ui: &Ui, kind: TieKind, scalp: Option<&Scalp>) -> HairTie {
    let of = scalp.map(|scalp| std::ptr::from_ref(scalp).addr());
    let id = egui::Id::unique(("new tie", kind == TieKind::Bun));
    let known: Option<(Option<usize>, HairTie)> = ui.data(|data| data.get_temp(id));
    if let Some((_, tie)) = known.filter(|(known, _)| *known == of) {
        return tie;
    }
    let tie = new_tie(kind, scalp);
    ui.data_mut(|data| data.insert_temp(id, (of, tie)));
    tie
}

fn controls(ui: &mut Ui, tie: &mut HairTie, default: &HairTie) {
    settings(ui, &["kind", "at"], tie, default);
    aim(ui, &mut tie.axis, default.axis);
    settings(ui, &["radius", "tightness"], tie, default);
    if tie.kind == TieKind::Bun {
        settings(ui, &["bun_radius", "bun_coils"], tie, default);
    }
    gathered(ui, tie, default);
}

/// The direction in which hair leaves the tie.
fn aim(ui: &mut Ui, axis: &mut Vec3, default: Vec3) {
    let (before, restored) = (Aim::of(*axis), Aim::of(default));
    let mut aim = before;
    let tip = "Side to which hair leaves the tie: 0 is the back, 90 the dancer's left, 180 the front. The arrow in the image can also \
               be dragged.";
    Number::new("Heading", -PI..=PI, Unit::RADIANS, tip).show(ui, &mut aim.heading, restored.heading);
    let tip = "How steeply hair leaves the tie: 90 is straight up.";
    Number::new("Rise", -FRAC_PI_2..=FRAC_PI_2, Unit::RADIANS, tip).show(ui, &mut aim.rise, restored.rise);
    if aim != before {
        let turned = aim.axis();
        // A restored default has exactly its own bytes.
        *axis = if turned.angle_between(default) < 1e-3 { default } else { turned };
    }
}

/// Which hair a tie gathers, as the panel offers it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Gathered {
    All,
    BehindEars,
    Above,
    Left,
    Right,
    /// On one side of another plane.
    Beyond,
    Patch,
}

impl Gathered {
    fn of(tie: &HairTie) -> Self {
        match tie.reach {
            TieReach::All => Self::All,
            TieReach::BehindEars => Self::BehindEars,
            TieReach::AbovePlane if tie.plane_normal == Vec3::Y => Self::Above,
            TieReach::AbovePlane if tie.plane_normal == Vec3::X => Self::Left,
            TieReach::AbovePlane if tie.plane_normal == Vec3::NEG_X => Self::Right,
            TieReach::AbovePlane => Self::Beyond,
            TieReach::InSphere => Self::Patch,
        }
    }

    fn apply(self, tie: &mut HairTie, d: &HairTie) {
        let plane = |normal| (TieReach::AbovePlane, normal);
        (tie.reach, tie.plane_normal) = match self {
            Self::All => (TieReach::All, d.plane_normal),
            Self::BehindEars => (TieReach::BehindEars, d.plane_normal),
            Self::Above => plane(Vec3::Y),
            Self::Left => plane(Vec3::X),
            Self::Right => plane(Vec3::NEG_X),
            Self::Beyond => plane(tie.plane_normal),
            Self::Patch => (TieReach::InSphere, d.plane_normal),
        };
    }
}

fn gathered(ui: &mut Ui, tie: &mut HairTie, default: &HairTie) {
    let before = Gathered::of(tie);
    let mut options = vec![
        (Gathered::All, "All hair"),
        (Gathered::BehindEars, "Hair behind the ears"),
        (Gathered::Above, "Hair above a height"),
        (Gathered::Left, "Hair on the left"),
        (Gathered::Right, "Hair on the right"),
        (Gathered::Patch, "Hair in a patch"),
    ];
    if before == Gathered::Beyond {
        options.push((Gathered::Beyond, "Hair beyond a plane"));
    }
    let info = &entry::<HairTie>("reach").info;
    let tip = format!("{} Left and right are the dancer's.", info.tooltip());
    let mut chosen = before;
    choice(ui, info.label, &tip, &mut chosen, Gathered::of(default), &options);
    if chosen != before {
        chosen.apply(tie, default);
    }
    match chosen {
        Gathered::All | Gathered::BehindEars | Gathered::Beyond => {}
        Gathered::Above => {
            let tip = "Hair is gathered above this height over the joint of the head.";
            let number = Number::new("Height", REACH, Unit::METRES_AS_CM, tip);
            number.show(ui, &mut tie.plane_point.y, default.plane_point.y);
        }
        Gathered::Left | Gathered::Right => {
            let tip = "Position of the parting: 0 is the middle, positive values are to the dancer's left.";
            let number = Number::new("Parting", REACH, Unit::METRES_AS_CM, tip);
            number.show(ui, &mut tie.plane_point.x, default.plane_point.x);
        }
        Gathered::Patch => patch(ui, tie, default),
    }
}

/// The patch whose hair is gathered.
fn patch(ui: &mut Ui, tie: &mut HairTie, default: &HairTie) {
    let follows = tie.sphere_at_ring;
    settings(ui, &["sphere_radius", "sphere_at_ring"], tie, default);
    if tie.sphere_at_ring {
        return;
    }
    if follows {
        // A patch that is detached from the ring starts where it was.
        tie.sphere_centre = tie.at;
    }
    setting(ui, "sphere_centre", tie, default);
}

/// The smallest distance from the middle at which a tie can be mirrored, metres.
const ASIDE: f32 = 0.01;

/// The same tie on the other side of the head, and the hair parted between the two.
fn mirror(ties: &mut Vec<HairTie>, selected: &mut usize) {
    let Some(tie) = ties.get_mut(*selected) else { return };
    // Hair that both reach would all go to the first.
    let parted = tie.reach == TieReach::AbovePlane && tie.plane_normal.x != 0.0;
    if !parted && tie.reach != TieReach::InSphere {
        let side = if tie.at.x > 0.0 { Gathered::Left } else { Gathered::Right };
        side.apply(tie, &HairTie::default());
        tie.plane_point.x = 0.0;
    }
    let other = tie.mirrored();
    *selected = ties.len();
    ties.push(other);
}
