//! Natural colours of hair.

use crate::HairLook;

/// A natural colour: pigment, and the share of strands that have none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HairColour {
    /// The name in the interface.
    pub name: &'static str,
    /// Concentration of eumelanin.
    pub eumelanin: f32,
    /// Concentration of pheomelanin.
    pub pheomelanin: f32,
    /// Share of strands without pigment.
    pub grey: f32,
}

/// The natural colours, from dark to light. Concentrations are in the units of [`HairLook::absorption`].
pub const HAIR_COLOURS: [HairColour; 8] = [
    colour("Black", 8.0, 0.0, 0.0),
    colour("Dark brown", 3.0, 0.1, 0.0),
    colour("Brown", 1.3, 0.1, 0.0),
    colour("Auburn", 0.8, 0.5, 0.0),
    colour("Red", 0.3, 0.8, 0.0),
    colour("Blonde", 0.3, 0.05, 0.0),
    colour("Platinum", 0.06, 0.02, 0.0),
    colour("Grey", 3.0, 0.1, 0.6),
];

const fn colour(name: &'static str, eumelanin: f32, pheomelanin: f32, grey: f32) -> HairColour {
    HairColour { name, eumelanin, pheomelanin, grey }
}

impl HairColour {
    /// Gives hair this colour, without dye. The rest of the look stays.
    pub fn apply(&self, look: &mut HairLook) {
        look.eumelanin = self.eumelanin;
        look.pheomelanin = self.pheomelanin;
        look.grey = self.grey;
        look.dye_amount = 0.0;
    }

    /// The natural colour that hair of this look has; `None` for any other colour.
    pub fn of(look: &HairLook) -> Option<&'static Self> {
        HAIR_COLOURS.iter().find(|colour| {
            let mut same = *look;
            colour.apply(&mut same);
            same == *look
        })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use glam::Vec3;
    use lovelock_base::settings::Settings;

    use super::*;

    #[test]
    fn every_colour_is_applied_recognised_and_named_once() {
        let names: BTreeSet<_> = HAIR_COLOURS.iter().map(|colour| colour.name).collect();
        assert_eq!(names.len(), HAIR_COLOURS.len(), "{names:?}");
        for colour in &HAIR_COLOURS {
            let before = HairLook { roughness: 0.3, dye_amount: 0.7, dye: Vec3::X, ..HairLook::default() };
            let mut look = before;
            colour.apply(&mut look);
            let HairColour { eumelanin, pheomelanin, grey, .. } = *colour;
            let wanted = HairLook { eumelanin, pheomelanin, grey, dye_amount: 0.0, ..before };
            assert_eq!(look, wanted, "{}: the rest stays", colour.name);
            assert_eq!(look, look.clamped(), "{} is in range", colour.name);
            assert_eq!(HairColour::of(&look), Some(colour), "{} is no other colour", colour.name);
            assert_eq!(HairColour::of(&before), None, "dyed hair has no natural colour");
        }
    }

    #[test]
    fn colours_look_as_they_are_called() {
        let seen = |name: &str| {
            let mut look = HairLook::default();
            let colour = HAIR_COLOURS.iter().find(|colour| colour.name == name).expect(name);
            colour.apply(&mut look);
            HairLook::body_color(look.absorption())
        };
        let light = |name: &str| seen(name).dot(Vec3::new(0.2126, 0.7152, 0.0722));
        for (darker, lighter) in [
            ("Black", "Dark brown"),
            ("Dark brown", "Brown"),
            ("Brown", "Blonde"),
            ("Blonde", "Platinum"),
            ("Auburn", "Red"),
        ] {
            assert!(light(darker) < light(lighter), "{darker} {lighter}");
        }
        // Dark hair is reddish too, because the darker of two shades has the larger ratio.
        let redness = |name: &str| seen(name).x / seen(name).y;
        for (pale, red) in [("Blonde", "Red"), ("Blonde", "Auburn"), ("Platinum", "Blonde")] {
            assert!(redness(pale) < redness(red), "{pale} {red}");
        }
    }
}
