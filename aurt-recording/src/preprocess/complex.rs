use std::ops::{Add, Div, Mul, Sub};

/// A complex number, as far as filter design needs one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Complex {
    pub(crate) re: f64,
    pub(crate) im: f64,
}

impl Complex {
    pub(crate) const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    pub(crate) const fn real(re: f64) -> Self {
        Self { re, im: 0.0 }
    }

    pub(crate) const fn conjugate(self) -> Self {
        Self { re: self.re, im: -self.im }
    }

    pub(crate) const fn norm_squared(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    /// z^n by way of polar coordinates, so that the relative error does not grow with n times that of a product.
    pub(crate) fn power(self, n: usize) -> Self {
        if n == 0 {
            return Self::real(1.0);
        }
        let (modulus, argument) = (libm::hypot(self.re, self.im), libm::atan2(self.im, self.re));
        let (sine, cosine) = libm::sincos(argument * n as f64);
        let modulus = libm::pow(modulus, n as f64);
        Self { re: modulus * cosine, im: modulus * sine }
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}

impl Div for Complex {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let scale = other.norm_squared();
        let product = self * other.conjugate();
        Self { re: product.re / scale, im: product.im / scale }
    }
}
