use aurt_traits::RobotNames;
use nalgebra::DVector;
use serde::{Deserialize, Serialize};

use super::assembly::{Assembly, Fit};
use super::prior::Prior;
use super::program::Reached;
use crate::physical::pseudo_inertia;
use crate::with_deviation;

/// Estimates that differ from least squares by more than this share of their standard deviation have moved.
const NOTABLE: f64 = 0.5;
/// Bodies whose scaled pseudo-inertia has a smaller eigenvalue than this lie at the edge of what can be.
const EDGE: f64 = 1e-3;
/// Masses that differ from the description by more than this factor are told.
const MASS_FACTOR: f64 = 3.0;

/// A standard parameter of a consistent estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StandardEstimate {
    /// Name, `XX_0`.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Value.
    pub value: f64,
    /// Standard deviation; absent where the data leave the parameter open.
    pub std_dev: Option<f64>,
    /// Whether the data determine it. If not, they determine only sums of it and others, and the value is one of many that
    /// explain them equally.
    pub determined: bool,
    /// Its value in the prior, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<f64>,
}

/// A coefficient that physics moved away from least squares.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Moved {
    /// Its name.
    pub name: String,
    /// What least squares gave.
    pub least_squares: f64,
    /// What a machine can have.
    pub value: f64,
    /// The difference in standard deviations.
    pub deviations: f64,
}

/// How a consistent estimate came about.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConsistentReport {
    /// By how much χ² exceeds that of least squares: the squared distance in standard deviations.
    pub loss: f64,
    /// The least loss that any machine can have is at most so much below.
    pub within: f64,
    /// Number of coefficients that the data determine; noise alone puts a machine's χ² about there.
    pub determined: usize,
    /// Standard parameters, link after link.
    pub standard: Vec<StandardEstimate>,
    /// Coefficients that moved by more than half a standard deviation, furthest first.
    pub moved: Vec<Moved>,
    /// Bodies at the edge of what can be: nearly flat, or points.
    pub at_edge: Vec<String>,
    /// Joints whose friction model cannot brake at all speeds and loads, whatever its coefficients; it is as least squares
    /// has it.
    pub undecided: Vec<usize>,
    /// Whether standard parameters were known before.
    pub prior: bool,
    /// Newton steps.
    pub steps: usize,
    /// Whether the search ended at the optimum.
    pub converged: bool,
}

pub(super) fn report(
    fit: &Fit<'_>,
    assembly: &Assembly,
    reached: &Reached,
    coefficients: &DVector<f64>,
    standard: &DVector<f64>,
    prior: Option<&Prior>,
) -> ConsistentReport {
    let n = fit.coefficients.len();
    let program = &assembly.program;
    let (of, _) = &assembly.standard;
    let parameters = fit.model.rigid_body().standard_parameters();
    let standard = parameters.iter().enumerate().map(|(k, p)| {
        let row = of.row(k);
        let determined = row.columns(0, program.free).iter().all(|v| *v == 0.0)
            && row.columns(program.free, program.seen).iter().any(|v| *v != 0.0);
        let deviation = row.columns(program.free, program.seen).norm() * program.scale.sqrt();
        StandardEstimate {
            name: p.name.clone(),
            unit: p.unit.clone(),
            value: standard[k],
            std_dev: determined.then_some(deviation),
            determined,
            description: prior.and_then(|prior| prior.standard.get(k).copied()),
        }
    });
    let mut moved: Vec<Moved> = (0..n)
        .filter_map(|k| {
            let deviation = fit.covariance[k * n + k].sqrt();
            let deviations = (coefficients[k] - fit.coefficients[k]) / deviation;
            (deviations.is_finite() && deviations.abs() > NOTABLE).then(|| Moved {
                name: fit.model.parameters()[k].name.clone(),
                least_squares: fit.coefficients[k],
                value: coefficients[k],
                deviations,
            })
        })
        .collect();
    moved.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
    let bodies = program.standard(&reached.at);
    let at_edge = bodies.iter().zip(&assembly.names).filter(|(s, _)| {
        let p = pseudo_inertia(&s.data.0[0]);
        let scale = nalgebra::Matrix4::from_diagonal(&p.diagonal().map(|d| d.abs().sqrt().recip()));
        let scaled = scale * p * scale;
        scaled.iter().all(|v| v.is_finite()) && scaled.symmetric_eigenvalues().min() < EDGE
    });
    ConsistentReport {
        loss: 2.0 * reached.loss,
        within: 2.0 * reached.within,
        determined: program.seen,
        standard: standard.collect(),
        moved,
        at_edge: at_edge.map(|(_, name)| name.clone()).collect(),
        undecided: assembly.undecided.clone(),
        prior: prior.is_some(),
        steps: reached.steps,
        converged: reached.converged,
    }
}

/// A mass by the name of its link or joint, if that has one: `the mass of wrist_3_link`, or `m_5`.
fn of_link(mass: &str, names: RobotNames<'_>) -> String {
    let link = mass.rsplit_once('_').and_then(|(_, link)| link.parse::<usize>().ok());
    match link {
        Some(link) if names.links.get(link).is_some_and(|name| !name.trim().is_empty()) => {
            format!("the mass of {}", names.link(link))
        }
        Some(link) if link < names.joints.len() => format!("the mass behind {}", names.joint(link)),
        _ => mass.to_owned(),
    }
}

impl ConsistentReport {
    pub(crate) fn warnings(&self, names: RobotNames<'_>) -> Vec<String> {
        let mut warnings = Vec::new();
        // Beyond the 99.9 % point of the distribution that noise gives (Wilson and Hilferty's approximation).
        let degrees = self.determined.max(1) as f64;
        let spread = 2.0 / (9.0 * degrees);
        let limit = degrees * (1.0 - spread + 3.09 * spread.sqrt()).powi(3);
        if self.loss > limit {
            let furthest: Vec<String> = self
                .moved
                .iter()
                .take(5)
                .map(|m| {
                    let deviation = ((m.value - m.least_squares) / m.deviations).abs();
                    let before = with_deviation(m.least_squares, deviation);
                    format!("{} (least squares {before}, now {:.4})", m.name, m.value)
                })
                .collect();
            let near = if self.prior { " near the description" } else { "" };
            let cause =
                if self.prior { "The description is of another machine, the model" } else { "The model" };
            warnings.push(format!(
                "no physically consistent parameters{near} fit these recordings as well as least squares: χ² grows by {:.0} with \
                 {} coefficients, more than noise explains. Largest differences: {}. {cause} lacks an effect, or the recordings \
                 have an error: run `aurt diagnose`",
                self.loss,
                self.determined,
                furthest.join(", ")
            ));
        }
        let moved: Vec<String> = self
            .standard
            .iter()
            .filter_map(|s| Some((s, s.description.filter(|_| s.unit == "kg")?)))
            .filter(|(s, known)| !(known / MASS_FACTOR..=known * MASS_FACTOR).contains(&s.value))
            .map(|(s, known)| {
                format!("{} (description {known:.3} kg, now {:.3} kg)", of_link(&s.name, names), s.value)
            })
            .collect();
        if !moved.is_empty() {
            warnings.push(format!(
                "masses differ from the description by more than a factor of {MASS_FACTOR}: {}. If the description is right, the \
                 model lacks an effect or the recordings have an error (run `aurt diagnose`), or they tell too little of these \
                 links: raise `prior_weight`",
                moved.join(", ")
            ));
        }
        if !self.undecided.is_empty() {
            warnings.push(format!(
                "the friction model of {} cannot dissipate at all speeds and loads of the calibration with any \
                 coefficients; its coefficients are those of least squares",
                names.joint_list(&self.undecided)
            ));
        }
        if !self.converged {
            warnings.push(format!(
                "the search for a consistent estimate did not converge in {} steps; χ² is {:.3e}, at most {:.1e} above the \
                 minimum",
                self.steps, self.loss, self.within
            ));
        }
        warnings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masses_are_called_by_the_names_of_a_robot() {
        let own = ["base", "elbow"].map(str::to_owned);
        assert_eq!(of_link("m_1", RobotNames::default()), "m_1");
        assert_eq!(of_link("m_1", RobotNames::of_joints(&own)), "the mass behind elbow");
        assert_eq!(of_link("m_1", RobotNames { joints: &own, links: &own }), "the mass of elbow");
        assert_eq!(of_link("m_7", RobotNames::of_joints(&own)), "m_7");
    }
}
