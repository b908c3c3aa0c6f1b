use super::lanes::Lanes;
use crate::chain::JointFrame;

/// A vector of three in the lanes.
pub(super) type Vector<T> = [T; 3];

/// The constant rotation of a placement, in the cheapest form that it has.
///
/// Real robots turn by right angles about x almost everywhere, which costs nothing but a sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Turn {
    /// None.
    Straight,
    /// By +90° about x.
    Up,
    /// By −90° about x.
    Down,
    /// By any angle about x: its cosine and sine.
    AboutX(f64, f64),
    /// Any other, as a matrix.
    Any([[f64; 3]; 3]),
}

impl Turn {
    pub fn of(frame: &JointFrame) -> Self {
        let r = frame.rotation;
        let about_x = r[0] == [1.0, 0.0, 0.0] && r[1][0] == 0.0 && r[2][0] == 0.0;
        match (about_x, r[1][1], r[2][1]) {
            (true, 1.0, 0.0) => Self::Straight,
            (true, 0.0, 1.0) => Self::Up,
            (true, 0.0, -1.0) => Self::Down,
            (true, cosine, sine) => Self::AboutX(cosine, sine),
            (false, ..) => Self::Any(r),
        }
    }
}

/// A [`Turn`] that is known where the code is compiled.
pub(super) trait Turned: Copy {
    /// A vector of the previous link frame in the coordinates of the joint: Rᵀ v.
    fn into_joint<T: Lanes>(self, v: &Vector<T>) -> Vector<T>;
}

#[derive(Clone, Copy)]
pub(super) struct Straight;
#[derive(Clone, Copy)]
pub(super) struct Up;
#[derive(Clone, Copy)]
pub(super) struct Down;
#[derive(Clone, Copy)]
pub(super) struct AboutX(pub f64, pub f64);
#[derive(Clone, Copy)]
pub(super) struct Any(pub [[f64; 3]; 3]);

impl Turned for Straight {
    #[inline(always)]
    fn into_joint<T: Lanes>(self, v: &Vector<T>) -> Vector<T> {
        *v
    }
}

impl Turned for Up {
    #[inline(always)]
    fn into_joint<T: Lanes>(self, v: &Vector<T>) -> Vector<T> {
        [v[0], v[2], -v[1]]
    }
}

impl Turned for Down {
    #[inline(always)]
    fn into_joint<T: Lanes>(self, v: &Vector<T>) -> Vector<T> {
        [v[0], -v[2], v[1]]
    }
}

impl Turned for AboutX {
    #[inline(always)]
    fn into_joint<T: Lanes>(self, v: &Vector<T>) -> Vector<T> {
        let (cosine, sine) = (T::splat(self.0), T::splat(self.1));
        [v[0], sine.mul_add(v[2], cosine * v[1]), sine.neg_mul_add(v[1], cosine * v[2])]
    }
}

impl Turned for Any {
    #[inline(always)]
    fn into_joint<T: Lanes>(self, v: &Vector<T>) -> Vector<T> {
        [column_dot(&self.0, 0, v), column_dot(&self.0, 1, v), column_dot(&self.0, 2, v)]
    }
}

/// A matrix column times a vector.
#[inline(always)]
fn column_dot<T: Lanes>(r: &[[f64; 3]; 3], c: usize, v: &Vector<T>) -> T {
    dot(&[T::splat(r[0][c]), T::splat(r[1][c]), T::splat(r[2][c])], v)
}

#[inline(always)]
pub(super) fn dot<T: Lanes>(a: &Vector<T>, b: &Vector<T>) -> T {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}
