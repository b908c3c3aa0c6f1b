//! Laws of inertia, gravity and position.

use aurt_rbd::{INERTIAL_PARAMETERS, LinkBody};

use super::law::{Added, Law};
use super::resonator;
use super::scene::Scene;
use crate::effects::BaseTilt;
use crate::error::SimulationError;

/// The torque of a law of inertia, gravity or position.
pub(super) fn torque(added: &Added, scene: &Scene) -> Result<Vec<Vec<f64>>, SimulationError> {
    let j = added.joint;
    let mut torques = scene.nothing();
    match &added.law {
        Law::RotorInertia => {
            torques[j] = scene.motion.acceleration_rad_s2[j].iter().map(|a| added.size * a).collect();
        }
        Law::Payload { link, .. } => {
            let mut standard = vec![0.0; scene.standard.len()];
            let at = link * INERTIAL_PARAMETERS;
            if let Some(body) = body(added) {
                standard[at..at + INERTIAL_PARAMETERS].copy_from_slice(&body.standard_parameters());
            }
            torques = scene.torque_of(&standard)?;
        }
        Law::BaseTilt { .. } => {
            if let Some(tilt) = tilt(added) {
                torques = scene.torque_under(tilt.tilted(scene.bodies.gravity_m_s2()))?;
                subtract(&mut torques, &scene.load);
            }
        }
        Law::EncoderOffset => {
            torques = scene.torque_at(j, -added.signed())?;
            subtract(&mut torques, &scene.load);
        }
        Law::Spring { rest_rad } => {
            torques[j] =
                scene.motion.position_rad[j].iter().map(|q| added.signed() * (q - rest_rad)).collect();
        }
        Law::TorqueRipple { order, phase_rad } => {
            torques[j] = scene.motion.position_rad[j]
                .iter()
                .map(|q| added.size * libm::sin(order * q + phase_rad))
                .collect();
        }
        Law::JointElasticity { damping_ratio } => {
            let column = scene.inertia_column(j)?;
            let mean = column[j].iter().map(|m| m.abs()).sum::<f64>() / column[j].len().max(1) as f64;
            let rate = (1.0 / (added.size * mean).max(1e-12)).sqrt();
            let acceleration = &scene.motion.acceleration_rad_s2[j];
            let answer = resonator::answer(&scene.motion.time_s, acceleration, rate, *damping_ratio);
            for (series, inertia) in torques.iter_mut().zip(&column) {
                for (k, t) in series.iter_mut().enumerate() {
                    *t = inertia[k] * (answer[k] - acceleration[k]);
                }
            }
        }
        _ => {}
    }
    Ok(torques)
}

fn subtract(torques: &mut [Vec<f64>], others: &[Vec<f64>]) {
    let pairs = torques.iter_mut().flatten().zip(others.iter().flatten());
    pairs.for_each(|(torque, other)| *torque -= other);
}

pub(super) fn body(added: &Added) -> Option<LinkBody> {
    let Law::Payload { com_m, gyration_m, .. } = &added.law else { return None };
    let i = added.size * gyration_m * gyration_m;
    Some(LinkBody { mass_kg: added.size, com_m: *com_m, inertia_at_com_kg_m2: [i, 0.0, 0.0, i, 0.0, i] })
}

pub(super) fn tilt(added: &Added) -> Option<BaseTilt> {
    let Law::BaseTilt { direction_rad } = &added.law else { return None };
    let (sin, cos) = (libm::sin(*direction_rad), libm::cos(*direction_rad));
    Some(BaseTilt { roll_rad: added.size * cos, pitch_rad: added.size * sin })
}
