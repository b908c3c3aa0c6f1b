//! Laws of friction, dry and viscous, with and without load and memory.

use super::law::{Added, Law};
use super::scene::{Scene, direction};

pub(super) fn torque(added: &Added, scene: &Scene) -> Vec<Vec<f64>> {
    let mut torques = scene.nothing();
    let j = added.joint;
    match &added.law {
        Law::JointCouplingFriction { partner, ratio, viscous_s, inertia_s2 } => {
            for k in 0..scene.samples() {
                let along = |series: &[Vec<f64>]| series[j][k] + ratio * series[*partner][k];
                let velocity = along(&scene.motion.velocity_rad_s);
                let acceleration = along(&scene.motion.acceleration_rad_s2);
                let torque =
                    added.size * (direction(velocity) + viscous_s * velocity + inertia_s2 * acceleration);
                torques[j][k] = torque;
                torques[*partner][k] = ratio * torque;
            }
        }
        Law::PreslidingHysteresis { distance_rad } => {
            torques[j] = bristle(&scene.motion.position_rad[j], *distance_rad);
            torques[j].iter_mut().for_each(|t| *t *= added.size);
        }
        law => {
            let fastest = scene.motion.velocity_rad_s[j].iter().fold(0.0_f64, |a, v| a.max(v.abs()));
            for k in 0..scene.samples() {
                torques[j][k] = added.signed() * of_sample(law, scene, j, k, fastest);
            }
        }
    }
    torques
}

/// What a law without memory gives for size 1.
fn of_sample(law: &Law, scene: &Scene, j: usize, k: usize, fastest: f64) -> f64 {
    let velocity = scene.motion.velocity_rad_s[j][k];
    let sign = scene.direction(j, k);
    let load = scene.load[j][k];
    match law {
        Law::Coulomb => sign,
        Law::CoulombAsymmetry => sign.abs(),
        Law::Stribeck { velocity_rad_s, exponent } => {
            sign * libm::exp(-libm::pow(velocity.abs() / velocity_rad_s, *exponent))
        }
        Law::Viscous => velocity,
        Law::ViscousNonlinear { knee_rad_s } => {
            knee_rad_s * libm::tanh(velocity / knee_rad_s) - velocity * knee_rad_s / (knee_rad_s + fastest)
        }
        Law::ViscousAsymmetry => velocity.abs(),
        Law::LoadDependentFriction => load.abs() * sign,
        Law::DriveEfficiency { driven } => {
            load.abs() * sign * if load * velocity >= 0.0 { 1.0 } else { *driven }
        }
        Law::TemperatureDependentFriction { origin_s } => {
            let own = scene.coulomb[j] * sign + scene.viscous[j] * velocity;
            -libm::log(1.0 + scene.since_start_s(k) / origin_s) * own
        }
        Law::FrictionLevelChanged { viscous } => {
            scene.coulomb[j] * sign + viscous * scene.viscous[j] * velocity
        }
        _ => 0.0,
    }
}

/// The bristle of Dahl along a path: |z| < 1, and towards ±1 over the distance d, z ← s + (z − s) e^{−|Δq|/d} with
/// s = sgn Δq, which is exact for any step in one direction.
fn bristle(path_rad: &[f64], distance_rad: f64) -> Vec<f64> {
    let mut z = 0.0;
    let mut before = path_rad.first().copied().unwrap_or(0.0);
    path_rad
        .iter()
        .map(|q| {
            let travel = q - before;
            before = *q;
            if travel != 0.0 {
                let towards = travel.signum();
                z = towards + (z - towards) * libm::exp(-travel.abs() / distance_rad);
            }
            z
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::bristle;

    #[test]
    fn a_bristle_forgets_over_its_distance_and_not_with_time() {
        let there: Vec<f64> = (0..=100).map(|k| 0.01 * f64::from(k)).collect();
        let loaded = bristle(&there, 0.05);
        assert!((loaded[100] - 1.0).abs() < 1e-8);
        // Half as many steps over the same way.
        let coarse: Vec<f64> = there.iter().step_by(2).copied().collect();
        assert!((bristle(&coarse, 0.05)[10] - loaded[20]).abs() < 1e-12);
        assert_eq!(bristle(&[0.3; 50], 0.05), vec![0.0; 50]);
    }
}
