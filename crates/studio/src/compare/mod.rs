//! Methods beside each other on the same hair at the same instant, with the truth, the error and the cost.

mod contender;
mod report;

pub use contender::Contender;
pub use report::{
    BandingReport, CompareReport, FlipError, FootprintTruth, Legend, MethodFiles, MethodReport, PointTruth,
    ProbeCurve, ProbeMark, ProbeReport, Reference, SceneFacts, StabilityReport, StageMs, TimeSpread,
    TransmittanceError,
};
