use super::lanes::Lanes;

pub(super) type Vector<T> = [T; 3];

/// The constant rotation of a placement, in the cheapest form that it has.
///
/// Real robots turn by right angles about x almost everywhere, which costs nothing but a sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Turn {
    Straight(Straight),
    Up(Up),
    Down(Down),
    AboutX(AboutX),
    Any(Any),
}

impl Turn {
    /// The turn of a rotation matrix that maps the new frame's coordinates to the old one's.
    pub fn of(r: &[[f64; 3]; 3]) -> Self {
        let about_x = r[0] == [1.0, 0.0, 0.0] && r[1][0] == 0.0 && r[2][0] == 0.0;
        match (about_x, r[1][1], r[2][1]) {
            (true, 1.0, 0.0) => Self::Straight(Straight),
            (true, 0.0, 1.0) => Self::Up(Up),
            (true, 0.0, -1.0) => Self::Down(Down),
            (true, cosine, sine) => Self::AboutX(AboutX(cosine, sine)),
            (false, ..) => Self::Any(Any(*r)),
        }
    }
}

/// The constant translation of a placement, in the new frame's axes, in the cheapest form that it has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shift {
    Nowhere(Nowhere),
    AlongX(AlongX),
    AlongZ(AlongZ),
    Anywhere(Anywhere),
}

impl Shift {
    /// The cheapest form of a translation.
    pub fn of(p: [f64; 3]) -> Self {
        match p {
            [0.0, 0.0, 0.0] => Self::Nowhere(Nowhere),
            [x, 0.0, 0.0] => Self::AlongX(AlongX(x)),
            [0.0, 0.0, z] => Self::AlongZ(AlongZ(z)),
            _ => Self::Anywhere(Anywhere(p)),
        }
    }
}

/// Runs `$body` with `$turn` bound to the compile-time form of a [`Turn`], so that the choice is made once and
/// not for every vector.
macro_rules! with_turn {
    ($turn_of:expr, $turn:ident => $body:expr) => {
        match $turn_of {
            $crate::kernel::turn::Turn::Straight($turn) => $body,
            $crate::kernel::turn::Turn::Up($turn) => $body,
            $crate::kernel::turn::Turn::Down($turn) => $body,
            $crate::kernel::turn::Turn::AboutX($turn) => $body,
            $crate::kernel::turn::Turn::Any($turn) => $body,
        }
    };
}

/// As [`with_turn`], for a [`Shift`].
macro_rules! with_shift {
    ($shift_of:expr, $shift:ident => $body:expr) => {
        match $shift_of {
            $crate::kernel::turn::Shift::Nowhere($shift) => $body,
            $crate::kernel::turn::Shift::AlongX($shift) => $body,
            $crate::kernel::turn::Shift::AlongZ($shift) => $body,
            $crate::kernel::turn::Shift::Anywhere($shift) => $body,
        }
    };
}

pub(super) use with_shift;
pub(super) use with_turn;

/// A [`Turn`] that is known where the code is compiled.
pub(super) trait Turned: Copy {
    /// A vector of the previous link frame in the axes of the joint: Rᵀ v.
    fn in_joint<T: Lanes>(self, v: &Vector<T>) -> Vector<T>;
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Straight;
/// By +90° about x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Up;
/// By −90° about x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Down;
/// By any angle about x: its cosine and sine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AboutX(pub f64, pub f64);
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Any(pub [[f64; 3]; 3]);

impl Turned for Straight {
    #[inline(always)]
    fn in_joint<T: Lanes>(self, v: &Vector<T>) -> Vector<T> {
        *v
    }
}

impl Turned for Up {
    #[inline(always)]
    fn in_joint<T: Lanes>(self, v: &Vector<T>) -> Vector<T> {
        [v[0], v[2], -v[1]]
    }
}

impl Turned for Down {
    #[inline(always)]
    fn in_joint<T: Lanes>(self, v: &Vector<T>) -> Vector<T> {
        [v[0], -v[2], v[1]]
    }
}

impl Turned for AboutX {
    #[inline(always)]
    fn in_joint<T: Lanes>(self, v: &Vector<T>) -> Vector<T> {
        let (cosine, sine) = (T::splat(self.0), T::splat(self.1));
        [v[0], sine.mul_add(v[2], cosine * v[1]), sine.neg_mul_add(v[1], cosine * v[2])]
    }
}

impl Turned for Any {
    #[inline(always)]
    fn in_joint<T: Lanes>(self, v: &Vector<T>) -> Vector<T> {
        [column_dot(&self.0, 0, v), column_dot(&self.0, 1, v), column_dot(&self.0, 2, v)]
    }
}

#[inline(always)]
fn column_dot<T: Lanes>(r: &[[f64; 3]; 3], c: usize, v: &Vector<T>) -> T {
    dot(&[T::splat(r[0][c]), T::splat(r[1][c]), T::splat(r[2][c])], v)
}

/// A [`Shift`] that is known where the code is compiled.
pub(super) trait Shifted: Copy {
    /// v + ω × p: the velocity of the shifted origin.
    fn swing<T: Lanes>(self, omega: &Vector<T>, v: &Vector<T>) -> Vector<T>;
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Nowhere;
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AlongX(pub f64);
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AlongZ(pub f64);
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Anywhere(pub [f64; 3]);

impl Shifted for Nowhere {
    #[inline(always)]
    fn swing<T: Lanes>(self, _: &Vector<T>, v: &Vector<T>) -> Vector<T> {
        *v
    }
}

impl Shifted for AlongX {
    #[inline(always)]
    fn swing<T: Lanes>(self, [_, oy, oz]: &Vector<T>, v: &Vector<T>) -> Vector<T> {
        let p = T::splat(self.0);
        [v[0], oz.mul_add(p, v[1]), oy.neg_mul_add(p, v[2])]
    }
}

impl Shifted for AlongZ {
    #[inline(always)]
    fn swing<T: Lanes>(self, [ox, oy, _]: &Vector<T>, v: &Vector<T>) -> Vector<T> {
        let p = T::splat(self.0);
        [oy.mul_add(p, v[0]), ox.neg_mul_add(p, v[1]), v[2]]
    }
}

impl Shifted for Anywhere {
    #[inline(always)]
    fn swing<T: Lanes>(self, [ox, oy, oz]: &Vector<T>, v: &Vector<T>) -> Vector<T> {
        let [px, py, pz] = [T::splat(self.0[0]), T::splat(self.0[1]), T::splat(self.0[2])];
        [
            oz.neg_mul_add(py, oy.mul_add(pz, v[0])),
            ox.neg_mul_add(pz, oz.mul_add(px, v[1])),
            oy.neg_mul_add(px, ox.mul_add(py, v[2])),
        ]
    }
}

#[inline(always)]
pub(super) fn dot<T: Lanes>(a: &Vector<T>, b: &Vector<T>) -> T {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}
