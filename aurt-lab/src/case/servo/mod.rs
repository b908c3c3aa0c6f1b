//! The world of servo arms: recordings of commands and positions, without torques.
//!
//! The simulator shares the rigid bodies with what is fitted, and nothing else: firmware that runs 1000 times a second on
//! encoder ticks, a host whose commands hold for 20 ms, dry friction of bristles, small explicit steps, a load that is a
//! point, and a description whose masses are slightly wrong.

mod arm;
mod effect;
mod make;
mod motion;
mod plant;

pub(crate) use make::{make, record, requests};
