//! Ponytails, buns and pigtails: see [`HairTie`].

use lovelock_groom::{HairTie, Hairstyle, tied_where};

use crate::Scope;
use crate::operate::{Kind, Operate, Subject};

impl Operate for HairTie {
    const KIND: Kind = Kind {
        id: "tie",
        label: "Tie",
        text: "Gathers hair into a ponytail or a bun. Hair that an earlier tie gathers stays in it.",
        subject: Subject::Shape,
    };

    /// A tie either gathers a wisp or does not: it takes those where weight and mask are at least a half.
    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        *style = tied_where(style, std::slice::from_ref(self), scope.obstacle, |root| scope.at(root) >= 0.5);
    }
}
