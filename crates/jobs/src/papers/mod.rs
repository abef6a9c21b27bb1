//! `lovelock papers`: the figures and tables of the papers that this program implements, drawn and measured here, on one page.
//!
//! Every paper has a list of figures: entries with what the paper shows and a function that makes ours. The page, the data and the
//! pictures are written as figures are finished, so a run that is stopped keeps them.

mod bertails;
mod curves;
mod figures;
mod folder;
mod mertens;
mod page;
mod report;
mod run;
mod sintorn;
mod studio;
mod xu;

pub use report::{
    CheckReport, CurveReport, FigureReport, PapersReport, PictureReport, PlotReport, TableReport,
};
pub use run::{figure_ids, papers};
pub use studio::PapersRequest;

#[cfg(test)]
mod tests;
