//! `coupling`: a motor that turns with the sum of two joints' velocities.
//!
//! # Equation
//! The motor of joint j, seen behind its gear, turns at ω = q̇_j + ρ q̇_k, k the partner. What acts on its shaft,
//! f = I ω̇ + F_v ω + F_C sgn ω, does work on both joints, and so by virtual work
//! τ_j = f, τ_k = ρ f.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joint` | – | j |
//! | `partner` | – | k |
//! | `ratio` | 1 | ρ, not zero; 1 unless given |
//! | `inertia`, `viscous`, `coulomb` | – | which of the three columns the term has; all unless given |
//! | `rest_velocity_rad_s` | rad/s | \|ω\| up to which the motor rests, as for `sign`; 0 unless given |
//!
//! # Use when
//! Wrists whose last motors sit before the previous joint's axis and drive through it. On the Stäubli TX40 motor 5
//! turns with q̇_4 + q̇_5 (joints count from 0): `joint = 5, partner = 4, ratio = 1.0`; about 0.011 kg m²,
//! 0.64 Nm s/rad, 1.82 Nm. Joints may keep the friction of their own bearings beside it.
//!
//! # Source
//! Gautier, Janot, Vandanjon (2013), *A new closed-loop output error method for parameter identification of robot
//! dynamics*, and Janot, Vandanjon, Gautier (2014), for the TX40 and its coupled wrist.

use aurt_traits::{
    ArmSeries, ArmTerm, Columns, Invariant, Invariants, ModelError, Parameter, Result, register_model,
};
use serde::{Deserialize, Serialize};

use crate::hysteresis::sign::{rest_complaint, sign_beyond};
use crate::shape::verdict;

/// A motor that turns with the sum of two joints' velocities.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coupling {
    /// The joint j that the motor drives.
    pub joint: usize,
    /// The joint k whose motion turns the motor too.
    pub partner: usize,
    /// Turns of the motor (behind its gear) per turn of the partner.
    #[serde(default = "one")]
    pub ratio: f64,
    /// Whether the motor's inertia is a column.
    #[serde(default = "yes")]
    pub inertia: bool,
    /// Whether the motor's viscous friction is a column.
    #[serde(default = "yes")]
    pub viscous: bool,
    /// Whether the motor's dry friction is a column.
    #[serde(default = "yes")]
    pub coulomb: bool,
    /// Speed |ω| up to which the motor rests, in rad/s.
    #[serde(default)]
    pub rest_velocity_rad_s: f64,
}

const fn one() -> f64 {
    1.0
}

const fn yes() -> bool {
    true
}

/// What a column of the term is made of.
#[derive(Debug, Clone, Copy)]
enum Part {
    Inertia,
    Viscous,
    Coulomb,
}

impl Coupling {
    fn parts(&self) -> Vec<Part> {
        [(self.inertia, Part::Inertia), (self.viscous, Part::Viscous), (self.coulomb, Part::Coulomb)]
            .into_iter()
            .filter_map(|(wanted, part)| wanted.then_some(part))
            .collect()
    }

    fn value(&self, part: Part, joint: f64, partner: f64) -> f64 {
        let motor = joint + self.ratio * partner;
        match part {
            Part::Inertia | Part::Viscous => motor,
            Part::Coulomb => sign_beyond(motor, self.rest_velocity_rad_s),
        }
    }
}

register_model! {
    slot: ArmTerm,
    name: "coupling",
    summary: "a motor that turns with the sum of two joints' velocities (coupled wrists)",
    equation: "ω = q̇_j + ratio q̇_k, f = inertia ω̇ + viscous ω + coulomb sgn ω, τ_j = f, τ_k = ratio f",
    use_when: "a joint's residual follows its neighbour's motion, as on wrists driven through one another",
    source: "Gautier, Janot, Vandanjon (2013); Janot, Vandanjon, Gautier (2014)",
    example: r#"{ model = "coupling", joint = 1, partner = 0, ratio = 1.0 }"#,
}

#[typetag::serde(name = "coupling")]
impl ArmTerm for Coupling {
    declares_term! { "coupling" }

    fn joints(&self, _robot_joints: usize) -> Vec<usize> {
        vec![self.joint.min(self.partner), self.joint.max(self.partner)]
    }

    fn columns(&self, _robot_joints: usize) -> Vec<Parameter> {
        let (j, k) = (self.joint, self.partner);
        self.parts()
            .into_iter()
            .map(|part| match part {
                Part::Inertia => Parameter::new(format!("inertia_{j}_{k}"), "kg m^2"),
                Part::Viscous => Parameter::new(format!("viscous_{j}_{k}"), "Nm s/rad"),
                Part::Coulomb => Parameter::new(format!("coulomb_{j}_{k}"), "Nm"),
            })
            .collect()
    }

    fn invariants(&self) -> Invariants {
        if self.inertia {
            return Invariants::of(&[Invariant::EvenInLoad, Invariant::Memoryless]);
        }
        Invariants::of(&[
            Invariant::EvenInLoad,
            Invariant::OddInVelocity,
            Invariant::Passive,
            Invariant::Memoryless,
        ])
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        let mut complaints = Vec::new();
        let mut complain = |parameter: &str, reason: String| {
            complaints.push(ModelError::parameter("coupling", parameter, reason));
        };
        let last = robot_joints.saturating_sub(1);
        for (key, joint) in [("joint", self.joint), ("partner", self.partner)] {
            if joint >= robot_joints {
                complain(key, format!("must lie between 0 and {last} (joints count from 0), is {joint}"));
            }
        }
        if self.joint == self.partner {
            complain("partner", format!("must be another joint than `joint` = {}", self.joint));
        }
        if !self.ratio.is_finite() || self.ratio == 0.0 {
            complain("ratio", format!("must be a number other than zero, is {}", self.ratio));
        }
        if self.parts().is_empty() {
            complain("coulomb", "must be true where `inertia` and `viscous` are false".into());
        }
        complaints.extend(rest_complaint("coupling", self.rest_velocity_rad_s));
        verdict(complaints)
    }

    fn evaluate(&self, series: &ArmSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let (motion, parts) = (series.motion, self.parts());
        let samples = motion.samples();
        let (data, stride) = out.raw_mut();
        for (i, row) in self.joints(motion.joints()).into_iter().enumerate() {
            let arm = if row == self.joint { 1.0 } else { self.ratio };
            for (c, part) in parts.iter().enumerate() {
                let (own, other) = match part {
                    Part::Inertia => {
                        (motion.acceleration_rad_s2(self.joint), motion.acceleration_rad_s2(self.partner))
                    }
                    Part::Viscous | Part::Coulomb => {
                        (motion.velocity_rad_s(self.joint), motion.velocity_rad_s(self.partner))
                    }
                };
                let start = (i * parts.len() + c) * stride;
                for (n, o) in data[start..start + samples].iter_mut().enumerate() {
                    *o = arm * self.value(*part, own[n], other[n]);
                }
            }
        }
        Ok(())
    }
}
