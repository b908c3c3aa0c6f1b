//! Coefficients that no motion tells apart.

use aurt_traits::{LoadTorque, ModelError, Motion, RobotModel, RobotState, RobotTile};
use nalgebra::DMatrix;

use crate::linear::solve_upper;
use crate::{CalibrationError, System};

/// A coefficient's share of a combination below this, in the lengths of their columns, is rounding.
const ROUNDING: f64 = 1e-7;
/// A combination holds on a motion where it misses no more of the column than this.
const HOLDS: f64 = 1e-6;
/// Samples of the motion on which combinations are tried, and their distance, s.
const SAMPLES: usize = 256;
const PERIOD_S: f64 = 0.02;

/// A column of the regressor that is a sum of others in the recordings.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Dependence {
    /// Its coefficient, which is set to zero.
    pub column: usize,
    /// The other coefficients with the factors of the sum: of ζ_k + factor · ζ_column the recordings see the sum alone.
    pub on: Vec<(usize, f64)>,
}

impl Dependence {
    /// The dependent columns of the recordings' rows.
    pub(crate) fn all(system: &System, weights: &[f64]) -> Result<Vec<Self>, CalibrationError> {
        let triangle = system.triangle(weights)?;
        let factors = solve_upper(&triangle.upper, &triangle.beyond).ok_or(CalibrationError::NotFinite)?;
        let length = |of: &DMatrix<f64>, k: usize| of.column(k).norm();
        let dependence = |(i, column): (usize, &usize)| {
            let whole = length(&triangle.beyond, i);
            let share = |k: usize| (factors[(k, i)] * length(&triangle.upper, k)).abs();
            let on = (0..triangle.kept.len())
                .filter(|k| share(*k) > ROUNDING * whole)
                .map(|k| (triangle.kept[k], factors[(k, i)]))
                .collect();
            Self { column: *column, on }
        };
        let found = triangle.others.iter().enumerate().map(dependence);
        Ok(found.filter(|dependence| !dependence.on.is_empty()).collect())
    }

    /// Those of them that hold on another motion, and so come from the structure of the model and not from the recordings;
    /// none of a model that cannot be evaluated there.
    pub(crate) fn structural(found: Vec<Self>, model: &RobotModel, load: &LoadTorque) -> Vec<Self> {
        if found.is_empty() {
            return found;
        }
        let mut tile = RobotTile::default();
        let evaluated = motion(model.joints())
            .and_then(|motion| model.evaluate(motion.view(), load, &mut RobotState::default(), &mut tile));
        if evaluated.is_err() {
            return Vec::new();
        }
        let holds = |dependence: &Self| {
            let (mut missed, mut whole) = (0.0_f64, 0.0_f64);
            for joint in 0..model.joints() {
                let columns = model.row_columns(joint);
                let of = |column: usize| {
                    columns
                        .iter()
                        .position(|c| *c == column)
                        .map(|k| tile.slot(model.row_slots(joint).start + k))
                };
                for sample in 0..SAMPLES {
                    let at = |column: usize| of(column).map_or(0.0, |values| values[sample]);
                    let sum: f64 = dependence.on.iter().map(|(k, factor)| factor * at(*k)).sum();
                    missed = missed.max((at(dependence.column) - sum).abs());
                    whole = whole.max(at(dependence.column).abs());
                }
            }
            whole > 0.0 && missed <= HOLDS * whole
        };
        found.into_iter().filter(holds).collect()
    }

    /// The combinations that are determined, `ZZ_0 + rotor_inertia.I_a_0`.
    pub(crate) fn combinations(&self, model: &RobotModel) -> String {
        let name = |k: usize| model.parameters()[k].name.as_str();
        let combination = |(k, factor): &(usize, f64)| {
            let sign = if *factor < 0.0 { '−' } else { '+' };
            let size = factor.abs();
            let scale = if (size - 1.0).abs() < HOLDS { String::new() } else { format!("{size:.4} · ") };
            format!("{} {sign} {scale}{}", name(*k), name(self.column))
        };
        self.on.iter().map(combination).collect::<Vec<_>>().join(", ")
    }
}

/// A motion of all joints through a wide range in both directions, no two alike.
fn motion(joints: usize) -> Result<Motion, ModelError> {
    let time: Vec<f64> = (0..SAMPLES).map(|k| k as f64 * PERIOD_S).collect();
    let [mut position, mut velocity, mut acceleration] = [(); 3].map(|()| Vec::new());
    for joint in 0..joints {
        let of = |index: usize| {
            let wave = (3 * joint + index) as f64;
            (1.1 / (1.0 + index as f64), 2.0 + 1.618 * index as f64 + 0.37 * wave.sqrt(), 0.7 * wave)
        };
        for t in &time {
            let waves = || (0..3).map(of).map(|(a, w, phase)| (a, w, libm::sincos(w * t + phase)));
            position.push(waves().map(|(a, _, (sin, _))| a * sin).sum());
            velocity.push(waves().map(|(a, w, (_, cos))| a * w * cos).sum());
            acceleration.push(waves().map(|(a, w, (sin, _))| -a * w * w * sin).sum());
        }
    }
    Motion::new(joints, time, position, velocity, acceleration)
}
