//! The work of an evaluation, counted by running the kernel on numbers that count.

use std::cell::Cell;
use std::ops::{Add, Mul, Neg, Sub};

use aurt_traits::{Motion, RegressorTile, RigidBodyRegressor};

use super::{evaluate_lanes, lanes::Lanes, plan::Plan};
use crate::{MdhRows, MdhTable, SerialChain};

/// One sample, every operation on which is counted.
#[derive(Debug, Clone, Copy)]
struct Counted(f64);

thread_local! {
    /// Additions and subtractions; products; products with addition.
    static OPERATIONS: Cell<[usize; 3]> = const { Cell::new([0; 3]) };
}

fn count(kind: usize) {
    let mut all = OPERATIONS.get();
    all[kind] += 1;
    OPERATIONS.set(all);
}

impl Lanes for Counted {
    const LANES: usize = 1;

    fn splat(value: f64) -> Self {
        Self(value)
    }

    fn load(from: &[f64]) -> Self {
        Self(from[0])
    }

    unsafe fn store_at(self, to: *mut f64) {
        // SAFETY: the caller's promise.
        unsafe { to.write(self.0) };
    }

    fn first(self) -> f64 {
        self.0
    }

    fn mul_add(self, b: Self, c: Self) -> Self {
        count(2);
        Self(self.0.mul_add(b.0, c.0))
    }

    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        count(2);
        Self((-self.0).mul_add(b.0, c.0))
    }

    fn select_odd(self, other: Self, selector: Self) -> Self {
        if selector.0.to_bits() & 1 == 0 { self } else { other }
    }

    fn flip_by_bit_one(self, selector: Self, offset: u64) -> Self {
        let sign = (selector.0.to_bits().wrapping_add(offset) & 2) << 62;
        Self(f64::from_bits(self.0.to_bits() ^ sign))
    }
}

impl Add for Counted {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        count(0);
        Self(self.0 + other.0)
    }
}

impl Sub for Counted {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        count(0);
        Self(self.0 - other.0)
    }
}

impl Mul for Counted {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        count(1);
        Self(self.0 * other.0)
    }
}

impl Neg for Counted {
    type Output = Self;

    fn neg(self) -> Self {
        Self(-self.0)
    }
}

/// docs/performance.md and the benchmark `roofline` rest on these numbers.
#[test]
fn work_of_an_evaluation_of_a_ur10e() {
    let mdh =
        "alpha,a,d\npi/2,0,0.1807\n0,-0.6127,0\n0,-0.57155,0\npi/2,0,0.17415\n-pi/2,0,0.11985\n0,0,0.11655\n";
    let table = MdhTable::parse(mdh, "ur10e", MdhRows::Next).unwrap();
    let chain = SerialChain::from_mdh(&table, [0.0, 0.0, -9.81]).unwrap();
    let mut entries = 0;
    let destinations: Vec<u32> = (0..6)
        .flat_map(|joint| (0..60).map(move |parameter| (joint, parameter)))
        .map(|(joint, parameter)| {
            if !chain.loads(parameter, joint) {
                return RegressorTile::UNWANTED;
            }
            entries += 1;
            entries - 1
        })
        .collect();
    let motion = Motion::new(6, vec![0.0], vec![0.3; 6], vec![0.5; 6], vec![0.7; 6]).unwrap();
    let mut data = vec![0.0; entries as usize];
    let mut tile = RegressorTile::new(&destinations, 60, 1, 1, &mut data);
    let plan = Plan::new(&chain, motion.view(), &mut tile);
    let (_, stride, data) = tile.raw_mut();
    evaluate_lanes::<Counted>(plan, stride, data);
    let [sums, products, fused] = OPERATIONS.get();
    println!("{entries} entries; {sums} sums, {products} products, {fused} products with sum");
    assert_eq!((entries, sums + products + 2 * fused), (0, 0));
}
