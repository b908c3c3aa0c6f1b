//! How much the fitted model's torque changes with positions, velocities and accelerations.

use aurt_calibration::predict_tile;
use aurt_recording::Segment;
use aurt_traits::{Motion, RobotState, RobotTile};

use crate::error::DiagnosisError;
use crate::recordings::rows::Fit;

/// Samples along a segment at which it is evaluated; the arm's pose changes little between them.
const SAMPLES: usize = 256;
/// Steps of the central differences, rad, rad/s and rad/s²: small beside any motion, large beside rounding.
const STEPS: [f64; 3] = [1e-5, 1e-4, 1e-2];
/// A joint slower than this shows the step of its dry friction, not its slope, rad/s.
const SLOW_RAD_S: f64 = 0.01;

/// Mean squares, along a segment, of the derivatives of one joint's torque by the motion of another (or the same).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Slopes {
    /// ⟨(∂τ_j/∂q_k)²⟩.
    pub(super) position: f64,
    /// ⟨(∂τ_j/∂q̇_k)²⟩.
    pub(super) velocity: f64,
    /// ⟨(∂τ_j/∂q̈_k)²⟩, the inertia matrix and what load-dependent friction adds to it.
    pub(super) acceleration: f64,
    /// ⟨∂τ_j/∂q_k · ∂τ_j/∂q̈_k⟩.
    pub(super) cross: f64,
}

/// Slopes of a fitted model along a segment.
#[derive(Debug, Clone)]
pub(super) struct Sensitivity {
    /// `[joint j][moving joint k]`.
    pub(super) slopes: Vec<Vec<Slopes>>,
}

impl Sensitivity {
    /// Evaluates the model around the motion at some hundred places: its own prediction, whatever its terms.
    pub(super) fn evaluate(segment: &Segment, fit: &Fit<'_>) -> Result<Self, DiagnosisError> {
        let joints = fit.model.joints();
        let stride = segment.motion.samples().div_ceil(SAMPLES).max(1);
        let places = Places::of(segment, stride);
        let mut slopes = vec![vec![Slopes::default(); joints]; joints];
        for moving in 0..joints {
            let derivative = |which: usize| -> Result<Vec<f64>, DiagnosisError> {
                let [up, down] = [STEPS[which], -STEPS[which]].map(|step| {
                    let mut moved = places.clone();
                    let n = moved.time_s.len();
                    moved.series[which][moving * n..(moving + 1) * n].iter_mut().for_each(|v| *v += step);
                    moved.predicted(fit)
                });
                let scale = 0.5 / STEPS[which];
                Ok(up?.iter().zip(&down?).map(|(up, down)| scale * (up - down)).collect())
            };
            let [by_position, by_velocity, by_acceleration] =
                [derivative(0)?, derivative(1)?, derivative(2)?];
            let n = places.time_s.len();
            let fast: Vec<bool> =
                places.series[1][moving * n..(moving + 1) * n].iter().map(|v| v.abs() > SLOW_RAD_S).collect();
            for (joint, row) in slopes.iter_mut().enumerate() {
                let span = joint * n..(joint + 1) * n;
                let (g, c, m) =
                    (&by_position[span.clone()], &by_velocity[span.clone()], &by_acceleration[span]);
                let mean = |values: &mut dyn Iterator<Item = f64>| {
                    let (sum, count) = values.fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
                    if count > 0.0 { sum / count } else { 0.0 }
                };
                row[moving] = Slopes {
                    position: mean(&mut g.iter().map(|g| g * g)),
                    velocity: mean(&mut c.iter().zip(&fast).filter(|(_, fast)| **fast).map(|(c, _)| c * c)),
                    acceleration: mean(&mut m.iter().map(|m| m * m)),
                    cross: mean(&mut g.iter().zip(m).map(|(g, m)| g * m)),
                };
            }
        }
        Ok(Self { slopes })
    }
}

/// A motion thinned out: q, q̇, q̈, joint after joint.
#[derive(Clone)]
struct Places {
    joints: usize,
    time_s: Vec<f64>,
    series: [Vec<f64>; 3],
}

impl Places {
    fn of(segment: &Segment, stride: usize) -> Self {
        let motion = segment.motion.view();
        let joints = motion.joints();
        let picked = |series: &[f64]| series.iter().step_by(stride).copied().collect::<Vec<_>>();
        Self {
            joints,
            time_s: picked(motion.time_s()),
            series: [
                (0..joints).flat_map(|j| picked(motion.position_rad(j))).collect(),
                (0..joints).flat_map(|j| picked(motion.velocity_rad_s(j))).collect(),
                (0..joints).flat_map(|j| picked(motion.acceleration_rad_s2(j))).collect(),
            ],
        }
    }

    /// The fitted model's torques, joint after joint.
    fn predicted(self, fit: &Fit<'_>) -> Result<Vec<f64>, DiagnosisError> {
        let samples = self.time_s.len();
        let [position, velocity, acceleration] = self.series;
        let motion = Motion::new(self.joints, self.time_s, position, velocity, acceleration)?;
        let mut tile = RobotTile::default();
        fit.model.evaluate(motion.view(), fit.load, &mut RobotState::default(), &mut tile)?;
        let mut out = vec![0.0; self.joints * samples];
        predict_tile(fit.model, &tile, fit.coefficients, samples, &mut out);
        Ok(out)
    }
}
