//! Hair ties: ponytails and buns.

use egui::Ui;
use glam::Vec3;
use lovelock_groom::{HairTie, Haircut, Scalp, TieKind, TieReach};
use lovelock_project::project::HairSection;

use crate::window::aim::Aim;
use crate::window::control::{Number, choice, note, toggle};

const FULL: &str = "There are as many ties as can be.";

/// The controls of the ties of `hair`. `selected` is the one that is edited, and has its handle in the picture; a new one is
/// placed on `scalp`.
pub(crate) fn ui(ui: &mut Ui, hair: &mut HairSection, selected: &mut usize, scalp: Option<&Scalp>) {
    let ties = &mut hair.ties;
    *selected = (*selected).min(ties.len().saturating_sub(1));
    ui.horizontal_wrapped(|ui| {
        for (i, tie) in ties.iter().enumerate() {
            let name = format!("{} {}", label(tie.kind), i + 1);
            ui.selectable_value(selected, i, name)
                .on_hover_text("Shows the controls of this tie, and its handle.");
        }
    });
    ui.horizontal_wrapped(|ui| {
        let full = ties.len() >= HairTie::MOST;
        for (kind, words) in [
            (TieKind::Ponytail, "Gathers the hair at the back of the head and lets it hang."),
            (TieKind::Bun, "Gathers the hair on top of the head and winds it up."),
        ] {
            let button = ui.add_enabled(!full, egui::Button::new(format!("+ {}", label(kind))));
            if button.on_hover_text(words).on_disabled_hover_text(FULL).clicked() {
                *selected = ties.len();
                ties.push(new_tie(kind, scalp));
            }
        }
        if let Some(tie) = ties.get(*selected) {
            let is_aside = tie.at.x.abs() > ASIDE;
            let why_not = if full { FULL } else { "Move the tie to one side of the head first." };
            let button = ui.add_enabled(!full && is_aside, egui::Button::new("Mirror"));
            let words = "Ties the hair of the other side in the same way: two of them are pigtails.";
            if button.on_hover_text(words).on_disabled_hover_text(why_not).clicked() {
                mirror(ties, selected);
            }
            if ui.button("Remove").on_hover_text("Lets the hair of this tie fall.").clicked() {
                ties.remove(*selected);
                *selected = selected.saturating_sub(1);
            }
        }
    });
    let Some(tie) = ties.get_mut(*selected) else {
        note(ui, "No tie: the hair falls as it grows.");
        return;
    };
    let shipped = hair.preset.ties().get(*selected).copied().unwrap_or_default();
    let d = HairTie { kind: tie.kind, ..shipped };
    controls(ui, tie, &d);
}

/// The scissors, and the way back from their cuts.
pub(crate) fn scissors(ui: &mut Ui, cut: &mut Haircut, held: &mut bool) {
    ui.separator();
    ui.horizontal_wrapped(|ui| {
        let button = ui.selectable_label(*held, "Scissors").on_hover_text(
            "Drag a line across the hair in the picture: what is beyond it, seen from the head, is cut off, while it moves. X takes \
             the scissors and puts them away.",
        );
        if button.clicked() {
            *held = !*held;
        }
        let grow = ui.add_enabled(!cut.is_empty(), egui::Button::new("Grow back"));
        let grow = grow.on_hover_text("Takes all cuts back.").on_disabled_hover_text("Nothing is cut.");
        if grow.clicked() {
            *cut = Haircut::default();
        }
    });
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

fn controls(ui: &mut Ui, tie: &mut HairTie, d: &HairTie) {
    choice(
        ui,
        "Beyond it",
        "What becomes of the hair beyond the tie.",
        &mut tie.kind,
        d.kind,
        &[(TieKind::Ponytail, "Hangs: a ponytail"), (TieKind::Bun, "Is wound up: a bun")],
    );
    let ways = [
        ("Sideways", "Moves the tie toward the dancer's left. It can be dragged in the picture too."),
        ("Upward", "Moves the tie up. It can be dragged in the picture too."),
        ("Forward", "Moves the tie to the front. It can be dragged in the picture too."),
    ];
    let mut at = tie.at.to_array();
    let before = at;
    for (((label, tip), value), default) in ways.into_iter().zip(&mut at).zip(d.at.to_array()) {
        Number::new(label, -0.6..=0.6, tip).centimetres().show(ui, value, default);
    }
    if at != before {
        tie.at = Vec3::from_array(at);
    }
    aim(ui, tie, d);
    Number::new("Ring", 0.004..=0.05, "Radius of the tie's opening.").millimetres().show(
        ui,
        &mut tie.radius,
        d.radius,
    );
    Number::new(
        "Tightness",
        0.0..=1.0,
        "How firmly hair lies on the head before the tie: loose, or combed tight.",
    )
    .percent()
    .show(ui, &mut tie.tightness, d.tightness);
    if tie.kind == TieKind::Bun {
        Number::new("Bun", 0.015..=0.12, "Radius of the bun.").millimetres().show(
            ui,
            &mut tie.bun_radius,
            d.bun_radius,
        );
        let tip = "In how many rounds of the bun its lock turns once about itself: fewer twist it more.";
        Number::new("Coils", 0.5..=8.0, tip).decimals(1).show(ui, &mut tie.bun_coils, d.bun_coils);
    }
    gathers(ui, tie, d);
}

/// Which way hair leaves the tie.
fn aim(ui: &mut Ui, tie: &mut HairTie, d: &HairTie) {
    use std::f32::consts::{FRAC_PI_2, PI};
    let (before, default) = (Aim::of(tie.axis), Aim::of(d.axis));
    let mut aim = before;
    Number::new(
        "Heading",
        -PI..=PI,
        "To which side hair leaves the tie: 0 is to the back, 90 to the dancer's left, 180 to the front. The arrow in the picture can \
         be dragged too.",
    )
    .degrees()
    .show(ui, &mut aim.heading, default.heading);
    Number::new("Rise", -FRAC_PI_2..=FRAC_PI_2, "How steeply hair leaves the tie: 90 is straight up.")
        .degrees()
        .show(ui, &mut aim.rise, default.rise);
    if aim != before {
        let turned = aim.axis();
        // Restored, it is the very direction that it was.
        tie.axis = if turned.angle_between(d.axis) < 1e-3 { d.axis } else { turned };
    }
}

/// Which hair a tie gathers, as it is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Gathers {
    All,
    BehindEars,
    Above,
    Left,
    Right,
    /// On one side of another plane.
    Beyond,
    Patch,
}

impl Gathers {
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

fn gathers(ui: &mut Ui, tie: &mut HairTie, d: &HairTie) {
    let before = Gathers::of(tie);
    let mut options = vec![
        (Gathers::All, "All that is long enough"),
        (Gathers::BehindEars, "What grows behind the ears"),
        (Gathers::Above, "What grows above a height"),
        (Gathers::Left, "What grows on the left"),
        (Gathers::Right, "What grows on the right"),
        (Gathers::Patch, "What grows in a patch"),
    ];
    if before == Gathers::Beyond {
        options.push((Gathers::Beyond, "What grows beyond a plane"));
    }
    let mut chosen = before;
    choice(
        ui,
        "Gathers",
        "Which hair it takes, by where it grows; left and right are the dancer's. Where ties want the same hair, the first has it.",
        &mut chosen,
        Gathers::of(d),
        &options,
    );
    if chosen != before {
        chosen.apply(tie, d);
    }
    match chosen {
        Gathers::All | Gathers::BehindEars | Gathers::Beyond => {}
        Gathers::Above => {
            Number::new("Height", -0.6..=0.6, "Above this height over the head's joint hair is gathered.")
                .centimetres()
                .show(ui, &mut tie.plane_point.y, d.plane_point.y);
        }
        Gathers::Left | Gathers::Right => {
            Number::new(
                "Parting",
                -0.6..=0.6,
                "Where the parting is: 0 is the middle, more is to the dancer's left.",
            )
            .centimetres()
            .show(ui, &mut tie.plane_point.x, d.plane_point.x);
        }
        Gathers::Patch => patch(ui, tie, d),
    }
}

/// The patch whose hair is gathered.
fn patch(ui: &mut Ui, tie: &mut HairTie, d: &HairTie) {
    Number::new("Patch", 0.005..=0.6, "Radius of the patch whose hair is gathered.").centimetres().show(
        ui,
        &mut tie.sphere_radius,
        d.sphere_radius,
    );
    let followed = tie.sphere_at_ring;
    toggle(
        ui,
        "Around the ring",
        "Whether the patch goes where the tie is moved. Off, it stays, and has a place of its own.",
        &mut tie.sphere_at_ring,
        d.sphere_at_ring,
    );
    if tie.sphere_at_ring {
        return;
    }
    if followed {
        // It begins where it was.
        tie.sphere_centre = tie.at;
    }
    let ways = [
        ("Patch sideways", "Moves the patch toward the dancer's left."),
        ("Patch upward", "Moves the patch up."),
        ("Patch forward", "Moves the patch to the front."),
    ];
    let mut centre = tie.sphere_centre.to_array();
    for (((label, tip), value), default) in ways.into_iter().zip(&mut centre).zip(d.sphere_centre.to_array())
    {
        Number::new(label, -0.6..=0.6, tip).centimetres().show(ui, value, default);
    }
    tie.sphere_centre = Vec3::from_array(centre);
}

/// How far from the middle a tie is to be for another one on the other side, metres.
const ASIDE: f32 = 0.01;

/// The same tie on the other side of the head, and the hair parted between the two.
fn mirror(ties: &mut Vec<HairTie>, selected: &mut usize) {
    let Some(tie) = ties.get_mut(*selected) else { return };
    // What both want the first would have.
    let parted = tie.reach == TieReach::AbovePlane && tie.plane_normal.x != 0.0;
    if !parted && tie.reach != TieReach::InSphere {
        let side = if tie.at.x > 0.0 { Gathers::Left } else { Gathers::Right };
        side.apply(tie, &HairTie::default());
        tie.plane_point.x = 0.0;
    }
    let other = tie.mirrored();
    *selected = ties.len();
    ties.push(other);
}
