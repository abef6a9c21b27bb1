//! Strands that a file hides: invisible ones, guides or proxies that stand for others, and prototypes of copies.

use lovelock_base::words::counted;

use super::HairFileError;
use super::file::{Hidden, RawHair};

/// The label of the setting that imports hidden strands.
const SETTING: &str = "the setting *Include hidden*";

impl RawHair {
    /// Marks the strands from number `first` on, which were read last, as hidden for a reason, if there is one.
    pub(super) fn hide_from(&mut self, first: usize, why: Option<Hidden>) {
        if why.is_some() {
            self.hidden.resize(first, None);
            self.hidden.resize(self.point_counts.len(), why);
        }
    }

    /// Leaves hidden strands out, or with `include` keeps them. Notes say how many there are. Stand-ins without anything that they
    /// could stand for are kept. Then fills widths and colours that some curves lack.
    ///
    /// # Errors
    /// If every strand is invisible.
    pub(super) fn settled(mut self, name: &str, include: bool) -> Result<Self, HairFileError> {
        self.leave_hidden_out(name, include)?;
        self.fill_missing();
        Ok(self)
    }

    fn leave_hidden_out(&mut self, name: &str, include: bool) -> Result<(), HairFileError> {
        let mut hidden = std::mem::take(&mut self.hidden);
        hidden.resize(self.point_counts.len(), None);
        let count = |why: Option<Hidden>| hidden.iter().filter(|&&mark| mark == why).count();
        let (drawn, invisible) = (count(None), count(Some(Hidden::Invisible)));
        let (stand_ins, prototypes) = (count(Some(Hidden::StandIn)), count(Some(Hidden::Prototype)));
        let mut parts = Vec::new();
        if stand_ins > 0 {
            parts.push(counted(stand_ins, "guide or proxy", "guides and proxies"));
        }
        if prototypes > 0 {
            parts.push(counted(prototypes, "strand of a prototype", "strands of prototypes"));
        }
        if invisible > 0 {
            parts.push(counted(invisible, "hidden strand", "hidden strands"));
        }
        let parts = parts.join(" and ");
        let left_out = |what: &str, count: usize| {
            format!("Left out {what}; {SETTING} imports {}.", if count == 1 { "it" } else { "them" })
        };
        let all = invisible + stand_ins + prototypes;
        let kept: Vec<bool> = if all == 0 {
            return Ok(());
        } else if include {
            self.notes.push(format!("Includes {parts} of the file."));
            return Ok(());
        } else if drawn > 0 {
            self.notes.push(left_out(&parts, all));
            hidden.iter().map(Option::is_none).collect()
        } else if all > invisible {
            let what = match (stand_ins, prototypes) {
                (_, 0) => "guides or proxies",
                (0, _) => "prototypes",
                _ => "guides, proxies or prototypes",
            };
            self.notes.push(format!("All visible strands are {what}, so they are used."));
            if invisible > 0 {
                self.notes.push(left_out(&counted(invisible, "hidden strand", "hidden strands"), invisible));
            }
            hidden.iter().map(|&why| why != Some(Hidden::Invisible)).collect()
        } else {
            return Err(HairFileError::Malformed {
                name: name.to_owned(),
                offset: 0,
                found: format!("{parts} and no visible one"),
                wanted: format!("one visible strand or more, or {SETTING} on"),
            });
        };
        self.keep_strands(&kept);
        Ok(())
    }

    fn keep_strands(&mut self, kept: &[bool]) {
        let of_points: Vec<bool> = (kept.iter().zip(&self.point_counts))
            .flat_map(|(&kept, &count)| std::iter::repeat_n(kept, count as usize))
            .collect();
        keep(&mut self.points, &of_points);
        for array in [&mut self.thickness, &mut self.transparency].into_iter().flatten() {
            keep(array, &of_points);
        }
        if let Some(array) = &mut self.colours {
            keep(array, &of_points);
        }
        keep(&mut self.point_counts, kept);
        self.marks = self.marks.selected((0..kept.len()).filter(|&strand| kept[strand]));
        self.left_out = Some(of_points);
    }
}

/// Keeps the marked elements.
fn keep<T>(values: &mut Vec<T>, marks: &[bool]) {
    let mut marks = marks.iter();
    values.retain(|_| marks.next().is_some_and(|&kept| kept));
}
