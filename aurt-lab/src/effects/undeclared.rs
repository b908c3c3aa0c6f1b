//! What a drive has besides its declared friction: the small lacks of every real experiment.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use aurt_simulation::SimulationError;
use aurt_simulation::effects::{
    BristleModel, Curve, Effect, Factor, PreslidingHysteresis, Setup, TemperatureDependentFriction,
    check_joints, check_values,
};
use aurt_simulation::error::Complaints;
use aurt_simulation::plant::ViscousLaw;
use aurt_simulation::robots::Robot;

/// Small physics of one joint that no experiment declares; 0 for none.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lacks {
    /// A of the viscous friction's bend A ((q̇/v)³ − q̇/v) at half the largest speed v, Nm; negative bends off.
    pub cubic_nm: f64,
    /// Static less Coulomb friction, Nm.
    pub stribeck_nm: f64,
    /// Velocity and exponent of that.
    pub stribeck_shape: [f64; 2],
    /// Dry friction per load, Nm/Nm.
    pub load_coefficient: f64,
    /// Distance over which dry friction builds up, rad.
    pub presliding_rad: f64,
    /// Relative fall of friction per kelvin.
    pub fall_per_k: f64,
}

/// The lacks of all joints. Unlike the effects that are named, they take what is installed before them as it is and
/// add to it; where an effect is of their own kind, it stands alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Undeclared {
    pub lacks: Vec<Lacks>,
    pub bristles: BristleModel,
    /// Time constants of lubricant and housing, s.
    pub time_constants_s: [f64; 2],
}

/// A lack by the vocabulary's names.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedLack {
    /// The effect's identifier.
    pub identifier: &'static str,
    pub joints: Vec<usize>,
    pub parameter: &'static str,
    /// The size, one per joint.
    pub values: Vec<f64>,
}

const NAME: &str = "undeclared";
/// Shortest and longest presliding, rad: as of the effect of that name.
pub const PRESLIDING_RAD: [f64; 2] = [1e-4, 0.12];

impl Undeclared {
    /// The lacks by the vocabulary's names.
    pub fn by_name(&self) -> Vec<NamedLack> {
        let mut named = Vec::new();
        let mut add = |identifier, of: &dyn Fn(&Lacks) -> f64, parameter: &'static str| {
            let joints: Vec<usize> = (0..self.lacks.len()).filter(|j| of(&self.lacks[*j]) != 0.0).collect();
            let values = joints.iter().map(|j| of(&self.lacks[*j])).collect();
            if !joints.is_empty() {
                named.push(NamedLack { identifier, joints, parameter, values });
            }
        };
        add("viscous_nonlinear", &|l| l.cubic_nm, "cubic_nm");
        add("stribeck", &|l| l.stribeck_nm, "excess_nm");
        add("load_dependent_friction", &|l| l.load_coefficient, "load_coefficient");
        add("presliding_hysteresis", &|l| l.presliding_rad, "distance_rad");
        add("temperature_dependent_friction", &|l| l.fall_per_k, "fall_per_k");
        named
    }
}

impl Effect for Undeclared {
    fn identifier(&self) -> &'static str {
        NAME
    }

    fn joints(&self) -> Vec<usize> {
        (0..self.lacks.len()).filter(|j| self.lacks[*j] != Lacks::default()).collect()
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        Vec::new()
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        for (j, (lacks, drive)) in self.lacks.iter_mut().zip(&robot.drives).enumerate() {
            let factor = factor.on(j);
            let most = drive.viscous_nm_s * drive.velocity_limit_rad_s;
            lacks.cubic_nm = (lacks.cubic_nm * factor).clamp(-0.1 * most, 0.5 * most);
            lacks.stribeck_nm = (lacks.stribeck_nm * factor).min(1.5 * drive.coulomb_nm);
            lacks.load_coefficient = (lacks.load_coefficient * factor).min(0.3);
            lacks.fall_per_k = (lacks.fall_per_k * factor).min(0.05);
            if lacks.presliding_rad > 0.0 {
                let [low, high] = PRESLIDING_RAD;
                lacks.presliding_rad = (lacks.presliding_rad * factor).clamp(low, high);
            }
        }
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        let joints: Vec<usize> = (0..self.lacks.len()).collect();
        check_joints(&mut complaints, NAME, &joints, robot);
        let mut check = |name, of: &dyn Fn(&Lacks) -> f64, bounds| {
            let values: Vec<f64> = self.lacks.iter().map(of).collect();
            check_values(&mut complaints, NAME, name, &joints, &values, bounds);
        };
        check("cubic_nm", &|l| l.cubic_nm, (-1e4, 1e4));
        check("stribeck_nm", &|l| l.stribeck_nm, (0.0, 1e4));
        check("load_coefficient", &|l| l.load_coefficient, (0.0, 0.9));
        check("presliding_rad", &|l| l.presliding_rad, (0.0, 1.0));
        check("fall_per_k", &|l| l.fall_per_k, (0.0, 0.5));
        for constant in self.time_constants_s {
            complaints.within("time constant of warming in s", constant, 0.1, 1e6);
        }
        complaints.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (j, lacks) in self.lacks.iter().enumerate() {
            let drive = setup.machine.nominal.drives[j];
            let physics = &mut setup.machine.joints[j];
            if lacks.cubic_nm != 0.0 {
                let law = std::mem::replace(
                    &mut physics.viscous,
                    Box::new(aurt_simulation::plant::LinearViscous(0.0)),
                );
                let reference_rad_s = 0.5 * drive.velocity_limit_rad_s;
                physics.viscous = Box::new(Bent { law, bend_nm: lacks.cubic_nm, reference_rad_s });
            }
            let level_nm = 0.5 * (physics.coulomb_nm[0] + physics.coulomb_nm[1]);
            // Where the experiment declares no dry friction, there is none that could be a little wrong.
            if setup.machine.robot.drives[j].coulomb_nm <= 0.0 || level_nm <= 0.0 {
                continue;
            }
            if lacks.stribeck_nm > 0.0 {
                let [velocity_rad_s, exponent] = lacks.stribeck_shape;
                physics.dry_terms.push(Box::new(Curve {
                    excess_nm: lacks.stribeck_nm,
                    velocity_rad_s,
                    exponent,
                }));
            }
            physics.load_coefficient = physics.load_coefficient.map(|c| c + lacks.load_coefficient);
            if lacks.presliding_rad > 0.0 && physics.bristle.is_none() {
                let whole = PreslidingHysteresis {
                    joints: vec![j],
                    distance_rad: vec![lacks.presliding_rad],
                    model: self.bristles,
                    damping_share: 0.0,
                };
                physics.bristle = Some(whole.bristle(lacks.presliding_rad, level_nm, drive.viscous_nm_s));
            }
            if lacks.fall_per_k > 0.0 && physics.warmth.is_none() {
                let warm = TemperatureDependentFriction {
                    joints: vec![j],
                    fall_per_k: vec![lacks.fall_per_k],
                    dry_share: 1.0,
                    time_constants_s: self.time_constants_s,
                };
                physics.warmth = Some(warm.warmth(&drive, lacks.fall_per_k));
            }
        }
        Ok(())
    }

    fn fields(&self) -> Value {
        serde_json::to_value(self).unwrap_or_else(|_| json!({}))
    }
}

/// A law of viscous friction with a cubic bend that vanishes at its reference speed.
#[derive(Debug)]
struct Bent {
    law: Box<dyn ViscousLaw>,
    bend_nm: f64,
    reference_rad_s: f64,
}

impl ViscousLaw for Bent {
    fn torque_nm(&self, velocity_rad_s: f64) -> f64 {
        let x = velocity_rad_s / self.reference_rad_s;
        self.law.torque_nm(velocity_rad_s) + self.bend_nm * x * (x * x - 1.0)
    }

    fn steepest_nm_s(&self) -> f64 {
        // At twice the reference speed, the largest there is, the slope of x³ − x is 11.
        self.law.steepest_nm_s() + 11.0 * self.bend_nm.abs() / self.reference_rad_s
    }
}
