use serde::{Deserialize, Serialize};

use crate::plant::{Bristle, Stretch};

/// The generalised Maxwell-slip model (Al-Bender, Lampaert, Swevers, *The generalized Maxwell-slip model*,
/// IEEE TAC 2005): elements in parallel, each a spring that sticks, Ḟ_i = k_i v, until it bears its share of
/// the level, and then slides towards that share, Ḟ_i = sgn(v) C (α_i − F_i / s) with the level s.
///
/// A sliding element sticks again when the velocity reverses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gms {
    /// k_i, Nm/rad.
    pub stiffness_nm_rad: Vec<f64>,
    /// α_i; they sum to 1.
    pub share: Vec<f64>,
    /// C, Nm/s.
    pub attraction_nm_s: f64,
}

impl Gms {
    /// Elements that slide one after the other: `displacements_rad` at which they do, for the given level and
    /// shares.
    pub fn from_displacements(level_nm: f64, displacements_rad: &[f64], share: &[f64]) -> Self {
        let stiffness = share.iter().zip(displacements_rad).map(|(a, d)| a * level_nm / d).collect();
        Self { stiffness_nm_rad: stiffness, share: share.to_vec(), attraction_nm_s: 50.0 * level_nm }
    }

    /// Torque of element `i`, and whether it slides, at the end of the way.
    fn element(&self, i: usize, before_nm: f64, way: Stretch) -> f64 {
        let bound = self.share[i] * way.level_nm;
        let stuck = before_nm + self.stiffness_nm_rad[i] * way.moved_rad;
        let direction = if way.moved_rad < 0.0 { -1.0 } else { 1.0 };
        if way.level_nm <= 0.0 {
            return 0.0;
        }
        if stuck * direction <= bound {
            return stuck;
        }
        // It slides: towards its bound at the rate C / s, from where it was or, if it has only now let go,
        // from the bound itself.
        let rate = self.attraction_nm_s / way.level_nm;
        let start = if before_nm * direction > bound { before_nm } else { bound * direction };
        bound * direction + (start - bound * direction) * libm::exp(-rate * way.elapsed_s)
    }
}

impl Bristle for Gms {
    fn state_len(&self) -> usize {
        self.share.len()
    }

    fn torque_nm(&self, state: &[f64], way: Stretch) -> [f64; 2] {
        let sum = state.iter().enumerate().map(|(i, f)| self.element(i, *f, way)).sum();
        [sum, 0.0]
    }

    fn advance(&self, state: &mut [f64], way: Stretch) {
        for (i, f) in state.iter_mut().enumerate() {
            *f = self.element(i, *f, way);
        }
    }

    fn stiffness_nm_rad(&self, _level_nm: f64) -> f64 {
        self.stiffness_nm_rad.iter().sum()
    }
}
