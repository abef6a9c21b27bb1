//! The places of the panels, as they are stored between runs.

use egui_tiles::{Tile, Tree};
use serde::{Deserialize, Serialize};

use crate::window::shelf::{Columns, Side};

/// Where a panel is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Spot {
    Column(Side),
    /// A window over the image.
    Floating,
    /// The second window.
    Second,
}

/// Where a panel is moved to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Place {
    /// Where it is by default.
    Usual,
    /// Above the panel of that title in a column, or at the end of the column.
    Above(Side, Option<&'static str>),
    /// A window over the image, with its corner there.
    Floating(Option<egui::Pos2>),
    /// The second window.
    Second,
}

/// Where each panel is, by its title.
///
/// A panel that no list names is at its usual place. So the default is empty, and a panel that a later version adds has a place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Arrangement {
    /// The columns to the left and to the right, from top to bottom, if they differ from the usual ones.
    columns: [Vec<String>; 2],
    floating: Vec<String>,
    /// The panels of the second window, side by side and in tabs.
    second: Option<Tree<String>>,
    /// Where the second window was on the screen: left, top, width, height, points.
    second_place: Option<[f32; 4]>,
}

impl Arrangement {
    /// Whether every panel is at its usual place.
    #[cfg(test)]
    pub(crate) fn is_usual(&self) -> bool {
        self.columns.iter().all(Vec::is_empty) && self.floating.is_empty() && self.second.is_none()
    }

    /// The panels of the columns, from top to bottom.
    pub(crate) fn columns(&self, usual: &Columns) -> Columns {
        let known = |title: &String| usual.iter().flatten().find(|known| *known == title).copied();
        let mut columns: Columns = Default::default();
        for (column, stored) in columns.iter_mut().zip(&self.columns) {
            column.extend(stored.iter().filter_map(known));
        }
        for (side, usual) in usual.iter().enumerate() {
            for (at, title) in usual.iter().enumerate() {
                let is_elsewhere = self.is_floating(title)
                    || self.is_in_second(title)
                    || columns.iter().any(|column| column.contains(title));
                if is_elsewhere {
                    continue;
                }
                // Below the panel that is above it by default, or the nearest one above that.
                let mut above = usual[..at].iter().rev();
                let column = &mut columns[side];
                let place = above.find_map(|above| column.iter().position(|of| of == above));
                column.insert(place.map_or(0, |place| place + 1), title);
            }
        }
        columns
    }

    /// The panels that float.
    pub(crate) fn floating(&self, usual: &Columns) -> Vec<&'static str> {
        let known = usual.iter().flatten().copied();
        known.filter(|title| self.is_floating(title)).collect()
    }

    /// Where a panel is.
    pub(crate) fn spot(&self, title: &str, usual: &Columns) -> Spot {
        if self.is_floating(title) {
            Spot::Floating
        } else if self.is_in_second(title) {
            Spot::Second
        } else if self.columns(usual)[1].contains(&title) {
            Spot::Column(Side::Right)
        } else {
            Spot::Column(Side::Left)
        }
    }

    fn is_floating(&self, title: &str) -> bool {
        self.floating.iter().any(|of| of == title)
    }

    fn is_in_second(&self, title: &str) -> bool {
        self.second.as_ref().is_some_and(|tree| panes(tree).any(|of| of == title))
    }

    /// Moves a panel.
    pub(crate) fn set(&mut self, title: &'static str, place: Place, usual: &Columns) {
        if let Place::Above(_, Some(above)) = place
            && above == title
        {
            return;
        }
        let mut columns = self.columns(usual);
        for column in &mut columns {
            column.retain(|of| *of != title);
        }
        self.floating.retain(|of| of != title);
        self.remove_from_second(title);
        match place {
            Place::Usual => {}
            Place::Above(side, above) => {
                let column = &mut columns[side as usize];
                let at = above.and_then(|above| column.iter().position(|of| *of == above));
                column.insert(at.unwrap_or(column.len()), title);
            }
            Place::Floating(_) => self.floating.push(title.to_owned()),
            Place::Second => self.add_to_second(title),
        }
        self.columns = columns.map(|column| column.into_iter().map(str::to_owned).collect());
        // What is as usual is not stored, so that a later version may order its panels anew.
        let stored = std::mem::take(&mut self.columns);
        let now = Self { columns: stored.clone(), ..self.clone() }.columns(usual);
        if self.columns(usual) != now {
            self.columns = stored;
        }
    }

    fn add_to_second(&mut self, title: &str) {
        let Some(tree) = &mut self.second else {
            self.second =
                Some(Tree::new_horizontal(egui::Id::unique("second window"), vec![title.to_owned()]));
            return;
        };
        let pane = tree.tiles.insert_pane(title.to_owned());
        match tree.root.and_then(|root| Some((root, tree.tiles.get_mut(root)?))) {
            Some((_, Tile::Container(root))) => root.add_child(pane),
            Some((root, Tile::Pane(_))) => {
                tree.root = Some(tree.tiles.insert_horizontal_tile(vec![root, pane]));
            }
            None => tree.root = Some(pane),
        }
    }

    fn remove_from_second(&mut self, title: &str) {
        if let Some(tree) = &mut self.second {
            while let Some(pane) = tree.tiles.find_pane(&title.to_owned()) {
                tree.remove_recursively(pane);
            }
        }
        self.forget_empty_second();
    }

    /// The panels of the second window, if it is open.
    pub(super) fn second(&mut self) -> Option<&mut Tree<String>> {
        self.second.as_mut()
    }

    /// Whether the second window is open.
    pub(crate) fn has_second(&self) -> bool {
        self.second.is_some()
    }

    /// Where the second window was.
    pub(super) fn second_place(&self) -> Option<egui::Rect> {
        let [left, top, width, height] = self.second_place.filter(|of| of.iter().all(|of| of.is_finite()))?;
        let size = egui::vec2(width, height).clamp(egui::vec2(200.0, 150.0), egui::vec2(8192.0, 8192.0));
        Some(egui::Rect::from_min_size(egui::pos2(left, top), size))
    }

    /// Notes where the second window is.
    pub(super) fn set_second_place(&mut self, place: egui::Rect) {
        self.second_place = Some([place.left(), place.top(), place.width(), place.height()]);
    }

    /// Closes the second window. Its panels return to their columns.
    pub(super) fn close_second(&mut self) {
        self.second = None;
    }

    /// Removes panels that this version does not have or that are elsewhere too, and a window that is left empty.
    pub(crate) fn forget_unknown(&mut self, usual: &Columns) {
        let Self { columns, floating, second, .. } = self;
        let mut seen: Vec<String> = Vec::new();
        let mut is_new = |title: &String| {
            let is_new = usual.iter().flatten().any(|known| known == title) && !seen.contains(title);
            seen.push(title.clone());
            is_new
        };
        for column in columns {
            column.retain(&mut is_new);
        }
        floating.retain(&mut is_new);
        if let Some(tree) = second {
            let wrong: Vec<_> = tree
                .tiles
                .iter()
                .filter(|(_, tile)| matches!(tile, Tile::Pane(title) if !is_new(title)))
                .map(|(id, _)| *id)
                .collect();
            for id in wrong {
                tree.remove_recursively(id);
            }
        }
        self.forget_empty_second();
    }

    pub(super) fn forget_empty_second(&mut self) {
        self.second.take_if(|tree| tree.root.is_none() || panes(tree).next().is_none());
    }
}

fn panes(tree: &Tree<String>) -> impl Iterator<Item = &String> {
    tree.tiles.tiles().filter_map(|tile| match tile {
        Tile::Pane(title) => Some(title),
        Tile::Container(_) => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn usual() -> Columns {
        [vec!["A", "B", "C"], vec!["X", "Y", "Z"]]
    }

    fn moved(moves: &[(&'static str, Place)]) -> Arrangement {
        let mut arrangement = Arrangement::default();
        for (title, place) in moves {
            arrangement.set(title, *place, &usual());
        }
        arrangement
    }

    #[test]
    fn nothing_is_stored_by_default_and_after_the_way_back() {
        assert!(Arrangement::default().is_usual());
        assert_eq!(Arrangement::default().columns(&usual()), usual());
        for place in [Place::Above(Side::Right, Some("Y")), Place::Floating(None), Place::Second] {
            let back = moved(&[("B", place), ("B", Place::Usual)]);
            assert_eq!(back, Arrangement::default(), "{place:?}");
            assert!(!moved(&[("B", place)]).is_usual(), "negative control");
        }
        let back =
            moved(&[("B", Place::Above(Side::Left, None)), ("B", Place::Above(Side::Left, Some("C")))]);
        assert!(back.is_usual());
    }

    #[test]
    fn a_panel_is_in_one_place() {
        let steps = [
            ("B", Place::Floating(None)),
            ("X", Place::Second),
            ("B", Place::Second),
            ("X", Place::Above(Side::Left, Some("A"))),
            ("Y", Place::Above(Side::Right, None)),
            ("B", Place::Floating(None)),
            ("C", Place::Above(Side::Right, Some("Z"))),
        ];
        for until in 0..=steps.len() {
            let arrangement = moved(&steps[..until]);
            let second = arrangement.second.iter().flat_map(panes).cloned();
            let mut all: Vec<String> = second.collect();
            all.extend(arrangement.columns(&usual()).concat().into_iter().map(str::to_owned));
            all.extend(arrangement.floating(&usual()).into_iter().map(str::to_owned));
            all.sort();
            assert_eq!(all, ["A", "B", "C", "X", "Y", "Z"], "after {until} steps");
        }
        let arrangement = moved(&steps);
        assert_eq!(arrangement.columns(&usual()), [vec!["X", "A"], vec!["C", "Z", "Y"]]);
        assert_eq!(arrangement.spot("B", &usual()), Spot::Floating);
        assert_eq!(arrangement.spot("X", &usual()), Spot::Column(Side::Left));
        assert!(arrangement.second.is_none(), "an empty window is closed");
    }

    #[test]
    fn a_panel_dropped_above_itself_stays() {
        assert!(moved(&[("B", Place::Above(Side::Left, Some("B")))]).is_usual());
    }

    #[test]
    fn a_panel_of_a_later_version_has_a_place() {
        let arrangement = moved(&[("C", Place::Above(Side::Left, Some("A")))]);
        let later = [vec!["A", "New", "B", "C"], vec!["First", "X", "Y", "Z"]];
        let [left, right] = arrangement.columns(&later);
        assert_eq!(left, ["C", "A", "New", "B"]);
        assert_eq!(right, ["First", "X", "Y", "Z"]);
    }

    #[test]
    fn what_is_stored_is_read_again_and_what_is_unknown_is_forgotten() {
        let mut stored = moved(&[("A", Place::Second), ("X", Place::Second), ("B", Place::Floating(None))]);
        stored.set_second_place(egui::Rect::from_min_size(egui::pos2(10.0, 20.0), egui::vec2(300.0, 400.0)));
        let text = serde_json::to_string(&stored).expect("text");
        let mut read: Arrangement = serde_json::from_str(&text).expect("an arrangement");
        assert_eq!(read, stored);
        read.forget_unknown(&usual());
        assert_eq!(read, stored);
        let fewer = [vec!["B", "C"], vec!["Y", "Z"]];
        read.forget_unknown(&fewer);
        assert_eq!(read.columns(&fewer), [vec!["C"], vec!["Y", "Z"]]);
        assert!(read.second.is_none());
        assert_eq!(read.spot("B", &fewer), Spot::Floating);
        let empty: Arrangement = serde_json::from_str("{}").expect("defaults");
        assert!(empty.is_usual());
    }
}
