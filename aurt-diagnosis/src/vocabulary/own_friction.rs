//! The friction that a model has by itself, on top of which the coefficients of proposals come.

use aurt_traits::{ColumnGroup, RobotModel};

/// The friction of a joint's own stack in a fit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OwnFriction {
    /// Level of dry friction at full sliding without load, Nm.
    pub coulomb_nm: f64,
    /// Linear viscous friction, Nm s/rad.
    pub viscous_nm_s: f64,
}

impl OwnFriction {
    /// The friction of a joint's stack; `coefficients` are those of a fit over the model's columns, at least
    /// up to the joint dynamics.
    pub fn of(model: &RobotModel, joint: usize, coefficients: &[f64]) -> Self {
        let mut own = Self::default();
        let Some(stack) = model.stacks().get(joint) else { return own };
        let range = model.group(ColumnGroup::JointDynamics(joint));
        let dry = stack.coulomb().columns().len() * stack.hysteresis().columns().len();
        for (k, (column, value)) in
            stack.columns().iter().zip(coefficients.iter().skip(range.start)).enumerate()
        {
            // An excess near rest (`dF_S…`) is gone at full sliding.
            if k < dry && column.unit == "Nm" && !column.name.starts_with("dF") {
                own.coulomb_nm += value;
            } else if k >= dry && column.unit == "Nm s/rad" {
                own.viscous_nm_s += value;
            }
        }
        own
    }
}
