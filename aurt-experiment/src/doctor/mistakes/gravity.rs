//! The sign of gravity in currents whose torque constants are unknown.
//!
//! Parameters that joints share are wrong there by the ratios of the constants, which hides what gravity would show. Each joint is
//! therefore fitted by itself: its own row holds the first moments under gravity and, with the sign of the motor that friction
//! tells, in the forces of inertia. A motion that is too slow for these says nothing of the sign.

use super::evidence::{Evidence, TESTS};
use super::folds::within;
use super::found::Step;
use super::mistake::Mistake;
use super::setup::Setup;
use super::trial::Bench;

/// A gain that is no difference: gravity acts on no joint.
const NO_DIFFERENCE: f64 = 1e-9;

/// The answer of recordings to the question whether gravity is the other way round.
#[derive(Debug)]
pub enum GravitySign {
    /// It is as stated, or acts on no joint.
    Confirmed,
    /// It is the other way round.
    Refuted(Box<Step>),
    /// They are explained alike.
    Open,
}

impl GravitySign {
    /// Compares a setup with the one in which gravity is turned round; `whole` is the same with all of its recordings. `None` if
    /// nothing can be fitted.
    pub fn of(bench: &Bench, [setup, whole]: [&Setup; 2]) -> Option<Self> {
        let separate = bench.separate();
        let to_m_s2 = setup.gravity_m_s2.map(|g| if g == 0.0 { 0.0 } else { -g });
        let mistake = Mistake::Gravity { to_m_s2 };
        let other = mistake.undone(setup);
        let [now, after] = [separate.score(setup)?, separate.score(&other)?];
        let across = Evidence::of([(Some(&now), &after)])?;
        let stretches = within(&separate, whole, [setup, &other], None)?;
        if across.gain.abs() < NO_DIFFERENCE && stretches.gain.abs() < NO_DIFFERENCE {
            return Some(Self::Confirmed);
        }
        if across.is_enough() && across.is_sure(TESTS) && stretches.is_sure(TESTS) {
            let joints = after.joints.iter().flatten().count().max(1) as f64;
            let likelier = Some((-across.gain / joints).exp());
            let step = Step { likelier, ..Step::new(mistake, bench.score(&other)?) };
            return Some(Self::Refuted(Box::new(step)));
        }
        let is_surely_worse = across.reversed().is_sure(1) || stretches.reversed().is_sure(1);
        let is_better = across.gain > 0.0 && stretches.gain > 0.0;
        Some(if is_surely_worse && !is_better { Self::Confirmed } else { Self::Open })
    }
}
