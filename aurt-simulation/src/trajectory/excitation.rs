//! Excitation: multi-sines whose observation matrix is as well conditioned as possible.

use aurt_rbd::base_parameters;
use aurt_traits::{BaseParameters, Motion as Series, RegressorTile, RigidBodyRegressor};
use nalgebra::DMatrix;

use super::multi_sine::{MultiSine, MultiSineOptions, draw_amplitudes};
use super::{Path, Trajectory};
use crate::error::{Complaints, SimulationError};
use crate::random::Random;
use crate::robots::Robot;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExcitationOptions {
    pub sines: MultiSineOptions,
    /// Number of multi-sines that are tried.
    pub tries: usize,
    /// Whether the torques of the robot's nominal model have to stay within its drives' limits too.
    pub torque_limits: bool,
}

/// A well conditioned excitation.
#[derive(Debug, Clone)]
pub struct Excitation {
    pub trajectory: Trajectory,
    /// Condition number of the base regressor over it, columns scaled to equal length.
    pub condition_number: f64,
    /// That of the first multi-sine that was drawn.
    pub first_condition_number: f64,
}

/// Rate at which the regressor is sampled, Hz, at least; and samples per period of the highest harmonic.
const SAMPLES: (f64, f64) = (5.0, 12.0);
/// Share of the tries that are fresh draws.
const FRESH: f64 = 0.15;
/// Factors on the size of changes after one that improved and one that did not: a fifth of the changes should
/// improve (Rechenberg's rule).
const ADAPTION: (f64, f64) = (1.4, 0.92);

/// Searches amplitudes and phases for the smallest condition number of the base regressor (Gautier and Khalil,
/// *Exciting trajectories for the identification of base inertial parameters of robots*, IJRR 1992; Fourier series
/// after Swevers et al., IEEE T-RA 1997). Every candidate is scaled into the limits of position, velocity and
/// acceleration, so that only shapes compete. A few are drawn afresh; the best of them is changed at random, a
/// (1 + 1) evolution strategy.
///
/// `bodies` are rigid bodies that are not the robot's chain, such as those in which joints follow others: of the robot are
/// then the limits of the joints that move on their own.
///
/// # Errors
/// Options or robots that make no sense, and [`SimulationError::BeyondLimit`] if no candidate stays within the
/// torque limits.
pub fn excite(
    robot: &Robot,
    bodies: Option<&dyn RigidBodyRegressor>,
    options: &ExcitationOptions,
    seed: u64,
    progress: &mut dyn FnMut(usize, f64),
) -> Result<Excitation, SimulationError> {
    let chain = robot.chain()?;
    let bodies = bodies.unwrap_or(&chain);
    let mut complaints = Complaints::default();
    complaints.within("number of multi-sines that are tried", options.tries as f64, 1.0, 1e6);
    complaints.finish()?;
    options.sines.validate()?;
    let regressor = Regressor::new(robot, bodies, options)?;
    let mut random = Random::labelled(seed, "excitation");
    let mut best: Option<(f64, Vec<[f64; 2]>, MultiSine)> = None;
    let (mut first, mut refusal) = (f64::INFINITY, None);
    let fresh = ((FRESH * options.tries as f64) as usize).max(1);
    let mut spread = 0.3;
    for attempt in 0..options.tries {
        let shape = match &best {
            Some((_, shape, _)) if attempt >= fresh => changed(shape, spread, &mut random),
            _ => draw_amplitudes(robot, &options.sines, &mut random),
        };
        let path = MultiSine::fitted(robot, &options.sines, &shape)?;
        if options.torque_limits
            && let Err(error) = Trajectory::new(path.clone()).check_torque(robot)
        {
            refusal = Some(error);
            continue;
        }
        let condition = regressor.condition_number(&path);
        if attempt == 0 {
            first = condition;
        }
        let improves = best.as_ref().is_none_or(|(least, ..)| condition < *least);
        if improves {
            best = Some((condition, shape, path));
        }
        if attempt >= fresh {
            spread = (spread * if improves { ADAPTION.0 } else { ADAPTION.1 }).clamp(1e-3, 1.0);
        }
        progress(attempt + 1, best.as_ref().map_or(f64::INFINITY, |(least, ..)| *least));
    }
    match (best, refusal) {
        (Some((condition_number, _, path)), _) => {
            let trajectory = Trajectory::new(path);
            trajectory.check(robot)?;
            let first_condition_number = if first.is_finite() { first } else { condition_number };
            Ok(Excitation { trajectory, condition_number, first_condition_number })
        }
        (None, Some(error)) => Err(error),
        (None, None) => {
            Err(SimulationError::value("number of multi-sines that are tried", 0.0, "it must be positive"))
        }
    }
}

/// The shape with a change of about `spread` of its size.
fn changed(shape: &[[f64; 2]], spread: f64, random: &mut Random) -> Vec<[f64; 2]> {
    let size = (shape.iter().flatten().map(|a| a * a).sum::<f64>() / (2 * shape.len()).max(1) as f64).sqrt();
    shape.iter().map(|pair| pair.map(|a| a + spread * size * random.normal())).collect()
}

/// The base regressor along candidates.
struct Regressor<'a> {
    bodies: &'a dyn RigidBodyRegressor,
    base: BaseParameters,
    joints: usize,
    time_s: Vec<f64>,
}

impl<'a> Regressor<'a> {
    fn new(
        robot: &Robot,
        bodies: &'a dyn RigidBodyRegressor,
        options: &ExcitationOptions,
    ) -> Result<Self, SimulationError> {
        let rate_hz = SAMPLES.0.max(SAMPLES.1 * options.sines.top_hz);
        let samples = (options.sines.duration_s.clamp(1.0, 3600.0) * rate_hz) as usize;
        Ok(Self {
            base: base_parameters(bodies, 1)?,
            joints: robot.joints(),
            time_s: (0..samples).map(|k| k as f64 / rate_hz).collect(),
            bodies,
        })
    }

    /// The ratio of the largest to the smallest singular value of the base regressor with columns of equal
    /// length; infinite if a parameter is not excited at all.
    fn condition_number(&self, path: &MultiSine) -> f64 {
        let (n, samples) = (self.joints, self.time_s.len());
        let mut series = [const { Vec::new() }; 3].map(|_: Vec<f64>| vec![0.0; n * samples]);
        let (mut q, mut v, mut a) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for (k, time_s) in self.time_s.iter().enumerate() {
            path.at(*time_s, &mut q, &mut v, &mut a);
            for j in 0..n {
                for (out, value) in series.iter_mut().zip([q[j], v[j], a[j]]) {
                    out[j * samples + k] = value;
                }
            }
        }
        let [q, v, a] = series;
        let Ok(motion) = Series::new(n, self.time_s.clone(), q, v, a) else { return f64::INFINITY };
        let (standard, columns) = (self.bodies.standard_parameters().len(), self.base.len());
        let mut destination = vec![RegressorTile::UNWANTED; n * standard];
        for j in 0..n {
            for (k, p) in self.base.columns.iter().enumerate().filter(|(_, p)| self.bodies.loads(**p, j)) {
                destination[j * standard + p] = (k * n + j) as u32;
            }
        }
        // Column after column, joint after joint; entries that do not load a joint stay zero.
        let mut data = vec![0.0; columns * n * samples];
        self.bodies.evaluate(
            motion.view(),
            &mut RegressorTile::new(&destination, standard, samples, samples, &mut data),
        );
        let matrix = DMatrix::from_vec(n * samples, columns, data);
        let gram = matrix.tr_mul(&matrix);
        let scale: Vec<f64> = (0..columns).map(|k| gram[(k, k)].sqrt()).collect();
        if scale.iter().any(|s| *s <= 0.0) {
            return f64::INFINITY;
        }
        let scaled = DMatrix::from_fn(columns, columns, |r, c| gram[(r, c)] / (scale[r] * scale[c]));
        let values = scaled.symmetric_eigenvalues();
        if values.min() > 0.0 { (values.max() / values.min()).sqrt() } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robots;

    fn options(tries: usize) -> ExcitationOptions {
        let sines = MultiSineOptions { duration_s: 15.0, harmonics: 5, top_hz: 0.6, share: 0.8 };
        ExcitationOptions { sines, tries, torque_limits: true }
    }

    #[test]
    fn search_improves_and_the_seed_decides() {
        let robot = robots::ur10e();
        let mut heard = 0;
        let found = excite(&robot, None, &options(120), 1, &mut |done, _| heard = done).unwrap();
        assert_eq!(heard, 120);
        assert!(found.condition_number < 0.8 * found.first_condition_number, "{found:?}");
        found.trajectory.check(&robot).unwrap();
        found.trajectory.check_torque(&robot).unwrap();
        let again = excite(&robot, None, &options(120), 1, &mut |_, _| ()).unwrap();
        assert_eq!(again.condition_number, found.condition_number);
        let other = excite(&robot, None, &options(120), 2, &mut |_, _| ()).unwrap();
        assert_ne!(other.condition_number, found.condition_number);
    }

    #[test]
    fn drives_that_cannot_hold_the_arm_are_said() {
        let mut robot = robots::ur10e();
        robot.drives[1].torque_limit_nm = 1.0;
        let text = excite(&robot, None, &options(3), 1, &mut |_, _| ()).unwrap_err().to_string();
        assert!(text.contains("joint 1") && text.contains("torque"), "{text}");
        assert!(excite(&robots::ur10e(), None, &options(0), 1, &mut |_, _| ()).is_err());
    }
}
