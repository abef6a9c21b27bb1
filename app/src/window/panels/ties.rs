//! Hair ties: ponytails and buns.

use egui::Ui;
use glam::Vec3;
use lovelock_studio::HairSection;
use lovelock_studio::groom::{HairTie, Haircut, Scalp, TieKind, TieReach};

use crate::window::control::{Number, choice, note};

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
            if button
                .on_hover_text(words)
                .on_disabled_hover_text("There are as many ties as can be.")
                .clicked()
            {
                *selected = ties.len();
                ties.push(new_tie(kind, scalp));
            }
        }
        if !ties.is_empty() && ui.button("Remove").on_hover_text("Lets the hair of this tie fall.").clicked()
        {
            ties.remove(*selected);
            *selected = selected.saturating_sub(1);
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
    let mut rise = rise(tie.axis);
    let before = rise;
    Number::new(
        "Rise",
        -std::f32::consts::FRAC_PI_2..=std::f32::consts::FRAC_PI_2,
        "How steeply hair leaves the tie: 90 is straight up.",
    )
    .degrees()
    .show(ui, &mut rise, self::rise(d.axis));
    if rise != before {
        let turned = with_rise(tie.axis, rise);
        // Restored, it is the very direction that it was.
        let restored = turned.angle_between(d.axis) < 1e-3;
        tie.axis = if restored { d.axis } else { turned };
    }
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
        Number::new("Coils", 0.5..=8.0, "How often hair goes around the bun.").decimals(1).show(
            ui,
            &mut tie.bun_coils,
            d.bun_coils,
        );
    }
    choice(
        ui,
        "Gathers",
        "Which hair it takes, by where it grows.",
        &mut tie.reach,
        d.reach,
        &[
            (TieReach::All, "All that is long enough"),
            (TieReach::BehindEars, "What grows behind the ears"),
            (TieReach::AbovePlane, "What grows above a height"),
            (TieReach::InSphere, "What grows in a patch"),
        ],
    );
    match tie.reach {
        TieReach::All | TieReach::BehindEars => {}
        TieReach::AbovePlane => {
            Number::new("Height", -0.6..=0.6, "Above this height over the head's joint hair is gathered.")
                .centimetres()
                .show(ui, &mut tie.plane_point.y, d.plane_point.y);
        }
        TieReach::InSphere => {
            Number::new("Patch", 0.005..=0.6, "Radius of the patch whose hair is gathered.")
                .centimetres()
                .show(ui, &mut tie.sphere_radius, d.sphere_radius);
        }
    }
}

/// Angle of a direction above the horizon, radians.
fn rise(axis: Vec3) -> f32 {
    axis.normalize_or(Vec3::NEG_Z).y.clamp(-1.0, 1.0).asin()
}

/// The direction toward the same side that rises by that angle.
fn with_rise(axis: Vec3, rise: f32) -> Vec3 {
    let level = Vec3::new(axis.x, 0.0, axis.z).normalize_or(Vec3::NEG_Z);
    level * rise.cos().max(1e-4) + Vec3::Y * rise.sin()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rise_keeps_its_side_and_comes_back() {
        let axis = Vec3::new(0.4, 0.3, -1.0);
        for angle in [-1.2, 0.0, 0.7, 1.5] {
            let turned = with_rise(axis, angle);
            assert!((rise(turned) - angle).abs() < 1e-3);
            assert!((turned.x / turned.z - axis.x / axis.z).abs() < 1e-3);
        }
    }
}
