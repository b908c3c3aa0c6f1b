//! One trial: a calibration with plain friction on the fitted parts, judged on the others.

use std::sync::{Arc, OnceLock};

use aurt_calibration::{
    CalibrationOptions, NamedRecording, System, TermScopes, accumulate, for_each_predicted_block,
};
use aurt_plugins::model::{BASE_PARAMETER_SEED, RigidBodyDynamics};
use aurt_rbd::{CoupledChain, SerialChain};
use aurt_traits::{ArmTerm, ColumnGroup, JointStack, LoadTorque, RigidBodyRegressor, RobotModel};

use super::setup::{Part, Setup};

/// With a larger error than that of a model that predicts nothing, a joint is not explained.
pub const WORST: f64 = 1.0;
/// Power that friction feeds into a joint, as a share of the power of its measurement, from which on the joint counts as
/// not explained: friction takes power.
const FED_SHARE: f64 = 0.1;

/// A joint that moves for less than this share of the time counts as resting.
const LEAST_MOVING: f64 = 0.1;

#[derive(Debug, Clone)]
pub struct Bench {
    /// Friction of a joint: a Coulomb coefficient and a viscous one.
    pub friction: JointStack,
    /// What the model has beside, with what experiments often leave out.
    pub arm_terms: Vec<Box<dyn ArmTerm>>,
    pub scopes: TermScopes,
    /// Friction that grows with the load too.
    pub loaded_friction: JointStack,
    /// Friction that builds up over a distance: after a reversal it comes late.
    pub presliding_friction: JointStack,
    /// Whether robots are compared: with a load from a first fit.
    pub compares: bool,
    /// Whether each joint is fitted by itself, with coefficients of its own for the bodies that it shares with others.
    pub separate: bool,
}

pub struct Fit {
    model: Arc<RobotModel>,
    coefficients: Vec<Vec<f64>>,
    load: LoadTorque,
    fed: Vec<bool>,
}

/// Errors of a fit over a recording.
#[derive(Debug, Clone, Default)]
pub struct FittedRows {
    /// When each row is, s from the first stamp of the recording.
    pub time_s: Vec<f64>,
    /// Of each joint and row the error and the measurement; nothing for a row that does not count.
    pub joints: Vec<Vec<Option<[f64; 2]>>>,
}

/// How well a setup explains what was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Score {
    /// Per joint, root mean square of the held-out error over that of the measurement; nothing for a joint that measures
    /// nothing.
    pub joints: Vec<Option<f64>>,
    pub moving: Vec<bool>,
    /// Whether the friction that fits a joint feeds power into it.
    pub fed: Vec<bool>,
    /// Over all joints: the root of the mean square, with 1 at most and 1 for a joint that friction feeds.
    pub total: f64,
    /// Of each judging part, joint and row: the held-out error and the measurement; nothing for a row that does not count.
    pub parts: Vec<Vec<Vec<Option<[f64; 2]>>>>,
}

impl Score {
    /// The joints that move while they are judged, with their errors.
    pub fn of_moving(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let errors = self.joints.iter().zip(&self.moving).enumerate();
        errors.filter_map(|(j, (error, moves))| error.filter(|_| *moves).map(|e| (j, e)))
    }

    /// Σ_j ln r_j.
    pub fn logarithm(&self) -> f64 {
        (0..self.joints.len()).filter_map(|j| Some(self.ratio(j)?.ln())).sum()
    }

    /// True if the mean of ln(r_j before / r_j) over some joints is at least that over all, or there are none. Taking a joint of which
    /// the model lacks something out of the fit lowers the errors of the others alone.
    pub(super) fn is_better_on(&self, joints: &[usize], before: &Self) -> bool {
        let gain = |j: usize| Some((before.ratio(j)? / self.ratio(j)?).ln());
        let mean = |gains: Vec<f64>| gains.iter().sum::<f64>() / gains.len().max(1) as f64;
        let own = joints.iter().filter_map(|j| gain(*j)).collect();
        joints.is_empty() || mean(own) >= mean((0..self.joints.len()).filter_map(gain).collect())
    }

    /// r_j, which is 1 for a joint that is not explained.
    fn ratio(&self, joint: usize) -> Option<f64> {
        self.joints[joint].map(|e| if self.fed[joint] { WORST } else { e.clamp(f64::EPSILON, WORST) })
    }

    /// Σ_j −ln r_j − e_j²/(2σ_j²) + 1/2 over the joints, the mean over each of so many batches of rows of a part. A joint that is
    /// not explained has r_j = 1, and the measurement for its error.
    pub fn likelihoods(&self, part: usize, batches: usize) -> Vec<f64> {
        let mut sums = vec![0.0; batches];
        for joint in 0..self.joints.len() {
            let Some(ratio) = self.ratio(joint) else { continue };
            let unexplained = ratio >= WORST;
            let left = |[e, y]: [f64; 2]| if unexplained { y } else { e };
            let all = || self.parts.iter().flat_map(|p| &p[joint]).flatten();
            let count = all().count().max(1) as f64;
            let variance = all().map(|row| left(*row).powi(2)).sum::<f64>() / count;
            let rows = &self.parts[part][joint];
            for (batch, sum) in sums.iter_mut().enumerate() {
                let range = batch * rows.len() / batches..(batch + 1) * rows.len() / batches;
                let of_row = |row: &Option<[f64; 2]>| {
                    row.map_or(0.0, |r| 0.5 - left(r).powi(2) / (2.0 * variance.max(f64::MIN_POSITIVE)))
                };
                let length = range.len().max(1) as f64;
                *sum += rows[range].iter().map(of_row).sum::<f64>() / length - ratio.ln();
            }
        }
        sums
    }
}

impl Bench {
    /// The bench on which robots are compared: with friction that grows with the load.
    pub fn comparing(&self) -> Self {
        Self { compares: true, friction: self.loaded_friction.clone(), ..self.clone() }
    }

    /// The bench on which each joint is fitted by itself, as currents ask for whose torque constants are unknown.
    pub fn separate(&self) -> Self {
        Self { separate: true, ..self.clone() }
    }

    /// The bench on which a delay is none of friction.
    pub fn presliding(&self) -> Self {
        Self { friction: self.presliding_friction.clone(), ..self.clone() }
    }

    /// A setup with the model of this bench, once for all that is cut from it.
    pub fn modelled(&self, setup: &Setup) -> Setup {
        Setup { model: OnceLock::from(self.model(setup).map(Arc::new)), ..setup.clone() }
    }

    /// Fits and judges; nothing if the setup allows no fit.
    pub fn score(&self, setup: &Setup) -> Option<Score> {
        self.judge(setup, &self.fit(setup)?)
    }

    pub fn fit(&self, setup: &Setup) -> Option<Fit> {
        let model = setup.model.get_or_init(|| self.model(setup).map(Arc::new)).clone()?;
        let fitted = prepared(setup.parts.iter().filter(|p| p.fitted))?;
        let slow = || setup.parts.iter().filter(|p| p.fitted).map(Part::rest_options);
        let mut load = LoadTorque::Fitted(vec![0.0; model.parameters().len()]);
        let mut system = self.system(&model, fitted.iter().zip(slow()), &load)?;
        let weights: Vec<f64> =
            measured(&system).iter().map(|y| if *y > 0.0 { 1.0 / y } else { 0.0 }).collect();
        if self.separate {
            let of_joint = |joint: usize| {
                let own = weights.iter().enumerate().map(|(j, w)| if j == joint { *w } else { 0.0 });
                let own: Vec<f64> = own.collect();
                // What a joint without a measurement would be fitted to is nothing.
                if own[joint] > 0.0 {
                    solved(&system, &own)
                } else {
                    Some(vec![0.0; model.parameters().len()])
                }
            };
            let coefficients = (0..weights.len()).map(of_joint).collect::<Option<Vec<_>>>()?;
            let fed = fed(&model, &coefficients, &fitted, &measured(&system));
            return Some(Fit { model, coefficients, load, fed });
        }
        let mut coefficients = solved(&system, &weights)?;
        if self.compares {
            // The bodies of the first fit are the load of the second.
            load = LoadTorque::Fitted(coefficients);
            system = self.system(&model, fitted.iter().zip(slow()), &load)?;
            coefficients = solved(&system, &weights)?;
        }
        let coefficients = vec![coefficients];
        let fed = fed(&model, &coefficients, &fitted, &measured(&system));
        Some(Fit { model, coefficients, load, fed })
    }

    /// Judges a fit on the parts that are not fitted.
    pub fn judge(&self, setup: &Setup, fit: &Fit) -> Option<Score> {
        let Fit { model, coefficients, load, fed } = fit;
        let joints = setup.moving_joints();
        let mut parts = Vec::new();
        let mut moving = vec![false; joints];
        for part in setup.parts.iter().filter(|p| !p.fitted) {
            let prepared = part.prepared()?;
            let rest = part.rest_options().rest_velocities(&**model.rigid_body());
            for (joint, moves) in moving.iter_mut().enumerate() {
                *moves |= share_moving(&prepared, joint, rest[joint]) > LEAST_MOVING;
            }
            let judged = |of: &Vec<f64>| self.judged(model, &prepared, &rest, load, of);
            let each = coefficients.iter().map(judged).collect::<Option<Vec<_>>>()?;
            // Rows of a joint are predicted with its own coefficients, where it has some.
            let own =
                |joint: usize| each.get(joint).or(each.first()).and_then(|rows| rows.get(joint)).cloned();
            parts.push((0..joints).map(own).collect::<Option<Vec<_>>>()?);
        }
        let sum = |joint: usize, of: usize| -> f64 {
            parts.iter().flat_map(|p| &p[joint]).flatten().map(|row: &[f64; 2]| row[of].powi(2)).sum()
        };
        let joints: Vec<Option<f64>> = (0..joints).map(|j| ratio(sum(j, 0), sum(j, 1))).collect();
        let total = total(&joints, fed);
        total.is_finite().then_some(Score { joints, moving, fed: fed.clone(), total, parts })
    }

    /// Errors and measurements of a part under a fit of all joints together, row by row.
    pub fn rows(&self, part: &Part, fit: &Fit) -> Option<FittedRows> {
        let prepared = part.prepared()?;
        let rest = part.rest_options().rest_velocities(&**fit.model.rigid_body());
        let joints = self.judged(&fit.model, &prepared, &rest, &fit.load, fit.coefficients.first()?)?;
        let segments = prepared.data.segments.iter().filter(|s| s.measurement.is_some());
        let stamps = |s: &aurt_recording::Segment| -> Vec<f64> {
            let motion = s.motion.view();
            (0..s.rows()).map(|row| motion.time_s()[s.sample(row)] - part.origin_s).collect()
        };
        Some(FittedRows { time_s: segments.flat_map(stamps).collect(), joints })
    }

    /// The held-out error and the measurement of each joint and row.
    fn judged(
        &self,
        model: &RobotModel,
        recording: &NamedRecording,
        rest: &[f64],
        load: &LoadTorque,
        coefficients: &[f64],
    ) -> Option<Vec<Vec<Option<[f64; 2]>>>> {
        let acting = self.scopes.acting(model, &recording.name);
        let acting: Vec<f64> =
            coefficients.iter().zip(acting).map(|(c, acts)| if acts { *c } else { 0.0 }).collect();
        let mut rows = vec![Vec::new(); model.joints()];
        for segment in &recording.data.segments {
            let Some(measurement) = &segment.measurement else { continue };
            for_each_predicted_block(model, segment, load, &acting, |block| {
                for (joint, rows) in rows.iter_mut().enumerate() {
                    let measured = block.measurement(&measurement[joint]);
                    rows.extend(measured.iter().zip(block.column(joint)).enumerate().map(
                        |(row, (y, predicted))| {
                            let counts = block.speed(segment, joint, row) > rest[joint];
                            counts.then_some([y - predicted, *y])
                        },
                    ));
                }
            })
            .ok()?;
        }
        Some(rows)
    }

    fn model(&self, setup: &Setup) -> Option<RobotModel> {
        let chain = SerialChain::new(setup.joints.clone(), setup.gravity_m_s2).ok()?;
        let rigid_body: Arc<dyn RigidBodyRegressor> = if setup.couplings.is_empty() {
            Arc::new(chain)
        } else {
            Arc::new(CoupledChain::new(chain, setup.couplings.clone()).ok()?)
        };
        let dynamics = RigidBodyDynamics::new(rigid_body, BASE_PARAMETER_SEED).ok()?;
        let stacks = vec![self.friction.clone(); setup.moving_joints()];
        dynamics.with_joint_dynamics(stacks, self.arm_terms.clone()).ok()
    }

    fn system<'r>(
        &self,
        model: &RobotModel,
        recordings: impl Iterator<Item = (&'r NamedRecording, CalibrationOptions)>,
        load: &LoadTorque,
    ) -> Option<System> {
        let mut all: Option<System> = None;
        for (recording, options) in recordings {
            let one = accumulate(model, std::slice::from_ref(recording), &self.scopes, load, &options);
            match (&mut all, one.ok()?) {
                (Some(all), one) => all.merge(&one).ok()?,
                (none, one) => *none = Some(one),
            }
        }
        all
    }
}

/// Least squares with a prior, so that what a motion hardly excites is small instead of any number: a column by itself explains
/// about as much as a joint measures, and n rows of which a share r² is left say as much as √n that err by themselves.
fn solved(system: &System, weights: &[f64]) -> Option<Vec<f64>> {
    let rows = system.factors().iter().map(aurt_calibration::JointFactor::rows).max()?.max(1) as f64;
    let fit = |left: f64| system.solve_with_prior(weights, left / rows.sqrt()).ok();
    let squares = system.residual_sum(&fit(1.0)?);
    let measured = weights.iter().filter(|w| **w > 0.0).count().max(1) as f64;
    fit(squares.iter().zip(weights).map(|(s, w)| s * w * w).sum::<f64>() / measured)
}

fn prepared<'p>(parts: impl Iterator<Item = &'p Part>) -> Option<Vec<NamedRecording>> {
    let all: Option<Vec<NamedRecording>> = parts.map(|p| p.prepared().map(|r| (*r).clone())).collect();
    all.filter(|a| !a.is_empty())
}

fn share_moving(recording: &NamedRecording, joint: usize, rest_velocity: f64) -> f64 {
    let motions = || recording.data.segments.iter().map(|s| s.motion.view());
    let samples: usize = motions().map(|m| m.samples()).sum();
    let moving = |v: &&f64| v.abs() > rest_velocity;
    let moving: usize = motions().map(|m| m.velocity_rad_s(joint).iter().filter(moving).count()).sum();
    moving as f64 / samples.max(1) as f64
}

/// ‖y_j‖ of each joint.
fn measured(system: &System) -> Vec<f64> {
    let norm = |f: &aurt_calibration::JointFactor| {
        let (triangle, size) = (f.triangle(), f.columns().len() + 1);
        triangle[(size - 1) * size..].iter().map(|v| v * v).sum::<f64>().sqrt()
    };
    system.factors().iter().map(norm).collect()
}

fn ratio(error: f64, measurement: f64) -> Option<f64> {
    (measurement > 0.0).then(|| (error / measurement).sqrt())
}

fn total(joints: &[Option<f64>], fed: &[bool]) -> f64 {
    let squares: Vec<f64> = joints
        .iter()
        .zip(fed)
        .filter_map(|(e, fed)| e.map(|e| e.max(if *fed { 1.0 } else { 0.0 }).min(WORST).powi(2)))
        .collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Whether the friction of each joint gives power instead of taking it.
fn fed(
    model: &RobotModel,
    coefficients: &[Vec<f64>],
    recordings: &[NamedRecording],
    measured: &[f64],
) -> Vec<bool> {
    let rows: usize = recordings.iter().map(NamedRecording::rows).sum();
    (0..model.joints())
        .map(|joint| {
            let columns = model.group(ColumnGroup::JointDynamics(joint));
            let own = coefficients.get(joint).or(coefficients.first()).and_then(|own| own.get(columns));
            let Some([coulomb, viscous]) = own else { return false };
            let speeds = || {
                let motions = recordings.iter().flat_map(|r| &r.data.segments).map(|s| s.motion.view());
                motions.flat_map(move |m| m.velocity_rad_s(joint).to_vec())
            };
            let samples = speeds().count().max(1) as f64;
            let mean = speeds().map(f64::abs).sum::<f64>() / samples;
            let square = speeds().map(|v| v * v).sum::<f64>() / samples;
            let typical = measured[joint] / (rows.max(1) as f64).sqrt() * square.sqrt();
            coulomb * mean + viscous * square < -FED_SHARE * typical
        })
        .collect()
}
