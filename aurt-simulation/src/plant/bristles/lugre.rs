use serde::{Deserialize, Serialize};

use crate::plant::{Bristle, Stretch};

/// The LuGre model (Canudas de Wit, Olsson, Åström, Lischinsky, *A new model for control of systems with
/// friction*, IEEE TAC 1995): ż = v − σ₀ |v| z / g, torque σ₀ z + σ₁ ż.
///
/// g is the level of dry friction, which may depend on velocity. Along the path the law reads
/// dz/dx = 1 − σ₀ z sgn(v) / g, whose solution over a stretch is an exponential: it is stable for steps of any
/// length.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LuGre {
    /// σ₀, Nm/rad.
    pub stiffness_nm_rad: f64,
    /// σ₁, Nm s/rad.
    pub damping_nm_s: f64,
}

impl LuGre {
    fn deflection_rad(&self, before_rad: f64, way: Stretch) -> f64 {
        let direction = if way.moved_rad < 0.0 { -1.0 } else { 1.0 };
        let steady = direction * way.level_nm / self.stiffness_nm_rad;
        if steady == 0.0 {
            return 0.0;
        }
        steady + (before_rad - steady) * libm::exp(-way.moved_rad / steady)
    }
}

impl Bristle for LuGre {
    fn state_len(&self) -> usize {
        1
    }

    fn torque_nm(&self, state: &[f64], way: Stretch) -> [f64; 2] {
        let z = self.deflection_rad(state[0], way);
        let v = way.velocity_rad_s;
        let relaxation =
            if way.level_nm > 0.0 { self.stiffness_nm_rad * v.abs() / way.level_nm } else { 0.0 };
        [self.stiffness_nm_rad * z, self.damping_nm_s * (v - relaxation * z)]
    }

    fn advance(&self, state: &mut [f64], way: Stretch) {
        state[0] = self.deflection_rad(state[0], way);
    }

    fn stiffness_nm_rad(&self, _level_nm: f64) -> f64 {
        self.stiffness_nm_rad
    }

    fn damping_nm_s(&self) -> f64 {
        self.damping_nm_s
    }
}
