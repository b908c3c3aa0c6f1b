//! Steps from event to event: the classical Runge–Kutta method of order four between them; reversals,
//! sticking and break-away located and resolved.

use super::dynamics::{Mode, Plant};
use crate::error::SimulationError;

/// Accuracy of the times of events, s.
const EVENT_S: f64 = 2e-7;
/// Events within one step after which the rest of it is taken as a whole.
const MOST_EVENTS: usize = 40;

/// Integrates a [`Plant`].
#[derive(Debug)]
pub(crate) struct Integrator {
    pub time_s: f64,
    pub state: Vec<f64>,
    /// Rates of the state at `time_s`.
    pub rates: Vec<f64>,
    trial: Vec<f64>,
    trial_rates: Vec<f64>,
    k: [Vec<f64>; 3],
    /// Number of evaluations of the rates so far.
    pub evaluations: u64,
    /// Number of events resolved so far.
    pub events: u64,
}

impl Integrator {
    /// Starts at rest or in motion at time 0 with q and q̇; the shafts start where gravity leaves the gears
    /// without twist.
    pub fn new(plant: &mut Plant, q_rad: &[f64], qd_rad_s: &[f64]) -> Result<Self, SimulationError> {
        let n = plant.joints;
        let mut state = vec![0.0; plant.state_len()];
        state[..n].copy_from_slice(q_rad);
        state[n..2 * n].copy_from_slice(qd_rad_s);
        let shafts = plant.compliant.len();
        for (c, j) in plant.compliant.iter().enumerate() {
            state[2 * n + c] = q_rad[*j];
            state[2 * n + shafts + c] = qd_rad_s[*j];
        }
        for contact in 0..plant.modes.len() {
            let velocity = plant.sliding_rad_s(contact, &state);
            if plant.modes[contact] != Mode::Absent && velocity != 0.0 {
                plant.modes[contact] = Mode::Slides(velocity.signum());
            }
        }
        let length = state.len();
        let zeros = || vec![0.0; length];
        let mut integrator = Self {
            time_s: 0.0,
            rates: zeros(),
            trial: zeros(),
            trial_rates: zeros(),
            k: [zeros(), zeros(), zeros()],
            state,
            evaluations: 0,
            events: 0,
        };
        plant.shaft_then_rad.copy_from_slice(q_rad);
        // The drives start with whatever torque the controller asks for, as after a long time.
        plant.then_s = -1e9;
        plant.rates(0.0, &integrator.state, &mut integrator.rates)?;
        plant.drive_then_nm.copy_from_slice(&plant.drive_nm);
        plant.then_s = 0.0;
        integrator.settle(plant)?;
        plant.drive_then_nm.copy_from_slice(&plant.drive_nm);
        Ok(integrator)
    }

    /// Moves on to `end_s`, through every event on the way.
    pub fn advance(&mut self, plant: &mut Plant, end_s: f64) -> Result<(), SimulationError> {
        let mut events = 0;
        loop {
            let span_s = end_s - self.time_s;
            let at_start = margin(plant, &self.state);
            self.attempt(plant, span_s)?;
            let at_end = margin(plant, &self.trial);
            if events >= MOST_EVENTS || at_end >= 0.0 {
                self.accept(plant, end_s);
                if events >= MOST_EVENTS {
                    self.follow_velocities(plant);
                    self.settle(plant)?;
                }
                return Ok(());
            }
            events += 1;
            self.events += 1;
            let after_s = self.locate(plant, at_start, (span_s, at_end))?;
            let time_s = if after_s == span_s { end_s } else { self.time_s + after_s };
            self.resolve(plant);
            self.accept(plant, time_s);
            self.settle(plant)?;
            if time_s >= end_s {
                return Ok(());
            }
        }
    }

    /// The earliest time at which a contact is violated, from above, within [`EVENT_S`]; the step to there is
    /// left as the attempted one. Secants (Illinois) and halvings in turn.
    fn locate(
        &mut self,
        plant: &mut Plant,
        at_start: f64,
        (end_s, at_end): (f64, f64),
    ) -> Result<f64, SimulationError> {
        let (mut before_s, mut before) = (0.0, at_start.max(0.0));
        let (mut after_s, mut after) = (end_s, at_end);
        let mut attempted_s = end_s;
        for turn in 0.. {
            let width_s = after_s - before_s;
            if width_s <= EVENT_S {
                break;
            }
            let secant_s = before_s + width_s * before / (before - after);
            let middle_s = if turn % 3 == 2 { before_s + 0.5 * width_s } else { secant_s };
            // A secant that falls onto an end is moved inwards by the width that is asked for.
            let middle_s = middle_s.clamp(before_s + 0.5 * EVENT_S, after_s - 0.5 * EVENT_S);
            self.attempt(plant, middle_s)?;
            attempted_s = middle_s;
            let value = margin(plant, &self.trial);
            if value < 0.0 {
                (after_s, after) = (middle_s, value);
                before *= 0.5;
            } else {
                (before_s, before) = (middle_s, value);
                after *= 0.5;
            }
        }
        if attempted_s != after_s {
            self.attempt(plant, after_s)?;
        }
        Ok(after_s)
    }

    /// One step of the classical Runge–Kutta method into `trial`, with the rates at its end.
    fn attempt(&mut self, plant: &mut Plant, span_s: f64) -> Result<(), SimulationError> {
        let [k2, k3, k4] = &mut self.k;
        let (half, start) = (0.5 * span_s, self.time_s);
        let combine = |out: &mut Vec<f64>, state: &[f64], rates: &[f64], weight: f64| {
            for ((o, y), r) in out.iter_mut().zip(state).zip(rates) {
                *o = y + weight * r;
            }
        };
        combine(&mut self.trial, &self.state, &self.rates, half);
        plant.rates(start + half, &self.trial, k2)?;
        combine(&mut self.trial, &self.state, k2, half);
        plant.rates(start + half, &self.trial, k3)?;
        combine(&mut self.trial, &self.state, k3, span_s);
        plant.rates(start + span_s, &self.trial, k4)?;
        let sixth = span_s / 6.0;
        for i in 0..self.trial.len() {
            self.trial[i] = self.state[i] + sixth * (self.rates[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
        plant.rates(start + span_s, &self.trial, &mut self.trial_rates)?;
        self.evaluations += 4;
        Ok(())
    }

    /// Stops the contacts that have come to rest at the end of the attempted step. Whether they, and those that
    /// bear too much, hold or slide is for [`Plant::settle`] to say.
    fn resolve(&mut self, plant: &mut Plant) {
        for contact in 0..plant.modes.len() {
            if matches!(plant.modes[contact], Mode::Slides(_))
                && contact_margin(plant, contact, &self.trial) < 0.0
            {
                plant.stop(contact, &mut self.trial);
                plant.modes[contact] = Mode::Holds;
            }
        }
    }

    fn accept(&mut self, plant: &mut Plant, time_s: f64) {
        std::mem::swap(&mut self.state, &mut self.trial);
        std::mem::swap(&mut self.rates, &mut self.trial_rates);
        self.time_s = time_s;
        plant.complete(time_s, &self.state, &self.rates);
    }

    fn settle(&mut self, plant: &mut Plant) -> Result<(), SimulationError> {
        self.evaluations += plant.settle(self.time_s, &self.state, &mut self.rates)?;
        Ok(())
    }

    /// Gives every sliding contact the direction in which it moves.
    fn follow_velocities(&self, plant: &mut Plant) {
        for contact in 0..plant.modes.len() {
            let velocity = plant.sliding_rad_s(contact, &self.state);
            if let Mode::Slides(_) = plant.modes[contact]
                && velocity != 0.0
            {
                plant.modes[contact] = Mode::Slides(velocity.signum());
            }
        }
    }
}

/// How far the contact that is nearest to a change of mode is from it; negative beyond it.
fn margin(plant: &Plant, state: &[f64]) -> f64 {
    (0..plant.modes.len()).map(|contact| contact_margin(plant, contact, state)).fold(f64::INFINITY, f64::min)
}

/// The velocity that is left to a sliding contact before it rests, the torque that is left to a holding one
/// before it lets go.
fn contact_margin(plant: &Plant, contact: usize, state: &[f64]) -> f64 {
    match plant.modes[contact] {
        Mode::Absent => f64::INFINITY,
        Mode::Slides(direction) => {
            direction * plant.sliding_rad_s(contact, state) + plant.rest_rad_s(contact)
        }
        Mode::Holds => plant.spare_nm(contact),
    }
}
