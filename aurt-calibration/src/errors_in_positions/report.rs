use aurt_traits::{RobotModel, RobotNames};
use serde::{Deserialize, Serialize};

use super::shift::Shift;

/// Beyond this share of noise in accelerations first order is not enough (docs/estimation.md).
const OVERWHELMING: f64 = 0.5;
/// A bias of so many standard deviations makes intervals an eighth wider.
const NOTABLE: f64 = 0.5;

/// What noise of the positions does to least squares.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PositionBias {
    /// The joints.
    pub joints: Vec<JointPositionNoise>,
    /// f_dyn of the fit, and the lowest that suits the motion; absent where nothing moves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub f_dyn: Option<FittedBandwidth>,
    /// Draws of the noise; none where it is negligible.
    pub draws: u64,
    /// The coefficients that the recordings determine; none where noise is negligible.
    pub parameters: Vec<ParameterBias>,
}

/// The f_dyn of a fit beside that which suits the motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FittedBandwidth {
    /// Of the fit, Hz.
    pub f_dyn_hz: f64,
    /// The lowest round one with room above the motion, Hz.
    pub suitable_hz: f64,
}

impl FittedBandwidth {
    /// What lowers the noise of the positions against the motion, as an order; without it nothing moves.
    pub(crate) fn remedy(of: Option<Self>) -> String {
        let rounded =
            |Self { f_dyn_hz, suitable_hz }| Self { f_dyn_hz: (1e3 * f_dyn_hz).round() / 1e3, suitable_hz };
        match of.map(rounded) {
            Some(Self { f_dyn_hz, suitable_hz }) if suitable_hz < f_dyn_hz => {
                format!("use f_dyn_hz = {suitable_hz}, which suits the motion")
            }
            Some(Self { f_dyn_hz, suitable_hz }) if suitable_hz > f_dyn_hz => format!(
                "use a finer encoder, or record faster motions; f_dyn_hz = {f_dyn_hz} already cuts this motion, which {suitable_hz} suits"
            ),
            Some(Self { f_dyn_hz, .. }) => format!(
                "use a finer encoder, or record faster motions; f_dyn_hz = {f_dyn_hz} suits this motion, and a lower one would cut it"
            ),
            None => "use a finer encoder, or record faster motions".into(),
        }
    }
}

/// The noise of a joint's position, of its noisiest recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointPositionNoise {
    /// White noise, rad.
    pub white_rad: f64,
    /// Step of the lattice of the encoder, rad.
    pub step_rad: Option<f64>,
    /// Share of the noise in the power of the filtered accelerations.
    pub acceleration_share: f64,
}

impl JointPositionNoise {
    /// Whether its effect is beyond first order.
    pub(super) fn is_overwhelming(&self) -> bool {
        self.acceleration_share > OVERWHELMING
    }
}

/// A coefficient's bias, which is part of its standard deviation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterBias {
    /// The coefficient.
    pub name: String,
    /// By how much noise of the positions is taken to have shifted it.
    pub bias: f64,
    /// The same in standard deviations that other errors give it.
    pub deviations: f64,
}

pub(crate) struct Looked {
    pub joints: Vec<JointPositionNoise>,
    pub f_dyn: Option<FittedBandwidth>,
    pub draws: u64,
    /// What the noise does to least squares when it is added once more.
    pub shift: Shift,
}

impl PositionBias {
    /// The bias of least squares; `deviations` are those of other errors.
    pub(crate) fn of(model: &RobotModel, looked: &Looked, deviations: impl Fn(usize) -> f64) -> Self {
        let told = |(k, bias): (usize, &f64)| {
            let deviation = deviations(k);
            let deviations = if deviation > 0.0 { bias / deviation } else { 0.0 };
            ParameterBias { name: model.parameters()[k].name.clone(), bias: *bias, deviations }
        };
        let shifted = looked.shift.coefficients().iter();
        let determined = shifted.enumerate().filter(|(k, _)| deviations(*k) > 0.0);
        Self {
            joints: looked.joints.clone(),
            f_dyn: looked.f_dyn,
            draws: looked.draws,
            parameters: determined.map(told).collect(),
        }
    }

    /// The coefficients whose intervals are wider by it, the worst first.
    pub fn notable(&self) -> Vec<&ParameterBias> {
        let mut notable: Vec<&ParameterBias> =
            self.parameters.iter().filter(|p| p.deviations.abs() > NOTABLE).collect();
        notable.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
        notable
    }

    /// What to know where noise is more than corrections hold for.
    pub(crate) fn overwhelming(&self, names: RobotNames<'_>) -> Option<String> {
        let worst = self.joints.iter().enumerate();
        let (joint, noise) =
            worst.max_by(|a, b| a.1.acceleration_share.total_cmp(&b.1.acceleration_share))?;
        noise.is_overwhelming().then(|| {
            format!(
                "position noise makes up {:.0} % of the power of the accelerations of {}, too much for its effect on the \
                 estimates to be determined; {}",
                100.0 * noise.acceleration_share,
                names.joint(joint),
                FittedBandwidth::remedy(self.f_dyn)
            )
        })
    }

    /// The warning of coefficients whose intervals are wider by it.
    pub(crate) fn warning(&self) -> Option<String> {
        const NAMED: usize = 3;
        let notable = self.notable();
        let worst: Vec<String> = notable
            .iter()
            .take(NAMED)
            .map(|p| format!("{} by {:.1} standard deviations", p.name, p.deviations.abs()))
            .collect();
        (!notable.is_empty()).then(|| {
            format!(
                "position noise biases {} of {} coefficients by more than {NOTABLE} standard deviations ({}{}), included in their \
                 intervals; {} (`aurt explain position_bias`)",
                notable.len(),
                self.parameters.len(),
                worst.join(", "),
                if notable.len() > NAMED { ", …" } else { "" },
                FittedBandwidth::remedy(self.f_dyn)
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::FittedBandwidth;

    #[test]
    fn one_bandwidth_alone_suits_a_motion() {
        let remedy = |f_dyn_hz| FittedBandwidth::remedy(Some(FittedBandwidth { f_dyn_hz, suitable_hz: 4.0 }));
        assert!(remedy(10.0).starts_with("use f_dyn_hz = 4, which suits"));
        assert!(remedy(4.0).contains("f_dyn_hz = 4 suits this motion, and a lower one would cut it"));
        for below in [3.0, 1.5] {
            let said = remedy(below);
            assert!(said.contains("already cuts this motion, which 4 suits"), "{said}");
            assert!(!said.contains("a lower one"), "{said}");
        }
    }
}
