//! The results of `lovelock papers`, as `papers.json` contains them.

use serde::{Deserialize, Serialize};

/// All figures that were made.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PapersReport {
    /// The version of the program.
    pub papers_version: String,
    /// CPU and number of threads.
    pub machine: String,
    /// The device that drew.
    pub adapter: String,
    /// Whether all figures of the request were made.
    pub complete: bool,
    /// The figures, in the order of the papers.
    pub figures: Vec<FigureReport>,
}

/// One figure or table of a paper, beside ours.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FigureReport {
    /// Its name on the command line.
    pub id: String,
    /// Authors and year of the paper.
    pub paper: String,
    /// Which figures or tables of the paper it stands beside.
    pub title: String,
    /// What the paper shows there.
    pub shows: String,
    /// What differs here; empty if nothing does.
    pub differs: String,
    /// Our images.
    pub pictures: Vec<PictureReport>,
    /// Our curves.
    pub plots: Vec<PlotReport>,
    /// Our numbers, beside published ones where there are any.
    pub tables: Vec<TableReport>,
    /// What must hold.
    pub checks: Vec<CheckReport>,
    /// Why it could not be made; null if it was.
    pub refused: Option<String>,
}

/// An image.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PictureReport {
    /// Its file, relative to the page.
    pub file: String,
    /// What it shows.
    pub caption: String,
    /// The project that draws it, relative to the page; null for an image of numbers.
    pub project: Option<String>,
    /// The command that draws it alone; null for an image of numbers.
    pub command: Option<String>,
}

/// Curves in one field.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PlotReport {
    /// What it shows.
    pub caption: String,
    /// The quantity of each axis with its unit.
    pub axes: [String; 2],
    /// The curves; the first is the truth.
    pub curves: Vec<CurveReport>,
}

/// One curve.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct CurveReport {
    /// Its name.
    pub name: String,
    /// Its points in ascending order of x.
    pub points: Vec<(f32, f32)>,
}

/// A table of text.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TableReport {
    /// What it contains, with the machines.
    pub caption: String,
    /// Headings, the first of which is that of the rows' names.
    pub heads: Vec<String>,
    /// The rows.
    pub rows: Vec<Vec<String>>,
}

/// A claim that must hold.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct CheckReport {
    /// The claim.
    pub claim: String,
    /// The numbers that were found.
    pub found: String,
    /// Whether it holds.
    pub holds: bool,
}

impl PapersReport {
    /// The checks that do not hold, each with the id of its figure.
    pub fn failed(&self) -> Vec<(&str, &CheckReport)> {
        self.figures
            .iter()
            .flat_map(|figure| figure.checks.iter().map(|check| (figure.id.as_str(), check)))
            .filter(|(_, check)| !check.holds)
            .collect()
    }

    /// Number of all checks.
    pub fn checks(&self) -> usize {
        self.figures.iter().map(|figure| figure.checks.len()).sum()
    }
}
