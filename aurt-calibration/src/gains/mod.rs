//! Gains of the drives: torque per measured value, joint by joint.
//!
//! Base parameters act on several joints at once, so the same bodies explain measurements of all of them in one scale only if the
//! gains g_j are in the right proportion: unloaded motion determines their ratios. The common factor cancels, since machine
//! and gains may both be twice as large, until a part of the machine is known: a load of mass m on some of the recordings.
//!
//! y_j = a_j W_j ζ + e_j,  a_j = 1/g_j,  ζ_m = m,
//!
//! is what noise of the measurement is added to, so that weighted least squares over (ζ, a) is the likeliest estimate; the total
//! least squares of g_j y_j = W_j ζ (Gautier, Briot 2014) is another way to the same end. Gauss and Newton's steps need the
//! triangles of the joints alone. Coefficients ζ are those of the torque, friction included.
//!
//! What is decided at all follows from the directions in (ζ, a) that no row sees: a gain is determined if none of them moves
//! it, a ratio of two if none changes it.

mod covariance;
mod problem;
mod recorded;

use aurt_traits::{LoadTorque, RobotModel};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::physical::carried;
use crate::rows::check;
use crate::{CalibrationError, JointFactor, NamedRecording, System, accumulate};
use covariance::{covariance, white};
use problem::{Point, Problem, Seen};
pub use recorded::{GainsOf, KnownLoad};

/// Passes, each with the load torque of the last.
const PASSES: usize = 8;
/// Passes end where no gain changes by more than this, relatively.
const SETTLED: f64 = 1e-6;
/// A deviation above this share of a gain is no estimate of it.
const HARDLY: f64 = 0.1;
/// A sign is told if the ratio is so many standard deviations below zero.
const BEYOND_NOISE: f64 = 2.0;

/// What recordings determine of a gain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Decided {
    /// The gain itself.
    Gain,
    /// Its ratio to that of the reference joint.
    Ratio,
    /// Nothing.
    Nothing,
}

/// The gain of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Gain {
    /// What is determined.
    pub decided: Decided,
    /// Torque per measured value; without a known load in the scale in which the reference joint has 1, and 1 where nothing is
    /// determined.
    pub value: f64,
    /// Its standard deviation, where it is determined.
    pub std_dev: Option<f64>,
    /// Over the reference joint's.
    pub ratio: f64,
    /// Standard deviation of the ratio, where it is determined; zero of the reference joint.
    pub ratio_std_dev: Option<f64>,
}

impl Gain {
    /// True if the deviation of the gain, or of its ratio, is above a tenth of it: that is no estimate.
    pub fn is_doubtful(&self) -> bool {
        let relative = |std: Option<f64>, value: f64| std.is_some_and(|s| s > HARDLY * value.abs());
        relative(self.std_dev, self.value) || relative(self.ratio_std_dev, self.ratio)
    }
}

/// The gains of all joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Gains {
    /// Joint by joint.
    pub joints: Vec<Gain>,
    /// The joint whose gain ratios refer to, the one that is surest.
    pub reference: usize,
    /// The load's mass, kg, if one was given.
    pub mass_kg: Option<f64>,
    /// Deviation of each joint's residual, in the unit of the measurement.
    pub sigma: Vec<f64>,
    /// Rows of each joint.
    pub samples_per_joint: Vec<usize>,
    /// Centre of the load's mass in the frame of its link, m, as it was estimated or given.
    pub centre_of_mass_m: Option<[f64; 3]>,
    /// What a user should know.
    pub warnings: Vec<String>,
}

/// Why gains cannot be estimated.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum GainsError {
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    #[error("the mass of the load must be positive and finite, but is {mass_kg} kg")]
    Mass { mass_kg: f64 },
    #[error("the standard deviation of the mass must be finite and not negative, but is {std_kg} kg")]
    MassDeviation { std_kg: f64 },
    #[error("the centre of mass must be finite, in m, in the frame of the link that carries the load")]
    CentreOfMass,
    #[error(
        "the model has {found} loads with a column `m`, but exactly one of known mass is required; add to the experiment one \
         [[arm_terms]] model = \"payload\" with the `recordings` that carry it"
    )]
    Loads { found: usize },
    #[error(
        "a centre of mass requires the columns mX, mY and mZ of the payload; add them to its `parameters`"
    )]
    NoMoments,
    #[error(
        "the load acts in all recordings, so it cannot be separated from the last link; add a recording without it, and name \
         those with it as `recordings` of the payload"
    )]
    NeverWithout,
    #[error(
        "the load acts in none of the recordings; name those that carry it as `recordings` of the payload"
    )]
    NeverWith,
    #[error(
        "these recordings determine no gain and no ratio of gains: move the joints so that a link loads several of them; \
         `aurt excite` plans such a motion"
    )]
    Undetermined,
}

/// Estimates the gains.
///
/// # Errors
/// [`GainsError`].
pub fn estimate_gains(of: &GainsOf<'_>) -> Result<Gains, GainsError> {
    let (known, factors) = known(of)?;
    let (problem, point, load) = solved(of, &known)?;
    let seen = Seen::at(&problem, &point)?;
    if !seen.has_ratios() {
        return Err(GainsError::Undetermined);
    }
    let covariance = covariance(of, &load, &problem, &point, &seen)?;
    Ok(gains(of, &problem, &point, &seen, &covariance, factors))
}

/// What recordings will determine, from their motions and the gains at which the search begins: deviations are those that
/// white noise of the measurement would give.
///
/// # Errors
/// [`GainsError`].
pub fn decidable_gains(of: &GainsOf<'_>) -> Result<Gains, GainsError> {
    let (known, factors) = known(of)?;
    let system = accumulated(of, &unloaded(of.model))?;
    let problem = Problem::new(&system, known);
    let point = problem.start()?;
    let seen = Seen::at(&problem, &point)?;
    let covariance = white(of, &problem, &seen);
    Ok(gains(of, &problem, &point, &seen, &covariance, factors))
}

/// Coefficients that are known, and the relative deviation of all gains that comes with them.
fn known(of: &GainsOf<'_>) -> Result<(Vec<Option<f64>>, f64), GainsError> {
    check(of.model, of.recordings)?;
    let mut known = vec![None; of.model.parameters().len()];
    let Some(load) = of.load else { return Ok((known, 0.0)) };
    if !(load.mass_kg.is_finite() && load.mass_kg > 0.0) {
        return Err(GainsError::Mass { mass_kg: load.mass_kg });
    }
    if !(load.mass_std_kg.is_finite() && load.mass_std_kg >= 0.0) {
        return Err(GainsError::MassDeviation { std_kg: load.mass_std_kg });
    }
    let loads = carried(of.model);
    let [body] = loads.as_slice() else { return Err(GainsError::Loads { found: loads.len() }) };
    let place = |symbol: usize| body.places[symbol].map(|p| body.columns.start + p);
    let Some(mass) = place(9) else { return Err(GainsError::Loads { found: 0 }) };
    known[mass] = Some(load.mass_kg);
    if let Some(centre) = load.centre_of_mass_m {
        if centre.iter().any(|c| !c.is_finite()) {
            return Err(GainsError::CentreOfMass);
        }
        for (axis, metres) in centre.into_iter().enumerate() {
            known[place(6 + axis).ok_or(GainsError::NoMoments)?] = Some(load.mass_kg * metres);
        }
    }
    let carries = |r: &NamedRecording| of.scopes.acting(of.model, &r.name)[mass];
    match of.recordings.iter().filter(|r| carries(r)).count() {
        0 => Err(GainsError::NeverWith),
        n if n == of.recordings.len() => Err(GainsError::NeverWithout),
        _ => Ok((known, load.mass_std_kg / load.mass_kg)),
    }
}

fn unloaded(model: &RobotModel) -> LoadTorque {
    LoadTorque::Fitted(vec![0.0; model.parameters().len()])
}

fn accumulated(of: &GainsOf<'_>, load: &LoadTorque) -> Result<System, CalibrationError> {
    accumulate(of.model, of.recordings, of.scopes, load, of.options)
}

/// The estimate, with the load torque that its own bodies give.
fn solved(of: &GainsOf<'_>, known: &[Option<f64>]) -> Result<(Problem, Point, LoadTorque), GainsError> {
    let mut load = unloaded(of.model);
    let mut before: Option<Point> = None;
    for _ in 1..PASSES {
        let system = accumulated(of, &load)?;
        let problem = Problem::new(&system, known.to_vec());
        let start = before.take().map_or_else(|| problem.start(), Ok)?;
        let point = problem.minimum(start.clone())?;
        let change = point.inverse.iter().zip(&start.inverse).map(|(a, b)| (a / b - 1.0).abs());
        if change.fold(0.0, f64::max) < SETTLED {
            return Ok((problem, point, load));
        }
        load = LoadTorque::Fitted(point.coefficients.clone());
        before = Some(point);
    }
    let system = accumulated(of, &load)?;
    let problem = Problem::new(&system, known.to_vec());
    let point = problem.minimum(before.map_or_else(|| problem.start(), Ok)?)?;
    Ok((problem, point, load))
}

/// Gains in the scale that there is, with what is known of them; `covariance` is that of log g_j, column after column.
fn gains(
    of: &GainsOf<'_>,
    problem: &Problem,
    point: &Point,
    seen: &Seen,
    covariance: &nalgebra::DMatrix<f64>,
    of_mass: f64,
) -> Gains {
    let joints = of.model.joints();
    let variance_of_ratio =
        |j: usize, r: usize| covariance[(j, j)] + covariance[(r, r)] - 2.0 * covariance[(j, r)];
    let decided: Vec<usize> = (0..joints).filter(|j| seen.decides_ratio(*j)).collect();
    let doubt = |r: &usize| decided.iter().map(|j| variance_of_ratio(*j, *r)).sum::<f64>();
    let reference = decided.iter().copied().min_by(|a, b| doubt(a).total_cmp(&doubt(b))).unwrap_or(0);
    let is_absolute = |j: usize| of.load.is_some() && seen.decides_gain(j);
    let scale = if is_absolute(reference) { 1.0 } else { point.inverse[reference] };
    let estimated: Vec<Gain> = (0..joints)
        .map(|j| {
            let has_ratio = seen.decides_ratio(j);
            let ratio = if has_ratio { point.inverse[reference] / point.inverse[j] } else { 1.0 };
            let value = if has_ratio { scale / point.inverse[j] } else { 1.0 };
            let deviation = |variance: f64, value: f64| variance.max(0.0).sqrt() * value.abs();
            let std_dev = is_absolute(j).then(|| deviation(covariance[(j, j)] + of_mass * of_mass, value));
            let ratio_std_dev = has_ratio.then(|| deviation(variance_of_ratio(j, reference), ratio));
            let decided = match (is_absolute(j), has_ratio) {
                (true, _) => Decided::Gain,
                (false, true) => Decided::Ratio,
                _ => Decided::Nothing,
            };
            Gain { decided, value, std_dev, ratio, ratio_std_dev }
        })
        .collect();
    let centre_of_mass_m = of.load.and_then(|load| {
        let body = carried(of.model).into_iter().next()?;
        let moments = [6, 7, 8].map(|s| body.places[s].map(|p| point.coefficients[body.columns.start + p]));
        Some([moments[0]? / load.mass_kg, moments[1]? / load.mass_kg, moments[2]? / load.mass_kg])
    });
    Gains {
        warnings: warnings(of, &estimated),
        joints: estimated,
        reference,
        mass_kg: of.load.map(|load| load.mass_kg),
        sigma: point.sigma.clone(),
        samples_per_joint: problem.factors().iter().map(JointFactor::rows).collect(),
        centre_of_mass_m,
    }
}

fn warnings(of: &GainsOf<'_>, gains: &[Gain]) -> Vec<String> {
    let list = |chosen: &dyn Fn(&Gain) -> bool| {
        let joints: Vec<usize> = (0..gains.len()).filter(|j| chosen(&gains[*j])).collect();
        (!joints.is_empty()).then(|| of.model.names().joint_list(&joints))
    };
    let mut warnings = Vec::new();
    if let Some(joints) = list(&|g| g.decided == Decided::Nothing) {
        warnings.push(format!(
            "the gain of {joints} is not determined: no link that it moves loads another joint; move it together with \
             its neighbours, or attach a load off its axis"
        ));
    }
    if of.load.is_some()
        && let Some(joints) = list(&|g| g.decided == Decided::Ratio)
    {
        warnings.push(format!(
            "the load does not determine the gain of {joints}, only its ratio: move the load through more positions"
        ));
    }
    if let Some(joints) = list(&Gain::is_doubtful) {
        warnings.push(format!(
            "the gain of {joints} is poorly determined (standard deviation above {:.0} %): move the joint faster, or \
             attach a load off its axis",
            100.0 * HARDLY
        ));
    }
    let is_turned = |g: &Gain| g.ratio_std_dev.is_some_and(|s| g.ratio < -BEYOND_NOISE * s);
    if let Some(joints) = list(&is_turned) {
        warnings.push(format!(
            "the gain of {joints} has the opposite sign of the reference joint: its measurement or its axis is inverted"
        ));
    }
    warnings
}
