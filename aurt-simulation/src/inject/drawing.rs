//! Shapes of effects, drawn for a robot's recordings: every shape from a continuum, within what the motion can show.

use aurt_rbd::INERTIAL_PARAMETERS;

use super::injection::Injection;
use super::kinds::Kind;
use super::law::{Added, Law};
use crate::random::Random;

/// Joints slower than this are as good as standing, rad/s (root mean square).
const STANDS_RAD_S: f64 = 0.02;

fn log_between(random: &mut Random, low: f64, high: f64) -> f64 {
    low * libm::pow(high / low, random.unit())
}

impl Injection {
    /// Whether an effect can be on a joint so that the recordings may show it.
    pub fn suits(&self, kind: &Kind, joint: usize) -> bool {
        let (figures, left) = (&self.figures[joint], self.model.left_rms()[joint]);
        let moves = figures.velocity_rad_s > STANDS_RAD_S && left > 0.0;
        moves
            && match kind.identifier {
                "load_dependent_friction" | "drive_efficiency" => figures.load > 2.0 * left,
                "temperature_dependent_friction" | "friction_level_changed" => {
                    self.model.coulomb[joint] > 0.0
                }
                "coulomb_asymmetry" => self.model.coulomb[joint] > 0.0,
                "viscous_asymmetry" => self.model.viscous[joint] > 0.0,
                "joint_elasticity" => figures.inertia > 0.0,
                _ => true,
            }
    }

    /// An effect of a kind on a joint, of a size that is to be brought to strength.
    pub(super) fn draw(&self, kind: &Kind, joint: usize, random: &mut Random) -> Added {
        let joints = self.figures.len();
        let figures = self.figures[joint];
        let (speed, left) = (figures.velocity_rad_s, self.model.left_rms()[joint]);
        let other = |random: &mut Random| {
            let moving: Vec<usize> = (0..joints)
                .filter(|k| *k != joint && self.figures[*k].velocity_rad_s > STANDS_RAD_S)
                .collect();
            random.choose(&moving).copied().unwrap_or((joint + 1) % joints)
        };
        let last = self.model.columns.standard.len() / INERTIAL_PARAMETERS - 1;
        let (law, size) = match kind.identifier {
            "coulomb" => (Law::Coulomb, left),
            "coulomb_asymmetry" => (Law::CoulombAsymmetry, left),
            "stribeck" => {
                let velocity_rad_s = log_between(random, 0.02, 0.15).min(0.5 * speed);
                (Law::Stribeck { velocity_rad_s, exponent: random.between(0.5, 2.0) }, left)
            }
            "viscous" => (Law::Viscous, left / speed),
            "viscous_nonlinear" => {
                (Law::ViscousNonlinear { knee_rad_s: speed * random.between(0.4, 1.5) }, left / speed)
            }
            "viscous_asymmetry" => (Law::ViscousAsymmetry, left / speed),
            "presliding_hysteresis" => {
                let distance_rad = log_between(random, 0.005, 0.05).min(0.1 * figures.width_rad());
                (Law::PreslidingHysteresis { distance_rad }, left)
            }
            "load_dependent_friction" => (Law::LoadDependentFriction, left / figures.load),
            "drive_efficiency" => {
                let driven = random.between(0.1, 0.5);
                (Law::DriveEfficiency { driven }, left / figures.load)
            }
            "temperature_dependent_friction" => (
                Law::TemperatureDependentFriction { origin_s: log_between(random, 2.0, 20.0) },
                left / self.model.coulomb[joint],
            ),
            "friction_level_changed" => (
                Law::FrictionLevelChanged { viscous: random.between(0.5, 2.0) },
                left / self.model.coulomb[joint],
            ),
            "joint_coupling_friction" => {
                let law = Law::JointCouplingFriction {
                    partner: other(random),
                    ratio: random.sign() * random.between(0.2, 3.0),
                    viscous_s: random.between(0.2, 1.0) / speed,
                    inertia_s2: random.between(0.0, 0.02),
                };
                (law, left)
            }
            "rotor_inertia" => (Law::RotorInertia, left / speed),
            "payload" => {
                let side = |random: &mut Random| random.between(-0.06, 0.06);
                let com_m = [side(random), side(random), random.between(0.02, 0.14)];
                (Law::Payload { link: last, com_m, gyration_m: random.between(0.03, 0.08) }, 1.0)
            }
            "base_tilt" => {
                (Law::BaseTilt { direction_rad: random.between(0.0, std::f64::consts::TAU) }, 0.03)
            }
            "encoder_offset" => (Law::EncoderOffset, 0.02),
            "spring" => (Law::Spring { rest_rad: figures.inside_rad(random) }, left),
            "torque_ripple" => {
                // At least one and a half waves over the joint's range, and in the pass band while it moves.
                let least = 1.5 * std::f64::consts::TAU / figures.width_rad();
                let most = (std::f64::consts::TAU * self.real.options.f_dyn_hz / speed).max(1.2 * least);
                let order = log_between(random, least, most);
                let order = if random.chance(0.5) { order.round().max(1.0) } else { order };
                (Law::TorqueRipple { order, phase_rad: random.between(0.0, std::f64::consts::TAU) }, left)
            }
            "joint_elasticity" => {
                let law = Law::JointElasticity { damping_ratio: log_between(random, 0.02, 0.3) };
                (law, self.compliance(joint, 5.0))
            }
            "torque_constant" => (Law::TorqueConstant, 0.05),
            "current_offset" => (Law::CurrentOffset, left),
            "time_delay" => (Law::TimeDelay, 0.01),
            "saturation" => (Law::Saturation { peak: figures.peak }, 0.1),
            "dropped_samples" => (Law::DroppedSamples { seed: random.bits() }, 0.02),
            "external_contact" => {
                let direction = [(); 3].map(|()| random.normal());
                let length = direction.iter().map(|d| d * d).sum::<f64>().sqrt().max(1e-9);
                let from = self.shortest_s * random.between(0.2, 0.6);
                let window_s = [from, from + (0.1 * self.shortest_s).max(0.5) * random.between(1.0, 2.0)];
                let link = last - random.index(2.min(joints));
                (Law::ExternalContact { link, direction: direction.map(|d| d / length), window_s }, 10.0)
            }
            "periodic_disturbance" => {
                let law = Law::PeriodicDisturbance {
                    frequency_hz: self.real.options.f_dyn_hz * random.between(0.4, 1.2),
                    phase_rad: random.between(0.0, std::f64::consts::TAU),
                };
                (law, left)
            }
            "cross_angle_friction" => {
                let partner = other(random);
                let middle_rad = self.figures[partner].inside_rad(random);
                (Law::CrossAngleFriction { partner, middle_rad }, left)
            }
            "sticking_window" => {
                let width = figures.width_rad() * random.between(0.08, 0.2);
                let from = figures.range_rad[0] + (figures.width_rad() - width) * random.between(0.2, 0.8);
                (Law::StickingWindow { place_rad: [from, from + width] }, 2.0 * left)
            }
            _ => (Law::PositionDamper { middle_rad: figures.inside_rad(random) }, left / speed),
        };
        let either = matches!(
            law,
            Law::CoulombAsymmetry
                | Law::ViscousAsymmetry
                | Law::ViscousNonlinear { .. }
                | Law::TorqueConstant
                | Law::CurrentOffset
                | Law::EncoderOffset
                | Law::FrictionLevelChanged { .. }
        );
        let sign = if either { random.sign() } else { 1.0 };
        Added { law, joint, size, sign }
    }

    /// Compliance with which a joint swings at a multiple of f_dyn, rad/Nm.
    fn compliance(&self, joint: usize, multiple: f64) -> f64 {
        let rate = std::f64::consts::TAU * multiple * self.real.options.f_dyn_hz;
        1.0 / (self.figures[joint].inertia * rate * rate).max(1e-12)
    }

    /// The largest size that a real machine could have.
    pub(super) fn largest(&self, added: &Added) -> f64 {
        match &added.law {
            // Friction never turns into drive.
            Law::TemperatureDependentFriction { origin_s } => {
                0.9 / libm::log(1.0 + self.longest_s / origin_s).max(1e-9)
            }
            Law::FrictionLevelChanged { viscous } if added.sign < 0.0 => 0.9 / viscous.max(1.0),
            Law::CoulombAsymmetry => 0.95 * self.model.coulomb[added.joint],
            Law::ViscousAsymmetry => 0.95 * self.model.viscous[added.joint],
            // A softer joint swings at the motion's own frequencies, and gravity acts at another angle than measured.
            Law::JointElasticity { .. } => self.compliance(added.joint, 1.5),
            Law::LoadDependentFriction | Law::DriveEfficiency { .. } | Law::TorqueConstant => 0.6,
            Law::BaseTilt { .. } => 0.6,
            Law::EncoderOffset => 0.2,
            Law::TimeDelay => 0.1,
            Law::Saturation { .. } => 0.9,
            Law::DroppedSamples { .. } => 0.2,
            _ => f64::INFINITY,
        }
    }
}
