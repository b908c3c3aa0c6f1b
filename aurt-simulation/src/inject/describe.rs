//! Sizes and parameters of what is added, by name and unit.

use aurt_traits::MeasurementUnit;

use super::bodies;
use super::law::{Added, Law};
use super::scene::Scene;

/// The quantity that is an effect's size.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SizeName {
    pub name: &'static str,
    /// Its unit where torques are in Nm.
    pub unit: &'static str,
}

impl Added {
    /// What [`Added::size`] is.
    pub const fn size_name(&self, unit: MeasurementUnit) -> SizeName {
        let nm = matches!(unit, MeasurementUnit::NewtonMetre);
        let torque = if nm { "Nm" } else { "A" };
        let per_velocity = if nm { "Nm s/rad" } else { "A s/rad" };
        let (name, unit) = match &self.law {
            Law::Coulomb => ("dry friction", torque),
            Law::CoulombAsymmetry => ("half the difference of the two directions' dry friction", torque),
            Law::Stribeck { .. } => ("excess of dry friction near rest", torque),
            Law::Viscous => ("viscous friction", per_velocity),
            Law::ViscousNonlinear { .. } => {
                ("curvature of viscous friction, as a slope near rest", per_velocity)
            }
            Law::ViscousAsymmetry => {
                ("half the difference of the two directions' viscous friction", per_velocity)
            }
            Law::PreslidingHysteresis { .. } => ("dry friction that builds up after a reversal", torque),
            Law::LoadDependentFriction => ("dry friction per load", "%"),
            Law::DriveEfficiency { .. } => ("loss per load while driving", "%"),
            Law::TemperatureDependentFriction { .. } => ("fall of friction per e-fold of time", "%"),
            Law::FrictionLevelChanged { .. } => ("change of friction", "%"),
            Law::JointCouplingFriction { .. } => ("dry friction of the coupled motor", torque),
            Law::RotorInertia => ("rotor inertia", if nm { "kg m²" } else { "A s²/rad" }),
            Law::Payload { .. } => ("mass", "kg"),
            Law::BaseTilt { .. } => ("tilt", "°"),
            Law::EncoderOffset => ("offset of the encoder", "mrad"),
            Law::Spring { .. } => ("stiffness", if nm { "Nm/rad" } else { "A/rad" }),
            Law::TorqueRipple { .. } => ("amplitude", torque),
            Law::JointElasticity { .. } => ("compliance", "mrad/Nm"),
            Law::TorqueConstant => ("error of the torque constant", "%"),
            Law::CurrentOffset => ("offset", torque),
            Law::TimeDelay => ("delay", "ms"),
            Law::Saturation { .. } => ("share of the peak that is cut off", "%"),
            Law::DroppedSamples { .. } => ("share of the rows", "%"),
            Law::ExternalContact { .. } => ("force", "N"),
            Law::PeriodicDisturbance { .. } => ("amplitude", torque),
            Law::CrossAngleFriction { .. } | Law::StickingWindow { .. } => ("dry friction", torque),
            Law::PositionDamper { .. } => ("damping", per_velocity),
        };
        SizeName { name, unit }
    }

    /// [`Added::size`] in the unit of [`Self::size_name`].
    pub fn size_shown(&self) -> f64 {
        match self.size_name(MeasurementUnit::NewtonMetre).unit {
            "%" => 100.0 * self.size,
            "°" => self.size.to_degrees(),
            "ms" | "mrad" | "mrad/Nm" => 1e3 * self.size,
            _ => self.size,
        }
    }

    /// Parameters under their canonical names, where the law has them; `scene` gives the robot's own friction.
    pub fn parameters(&self, scene: &Scene) -> Vec<(String, Vec<f64>)> {
        let (coulomb, viscous) = (scene.coulomb[self.joint], scene.viscous[self.joint]);
        let signed = self.signed();
        let named: Vec<(&str, f64)> = match &self.law {
            Law::Coulomb => vec![("coulomb_nm", signed)],
            Law::CoulombAsymmetry => {
                vec![("coulomb_pos_nm", coulomb + signed), ("coulomb_neg_nm", coulomb - signed)]
            }
            Law::Viscous => vec![("viscous_nm_s", signed)],
            Law::ViscousAsymmetry => {
                vec![("viscous_pos_nm_s", viscous + signed), ("viscous_neg_nm_s", viscous - signed)]
            }
            Law::LoadDependentFriction => vec![("load_coefficient", signed)],
            Law::DriveEfficiency { driven } => vec![("driving", signed), ("driven", driven * signed)],
            Law::JointCouplingFriction { partner, ratio, viscous_s, inertia_s2 } => vec![
                ("partner", *partner as f64),
                ("ratio", *ratio),
                ("inertia_kg_m2", inertia_s2 * self.size),
                ("viscous_nm_s", viscous_s * self.size),
                ("coulomb_nm", self.size),
            ],
            Law::RotorInertia => vec![("inertia_kg_m2", self.size)],
            Law::Payload { link, .. } => vec![("mass_kg", self.size), ("link", *link as f64)],
            Law::BaseTilt { .. } => bodies::tilt(self)
                .map(|t| vec![("roll_rad", t.roll_rad), ("pitch_rad", t.pitch_rad)])
                .unwrap_or_default(),
            Law::EncoderOffset => vec![("offset_rad", signed)],
            Law::Spring { rest_rad } => vec![("stiffness_nm_rad", signed), ("rest_rad", *rest_rad)],
            Law::TorqueRipple { order, .. } => vec![("order", *order), ("amplitude_nm", self.size)],
            Law::JointElasticity { .. } => vec![("stiffness_nm_rad", 1.0 / self.size.max(1e-12))],
            Law::TorqueConstant => vec![("gain_error", signed)],
            Law::CurrentOffset => vec![("offset", signed)],
            Law::TimeDelay => vec![("delay_s", self.size)],
            Law::Saturation { peak } => vec![("limit", (1.0 - self.size) * peak)],
            Law::DroppedSamples { .. } => vec![("share", self.size)],
            Law::ExternalContact { link, .. } => vec![("link", *link as f64)],
            _ => Vec::new(),
        };
        named.into_iter().map(|(name, value)| (name.to_owned(), vec![value])).collect()
    }

    /// The joints whose physics it is; none for effects of the whole arm.
    pub fn own_joints(&self, whole_arm: bool) -> Vec<usize> {
        match &self.law {
            Law::JointCouplingFriction { partner, .. } => {
                vec![self.joint.min(*partner), self.joint.max(*partner)]
            }
            _ if whole_arm => Vec::new(),
            _ => vec![self.joint],
        }
    }
}
