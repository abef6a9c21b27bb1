//! What brushes did to hair.

use glam::{Quat, Vec2, Vec3};
use lovelock_base::settings::{Setting, Settings};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::guides::{GuideShape, Lengths, reshape_where, shape_of, shorten, turn_links};
use crate::hand::{HandEdit, HandEdits, HandRoots, link_frames, relength, turned_by};
use crate::operate::{Kind, Operate, Subject};

use strands::StrandEdits;

mod strands;

/// What brushes did to hair, place by place of the scalp.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hand {
    /// The edits.
    pub edits: HandEdits,
}

impl Settings for Hand {
    const TABLE: &'static [Setting<Self>] = &[];
}

impl Operate for Hand {
    const KIND: Kind = Kind {
        id: "hand",
        label: "By hand",
        text: "Brush strokes: combing, cutting, curling. They keep their place on the scalp.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        if self.edits.is_empty() {
            return;
        }
        let roots = HandRoots::of(style);
        let edits = self.edits.of_roots(&roots);
        let strengths = scope.guides(style);
        let of = |acts: fn(&HandEdit) -> bool| -> Option<Vec<f32>> {
            let strength = |(edit, strength): (&Option<HandEdit>, &f32)| {
                edit.as_ref().filter(|edit| acts(edit)).map_or(0.0, |_| *strength)
            };
            let all: Vec<f32> = edits.iter().zip(&strengths).map(strength).collect();
            all.iter().any(|strength| *strength != 0.0).then_some(all)
        };
        let edit_of = |shape: &GuideShape| edits[shape.index].as_ref();

        if let Some(strengths) = of(|edit| edit.length != 1.0) {
            reshape_where(style, scope, &strengths, Lengths::Change, |shape| {
                let Some(edit) = edit_of(shape) else { return };
                relength(&mut shape.points, weighted(edit.length, shape.strength).max(HandEdit::LENGTHS[0]));
            });
        }
        // Strands are changed along the guides as they are before a cut.
        let links =
            |guide| shape_of(&style.guides, guide, 1.0, None).map_or(1, |shape| shape.points.len() - 1);
        let links: Vec<usize> = (0..style.guides.count()).map(links).collect();
        if let Some(strengths) = of(|edit| !edit.turns.is_empty()) {
            reshape_where(style, scope, &strengths, Lengths::Keep, |shape| {
                if let Some(edit) = edit_of(shape) {
                    turn(shape, edit, roots.directions[shape.index], scope);
                }
            });
        }
        if of(|edit| edit.kept < 1.0 || edit.removed).is_some() {
            shorten(style, scope, |shape| match edit_of(shape) {
                Some(edit) if edit.removed && shape.strength >= 0.5 => 0.0,
                Some(edit) => weighted(edit.kept, shape.strength).max(0.0),
                None => 1.0,
            });
        }
        StrandEdits { edits: &edits, links: &links, scope }.apply(style);
    }

    fn texts(&self) -> Vec<(&'static str, String)> {
        vec![("edits", self.edits.to_text())]
    }

    fn set_text(&mut self, _name: &str, text: &str) -> Result<(), String> {
        self.edits = HandEdits::from_text(text)?;
        Ok(())
    }
}

/// A factor that acts with a strength.
fn weighted(factor: f32, strength: f32) -> f32 {
    1.0 + (factor - 1.0) * strength
}

fn turn(shape: &mut GuideShape, edit: &HandEdit, outward: Vec3, scope: &Scope<'_>) {
    let count = shape.points.len() - 1;
    let turns = edit.turns_at(count);
    let frames: Vec<Quat> = link_frames(&shape.points, outward);
    let strength = shape.strength;
    turn_links(shape, |i, _, direction| {
        let amount = strength * scope.along((i as f32 + 0.5) / count as f32);
        let turn = turns.get(i).copied().unwrap_or_default() * amount;
        if turn == Vec2::ZERO { direction } else { turned_by(frames[i], turn) }
    });
}
