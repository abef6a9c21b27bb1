//! Methods beside each other on the same hair at the same instant, with the truth, the error and the cost.

mod batch;
mod changes;
mod contender;
mod html;
mod live;
mod report;

pub use batch::{CompareRequest, Sweep, compare};
pub use changes::{ChangeReport, StabilityReport};
pub use contender::Contender;
pub(crate) use live::FilmOfPanes;
pub use live::{
    Live, LiveError, LivePane, LiveProbe, LiveRequest, LiveShows, LiveTimes, LiveView, ProbePlace,
    ProbedHair, Sheet, SheetPane, bytes_label, pane_columns,
};
pub use report::{
    BandingReport, CompareReport, FlipError, FootprintTruth, Legend, MethodFiles, MethodReport, NamedTruth,
    PointTruth, ProbeCurve, ProbeMark, ProbeReport, Reference, SceneFacts, StageMs, TimeSpread,
    TransmittanceError,
};
