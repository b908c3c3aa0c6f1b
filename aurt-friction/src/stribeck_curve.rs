//! The Stribeck curve that `stribeck`, `lugre`, `lugre_damped` and `gms` share.

use serde::{Deserialize, Serialize};

use crate::shape::Shape;

/// Stribeck velocity v_S.
pub(crate) const STRIBECK_VELOCITY: Shape = Shape::logarithmic("stribeck_velocity_rad_s", "rad/s", 1e-3, 1.0);
/// Ratio F_C/F_S of the sliding to the break-away level.
pub(crate) const COULOMB_RATIO: Shape = Shape::linear("coulomb_ratio", "1", 0.05, 1.0);
/// Exponent δ.
pub(crate) const STRIBECK_EXPONENT: Shape = Shape::linear("stribeck_exponent", "1", 0.5, 3.0);

/// The law by which an excess falls from 1 at rest to 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StribeckLaw {
    /// exp(−|v/v_S|^δ), of Bo and Pavelescu (1982).
    #[default]
    Exponential,
    /// 1/(1 + |v/v_S|^δ), of Hess and Soom (1990): half of the excess is gone at v_S, and its tail is long.
    Rational,
}

/// A Stribeck law at its velocity and exponent.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Decay {
    pub(crate) law: StribeckLaw,
    pub(crate) velocity_rad_s: f64,
    pub(crate) exponent: f64,
}

impl Decay {
    /// A decay by the exponential law.
    pub(crate) const fn exponential(velocity_rad_s: f64, exponent: f64) -> Self {
        Self { law: StribeckLaw::Exponential, velocity_rad_s, exponent }
    }

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
        match self.law {
            StribeckLaw::Exponential => libm::exp(-power),
            StribeckLaw::Rational => 1.0 / (1.0 + power),
        }
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
