//! Methods beside each other on the same hair at the same instant, with the truth, the error and the cost.

mod contender;
mod live;
mod report;

pub use contender::Contender;
pub use live::{
    Live, LiveError, LivePane, LiveProbe, LiveRequest, LiveShows, LiveTimes, LiveView, ProbePlace, ProbedHair,
};
pub use report::{
    BandingReport, CompareReport, FlipError, FootprintTruth, Legend, MethodFiles, MethodReport, PointTruth,
    ProbeCurve, ProbeMark, ProbeReport, Reference, SceneFacts, StabilityReport, StageMs, TimeSpread,
    TransmittanceError,
};
