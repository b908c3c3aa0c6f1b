use aurt_traits::RobotModel;

use crate::uncertainty::noise_bandwidth_factor;
use crate::{CalibrationOptions, NamedRecording, TermScopes};

/// What is known of the load that some of the recordings carry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownLoad {
    /// Its mass, kg.
    pub mass_kg: f64,
    /// Standard deviation of the mass, kg.
    pub mass_std_kg: f64,
    /// Its centre of mass in the frame of the link that carries it, m, where it is known.
    pub centre_of_mass_m: Option<[f64; 3]>,
}

/// What gains are estimated of.
#[derive(Debug, Clone, Copy)]
pub struct GainsOf<'a> {
    /// The robot. With a known load one of its arm terms is a payload with a column of mass.
    pub model: &'a RobotModel,
    /// Recordings, of which some carry the load.
    pub recordings: &'a [NamedRecording],
    /// In which of them each arm term acts.
    pub scopes: &'a TermScopes,
    /// The load; without one there are ratios only.
    pub load: Option<KnownLoad>,
    /// Treatment of rows at rest and of the load torque.
    pub options: &'a CalibrationOptions,
}

impl GainsOf<'_> {
    /// By how much the variance of an estimate exceeds that of independent rows.
    pub(super) fn bandwidth(&self) -> f64 {
        let first = self.recordings.iter().find_map(|r| r.data.segments.first());
        first.map_or(1.0, |s| noise_bandwidth_factor(&s.parallel_filter, s.decimation))
    }
}
