//! Hoses and cables between two links.

use aurt_traits::reexport::typetag;
use aurt_traits::{
    ArmSeries, ArmTerm, Columns, Invariant, Invariants, ModelError, Parameter, register_model,
};
use serde::{Deserialize, Serialize};

const NAME: &str = "dress_pack";

/// A hose package that two joints bend and twist against each other: τ_a = D (q̇_a ∓ q̇_b) and the reaction on b.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DressPack {
    /// The two joints a and b, from 0.
    pub joints: [usize; 2],
    /// Whether the axes have opposite senses, so that the package feels the sum of the velocities.
    #[serde(default)]
    pub opposed: bool,
    /// What the package is called in the coefficient's name.
    #[serde(default = "hose")]
    pub label: String,
}

fn hose() -> String {
    "hose".to_owned()
}

#[typetag::serde(name = "dress_pack")]
impl ArmTerm for DressPack {
    fn name(&self) -> &str {
        NAME
    }

    fn boxed_clone(&self) -> Box<dyn ArmTerm> {
        Box::new(self.clone())
    }

    fn joints(&self, _robot_joints: usize) -> Vec<usize> {
        let [a, b] = self.joints;
        vec![a.min(b), a.max(b)]
    }

    fn columns(&self, _robot_joints: usize) -> Vec<Parameter> {
        vec![Parameter::new(format!("{}_damping", self.label), "Nm s/rad")]
    }

    fn invariants(&self) -> Invariants {
        Invariants::of(&[Invariant::OddInVelocity, Invariant::Passive, Invariant::Memoryless])
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        let complaint = |reason: String| ModelError::InvalidParameter {
            model: NAME.to_owned(),
            parameter: "joints".to_owned(),
            reason,
        };
        let [a, b] = self.joints;
        let mut complaints = Vec::new();
        if a == b {
            complaints.push(complaint(format!("must be two different joints, are {a} and {b}")));
        }
        for joint in self.joints.iter().filter(|j| **j >= robot_joints) {
            complaints
                .push(complaint(format!("names joint {joint}, but the robot has {robot_joints} joints")));
        }
        if complaints.is_empty() { Ok(()) } else { Err(complaints) }
    }

    fn evaluate(
        &self,
        series: &ArmSeries<'_>,
        _state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        let [low, high] = [self.joints[0].min(self.joints[1]), self.joints[0].max(self.joints[1])];
        let sense = if self.opposed { -1.0 } else { 1.0 };
        let (v_low, v_high) = (series.motion.velocity_rad_s(low), series.motion.velocity_rad_s(high));
        for (i, (a, b)) in v_low.iter().zip(v_high).enumerate() {
            let relative = a - sense * b;
            out.column_mut(0)[i] = relative;
            out.column_mut(1)[i] = -sense * relative;
        }
        Ok(())
    }
}

register_model! {
    slot: ArmTerm,
    name: "dress_pack",
    summary: "viscous drag of hoses and cables between two joints",
    equation: "τ_a = D (q̇_a ∓ q̇_b), τ_b = ∓ τ_a",
    use_when: "a joint's friction depends on how another joint moves, and hoses run along both",
    source: "Rayleigh's dissipation function R = ½ D (q̇_a ∓ q̇_b)²",
    example: r#"{ model = "dress_pack", joints = [0, 1] }"#,
}
