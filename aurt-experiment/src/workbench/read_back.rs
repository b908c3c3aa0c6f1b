//! Torques of an exported robot description, as AURT reads it, beside those of the model that it was made of.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::path::Path;

use aurt::CalibratedModel;
use aurt_calibration::Calibration;
use aurt_export::into::Format;
use aurt_plugins::Registry;
use aurt_plugins::model::RigidBodyDynamics;
use aurt_rbd::robots::{DescribedRobot, Part, PlacedLink, placed_links};
use aurt_rbd::{RobotDescription, carry_over};
use aurt_simulation::Random;
use aurt_traits::{LoadTorque, Motion, RobotNames};

use crate::workbench::described_model::{coefficients, exact_parameters, model};
use crate::workbench::failure::Failure;

/// Duration of the motion and distance of its samples, s.
pub const DURATION_S: f64 = 20.0;
const STEP_S: f64 = 0.01;
/// Angular frequencies of its sines, rad/s.
const SLOWEST: f64 = 0.5;
const FASTEST: f64 = 1.5;
const SEED: u64 = 1;
/// Largest speed of a sine, rad/s or m/s, for models that state no range.
const MOST_SPEED: f64 = 10.0;

#[derive(Debug, Clone, Copy)]
pub(super) struct WrittenDescription<'a> {
    pub(super) text: &'a str,
    pub(super) path: &'a Path,
    pub(super) format: Format,
    /// The body that the robot stands on, where the file leaves a choice.
    pub(super) base: Option<&'a str>,
    pub(super) part: &'a Part,
}

/// Torque of a joint that a description lacks or adds, over a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueDifference {
    pub joint: String,
    /// Root mean square of the difference, Nm or N.
    pub difference_nm: f64,
    /// Root mean square of the model's torque, Nm or N.
    pub torque_nm: f64,
}

impl TorqueDifference {
    /// The difference over the torque; zero without torque.
    pub fn relative(&self) -> f64 {
        if self.torque_nm > 0.0 { self.difference_nm / self.torque_nm } else { 0.0 }
    }
}

/// The differences of all joints over sines that reach the speeds of the calibration.
pub(super) fn torque_differences(
    calibrated: &CalibratedModel,
    written: &WrittenDescription<'_>,
) -> Result<Vec<TorqueDifference>, Failure> {
    let WrittenDescription { text, path, format, base, part } = *written;
    let (described, links) = placed_links(text, path, format, base, part)?;
    let (names, joints) = (calibrated.model.rigid_body().joint_names(), calibrated.model.joints());
    if described.joints() != joints {
        let reason = format!("has {} joints, and the model {joints}", described.joints());
        return Err(Failure::unfit(path, reason, "export it again"));
    }
    // A tree may list its joints in another order.
    let place = |(k, name): (usize, &String)| names.iter().position(|own| own == name).unwrap_or(k);
    let order: Vec<usize> = described.joint_names.iter().enumerate().map(place).collect();
    let sines = sines(calibrated);
    let own: Vec<usize> = (0..joints).collect();
    let expected = calibrated.torque(motion(&sines, &own)?.view())?;
    let found = described_torque(calibrated, &described, &links, &motion(&sines, &order)?)?;
    let robot = RobotNames::of(&**calibrated.model.rigid_body());
    let rms = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v * v, count + 1.0));
        f64::sqrt(sum / f64::max(count, 1.0))
    };
    let mut differences: Vec<(usize, TorqueDifference)> = (order.iter().zip(&found))
        .map(|(joint, found)| {
            let expected = &expected[*joint];
            let difference = TorqueDifference {
                joint: robot.joint(*joint),
                difference_nm: rms(&mut expected.iter().zip(found).map(|(a, b)| a - b)),
                torque_nm: rms(&mut expected.iter().copied()),
            };
            (*joint, difference)
        })
        .collect();
    differences.sort_by_key(|(joint, _)| *joint);
    Ok(differences.into_iter().map(|(_, difference)| difference).collect())
}

/// The torque of a description: bodies, friction, rotors and springs.
fn described_torque(
    calibrated: &CalibratedModel,
    described: &DescribedRobot,
    links: &[PlacedLink],
    motion: &Motion,
) -> Result<Vec<Vec<f64>>, Failure> {
    let own = described.rigid_body(calibrated.model.rigid_body().gravity_m_s2())?;
    let dynamics = RigidBodyDynamics::new(own.clone(), calibrated.model.base().seed)?;
    let massless = vec![0.0; own.standard_parameters().len()];
    let standard = described.standard_parameters.as_ref().unwrap_or(&massless);
    let carried = carry_over(&*own, &dynamics.base, &*own, standard)?;
    let registry = Registry::linked().map_err(aurt::Error::from)?;
    let model = model(described, dynamics, &registry)?;
    let values = coefficients(described, &carried.values, &model);
    let calibration = Calibration {
        parameters: exact_parameters(&model, &values),
        load: LoadTorque::Fitted(values),
        ..calibrated.calibration.clone()
    };
    let read = CalibratedModel { model, calibration, ..calibrated.clone() };
    let mut torque = read.torque(motion.view())?;
    for (joint, (torque, link)) in torque.iter_mut().zip(links).enumerate() {
        let rest = link.joint.spring_ref * link.joint.unit;
        for (torque, q) in torque.iter_mut().zip(motion.view().position_rad(joint)) {
            *torque += link.joint.stiffness * (q - rest);
        }
    }
    Ok(torque)
}

/// A sine of a joint: its largest speed, rad/s, angular frequency, rad/s, and phase, rad.
type Sine = [f64; 3];

fn sines(calibrated: &CalibratedModel) -> Vec<Sine> {
    let mut random = Random::new(SEED);
    let speeds = calibrated.calibration.ranges.iter().map(|range| range.velocity_rad_s.min(MOST_SPEED));
    speeds.map(|speed| [speed, SLOWEST + (FASTEST - SLOWEST) * random.unit(), TAU * random.unit()]).collect()
}

fn motion(sines: &[Sine], order: &[usize]) -> Result<Motion, Failure> {
    let samples = (DURATION_S / STEP_S) as usize;
    let time_s: Vec<f64> = (0..samples).map(|k| STEP_S * k as f64).collect();
    let series = [0, 1, 2].map(|derivative: i32| -> Vec<f64> {
        let of_joint = |joint: &usize| {
            let [speed, rate, phase] = sines[*joint];
            let turned = phase + f64::from(derivative) * FRAC_PI_2;
            let size = speed * rate.powi(derivative - 1);
            time_s.iter().map(move |t| size * (rate * t + turned).sin()).collect::<Vec<_>>()
        };
        order.iter().flat_map(of_joint).collect()
    });
    let [q, qd, qdd] = series;
    Ok(Motion::new(order.len(), time_s, q, qd, qdd)?)
}
