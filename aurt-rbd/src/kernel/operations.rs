//! How many operations an evaluation needs, counted by running the kernel on lanes that take notes.

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::{Add, Mul, Neg, Sub};

use aurt_traits::{MotionView, RegressorTile};

use super::lanes::Lanes;
use super::plan::Plan;
use crate::SerialChain;

/// What one evaluation of the regressor needs, by kind of instruction.
///
/// Only operations count that a written entry depends on, and each combination of operands once, however often the
/// source text has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Operations {
    /// a · b + c or c − a · b.
    pub multiply_adds: usize,
    /// Sums and differences.
    pub additions: usize,
    /// Products.
    pub multiplications: usize,
    /// Changes of sign and choices between values, which are no arithmetic.
    pub others: usize,
    /// Numbers read: positions, velocities and accelerations.
    pub loads: usize,
    /// Entries written.
    pub stores: usize,
}

impl Operations {
    /// Additions and multiplications, those of a fused multiply-add counted apart.
    #[must_use]
    pub const fn flops(&self) -> usize {
        2 * self.multiply_adds + self.additions + self.multiplications
    }

    /// Bytes read and written.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        (self.loads + self.stores) * size_of::<f64>()
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Kind {
    Constant(u64),
    Loaded(usize),
    MultiplyAdd,
    NegatedMultiplyAdd,
    Sum,
    Difference,
    Product,
    Negation,
    Choice,
    Flip(u64),
}

/// Values by what they were made of.
#[derive(Debug, Default)]
struct Notes {
    known: HashMap<(Kind, [u32; 3]), u32>,
    made: Vec<(Kind, [u32; 3])>,
    written: Vec<u32>,
}

thread_local! {
    static NOTES: RefCell<Notes> = RefCell::default();
}

/// A value: its number in the notes.
#[derive(Debug, Clone, Copy)]
struct Noted(u32);

impl Noted {
    // The kernel is one large function; with this in every operation of it the compiler would take minutes.
    #[inline(never)]
    fn new(kind: Kind, of: &[Self]) -> Self {
        let mut from = [0; 3];
        from.iter_mut().zip(of).for_each(|(from, of)| *from = of.0);
        if matches!(kind, Kind::Sum | Kind::Product | Kind::MultiplyAdd | Kind::NegatedMultiplyAdd) {
            from[..2].sort_unstable();
        }
        NOTES.with_borrow_mut(|notes| {
            let next = notes.made.len() as u32;
            let known = *notes.known.entry((kind, from)).or_insert(next);
            if known == next {
                notes.made.push((kind, from));
            }
            Self(known)
        })
    }
}

macro_rules! noted_operator {
    ($operator:ident, $method:ident, $kind:ident) => {
        impl $operator for Noted {
            type Output = Self;

            fn $method(self, other: Self) -> Self {
                Self::new(Kind::$kind, &[self, other])
            }
        }
    };
}
noted_operator!(Add, add, Sum);
noted_operator!(Sub, sub, Difference);
noted_operator!(Mul, mul, Product);

impl Neg for Noted {
    type Output = Self;

    fn neg(self) -> Self {
        Self::new(Kind::Negation, &[self])
    }
}

impl Lanes for Noted {
    const LANES: usize = 1;

    fn splat(value: f64) -> Self {
        Self::new(Kind::Constant(value.to_bits()), &[])
    }

    fn load(from: &[f64]) -> Self {
        Self::new(Kind::Loaded(from.as_ptr() as usize), &[])
    }

    unsafe fn store_at(self, _: *mut f64) {
        NOTES.with_borrow_mut(|notes| notes.written.push(self.0));
    }

    fn first(self) -> f64 {
        f64::NAN
    }

    fn mul_add(self, b: Self, c: Self) -> Self {
        Self::new(Kind::MultiplyAdd, &[self, b, c])
    }

    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        Self::new(Kind::NegatedMultiplyAdd, &[self, b, c])
    }

    fn select_odd(self, other: Self, selector: Self) -> Self {
        Self::new(Kind::Choice, &[self, other, selector])
    }

    fn flip_by_bit_one(self, selector: Self, offset: u64) -> Self {
        Self::new(Kind::Flip(offset), &[self, selector])
    }
}

/// Counts the operations behind the wanted entries of a tile for the first sample of `motion`.
pub(crate) fn count(chain: &SerialChain, motion: MotionView<'_>, tile: &mut RegressorTile<'_>) -> Operations {
    let plan = Plan::new(chain, motion, tile);
    let (_, stride, data) = tile.raw_mut();
    NOTES.set(Notes::default());
    super::evaluate_lanes::<Noted>(plan, stride, data);
    let Notes { made, written, .. } = NOTES.take();
    let mut counted = Operations { stores: written.len(), ..Operations::default() };
    let mut needed = vec![false; made.len()];
    written.iter().for_each(|k| needed[*k as usize] = true);
    // What a value is made of stands before it.
    for (k, (kind, from)) in made.iter().enumerate().rev() {
        if !needed[k] {
            continue;
        }
        let operands = match kind {
            Kind::Constant(_) => continue,
            Kind::Loaded(_) => {
                counted.loads += 1;
                continue;
            }
            Kind::MultiplyAdd | Kind::NegatedMultiplyAdd => {
                counted.multiply_adds += 1;
                3
            }
            Kind::Sum | Kind::Difference => {
                counted.additions += 1;
                2
            }
            Kind::Product => {
                counted.multiplications += 1;
                2
            }
            Kind::Negation => {
                counted.others += 1;
                1
            }
            Kind::Choice => {
                counted.others += 1;
                3
            }
            Kind::Flip(_) => {
                counted.others += 1;
                2
            }
        };
        from[..operands].iter().for_each(|k| needed[*k as usize] = true);
    }
    counted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MdhRows, MdhTable};
    use aurt_traits::Motion;

    /// One joint about a vertical axis: its torque is ZZ q̈, and gravity has no moment about it.
    #[test]
    fn a_turntable_needs_its_acceleration_and_its_sense() {
        let table = MdhTable::parse("alpha,a,d\n0,0,0\n", "turntable", MdhRows::Next).unwrap();
        let chain = SerialChain::from_mdh(&table, [0.0, 0.0, -9.81]).unwrap();
        let motion = Motion::new(1, vec![0.0], vec![0.3], vec![0.5], vec![0.7]).unwrap();
        let mut destination = [RegressorTile::UNWANTED; 10];
        destination[5] = 0;
        let mut data = [0.0];
        let mut tile = RegressorTile::new(&destination, 10, 1, 1, &mut data);
        let counted = count(&chain, motion.view(), &mut tile);
        // The acceleration times the sense on the way in, and again on the way out.
        let expected = Operations { multiplications: 2, loads: 1, stores: 1, ..Operations::default() };
        assert_eq!(counted, expected);
        assert_eq!((counted.flops(), counted.bytes()), (2, 16));
    }
}
