//! How a calibrated model moves: forward dynamics of any [`RobotModel`], whatever its friction.
//!
//! A model predicts torques from a motion, y(q, q̇, q̈, z) with a memory z of its friction. Moving it means to
//! solve y = u for q̈. Friction that grows with the load makes that an implicit equation even at one instant,
//! since the load contains q̈, and dry friction jumps where a velocity changes its sign. Both are met by an
//! implicit method: the singly diagonally implicit Runge–Kutta method of Alexander (1977), of order two and
//! L-stable, whose stages are solved by Newton's method with numerical derivatives and step control. Within
//! [`REST_RAD_S`] of rest the torque of a joint runs linearly between its values at both ends, so that a joint
//! that is held creeps with at most that velocity.
//!
//! Nothing here knows which models there are; the rigid bodies are the model's base parameters, in whatever unit
//! it was calibrated in.

mod drive;
mod torque;

pub use drive::ModelDrive;

use aurt_traits::{LoadTorque, RobotModel};
use nalgebra::{DMatrix, DVector};

use crate::error::{Complaints, SimulationError};
use torque::Torque;

/// Half the width of the velocities that count as rest, rad/s.
pub const REST_RAD_S: f64 = 2e-4;
const LONGEST_STEP_S: f64 = 1e-3;
/// γ of the method, 1 − 1/√2.
const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;
/// Iterations of Newton's method in one stage, after which the step is halved.
const ITERATIONS: usize = 25;
/// How often a step may be halved.
const HALVINGS: u32 = 8;
/// What a stage may leave of its equation, relative to the torques in it.
const LEFT: f64 = 1e-9;
/// What it leaves unless rounding, or a kink of friction, lets Newton's method come no closer.
const CLOSE: f64 = 1e-12;
/// A change of acceleration from which derivatives are taken, rad/s².
const PROBE_RAD_S2: f64 = 1e-4;
/// Velocity beyond which a motion has failed, rad/s, and distance from a command, rad.
const LOST: (f64, f64) = (100.0, 0.5);

/// A model that has been given its coefficients.
#[derive(Debug, Clone)]
pub struct MovingModel<'a> {
    pub model: &'a RobotModel,
    pub coefficients: &'a [f64],
    /// How its load torque is formed.
    pub load: &'a LoadTorque,
}

/// A motion of a model, `[joint][sample]`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ModelMotion {
    pub time_s: Vec<f64>,
    pub position_rad: Vec<Vec<f64>>,
    pub velocity_rad_s: Vec<Vec<f64>>,
    /// What drives the joints, in the unit that the model was calibrated in.
    pub torque: Vec<Vec<f64>>,
    /// Number of evaluations of the model.
    pub evaluations: u64,
}

impl MovingModel<'_> {
    /// Moves the model as the drive says, from the first to the last of the drive's samples; `progress` hears the
    /// share that is done.
    ///
    /// # Errors
    /// [`SimulationError::Count`] if drive or coefficients do not fit the model, [`SimulationError::Value`] if its
    /// inertia is not positive at the start, [`SimulationError::NotSettled`] if a step cannot be solved, and
    /// [`SimulationError::Diverged`] if the motion runs away.
    pub fn run(
        &self,
        drive: &ModelDrive,
        progress: &mut dyn FnMut(f64),
    ) -> Result<ModelMotion, SimulationError> {
        let n = self.model.joints();
        for (what, expected, found) in [
            ("coefficients of the model", self.model.parameters().len(), self.coefficients.len()),
            ("joints of the drive", n, drive.joints()),
        ] {
            if expected != found {
                return Err(SimulationError::Count { what: what.into(), expected, found });
            }
        }
        let mut torque = Torque::new(self);
        let (q, v) = drive.start();
        let inertia = torque.inertia(&q)?;
        let mut complaints = Complaints::default();
        for (j, value) in inertia.iter().enumerate() {
            let what = format!("what the model needs to accelerate joint {j}, its inertia,");
            complaints.positive(what, *value);
        }
        complaints.finish()?;
        let gains = drive.gains(&inertia);
        let feed_forward = drive.feed_forward(&mut torque)?;
        let mut stepper = Stepper { torque, drive, gains, feed_forward, inverse: None };
        let mut state = At { time_s: drive.time_s()[0], q, v, a: vec![0.0; n] };
        stepper.torque.start(&state.q, &state.v, state.time_s)?;
        let mut motion = ModelMotion {
            position_rad: vec![Vec::new(); n],
            velocity_rad_s: vec![Vec::new(); n],
            torque: vec![Vec::new(); n],
            ..ModelMotion::default()
        };
        let times = drive.time_s();
        for (k, time_s) in times.iter().enumerate() {
            if k > 0 {
                let span_s = time_s - times[k - 1];
                // A distance that rounding has made a little longer is not worth another step.
                let steps = (span_s / LONGEST_STEP_S - 1e-6).ceil().max(1.0);
                for _ in 0..steps as usize {
                    stepper.step(&mut state, span_s / steps, HALVINGS)?;
                }
                state.time_s = *time_s;
            }
            let u = stepper.wanted(&state);
            motion.time_s.push(*time_s);
            for j in 0..n {
                motion.position_rad[j].push(state.q[j]);
                motion.velocity_rad_s[j].push(state.v[j]);
                motion.torque[j].push(u[j]);
                stepper.check(&state, j)?;
            }
            if k % 64 == 0 {
                progress(k as f64 / times.len() as f64);
            }
        }
        motion.evaluations = stepper.torque.evaluations;
        Ok(motion)
    }
}

#[derive(Debug, Clone)]
struct At {
    time_s: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
}

struct Stepper<'a, 'm> {
    torque: Torque<'m>,
    drive: &'a ModelDrive,
    gains: Vec<[f64; 2]>,
    feed_forward: Vec<Vec<f64>>,
    /// Inverse of the derivative of a stage's equation by the accelerations, and the step it is for.
    inverse: Option<(f64, DMatrix<f64>)>,
}

impl Stepper<'_, '_> {
    fn wanted(&self, at: &At) -> Vec<f64> {
        self.drive.torque(at.time_s, &at.q, &at.v, &self.gains, &self.feed_forward)
    }

    /// One step, or two of half the length where it cannot be solved.
    fn step(&mut self, state: &mut At, step_s: f64, halvings: u32) -> Result<(), SimulationError> {
        let n = state.q.len();
        let within = GAMMA * step_s;
        let solved = self.stage(&state.q, &state.v, &state.a, state.time_s + within, within)?;
        let second = match solved {
            Ok(first) => {
                let rest = step_s - within;
                let q: Vec<f64> = (0..n).map(|j| state.q[j] + rest * first.v[j]).collect();
                let v: Vec<f64> = (0..n).map(|j| state.v[j] + rest * first.a[j]).collect();
                self.stage(&q, &v, &first.a, state.time_s + step_s, within)?
            }
            Err(left) => Err(left),
        };
        match second {
            Ok(end) => {
                self.torque.accept(&end.q, &end.v, &end.a, end.time_s)?;
                *state = end;
                Ok(())
            }
            Err(_) if halvings > 0 => {
                self.step(state, 0.5 * step_s, halvings - 1)?;
                self.step(state, 0.5 * step_s, halvings - 1)
            }
            Err(left) => Err(SimulationError::NotSettled {
                what: "the acceleration of the model (is its inertia positive?)",
                iterations: ITERATIONS,
                change: left,
                time_s: state.time_s,
            }),
        }
    }

    /// Solves y(q + h v', v', a) = u for a, with v' = v + h a; or what is left of the equation.
    fn stage(
        &mut self,
        q: &[f64],
        v: &[f64],
        guess: &[f64],
        time_s: f64,
        h: f64,
    ) -> Result<Result<At, f64>, SimulationError> {
        let n = q.len();
        let at = |a: Vec<f64>| {
            let velocity: Vec<f64> = (0..n).map(|j| v[j] + h * a[j]).collect();
            At { time_s, q: (0..n).map(|j| q[j] + h * velocity[j]).collect(), v: velocity, a }
        };
        let mut here = at(guess.to_vec());
        let (mut off, mut size) = self.off(&here)?;
        let mut no_closer = false;
        for iteration in 0..ITERATIONS {
            if size <= CLOSE || (no_closer && size <= LEFT) {
                return Ok(Ok(here));
            }
            let known = self.inverse.take().filter(|(for_h, _)| *for_h == h && iteration < 4);
            let fresh = known.is_none();
            let inverse = match known {
                Some((_, inverse)) => inverse,
                None => match self.derivative(&here, &off, &at)?.try_inverse() {
                    Some(inverse) => inverse,
                    None => return Ok(Err(size)),
                },
            };
            let change = &inverse * &off;
            let mut share = 1.0;
            let (next, next_off, next_size) = loop {
                let next = at((0..n).map(|j| here.a[j] - share * change[j]).collect());
                let (next_off, next_size) = self.off(&next)?;
                // Derivatives of an earlier step get one chance; the last try is taken as it is, since a jump may
                // have to be crossed uphill.
                if next_size < 0.9 * size || !fresh || share < 0.05 {
                    break (next, next_off, next_size);
                }
                share *= 0.5;
            };
            let poor = next_size > 0.3 * size;
            if !poor {
                self.inverse = Some((h, inverse));
            }
            no_closer = poor && fresh;
            if next_size < size || (fresh && size > LEFT) {
                (here, off, size) = (next, next_off, next_size);
            }
        }
        self.inverse = None;
        Ok(if size <= LEFT { Ok(here) } else { Err(size) })
    }

    /// What is left of the equation, and how much that is relative to its torques.
    fn off(&mut self, at: &At) -> Result<(DVector<f64>, f64), SimulationError> {
        let wanted = self.wanted(at);
        let needed = self.torque.near_rest(&at.q, &at.v, &at.a, at.time_s)?;
        let off = DVector::from_fn(wanted.len(), |j, _| needed[j] - wanted[j]);
        let scale = needed.iter().chain(&wanted).fold(1e-3_f64, |m, x| m.max(x.abs()));
        let size = off.amax() / scale;
        Ok((off, if size.is_finite() { size } else { f64::INFINITY }))
    }

    fn derivative(
        &mut self,
        here: &At,
        off: &DVector<f64>,
        at: &impl Fn(Vec<f64>) -> At,
    ) -> Result<DMatrix<f64>, SimulationError> {
        let n = here.a.len();
        let mut derivative = DMatrix::zeros(n, n);
        for j in 0..n {
            let mut a = here.a.clone();
            let probe = PROBE_RAD_S2 * (1.0 + a[j].abs());
            a[j] += probe;
            let (changed, _) = self.off(&at(a))?;
            derivative.set_column(j, &((changed - off) / probe));
        }
        Ok(derivative)
    }

    fn check(&self, state: &At, joint: usize) -> Result<(), SimulationError> {
        let away = self.drive.commanded_rad(state.time_s, joint).map_or(0.0, |q| state.q[joint] - q);
        let fine = state.v[joint].abs() <= LOST.0 && away.abs() <= LOST.1;
        if fine {
            return Ok(());
        }
        let reason = if away == 0.0 {
            format!(
                "it turns with {:.0} rad/s; without a controller small errors of a model grow, so shorten the \
                 recording or let the model follow its motion",
                state.v[joint]
            )
        } else {
            format!("it is {away:.3} rad away")
        };
        Err(SimulationError::Diverged { joint, time_s: state.time_s, reason })
    }
}
