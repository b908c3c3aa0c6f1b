//! The rigid bodies that an arm term in a library sees: none.

use serde::ser::Error;
use serde::{Serialize, Serializer};

use crate::{MotionView, Parameter, RegressorTile, RigidBodyRegressor};

/// Stands in for the robot's rigid bodies, which do not cross the boundary. A term that evaluates them panics with
/// an explanation, which the host reports under the model's name.
#[derive(Debug, Clone, Copy)]
pub(super) struct NoBodies {
    pub joints: usize,
}

impl Serialize for NoBodies {
    fn serialize<S: Serializer>(&self, _serializer: S) -> Result<S::Ok, S::Error> {
        Err(S::Error::custom("rigid bodies are not available inside a library"))
    }
}

// `#[typetag::serde]` would register this under a name that model files could use; the two hidden functions that it
// adds to the implementation are therefore written out.
impl RigidBodyRegressor for NoBodies {
    fn typetag_name(&self) -> &'static str {
        "unavailable"
    }

    fn typetag_deserialize(&self) {}

    fn joints(&self) -> usize {
        self.joints
    }

    fn standard_parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }

    fn loads(&self, _parameter: usize, _joint: usize) -> bool {
        false
    }

    fn evaluate(&self, _motion: MotionView<'_>, _out: &mut RegressorTile<'_>) {
        panic!(
            "an arm term in a dynamic library is not given the robot's rigid bodies; link its crate statically"
        );
    }

    fn gravity_m_s2(&self) -> [f64; 3] {
        panic!(
            "an arm term in a dynamic library is not given the robot's gravity; link its crate statically"
        );
    }

    fn with_gravity(&self, _gravity_m_s2: [f64; 3]) -> Box<dyn RigidBodyRegressor> {
        Box::new(*self)
    }
}
