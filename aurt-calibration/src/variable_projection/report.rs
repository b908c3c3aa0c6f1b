use aurt_traits::{ColumnGroup, RobotModel, Scale};
use serde::{Deserialize, Serialize};

use crate::CalibratedParameter;
use crate::errors_in_positions::Shift;

/// A shape parameter that a calibration found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FittedShape {
    /// Whose it is: a joint's stack or an arm term.
    pub group: ColumnGroup,
    /// The model that has it.
    pub model: String,
    /// Its name, equal to the model's configuration key.
    pub name: String,
    /// Its unit in a model of what was measured, of a joint that turns or slides.
    pub unit: String,
    /// Its value in the model that the search began with.
    pub start: f64,
    /// Estimate.
    pub value: f64,
    /// Standard deviation of the estimate; absent at a bound and where the recordings do not determine it.
    pub std_dev: Option<f64>,
    /// 95 % confidence interval, within the bounds; of a parameter that is searched in logarithms, in these.
    pub interval_95: Option<[f64; 2]>,
    /// By how much noise of the positions is taken to have shifted it, part of the deviation; absent where it is negligible.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shift_by_position_noise: Option<f64>,
    /// Smallest value that the model allows.
    pub lower: f64,
    /// Largest value that the model allows.
    pub upper: f64,
    /// How it was stepped through.
    pub scale: Scale,
    /// Whether the estimate is one of these bounds.
    pub at_bound: bool,
    /// How many of the refined starts of its owner ended at the best fit.
    pub agreeing_starts: usize,
}

/// How the search for shape parameters went.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShapeReport {
    /// The shapes, owner after owner.
    pub shapes: Vec<FittedShape>,
    /// Starts that were refined for every joint or arm term.
    pub starts: usize,
    /// Iterations over all refinements.
    pub iterations: usize,
    /// How often the columns of a joint or arm term were evaluated.
    pub evaluations: usize,
    /// Whether the last refinement ended by itself and the shapes no longer move when weights and load torque follow.
    pub converged: bool,
    /// Weighted sum of squared residuals per row with the shapes that the model had, in the last weights.
    pub cost_before: f64,
    /// The same with the shapes found.
    pub cost_after: f64,
}

impl FittedShape {
    /// Change of the value by its share of the range.
    pub(super) fn slope(&self) -> f64 {
        match self.scale {
            Scale::Linear => self.upper - self.lower,
            Scale::Logarithmic => self.value * libm::log(self.upper / self.lower),
        }
    }

    /// Whether noise of the positions makes up more than half of its variance.
    fn is_shifted(&self) -> bool {
        let shift = self.shift_by_position_noise.unwrap_or_default();
        self.std_dev.is_some_and(|s| 2.0 * shift * shift > s * s)
    }

    /// The joint or arm term, the model and the parameter in words: `joint 2, lugre: presliding_rad`.
    pub fn label(&self) -> String {
        let owner = match self.group {
            ColumnGroup::RigidBody => "rigid bodies".to_owned(),
            ColumnGroup::JointDynamics(joint) => format!("joint {joint}"),
            ColumnGroup::ArmTerm(k) => format!("arm term {k}"),
        };
        format!("{owner}, {}: {}", self.model, self.name)
    }
}

impl ShapeReport {
    /// Widens the shapes' intervals as the memory of the noise has widened those of their owners' coefficients, and by the
    /// shift that noise of the positions may be to blame for; `white` are the coefficients' deviations without either.
    pub(super) fn widen(
        &mut self,
        model: &RobotModel,
        coefficients: &[CalibratedParameter],
        white: &[f64],
        shift: &Shift,
    ) {
        let of = |k: usize| shift.coefficients().get(k).copied().unwrap_or_default();
        let remembered = |k: usize| {
            let variance = coefficients[k].std_dev?.powi(2) - of(k).powi(2);
            Some(variance.max(0.0).sqrt() / white[k]).filter(|ratio| ratio.is_finite())
        };
        for (i, shape) in self.shapes.iter_mut().enumerate() {
            let ratios: Vec<f64> = model.group(shape.group).filter_map(remembered).collect();
            let memory =
                if ratios.is_empty() { 1.0 } else { ratios.iter().sum::<f64>() / ratios.len() as f64 };
            let Some(deviation) = shape.std_dev.filter(|s| *s > 0.0) else { continue };
            let own = shift.shapes().get(i).map_or(0.0, |share| share * shape.slope());
            let widened = (memory * deviation).hypot(own);
            shape.shift_by_position_noise = (own != 0.0).then_some(own.abs());
            let factor = widened / deviation;
            shape.std_dev = Some(widened);
            let (value, [lower, upper]) = (shape.value, [shape.lower, shape.upper]);
            shape.interval_95 = shape.interval_95.map(|ends| {
                ends.map(|end| match shape.scale {
                    Scale::Linear => value + factor * (end - value),
                    Scale::Logarithmic => value * (end / value).powf(factor),
                })
                .map(|end| end.clamp(lower, upper))
            });
        }
    }

    /// The shapes that some rule chooses, with their values; empty without any.
    fn listed(&self, choose: impl Fn(&&FittedShape) -> bool) -> String {
        let names = self.shapes.iter().filter(choose).map(|s| match s.unit.as_str() {
            "1" => format!("{} = {:.4}", s.label(), s.value),
            of => format!("{} = {:.4} {}", s.label(), s.value, of),
        });
        names.collect::<Vec<_>>().join("; ")
    }

    /// The warning of shapes at a limit of their model.
    pub(super) fn bounded(&self) -> Option<String> {
        let bounded = self.listed(|s| s.at_bound);
        (!bounded.is_empty()).then(|| {
            format!(
                "shape parameters at a bound, where the model degenerates or the recordings do not determine them: {bounded}; \
                 use the simpler model, or record motions that show the difference (`aurt explain shape_at_bound`)"
            )
        })
    }

    /// What a user should know of the shapes.
    pub(super) fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::from_iter(self.bounded());
        let shifted = self.listed(|s| s.is_shifted());
        if !shifted.is_empty() {
            warnings.push(format!(
                "position noise may have shifted shape parameters by more than all other errors together (included in \
                 their intervals): {shifted}; use the f_dyn_hz that `aurt check` names if it is lower, a finer encoder, or motions with less time near rest \
                 (`aurt explain position_bias`)"
            ));
        }
        let silent = self.listed(|s| !s.at_bound && s.std_dev.is_none());
        if !silent.is_empty() {
            warnings.push(format!("shape parameters not determined by the recordings: {silent}"));
        }
        if !self.converged {
            warnings.push(format!(
                "the search for shape parameters did not converge in {} iterations",
                self.iterations
            ));
        }
        warnings
    }
}
