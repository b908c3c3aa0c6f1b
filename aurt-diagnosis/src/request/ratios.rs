//! The scale that currents of several drives have in common.

use aurt_calibration::{Gain, Gains, with_deviation};
use aurt_traits::RobotNames;

/// Ratios of torque constants that recordings determine.
#[derive(Debug, Clone, PartialEq)]
pub struct CommonScale {
    /// The joint in whose scale currents are.
    reference: usize,
    /// K_j/K_r and its standard deviation; absent where nothing determines it.
    ratios: Vec<Option<[f64; 2]>>,
}

/// Deviations beyond which two estimates of a ratio differ, by chance on one of seventy arms of six joints: the targets' one is then that of
/// something that has changed.
const SAME: f64 = 3.0;

impl CommonScale {
    pub(super) fn known(gains: &Gains) -> Option<Self> {
        let is_known = |gain: &&Gain| gain.ratio > 0.0 && !gain.is_doubtful();
        let known = |gain: &Gain| Some([gain.ratio, Some(gain).filter(is_known)?.ratio_std_dev?]);
        let ratios: Vec<Option<[f64; 2]>> = gains.joints.iter().map(known).collect();
        let others = ratios.iter().flatten().count() > 1;
        others.then_some(Self { reference: gains.reference, ratios })
    }

    /// True if no ratio of both differs.
    pub(super) fn agrees(&self, other: &Self) -> bool {
        let Some(Some([scale, _])) = other.ratios.get(self.reference) else { return false };
        let both = self.ratios.iter().zip(&other.ratios).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
        both.into_iter()
            .all(|([a, std], [b, other])| (a - b / scale).abs() <= SAME * std.hypot(other / scale))
    }

    /// Factors that bring the measurement to the scale, joint by joint.
    pub(crate) fn factors(&self) -> Vec<f64> {
        self.ratios.iter().map(|ratio| ratio.map_or(1.0, |[ratio, _]| ratio)).collect()
    }

    /// The note on what currents were compared in.
    pub(crate) fn note(&self, names: RobotNames<'_>) -> String {
        let known = self.ratios.iter().enumerate().filter(|(j, _)| *j != self.reference);
        let ratio = |(j, ratio): (usize, &Option<[f64; 2]>)| {
            ratio.map(|[ratio, std]| format!("{} {}", names.joint(j), with_deviation(ratio, std)))
        };
        let ratios: Vec<String> = known.filter_map(ratio).collect();
        let unknown: Vec<usize> = (0..self.ratios.len()).filter(|j| self.ratios[*j].is_none()).collect();
        let mut note = format!(
            "currents are those that the drive of {} would have: torque constants over its own, as motion determines them, are {}",
            names.joint(self.reference),
            ratios.join(", ")
        );
        if !unknown.is_empty() {
            note.push_str(&format!("; for {} nothing determines them", names.joint_list(&unknown)));
        }
        note
    }
}
