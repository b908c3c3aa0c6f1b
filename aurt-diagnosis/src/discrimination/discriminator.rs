use aurt_recording::Recording;

use super::{Doubt, Interval, Outlook, Subject};
use crate::error::DiagnosisError;

/// The doubts of a diagnosis, and what a motion would do about them.
pub trait Discriminator: Sync {
    /// Evidence of a motion that is not recorded yet.
    type Planned: Clone + Send + Sync;

    /// The open questions, those of claims first.
    fn doubts(&self) -> &[Doubt];

    /// The motion of a recording whose measurement is still unknown; what stands in its place is not used.
    ///
    /// # Errors
    /// Those of preprocessing and evaluation, or simulation.
    fn planned(&self, motion: &Recording) -> Result<Self::Planned, DiagnosisError>;

    /// Two motions, one after the other.
    fn and(&self, one: Self::Planned, other: &Self::Planned) -> Self::Planned;

    /// The motions of the present recordings, recorded again for as long as another.
    ///
    /// # Errors
    /// As [`Self::planned`].
    fn recorded_again(&self, other: &Self::Planned) -> Result<Self::Planned, DiagnosisError>;

    /// The outlook of some doubts.
    fn outlook_of(&self, doubts: &[usize], planned: &Self::Planned) -> Vec<Outlook>;

    /// The outlook of every doubt, in the order of [`Self::doubts`].
    fn outlook(&self, planned: &Self::Planned) -> Vec<Outlook> {
        self.outlook_of(&(0..self.doubts().len()).collect::<Vec<_>>(), planned)
    }

    /// Deviations of all parameters of what is claimed, now and with a motion recorded.
    fn intervals(&self, planned: &Self::Planned) -> Vec<(Subject, Vec<Interval>)>;

    /// The largest torque of each joint that the model of the diagnosis predicts, in the measurement's unit; of drives the
    /// largest distance of position and command, rad.
    fn largest<'m>(&self, planned: &'m Self::Planned) -> &'m [f64];

    /// Step and white noise of each joint's positions, rad, as they were recorded; none of commands.
    fn encoders(&self) -> Vec<[f64; 2]> {
        Vec::new()
    }

    /// The expected logarithm of the ratio of likelihoods from which a diagnosis decides rightly with a probability; infinite
    /// where it decides by another measure.
    fn nats_to_decide(&self, _probability: f64) -> f64 {
        f64::INFINITY
    }
}
