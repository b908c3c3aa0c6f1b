use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A number with its derivatives along [`Jet::LANES`] directions (forward-mode differentiation).
///
/// Every operation applies its chain rule, so that code written once for jets gives values and exact derivatives.
/// Functions with kinks ([`Self::abs`], [`Self::clamp`]) have the derivative of the branch that is taken.
///
/// ```
/// use aurt_traits::Jet;
/// let x = Jet::variable(0.5, 0);
/// let y = x * x + x.sin();
/// assert!((y.slope[0] - (1.0 + 0.5f64.cos())).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Jet {
    /// The value.
    pub value: f64,
    /// ∂value along each direction.
    pub slope: [f64; Self::LANES],
}

impl Jet {
    /// Number of directions.
    pub const LANES: usize = 8;
    /// Zero.
    pub const ZERO: Self = Self::constant(0.0);

    /// A number that no direction changes.
    pub const fn constant(value: f64) -> Self {
        Self { value, slope: [0.0; Self::LANES] }
    }

    /// A number that is itself direction `lane`.
    ///
    /// # Panics
    /// If there is no such lane.
    pub const fn variable(value: f64, lane: usize) -> Self {
        let mut jet = Self::constant(value);
        jet.slope[lane] = 1.0;
        jet
    }

    /// f(self), given f and f' at the value.
    #[inline]
    #[must_use]
    pub fn chain(self, value: f64, derivative: f64) -> Self {
        Self { value, slope: self.slope.map(|s| s * derivative) }
    }

    /// The sine.
    #[must_use]
    pub fn sin(self) -> Self {
        self.chain(libm::sin(self.value), libm::cos(self.value))
    }

    /// The cosine.
    #[must_use]
    pub fn cos(self) -> Self {
        self.chain(libm::cos(self.value), -libm::sin(self.value))
    }

    /// The exponential.
    #[must_use]
    pub fn exp(self) -> Self {
        let e = libm::exp(self.value);
        self.chain(e, e)
    }

    /// The square root of a number above zero; zero, without slope, of all others.
    #[must_use]
    pub fn sqrt(self) -> Self {
        if self.value <= 0.0 {
            return Self::ZERO;
        }
        let root = libm::sqrt(self.value);
        self.chain(root, 0.5 / root)
    }

    /// The magnitude.
    #[must_use]
    pub fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }

    /// The nearest number within ±`limit`.
    #[must_use]
    pub fn clamp(self, limit: Self) -> Self {
        if self.value > limit.value {
            limit
        } else if self.value < -limit.value {
            -limit
        } else {
            self
        }
    }

    /// What of a number exceeds ±`band`; zero within.
    #[must_use]
    pub fn beyond(self, band: Self) -> Self {
        self - self.clamp(band)
    }
}

impl From<f64> for Jet {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

impl Neg for Jet {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

/// An operation of two jets by its value and what it makes of the two slopes.
macro_rules! operation {
    ($trait:ident, $method:ident, |$a:ident, $b:ident| $value:expr, |$s:ident, $t:ident| $slope:expr) => {
        impl $trait for Jet {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                let ($a, $b) = (self.value, other.value);
                let mut slope = [0.0; Self::LANES];
                for k in 0..Self::LANES {
                    let ($s, $t) = (self.slope[k], other.slope[k]);
                    slope[k] = $slope;
                }
                Self { value: $value, slope }
            }
        }
    };
}
operation!(Add, add, |a, b| a + b, |s, t| s + t);
operation!(Sub, sub, |a, b| a - b, |s, t| s - t);
operation!(Mul, mul, |a, b| a * b, |s, t| s * b + a * t);

impl Div for Jet {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let inverse = 1.0 / other.value;
        self * other.chain(inverse, -inverse * inverse)
    }
}

impl Add<f64> for Jet {
    type Output = Self;
    #[inline]
    fn add(mut self, other: f64) -> Self {
        self.value += other;
        self
    }
}

impl Mul<f64> for Jet {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f64) -> Self {
        self.chain(self.value * factor, factor)
    }
}

impl AddAssign for Jet {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Jet {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_those_of_differences() {
        let f = |x: Jet, y: Jet| {
            (x * y + x.sin() / (y + 2.0)).exp().sqrt() - (x - y).abs() * 0.3
                + y.cos().clamp(Jet::from(0.4)) * x.beyond(Jet::from(0.1))
        };
        for (x, y) in [(0.3, 0.7), (-0.4, 1.2), (0.05, -0.2)] {
            let jet = f(Jet::variable(x, 0), Jet::variable(y, 3));
            let at = |x: f64, y: f64| f(x.into(), y.into()).value;
            let h = 1e-6;
            assert!((jet.slope[0] - (at(x + h, y) - at(x - h, y)) / (2.0 * h)).abs() < 1e-8);
            assert!((jet.slope[3] - (at(x, y + h) - at(x, y - h)) / (2.0 * h)).abs() < 1e-8);
            assert_eq!(jet.slope[1], 0.0);
        }
    }
}
