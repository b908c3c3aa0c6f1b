//! The Stribeck curve that `stribeck`, `lugre`, `lugre_damped` and `gms` share.

use crate::shape::Shape;

/// Stribeck velocity v_S.
pub(crate) const STRIBECK_VELOCITY: Shape = Shape::logarithmic("stribeck_velocity_rad_s", "rad/s", 1e-3, 1.0);
/// Ratio F_C/F_S of the sliding to the break-away level.
pub(crate) const COULOMB_RATIO: Shape = Shape::linear("coulomb_ratio", "1", 0.05, 1.0);
/// Exponent δ.
pub(crate) const STRIBECK_EXPONENT: Shape = Shape::linear("stribeck_exponent", "1", 0.5, 3.0);

/// exp(−|v/v_S|^δ), which falls from 1 at rest to 0.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Decay {
    pub(crate) velocity_rad_s: f64,
    pub(crate) exponent: f64,
}

impl Decay {
    /// The decay at velocity `v`.
    #[inline]
    pub(crate) fn at(self, v: f64) -> f64 {
        let x = (v / self.velocity_rad_s).abs();
        // The Gaussian and the exponential curve are the usual ones, and `powf` is several times slower.
        let power = if self.exponent == 2.0 {
            x * x
        } else if self.exponent == 1.0 {
            x
        } else {
            libm::pow(x, self.exponent)
        };
        libm::exp(-power)
    }
}

/// g(v)/F_S = r + (1 − r) exp(−|v/v_S|^δ) with r = F_C/F_S: one at rest, r at speed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StribeckCurve {
    pub(crate) coulomb_ratio: f64,
    pub(crate) decay: Decay,
}

impl StribeckCurve {
    /// The level at velocity `v`, relative to break-away.
    #[inline]
    pub(crate) fn level(self, v: f64) -> f64 {
        self.coulomb_ratio + (1.0 - self.coulomb_ratio) * self.decay.at(v)
    }
}
