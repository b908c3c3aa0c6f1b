
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]
#![allow(unused_parens, unused_mut, unused_variables, clippy::all)]

#[cfg(feature = "std")]
#[allow(dead_code)]
mod math {
    macro_rules! functions {
        ($($name:ident $method:ident ($($more:ident)?);)*) => {
            $(
                #[inline(always)]
                pub fn $name(x: f64 $(, $more: f64)?) -> f64 {
                    x.$method($($more)?)
                }
            )*
        };
    }
    functions! {
        copysign copysign(y);
        cos cos();
        exp exp();
        expm1 exp_m1();
        fabs abs();
        log1p ln_1p();
        pow powf(y);
        sin sin();
        sqrt sqrt();
        tanh tanh();
    }
}

#[cfg(not(feature = "std"))]
mod math {
    #[allow(unused_imports)]
    pub use libm::{copysign, cos, exp, expm1, fabs, log1p, pow, sin, sqrt, tanh};
}

#[allow(unused_imports)]
use math::*;

/// Number of joints.
pub const JOINTS: usize = @JOINTS@;

/// What friction remembers from sample to sample. A copy is a point to which one can return.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    started: bool,
    m: [f64; @MEMORY@],
}

impl State {
    /// Begins a series: friction starts relaxed at the first sample that follows.
    pub const fn new() -> Self {
        Self { started: false, m: [0.0; @MEMORY@] }
    }
}

impl Default for State {
    fn default() -> Self {
        Self::new()
    }
}
