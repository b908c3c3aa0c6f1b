//! `time_delay`: a delay between motion and measurement.
//!
//! # What it is
//! The row of time t holds q(t) and τ(t − d): to first order, y = τ − d τ̇. Position and current come over
//! different buses, are filtered differently, or a logger pairs the values of two cycles.
//!
//! - `delay_s`: d, s, usually one to ten samples, below zero where positions are late; as a rule the same for all
//!   joints, since they share the bus.
//!
//! # How it shows
//! Residuals follow the slope of the torque; at reversals, where friction steps, they are peaks as wide as the
//! delay, on the same side of every reversal.
//!
//! # Easily confused with
//! - `joint_elasticity`: a resonance above the motion delays as well, but not at all frequencies alike.
//! - `presliding_hysteresis` and `stribeck`: the step of friction at a reversal comes late in these, too. They
//!   follow travel and speed, a delay follows time.
//! - `viscous`, acting against a delayed gravity torque in slow motion.
//! - `rotor_inertia`, in motion of a single frequency.
//!
//! # What to record to be sure
//! Time stamps of position and current from one clock. A sharp jolt by hand at rest shows the delay on a plot.
//!
//! # References
//! - W. Khalil, E. Dombre (2002), *Modeling, Identification and Control of Robots*, on the filtering that keeps
//!   torque and regressor in phase.

use crate::recordings::rows::Instrument;
use crate::vocabulary::{Effect, Family, Kind, Parameter, Proposal, Unit};

pub static EFFECT: Effect = Effect {
    id: "time_delay",
    family: Family::D,
    kind: Kind::Acceleration,
    title: "a delay between motion and measurement",
    decider: "time stamps of both from one clock",
    source: include_str!("time_delay.rs"),
    parameters: &[Parameter::new("delay_s", Unit::Time)],
    is_whole_arm: true,
    concerns_all_joints: true,
    propose: |context| {
        let column = |which| Proposal::instrument((0..context.joints).collect(), 0, which);
        [Instrument::Delay, Instrument::DelayOfAll].map(column).to_vec()
    },
    ..Effect::BASE
};
