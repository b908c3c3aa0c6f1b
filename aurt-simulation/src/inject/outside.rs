//! What acts from outside, and laws that no vocabulary has.

use super::law::{Added, Law};
use super::scene::Scene;
use crate::error::SimulationError;

/// A contact takes this long to build up and to end, s.
const EDGE_S: f64 = 0.1;
const EDGE_RAD: f64 = 0.02;

/// The torque of a contact or an unknown effect.
pub(super) fn torque(added: &Added, scene: &Scene) -> Result<Vec<Vec<f64>>, SimulationError> {
    if let Law::ExternalContact { link, direction, window_s } = &added.law {
        return contact(added.size, scene, *link, *direction, *window_s);
    }
    let mut torques = scene.nothing();
    let j = added.joint;
    let (position, velocity) = (&scene.motion.position_rad, &scene.motion.velocity_rad_s[j]);
    for (k, torque) in torques[j].iter_mut().enumerate() {
        *torque = added.size
            * match &added.law {
                Law::PeriodicDisturbance { frequency_hz, phase_rad } => {
                    libm::sin(std::f64::consts::TAU * frequency_hz * scene.since_start_s(k) + phase_rad)
                }
                Law::CrossAngleFriction { partner, middle_rad } => {
                    let opening = 1.0 + libm::sin(2.0 * (position[*partner][k] - middle_rad));
                    0.5 * opening * scene.direction(j, k)
                }
                Law::StickingWindow { place_rad: [from, to] } => {
                    let inside = (position[j][k] - from).min(to - position[j][k]);
                    (0.5 + inside / EDGE_RAD).clamp(0.0, 1.0) * scene.direction(j, k)
                }
                Law::PositionDamper { middle_rad } => {
                    (1.0 + libm::sin(2.0 * (position[j][k] - middle_rad))) * velocity[k]
                }
                _ => 0.0,
            };
    }
    Ok(torques)
}

/// −Jᵀ F: what the drives have to hold against a force on a link.
fn contact(
    size_n: f64,
    scene: &Scene,
    link: usize,
    direction: [f64; 3],
    window_s: [f64; 2],
) -> Result<Vec<Vec<f64>>, SimulationError> {
    let mut torques = scene.held_against(link, direction)?;
    for series in &mut torques {
        for (k, torque) in series.iter_mut().enumerate() {
            let time = scene.since_start_s(k);
            let inside = ((time - window_s[0]).min(window_s[1] - time) / EDGE_S).clamp(0.0, 1.0);
            *torque *= size_n * inside;
        }
    }
    Ok(torques)
}
